//! The refractive index of a material.

use super::dispersion::{Dispersion, SellmeierTerm};
use super::lines;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{BAND_NM, Observer};
use serde::Deserialize;

/// The end of a warning about a part of the band that hardly contributes to colours.
const NEGLIGIBLE: &str = ", which contributes less than 0.1 % to the colour of white light";

/// The largest fraction of X + Y + Z of white light of equal energy that is negligible.
const NEGLIGIBLE_FRACTION: f64 = 1e-3;

/// Tells whether a note ends with a warning about an index where it changes no colour.
pub fn is_negligible(note: &str) -> bool {
    note.ends_with(NEGLIGIBLE)
}

/// The medium to which a refractive index is relative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceMedium {
    /// Air at 20–22 °C and 101 325 Pa, as in glass catalogues.
    Air,
    /// Vacuum.
    Vacuum,
    /// Unknown to the source. The indices relative to air and to vacuum differ by 3e-4.
    #[serde(rename = "unstated")]
    Unspecified,
}

/// A refractive index n(λ) ≥ 1, relative to the surrounding air, over the whole band.
///
/// Outside the range of its formula, n is the value at the nearest end of the range, because
/// dispersion formulas extrapolate badly.
#[derive(Debug, Clone, PartialEq)]
pub struct RefractiveIndex {
    dispersion: Dispersion,
    range_nm: (f64, f64),
    dispersive: bool,
    warning: Option<String>,
}

impl RefractiveIndex {
    /// Creates an index that is constant. Returns an error if `n` is below 1 or NaN.
    pub fn constant(n: f64) -> Result<Self> {
        Self::new(Dispersion::Constant(n), BAND_NM)
    }

    /// Creates n = a + b/λ² + c/λ⁴, λ in µm (Cauchy); NaN or less than 1 in the band is an error.
    pub fn cauchy(a: f64, b: f64, c: f64) -> Result<Self> {
        Self::new(Dispersion::Cauchy { a, b, c }, BAND_NM)
    }

    /// Creates n² = 1 + Σ b λ²/(λ² − c), with λ in µm and c in µm² (Sellmeier). Returns an error
    /// for different lengths, a resonance within the band, or n below 1 or NaN.
    pub fn sellmeier(b: &[f64], c_um2: &[f64]) -> Result<Self> {
        if b.len() != c_um2.len() {
            let what = format!("{} Sellmeier coefficients b but {} c", b.len(), c_um2.len());
            return Err(Error::input(what).expected("equally many b and c"));
        }
        let poles = b.iter().zip(c_um2).map(|(&b, &c)| SellmeierTerm { b, c }).collect();
        Self::new(Dispersion::Sellmeier { c0: 0.0, poles }, BAND_NM)
    }

    /// Creates a two-term Cauchy index from n_d and the Abbe number `vd` = (n_d − 1)/(n_F − n_C).
    /// Returns an error if `vd` is not positive, or if n is NaN or below 1 in the band.
    pub fn abbe(nd: f64, vd: f64) -> Result<Self> {
        if !(vd > 0.0 && vd.is_finite()) {
            return Err(Error::input(format!("an Abbe number of {vd}")).expected("a positive number"));
        }
        let per_um2 = |nm: f64| 1e6 / (nm * nm);
        let b = (nd - 1.0) / (vd * (per_um2(lines::F_NM) - per_um2(lines::C_NM)));
        Self::cauchy(nd - b * per_um2(lines::D_NM), b, 0.0)
    }

    /// Creates an index by linear interpolation of points (`nm`, `n`), held outside. Returns an
    /// error for empty or different lists, `nm` that do not increase, or n below 1 or NaN.
    pub fn table(nm: &[f64], n: &[f64]) -> Result<Self> {
        if nm.len() != n.len() || nm.is_empty() {
            let what = format!("a table of {} wavelengths and {} indices", nm.len(), n.len());
            return Err(Error::input(what).expected("as many indices as wavelengths, and at least one"));
        }
        if let Some(bad) = nm.iter().find(|nm| !(nm.is_finite() && **nm > 0.0)) {
            return Err(Error::input(format!("a wavelength of {bad} nm")).expected("a positive number"));
        }
        if let Some(pair) = nm.windows(2).find(|pair| pair[0] >= pair[1]) {
            let what = format!("wavelength {} nm follows {} nm", pair[1], pair[0]);
            return Err(Error::input(what).expected("wavelengths in increasing order"));
        }
        if let Some(i) = n.iter().position(|n| !is_valid_index(*n)) {
            return Err(invalid_index(n[i], nm[i]));
        }
        Self::new(Dispersion::Table { nm: nm.into(), n: n.into() }, (nm[0], nm[nm.len() - 1]))
    }

