//! Patterns: maps from texture coordinates to texels.

use super::mapping::UvTransform;
use super::point::{LookupRandom, TexturePoint};
use super::pyramid::ImagePattern;
use abbe_spectra::math::elementary::{hypot, powf};
use abbe_spectra::math::noise::gradient_noise;
use glam::DVec3;

/// A map from texture coordinates to the number of a texel.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// A picture over the unit square of uv.
    Image(ImagePattern),
    /// Squares of side 1 in uv after the transform: 0 if row plus column is even, or else 1.
    Checker(UvTransform),
    /// Stripes of width 1 along v, of number 0 for 0 ≤ u < 1, and 1 beside it.
    Stripes(UvTransform),
    /// Selects the texel 1 with the probability of the noise, from 0 to 1, and otherwise 0.
    Noise(NoisePattern, UvTransform),
    /// Selects the texel 1 with the probability of the gradient, from 0 to 1, and otherwise 0.
    Gradient(GradientPattern, UvTransform),
}

/// A gradient t^`power`, whose coordinate t is limited to the range from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GradientPattern {
    /// True if t is the distance from the centre (0.5, 0.5), and 1 at 0.5; false if t is v.
    pub radial: bool,
    /// The exponent, above 0.
    pub power: f64,
}

impl GradientPattern {
    /// Returns the gradient at a point, from 0 to 1.
    pub fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let t = if self.radial { 2.0 * hypot(u - 0.5, v - 0.5) } else { v };
        let t = t.clamp(0.0, 1.0);
        if self.power == 1.0 { t } else { powf(t, self.power) }
    }
}

/// Fractal gradient noise (Perlin 2002). The first octave has a wavelength of about 1 in uv, and
/// each further one half the wavelength and half the weight of the octave before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoisePattern {
    /// The number of octaves, at least 1.
    pub octaves: u32,
    /// The seed.
    pub seed: u32,
}

/// Stretches gradient noise in a plane, within about ±0.7, to nearly the whole range from 0 to 1.
const GAIN: f64 = 0.75;

impl NoisePattern {
    /// Returns the noise at a point, from 0 to 1.
    pub fn at(&self, uv: [f64; 2]) -> f64 {
        let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
        // The third coordinate differs from the lattice, where the noise of all octaves is 0.
        let mut place = DVec3::new(uv[0], uv[1], 0.5);
        for octave in 0..self.octaves {
            sum += weight * gradient_noise(place, u64::from(self.seed) << 32 | u64::from(octave));
            total += weight;
            weight *= 0.5;
            place = DVec3::new(2.0 * place.x, 2.0 * place.y, 0.5);
        }
        (0.5 + GAIN * sum / total).clamp(0.0, 1.0)
    }
}

impl Pattern {
    /// Selects a texel at a point, by its weight in the filter over the point's footprint.
    pub fn texel(&self, point: &TexturePoint, random: &mut LookupRandom) -> u32 {
        if let Self::Image(image) = self {
            return image.texel(point, random);
        }
        let mut at = |transform: &UvTransform| jittered(transform, point, random);
        match self {
            Self::Image(_) => 0,
            Self::Checker(transform) => {
                let [u, v] = at(transform);
                odd(u.floor() + v.floor())
            }
            Self::Stripes(transform) => odd(at(transform)[0].floor()),
            Self::Noise(noise, transform) => {
                let value = noise.at(at(transform));
                u32::from(random.uniform() < value)
            }
            Self::Gradient(gradient, transform) => {
                let value = gradient.at(at(transform));
                u32::from(random.uniform() < value)
            }
        }
    }

    /// Returns the value, interpolated between those of texels, at a point selected at random
    /// within the footprint. A function of the value that is not linear, such as the colour of a
    /// film, needs it instead of a selected texel.
    pub fn interpolated(&self, point: &TexturePoint, random: &mut LookupRandom, value: impl Fn(usize) -> f64) -> f64 {
        let mixed = |weight: f64| value(0) + weight * (value(1) - value(0));
        match self {
            Self::Image(image) => image.interpolated(point, random, value),
            Self::Checker(_) | Self::Stripes(_) => value(self.texel(point, random) as usize),
            Self::Noise(noise, transform) => mixed(noise.at(jittered(transform, point, random))),
            Self::Gradient(gradient, transform) => mixed(gradient.at(jittered(transform, point, random))),
        }
    }

