//! Participating media: what fog, smoke, milk and flames do to light on its way.
//!
//! A medium's coefficients are functions of wavelength times a density that may vary in space, so that everything that happens
//! along a stretch of a ray hangs on one number, the column density D = ∫ρ ds: the transmittance at every wavelength is
//! exp(−σ_t(λ)·D). Absorption and scattering are stated apart, none negative, so that no albedo exceeds 1.

pub mod field;
pub mod volume_file;

mod glow;

pub use glow::Glow;

use super::geometry::Ray;
use super::motion::Motion;
use crate::optics::phase::Phase;
use crate::spectrum::Spectrum;
use field::Field;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// A medium, placed in the scene. Coefficients are in 1/m at density 1.
#[derive(Debug, Clone)]
pub struct Medium {
    /// Its name for reports.
    pub name: String,
    /// Absorption σ_a.
    pub absorption: Spectrum,
    /// Scattering σ_s.
    pub scattering: Spectrum,
    /// Extinction σ_t = σ_a + σ_s.
    pub extinction: Spectrum,
    /// The least and the largest extinction in the band.
    pub extinction_range: (f64, f64),
    /// The largest scattering coefficient in the band.
    pub scattering_max: f64,
    /// Into which directions it scatters.
    pub phase: Phase,
    /// Where how much of it is.
    pub density: Density,
    /// Whether most light that enters it meets a particle more than a few times.
    pub dense: bool,
    /// How the light that passes is worked out.
    pub transmittance: Transmittance,
    /// The light that it emits by itself.
    pub emission: Option<Glow>,
    /// How it moves while the shutter is open, if it does.
    pub motion: Option<Motion>,
}

/// Density (relative, without unit) as a function of place.
#[derive(Debug, Clone, PartialEq)]
pub enum Density {
    /// 1 everywhere.
    Uniform,
    /// Within a box.
    Field(Arc<Field>),
}

/// How the transmittance of a medium that varies in space is worked out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transmittance {
    /// From the exact column density.
    Exact,
    /// By ratio tracking: unbiased, noisy.
    Ratio,
    /// From the column density by midpoint steps: biased, without noise.
    March {
        /// Steps along a stretch.
        steps: u32,
    },
}

impl Medium {
    /// A medium of these coefficients (1/m at density 1).
    pub fn new(name: String, (absorption, scattering): (Spectrum, Spectrum), phase: Phase, density: Density) -> Self {
        let extinction = Spectrum::mix(&[(1.0, &absorption), (1.0, &scattering)]);
        let transmittance = Transmittance::Exact;
        let extinction_range = (extinction.min(), extinction.max());
        let scattering_max = scattering.max();
        Self {
            scattering_max,
            name,
            absorption,
            scattering,
            extinction,
            extinction_range,
            phase,
            density,
            transmittance,
            dense: false,
            emission: None,
            motion: None,
        }
    }

    /// The medium after a map of the scene's places.
    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        let density = match &self.density {
            Density::Uniform => Density::Uniform,
            Density::Field(field) => Density::Field(Arc::new(field.moved(map))),
        };
        Self { density, emission: self.emission.as_ref().map(|glow| glow.moved(map)), ..self.clone() }
    }

    /// Whether green light that crosses a body of it, `across_m` thin, meets more than a few particles; a medium of a box of its own is judged by that box.
    pub fn is_dense_across(&self, across_m: f64) -> bool {
        /// Mean free paths.
        const DENSE: f64 = 4.0;
        let column_m = match &self.density {
            Density::Uniform => across_m,
            Density::Field(field) => field.least_column_m(),
        };
        self.optical_depth(550.0, column_m) > DENSE
    }

    /// A column density that no straight way through a body of it, `across_m` wide, exceeds, in m.
    pub fn most_column_m(&self, across_m: f64) -> f64 {
        match &self.density {
            Density::Uniform => across_m,
            Density::Field(field) => {
                let corners = field.corners();
                let diagonals = (0..4).map(|i| (corners[7 - i] - corners[i]).length());
                field.max() * across_m.min(diagonals.fold(0.0, f64::max))
            }
        }
    }

    /// Whether it scatters at any wavelength.
    pub fn scatters(&self) -> bool {
        self.scattering_max > 0.0
    }

    /// Whether a grid of so many cells along its longest side is fine enough for a light map.
    pub fn is_smooth_in_cells(&self, cells: u32) -> bool {
        match &self.density {
            Density::Uniform => true,
            Density::Field(field) => field.is_smooth_in_cells(cells),
        }
    }

    /// The density at a point.
    pub fn density_at(&self, point: DVec3) -> f64 {
        match &self.density {
            Density::Uniform => 1.0,
            Density::Field(field) => field.at(point),
        }
    }

    /// The light that it emits at a point, in W/m³/sr/nm.
    pub fn emission_per_m(&self, point: DVec3, nm: f64) -> f64 {
        self.emission.as_ref().map_or(0.0, |glow| {
            let density = self.density_at(point);
            if density > 0.0 { density * glow.at(point, nm) } else { 0.0 }
        })
    }

    /// The largest density along the ray's first `length_m`: the bound of null-collision tracking.
    pub fn majorant(&self, ray: &Ray, length_m: f64) -> f64 {
        match &self.density {
            Density::Uniform => 1.0,
            Density::Field(field) => field.majorant(ray, length_m),
        }
    }

    /// The column density ∫ρ ds in m along the ray's first `length_m` (which may be infinite), exact.
    pub fn column_m(&self, ray: &Ray, length_m: f64) -> f64 {
        match &self.density {
            Density::Uniform => length_m,
            Density::Field(field) => field.column_m(ray, length_m),
        }
    }

    /// The column density by `steps` midpoint steps along the ray's way through the medium: biased, with an error that falls with
    /// the square of the step.
    pub fn column_by_steps(&self, ray: &Ray, length_m: f64, steps: u32) -> f64 {
        match &self.density {
            Density::Uniform => length_m,
            Density::Field(field) => field.column_by_steps(ray, length_m, steps),
        }
    }

    /// The optical depth of a column density at a wavelength; a clear medium has none, however long.
    pub fn optical_depth(&self, nm: f64, column_m: f64) -> f64 {
        let sigma_t = self.extinction.at(nm);
        if sigma_t > 0.0 { sigma_t * column_m } else { 0.0 }
    }

    /// The largest extinction of all wavelengths, in 1/m at density 1.
    pub fn largest_extinction(&self) -> f64 {
        self.extinction_range.1
    }

    /// How far along the ray the column density reaches `column_m`; `None` where the ray's first `length_m` hold less.
    pub fn distance_at(&self, ray: &Ray, length_m: f64, column_m: f64) -> Option<f64> {
        match &self.density {
            Density::Uniform => (column_m < length_m).then_some(column_m),
            Density::Field(field) => field.distance_at(ray, length_m, column_m),
        }
    }

    /// The part of the ray's first `length_m` in which the density may be above 0.
    pub fn window(&self, ray: &Ray, length_m: f64) -> Option<(f64, f64)> {
        match &self.density {
            Density::Uniform => Some((0.0, length_m)),
            Density::Field(field) => field.window(ray, length_m),
        }
    }

    /// The radius of a ball around the scene's centre outside of which there is nothing of the medium; 0 where only its bounds decide that.
    pub fn reach_m(&self) -> f64 {
        match &self.density {
            Density::Uniform => 0.0,
            Density::Field(field) => field.reach_m(),
        }
    }

    /// Whether the density is the same everywhere.
    pub fn is_uniform(&self) -> bool {
        match self.density {
            Density::Uniform => true,
            Density::Field(_) => false,
        }
    }
}
