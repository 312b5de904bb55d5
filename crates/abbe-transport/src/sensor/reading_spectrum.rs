//! The spectra of readings, in bands of equal width.

use super::channels::{band_centre_nm, band_nm};
use super::film::Film;
use abbe_spectra::math::random::REPLICATES;
use abbe_spectra::spectrum::{LineSegment, Spectrum};

/// The mean spectral radiance at a sensor, in bands of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingSpectrum {
    pub mean: ReadingBands,
    /// The means of the replicates. Only replicates with passes are listed.
    pub by_replicate: Vec<ReadingBands>,
}

/// Spectral radiance in bands of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingBands {
    /// The spectral radiance of each band in W/m²/sr/nm.
    pub values: Vec<f64>,
    /// The spectral radiance times the mean distance of the light from the centre of the band, in
    /// W/m²/sr. Empty if the layout has no moments.
    moments: Vec<f64>,
}

/// The least width of a line of [`ReadingBands::light`], as a fraction of the width of its band.
const NARROWEST_LINE: f64 = 0.01;

impl Film {
    /// Returns `None` without bands or for a picture.
    pub fn reading_spectrum(&self, number: usize) -> Option<ReadingSpectrum> {
        let ((bands, channels), measurement) = (self.bands(), self.measurement.as_ref()?);
        if bands == 0 {
            return None;
        }
        let rows = number * measurement.layout.rows..(number + 1) * measurement.layout.rows;
        let (from_nm, to_nm) = band_nm(0, bands);
        let width_nm = to_nm - from_nm;
        let sums = |replicate: usize| -> Vec<f64> {
            let mut sums = vec![0.0; channels];
            for row in rows.clone() {
                let first = (row * REPLICATES + replicate) * channels;
                let of_row = &measurement.by_replicate[first..first + channels];
                sums.iter_mut().zip(of_row).for_each(|(sum, value)| *sum += value);
            }
            sums
        };
        let mean = |sums: Vec<f64>, passes: u64| {
            let scale = 1.0 / (passes.max(1) as f64 * rows.len() as f64 * width_nm);
            let mut values: Vec<f64> = sums.into_iter().map(|sum| sum * scale).collect();
            let moments = values.split_off(bands);
            ReadingBands { values, moments }
        };
        let mut total = vec![0.0; channels];
        let mut by_replicate = Vec::new();
        for (replicate, &passes) in self.passes.iter().enumerate().filter(|(_, passes)| **passes > 0) {
            let sums = sums(replicate);
            total.iter_mut().zip(&sums).for_each(|(total, sum)| *total += sum);
            by_replicate.push(mean(sums, passes));
        }
        Some(ReadingSpectrum { mean: mean(total, self.passes()), by_replicate })
    }
}

impl ReadingBands {
    /// Returns `count` bands, a divisor of their number.
    #[must_use]
    pub fn merged(&self, count: usize) -> Self {
        let all = self.values.len();
        let group = all / count;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / group as f64;
        let values = self.values.chunks_exact(group).map(mean).collect();
        let from_wide_centre = |band: usize| band_centre_nm(band, all) - band_centre_nm(band / group, count);
        let moment = |(band, moment): (usize, &f64)| moment + self.values[band] * from_wide_centre(band);
        let moments: Vec<f64> = self.moments.iter().enumerate().map(moment).collect();
        Self { values, moments: moments.chunks_exact(group).map(mean).collect() }
    }

    /// Returns a spectral line for each band, at the mean wavelength, or at the centre.
    pub fn light(&self) -> Spectrum {
        let count = self.values.len();
        let line = |(band, &value): (usize, &f64)| {
            let (from, to) = band_nm(band, count);
            let (centre, largest) = (band_centre_nm(band, count), 0.5 * (1.0 - NARROWEST_LINE) * (to - from));
            let shift = self.moments.get(band).map_or(0.0, |moment| moment / value).clamp(-largest, largest);
            let half = 0.5 * (to - from) - shift.abs();
            LineSegment { nm: (centre + shift - half, centre + shift + half), power: value * (to - from) }
        };
        Spectrum::from_segments(
            &self.values.iter().enumerate().filter(|(_, value)| **value > 0.0).map(line).collect::<Vec<_>>(),
        )
    }
}

impl ReadingSpectrum {
    /// Returns `count` bands, a divisor of their number.
    #[must_use]
    pub fn merged(&self, count: usize) -> Self {
        Self {
            mean: self.mean.merged(count),
            by_replicate: self.by_replicate.iter().map(|bands| bands.merged(count)).collect(),
        }
    }

    /// Returns the number of degrees of freedom of [`Self::noise_of`].
    pub fn degrees(&self) -> f64 {
        self.by_replicate.len().saturating_sub(1) as f64
    }

    /// Returns the standard error of a function of the spectrum, from the replicates. `None` for
    /// fewer than two replicates with passes, or if the function has no value for one of them.
    pub fn noise_of(&self, of: impl Fn(&ReadingBands) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.by_replicate.iter().map(of).collect::<Option<_>>()?;
        let count = values.len() as f64;
        if count < 2.0 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / count;
        let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Some((spread / (count - 1.0) / count).sqrt())
    }
}
