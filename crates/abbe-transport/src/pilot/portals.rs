//! The search for portals: windows and other holes through which the light of the surroundings
//! reaches the visible part of the scene.
//!
//! Paths from the camera leave a room only through its portals, and each escaping path gives a line
//! from its last surface to the surroundings. Lines from different surfaces meet near a portal, so
//! the search looks for small spheres that many lines pass through. It maximises the likelihood of
//! the lines: a line that a sphere explains has the density 1/Ω, for the solid angle Ω of the
//! sphere seen from the surface.

use crate::gather::{PORTAL_FRACTION, PixelSampler, PortalSpheres, Portals};
use crate::pass::{PassContext, StageSeconds};
use crate::walk::{BodyMode, StopFlag, SurfaceLookup, WithBodies, scatter};
use abbe_optics::bsdf::TransportMode;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::elementary::ln;
use abbe_spectra::math::random::{Purpose, Seed, StreamKey, Streams};
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::spectrum::{REFERENCE_NM, Wavelengths};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::ops::Range;
use web_time::Instant;

/// The number of camera paths in one batch of the search.
const BATCH: u64 = 4096;

/// The largest number of batches. The search traces batches until it has enough lines.
const MAX_BATCHES: u64 = 16;

/// The same for a measurement that finds few lines. Without portals, the sky behind a tiny hole
/// would need far more samples than the search.
const MAX_BATCHES_OF_MEASUREMENT: u64 = 256;

/// A measurement stops the longer search when it has this number of lines.
const FEW_LINES: usize = 8 * MIN_LINES;

/// The factor on the radii for a measurement with fewer than [`MAX_LINES`] lines. Few lines do not
/// reach the edges of a portal, and the light beyond a sphere would be rare and bright.
const MARGIN_OF_FEW_LINES: f64 = 1.5;

const TASK: u64 = 256;

/// The largest number of surface events of these paths.
const MAX_SURFACES: usize = 6;

/// The search uses at most this number of lines.
const MAX_LINES: usize = 512;

/// With fewer lines, the search finds nothing.
const MIN_LINES: usize = 24;

const MAX_PORTALS: usize = 8;

/// The number of pairs of lines whose nearest points are tried as the centre of a sphere.
const PAIRS: u64 = 256;

/// The fractions of the lines that a sphere of the search contains.
const INSIDE: [f64; 7] = [0.02, 0.04, 0.08, 0.16, 0.32, 0.64, 1.0];

/// The rise of the mean logarithm of the likelihood for which a sphere is added.
const MIN_GAIN: f64 = 0.15;

/// The total rise for which the portals are used: a typical line is three times as likely.
const MIN_TOTAL_GAIN: f64 = 1.1;

/// The end of a path that left the scene.
#[derive(Debug, Clone, Copy)]
struct EscapedLine {
    ray: Ray,
    /// The density (1/sr) with which next-event estimation without portals finds this ray.
    pdf_solid_angle: f64,
    /// True if the line passes through glass that does not bend it.
    glazed: bool,
}

/// Finds the portals, and adds the duration to `seconds`. There are none if no light surrounds the
/// scene, or if most paths leave it.
pub fn find_portals(context: &PassContext<'_>, seconds: &mut StageSeconds) -> Portals {
    let start = Instant::now();
    let (scene, seed) = (context.scene, context.budget.seed);
    let Some(sky) = scene.lights.iter().find(|light| light.surrounds()) else { return Portals::default() };
    let pdf_solid_angle = |direction: DVec3| sky.pdf_li_escaped(direction);
    let lines = escaped_lines(scene, seed.streams(Purpose::PortalSearch), pdf_solid_angle, context.stop);
    let (open, glazed): (Vec<_>, Vec<_>) = lines.into_iter().partition(|line| !line.glazed);
    let fit = |lines: &[EscapedLine]| {
        let mut spheres = fit_spheres(&thinned(lines), seed);
        if scene.measures() && lines.len() < MAX_LINES {
            spheres.iter_mut().for_each(|sphere| sphere.radius_m *= MARGIN_OF_FEW_LINES);
        }
        PortalSpheres(spheres)
    };
    let portals = Portals { open: fit(&open), glazed: fit(&glazed) };
    seconds.pilot += start.elapsed().as_secs_f64();
    portals
}

