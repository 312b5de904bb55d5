//! The readings of meters.
//!
//! The film of a measurement has one column. Each reading has the same number of rows, so that few
//! readings keep all threads busy. The noise of a reading is the standard error of the mean over
//! the replicates. It uses no neighbours, because these are other readings.

use super::channels::band_nm;
use super::error_bars::{ErrorSquares, PixelMeans};
use super::film::Film;
use super::picture::SpectralBands;
use crate::math::random::REPLICATES;
use crate::spectrum::{LUMENS_PER_WATT, Observer};
use std::sync::Arc;

/// The readings of a film.
#[derive(Debug, Clone)]
pub struct ReadingLayout {
    /// The number of rows of each reading.
    pub rows: usize,
    /// The owners of the readings, in the order of their rows.
    pub readings: Vec<ReadingOwner>,
}

/// The meter to which a reading belongs.
#[derive(Debug, Clone, Copy)]
pub struct ReadingOwner {
    /// The number of the meter.
    pub meter: usize,
    /// The observer whose function ȳ weights the wavelengths of the reading.
    pub observer: &'static Observer,
    /// True if a stop rule for the error waits for the reading.
    pub decides_stop: bool,
}

/// The data of a measurement in the film.
#[derive(Debug)]
pub(super) struct Measurement {
    pub(super) layout: Arc<ReadingLayout>,
    /// The sums of the spectral bands: for each row, for each replicate, one sum for each band.
    pub(super) by_replicate: Vec<f64>,
}

/// A reading: the mean radiance at a receptor over the directions of its response, weighted by an
/// observer.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The weighted mean radiance times 683 lm/W: cd/m² for the observer of the luminance.
    pub value: f64,
    /// The standard error of the value, if it is known.
    pub noise: Option<f64>,
    /// The magnitude of the estimated bias of the value, if it is known.
    pub bias: Option<f64>,
    /// X, Y and Z of the mean radiance, in W/m²/sr. Y is meaningless unless the observer is one of
    /// the colour-matching observers.
    pub xyz: [f64; 3],
    /// The number of degrees of freedom of the noise.
    pub degrees: usize,
    /// The spectrum. `None` if the film has no bands.
    pub spectrum: Option<ReadingSpectrum>,
}

/// The mean spectral radiance at a receptor.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingSpectrum {
    /// The centres of the bands in nm.
    pub centres_nm: Vec<f64>,
    /// The mean of each band in W/m²/sr/nm.
    pub values: Vec<f64>,
    /// The mean of each band and replicate in W/m²/sr/nm. Only replicates with passes are listed.
    pub by_replicate: Vec<Vec<f64>>,
}

/// The 97.5 % quantiles of Student's t with 1 to 7 degrees of freedom.
const TWO_SIDED: [f64; REPLICATES - 1] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365];

/// The 95 % quantiles of Student's t with 1 to 7 degrees of freedom.
const ONE_SIDED: [f64; REPLICATES - 1] = [6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895];

/// A reading is judged relative to its value, or relative to this share of the largest reading of
/// its meter, if this is more.
const LEAST_SHARE: f64 = 0.1;

