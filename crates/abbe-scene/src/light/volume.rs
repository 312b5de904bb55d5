//! A volume light: a medium that emits light, such as hot soot or the gas of a neon tube. The cells
//! of a box around the medium are measured by probes (the points of a finer grid). Most samples
//! select a cell in proportion to its emission, and a small fraction selects all cells alike,
//! because the probes may miss emission. Directions are uniform.
//!
//! Shadow rays from points in or near the box need a second technique. The irradiance from a point
//! of the medium at the distance d falls as 1/d², so that near points, which a cell selects seldom,
//! would give estimates of infinite variance: pictures would be too dark apart from rare bright
//! samples. Half of these rays therefore sample a direction and a distance on the chord of the box,
//! with a density proportional to 1/d², and the balance heuristic combines both.

use super::lit_interval::LitInterval;
use super::sample::{EmittedSpd, LeRandoms, LeSample, LiSample, RepresentativePoint};
use crate::geometry::{Geometry, Ray};
use crate::medium::Medium;
use crate::motion::AnimatedTransform;
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::math::warp;
use abbe_spectra::spectrum::Spectrum;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// The part of an emitting medium inside one body, or inside the box of a grid medium.
#[derive(Debug, Clone)]
pub struct VolumeLight {
    medium: Medium,
    /// The surface of the body, or `None` if the medium's own box bounds the medium.
    body: Option<Arc<Geometry>>,
    /// From the unit cube to a box around the emitting part.
    from_unit: DAffine3,
    /// Selects a cell of the box. The x index of the cells varies fastest.
    cells: DiscreteDistribution,
    power_w: f64,
    spectrum: Spectrum,
}

/// The number of cells along each side of the box.
const CELLS: usize = 32;

/// The number of probes along each side of a cell.
const PROBES: usize = 4;

const PROBED: usize = CELLS * PROBES;

/// The distance between a row of probes and the ray along it, divided by the distance between two
/// probes, which keeps the ray from running along an edge of a mesh.
const BESIDE: f64 = 1e-6;

/// A direction that is unlikely to be parallel to an edge or a face.
const OBLIQUE: DVec3 = DVec3::new(0.391_827, 0.803_153, 0.448_713);

/// The fraction of the points that are sampled uniformly over all cells.
const DEFENSIVE_FRACTION: f64 = 0.05;

/// Points are near the box up to this distance, as a fraction of its sides.
const NEAR: f64 = 0.5;

struct VolumeSample {
    position: DVec3,
    /// In W over the band, divided by the pdf of the sample.
    flux_w: f64,
    spd: EmittedSpd,
}

/// The measurements in a layer of cells.
struct ProbedLayer {
    /// The sum over the probes of each cell. The x index varies fastest.
    emitted: Vec<f64>,
    /// The temperature in K and the density at each probe with thermal emission.
    by_temperature: Vec<(f64, f64)>,
}

