//! Standard observers: colour-matching functions and the tristimulus values of a spectrum.

use std::sync::OnceLock;

use super::band::BAND_NM;
use super::continuum::Continuum;
use super::value::Spectrum;
use super::{library, sweep};
use crate::error::{Error, Result};

/// The maximum luminous efficacy of radiation (at ȳ = 1), in lm/W.
pub const LUMENS_PER_WATT: f64 = 683.0;

/// The melanopic efficacy of luminous radiation of D65, in W/lm (CIE S 026:2018, table 3).
pub const MELANOPIC_W_PER_LM_OF_D65: f64 = 1.3262e-3;

/// The names of the observers.
pub const OBSERVER_NAMES: [&str; 4] = ["cie1931", "cie1964", "cie2015_2", "cie2015_10"];

/// A standard observer: the colour-matching functions x̄, ȳ and z̄ by nm from 360 to 830 nm, linear
/// between the samples and 0 outside the table.
#[derive(Debug)]
pub struct Observer {
    name: &'static str,
    /// One entry per nm, the last one twice, so that interpolation has no special case.
    every_nm: Vec<[f64; 3]>,
    bars: [Spectrum; 3],
    sum: Spectrum,
}

impl Observer {
    /// Returns the CIE 1931 observer for 2° (ISO/CIE 11664-1), whose ȳ is V(λ).
    pub fn cie1931() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie1931", include_str!("../../data/cie/cie1931_2deg_1nm.csv")))
    }

    /// Returns the CIE 1964 observer for a field of 10° (ISO/CIE 11664-1).
    pub fn cie1964() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie1964", include_str!("../../data/cie/cie1964_10deg_1nm.csv")))
    }

    /// Returns the observer of CIE 170-2:2015 for 2°, from cone fundamentals, from 390 nm on.
    pub fn cie2015_2() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie2015_2", include_str!("../../data/cie/cie2015_2deg_1nm.csv")))
    }

    /// Returns the observer of CIE 170-2:2015 for a field of 10°, as [`Self::cie2015_2`].
    pub fn cie2015_10() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::parse("cie2015_10", include_str!("../../data/cie/cie2015_10deg_1nm.csv")))
    }

    /// Returns the observer with ȳ = 1, whose Y is the radiant quantity over the band. It has no
    /// name among [`OBSERVER_NAMES`], because it describes no eye.
    pub fn radiometric() -> &'static Self {
        static OBSERVER: OnceLock<Observer> = OnceLock::new();
        OBSERVER.get_or_init(|| Self::with_luminosity("radiometric", |_| 1.0))
    }

    /// Returns five observers whose ȳ are the action spectra of the S, M and L cones, of the rods
    /// and of melanopsin (CIE S 026:2018, table 2).
    pub fn alpha_opic() -> [&'static Self; 5] {
        static OBSERVERS: OnceLock<[Observer; 5]> = OnceLock::new();
        let observers = OBSERVERS.get_or_init(|| {
            let [nm, s, m, l, rod, melanopsin] = library::columns(include_str!("../../data/cie/alpha_opic_1nm.csv"));
            let of = |name, values: Vec<f64>| {
                let at = |wanted: f64| nm.iter().position(|&nm| nm == wanted).map_or(0.0, |i| values[i]);
                Self::with_luminosity(name, at)
            };
            [of("s_cone", s), of("m_cone", m), of("l_cone", l), of("rod", rod), of("melanopsin", melanopsin)]
        });
        observers.each_ref()
    }

    /// Returns the melanopic daylight efficacy ratio of a light (CIE S 026:2018): its melanopic
    /// irradiance per illuminance, relative to that of D65, or `None` without luminance.
    pub fn melanopic_ratio(light: &Spectrum) -> Option<f64> {
        let [melanopic, luminous] = [Self::alpha_opic()[4], Self::cie1931()].map(|observer| observer.xyz(light)[1]);
        (luminous > 0.0).then(|| melanopic / (LUMENS_PER_WATT * luminous * MELANOPIC_W_PER_LM_OF_D65))
    }

    /// Returns the CIE 1931 observer with another function ȳ, given by `luminosity` at whole nm.
    pub fn with_luminosity(name: &'static str, luminosity: impl Fn(f64) -> f64) -> Self {
        let mut every_nm = Self::cie1931().every_nm.clone();
        let last = every_nm.len() - 1;
        every_nm[..last].iter_mut().zip(BAND_NM.0 as u32..).for_each(|(bar, nm)| bar[1] = luminosity(f64::from(nm)));
        Self::from_table(name, every_nm)
    }

    /// Returns an observer by its name (see [`OBSERVER_NAMES`]), or an error if it is unknown.
    pub fn by_name(name: &str) -> Result<&'static Self> {
        match name.to_ascii_lowercase().as_str() {
            "cie1931" => Ok(Self::cie1931()),
            "cie1964" => Ok(Self::cie1964()),
            "cie2015_2" => Ok(Self::cie2015_2()),
            "cie2015_10" => Ok(Self::cie2015_10()),
            _ => Err(Error::unknown_name("observer", name, OBSERVER_NAMES).expected(OBSERVER_NAMES.join(", "))),
        }
    }

    /// Returns the observer's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Returns x̄, ȳ and z̄ at a wavelength in nm. They are 0 outside the band.
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

    /// Returns the exact integrals of spectrum · (x̄, ȳ, z̄) over the band. The second times
    /// [`LUMENS_PER_WATT`] is the luminous quantity.
    pub fn xyz(&self, spectrum: &Spectrum) -> [f64; 3] {
        self.bars.each_ref().map(|bar| sweep::product_integral([spectrum, bar].map(Spectrum::parts)))
    }

    /// Returns the exact integrals of reflectance · light · (x̄, ȳ, z̄) over the band.
    pub fn xyz_under(&self, reflectance: &Spectrum, light: &Spectrum) -> [f64; 3] {
        self.bars.each_ref().map(|bar| sweep::product_integral([reflectance, light, bar].map(Spectrum::parts)))
    }

    /// Returns for each whole nm of the band the exact integrals of triangle · light · (x̄, ȳ, z̄).
    /// The triangle is 1 at this wavelength and 0 at all other whole nm, so the integrals add up to
    /// [`xyz`](Self::xyz).
    pub(crate) fn xyz_near_each_nm(&self, light: &Spectrum) -> Vec<[f64; 3]> {
        let mut near = vec![[0.0; 3]; self.every_nm.len()];
        // The sum of the triangles at odd distances from the beginning of the band. It has a knot
        // at each whole nm.
        let knots: Vec<(f64, f64)> = (BAND_NM.0 as u32..=BAND_NM.1 as u32)
            .zip([0.0, 1.0].into_iter().cycle())
            .map(|(nm, odd)| (f64::from(nm), odd))
            .collect();
        let odd = Spectrum::from_continuum(Continuum::from_knots(&knots));
        let [x, y, z] = &self.bars;
        sweep::sweep([&odd, light, x, y, z].map(Spectrum::parts), |nm, [odd, light, bars @ ..]| {
            let first = (nm.0 - BAND_NM.0) as usize;
            let even = (1.0 - odd.0, 1.0 - odd.1);
            for (number, triangle) in [(first.next_multiple_of(2), even), (first | 1, odd)] {
                let integrals = bars.map(|bar| sweep::interval_integral(nm, [triangle, light, bar]));
                near[number].iter_mut().zip(integrals).for_each(|(sum, integral)| *sum += integral);
            }
        });
        near
    }

    /// Returns x̄, ȳ and z̄ as spectra.
    pub fn bars(&self) -> &[Spectrum; 3] {
        &self.bars
    }

    /// Returns x̄ + ȳ + z̄, which measures the importance of a wavelength for a picture.
    pub fn sum_bar(&self) -> &Spectrum {
        &self.sum
    }

    /// Parses a built-in table of four columns in steps of 1 nm.
    fn parse(name: &'static str, csv: &str) -> Self {
        let mut every_nm = vec![[0.0; 3]; (BAND_NM.1 - BAND_NM.0) as usize + 2];
        let [nm, x, y, z] = library::columns(csv);
        for (i, nm) in nm.iter().enumerate() {
            every_nm[(nm - BAND_NM.0) as usize] = [x[i], y[i], z[i]];
        }
        Self::from_table(name, every_nm)
    }

    /// Creates an observer from its table, whose last entry has no meaning.
    fn from_table(name: &'static str, mut every_nm: Vec<[f64; 3]>) -> Self {
        let last = every_nm.len() - 1;
        every_nm[last] = every_nm[last - 1];
        let spectrum = |value: &dyn Fn(&[f64; 3]) -> f64| {
            let knots: Vec<(f64, f64)> =
                every_nm[..last].iter().zip(BAND_NM.0 as u32..).map(|(bar, nm)| (f64::from(nm), value(bar))).collect();
            Spectrum::from_continuum(Continuum::from_knots(&knots))
        };
        let bars = [spectrum(&|bar| bar[0]), spectrum(&|bar| bar[1]), spectrum(&|bar| bar[2])];
        let sum = spectrum(&|bar| bar[0] + bar[1] + bar[2]);
        Self { name, every_nm, bars, sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The toolbox of CIE S 026 gives 0.496 for illuminant A.
    #[test]
    fn the_melanopic_ratio_is_1_for_d65_and_half_for_incandescent_light() {
        for (name, expected) in [("D65", 1.0), ("A", 0.496)] {
            let light = library::find(name).unwrap().spectrum;
            let ratio = Observer::melanopic_ratio(&light).unwrap();
            assert!((ratio - expected).abs() < 1e-3, "{name}: {ratio}");
        }
        assert_eq!(Observer::melanopic_ratio(&Spectrum::constant(0.0)), None);
    }
}