fn thinned(lines: &[EscapedLine]) -> Vec<EscapedLine> {
    lines.iter().copied().step_by(lines.len().div_ceil(MAX_LINES).max(1)).collect()
}

/// Returns the lines along which camera paths leave the scene. `pdf_solid_angle` is the density
/// with which shadow rays find a direction.
fn escaped_lines(
    scene: &Scene,
    streams: Streams,
    pdf_solid_angle: impl Fn(DVec3) -> f64 + Sync,
    stop: &StopFlag,
) -> Vec<EscapedLine> {
    let mut lines: Vec<EscapedLine> = Vec::new();
    let batches = if scene.measures() { MAX_BATCHES_OF_MEASUREMENT } else { MAX_BATCHES };
    for batch in 0..batches {
        let first = |task: u64| batch * BATCH + task * TASK;
        let trace = |task: u64| match stop.is_raised() {
            true => Vec::new(),
            false => trace_lines(scene, streams, first(task)..first(task + 1), &pdf_solid_angle),
        };
        lines.extend((0..BATCH / TASK).into_par_iter().map(trace).collect::<Vec<_>>().into_iter().flatten());
        if lines.len() >= MAX_LINES || (batch + 1 >= MAX_BATCHES && lines.len() >= FEW_LINES) {
            break;
        }
    }
    lines
}

fn trace_lines(
    scene: &Scene,
    streams: Streams,
    paths: Range<u64>,
    pdf_solid_angle: impl Fn(DVec3) -> f64,
) -> Vec<EscapedLine> {
    /// The largest squared distance of the directions before and after unbending glass.
    const UNBENT: f64 = 1e-20;
    let measures = scene.measures();
    let pixels = scene.camera.pixel_count() as u64;
    let wavelengths = Wavelengths::single(REFERENCE_NM);
    let mut lines = Vec::new();
    for path in paths {
        let pixel = if pixels < BATCH { path % pixels } else { path % BATCH * pixels / BATCH };
        let mut sampler = PixelSampler::new(streams, path, pixel);
        let Some((mut ray_state, pdf)) = sampler.ray_at(scene, pixel, REFERENCE_NM) else { continue };
        // The last vertex that scatters into many directions, and the density there.
        let mut last = pdf.map(|pdf| (ray_state.ray, pdf));
        let mut glazed = false;
        for _ in 0..MAX_SURFACES {
            let stream = &mut sampler.stream;
            let lookup = SurfaceLookup::of_line(stream.uniform());
            let Some(interaction) = WithBodies::next_interaction(scene, ray_state, lookup) else {
                let found = |(ray, pdf): (Ray, f64)| EscapedLine {
                    ray,
                    pdf_solid_angle: pdf.max(pdf_solid_angle(ray.direction)),
                    glazed,
                };
                lines.extend(last.map(found));
                break;
            };
            let Some(scattered) = scatter(&interaction, &wavelengths, TransportMode::Radiance, stream) else { break };
            ray_state = interaction.spawn_scattered(&scattered);
            if !scattered.delta {
                (last, glazed) = (Some((ray_state.ray, scattered.pdf)), false);
            } else if measures && ray_state.ray.direction.distance_squared(interaction.incoming) < UNBENT {
                glazed = true;
            } else {
                last = None;
            }
        }
    }
    lines
}