impl VolumeLight {
    /// The light transformed by a map of the scene's positions. Only the box of a grid medium can
    /// move; a body that contains an emitting medium cannot.
    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        Self { medium: self.medium.moved(map), from_unit: *map * self.from_unit, ..self.clone() }
    }

    pub fn motion(&self) -> Option<&AnimatedTransform> {
        self.medium.motion.as_ref()
    }

    pub fn medium_name(&self) -> &String {
        &self.medium.name
    }

    /// Creates the light of an emitting medium, or returns `None` if it emits nothing in the band.
    ///
    /// `from_unit` maps the unit cube to a box (m, relative to the scene's centre) around the
    /// emitting part. `body` contains the surface and the volume in m³ of the body around the
    /// medium, or is `None` if the box itself bounds the medium.
    pub fn new(medium: &Medium, from_unit: DAffine3, body: Option<(Arc<Geometry>, f64)>) -> Option<Self> {
        let emission = medium.emission.as_ref()?;
        let (body, body_volume) = body.unzip();
        let mut light = Self {
            medium: medium.clone(),
            body,
            from_unit,
            cells: DiscreteDistribution::new([1.0])?,
            power_w: 0.0,
            spectrum: Spectrum::constant(0.0),
        };
        let layers: Vec<_> = (0..CELLS).into_par_iter().map(|layer| light.probe_layer(layer)).collect();
        let emitted: Vec<f64> = layers.iter().flat_map(|layer| &layer.emitted).copied().collect();
        let sum: f64 = emitted.iter().sum();
        let mean = sum / emitted.len() as f64;
        // A cell dark at its probes may contain a part of the body, so none has probability 0.
        let fractions = emitted.iter().map(|here| (1.0 - DEFENSIVE_FRACTION) * here + DEFENSIVE_FRACTION * mean);
        light.cells = DiscreteDistribution::new(fractions)?;
        let probed_m3 = light.box_m3() / (PROBED as f64).powi(3);
        light.power_w = 4.0
            * PI
            * match (body_volume, medium.is_uniform()) {
                (Some(volume), true) => volume * emission.band_at(DVec3::ZERO).0,
                (Some(_) | None, _) => sum * probed_m3,
            };
        let spectrum = emission.mean_spectrum(layers.into_iter().flat_map(|layer| layer.by_temperature));
        let integral = spectrum.integral();
        light.spectrum = spectrum.scaled(1.0 / integral);
        (light.power_w > 0.0 && integral > 0.0).then_some(light)
    }

    fn probe_layer(&self, layer: usize) -> ProbedLayer {
        let mut probed = ProbedLayer { emitted: vec![0.0; CELLS.pow(2)], by_temperature: Vec::new() };
        let Some(emission) = &self.medium.emission else { return probed };
        for row in 0..PROBED * PROBES {
            let (y, z) = (row % PROBED, row / PROBED + PROBES * layer);
            let points = [0, 1].map(|x| self.probe([x, y, z]));
            let inside = self.inside_along(points[0], points[1] - points[0]);
            for x in (0..PROBED).filter(|&x| inside[x]) {
                let point = self.probe([x, y, z]);
                let density = self.medium.density_at(point);
                if density <= 0.0 {
                    continue;
                }
                let (band, temperature) = emission.band_at(point);
                if density * band > 0.0 {
                    probed.emitted[x / PROBES + CELLS * (y / PROBES)] += density * band;
                    probed.by_temperature.extend(temperature.map(|temperature| (temperature, density)));
                }
            }
        }
        probed
    }

    /// The mean spectrum of the emission, with integral 1 over the band.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// In W over the band, before absorption inside the medium.
    pub fn power_w(&self) -> f64 {
        self.power_w
    }

    /// A point at which the emission is strong.
    pub(super) fn representative_point(&self) -> RepresentativePoint {
        let samples = (0..64).map(|i| self.sample([(f64::from(i) + 0.5) / 64.0, 0.37, 0.61]));
        let brightest = samples.max_by(|a, b| a.flux_w.total_cmp(&b.flux_w));
        let position = brightest.map_or(self.from_unit.translation, |sample| sample.position);
        RepresentativePoint { position, surface: None }
    }

    /// The relative spectrum of the emission at a temperature in K, per nm.
    pub(super) fn spd_at(&self, temperature: f64, nm: f64) -> f64 {
        self.medium.emission.as_ref().map_or(0.0, |emission| emission.spd_at(temperature, nm))
    }

    pub(super) fn sample_le(&self, u: LeRandoms) -> LeSample {
        let VolumeSample { position, flux_w, spd } = self.sample(u.rest);
        LeSample { origin: position, direction: warp::sphere(u.aim), from: None, flux_w, spd }
    }

    pub(super) fn box_map(&self) -> DAffine3 {
        self.from_unit
    }

    pub(super) fn sample_le_through(&self, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let VolumeSample { position, flux_w, spd } = self.sample(u.rest);
        let (direction, solid_angle) = sphere.sample_direction(position, u.aim);
        LeSample { origin: position, direction, from: None, flux_w: flux_w * solid_angle / (4.0 * PI), spd }
    }

    /// Samples a direction towards a point of the medium, a point light of the sampled flux.
    pub(super) fn sample_li(&self, from: DVec3, [u, v, w]: [f64; 3]) -> Option<LiSample> {
        let to_unit = self.from_unit.inverse();
        let local = to_unit.transform_point3(from);
        let is_near = (local - 0.5).abs().max_element() < 0.5 + NEAR;
        let (position, cell) = if is_near && u >= 0.5 {
            let direction = warp::sphere([v, w]);
            let (first, last) = chord(local, to_unit.transform_vector3(direction))?;
            let position = from + (first + rest_of_half(u) * (last - first)) * direction;
            (position, cell_of(to_unit.transform_point3(position)))
        } else {
            self.sample_cell([rest_of_half(u), v, w])
        };
        let (emission, spd) = self.emission_at(position)?;
        let (direction, distance) = (position - from).normalize_and_length();
        let d2 = distance * distance;
        let of_cell = d2 * self.cells.probability(cell) / self.cell_m3();
        // The densities per unit of solid angle and of distance.
        let pdf = if is_near {
            let (first, last) = chord(local, to_unit.transform_vector3(direction))?;
            0.5 * of_cell + 0.5 / (4.0 * PI * (last - first))
        } else {
            of_cell
        };
        let irradiance = emission / pdf;
        (irradiance > 0.0 && irradiance.is_finite()).then_some(LiSample {
            direction,
            distance,
            target: None,
            irradiance,
            pdf_solid_angle: None,
            spd,
        })
    }

    /// The pivot is the point that [`Self::sample_li`] selects by its cell with the same numbers.
    pub(super) fn lit_interval(&self, (from, to): (f64, f64), [u, v, w]: [f64; 3]) -> LitInterval {
        LitInterval { from, to, pivot: Some(self.sample_cell([rest_of_half(u), v, w]).0) }
    }

    fn sample(&self, u: [f64; 3]) -> VolumeSample {
        let (position, cell) = self.sample_cell(u);
        match self.emission_at(position) {
            Some((emission, spd)) => {
                let flux_w = 4.0 * PI * emission * self.cell_m3() / self.cells.probability(cell);
                VolumeSample { position, flux_w, spd }
            }
            None => VolumeSample { position, flux_w: 0.0, spd: EmittedSpd::Own },
        }
    }

    /// Samples a cell and a point in it.
    fn sample_cell(&self, [mut u, v, w]: [f64; 3]) -> (DVec3, usize) {
        let cell = self.cells.sample(&mut u);
        let corner = DVec3::new((cell % CELLS) as f64, (cell / CELLS % CELLS) as f64, (cell / (CELLS * CELLS)) as f64);
        (self.from_unit.transform_point3((corner + DVec3::new(u, v, w)) / CELLS as f64), cell)
    }

    /// Returns the radiance per length (W/m³/sr over the band) that the medium emits at a point.
    fn emission_at(&self, position: DVec3) -> Option<(f64, EmittedSpd)> {
        let density = self.medium.density_at(position);
        let emission = self.medium.emission.as_ref().filter(|_| density > 0.0 && self.contains(position))?;
        let (band, temperature) = emission.band_at(position);
        // The spectrum of cold matter is not defined.
        (band > 0.0).then(|| (density * band, temperature.map_or(EmittedSpd::Own, EmittedSpd::Thermal)))
    }

    fn cell_m3(&self) -> f64 {
        self.box_m3() / (CELLS.pow(3)) as f64
    }

    fn box_m3(&self) -> f64 {
        self.from_unit.matrix3.determinant().abs()
    }

    fn probe(&self, place: [usize; 3]) -> DVec3 {
        let [x, y, z] = place.map(|place| place as f64 + 0.5);
        self.from_unit.transform_point3(DVec3::new(x, y, z) / PROBED as f64)
    }

    /// Returns whether each probe of a row lies inside, by one ray along the row.
    fn inside_along(&self, first: DVec3, step: DVec3) -> [bool; PROBED] {
        let Some(body) = &self.body else { return [true; PROBED] };
        let (direction, spacing) = step.normalize_and_length();
        let beside = BESIDE * spacing * OBLIQUE;
        let mut crossings = Vec::new();
        body.for_each_hit(&Ray::new(first + beside, direction), None, |hit| {
            crossings.push((hit.t, leaves(hit.normal, direction)));
        });
        std::array::from_fn(|x| {
            let ahead = crossings.iter().filter(|(t, _)| *t > x as f64 * spacing);
            ahead.map(|(_, leaves)| leaves).sum::<i32>() > 0
        })
    }

    /// Returns true if a ray from the point leaves the body more often than it enters it.
    fn contains(&self, point: DVec3) -> bool {
        let Some(body) = &self.body else { return true };
        let direction = OBLIQUE.normalize();
        let mut balance = 0;
        body.for_each_hit(&Ray::new(point, direction), None, |hit| balance += leaves(hit.normal, direction));
        balance > 0
    }
}

/// Maps each half of [0, 1) to all of it.
fn rest_of_half(u: f64) -> f64 {
    if u < 0.5 { 2.0 * u } else { 2.0 * u - 1.0 }
}

/// Returns the number of the cell that contains a point of the unit cube.
fn cell_of(point: DVec3) -> usize {
    let [x, y, z] = (point * CELLS as f64).to_array().map(|x| (x.max(0.0) as usize).min(CELLS - 1));
    x + CELLS * (y + CELLS * z)
}

/// Returns the interval of a ray inside the unit cube, or `None` if the ray misses it.
fn chord(origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
    let (to_low, to_high) = (-origin / direction, (1.0 - origin) / direction);
    let first = to_low.min(to_high).max_element().max(0.0);
    let last = to_low.max(to_high).min_element();
    (last > first).then_some((first, last))
}

/// Returns 1 if a ray leaves the body at a surface with this normal, and −1 if it enters the body.
fn leaves(normal: DVec3, direction: DVec3) -> i32 {
    if normal.dot(direction) > 0.0 { 1 } else { -1 }
}
