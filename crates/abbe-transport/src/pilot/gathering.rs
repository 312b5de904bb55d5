//! The choice of the trial where camera paths gather photons: in place, or behind the first diffuse
//! surface (the final gather of Jensen 1996, "Global illumination using photon maps").
//!
//! The trial measures the noise and the work of both. It cannot measure light that only few camera
//! samples find, such as that of a small bright spot on a wall, so a final gather is also rejected
//! if its samples lack light that photons in place have, or if few tiles have most of its noise.

use super::balance::{Balance, Variances};
use super::small_pass::{SmallPass, sample_variances};
use super::work::Work;
use crate::gather::CameraPass;
use crate::pass::PassContext;
use crate::plan::EffectId;

/// A difference of the light counts from this many standard errors on.
const SIGNIFICANT: f64 = 3.0;

/// Less missing light than this fraction may be the bias of photons in place.
const NEGLIGIBLE: f64 = 0.02;

/// The tiles with the greatest noise, as a fraction of all.
const NOISIEST: f64 = 1.0 / 32.0;

/// The most that these tiles may have of the noise.
const LARGEST_PART: f64 = 0.75;

/// The camera samples of the trial with one way of gathering, and the best division for it.
pub(super) struct Gathering<'p> {
    pub(super) camera_passes: [CameraPass<'p>; 2],
    pub(super) passes: [SmallPass; 2],
    pub(super) variances: [Variances; 3],
    pub(super) work: Work,
    pub(super) balance: Balance,
}

impl Gathering<'_> {
    /// Returns true if camera paths gather photons behind the first diffuse surface.
    pub(super) fn is_behind(&self) -> bool {
        self.camera_passes[0].final_gather
    }

    /// Returns true if this way is less noisy than photons in place, as far as the trial can tell.
    /// `tiles` holds the pixels of each tile.
    pub(super) fn improves_on(&self, in_place: &Self, tiles: &[Vec<usize>]) -> bool {
        self.visible_noise() < in_place.visible_noise()
            && finds_light(&self.light_of_tiles(), &in_place.light_of_tiles())
            && is_spread(self.noise_of_tiles(tiles))
    }

    fn visible_noise(&self) -> f64 {
        self.balance.visible_noise(self.variances, self.work)
    }

    /// Returns the sum of X, Y and Z of all camera samples of each tile.
    fn light_of_tiles(&self) -> Vec<f64> {
        let of_tile = |number: usize| {
            let pixels = self.passes.iter().flat_map(|pass| &pass.tiles[number]);
            pixels.flat_map(|pixel| pixel.samples.as_flattened()).sum::<f64>()
        };
        (0..self.passes[0].tiles.len()).map(of_tile).collect()
    }

    /// Returns the variance of the camera samples in each tile.
    fn noise_of_tiles(&self, tiles: &[Vec<usize>]) -> Vec<f64> {
        let mut of_pixels = sample_variances(&self.passes, tiles).map(|(_, of_pixel)| of_pixel.iter().sum::<f64>());
        tiles.iter().map(|tile| of_pixels.by_ref().take(tile.len()).sum()).collect()
    }
}

/// Returns true unless `light` of the tiles lacks a part of the `known` light.
fn finds_light(light: &[f64], known: &[f64]) -> bool {
    let count = light.len() as f64;
    let missing: Vec<f64> = known.iter().zip(light).map(|(known, light)| known - light).collect();
    let mean = missing.iter().sum::<f64>() / count;
    let variance = missing.iter().map(|missing| (missing - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let is_negligible = mean <= NEGLIGIBLE * known.iter().sum::<f64>() / count;
    is_negligible || mean <= SIGNIFICANT * (variance / count).sqrt()
}

/// Returns true unless the noisiest tiles have most of the noise.
fn is_spread(mut noise: Vec<f64>) -> bool {
    noise.sort_unstable_by(|a, b| b.total_cmp(a));
    let noisiest = ((NOISIEST * noise.len() as f64) as usize).max(1);
    noise[..noisiest].iter().sum::<f64>() <= LARGEST_PART * noise.iter().sum::<f64>()
}

/// Returns true if the plan gathers behind diffuse surfaces without a choice of the pilot.
pub(super) fn forces_final_gather(context: &PassContext<'_>) -> bool {
    let name = EffectId::FinalGather.effect().name;
    context.plan.indirect.may_gather_behind() && context.scene.settings.forces(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_that_few_samples_find_is_missing() {
        let known: Vec<f64> = (0..128).map(|i| 10.0 + f64::from(i % 7)).collect();
        let scaled = |factor: f64| known.iter().map(|light| factor * light).collect::<Vec<_>>();
        assert!(finds_light(&known, &known) && finds_light(&scaled(1.3), &known) && finds_light(&scaled(0.99), &known));
        assert!(!finds_light(&scaled(0.9), &known));
        // One sample in one tile found the missing light, and more than that.
        let mut found = scaled(0.5);
        found[40] += 900.0;
        assert!(finds_light(&found, &known) && !is_spread(found.iter().map(|light| light * light).collect()));
    }

    #[test]
    fn noise_of_most_tiles_is_spread() {
        let even: Vec<f64> = (0..128).map(|i| 1.0 + f64::from(i % 5)).collect();
        assert!(is_spread(even.clone()) && is_spread(vec![0.0; 16]));
        let mut rare = even;
        rare[3] = 5_000.0;
        assert!(!is_spread(rare));
    }
}
