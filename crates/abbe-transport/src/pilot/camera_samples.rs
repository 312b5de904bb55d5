//! The numbers of camera samples of the pixels.
//!
//! Pixels at edges, in penumbras and behind glass are noisier than others. The variance of the
//! picture at equal time is least if the samples of each pixel are proportional to σ/√c, for the
//! standard deviation σ and the work c of one sample (Neyman 1934, "On the Two Different Aspects of
//! the Representative Method"). The pilot estimates both from samples that are not part of the
//! picture, because numbers that depended on the picture's own samples would bias it (Kirk & Arvo
//! 1991, "Unbiased Sampling Techniques for Image Synthesis").

use super::small_pass::{TILE, mean_of_components};
use crate::pass::CameraSamples;
use rayon::prelude::*;
use std::f64::consts::FRAC_1_SQRT_2;

/// The most camera samples of a pixel in a pass, if the scene does not state the number.
pub(super) const MOST_SAMPLES: f64 = 16.0;

/// The side in pixels of the squares of the film whose pixels have the same number of samples.
const SQUARE: usize = 2;

/// The least number of squares of a film on which the noise is measured. On a smaller film, the
/// surroundings of a square are a large part of the film.
const LEAST_SQUARES: usize = 100;

/// The noise of a square is estimated from the squares up to this distance in each direction.
const RADIUS: usize = 1;

/// The fraction of the mean over the film in the relative variance of a square.
const FRACTION_OF_MEAN: f64 = 0.2;

/// The largest threshold. The others differ by factors of √2.
const LARGEST_THRESHOLD: f64 = 2.0;

const THRESHOLDS: i32 = 16;

