//! Participating media: absorption, scattering and emission of fog, smoke, milk and flames.
//!
//! Each coefficient of a medium is a function of wavelength, multiplied by a density that may vary
//! in space, so one number describes a segment of a ray: the column density D = ∫ρ ds. The
//! transmittance at every wavelength is exp(−σ_t(λ)·D). Absorption and scattering are given
//! separately, and neither is negative, so the albedo cannot exceed 1.

pub mod field;

mod emission;

pub use emission::MediumEmission;

use super::motion::AnimatedTransform;
use crate::geometry::Ray;
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::phase::PhaseFunction;
use abbe_spectra::spectrum::{REFERENCE_NM, Spectrum};
use field::ScalarField;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// A medium of the scene. All coefficients are in 1/m at density 1.
#[derive(Debug, Clone)]
pub struct Medium {
    pub name: String,
    /// σ_a, including the absorption of the fluorophore.
    pub absorption: Spectrum,
    /// σ_s.
    pub scattering: Spectrum,
    /// σ_t = σ_a + σ_s.
    pub extinction: Spectrum,
    /// The smallest and the largest extinction coefficient in the band.
    pub extinction_range: (f64, f64),
    /// The largest scattering coefficient in the band.
    pub scattering_max: f64,
    pub phase: PhaseFunction,
    pub density: Density,
    /// True if the medium is optically thick in at least one of its bodies; see
    /// [`is_dense_across`](Self::is_dense_across).
    pub dense: bool,
    pub transmittance: TransmittanceEstimator,
    pub emission: Option<MediumEmission>,
    /// The absorptance of this dye is an absorption coefficient.
    pub fluorophore: Option<Box<Fluorophore>>,
    /// While the shutter is open, with lengths in m.
    pub motion: Option<AnimatedTransform>,
}

/// The relative density, without unit, as a function of position.
#[derive(Debug, Clone, PartialEq)]
pub enum Density {
    /// 1 everywhere.
    Uniform,
    Field(Arc<ScalarField>),
}

/// The method that computes the transmittance if the density of a medium varies in space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransmittanceEstimator {
    /// From the exact column density.
    Exact,
    /// Ratio tracking (Novák et al. 2014): unbiased but noisy.
    Ratio,
    /// Ray marching computes the column density by the midpoint rule with this number of steps per
    /// segment: biased, but without noise.
    March { steps: u32 },
}