    /// Creates an index from a formula and its range of validity, two increasing wavelengths in nm,
    /// outside which the value at the nearest end is used. Returns an error if n is NaN or below 1
    /// in the band, or if a resonance lies within the range.
    pub fn new(dispersion: Dispersion, range_nm: (f64, f64)) -> Result<Self> {
        let in_order = range_nm.0 <= range_nm.1;
        if !in_order {
            let what = format!("a range from {} nm to {} nm", range_nm.0, range_nm.1);
            return Err(Error::input(what).expected("two increasing wavelengths"));
        }
        if let Dispersion::Sellmeier { poles, .. } = &dispersion {
            check_resonances(poles, range_nm)?;
        }
        let mut index = Self { dispersion, range_nm, dispersive: false, warning: None };
        let at_start = index.n(BAND_NM.0);
        for step in 0..=(BAND_NM.1 - BAND_NM.0) as usize {
            let nm = BAND_NM.0 + step as f64;
            let n = index.n(nm);
            if !is_valid_index(n) {
                return Err(invalid_index(n, nm));
            }
            index.dispersive |= n != at_start;
        }
        Ok(index)
    }

    /// Sets a warning if the range does not cover the band, or n is relative to vacuum.
    pub(super) fn set_warning(&mut self, name: &str, relative_to: ReferenceMedium) {
        let (from, to) = self.range_nm;
        let mut warnings = Vec::new();
        if from > BAND_NM.0 || to < BAND_NM.1 {
            let observer = Observer::cie1931();
            let total = |(from, to): (f64, f64)| {
                let nm = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).filter(|nm| from <= *nm && *nm <= to);
                nm.flat_map(|nm| observer.xyz_bar(nm)).sum::<f64>()
            };
            let is_negligible = total((from, to)) >= (1.0 - NEGLIGIBLE_FRACTION) * total(BAND_NM);
            let negligible = if is_negligible { NEGLIGIBLE } else { "" };
            let range = format!(
                "the index of {name} is known from {from} to {to} nm; the value at the nearest end is used \
                 outside this range{negligible}"
            );
            warnings.push(range);
        }
        if relative_to == ReferenceMedium::Vacuum {
            warnings
                .push(format!("the index of {name} is relative to vacuum, but indices of glasses are relative to air"));
        }
        self.warning = (!warnings.is_empty()).then(|| warnings.join("; "));
    }

    /// Returns the index at a wavelength in nm, held outside the range of validity.
    pub fn n(&self, wavelength_nm: f64) -> f64 {
        if let Dispersion::Constant(n) = self.dispersion {
            return n;
        }
        self.dispersion.n(wavelength_nm.clamp(self.range_nm.0, self.range_nm.1))
    }

    /// Returns true if n varies within the band.
    pub fn is_dispersive(&self) -> bool {
        self.dispersive
    }

    /// Returns n at the d line, 587.5618 nm.
    pub fn nd(&self) -> f64 {
        self.n(lines::D_NM)
    }

    /// Returns the Abbe number, unless n_F = n_C or the range lacks one of the lines.
    pub fn vd(&self) -> Option<f64> {
        let spread = self.n(lines::F_NM) - self.n(lines::C_NM);
        let known = self.range_nm.0 <= lines::F_NM && self.range_nm.1 >= lines::C_NM;
        (known && spread != 0.0).then(|| (self.nd() - 1.0) / spread)
    }

    /// Returns the range of validity of the formula in nm.
    pub fn range_nm(&self) -> (f64, f64) {
        self.range_nm
    }

    /// Returns the dispersion formula.
    pub fn dispersion(&self) -> &Dispersion {
        &self.dispersion
    }

    /// Returns a warning if the range lacks a part of the band, or the index is relative to vacuum.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }
}

