//! The strata of emitted rays.
//!
//! A small object in a large world receives few of the photons that the lights emit, and a grid of
//! cells over all emitted rays is too coarse to aim at it. The rays of each light are therefore
//! divided into strata: one for each guiding sphere around a small part of the scene, and a last
//! one for all other rays. Each stratum has its own probability and its own aim, so a ray through a
//! sphere has a high density at any ratio of scales, and the estimate stays unbiased (stratified
//! sampling: Cochran 1977, "Sampling Techniques", chapter 5).

use super::aim::Aim;
use crate::walk::{RayDensities, StratumDensity};
use abbe_scene::light::{LeRandoms, LeSample, Light, SceneExtent};
use abbe_spectra::math::distribution::DiscreteDistribution;
use abbe_spectra::math::sort::sort_by_number;
use abbe_spectra::math::sphere::BoundingSphere;
use std::ops::Range;

/// The number of rays from which the fraction of a stratum is computed.
const FRACTION_RAYS: u32 = 64;

/// A sphere is used only if a smaller fraction of the light's power passes through it.
const LARGEST_FRACTION: f64 = 1.0 / 256.0;

/// A surrounding sphere is used only if a smaller fraction of the light's power passes through it.
const LARGEST_OUTER_FRACTION: f64 = 1.0 / 4.0;

#[derive(Debug, Clone)]
pub struct EmissionStrata {
    /// The strata, light by light.
    pub list: Vec<Stratum>,
    pub choice: DiscreteDistribution,
    /// The spheres of the strata, if the world is much larger than they are. Distant surfaces
    /// scatter some photons towards them on purpose.
    pub guiding_spheres: Vec<BoundingSphere>,
}

#[derive(Debug, Clone)]
pub struct Stratum {
    pub light: usize,
    /// The target of the rays. `None` for the stratum of all other rays.
    sphere: Option<BoundingSphere>,
    /// The strata of the same light whose rays do not belong to this one, even through its sphere.
    excluded: Range<usize>,
    /// The fraction of the light's power in this stratum. Rays in excluded strata are included.
    pub fraction: f64,
    pub aim: Aim,
}

impl EmissionStrata {
    pub fn plain(lights: &DiscreteDistribution) -> Self {
        let list = (0..lights.len()).map(|light| Stratum::whole(light, 0..0)).collect();
        Self { list, choice: lights.clone(), guiding_spheres: Vec::new() }
    }

    /// Creates the strata of all lights: one for each inner sphere that only a small fraction of
    /// the light's power reaches and, if there is such a sphere, for the spheres `outer`, which lie
    /// between them and the world. Smaller spheres come first and exclude the larger ones. The
    /// strata of a light divide its probability.
    pub fn new(
        lights: &[Light],
        extent: SceneExtent<'_>,
        [inner, outer]: [&[BoundingSphere]; 2],
        probability: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let (mut list, mut weights): (Vec<Stratum>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut guiding_spheres: Vec<BoundingSphere> = Vec::new();
        for (number, light) in lights.iter().enumerate() {
            let fractions = |spheres: &[BoundingSphere], largest: f64| -> Vec<(BoundingSphere, f64)> {
                let fractions = spheres.iter().map(|sphere| (*sphere, fraction_through(light, extent, sphere)));
                fractions.filter(|&(_, fraction)| fraction > 0.0 && fraction < largest).collect()
            };
            let mut spheres = fractions(inner, LARGEST_FRACTION);
            if !spheres.is_empty() {
                let around = fractions(outer, LARGEST_OUTER_FRACTION);
                if !around.is_empty() {
                    spheres.extend(around);
                    for (sphere, _) in &spheres {
                        if !guiding_spheres.contains(sphere) {
                            guiding_spheres.push(*sphere);
                        }
                    }
                }
                sort_by_number(&mut spheres, |(sphere, _)| sphere.radius_m);
            }
            let first = list.len();
            for (sphere, fraction) in spheres {
                let (sphere, excluded) = (Some(sphere), first..list.len());
                list.push(Stratum { light: number, sphere, excluded, fraction, aim: Aim::plain() });
            }
            list.push(Stratum::whole(number, first..list.len()));
            let strata = list.len() - first;
            weights.extend(std::iter::repeat_n(probability(number) / strata as f64, strata));
        }
        Some(Self { choice: DiscreteDistribution::new(weights)?, list, guiding_spheres })
    }

    /// Returns the densities of the emitted rays: in each stratum, the mean density of its photons.
    pub fn ray_densities(&self, lights: &[Light], extent: SceneExtent<'_>) -> RayDensities {
        let density = |(number, stratum): (usize, &Stratum)| {
            let (light, power_w) = (stratum.light, stratum.fraction * lights[stratum.light].power_w(extent));
            let per_watt = self.choice.probability(number) * stratum.aim.mean_relative_pdf() / power_w;
            StratumDensity { light, sphere: stratum.sphere, per_watt: if power_w > 0.0 { per_watt } else { 0.0 } }
        };
        RayDensities::new(self.list.iter().enumerate().map(density).collect())
    }

    /// Samples a ray of a stratum. The flux is divided by the density within the stratum, and is 0
    /// if the ray belongs to another one.
    #[inline]
    pub(super) fn sample_le(
        &self,
        stratum: &Stratum,
        light: &Light,
        extent: SceneExtent<'_>,
        u: LeRandoms,
    ) -> LeSample {
        let sample = match &stratum.sphere {
            None => light.sample_le(extent, u),
            Some(sphere) => light.sample_le_through(extent, sphere, u),
        };
        let mut others = self.list[stratum.excluded.clone()].iter().filter_map(|other| other.sphere.as_ref());
        let elsewhere = others.any(|other| other.contains_part_of(sample.origin, sample.direction));
        if elsewhere { LeSample { flux_w: 0.0, ..sample } } else { sample }
    }
}

impl Stratum {
    /// Creates the stratum of all rays that do not belong to the excluded strata.
    fn whole(light: usize, excluded: Range<usize>) -> Self {
        Self { light, sphere: None, excluded, fraction: 1.0, aim: Aim::plain() }
    }
}

/// Returns the fraction of a light's power that passes through a sphere.
fn fraction_through(light: &Light, extent: SceneExtent<'_>, sphere: &BoundingSphere) -> f64 {
    let sobol = abbe_spectra::math::sobol::Sobol::new(0);
    let flux = |i: u32| {
        let u = sobol.point(i);
        light.sample_le_through(extent, sphere, LeRandoms { aim: [u[0], u[1]], rest: [u[2], u[3], u[4]] }).flux_w
    };
    let mean = (0..FRACTION_RAYS).map(flux).sum::<f64>() / f64::from(FRACTION_RAYS);
    let power_w = light.power_w(extent);
    if power_w > 0.0 { mean / power_w } else { 0.0 }
}