/// Finds spheres that explain the lines. Returns no spheres if they do not help.
fn fit_spheres(lines: &[EscapedLine], seed: Seed) -> Vec<BoundingSphere> {
    if lines.len() < MIN_LINES {
        return Vec::new();
    }
    let mut mixture = Mixture { spheres: Vec::new(), sums: vec![0.0; lines.len()] };
    while mixture.spheres.len() < MAX_PORTALS {
        let key = seed.streams(Purpose::PortalFit).pass(mixture.spheres.len() as u64);
        let Some((sphere, gain)) = best_sphere(lines, &mixture, key) else { break };
        if gain < MIN_GAIN * lines.len() as f64 {
            break;
        }
        for (sum, line) in mixture.sums.iter_mut().zip(lines) {
            *sum += line.pdf_through(&sphere);
        }
        mixture.spheres.push(sphere);
    }
    let count = mixture.spheres.len().max(1) as f64;
    let gain = |(line, sum): (&EscapedLine, &f64)| ln(line.mixture_pdf(*sum, count) / line.pdf_solid_angle);
    let mean = lines.iter().zip(&mixture.sums).map(gain).sum::<f64>() / lines.len() as f64;
    if mean >= MIN_TOTAL_GAIN { mixture.spheres } else { Vec::new() }
}

/// The spheres found so far. Rays are sent to all of them with equal probability.
struct Mixture {
    spheres: Vec<BoundingSphere>,
    /// For each line, the sum of the densities through all spheres.
    sums: Vec<f64>,
}

impl Mixture {
    /// Returns how much a sphere raises the logarithm of the likelihood of the lines.
    fn gain_of(&self, lines: &[EscapedLine], sphere: &BoundingSphere) -> f64 {
        let count = self.spheres.len() as f64;
        let gain = |(line, sum): (&EscapedLine, &f64)| {
            let before = line.mixture_pdf(*sum, count.max(1.0));
            ln(line.mixture_pdf(sum + line.pdf_through(sphere), count + 1.0) / before)
        };
        lines.iter().zip(&self.sums).map(gain).sum()
    }
}

/// Returns the sphere that raises the likelihood most, and the rise of its logarithm.
fn best_sphere(lines: &[EscapedLine], mixture: &Mixture, key: StreamKey) -> Option<(BoundingSphere, f64)> {
    let count = lines.len() as u64;
    let line = |pair: u64, side: u64| &lines[key.part(pair).part(side).index(count) as usize].ray;
    let centres = (0..PAIRS).filter_map(|pair| nearest_point(line(pair, 0), line(pair, 1)));
    let rated = |sphere: BoundingSphere| (sphere, mixture.gain_of(lines, &sphere));
    let best_around = |centre: DVec3| spheres_around(lines, centre).map(rated).max_by(|a, b| a.1.total_cmp(&b.1));
    let (mut best, mut gain) = centres.filter_map(best_around).max_by(|a, b| a.1.total_cmp(&b.1))?;
    // The point nearest to all lines in the sphere is a better centre.
    loop {
        let inside = |line: &&EscapedLine| best.contains_part_of(line.ray.origin, line.ray.direction);
        let Some(centre) = point_nearest_to(lines.iter().filter(inside).map(|line| &line.ray)) else { break };
        match best_around(centre) {
            Some((sphere, better)) if better > gain * 1.001 => (best, gain) = (sphere, better),
            _ => break,
        }
    }
    Some((best, gain))
}

/// Returns spheres around a point that contain increasing parts of the lines.
fn spheres_around(lines: &[EscapedLine], centre: DVec3) -> impl Iterator<Item = BoundingSphere> {
    /// The sphere is larger than the distance of its lines by this factor.
    const MARGIN: f64 = 1.05;
    let mut distances: Vec<f64> = lines.iter().map(|line| distance(&line.ray, centre)).collect();
    distances.sort_by(f64::total_cmp);
    INSIDE.into_iter().filter_map(move |inside| {
        let last = ((inside * distances.len() as f64) as usize).clamp(2, distances.len()) - 1;
        let radius_m = MARGIN * distances[last];
        (radius_m.is_finite() && radius_m > 0.0).then_some(BoundingSphere { centre, radius_m })
    })
}

