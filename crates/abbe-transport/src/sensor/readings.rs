//! The readings of meters.
//!
//! The film of a measurement has one column. Each reading has the same number of rows, so that few
//! readings keep all threads busy. Its noise is the standard error of the mean over the replicates,
//! without neighbours, which are other readings.
//!
//! If the rows of a reading share no random numbers, each gives its own estimate with seven degrees
//! of freedom, and the variance of the reading is their sum, so the intervals are narrower. A stop
//! rule for the error needs this: it stops at the first small estimate, which few degrees of
//! freedom often make too small.

use super::error_bars::{ErrorSquares, PixelMeans};
use super::pixel_sums::{PixelMean, passes_by_half};
use abbe_spectra::math::random::REPLICATES;
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer};
use std::sync::Arc;

#[derive(Debug, Clone)]
pub struct ReadingLayout {
    pub rows: usize,
    /// The owners of the readings, in the order of their rows.
    pub readings: Vec<ReadingOwner>,
    /// The bands of a spectrum have first moments, so that the wavelengths of lines are known.
    pub moments: bool,
}

#[derive(Debug, Clone, Copy)]
pub struct ReadingOwner {
    pub meter: usize,
    /// The observer whose function ȳ weights the wavelengths of the reading.
    pub observer: &'static Observer,
    /// True if a stop rule for the error waits for the reading.
    pub decides_stop: bool,
}

#[derive(Debug)]
pub(super) struct Measurement {
    pub(super) layout: Arc<ReadingLayout>,
    /// For each row and replicate, a sum for each band, and then a moment if the layout has them.
    pub(super) by_replicate: Vec<f64>,
    /// True if the rows of a reading share no random numbers.
    pub(super) independent_rows: bool,
}

/// The mean radiance at a sensor over the directions of its response, weighted by an observer.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The weighted mean radiance times 683 lm/W: cd/m² for the observer of the luminance.
    pub value: f64,
    /// The standard error of the value, if it is known.
    pub noise: Option<f64>,
    /// The magnitude of the estimated bias of the value, if it is known.
    pub bias: Option<f64>,
    /// The mean radiance in W/m²/sr. Y needs one of the colour-matching observers.
    pub xyz: [f64; 3],
    /// The number of degrees of freedom of the noise.
    pub degrees: f64,
    /// The factor on the noise in intervals, at least 1; see [`ErrorSquares::widening`].
    pub widening: f64,
}

/// The 97.5 % quantiles of Student's t with 1 to 6 degrees of freedom.
const TWO_SIDED: [f64; REPLICATES - 2] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447];

/// The 95 % quantiles of Student's t with 1 to 6 degrees of freedom.
const ONE_SIDED: [f64; REPLICATES - 2] = [6.314, 2.920, 2.353, 2.132, 2.015, 1.943];

/// The 97.5 % and the 95 % quantile of the normal distribution.
const NORMAL: [f64; 2] = [1.959_964, 1.644_854];

/// The largest bias of a reading with an interval, as a fraction of the value. The estimate is the
/// first term of a series in the radius of the kernel, so a large bias has large further terms.
const LARGEST_BIAS: f64 = 0.1;

/// The least divisor of a reading's relative error, by the largest reading of its meter.
const LEAST_FRACTION: f64 = 0.1;

impl ReadingLayout {
    /// Returns the channels of a film that need the memory of `bands` bands: sums over all passes,
    /// and of each replicate in half the precision.
    pub fn equivalent_channels(&self, bands: usize) -> usize {
        let channels = if self.moments { 2 * bands } else { bands };
        channels * (1 + REPLICATES / 2)
    }

    pub(super) fn observer(&self, row: usize) -> &'static Observer {
        self.readings[row / self.rows].observer
    }

    /// Returns the largest squared relative error among the readings that decide when a measurement
    /// stops. `None` if an error is unknown or all of them are 0.
    pub(super) fn largest_error(&self, readings: &[Reading]) -> Option<ErrorSquares> {
        let meters = self.readings.last()?.meter + 1;
        let mut largest = vec![0.0_f64; meters];
        for (owner, reading) in self.readings.iter().zip(readings) {
            largest[owner.meter] = largest[owner.meter].max(reading.value);
        }
        let mut worst = None::<ErrorSquares>;
        for (owner, reading) in self.readings.iter().zip(readings) {
            let scale = reading.value.max(LEAST_FRACTION * largest[owner.meter]);
            if scale <= 0.0 || !owner.decides_stop {
                continue;
            }
            let square = |error: f64| (error / scale).powi(2);
            let (sampling, bias) = (square(reading.noise?), square(reading.bias.unwrap_or(0.0)));
            let squares = ErrorSquares { bias, kernel_noise: 0.0, sampling };
            if worst.is_none_or(|worst| worst.relative() < squares.relative()) {
                worst = Some(squares);
            }
        }
        worst
    }
}

