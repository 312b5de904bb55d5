//! The spectral radiances of the pixels of an environment map.

use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{BAND_NM, Outside, Spectrum};

/// Spectral radiances in bands of wavelengths, pixel by pixel.
///
/// A value is the radiance throughout its band, because `abbe render` writes means over bands. The
/// edges of a band lie in the middle between neighbouring wavelengths. The first and the last band
/// extend as far beyond their wavelengths as they reach to the other side.
#[derive(Debug)]
pub struct EnvironmentBands {
    /// The edges of the bands in nm, ascending, within 360–830 nm.
    edges_nm: Vec<f64>,
    /// In W/m²/sr/nm, one value for each band of a pixel.
    values: Vec<f32>,
    /// The radiances of the pixels over the band in W/m²/sr.
    radiances: Vec<f64>,
}

/// The width in nm of the steps between the bands of a mean spectrum.
const STEP_NM: f64 = 1e-6;

impl EnvironmentBands {
    /// Creates the bands with these wavelengths in nm. `values` has one value for each wavelength
    /// of a pixel, in W/m²/sr/nm.
    ///
    /// # Errors
    /// Returns an error if there are fewer than two wavelengths, if they do not ascend, if no band
    /// lies within 360–830 nm, or if a value is negative or not finite.
    pub fn new(nm: &[f64], values: Vec<f32>) -> Result<Self> {
        let count = nm.len();
        if count < 2 || nm.windows(2).any(|pair| pair[0] >= pair[1]) || !values.len().is_multiple_of(count) {
            let what = format!("spectral channels at {nm:?} nm");
            return Err(Error::input(what).expected("two or more, at ascending wavelengths"));
        }
        if let Some(value) = values.iter().find(|value| !(**value >= 0.0 && value.is_finite())) {
            return Err(Error::input(format!("a spectral radiance of {value}")).expected("finite values of at least 0"));
        }
        let middle = |pair: &[f64]| 0.5 * (pair[0] + pair[1]);
        let first = nm[0] - 0.5 * (nm[1] - nm[0]);
        let last = nm[count - 1] + 0.5 * (nm[count - 1] - nm[count - 2]);
        let edges = std::iter::once(first).chain(nm.windows(2).map(middle)).chain([last]);
        let edges_nm: Vec<f64> = edges.map(|edge| edge.clamp(BAND_NM.0, BAND_NM.1)).collect();
        if edges_nm[0] >= edges_nm[count] {
            let what = format!("spectral channels from {} to {} nm", nm[0], nm[count - 1]);
            return Err(Error::input(what).expected(format!("wavelengths between {} and {} nm", BAND_NM.0, BAND_NM.1)));
        }
        let of_pixel = |pixel: &[f32]| {
            let bands = pixel.iter().zip(edges_nm.windows(2));
            bands.map(|(value, edges)| f64::from(*value) * (edges[1] - edges[0])).sum()
        };
        let radiances = values.chunks_exact(count).map(of_pixel).collect();
        Ok(Self { edges_nm, values, radiances })
    }

    /// The number of bands.
    fn count(&self) -> usize {
        self.edges_nm.len() - 1
    }

    /// The radiance of a pixel over the band in W/m²/sr.
    #[inline]
    pub(super) fn radiance(&self, pixel: usize) -> f64 {
        self.radiances[pixel]
    }

    /// The spectral radiance of a pixel at a wavelength in nm, in W/m²/sr/nm.
    #[inline]
    pub(super) fn at(&self, pixel: usize, nm: f64) -> f64 {
        let above = self.edges_nm.partition_point(|edge| *edge <= nm);
        // The last edge belongs to the last band.
        let above = if above > self.count() && nm == self.edges_nm[self.count()] { self.count() } else { above };
        if above == 0 || above > self.count() { 0.0 } else { f64::from(self.values[pixel * self.count() + above - 1]) }
    }

    /// The sum of the spectra of all pixels with a weight for each. It is nowhere below the sum of
    /// the bands, because the steps between them lie in the smaller of two bands.
    pub(super) fn weighted_sum(&self, weight: impl Fn(usize) -> f64) -> Spectrum {
        let mut sums = vec![0.0; self.count()];
        for (pixel, values) in self.values.chunks_exact(self.count()).enumerate() {
            let weight = weight(pixel);
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        let wide: Vec<(f64, [f64; 2])> =
            sums.iter().copied().zip(self.edges_nm.windows(2).map(|pair| [pair[0], pair[1]])).collect();
        let mut knots: Vec<(f64, f64)> = Vec::new();
        for (value, [from, to]) in wide.into_iter().filter(|(_, [from, to])| to - from > 8.0 * STEP_NM) {
            match knots.last_mut() {
                Some((end, before)) if value > *before => {
                    *end -= STEP_NM;
                    knots.push((from, value));
                }
                Some(_) => knots.push((from + STEP_NM, value)),
                None => knots.push((from, value)),
            }
            knots.push((to, value));
        }
        let (nm, values): (Vec<f64>, Vec<f64>) = knots.into_iter().unzip();
        Spectrum::table(&nm, &values, Outside::Zero).expect("bands with ascending edges and values of at least 0")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels with three bands of 100, 100 and 50 nm.
    fn bands() -> EnvironmentBands {
        EnvironmentBands::new(&[450.0, 550.0, 600.0], vec![1.0, 2.0, 0.0, 0.0, 0.0, 4.0]).unwrap()
    }

    #[test]
    fn each_value_holds_throughout_its_band() {
        let bands = bands();
        for (nm, expected) in
            [(399.0, 0.0), (400.0, 1.0), (499.9, 1.0), (500.1, 2.0), (574.9, 2.0), (575.1, 0.0), (700.0, 0.0)]
        {
            assert_eq!(bands.at(0, nm), expected, "{nm}");
        }
        assert_eq!([bands.at(1, 625.0), bands.at(1, 625.1)], [4.0, 0.0]);
        assert_eq!([bands.radiance(0), bands.radiance(1)], [100.0 + 150.0, 200.0]);
    }

    /// Importance sampling by the mean spectrum needs it above 0 wherever a pixel emits.
    #[test]
    fn the_sum_has_the_power_of_the_pixels_and_covers_their_bands() {
        let bands = bands();
        let sum = bands.weighted_sum(|pixel| [1.0, 0.5][pixel]);
        assert!((sum.integral() / (250.0 + 100.0) - 1.0).abs() < 1e-7, "{}", sum.integral());
        for i in 0..4700 {
            let nm = 360.05 + 0.1 * f64::from(i);
            assert!(sum.at(nm) >= bands.at(0, nm) + 0.5 * bands.at(1, nm) - 1e-12, "{nm}");
        }
    }

    #[test]
    fn bands_are_cut_at_the_ends_of_the_visible_band() {
        let bands = EnvironmentBands::new(&[350.0, 380.0], vec![1.0, 1.0]).unwrap();
        assert_eq!(bands.radiance(0), 35.0);
    }

    #[test]
    fn wrong_bands_are_refused() {
        for (nm, values, word) in [
            (&[500.0][..], vec![1.0], "two or more"),
            (&[500.0, 450.0], vec![1.0; 2], "ascending"),
            (&[900.0, 1000.0], vec![1.0; 2], "between 360 and 830"),
            (&[500.0, 600.0], vec![1.0, -1.0], "-1"),
            (&[500.0, 600.0], vec![1.0, f32::NAN], "NaN"),
        ] {
            let error = EnvironmentBands::new(nm, values).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}
