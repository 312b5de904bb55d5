//! The phase function of ice crystals that prefer an orientation while they fall.
//!
//! Plates fall with a vertical axis, columns with a horizontal axis (Greenler 1980, *Rainbows,
//! Halos, and Glories*; Tape 1994, *Atmospheric Halos*). Their light makes sundogs, the parhelic
//! circle, the circumzenithal arc, tangent arcs, pillars and the subsun. Rays are traced through
//! crystals before the first event of light, for light of some elevations, among them those of the
//! scene's distant lights. The vertical is the y axis of the scene.
//!
//! Between two elevations, the pdf is a mixture of two tables. The sine z of the elevation of the
//! scattered light is stretched, so that light which keeps the elevation of the incident light, or
//! reverses it, does so for both tables. Diffraction is that of [`ice`](super::ice()): as much
//! light as a crystal intercepts is diffracted forwards.

use super::crystal::{Crystal, evenly_spread};
use super::direction_table::{DirectionGrid, DirectionTable, Windows};
use super::ice::{angles, diffraction};
use super::table::PhaseTable;
use super::{Deflection, PhaseFunction, ice};
use crate::glass::RefractiveIndex;
use abbe_spectra::math::elementary::{acos, cos, ln, sin, sin_cos};
use abbe_spectra::math::frame::Frame;
use abbe_spectra::math::warp;
use glam::{DMat3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

/// The wavelengths in nm of the tables of regular elevations. Between them, tables are mixed.
const NM: [f64; 5] = [420.0, 475.0, 530.0, 590.0, 660.0];

/// The same for elevations of distant lights, so close that the edge of a sundog is sharp.
const FINE_NM: [f64; 13] = [420.0, 440.0, 460.0, 480.0, 500.0, 520.0, 540.0, 560.0, 580.0, 600.0, 620.0, 640.0, 660.0];

/// The elevations in degrees for which all tables are computed.
const ELEVATION_STEP_DEG: f64 = 3.0;

/// How accurate a table is.
#[derive(Debug, Clone, Copy)]
struct Effort {
    nm: &'static [f64],
    /// Steps of 180° in elevation.
    rows: usize,
    /// Steps of 180° in azimuth.
    columns: usize,
    rays: u32,
    /// The effective rays of a smoothed node.
    smoothing: f64,
}

/// For the regular elevations and for those of distant lights.
const EFFORTS: [Effort; 2] = [
    Effort { nm: &NM, rows: 360, columns: 360, rays: 12_000, smoothing: 600.0 },
    Effort { nm: &FINE_NM, rows: 720, columns: 1440, rays: 400_000, smoothing: 600.0 },
];

/// Directions that are sampled against the light follow the table of the reversed light, mixed with
/// this fraction of uniform directions: the tables of both directions of a path differ slightly.
const UNIFORM_FRACTION: f64 = 0.2;

/// How a population of crystals falls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IceOrientation {
    /// In all orientations, with the lengths of [`ice`](super::ice()).
    Random,
    /// With a vertical axis.
    Plates(PrismShape),
    /// With a horizontal axis, in all rotations about it.
    Columns(PrismShape),
    /// With a horizontal axis and two horizontal side faces (Parry 1821).
    Parry(PrismShape),
}

/// The shape and the tilt of hexagonal prisms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrismShape {
    /// Length divided by the width from corner to corner, above 0.
    pub length_to_width: f64,
    /// Standard deviation in rad of the tilt about each axis.
    pub tilt: f64,
}

/// Crystals, and the fraction of the scattered light that they scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IcePopulation {
    /// The shape and the orientation.
    pub orientation: IceOrientation,
    /// At least 0; at any scale.
    pub weight: f64,
}

/// The phase function of populations of ice crystals.
#[derive(Debug)]
pub struct OrientedIce {
    populations: Vec<IcePopulation>,
    sun_sines: Vec<f64>,
    /// Computed at the first use, because a scene that is only checked does not need them.
    tables: OnceLock<IceTables>,
}

