//! Standard observers: colour-matching functions and what they make of a spectrum.

use std::sync::OnceLock;

use super::continuum::Continuum;
use super::{BAND_NM, Spectrum, library, sweep};
use crate::error::{Error, Result};

/// Luminous efficacy of radiation where ȳ = 1, in lm/W.
pub const LUMENS_PER_WATT: f64 = 683.0;

/// The names by which observers are chosen.
pub const OBSERVER_NAMES: [&str; 4] = ["cie1931", "cie1964", "cie2015_2", "cie2015_10"];

/// A standard observer: colour-matching functions x̄, ȳ, z̄ tabulated every nm from 360 to 830, linear between, 0
/// outside.
#[derive(Debug)]
pub struct Observer {
    name: &'static str,
    /// One entry per nm, and the last one twice, so that the end of the band needs no branch.
    every_nm: Vec<[f64; 3]>,
    bars: [Spectrum; 3],
    sum: Spectrum,
}

impl Observer {
    /// CIE 1931, 2° (ISO/CIE 11664-1); its ȳ is V(λ).
    pub fn cie1931() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie1931", include_str!("../../data/cie/cie1931_2deg_1nm.csv")))
    }

    /// CIE 1964, 10° (ISO/CIE 11664-1).
    pub fn cie1964() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie1964", include_str!("../../data/cie/cie1964_10deg_1nm.csv")))
    }

    /// CIE 170-2:2015, 2°, from cone fundamentals; tabulated from 390 nm.
    pub fn cie2015_2() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie2015_2", include_str!("../../data/cie/cie2015_2deg_1nm.csv")))
    }

    /// CIE 170-2:2015, 10°, from cone fundamentals; tabulated from 390 nm.
    pub fn cie2015_10() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie2015_10", include_str!("../../data/cie/cie2015_10deg_1nm.csv")))
    }

    /// An observer by its name: `cie1931`, `cie1964`, `cie2015_2` or `cie2015_10`.
    ///
    /// # Errors
    /// A name that is none of these.
    pub fn by_name(name: &str) -> Result<&'static Self> {
        match name.to_ascii_lowercase().as_str() {
            "cie1931" => Ok(Self::cie1931()),
            "cie1964" => Ok(Self::cie1964()),
            "cie2015_2" => Ok(Self::cie2015_2()),
            "cie2015_10" => Ok(Self::cie2015_10()),
            _ => Err(Error::unknown_name("observer", name, OBSERVER_NAMES).expected(OBSERVER_NAMES.join(", "))),
        }
    }

    /// The name it is chosen by.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// x̄, ȳ, z̄ at a wavelength in nm; 0 outside the band.
    #[inline]
    pub fn xyz_bar(&self, nm: f64) -> [f64; 3] {
        if !(nm >= BAND_NM.0 && nm <= BAND_NM.1) {
            return [0.0; 3];
        }
        let place = nm - BAND_NM.0;
        let i = place as usize;
        let t = place - i as f64;
        let (from, to) = (&self.every_nm[i], &self.every_nm[i + 1]);
        [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), from[2] + t * (to[2] - from[2])]
    }

    /// ∫ spectrum · (x̄, ȳ, z̄) dλ over the band, exact; times [`LUMENS_PER_WATT`] the second is luminous.
    pub fn xyz(&self, spectrum: &Spectrum) -> [f64; 3] {
        self.bars.each_ref().map(|bar| sweep::product_integral([spectrum, bar]))
    }

    /// ∫ reflectance · light · (x̄, ȳ, z̄) dλ over the band, exact.
    pub fn xyz_under(&self, reflectance: &Spectrum, light: &Spectrum) -> [f64; 3] {
        self.bars.each_ref().map(|bar| sweep::product_integral([reflectance, light, bar]))
    }

    /// The three functions as spectra.
    pub fn bars(&self) -> &[Spectrum; 3] {
        &self.bars
    }

    /// x̄ + ȳ + z̄: how much a wavelength matters to a picture.
    pub fn sum_bar(&self) -> &Spectrum {
        &self.sum
    }

    /// Reads a table of four columns with 1 nm steps that is part of the program.
    fn parse(name: &'static str, csv: &str) -> Self {
        let mut every_nm = vec![[0.0; 3]; (BAND_NM.1 - BAND_NM.0) as usize + 2];
        let [nm, x, y, z] = library::columns(csv);
        for (i, nm) in nm.iter().enumerate() {
            every_nm[(nm - BAND_NM.0) as usize] = [x[i], y[i], z[i]];
        }
        let last = every_nm.len() - 1;
        every_nm[last] = every_nm[last - 1];
        let spectrum = |value: &dyn Fn(&[f64; 3]) -> f64| {
            let knots: Vec<(f64, f64)> =
                every_nm[..last].iter().zip(BAND_NM.0 as u32..).map(|(bar, nm)| (f64::from(nm), value(bar))).collect();
            Spectrum::smooth(Continuum::from_knots(&knots))
        };
        let bars = [spectrum(&|bar| bar[0]), spectrum(&|bar| bar[1]), spectrum(&|bar| bar[2])];
        let sum = spectrum(&|bar| bar[0] + bar[1] + bar[2]);
        Self { name, every_nm, bars, sum }
    }
}