impl Medium {
    /// Creates a medium from its absorption and scattering coefficients in 1/m at density 1.
    pub fn new(
        name: String,
        (absorption, scattering): (Spectrum, Spectrum),
        phase: PhaseFunction,
        density: Density,
    ) -> Self {
        let extinction = Spectrum::mix(&[(1.0, &absorption), (1.0, &scattering)]);
        let transmittance = TransmittanceEstimator::Exact;
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
            fluorophore: None,
            motion: None,
        }
    }

    #[must_use]
    pub fn with_fluorophore(self, fluorophore: Fluorophore) -> Self {
        let absorption = Spectrum::mix(&[(1.0, &self.absorption), (1.0, fluorophore.absorptance_spectrum())]);
        let extinction = Spectrum::mix(&[(1.0, &absorption), (1.0, &self.scattering)]);
        let extinction_range = (extinction.min(), extinction.max());
        Self { absorption, extinction, extinction_range, fluorophore: Some(Box::new(fluorophore)), ..self }
    }

    /// Lets light below the band enter the medium and excite its dye.
    pub fn add_ultraviolet(&mut self) {
        let below = self.extinction.ultraviolet_range();
        self.extinction_range = (self.extinction_range.0.min(below.0), self.extinction_range.1.max(below.1));
        self.fluorophore.iter_mut().for_each(|dye| dye.add_ultraviolet());
    }

    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        let density = match &self.density {
            Density::Uniform => Density::Uniform,
            Density::Field(field) => Density::Field(Arc::new(field.moved(map))),
        };
        Self { density, emission: self.emission.as_ref().map(|emission| emission.moved(map)), ..self.clone() }
    }

    /// Returns true if the optical depth at 550 nm across a body of this thickness exceeds 4. For a
    /// grid medium, the smallest column density across its own box replaces the thickness.
    pub fn is_dense_across(&self, across_m: f64) -> bool {
        const DENSE: f64 = 4.0;
        let column_m = self.field().map_or(across_m, ScalarField::min_column_m);
        self.optical_depth(REFERENCE_NM, column_m) > DENSE
    }

    /// An upper bound of the column density in m along lines through a body of the diameter
    /// `across_m`.
    pub fn max_column_m(&self, across_m: f64) -> f64 {
        self.field().map_or(across_m, |field| {
            let corners = field.corners();
            let diagonals = (0..4).map(|i| (corners[7 - i] - corners[i]).length());
            field.max() * across_m.min(diagonals.fold(0.0, f64::max))
        })
    }

    /// Returns true if the medium scatters or emits fluorescent light at any wavelength.
    pub fn scatters(&self) -> bool {
        self.scattering_max > 0.0 || self.fluorophore.is_some()
    }

    /// Returns the sum of the scattering coefficient and of the absorption coefficient of the
    /// fluorophore, in 1/m at density 1: a stored photon point has the power that these two
    /// processes remove.
    #[inline]
    pub fn stored_coefficient(&self, nm: f64) -> f64 {
        self.scattering.at(nm) + self.fluorophore.as_ref().map_or(0.0, |fluorophore| fluorophore.absorptance(nm))
    }

    /// Returns true if a light map with this number of cells along its longest side resolves the
    /// density.
    pub fn is_smooth_in_cells(&self, cells: u32) -> bool {
        self.field().is_none_or(|field| field.is_smooth_in_cells(cells))
    }

    /// The density at a point (m, relative to the scene's centre).
    pub fn density_at(&self, point: DVec3) -> f64 {
        self.field().map_or(1.0, |field| field.at(point))
    }

    /// The emission at a point, in W/m³/sr/nm.
    pub fn emission_per_m(&self, point: DVec3, nm: f64) -> f64 {
        self.emission.as_ref().map_or(0.0, |emission| {
            let density = self.density_at(point);
            if density > 0.0 { density * emission.at(point, nm) } else { 0.0 }
        })
    }

    /// An upper bound of the density along the first `length_m` of the ray, for null-collision
    /// tracking.
    pub fn majorant(&self, ray: &Ray, length_m: f64) -> f64 {
        self.field().map_or(1.0, |field| field.majorant(ray, length_m))
    }

    /// The exact column density ∫ρ ds along the first `length_m` (or ∞) of the ray, in m.
    pub fn column_m(&self, ray: &Ray, length_m: f64) -> f64 {
        self.field().map_or(length_m, |field| field.column_m(ray, length_m))
    }

    /// Computes the column density (in m) by the midpoint rule. The error is proportional to the
    /// square of the step.
    pub fn column_by_steps(&self, ray: &Ray, length_m: f64, steps: u32) -> f64 {
        self.field().map_or(length_m, |field| field.column_by_steps(ray, length_m, steps))
    }

    /// Converts a column density to the optical depth at a wavelength in nm. If σ_t is 0, it is 0
    /// even for an infinite column.
    pub fn optical_depth(&self, nm: f64, column_m: f64) -> f64 {
        let sigma_t = self.extinction.at(nm);
        if sigma_t > 0.0 { sigma_t * column_m } else { 0.0 }
    }

    pub fn largest_extinction(&self) -> f64 {
        self.extinction_range.1
    }

    /// The distance in m along the ray at which the column density reaches `column_m`. `None` if
    /// that of the first `length_m` is smaller.
    pub fn distance_at(&self, ray: &Ray, length_m: f64, column_m: f64) -> Option<f64> {
        match &self.density {
            Density::Uniform => (column_m < length_m).then_some(column_m),
            Density::Field(field) => field.distance_at(ray, length_m, column_m),
        }
    }

    /// The distances in m between which the density can be above 0 along the first `length_m` of
    /// the ray.
    pub fn interval(&self, ray: &Ray, length_m: f64) -> Option<(f64, f64)> {
        self.field().map_or(Some((0.0, length_m)), |field| field.interval(ray, length_m))
    }

    /// The radius in m of a sphere around the scene's centre that contains the medium's own box, if
    /// it has one.
    pub fn radius_m(&self) -> f64 {
        self.field().map_or(0.0, ScalarField::radius_m)
    }

    pub fn is_uniform(&self) -> bool {
        self.field().is_none()
    }

    fn field(&self) -> Option<&ScalarField> {
        if let Density::Field(field) = &self.density { Some(field) } else { None }
    }
}
