//! What errors are measured against: a reference picture whose own noise is known and taken off again.

use super::smooth;
use crate::output::compare::Scale;
use crate::sensor::Picture;
use serde::{Deserialize, Serialize};

/// A mean over pixels with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The mean.
    pub value: f64,
    /// Its standard error, pixels being taken for independent.
    pub standard_error: f64,
}

impl Estimate {
    fn mean(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (values.len() > 1).then(|| Self { value: mean, standard_error: (square / count).sqrt() })
    }

    /// Whether it stands clear of its own uncertainty.
    pub fn is_certain(&self) -> bool {
        self.value > 3.0 * self.standard_error
    }
}

/// How wrong a picture is: relative mean square errors, less what the reference's own noise adds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wrong {
    /// Over all pixels.
    pub whole: Estimate,
    /// Over those of smooth regions, if there are enough.
    pub smooth: Option<Estimate>,
}

/// A reference picture.
#[derive(Debug, Clone)]
pub struct Reference {
    /// The picture.
    pub picture: Picture,
    scale: Scale,
    /// The relative variance of each pixel.
    variance: Vec<f64>,
    /// Whether each pixel lies in a smooth region; empty if there are too few.
    smooth: Vec<bool>,
}

impl Reference {
    /// The mean of two pictures with independent noise and the same bias; half their difference tells the mean's noise, in every channel.
    pub fn of_halves([a, b]: [&Picture; 2]) -> Self {
        let mut mean = a.clone();
        for (mean, other) in mean.xyz.iter_mut().zip(&b.xyz) {
            mean.iter_mut().zip(other).for_each(|(mean, other)| *mean = 0.5 * (*mean + other));
        }
        for (i, noise) in mean.noise.iter_mut().enumerate() {
            let known = a.noise[i] >= 0.0 && b.noise[i] >= 0.0;
            *noise = if known { 0.5 * a.noise[i].hypot(b.noise[i]) } else { -1.0 };
            mean.bias[i] = if known { 0.5 * (a.bias[i] + b.bias[i]) } else { -1.0 };
        }
        let scale = Scale::of(&mean);
        let variance = a.xyz.iter().zip(&mean.xyz).map(|(a, mean)| scale.relative_square(*a, *mean)).collect();
        let noise = a.xyz.iter().zip(&mean.xyz).map(|(a, mean)| (a[1] - mean[1]).powi(2)).collect();
        Self::new(mean, scale, variance, noise)
    }

    /// A picture from elsewhere; its noise is what its error layer says of Y, and none where that is unknown.
    pub fn given(picture: Picture) -> Self {
        let scale = Scale::of(&picture);
        let noise: Vec<f64> = picture.noise.iter().map(|noise| f64::from(noise.max(0.0)).powi(2)).collect();
        let relative =
            |(noise, xyz): (&f64, &[f64; 3])| if *noise > 0.0 { noise / scale.unit(xyz[1], 1).powi(2) } else { 0.0 };
        let variance = noise.iter().zip(&picture.xyz).map(relative).collect();
        Self::new(picture, scale, variance, noise)
    }

    fn new(picture: Picture, scale: Scale, variance: Vec<f64>, noise: Vec<f64>) -> Self {
        let smooth = smooth::regions(&picture, &noise);
        let enough = smooth.iter().filter(|&&smooth| smooth).count() as f64 >= LEAST_SMOOTH * smooth.len() as f64;
        Self { picture, scale, variance, smooth: if enough { smooth } else { Vec::new() } }
    }

    /// How wrong a picture of the same size is. Pixels that are no numbers in the reference do not count.
    pub fn wrong(&self, picture: &Picture) -> Wrong {
        let square = |i: usize| self.scale.relative_square(picture.xyz[i], self.picture.xyz[i]) - self.variance[i];
        self.estimate(square)
    }

    /// The relative variance of the reference itself.
    pub fn own_variance(&self) -> Wrong {
        self.estimate(|i| self.variance[i])
    }

    /// The square of the bias that the picture itself claims, relative as errors are.
    pub fn claimed_bias_square(&self) -> f64 {
        let bias = |i: usize| f64::from(self.picture.bias[i].max(0.0)) / self.scale.unit(self.picture.xyz[i][1], 1);
        self.estimate(|i| if self.picture.bias[i] > 0.0 { bias(i).powi(2) } else { 0.0 }).whole.value
    }

    /// The share of pixels in smooth regions; `None` if there are too few.
    pub fn smooth_share(&self) -> Option<f64> {
        let count = self.smooth.iter().filter(|&&smooth| smooth).count();
        (!self.smooth.is_empty()).then(|| count as f64 / self.smooth.len() as f64)
    }

    fn estimate(&self, of: impl Fn(usize) -> f64) -> Wrong {
        let counts =
            |i: &usize| self.variance[*i].is_finite() && self.picture.xyz[*i].iter().all(|value| value.is_finite());
        let pixels: Vec<usize> = (0..self.variance.len()).filter(counts).collect();
        let whole: Vec<f64> = pixels.iter().map(|&i| of(i)).collect();
        let smooth: Vec<f64> = pixels.iter().filter(|&&i| self.smooth.get(i) == Some(&true)).map(|&i| of(i)).collect();
        let none = Estimate { value: f64::NAN, standard_error: f64::NAN };
        Wrong { whole: Estimate::mean(&whole).unwrap_or(none), smooth: Estimate::mean(&smooth) }
    }
}

/// Fewer pixels than this share are no region to measure slopes in.
const LEAST_SMOOTH: f64 = 0.02;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{Purpose, Stream};

    /// A grey picture with uniform noise of a standard deviation, of its own seed.
    fn noisy(level: f64, sigma: f64, seed: u64) -> Picture {
        let mut picture = Picture::black(64, 64);
        let mut stream = Stream::new(seed, Purpose::Pilot, 0, 0);
        for xyz in &mut picture.xyz {
            *xyz = [0; 3].map(|_| level + sigma * 12.0_f64.sqrt() * (stream.uniform() - 0.5));
        }
        picture
    }

    #[test]
    fn the_reference_s_own_noise_is_taken_off() {
        // Errors are relative to the noisy reference, which adds 4 × error × variance: nothing where the reference is better than the picture.
        let reference = Reference::of_halves([&noisy(1.0, 0.02, 1), &noisy(1.0, 0.02, 2)]);
        let own = reference.own_variance();
        assert!((own.whole.value / (0.0002 / 1.01) - 1.0).abs() < 0.1, "{own:?}");
        for (level, sigma) in [(1.0, 0.05), (1.03, 0.02)] {
            let known = (sigma * sigma + (level - 1.0_f64).powi(2)) / 1.01;
            let found = reference.wrong(&noisy(level, sigma, 3)).whole;
            assert!((found.value - known).abs() < 4.0 * found.standard_error, "{found:?} {known}");
            assert!(found.standard_error < 0.1 * known, "{found:?}");
        }
    }

    #[test]
    fn a_given_reference_is_taken_at_its_word() {
        let mut exact = noisy(2.0, 0.0, 0);
        assert_eq!(Reference::given(exact.clone()).own_variance().whole.value, 0.0);
        exact.noise.fill(0.2);
        let known = 0.04 / 4.04;
        assert!((Reference::given(exact).own_variance().whole.value / known - 1.0).abs() < 1e-6);
    }
}