impl PartialEq for OrientedIce {
    fn eq(&self, other: &Self) -> bool {
        (&self.populations, &self.sun_sines) == (&other.populations, &other.sun_sines)
    }
}

impl OrientedIce {
    /// One thread computes the tables: if others helped, the pool might give it a task that waits
    /// for them.
    pub(super) fn tables(&self) -> &IceTables {
        self.tables.get_or_init(|| IceTables::new(&self.populations, &self.sun_sines, EFFORTS))
    }
}

/// The tables of all elevations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct IceTables {
    /// The fraction of the light that crystals in all orientations scatter.
    random: f64,
    all_orientations: Arc<PhaseTable>,
    forward: PhaseTable,
    grids: [(DirectionGrid, &'static [f64]); 2],
    /// By ascending elevation, from 0 to 90°.
    nodes: Vec<Elevation>,
}

/// The light that crystals scatter if it arrives at one elevation.
#[derive(Debug, Clone, PartialEq)]
struct Elevation {
    sine: f64,
    /// The number of the grid and the wavelengths of the tables.
    grid: usize,
    /// The area that crystals turn to this light, relative to the mean over all directions.
    area: f64,
    /// For each wavelength, the fraction of the light that is diffracted or not deviated.
    forward: Vec<f64>,
    tables: Vec<DirectionTable>,
}

/// Returns the phase function of populations of ice crystals, of which one has a weight above 0.
/// `sun_sines` are the sines of the elevations of distant lights, for which it is most accurate.
pub fn ice_crystals(populations: &[IcePopulation], sun_sines: &[f64]) -> PhaseFunction {
    /// The phase functions in use. Scenes are resolved more than once.
    static KNOWN: Mutex<Vec<Weak<OrientedIce>>> = Mutex::new(Vec::new());
    let populations: Vec<IcePopulation> = populations.iter().copied().filter(|it| it.weight > 0.0).collect();
    if populations.iter().all(|it| it.orientation == IceOrientation::Random) {
        return PhaseFunction::Table(ice());
    }
    let ice = OrientedIce { populations, sun_sines: sun_sines.to_vec(), tables: OnceLock::new() };
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    known.retain(|phase| phase.strong_count() > 0);
    if let Some(same) = known.iter().filter_map(Weak::upgrade).find(|phase| **phase == ice) {
        return PhaseFunction::Oriented(same);
    }
    let phase = Arc::new(ice);
    known.push(Arc::downgrade(&phase));
    PhaseFunction::Oriented(phase)
}

impl IceTables {
    fn new(populations: &[IcePopulation], sun_sines: &[f64], efforts: [Effort; 2]) -> Self {
        let weight = |it: &IcePopulation| it.weight;
        let total: f64 = populations.iter().map(weight).sum();
        let is_random = |it: &&IcePopulation| it.orientation == IceOrientation::Random;
        let random = populations.iter().filter(is_random).map(weight).sum::<f64>() / total;
        let oriented: Vec<IcePopulation> = populations
            .iter()
            .filter(|it| !is_random(it))
            .map(|it| IcePopulation { weight: it.weight / (total * (1.0 - random)), ..*it })
            .collect();
        let suns = sun_sines.iter().map(|sine| (sine.abs().min(1.0), 1));
        let steps = (90.0 / ELEVATION_STEP_DEG) as u32;
        let sine = |i: u32| if i == steps { 1.0 } else { sin((ELEVATION_STEP_DEG * f64::from(i)).to_radians()) };
        let mut elevations: Vec<(f64, usize)> = suns.chain((0..=steps).map(|i| (sine(i), 0))).collect();
        elevations.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        elevations.dedup_by(|next, kept| next.0 == kept.0);
        let grids = efforts.map(|effort| (DirectionGrid::new(effort.rows, effort.columns), effort.nm));
        let index = RefractiveIndex::catalogue("ice -7C").expect("ice is in the catalogue");
        let indices = |nm: f64| index.n(nm);
        let node = |&(sine, grid): &(f64, usize)| {
            Elevation::new(&oriented, sine, (grid, &grids[grid].0, efforts[grid]), &indices)
        };
        let mut nodes: Vec<Elevation> = elevations.iter().map(node).collect();
        make_reciprocal(&mut nodes, &grids);
        let columns: Vec<Vec<f64>> = NM.iter().map(|&nm| diffraction(nm)).collect();
        let forward = PhaseTable::new(&angles(), &NM, &columns).expect("angles and values of diffraction");
        Self { random, all_orientations: ice(), forward, grids, nodes }
    }

    /// Returns the pdf per steradian of the light's directions.
    pub(super) fn eval(&self, deflection: Deflection, nm: f64) -> f64 {
        self.mixed(deflection, nm, 0.0)
    }

    /// Returns the pdf of [`sample_reversed`](Self::sample_reversed).
    pub(super) fn reversed_pdf(&self, deflection: Deflection, nm: f64) -> f64 {
        self.mixed(deflection, nm, UNIFORM_FRACTION)
    }

    pub(super) fn sample(&self, incoming: DVec3, nm: f64, u: [f64; 2]) -> DVec3 {
        self.sample_mixed(incoming, nm, u, 0.0)
    }

    /// Samples the direction in which a path continues against the light.
    pub(super) fn sample_reversed(&self, incoming: DVec3, nm: f64, u: [f64; 2]) -> DVec3 {
        self.sample_mixed(incoming, nm, u, UNIFORM_FRACTION)
    }

    fn mixed(&self, deflection: Deflection, nm: f64, uniform: f64) -> f64 {
        let Deflection { cos_theta, .. } = deflection;
        let (sine, phi, z) = deflection.about_vertical();
        let (mut forward, mut scattered) = (0.0, 0.0);
        for (node, share) in self.around(sine) {
            let (z, slope) = stretched(z, sine, node.sine);
            let (grid, wavelengths) = &self.grids[node.grid];
            for (column, of_column) in columns(wavelengths, nm) {
                let weight = share * of_column;
                if weight == 0.0 {
                    continue;
                }
                forward += weight * node.forward[column];
                let table = node.tables[column].eval(grid, phi, z) * slope;
                let pdf = (1.0 - uniform) * table + uniform * (0.25 / PI);
                scattered += weight * (1.0 - node.forward[column]) * pdf;
            }
        }
        let oriented = forward * self.forward.eval(cos_theta, nm) + scattered;
        if self.random == 0.0 {
            return oriented;
        }
        self.random * self.all_orientations.eval(cos_theta, nm) + (1.0 - self.random) * oriented
    }

    fn sample_mixed(&self, incoming: DVec3, nm: f64, [mut u, mut v]: [f64; 2], uniform: f64) -> DVec3 {
        let around = |versine: f64, v: f64| Frame::new(incoming).to_world(warp::spherical_direction(versine, v));
        if chosen(&mut u, self.random) {
            return around(self.all_orientations.quantile(nm, u), v);
        }
        let sine = incoming.y.abs().min(1.0);
        let [first, second] = self.around(sine);
        let (node, _) = if chosen(&mut u, second.1) { second } else { first };
        let (grid, wavelengths) = &self.grids[node.grid];
        let [first, second] = columns(wavelengths, nm);
        let (column, _) = if chosen(&mut u, second.1) { second } else { first };
        if chosen(&mut u, node.forward[column]) {
            return around(self.forward.quantile(nm, u), v);
        }
        if chosen(&mut u, uniform) {
            return warp::sphere([u, v]);
        }
        let mirrored = chosen(&mut v, 0.5);
        let (phi, z) = node.tables[column].sample(grid, [u, v]);
        let (z, _) = stretched(z, node.sine, sine);
        let across = DVec3::new(incoming.x, 0.0, incoming.z).try_normalize().unwrap_or(DVec3::X);
        let (sin_phi, cos_phi) = sin_cos(if mirrored { -phi } else { phi });
        let level = cos_phi * across + sin_phi * DVec3::Y.cross(across);
        let radius = (1.0 - z * z).max(0.0).sqrt();
        level * radius + DVec3::Y * (z * 1.0_f64.copysign(incoming.y))
    }

    /// Returns the tables below and above the sine of an elevation, and their weights.
    fn around(&self, sine: f64) -> [(&Elevation, f64); 2] {
        around(&self.nodes, sine).map(|(number, weight)| (&self.nodes[number], weight))
    }
}

/// Returns the numbers of the tables below and above the sine of an elevation, and their weights.
fn around(nodes: &[Elevation], sine: f64) -> [(usize, f64); 2] {
    between(nodes, |node| node.sine, sine)
}

/// Returns the indices of the ascending keys below and above a value, and their weights.
fn between<T>(list: &[T], key: impl Fn(&T) -> f64, value: f64) -> [(usize, f64); 2] {
    let after = list.partition_point(|item| key(item) <= value).clamp(1, list.len() - 1);
    let [below, above] = [after - 1, after].map(|index| key(&list[index]));
    let weight = ((value - below) / (above - below)).clamp(0.0, 1.0);
    [(after - 1, 1.0 - weight), (after, weight)]
}

/// Scales the scattered light by a function of its elevation, so that the pdf is reciprocal.
///
/// Crystals turn different areas to light of different elevations, but a medium has one scattering
/// coefficient. The pdf is therefore σ(ω → ω') x(ω) x(ω'), where σ is the reciprocal cross-section,
/// and x the function of the elevation for which the integral over ω' is 1 (Sinkhorn 1967). By its
/// symmetry, the integral over ω is 1 as well, so that uniform light stays uniform.
fn make_reciprocal(nodes: &mut [Elevation], grids: &[(DirectionGrid, &'static [f64]); 2]) {
    const STEPS: u32 = 200;
    // Of the light of one elevation, the fractions that leave near each elevation.
    let leaving = |number: usize, column: usize| {
        let (node, forward) = (&nodes[number], nodes[number].forward[column]);
        let mut fractions = vec![0.0; nodes.len()];
        fractions[number] = forward;
        for (z, probability) in node.tables[column].rows(&grids[node.grid].0) {
            for (to, weight) in around(nodes, z.abs()) {
                fractions[to] += (1.0 - forward) * probability * weight;
            }
        }
        fractions
    };
    let sum = |fractions: &[f64], scales: &[f64]| -> f64 {
        fractions.iter().zip(scales).map(|(fraction, scale)| fraction * scale).sum()
    };
    let scales_of = |nm: f64| {
        let of_node = |number: usize| leaving(number, nearest_column(grids[nodes[number].grid].1, nm));
        let fractions: Vec<Vec<f64>> = (0..nodes.len()).map(of_node).collect();
        let mut scales = vec![1.0; nodes.len()];
        for _ in 0..STEPS {
            let next =
                |number: usize| (scales[number] / (nodes[number].area * sum(&fractions[number], &scales))).sqrt();
            scales = (0..nodes.len()).map(next).collect();
        }
        scales
    };
    let scales = NM.map(scales_of);
    let scaled = |number: usize, column: usize| {
        let (grid, wavelengths) = &grids[nodes[number].grid];
        let scales = &scales[nearest_column(&NM, wavelengths[column])];
        let at = |z: f64| around(nodes, z.abs()).map(|(number, weight)| weight * scales[number]).iter().sum();
        let forward = nodes[number].forward[column] * scales[number] / sum(&leaving(number, column), scales);
        (forward, nodes[number].tables[column].scaled_rows(grid, at))
    };
    let of_node = |number: usize| (0..nodes[number].tables.len()).map(|column| scaled(number, column)).collect();
    let all: Vec<Vec<(f64, Vec<f32>)>> = (0..nodes.len()).map(of_node).collect();
    for (node, columns) in nodes.iter_mut().zip(all) {
        for ((forward, table), (scaled, rows)) in node.forward.iter_mut().zip(&mut node.tables).zip(columns) {
            *forward = scaled;
            table.set_rows(rows);
        }
    }
}

impl Deflection {
    /// Returns the sine of the elevation of the incident light, mirrored so that it is at least 0,
    /// and the azimuth and the sine of the elevation of the scattered light.
    fn about_vertical(self) -> (f64, f64, f64) {
        let sine = self.arriving_y.abs().min(1.0);
        let z = (self.leaving_y * 1.0_f64.copysign(self.arriving_y)).clamp(-1.0, 1.0);
        let across = ((1.0 - sine * sine) * (1.0 - z * z)).sqrt();
        // Vertical light has no azimuth, and its table does not vary with it.
        let cosine = if across > 0.0 { (self.cos_theta - sine * z) / across } else { 0.0 };
        (sine, acos(cosine.clamp(-1.0, 1.0)), z)
    }
}

/// Stretches −1, −`from`, `from`, 1 to −1, −`to`, `to`, 1, linearly between them. Returns the new
/// value and the slope.
fn stretched(z: f64, from: f64, to: f64) -> (f64, f64) {
    if z.abs() >= from && from < 1.0 {
        let slope = (1.0 - to) / (1.0 - from);
        ((1.0 - (1.0 - z.abs()) * slope).copysign(z), slope)
    } else {
        let slope = to / from;
        (z * slope, slope)
    }
}

/// Returns the columns next to a wavelength in nm, and their weights.
fn columns(wavelengths: &[f64], nm: f64) -> [(usize, f64); 2] {
    between(wavelengths, |&known| known, nm)
}

/// Returns the column that is nearest to a wavelength in nm.
fn nearest_column(wavelengths: &[f64], nm: f64) -> usize {
    let [below, above] = columns(wavelengths, nm);
    if above.1 > 0.5 { above.0 } else { below.0 }
}

/// Returns a wavelength in nm between the columns `after` − 1 and `after`, or as far beyond the
/// ends.
fn nm_between(wavelengths: &[f64], after: usize, t: f64) -> f64 {
    let of_step = after.clamp(1, wavelengths.len() - 1);
    let width = wavelengths[of_step] - wavelengths[of_step - 1];
    if after == 0 { wavelengths[0] - width * (1.0 - t) } else { wavelengths[after - 1] + width * t }
}

/// Decides an event of this probability by `u` in [0, 1), which becomes a new number.
fn chosen(u: &mut f64, probability: f64) -> bool {
    let happens = *u < probability;
    *u = if happens { *u / probability } else { (*u - probability) / (1.0 - probability) };
    *u = u.min(abbe_spectra::math::random::ONE_MINUS_ULP);
    happens
}

impl IceOrientation {
    /// Returns the crystals' shape, and the rotation of one crystal by evenly spread numbers.
    fn rotation(self, [turn, a, b, spin]: [f64; 4]) -> DMat3 {
        let deviation = |tilt: f64| tilt * (-2.0 * ln(1.0 - a)).sqrt();
        let (axis, spin) = match self {
            Self::Random => (acos(1.0 - 2.0 * a), TAU * spin),
            Self::Plates(shape) => (deviation(shape.tilt), TAU * spin),
            Self::Columns(shape) => (FRAC_PI_2 + deviation(shape.tilt) * cos(TAU * b), TAU * spin),
            Self::Parry(shape) => {
                let (sin, cos) = sin_cos(TAU * b);
                (FRAC_PI_2 + deviation(shape.tilt) * cos, deviation(shape.tilt) * sin)
            }
        };
        rotation_z(TAU * turn) * rotation_y(axis) * rotation_z(spin)
    }

    fn crystal(self) -> Crystal {
        match self {
            Self::Random => Crystal::new(1.0),
            Self::Plates(shape) | Self::Columns(shape) | Self::Parry(shape) => Crystal::new(shape.length_to_width),
        }
    }
}

fn rotation_z(angle: f64) -> DMat3 {
    let (sin, cos) = sin_cos(angle);
    DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z)
}

fn rotation_y(angle: f64) -> DMat3 {
    let (sin, cos) = sin_cos(angle);
    DMat3::from_cols(DVec3::new(cos, 0.0, -sin), DVec3::Y, DVec3::new(sin, 0.0, cos))
}

/// Calls `visit` with crystals of one population, by the rotation, the direction of the light and
/// the point in the crystal's coordinates, and the area that the light meets. The light travels
/// upwards at an elevation with this sine, with the azimuth 0; z is the vertical here.
fn rays(orientation: IceOrientation, sine: f64, count: u32, mut visit: impl FnMut(DMat3, DVec3, [f64; 3], f64)) {
    let travel = DVec3::new((1.0 - sine * sine).max(0.0).sqrt(), 0.0, sine);
    evenly_spread::<8>(count, |[turn, a, b, spin, u, v, w, shift]| {
        let rotation = orientation.rotation([turn, a, b, spin]);
        visit(rotation, rotation.transpose() * travel, [u, v, w], shift);
    });
}

impl Elevation {
    fn new(
        populations: &[IcePopulation],
        sine: f64,
        (number, grid, effort): (usize, &DirectionGrid, Effort),
        index: &impl Fn(f64) -> f64,
    ) -> Self {
        let wavelengths = effort.nm;
        let mut powers = vec![vec![0.0; grid.nodes()]; wavelengths.len()];
        let mut squares = vec![0.0; grid.nodes()];
        let mut area = 0.0;
        let mut forward = vec![0.0; wavelengths.len()];
        let mut scattered = vec![0.0; wavelengths.len()];
        for &IcePopulation { orientation, weight } in populations {
            let crystal = orientation.crystal();
            let count = (f64::from(effort.rays) * weight).ceil() as u32;
            let of_ray = weight / (f64::from(count) * crystal.mean_area());
            rays(orientation, sine, count, |rotation, travel, u, shift| {
                let (point, face, of_crystal) = crystal.point(travel, u);
                let ray = of_ray * of_crystal;
                area += ray;
                // The ray has one wavelength between each two columns and one beyond each end.
                for after in 0..=wavelengths.len() {
                    let nm = nm_between(wavelengths, after, shift);
                    let of_columns = [(after.wrapping_sub(1), 1.0 - shift), (after, shift)];
                    crystal.trace(index(nm), travel, (point, face), |direction, fraction, _| {
                        let power = ray * fraction;
                        let shares = of_columns.map(|(column, part)| (column, part * power));
                        let shares = shares.into_iter().filter(|(column, _)| *column < wavelengths.len());
                        if (direction - travel).length_squared() < 2e-12 {
                            shares.for_each(|(column, power)| forward[column] += power);
                            return;
                        }
                        let out = rotation * direction;
                        let across = (out.x * out.x + out.y * out.y).sqrt();
                        let phi = acos((out.x / across.max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0));
                        let node = grid.nearest(phi, out.z.clamp(-1.0, 1.0));
                        squares[node] += power * power;
                        for (column, power) in shares {
                            powers[column][node] += power;
                            scattered[column] += power;
                        }
                    });
                }
            });
        }
        for (forward, scattered) in forward.iter_mut().zip(scattered) {
            *forward += area;
            *forward /= *forward + scattered;
        }
        let windows = Windows::new(grid, &powers, &squares, effort.smoothing, sine == 1.0);
        let table = |powers: Vec<f64>| DirectionTable::new(grid, &windows.smoothed(&powers));
        let tables = powers.into_iter().map(table).collect();
        Self { sine, grid: number, area, forward, tables }
    }
}

#[cfg(test)]
#[path = "oriented_tests.rs"]
mod tests;
