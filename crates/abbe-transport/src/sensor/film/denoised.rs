//! The means of a film for the denoiser.

use super::Film;
use crate::sensor::denoising;
use abbe_denoise::{GROUPS, Samples};
use abbe_spectra::spectrum::LUMENS_PER_WATT;

impl Film {
    /// Returns true if the film has sums for the denoiser.
    pub fn denoises(&self) -> bool {
        self.channels.denoises()
    }

    pub(super) fn denoising_planes(&self) -> usize {
        if self.denoises() { denoising::PLANES } else { 0 }
    }

    pub(super) fn denoising_plane_names(&self) -> impl Iterator<Item = String> {
        denoising::plane_names().take(self.denoising_planes())
    }

    /// Returns the means for the denoiser, in cd/m². `None` if the film has no sums for it, or too
    /// few passes: the first four, or others that fill as many groups.
    pub fn denoising_samples(&self) -> Option<Samples> {
        if self.denoising.is_empty() || !Samples::suffice(self.passes) {
            return None;
        }
        let unit = self.unit.value() * LUMENS_PER_WATT;
        let mean = |sum: f64, passes: u64| (unit * sum / passes.max(1) as f64) as f32;
        let of_group: [u64; GROUPS] = std::array::from_fn(|group| self.passes.iter().skip(group).step_by(GROUPS).sum());
        let blank = || Vec::with_capacity(self.pixel_count());
        let mut means = Samples {
            width: self.width,
            height: self.height,
            passes: self.passes,
            y: std::array::from_fn(|_| blank()),
            x: std::array::from_fn(|_| blank()),
            z: std::array::from_fn(|_| blank()),
            features: std::array::from_fn(|_| Vec::with_capacity(self.pixel_count())),
        };
        for (sums, own) in self.pixels.iter().zip(&self.denoising) {
            for ((plane, sum), passes) in means.y.iter_mut().zip(sums.y).zip(self.passes) {
                plane.push(mean(sum.value(), passes));
            }
            let [x, z] = own.by_group([sums.x, sums.z]);
            for (planes, sums) in [(&mut means.x, x), (&mut means.z, z)] {
                for ((plane, sum), passes) in planes.iter_mut().zip(sums).zip(of_group) {
                    plane.push(mean(sum.value(), passes));
                }
            }
            means.features.iter_mut().zip(own.mean_surfaces()).for_each(|(plane, surface)| plane.push(surface));
        }
        Some(means)
    }
}
