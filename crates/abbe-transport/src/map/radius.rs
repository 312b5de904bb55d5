//! Kernel radii: the pilot fixes the first radius of each pixel, and it shrinks from pass to pass.

use crate::plan::partition::{PerClass, PerSet};
use abbe_spectra::math::elementary::powf;
use glam::DVec3;

/// The first radii of a pixel: `f32`, or `Option<f32>` while the pilot does not know all.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PixelRadii<T = f32> {
    /// Radii on surfaces, in m.
    pub surface: PerSet<PerClass<T>>,
    /// Radii in media, divided by the distance from the camera.
    pub volume: PerSet<PerClass<T>>,
}

#[derive(Debug, Default)]
pub struct FirstRadii {
    /// The radii of each kind, in the order of [`PixelRadii::all`].
    kinds: [RadiiOfKind; 8],
}

#[derive(Debug)]
enum RadiiOfKind {
    Same(f32),
    Each(Vec<f32>),
}

impl Default for RadiiOfKind {
    fn default() -> Self {
        Self::Same(f32::MIN_POSITIVE)
    }
}

impl FirstRadii {
    /// Replaces unknown radii, or all of them if `all` is true, by the median of those of the same
    /// kind that are known in other pixels.
    pub fn with_medians(radii: &[PixelRadii<Option<f32>>], all: bool) -> Self {
        let of_kind = |kind: usize| {
            let radius = |radii: &PixelRadii<Option<f32>>| radii.all()[kind];
            let mut known: Vec<f32> = radii.iter().filter_map(radius).collect();
            if known.is_empty() {
                return RadiiOfKind::default();
            }
            let middle = known.len() / 2;
            let median = *known.select_nth_unstable_by(middle, f32::total_cmp).1;
            if all {
                return RadiiOfKind::Same(median);
            }
            RadiiOfKind::Each(radii.iter().map(|radii| radius(radii).unwrap_or(median)).collect())
        };
        Self { kinds: std::array::from_fn(of_kind) }
    }

