//! Light as a function of wavelength.

mod lanes;

pub use lanes::{LANES, Lanes, Wavelengths};

/// The band of wavelengths that Abbe simulates, in nm. Every power and every integral is meant over it.
pub const BAND_NM: (f64, f64) = (360.0, 830.0);

/// A function of wavelength over the band. (Interim body: constant or piecewise linear, held at the ends.)
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    nm: Vec<f64>,
    values: Vec<f64>,
}

impl Spectrum {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Self { nm: vec![BAND_NM.0, BAND_NM.1], values: vec![value, value] }
    }

    /// The value at a wavelength in nm.
    pub fn at(&self, nm: f64) -> f64 {
        let i = self.nm.partition_point(|&knot| knot <= nm).clamp(1, self.nm.len() - 1);
        let t = ((nm - self.nm[i - 1]) / (self.nm[i] - self.nm[i - 1])).clamp(0.0, 1.0);
        self.values[i - 1] + t * (self.values[i] - self.values[i - 1])
    }
}
