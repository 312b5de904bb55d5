//! The reference picture of a study, whose known noise is subtracted from measured errors.

use super::smooth_regions;
use abbe_session::output::compare::ErrorScale;
use abbe_spectra::math::elementary::hypot;
use abbe_transport::sensor::Picture;
use abbe_transport::sensor::error_distribution::TRIMMED;
use serde::{Deserialize, Serialize};

/// A mean over pixels, and the standard error of this mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanEstimate {
    pub value: f64,
    /// The standard error of the mean, computed as if pixels were independent.
    pub standard_error: f64,
}

impl MeanEstimate {
    fn mean(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (values.len() > 1).then(|| Self { value: mean, standard_error: (square / count).sqrt() })
    }

    /// Returns true if the mean exceeds three times its standard error.
    pub fn is_significant(&self) -> bool {
        self.value > 3.0 * self.standard_error
    }
}

/// The relative mean square error of a picture, after subtraction of the reference's noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PictureError {
    /// The error over all pixels.
    pub whole: MeanEstimate,
    /// The error over the pixels of smooth regions, if there are enough such pixels.
    pub smooth: Option<MeanEstimate>,
    /// The squared error of a typical pixel: of Y, over all pixels except the worst 2 %.
    pub typical: MeanEstimate,
}

#[derive(Debug, Clone)]
pub struct ReferencePicture {
    pub picture: Picture,
    scale: ErrorScale,
    variance: Vec<f64>,
    /// The squared relative noise of Y.
    variance_of_y: Vec<f64>,
    /// For each pixel, whether it is in a smooth region. Empty if there are too few.
    smooth: Vec<bool>,
}

impl ReferencePicture {
    /// Creates the mean of two pictures with independent noise and the same bias. Half of their
    /// difference estimates its noise in every channel.
    pub fn of_halves([a, b]: [&Picture; 2]) -> Self {
        let mut mean = a.clone();
        for (mean, other) in mean.xyz.iter_mut().zip(&b.xyz) {
            mean.iter_mut().zip(other).for_each(|(mean, other)| *mean = 0.5 * (*mean + other));
        }
        for (i, noise) in mean.noise.iter_mut().enumerate() {
            let both = a.noise[i].zip(b.noise[i]);
            *noise = both.map(|(a, b)| 0.5 * hypot(f64::from(a), f64::from(b)) as f32);
            mean.bias[i] = both.and(a.bias[i].zip(b.bias[i])).map(|(a, b)| 0.5 * (a + b));
        }
        let scale = ErrorScale::of(&mean);
        let variance = a.xyz.iter().zip(&mean.xyz).map(|(a, mean)| scale.relative_square(*a, *mean)).collect();
        let noise = a.xyz.iter().zip(&mean.xyz).map(|(a, mean)| (a[1] - mean[1]).powi(2)).collect();
        Self::new(mean, scale, variance, noise)
    }

    /// Creates a reference from a picture with a noise layer. Unknown noise counts as none.
    pub fn given(picture: Picture) -> Self {
        let scale = ErrorScale::of(&picture);
        let noise: Vec<f64> = picture.noise.iter().map(|noise| f64::from(noise.unwrap_or(0.0)).powi(2)).collect();
        let relative =
            |(noise, xyz): (&f64, &[f64; 3])| if *noise > 0.0 { noise / scale.unit(xyz[1], 1).powi(2) } else { 0.0 };
        let variance = noise.iter().zip(&picture.xyz).map(relative).collect();
        Self::new(picture, scale, variance, noise)
    }

    fn new(picture: Picture, scale: ErrorScale, variance: Vec<f64>, noise: Vec<f64>) -> Self {
        let smooth = smooth_regions::find(&picture, &noise);
        let enough = smooth.iter().filter(|&&smooth| smooth).count() as f64 >= LEAST_SMOOTH * smooth.len() as f64;
        let of_y =
            |(noise, xyz): (&f64, &[f64; 3])| if *noise > 0.0 { noise / scale.unit(xyz[1], 1).powi(2) } else { 0.0 };
        let variance_of_y = noise.iter().zip(&picture.xyz).map(of_y).collect();
        Self { picture, scale, variance, variance_of_y, smooth: if enough { smooth } else { Vec::new() } }
    }

    /// Returns the error of a picture, without pixels that are not finite in the reference.
    pub fn error_of(&self, picture: &Picture) -> PictureError {
        let square = |i: usize| self.scale.relative_square(picture.xyz[i], self.picture.xyz[i]) - self.variance[i];
        let typical = |i: usize| {
            let (a, b) = (picture.xyz[i][1], self.picture.xyz[i][1]);
            let square = if a == b { 0.0 } else { ((a - b) / self.scale.unit(b, 1)).powi(2) };
            [square, self.variance_of_y[i]]
        };
        PictureError { typical: self.typical(typical), ..self.estimate(square) }
    }

