//! The sums that the denoiser needs in addition to those of the picture.
//!
//! X and Z are separate for four groups of replicates, and the first surfaces of camera rays for
//! the even and the odd passes. Surfaces converge quickly, so only the first passes record them.

use super::first_surface::FirstSurface;
use super::pixel_sums::replicate;
use abbe_denoise::{Feature, GROUPS};
use abbe_spectra::colour::RgbSpace;
use abbe_spectra::math::elementary::log2;
use abbe_spectra::math::sum::ExactSum;

/// The passes with a smaller index record the first surfaces of their camera samples.
pub(super) const SURFACE_PASSES: u64 = 16;

/// The groups with sums of their own. The sums of the picture contain the last group as well.
const OWN_GROUPS: usize = GROUPS - 1;

const VALUES: usize = 9;

const VALUE_NAMES: [&str; VALUES] =
    ["samples", "hits", "albedoR", "albedoG", "albedoB", "normalX", "normalY", "normalZ", "logdepth"];

/// The planes of a pixel in the order of [`plane_names`].
pub(super) const PLANES: usize = 2 * OWN_GROUPS + 2 * VALUES;

/// The quantum of numbers of samples, albedos, normals and logarithms of depths, which keeps the
/// sums of 10⁵ samples.
const QUANTA: [f64; VALUES] =
    [1.0, 1.0, 1.0 / 16384.0, 1.0 / 16384.0, 1.0 / 16384.0, 1.0 / 16384.0, 1.0 / 16384.0, 1.0 / 16384.0, 1.0 / 256.0];

/// The sums of one pixel over the camera samples of some passes, in [`QUANTA`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct SurfaceSums([i32; VALUES]);

/// The sums of one pixel in addition to those of the picture. They take 168 bytes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct DenoisingSums {
    x: [ExactSum; OWN_GROUPS],
    z: [ExactSum; OWN_GROUPS],
    surfaces: [SurfaceSums; 2],
}

impl SurfaceSums {
    /// Adds a camera sample. `None` means that its ray hits nothing.
    pub(super) fn add_sample(&mut self, surface: Option<&FirstSurface>) {
        let values = match surface {
            Some(surface) => {
                let ([r, g, b], [x, y, z]) = (surface.albedo_rgb(), surface.sight.normal);
                [1.0, 1.0, r, g, b, x, y, z, log2(surface.sight.depth_m.max(f64::MIN_POSITIVE))]
            }
            None => [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        for ((sum, value), quantum) in self.0.iter_mut().zip(values).zip(QUANTA) {
            *sum = sum.saturating_add((value / quantum).round_ties_even() as i32);
        }
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, more)| *sum = sum.saturating_add(more));
    }

    fn mean(&self) -> Feature {
        let mut values = [0.0; VALUES];
        values.iter_mut().zip(self.0).zip(QUANTA).for_each(|((value, sum), quantum)| *value = f64::from(sum) * quantum);
        let [samples, hits, r, g, b, x, y, z, depth] = values;
        if samples < 1.0 {
            return Feature::NONE;
        }
        let missed = samples - hits;
        let xyz = RgbSpace::Srgb.to_xyz([r + missed, g + missed, b + missed].map(|sum| sum / samples));
        let white = RgbSpace::Srgb.white();
        Feature {
            albedo: std::array::from_fn(|c| (xyz[c] / white[c]) as f32),
            normal: [x, y, z].map(|sum| (sum / samples) as f32),
            log_depth: if hits > 0.0 { (depth / hits) as f32 } else { 0.0 },
        }
    }
}

impl DenoisingSums {
    /// Adds X and Z of a pass.
    pub(super) fn add_light(&mut self, pass: u64, [x, z]: [f64; 2]) {
        let group = replicate(pass) % GROUPS;
        if let (Some(of_x), Some(of_z)) = (self.x.get_mut(group), self.z.get_mut(group)) {
            *of_x += x;
            *of_z += z;
        }
    }

    pub(super) fn add_surfaces(&mut self, pass: u64, sums: &SurfaceSums) {
        self.surfaces[replicate(pass) % 2].add(sums);
    }

    /// Returns the sums of X and of Z of each group. `all` are those of all groups.
    pub(super) fn by_group(&self, all: [ExactSum; 2]) -> [[ExactSum; GROUPS]; 2] {
        let mut groups = [[ExactSum::default(); GROUPS]; 2];
        for ((groups, own), all) in groups.iter_mut().zip([self.x, self.z]).zip(all) {
            let rest = own.iter().fold(all.bits(), |rest, sum| rest.saturating_sub(sum.bits()));
            groups[..OWN_GROUPS].copy_from_slice(&own);
            groups[OWN_GROUPS] = ExactSum::from_bits(rest);
        }
        groups
    }

    /// Returns the first surfaces in the even and in the odd passes.
    pub(super) fn mean_surfaces(&self) -> [Feature; 2] {
        self.surfaces.map(|sums| sums.mean())
    }

    pub(super) fn plane(&self, plane: usize) -> ExactSum {
        match plane.checked_sub(2 * OWN_GROUPS) {
            None if plane < OWN_GROUPS => self.x[plane],
            None => self.z[plane - OWN_GROUPS],
            Some(value) => ExactSum::from_bits(i128::from(self.surfaces[value / VALUES].0[value % VALUES])),
        }
    }

    pub(super) fn add_to_plane(&mut self, plane: usize, sum: ExactSum) {
        match plane.checked_sub(2 * OWN_GROUPS) {
            None if plane < OWN_GROUPS => self.x[plane] += sum,
            None => self.z[plane - OWN_GROUPS] += sum,
            Some(value) => {
                let own = &mut self.surfaces[value / VALUES].0[value % VALUES];
                let more = sum.bits().clamp(i128::from(i32::MIN), i128::from(i32::MAX)) as i32;
                *own = own.saturating_add(more);
            }
        }
    }
}

pub(super) fn plane_names() -> impl Iterator<Item = String> {
    let groups = ["X", "Z"].into_iter().flat_map(|c| (0..OWN_GROUPS).map(move |group| format!("{c}{group}")));
    let surfaces = (0..2).flat_map(|half| VALUE_NAMES.map(|name| format!("{name}{half}")));
    groups.chain(surfaces)
}