/// The largest variance of a square relative to the mean of the picture, as a multiple of the
/// film's mean, because a rare bright sample would otherwise decide alone.
const LARGEST_SQUARE: f64 = 64.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SampleChoice {
    /// The mean number of samples per pixel.
    pub(super) mean: f64,
    /// The work of the samples of a pass, divided by the work of one sample per pixel.
    pub(super) work: f64,
    /// The measures of the variance that the samples of a pass cause.
    pub(super) variances: [f64; 3],
    number: SampleNumber,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum SampleNumber {
    Same(u64),
    /// As many as σ/√c contains the threshold, for the relative standard deviation σ of a sample,
    /// and its work c divided by the mean.
    ByNoise {
        threshold: f64,
    },
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ProbedPixel {
    /// X, Y and Z of the sample in W/m²/sr.
    pub(super) sample: [f64; 3],
    /// X, Y and Z of the splats of the pixel in W/m²/sr.
    pub(super) splats: [f64; 3],
    /// The work of the sample in instructions.
    pub(super) work: f64,
}

#[derive(Debug)]
pub(super) struct FilmNoise {
    size: (usize, usize),
    /// The squares of the film, row by row.
    squares: Vec<SampleNoise>,
}

#[derive(Debug, Clone, Copy)]
struct SampleNoise {
    /// The variance relative to the light around the square.
    relative: f64,
    /// The variance relative to the mean of the picture.
    of_picture: f64,
    /// The squares of X, Y and Z to which `relative` refers.
    squares: [f64; 3],
    /// The work of the sample, divided by the mean work of a sample.
    work: f64,
}

impl FilmNoise {
    /// Measures the noise with a sample in each square, by `probe`. `None` for few pixels.
    pub(super) fn measure(
        (width, height): (usize, usize),
        probe: impl Fn(&[usize]) -> Vec<ProbedPixel> + Sync,
    ) -> Option<Self> {
        let (columns, rows) = (width.div_ceil(SQUARE), height.div_ceil(SQUARE));
        if columns * rows < LEAST_SQUARES {
            return None;
        }
        let pixel_of = |x: usize, y: usize| {
            // The places alternate, so that the samples do not miss a thin line.
            let place = (x + 2 * y) % (SQUARE * SQUARE);
            let (x, y) = (SQUARE * x + place % SQUARE, SQUARE * y + place / SQUARE);
            y.min(height - 1) * width + x.min(width - 1)
        };
        let probe_row = |y: usize| probe(&(0..columns).map(|x| pixel_of(x, y)).collect::<Vec<_>>());
        let probed: Vec<Vec<ProbedPixel>> = (0..rows).into_par_iter().map(probe_row).collect::<Vec<_>>();
        let mut picture = ProbeSums::default();
        probed.iter().flatten().for_each(|pixel| picture.add(pixel));
        let noise = |x: usize, y: usize| {
            let mut around = ProbeSums::default();
            for row in &probed[y.saturating_sub(RADIUS)..(y + RADIUS + 1).min(rows)] {
                row[x.saturating_sub(RADIUS)..(x + RADIUS + 1).min(columns)].iter().for_each(|pixel| around.add(pixel));
            }
            around.noise(&picture)
        };
        let mut squares = Vec::with_capacity(columns * rows);
        for y in 0..rows {
            squares.extend((0..columns).map(|x| noise(x, y)));
        }
        Some(Self { size: (width, height), squares }.with_fraction_of_mean())
    }

    fn square_of(&self, pixel: usize) -> &SampleNoise {
        let (width, _) = self.size;
        &self.squares[pixel / width / SQUARE * width.div_ceil(SQUARE) + pixel % width / SQUARE]
    }

    /// Compares pixels and their variances of a sample of X, Y and Z with the measured noise.
    /// Returns the ratio of the means over these pixels of the relative variances.
    pub(super) fn ratio_of(&self, variances: impl Iterator<Item = (usize, [f64; 3])>) -> f64 {
        let (sum, of_all) = variances.fold((0.0, 0.0), |(sum, of_all), (pixel, variance)| {
            let square = self.square_of(pixel);
            (sum + mean_of_components(|c| variance[c] / square.squares[c]), of_all + square.relative)
        });
        sum / of_all
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        for square in &mut self.squares {
            square.relative *= factor;
            square.of_picture *= factor;
        }
        self
    }

    /// Mixes the film's mean into each relative variance. Few samples around a square may not show
    /// that bright samples are possible but rare.
    fn with_fraction_of_mean(mut self) -> Self {
        let sum: f64 = self.squares.iter().map(|square| square.relative).sum();
        let mean = sum / self.squares.len() as f64;
        for square in &mut self.squares {
            square.relative += FRACTION_OF_MEAN * (mean - square.relative);
        }
        self
    }

    /// Returns equal numbers of samples first, followed by numbers that depend on the noise.
    pub(super) fn choices(&self, same: u64) -> Vec<SampleChoice> {
        let sum: f64 = self.squares.iter().map(|square| square.of_picture).sum();
        let limit = LARGEST_SQUARE * sum / self.squares.len() as f64;
        let mut choices = vec![self.choice(limit, SampleNumber::Same(same))];
        let mut threshold = LARGEST_THRESHOLD;
        for _ in 0..THRESHOLDS {
            choices.push(self.choice(limit, SampleNumber::ByNoise { threshold }));
            threshold *= FRAC_1_SQRT_2;
        }
        choices
    }

    /// Measures the variance of a choice: the mean of the relative variances of the pixels, their
    /// variance relative to the mean of the picture (at most `limit` in a square), and the mean of
    /// the relative variances of the means of square blocks.
    #[inline(never)]
    fn choice(&self, limit: f64, number: SampleNumber) -> SampleChoice {
        let (mut samples, mut work, mut relative, mut of_picture) = (0.0, 0.0, 0.0, 0.0);
        for square in &self.squares {
            let count = number.of(square) as f64;
            samples += count;
            work += count * square.work;
            relative += square.relative / count;
            of_picture += square.of_picture.min(limit) / count;
        }
        let [mean, work, relative, of_picture] =
            [samples, work, relative, of_picture].map(|sum| sum / self.squares.len() as f64);
        SampleChoice { mean, work, variances: [relative, of_picture, relative / (TILE * TILE) as f64], number }
    }

    pub(super) fn samples(&self, choice: &SampleChoice) -> CameraSamples {
        if let SampleNumber::Same(count) = choice.number {
            return CameraSamples::Same(count);
        }
        let (width, height) = self.size;
        let counts = (0..width * height).map(|pixel| choice.number.of(self.square_of(pixel)) as u8).collect();
        CameraSamples::Each(counts, choice.mean)
    }
}

impl SampleNumber {
    fn of(self, square: &SampleNoise) -> u64 {
        match self {
            Self::Same(count) => count,
            Self::ByNoise { threshold } => {
                ((square.relative / square.work).sqrt() / threshold).round().clamp(1.0, MOST_SAMPLES) as u64
            }
        }
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct ProbeSums {
    count: f64,
    samples: [f64; 3],
    squares: [f64; 3],
    splats: [f64; 3],
    work: f64,
}

impl ProbeSums {
    fn add(&mut self, pixel: &ProbedPixel) {
        self.count += 1.0;
        for c in 0..3 {
            let sample = pixel.sample[c];
            self.samples[c] += sample;
            self.squares[c] += sample * sample;
            self.splats[c] += pixel.splats[c];
        }
        self.work += pixel.work;
    }

    /// Returns the mean light of the pixels, as X, Y or Z.
    fn mean(&self, c: usize) -> f64 {
        (self.samples[c] + self.splats[c]) / self.count
    }

    /// Returns the noise in the middle of these pixels. `picture` sums over the film.
    fn noise(&self, picture: &Self) -> SampleNoise {
        let of_picture: [f64; 3] = std::array::from_fn(|c| picture.mean(c).powi(2).max(f64::MIN_POSITIVE));
        // The mean of the picture limits the weight of dark pixels.
        let squares = std::array::from_fn(|c| self.mean(c).powi(2) + 0.01 * of_picture[c]);
        let variance: [f64; 3] = std::array::from_fn(|c| {
            let spread = (self.squares[c] - self.samples[c].powi(2) / self.count).max(0.0);
            spread / (self.count - 1.0).max(1.0)
        });
        let [relative, of_picture] =
            [squares, of_picture].map(|squares| mean_of_components(|c| variance[c] / squares[c]));
        let [work, of_all] = [self, picture].map(|sums| (sums.work / sums.count).max(f64::MIN_POSITIVE));
        SampleNoise { relative, of_picture, squares, work: work / of_all }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};

    const SIDE: usize = 64;

    /// Returns the noise of a film on which the samples of a pixel are uniform numbers around 1,
    /// with this amplitude. `work` is the work of a sample of the pixel.
    fn noise(amplitude: impl Fn(usize) -> f64 + Sync, work: impl Fn(usize) -> f64 + Sync) -> FilmNoise {
        let probe = |&pixel: &usize| {
            let mut stream = Stream::new(Seed::new(7), Purpose::SurveyPhoton, 0, pixel as u64);
            let light = 1.0 + amplitude(pixel) * (2.0 * stream.uniform() - 1.0);
            ProbedPixel { sample: [light - 0.5; 3], splats: [0.5; 3], work: work(pixel) }
        };
        FilmNoise::measure((SIDE, SIDE), |pixels| pixels.iter().map(probe).collect())
            .unwrap_or_else(|| panic!("the film is large"))
    }

    fn is_left(pixel: usize) -> bool {
        pixel % SIDE < SIDE / 2
    }

    /// Returns the mean numbers of samples in the left half and in the right half of the film.
    fn means_of_halves(samples: &CameraSamples) -> [f64; 2] {
        let mean = |left: bool| {
            let pixels = (0..SIDE * SIDE).filter(|&pixel| is_left(pixel) == left);
            pixels.map(|pixel| samples.of(pixel) as f64).sum::<f64>() / (SIDE * SIDE / 2) as f64
        };
        [true, false].map(mean)
    }

    /// The left half has three times the standard deviation of the right half. A fifth of each
    /// variance is the mean over the film, so the ratio of the numbers is √(8.2/1.8) = 2.1. The
    /// squares between the halves make it smaller.
    #[test]
    fn noisy_pixels_get_more_samples() {
        let noise = noise(|pixel| if is_left(pixel) { 0.9 } else { 0.3 }, |_| 1.0);
        let choice = noise.choices(2)[10];
        let [left, right] = means_of_halves(&noise.samples(&choice));
        assert!((1.8..2.2).contains(&(left / right)), "{left} and {right}");
        assert!((choice.mean - 0.5 * (left + right)).abs() < 1e-9);
        assert_eq!(noise.samples(&noise.choices(2)[0]), CameraSamples::Same(2));
    }

    #[test]
    fn samples_with_four_times_the_work_get_half_the_number() {
        let noise = noise(|_| 0.9, |pixel| if is_left(pixel) { 4.0 } else { 1.0 });
        let choice = noise.choices(2)[10];
        let [left, right] = means_of_halves(&noise.samples(&choice));
        assert!((right / left - 2.0).abs() < 0.2, "{left} and {right}");
        let work = (4.0 * left + right) / 5.0;
        assert!((choice.work / work - 1.0).abs() < 0.05, "{} instead of {work}", choice.work);
    }

    /// A uniform number in [−1, 1) has the variance 1/3.
    #[test]
    fn the_variances_of_a_choice_are_those_of_its_samples() {
        let noise = noise(|_| 0.6, |_| 1.0);
        let choices = noise.choices(2);
        for (choice, count) in [(choices[0], 2.0), (choices[choices.len() - 1], 16.0)] {
            assert_eq!(choice.mean, count);
            let expected = 0.36 / 3.0 / count;
            for (measure, factor) in [(0, 1.0), (1, 1.0), (2, 16.0)] {
                let found = factor * choice.variances[measure];
                assert!((found / expected - 1.0).abs() < 0.12, "{found} instead of {expected}");
            }
        }
        let scaled = noise.scaled(0.25);
        assert!((scaled.choices(1)[0].variances[0] / 0.03 - 1.0).abs() < 0.1);
    }

    #[test]
    fn every_pixel_of_a_film_has_a_sample() {
        for size in [(200, 1), (1, 201), (21, 19)] {
            for amplitude in [0.0, 1.0] {
                let probe =
                    |&pixel: &usize| ProbedPixel { sample: [amplitude * pixel as f64; 3], ..ProbedPixel::default() };
                let noise = FilmNoise::measure(size, |pixels| pixels.iter().map(probe).collect()).unwrap();
                for choice in noise.choices(2) {
                    let samples = noise.samples(&choice);
                    assert!((0..size.0 * size.1).all(|pixel| (1..=16).contains(&samples.of(pixel))), "{size:?}");
                }
            }
        }
    }
}
