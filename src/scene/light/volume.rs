//! A glowing medium as a light: hot soot, a neon tube.
//!
//! Places are drawn from the cells of a box around it, in proportion to what the cells emit; directions are drawn uniformly. A small
//! share of the places is drawn from all cells alike, so that nothing that a cell's few probes missed is left out.

use super::{Emission, EmissionNumbers, Incident, Tint};
use crate::math::distribution::Discrete;
use crate::math::warp;
use crate::scene::geometry::{Geometry, Ray};
use crate::scene::medium::Medium;
use crate::scene::motion::Motion;
use crate::spectrum::Spectrum;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// The part of a medium that one body, or the box of a grid, holds.
#[derive(Debug, Clone)]
pub struct Volume {
    medium: Medium,
    /// The body that holds it; `None` where the medium's own box does.
    body: Option<Arc<Geometry>>,
    /// From the unit cube to a box around all of it.
    from_unit: DAffine3,
    /// How likely each of the box's cells is drawn, x fastest.
    cells: Discrete,
    power_w: f64,
    spectrum: Spectrum,
}

/// Cells along each side of the box, and probes along each side of a cell.
const CELLS: usize = 32;
const PROBES: usize = 4;

/// The share of the places that is drawn from all cells alike.
const DEFENSIVE_SHARE: f64 = 0.05;

impl Volume {
    /// The light after a map of the scene's places; only boxes of their own move.
    pub(super) fn moved(&self, map: &DAffine3) -> Self {
        Self { medium: self.medium.moved(map), from_unit: *map * self.from_unit, ..self.clone() }
    }

    /// How its medium moves, if it does.
    pub fn motion(&self) -> Option<&Motion> {
        self.medium.motion.as_ref()
    }

    /// The name of its medium.
    pub fn medium_name(&self) -> &String {
        &self.medium.name
    }

    /// The light of a medium that glows within the box onto which `from_unit` maps the unit cube (into the scene, m). `body` is what
    /// holds it, with its volume in m³, if it is not the box itself. `None` where nothing of it shines in the band.
    pub fn new(medium: &Medium, from_unit: DAffine3, body: Option<(Arc<Geometry>, f64)>) -> Option<Self> {
        let glow = medium.emission.as_ref()?;
        let (body, body_volume) = body.unzip();
        let mut light = Self {
            medium: medium.clone(),
            body,
            from_unit,
            cells: Discrete::new([1.0])?,
            power_w: 0.0,
            spectrum: Spectrum::constant(0.0),
        };
        let mut by_temperature = Vec::new();
        let mut emitted = vec![0.0; CELLS.pow(3)];
        let side = (CELLS * PROBES) as f64;
        let cell_of = |probe: DVec3| {
            let [x, y, z] = (probe / PROBES as f64).to_array().map(|place| place as usize);
            x + CELLS * (y + CELLS * z)
        };
        for number in 0..(CELLS * PROBES).pow(3) {
            let n = CELLS * PROBES;
            let probe = DVec3::new((number % n) as f64, (number / n % n) as f64, (number / (n * n)) as f64) + 0.5;
            let point = from_unit.transform_point3(probe / side);
            let (density, (band, temperature)) = (medium.density_at(point), glow.band_at(point));
            if density * band > 0.0 && light.holds(point) {
                emitted[cell_of(probe)] += density * band;
                by_temperature.extend(temperature.map(|temperature| (temperature, density)));
            }
        }
        let sum: f64 = emitted.iter().sum();
        let mean = sum / emitted.len() as f64;
        // Cells beside one that shines may be cut by the body's surface.
        let shares = emitted.iter().map(|here| (1.0 - DEFENSIVE_SHARE) * here + DEFENSIVE_SHARE * mean);
        light.cells = Discrete::new(shares)?;
        let probed_m3 = light.box_m3() / side.powi(3);
        light.power_w = 4.0
            * PI
            * match (body_volume, medium.is_uniform()) {
                (Some(volume), true) => volume * glow.band_at(DVec3::ZERO).0,
                (Some(_) | None, _) => sum * probed_m3,
            };
        let spectrum = glow.mean_spectrum(by_temperature.into_iter());
        let integral = spectrum.integral();
        light.spectrum = spectrum.scaled(1.0 / integral);
        (light.power_w > 0.0 && integral > 0.0).then_some(light)
    }