impl ReadingLayout {
    /// Returns the observer of a row.
    pub(super) fn observer(&self, row: usize) -> &'static Observer {
        self.readings[row / self.rows].observer
    }

    /// Returns the squared relative error of the reading with the largest relative error, among the
    /// readings that decide when a measurement stops. Returns `None` if an error is unknown or if
    /// all of these readings are 0.
    pub(super) fn largest_error(&self, readings: &[Reading]) -> Option<ErrorSquares> {
        let meters = self.readings.last()?.meter + 1;
        let mut largest = vec![0.0_f64; meters];
        for (owner, reading) in self.readings.iter().zip(readings) {
            largest[owner.meter] = largest[owner.meter].max(reading.value);
        }
        let mut worst = None::<ErrorSquares>;
        for (owner, reading) in self.readings.iter().zip(readings) {
            let scale = reading.value.max(LEAST_SHARE * largest[owner.meter]);
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
    /// Returns half the width of the 95 % interval of the value. `None` if the noise is unknown.
    ///
    /// The bias is a magnitude, so the interval covers both signs of it. If the bias exceeds the
    /// noise, only one end of the noise matters.
    pub fn half_interval_95(&self) -> Option<f64> {
        let (noise, bias) = (self.noise?, self.bias.unwrap_or(0.0));
        let [two, one] = [TWO_SIDED, ONE_SIDED].map(|quantiles| quantiles[self.degrees.clamp(1, REPLICATES - 1) - 1]);
        Some((bias + one * noise).max(two * noise))
    }
}

impl Film {
    /// Returns the readings of a measurement so far. Returns none if the film records a picture.
    pub fn readings(&self) -> Vec<Reading> {
        let Some(measurement) = &self.measurement else { return Vec::new() };
        let rows = measurement.layout.rows;
        (0..measurement.layout.readings.len()).map(|number| self.reading(number * rows..(number + 1) * rows)).collect()
    }

    /// Returns the reading of these rows.
    fn reading(&self, rows: std::ops::Range<usize>) -> Reading {
        let count = rows.len() as f64;
        let mut means = PixelMeans { y: [0.0; REPLICATES], bias: [0.0; 2] };
        let (all, halves) = (self.passes(), self.passes_by_half());
        let mean = |sum: f64, passes: u64| sum * LUMENS_PER_WATT / (passes.max(1) as f64 * count);
        let (mut total, mut xz) = (0.0, [0.0; 2]);
        for row in rows.clone() {
            let sums = self.sums_of(row);
            xz = [xz[0] + sums.x.value(), xz[1] + sums.z.value()];
            let y = sums.y.map(|sum| sum.value());
            total += y.iter().sum::<f64>();
            (0..REPLICATES).for_each(|r| means.y[r] += mean(y[r], self.passes[r]));
            (0..2).for_each(|h| means.bias[h] += mean(sums.bias[h].value(), halves[h]));
        }
        let known = halves.map(|passes| passes > 0);
        Reading {
            value: mean(total, all),
            xyz: [xz[0], total, xz[1]].map(|sum| mean(sum, all) / LUMENS_PER_WATT),
            noise: means.variance(self.passes).map(f64::sqrt),
            bias: means.squared_bias(known).map(|square| square.max(0.0).sqrt()),
            degrees: self.passes.iter().filter(|&&passes| passes > 0).count().saturating_sub(1),
            spectrum: self.spectrum_of(rows),
        }
    }

    fn spectrum_of(&self, rows: std::ops::Range<usize>) -> Option<ReadingSpectrum> {
        let (bands, measurement) = (self.bands(), self.measurement.as_ref()?);
        if bands == 0 {
            return None;
        }
        let (from_nm, to_nm) = band_nm(0, bands);
        let width_nm = to_nm - from_nm;
        let sums = |replicate: usize| -> Vec<f64> {
            let mut sums = vec![0.0; bands];
            for row in rows.clone() {
                let first = (row * REPLICATES + replicate) * bands;
                let of_row = &measurement.by_replicate[first..first + bands];
                sums.iter_mut().zip(of_row).for_each(|(sum, value)| *sum += value);
            }
            sums
        };
        let mut total = vec![0.0; bands];
        let mut by_replicate = Vec::new();
        for (replicate, &passes) in self.passes.iter().enumerate().filter(|(_, passes)| **passes > 0) {
            let sums = sums(replicate);
            total.iter_mut().zip(&sums).for_each(|(total, sum)| *total += sum);
            let scale = 1.0 / (passes as f64 * rows.len() as f64 * width_nm);
            by_replicate.push(sums.into_iter().map(|sum| sum * scale).collect());
        }
        let scale = 1.0 / (self.passes().max(1) as f64 * rows.len() as f64 * width_nm);
        let values = total.into_iter().map(|sum| sum * scale).collect();
        Some(ReadingSpectrum { centres_nm: SpectralBands::centres_nm(bands), values, by_replicate })
    }
}

impl ReadingSpectrum {
    /// Returns the standard error of a function of the spectrum, from its values at the replicates.
    /// `None` if fewer than two replicates have passes, or if the function has no value for one of
    /// them.
    pub fn noise_of(&self, of: impl Fn(&[f64]) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.by_replicate.iter().map(|spectrum| of(spectrum)).collect::<Option<_>>()?;
        let count = values.len() as f64;
        if count < 2.0 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / count;
        let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Some((spread / (count - 1.0) / count).sqrt())
    }
}