    #[inline]
    pub fn of(&self, pixel: usize) -> PixelRadii {
        let mut radii = PixelRadii::default();
        for (radius, kind) in radii.all_mut().into_iter().zip(&self.kinds) {
            *radius = match kind {
                RadiiOfKind::Same(radius) => *radius,
                RadiiOfKind::Each(radii) => radii[pixel],
            };
        }
        radii
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerKernel<T> {
    pub surface: PerClass<T>,
    pub points: PerClass<T>,
    pub beams: PerClass<T>,
}

impl<T: Copy> PerKernel<T> {
    pub fn splat(value: T) -> Self {
        let of_all = PerClass::from_fn(|_| value);
        Self { surface: of_all, points: of_all, beams: of_all }
    }
}

impl<T: Copy> PixelRadii<T> {
    pub fn splat(radius: T) -> Self {
        let of_all = PerSet::from_fn(|_| PerClass::from_fn(|_| radius));
        Self { surface: of_all, volume: of_all }
    }

    /// Computes each radius from the corresponding values of two pixels.
    pub fn zip_with<U: Copy, V>(self, other: PixelRadii<U>, mut combine: impl FnMut(T, U) -> V) -> PixelRadii<V> {
        let mut of_sets = |a: PerSet<PerClass<T>>, b: PerSet<PerClass<U>>| {
            a.zip_with(b, |a: PerClass<T>, b: PerClass<U>| a.zip_with(b, &mut combine))
        };
        PixelRadii { surface: of_sets(self.surface, other.surface), volume: of_sets(self.volume, other.volume) }
    }

    pub fn all(&self) -> [T; 8] {
        let mut copy = *self;
        copy.all_mut().map(|radius| *radius)
    }

    /// Returns mutable references to all radii, in the order of [`Self::all`].
    pub fn all_mut(&mut self) -> [&mut T; 8] {
        let Self { surface, volume } = self;
        [
            &mut surface.free.caustic,
            &mut surface.free.indirect,
            &mut surface.shared.caustic,
            &mut surface.shared.indirect,
            &mut volume.free.caustic,
            &mut volume.free.indirect,
            &mut volume.shared.caustic,
            &mut volume.shared.indirect,
        ]
    }
}

/// Returns the factors by which pass number `pass` scales the first radii. `photons` is the number
/// of photons that a pass stores, divided by the number for which the first radii are chosen.
pub fn scales(pass: u64, photons: PerKernel<f64>) -> PerKernel<f64> {
    let of_class = |photons: PerClass<f64>, dimensions: u32| {
        PerClass::from_fn(|class| scale_for_photons(photons[class], dimensions) * scale(pass, dimensions))
    };
    PerKernel {
        surface: of_class(photons.surface, 2),
        points: of_class(photons.points, 2),
        beams: of_class(photons.beams, 1),
    }
}

/// Returns the factor on the radius of a kernel of d = `dimensions` dimensions if a pass stores
/// `photons` times as many photons.
///
/// The variance is proportional to 1/(N rᵈ) for N photons, and the squared bias to r⁴, so the best
/// r is proportional to N^(−1/(d + 4)) (Silverman 1986, "Density Estimation for Statistics and Data
/// Analysis", section 4.3).
fn scale_for_photons(photons: f64, dimensions: u32) -> f64 {
    powf(photons, -1.0 / (f64::from(dimensions) + 4.0))
}

/// Returns the ratio of the radius after some passes and the first one, in d = `dimensions`.
///
/// By equation 15 of "Progressive Photon Mapping – A Probabilistic Approach" (Knaus & Zwicker
/// 2011), rᵈ_{i+1} = rᵈ_i (i + α)/(i + 1) after pass i, counted from 1, with α = 4/(d + 4). The
/// mean square error falls as N^(−2/3) for kernels on surfaces and for photon points (d = 2), and
/// as N^(−4/5) for photon beams (d = 1). The factor depends only on the number of the pass, so that
/// passes can run in any order.
pub fn scale(passes: u64, dimensions: u32) -> f64 {
    let alpha = 4.0 / (f64::from(dimensions) + 4.0);
    // The product of (i + α)/(i + 1) is computed factor by factor up to i = `EXACT`, and from the
    // asymptotic series Γ(n + α)/Γ(n + 1) ~ n^(α−1)(1 + (α−1)α/2n) beyond.
    const EXACT: u64 = 4096;
    let product: f64 = (1..=passes.min(EXACT)).map(|i| (i as f64 + alpha) / (i as f64 + 1.0)).product();
    let tail = if passes > EXACT {
        let ratio = |n: f64| powf(n, alpha - 1.0) * (1.0 + (alpha - 1.0) * alpha / (2.0 * n));
        ratio(passes as f64 + 1.0) / ratio(EXACT as f64 + 1.0)
    } else {
        1.0
    };
    powf(product * tail, 1.0 / f64::from(dimensions))
}

/// Returns the first radius (m) of a pixel: the distance to the k-th nearest photon, but at least
/// the pixel's footprint, because a smaller kernel only adds noise, and at most `largest_m`, also
/// without photons.
pub fn first(kth_distance_m: Option<f64>, footprint_m: f64, largest_m: f64) -> f64 {
    kth_distance_m.unwrap_or(largest_m).clamp(footprint_m.min(largest_m), largest_m)
}

/// Returns the smallest useful radius (m) of a kernel at `position` (m, relative to the scene's
/// centre): about 16 times the spacing of single-precision numbers there. With a smaller kernel,
/// the rounding of the photons' positions would be visible.
pub fn least(position: DVec3) -> f64 {
    const SIXTEEN_STEPS: f64 = 16.0 * (f32::EPSILON as f64);
    SIXTEEN_STEPS * position.abs().max_element()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_radii_become_the_median_of_their_kind() {
        let mut radii = [PixelRadii::splat(None); 4];
        for (pixel, radius) in [(0, 3.0), (1, 1.0), (3, 2.0)] {
            radii[pixel].surface.free.caustic = Some(radius);
        }
        let caustic = |all: bool| {
            let filled = FirstRadii::with_medians(&radii, all);
            [0, 1, 2, 3].map(|pixel| {
                let PixelRadii { surface, .. } = filled.of(pixel);
                assert_eq!(surface.free.indirect, f32::MIN_POSITIVE, "no radius of this kind is known");
                surface.free.caustic
            })
        };
        assert_eq!(caustic(false), [3.0, 1.0, 2.0, 2.0]);
        assert_eq!(caustic(true), [2.0; 4]);
    }

    /// The factors satisfy the recurrence, also where they are computed approximately.
    #[test]
    fn radii_follow_the_recurrence() {
        for (dimensions, alpha) in [(1, 4.0 / 5.0), (2, 2.0 / 3.0)] {
            let mut power = 1.0;
            for i in 1..6000_u64 {
                assert!((scale(i - 1, dimensions).powi(dimensions as i32) / power - 1.0).abs() < 1e-7, "pass {i}");
                power *= (i as f64 + alpha) / (i as f64 + 1.0);
            }
            assert_eq!(scale(0, dimensions), 1.0);
        }
    }

    /// The mean square error is least if the radius falls as n^(−1/(d + 4)).
    #[test]
    fn each_kind_of_radius_falls_at_its_own_rate() {
        let [early, late] = [1 << 20, 1 << 26].map(|pass| scales(pass, PerKernel::splat(1.0)));
        let exponent = |of: fn(&PerKernel<f64>) -> f64| (of(&late) / of(&early)).log2() / 6.0;
        assert!((exponent(|scales| scales.surface.indirect) + 1.0 / 6.0).abs() < 1e-5);
        assert!((exponent(|scales| scales.points.indirect) + 1.0 / 6.0).abs() < 1e-5);
        assert!((exponent(|scales| scales.beams.indirect) + 1.0 / 5.0).abs() < 1e-5);
    }

    /// With eight times as many beams of caustics, their radii are those after eight times as many
    /// passes. The other radii do not change.
    #[test]
    fn each_kind_of_radius_follows_the_photons_of_its_kind() {
        let plain = PerKernel::splat(0.5);
        let more = PerKernel { beams: PerClass { caustic: 4.0, indirect: 0.5 }, ..plain };
        let [early, early_of_more, late] =
            [(1 << 20, plain), (1 << 20, more), (1 << 23, plain)].map(|(n, p)| scales(n, p));
        assert!((early_of_more.beams.caustic / late.beams.caustic - 1.0).abs() < 1e-6);
        let other = PerClass { caustic: early.beams.caustic, ..early_of_more.beams };
        assert_eq!(PerKernel { beams: other, ..early_of_more }, early);
        assert_eq!(scales(0, PerKernel::splat(1.0)), PerKernel::splat(1.0));
    }

    #[test]
    fn a_first_radius_stays_within_its_bounds() {
        assert_eq!(first(Some(0.0), 0.01, 1.0), 0.01);
        assert_eq!(first(Some(0.5), 0.01, 1.0), 0.5);
        assert_eq!(first(None, 0.01, 1.0), 1.0);
        assert_eq!(first(Some(0.5), 2.0, 1.0), 1.0);
    }
}