    /// The shape of the spectrum of all of it: integral 1 over the band.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// The power in W over the band, self-absorption left aside.
    pub fn power_w(&self) -> f64 {
        self.power_w
    }

    /// A place in it that shines, to tell which bodies are around it.
    pub fn typical_place(&self) -> DVec3 {
        let places = (0..64).map(|i| self.draw([(f64::from(i) + 0.5) / 64.0, 0.37, 0.61]));
        let brightest = places.max_by(|a, b| a.1.total_cmp(&b.1));
        brightest.map_or(self.from_unit.translation, |(place, ..)| place)
    }

    /// The density per nm of the light from a place of this temperature.
    pub(super) fn shape_at(&self, temperature: f64, nm: f64) -> f64 {
        self.medium.emission.as_ref().map_or(0.0, |glow| glow.shape_at(temperature, nm))
    }

    pub(super) fn emit(&self, u: EmissionNumbers) -> Emission {
        let (origin, flux_w, tint) = self.draw(u.rest);
        Emission { origin, direction: warp::sphere(u.aim), from: None, flux_w, tint }
    }

    /// Towards a place in it, as if its whole power came from there.
    pub(super) fn towards(&self, from: DVec3, u: [f64; 3]) -> Option<Incident> {
        let (place, flux_w, tint) = self.draw(u);
        let (direction, distance) = (place - from).normalize_and_length();
        let irradiance = flux_w / (4.0 * PI * distance * distance);
        (irradiance > 0.0 && irradiance.is_finite()).then_some(Incident {
            direction,
            distance,
            target: None,
            irradiance,
            pdf_solid_angle: None,
            tint,
        })
    }

    /// Draws a place; with it the flux in W over the band, divided by the density of the draw, and the colour.
    pub(super) fn draw(&self, [mut u, v, w]: [f64; 3]) -> (DVec3, f64, Tint) {
        let cell = self.cells.sample(&mut u);
        let corner = DVec3::new((cell % CELLS) as f64, (cell / CELLS % CELLS) as f64, (cell / (CELLS * CELLS)) as f64);
        let place = self.from_unit.transform_point3((corner + DVec3::new(u, v, w)) / CELLS as f64);
        let density = self.medium.density_at(place);
        let Some(glow) = self.medium.emission.as_ref().filter(|_| density > 0.0 && self.holds(place)) else {
            return (place, 0.0, Tint::Own);
        };
        let (band, temperature) = glow.band_at(place);
        // Where nothing shines there is no colour either.
        if band <= 0.0 {
            return (place, 0.0, Tint::Own);
        }
        let cell_m3 = self.box_m3() / (CELLS.pow(3)) as f64;
        let flux_w = 4.0 * PI * density * band * cell_m3 / self.cells.probability(cell);
        (place, flux_w, temperature.map_or(Tint::Own, Tint::Thermal))
    }

    fn box_m3(&self) -> f64 {
        self.from_unit.matrix3.determinant().abs()
    }

    /// Whether a point lies in the body: a ray from there leaves it more often than it enters.
    fn holds(&self, point: DVec3) -> bool {
        let Some(body) = &self.body else { return true };
        let direction = DVec3::new(0.391_827, 0.803_153, 0.448_713).normalize();
        let mut leaves = 0;
        body.for_each_hit(&Ray::new(point, direction), None, |hit| {
            leaves += if hit.normal.dot(direction) > 0.0 { 1 } else { -1 };
        });
        leaves > 0
    }
}