fn distance(ray: &Ray, point: DVec3) -> f64 {
    let offset = point - ray.origin;
    offset.distance(offset.dot(ray.direction).max(0.0) * ray.direction)
}

/// Returns the point halfway between two rays where they are nearest. `None` if they are nearly
/// parallel, or nearest at their origins.
fn nearest_point(a: &Ray, b: &Ray) -> Option<DVec3> {
    let (cosine, offset) = (a.direction.dot(b.direction), b.origin - a.origin);
    let sine2 = 1.0 - cosine * cosine;
    if sine2 < 1e-4 {
        return None;
    }
    let along_a = (offset.dot(a.direction) - cosine * offset.dot(b.direction)) / sine2;
    let along_b = (cosine * offset.dot(a.direction) - offset.dot(b.direction)) / sine2;
    (along_a > 0.0 && along_b > 0.0).then(|| 0.5 * (a.at(along_a) + b.at(along_b)))
}

/// Returns the point with the least sum of squared distances, `None` for parallel lines.
fn point_nearest_to<'r>(rays: impl Iterator<Item = &'r Ray>) -> Option<DVec3> {
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for ray in rays {
        let d = ray.direction;
        let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        matrix += across;
        right += across * ray.origin;
    }
    (matrix.determinant().abs() > 1e-9).then(|| matrix.inverse() * right)
}

impl EscapedLine {
    /// Returns the density of next-event estimation. `sum` is that through all `count` portals.
    fn mixture_pdf(&self, sum: f64, count: f64) -> f64 {
        self.pdf_solid_angle.max(sum / count)
    }

    /// Returns the density with which shadow rays through a sphere find the line.
    fn pdf_through(&self, sphere: &BoundingSphere) -> f64 {
        PORTAL_FRACTION * sphere.pdf_direction(self.ray.origin, self.ray.direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;
    use std::f64::consts::FRAC_1_PI;

    /// Lines from the floor of a room through square windows in the plane y = 3.
    fn lines_through(windows: &[(DVec3, f64)]) -> Vec<EscapedLine> {
        let sobol = Sobol::new(11);
        let line = |i: u32| {
            let u = sobol.point(i);
            let (centre, size) = windows[i as usize % windows.len()];
            let floor = DVec3::new(6.0 * u[0] - 3.0, 0.0, 6.0 * u[1] - 3.0);
            let window = centre + size * DVec3::new(u[2] - 0.5, 0.0, u[3] - 0.5);
            let direction = (window - floor).normalize();
            EscapedLine {
                ray: Ray { origin: floor, direction },
                pdf_solid_angle: FRAC_1_PI * direction.y,
                glazed: false,
            }
        };
        (0..400).map(line).collect()
    }

    #[test]
    fn portals_are_found_where_lines_meet() {
        for windows in [
            vec![(DVec3::new(0.5, 3.0, 0.2), 1.0)],
            vec![(DVec3::new(-2.0, 3.0, 0.2), 0.5), (DVec3::new(1.0, 3.0, -2.0), 0.8)],
        ] {
            let spheres = fit_spheres(&lines_through(&windows), Seed::new(1));
            for (centre, size) in &windows {
                let around = |sphere: &&BoundingSphere| {
                    sphere.centre.distance(*centre) < 0.3 * size && sphere.radius_m < 1.1 * size
                };
                assert!(spheres.iter().any(|sphere| around(&sphere)), "{windows:?}: {spheres:?}");
            }
        }
    }

    #[test]
    fn an_open_roof_is_no_portal() {
        assert_eq!(fit_spheres(&lines_through(&[(DVec3::new(0.0, 3.0, 0.0), 12.0)]), Seed::new(1)), []);
    }
}