fn is_valid_index(n: f64) -> bool {
    n.is_finite() && n >= 1.0
}

fn invalid_index(n: f64, nm: f64) -> Error {
    let what = if n.is_nan() {
        format!("the index is not a number at {nm} nm")
    } else {
        format!("an index of {n} at {nm} nm")
    };
    Error::input(what)
        .expected(format!("an index of at least 1 over the whole band ({} to {} nm)", BAND_NM.0, BAND_NM.1))
}

/// Returns an error for a resonance in the range, even between whole nanometres.
fn check_resonances(poles: &[SellmeierTerm], range_nm: (f64, f64)) -> Result<()> {
    for pole in poles {
        if !(pole.b.is_finite() && pole.c.is_finite()) {
            return Err(Error::input("a Sellmeier coefficient that is not a finite number"));
        }
        let resonance_nm = 1e3 * pole.c.max(0.0).sqrt();
        if pole.b != 0.0 && range_nm.0 <= resonance_nm && resonance_nm <= range_nm.1 {
            let what = format!("Sellmeier's formula has no value at {resonance_nm} nm, where c = {} µm²", pole.c);
            return Err(Error::input(what).expected("resonances (√c) outside the band"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_indices_are_refused_with_the_reason() {
        let cases = [
            (RefractiveIndex::constant(0.99), "0.99"),
            (RefractiveIndex::cauchy(0.95, 0.02, 0.0), "at least 1"),
            (RefractiveIndex::abbe(1.05, 0.5), "at least 1"),
            (RefractiveIndex::table(&[400.0, 500.0], &[1.2, 0.8]), "500 nm"),
            (RefractiveIndex::constant(f64::NAN), "not a number"),
            (RefractiveIndex::constant(f64::INFINITY), "inf"),
            (RefractiveIndex::cauchy(1.5, f64::NAN, 0.0), "not a number"),
            (RefractiveIndex::sellmeier(&[1.0], &[f64::NAN]), "finite"),
            (RefractiveIndex::abbe(1.5, f64::NAN), "positive"),
            (RefractiveIndex::abbe(f64::NAN, 50.0), "not a number"),
            (RefractiveIndex::table(&[f64::NAN], &[1.5]), "wavelength"),
            (RefractiveIndex::table(&[500.0], &[f64::NAN]), "not a number"),
            (RefractiveIndex::table(&[], &[]), "at least one"),
            (RefractiveIndex::table(&[400.0, 500.0], &[1.5]), "2 wavelengths and 1 indices"),
            (RefractiveIndex::table(&[500.0, 400.0], &[1.5, 1.6]), "increasing"),
            (RefractiveIndex::table(&[500.0, 500.0], &[1.5, 1.6]), "increasing"),
            (RefractiveIndex::sellmeier(&[1.0, 2.0], &[0.01]), "2 Sellmeier coefficients b but 1 c"),
            // `new` samples the index at whole nanometres, but a resonance at 500.5 nm is refused.
            (RefractiveIndex::sellmeier(&[1e-9], &[0.5005 * 0.5005]), "resonances (√c) outside the band"),
        ];
        for (index, reason) in cases {
            let message = index.expect_err(reason).to_string();
            assert!(message.contains(reason), "{message}");
        }
    }

    #[test]
    fn an_abbe_number_gives_back_its_index_and_itself() {
        let index = RefractiveIndex::abbe(1.62, 36.4).unwrap();
        assert!((index.nd() - 1.62).abs() < 1e-14);
        assert!((index.vd().unwrap() - 36.4).abs() < 1e-9);
        assert!(index.is_dispersive());
    }

    #[test]
    fn only_varying_indices_are_dispersive() {
        assert!(!RefractiveIndex::constant(1.5).unwrap().is_dispersive());
        assert!(!RefractiveIndex::cauchy(1.5, 0.0, 0.0).unwrap().is_dispersive());
        assert!(RefractiveIndex::table(&[500.0, 600.0], &[1.5, 1.49]).unwrap().is_dispersive());
        assert_eq!(RefractiveIndex::constant(1.5).unwrap().vd(), None);
    }
}