    /// Returns the mean of the differences of two numbers over all pixels except the worst 2 %,
    /// those with the largest first numbers.
    fn typical(&self, of: impl Fn(usize) -> [f64; 2]) -> MeanEstimate {
        let mut squares: Vec<[f64; 2]> = (0..self.variance.len())
            .filter(|&i| self.variance_of_y[i].is_finite() && self.picture.xyz[i][1].is_finite())
            .map(of)
            .collect();
        squares.sort_by(|a, b| a[0].total_cmp(&b[0]));
        squares.truncate(squares.len() - (TRIMMED * squares.len() as f64) as usize);
        let differences: Vec<f64> = squares.iter().map(|[square, variance]| square - variance).collect();
        MeanEstimate::mean(&differences).unwrap_or(MeanEstimate { value: f64::NAN, standard_error: f64::NAN })
    }

    pub fn own_variance(&self) -> PictureError {
        self.estimate(|i| self.variance[i])
    }

    /// Returns the mean square of the reference's bias, in the unit of the errors.
    pub fn estimated_bias_square(&self) -> f64 {
        let bias = |i: usize| {
            let bias = self.picture.bias[i].filter(|bias| *bias > 0.0);
            bias.map(|bias| f64::from(bias) / self.scale.unit(self.picture.xyz[i][1], 1))
        };
        self.estimate(|i| bias(i).map_or(0.0, |bias| bias.powi(2))).whole.value
    }

    /// Returns the fraction of smooth pixels, or `None` if there are too few.
    pub fn smooth_fraction(&self) -> Option<f64> {
        let count = self.smooth.iter().filter(|&&smooth| smooth).count();
        (!self.smooth.is_empty()).then(|| count as f64 / self.smooth.len() as f64)
    }

    fn estimate(&self, of: impl Fn(usize) -> f64) -> PictureError {
        let counts =
            |i: &usize| self.variance[*i].is_finite() && self.picture.xyz[*i].iter().all(|value| value.is_finite());
        let pixels: Vec<usize> = (0..self.variance.len()).filter(counts).collect();
        let whole: Vec<f64> = pixels.iter().map(|&i| of(i)).collect();
        let smooth: Vec<f64> = pixels.iter().filter(|&&i| self.smooth.get(i) == Some(&true)).map(|&i| of(i)).collect();
        let none = MeanEstimate { value: f64::NAN, standard_error: f64::NAN };
        let typical = self.typical(|i| [self.variance_of_y[i], 0.0]);
        PictureError { whole: MeanEstimate::mean(&whole).unwrap_or(none), smooth: MeanEstimate::mean(&smooth), typical }
    }
}

/// The least fraction of smooth pixels with which slopes are measured there.
const LEAST_SMOOTH: f64 = 0.02;

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};

    /// A grey picture with uniform noise of standard deviation `sigma`.
    fn noisy(level: f64, sigma: f64, seed: u64) -> Picture {
        let mut picture = Picture::black(64, 64);
        let mut stream = Stream::new(Seed::new(seed), Purpose::SurveyPhoton, 0, 0);
        for xyz in &mut picture.xyz {
            *xyz = [0; 3].map(|_| level + sigma * 12.0_f64.sqrt() * (stream.uniform() - 0.5));
        }
        picture
    }

    #[test]
    fn the_noise_of_the_reference_is_subtracted() {
        // Errors are divided by a unit with the noise of the reference, which adds 4 × error ×
        // variance to an error. This is negligible if the reference has less noise than the
        // picture.
        let reference = ReferencePicture::of_halves([&noisy(1.0, 0.02, 1), &noisy(1.0, 0.02, 2)]);
        let own = reference.own_variance();
        assert!((own.whole.value / (0.0002 / 1.01) - 1.0).abs() < 0.1, "{own:?}");
        for (level, sigma) in [(1.0, 0.05), (1.03, 0.02)] {
            let known = (sigma * sigma + (level - 1.0_f64).powi(2)) / 1.01;
            let found = reference.error_of(&noisy(level, sigma, 3)).whole;
            assert!((found.value - known).abs() < 4.0 * found.standard_error, "{found:?} {known}");
            assert!(found.standard_error < 0.1 * known, "{found:?}");
        }
    }

    #[test]
    fn a_given_reference_uses_its_noise_layer() {
        let mut exact = noisy(2.0, 0.0, 0);
        assert_eq!(ReferencePicture::given(exact.clone()).own_variance().whole.value, 0.0);
        exact.noise.fill(Some(0.2));
        let known = 0.04 / 4.04;
        assert!((ReferencePicture::given(exact).own_variance().whole.value / known - 1.0).abs() < 1e-6);
    }
}