    pub(super) fn texel_count(&self) -> usize {
        match self {
            Self::Image(image) => image.texel_count(),
            Self::Checker(_) | Self::Stripes(_) | Self::Noise(..) | Self::Gradient(..) => 2,
        }
    }
}

/// Returns a point that is selected at random within the footprint of another point.
fn jittered(transform: &UvTransform, point: &TexturePoint, random: &mut LookupRandom) -> [f64; 2] {
    transform.apply(point).moved(random.uniform() - 0.5, random.uniform() - 0.5)
}

/// Returns 1 for an odd whole number, and 0 for an even one.
fn odd(number: f64) -> u32 {
    u32::from(number.rem_euclid(2.0) >= 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{Filter, ImageSize, Wrap};

    const SAME: UvTransform = UvTransform::IDENTITY;

    fn texel(pattern: &Pattern, uv: [f64; 2]) -> u32 {
        pattern.texel(&TexturePoint::new(uv), &mut LookupRandom::new(0.3))
    }

    #[test]
    fn squares_and_stripes_alternate_on_both_sides_of_zero() {
        for (uv, checker, stripes) in
            [([0.5, 0.5], 0, 0), ([1.5, 0.5], 1, 1), ([-0.5, 0.5], 1, 1), ([-0.5, -0.5], 0, 1), ([2.5, 1.5], 1, 0)]
        {
            assert_eq!(
                (texel(&Pattern::Checker(SAME), uv), texel(&Pattern::Stripes(SAME), uv)),
                (checker, stripes),
                "{uv:?}"
            );
        }
    }

    #[test]
    fn a_footprint_averages_a_pattern() {
        let point = TexturePoint { uv: [0.75, 0.5], footprint: [[1.0, 0.0], [0.0, 1.0]] };
        let mut random = LookupRandom::new(0.7);
        let count = 100_000;
        let second = (0..count).filter(|_| Pattern::Stripes(SAME).texel(&point, &mut random) == 1).count();
        assert!((second as f64 / f64::from(count) - 0.25).abs() < 0.005, "{second}");
    }

    /// A picture of two rows interpolates between them, and a gradient has its value at each point.
    #[test]
    fn values_are_interpolated_at_a_point() {
        let (size, random) = (ImageSize { width: 1, height: 2 }, &mut LookupRandom::new(0.4));
        let image = ImagePattern::new(size, [Wrap::Clamp; 2], Filter::Bilinear, SAME).unwrap();
        let picture = Pattern::Image(image);
        let gradient = |radial, power| Pattern::Gradient(GradientPattern { radial, power }, SAME);
        for (pattern, uv, known) in [
            (&picture, [0.5, 0.1], 100.0),
            (&picture, [0.5, 0.25], 100.0),
            (&picture, [0.5, 0.4], 160.0),
            (&gradient(false, 1.0), [0.2, 0.3], 160.0),
            (&gradient(false, 0.5), [0.2, 0.25], 200.0),
            (&gradient(true, 2.0), [0.75, 0.5], 150.0),
            (&gradient(true, 2.0), [0.0, 0.0], 300.0),
        ] {
            let found = pattern.interpolated(&TexturePoint::new(uv), random, |texel| [100.0, 300.0][texel]);
            assert!((found - known).abs() < 1e-9, "{pattern:?} at {uv:?}: {found}");
        }
    }

    /// Noise has a mean of one half, varies over most of its range, and its texels follow it.
    #[test]
    fn texels_follow_the_noise() {
        let noise = NoisePattern { octaves: 3, seed: 4 };
        let values: Vec<f64> =
            (0..40_000).map(|i| noise.at([0.173 * f64::from(i % 200), 0.131 * f64::from(i / 200)])).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let (low, high) = values.iter().fold((1.0_f64, 0.0_f64), |(low, high), &x| (low.min(x), high.max(x)));
        assert!((mean - 0.5).abs() < 0.02 && low < 0.2 && high > 0.8, "{mean} {low} {high}");
        let (uv, mut random) = ([3.3, 7.9], LookupRandom::new(0.1));
        let found = (0..100_000)
            .filter(|_| Pattern::Noise(noise, SAME).texel(&TexturePoint::new(uv), &mut random) == 1)
            .count();
        assert!((found as f64 * 1e-5 - noise.at(uv)).abs() < 0.006);
    }
}
