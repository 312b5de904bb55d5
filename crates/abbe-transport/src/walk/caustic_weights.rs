//! Multiple importance sampling of caustic light at glossy surfaces.
//!
//! Two techniques find the light that reaches a glossy surface through mirrors or clear glass: a
//! photon arrives there, or a camera path continues from there by the BSDF and hits the light.
//! Photons are better for small lights and wide lobes, camera paths for large lights and narrow
//! lobes, so the balance heuristic weights both (Veach & Guibas 1995; Georgiev et al. 2012, "Light
//! Transport Simulation with Vertex Connection and Merging").
//!
//! Both densities refer to the same measure: specular events conserve the density of rays per area
//! and solid angle (étendue), so the density of photons around a surface point and a direction is
//! that with which the light emits them. The weights sum to 1 for any densities, which may
//! therefore be approximate: they lack the Fresnel factors, the refractive indices and the
//! variation of the aim within a stratum.

use abbe_spectra::math::sphere::BoundingSphere;
use glam::DVec3;
use std::ops::Range;

/// The density of emitted rays, per m² and sr, for one photon path; 0 if no camera path can hit the
/// light. It is rounded at once to 12 bits, of which 8 are the exponent, so that a stored photon
/// and a camera path have the same value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct RayDensity(u16);

/// The low bits of a single-precision number that a density lacks. The sign bit is always 0.
const DROPPED_BITS: u32 = 19;

impl RayDensity {
    /// The density of lights that no camera path can hit.
    pub const NONE: Self = Self(0);

    pub fn new(per_m2_sr: f64) -> Self {
        Self(((per_m2_sr as f32).to_bits() >> DROPPED_BITS) as u16)
    }

    #[inline]
    pub fn to_bits(self) -> u32 {
        u32::from(self.0)
    }

    /// Returns the density with these 12 bits.
    #[inline]
    pub fn from_bits(bits: u32) -> Self {
        Self(bits as u16)
    }

    fn get(self) -> f64 {
        f64::from(f32::from_bits(u32::from(self.0) << DROPPED_BITS))
    }
}

#[derive(Debug, Clone, Default)]
pub struct RayDensities {
    strata: Vec<StratumDensity>,
    lights: Vec<Range<usize>>,
}

/// The mean density of the emitted rays in one stratum.
#[derive(Debug, Clone, Copy)]
pub struct StratumDensity {
    pub light: usize,
    /// The stratum contains the rays through this sphere. `None` for the stratum of all other rays.
    pub sphere: Option<BoundingSphere>,
    /// The fraction of the photon paths, divided by the power of the stratum, in 1/W.
    pub per_watt: f64,
}

impl RayDensities {
    /// Takes the strata light by light. Those of a light are ordered by priority: a ray belongs to
    /// the first stratum that contains it.
    pub fn new(strata: Vec<StratumDensity>) -> Self {
        let count = strata.last().map_or(0, |last| last.light + 1);
        let first = |light: usize| strata.partition_point(|stratum| stratum.light < light);
        let lights = (0..count).map(|light| first(light)..first(light + 1)).collect();
        Self { strata, lights }
    }

    /// Returns the density of rays with this radiance (W/m²/sr) in a stratum.
    pub fn of_stratum(&self, number: usize, radiance: f64) -> RayDensity {
        RayDensity::new(self.strata[number].per_watt * radiance)
    }

    /// Returns the density of a light's rays around the ray from `origin` along `direction`.
    pub fn around(&self, light: usize, origin: DVec3, direction: DVec3, radiance: f64) -> RayDensity {
        let contains = |&number: &usize| {
            self.strata[number].sphere.is_none_or(|sphere| sphere.contains_part_of(origin, direction))
        };
        let number = self.lights.get(light).cloned().and_then(|mut strata| strata.find(contains));
        number.map_or(RayDensity::NONE, |number| self.of_stratum(number, radiance))
    }
}

/// Weights photons and camera paths at one glossy surface point.
#[derive(Debug, Clone, Copy)]
pub struct CausticWeights {
    /// The number of photon paths, multiplied by the area (m²) over which a photon contributes and
    /// divided by the number of camera paths in this area.
    pub photons_m2: f64,
}

impl CausticWeights {
    /// Returns a photon's weight. `pdf` (1/sr) is that of continuing the camera path along it.
    #[inline]
    pub fn of_photon(self, density: RayDensity, pdf: f64) -> f64 {
        if density == RayDensity::NONE {
            return 1.0;
        }
        let photons = self.photons_m2 * density.get();
        photons / (photons + pdf)
    }

    /// Returns the weight of a camera path; see [`Self::of_photon`].
    pub fn of_camera_path(self, density: RayDensity, pdf: f64) -> f64 {
        if density == RayDensity::NONE { 0.0 } else { 1.0 - self.of_photon(density, pdf) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_both_techniques_sum_to_one() {
        for density in [0.0, 1e-30, 0.3, 4e12] {
            let density = RayDensity::new(density);
            for (photons_m2, pdf) in [(1e-9, 1e4), (1.0, 0.1), (1e3, 1e-3)] {
                let weights = CausticWeights { photons_m2 };
                let sum = weights.of_photon(density, pdf) + weights.of_camera_path(density, pdf);
                assert!((sum - 1.0).abs() < 1e-12, "{density:?}");
            }
        }
    }

    #[test]
    fn densities_are_rounded_to_5_significant_bits() {
        for value in [1e-20, 0.7, 3.0, 5e17] {
            assert!((RayDensity::new(value).get() / value - 1.0).abs() < 1.0 / 16.0, "{value}");
        }
        assert_eq!(RayDensity::new(0.0), RayDensity::NONE);
    }

    #[test]
    fn a_ray_belongs_to_the_first_stratum_that_contains_it() {
        let ball = BoundingSphere { centre: DVec3::X * 5.0, radius_m: 1.0 };
        let stratum = |light, sphere, per_watt| StratumDensity { light, sphere, per_watt };
        let densities =
            RayDensities::new(vec![stratum(0, None, 1.0), stratum(1, Some(ball), 64.0), stratum(1, None, 2.0)]);
        let density = |light, direction| densities.around(light, DVec3::ZERO, direction, 0.5).get();
        assert_eq!(density(0, DVec3::X), 0.5);
        assert_eq!(density(1, DVec3::X), 32.0);
        assert_eq!(density(1, DVec3::Y), 1.0);
    }
}