impl Reading {
    /// Returns half the width of the 95 % interval of the value. `None` if the noise is unknown, or
    /// if the bias is so large that its estimate is uncertain.
    pub fn half_interval_95(&self) -> Option<f64> {
        let (noise, bias) = (self.noise?, self.bias.unwrap_or(0.0));
        (bias <= LARGEST_BIAS * self.value)
            .then(|| half_interval_with_degrees(self.widening * noise, bias, self.degrees))
    }

    /// `passes` counts each replicate, and the rows may be `independent`.
    pub(super) fn of_rows(
        rows: impl ExactSizeIterator<Item = PixelMean>,
        passes: [u64; REPLICATES],
        independent: bool,
    ) -> Self {
        let count = rows.len() as f64;
        let blank = PixelMeans { y: [0.0; REPLICATES], bias: [0.0; 2] };
        let mut means = blank;
        let (all, halves) = (passes.iter().sum::<u64>(), passes_by_half(passes));
        let mean = |sum: f64, passes: u64| sum * LUMENS_PER_WATT / (passes.max(1) as f64 * count);
        let (mut total, mut xz) = (0.0, [0.0; 2]);
        // The sum of the variances of independent rows, and the sum of their squares.
        let mut variances = [0.0; 2];
        for PixelMean { xyz, y, bias } in rows {
            xz = [xz[0] + xyz[0], xz[1] + xyz[2]];
            total += xyz[1];
            let mut of_row = blank;
            (0..REPLICATES).for_each(|r| of_row.y[r] = mean(y[r], passes[r]));
            (0..REPLICATES).for_each(|r| means.y[r] += of_row.y[r]);
            (0..2).for_each(|h| means.bias[h] += mean(bias[h], halves[h]));
            let variance = of_row.variance(passes).unwrap_or(0.0);
            variances = [variances[0] + variance, variances[1] + variance * variance];
        }
        let known = halves.map(|passes| passes > 0);
        let (mut variance, mut degrees) =
            (means.variance(passes), passes.iter().filter(|&&passes| passes > 0).count().saturating_sub(1) as f64);
        if independent && variance.is_some() && variances[1] > 0.0 {
            // The degrees of freedom of a sum of variances (Welch 1947).
            degrees *= variances[0] * variances[0] / variances[1];
            variance = Some(variances[0]);
        }
        Self {
            value: mean(total, all),
            xyz: [xz[0], total, xz[1]].map(|sum| mean(sum, all) / LUMENS_PER_WATT),
            noise: variance.map(f64::sqrt),
            bias: means.squared_bias(known).map(|square| square.max(0.0).sqrt()),
            degrees,
            widening: 1.0,
        }
    }
}

/// Returns half the width of a 95 % interval, from the standard error `noise` with these degrees of
/// freedom. The bias is a magnitude, so the interval covers both signs of it. If the bias exceeds
/// the noise, only one end of the noise matters.
pub fn half_interval_with_degrees(noise: f64, bias: f64, degrees: f64) -> f64 {
    let [two, one] = [(TWO_SIDED, NORMAL[0]), (ONE_SIDED, NORMAL[1])]
        .map(|(table, z)| table.get((degrees as usize).max(1) - 1).copied().unwrap_or_else(|| student(z, degrees)));
    (bias + one * noise).max(two * noise)
}

/// Returns the quantile of Student's t from the quantile `z` of the normal distribution (Fisher &
/// Cornish 1960), to 0.001 from 7 degrees of freedom.
fn student(z: f64, degrees: f64) -> f64 {
    let z2 = z * z;
    let terms = [
        (z2 + 1.0) / 4.0,
        ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
    ];
    z * (1.0 + (terms[0] + (terms[1] + terms[2] / degrees) / degrees) / degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The half-widths for a standard error of 1 without bias are the quantiles of Student's t.
    #[test]
    fn intervals_have_the_quantiles_of_student() {
        let known = [(1.0, 12.706), (6.0, 2.447), (7.0, 2.364_6), (10.0, 2.228_1), (21.0, 2.079_6), (224.0, 1.970_6)];
        for (degrees, expected) in known {
            assert!((half_interval_with_degrees(1.0, 0.0, degrees) - expected).abs() < 1e-3, "{degrees}");
        }
        // A bias far above the noise counts with the one-sided quantile.
        assert!((half_interval_with_degrees(1.0, 100.0, 7.0) - 101.894_6).abs() < 1e-3);
    }
}
