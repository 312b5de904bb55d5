//! The index of refraction that a material holds.

use super::dispersion::{Dispersion, Pole};
use super::{RelativeTo, catalogue, lines};
use crate::error::{Error, Result};
use crate::spectrum::BAND_NM;

/// An index of refraction n(λ) ≥ 1, relative to the air around, over the whole band.
///
/// Outside the range in which its formula is known to hold, n keeps the value at the range's end: formulas extrapolate badly.
#[derive(Debug, Clone, PartialEq)]
pub struct Index {
    dispersion: Dispersion,
    range_nm: (f64, f64),
    dispersive: bool,
    warning: Option<String>,
}

impl Index {
    /// The same index `n` at every wavelength. Fails below 1 and on NaN.
    pub fn constant(n: f64) -> Result<Self> {
        Self::new(Dispersion::Constant(n), BAND_NM)
    }

    /// Cauchy's formula n = a + b/λ² + c/λ⁴ with λ in µm. Fails where n falls below 1 in the band, and on NaN.
    pub fn cauchy(a: f64, b: f64, c: f64) -> Result<Self> {
        Self::new(Dispersion::Cauchy { a, b, c }, BAND_NM)
    }

    /// Sellmeier's formula n² = 1 + Σ b λ²/(λ² − c) with λ in µm, c in µm². Fails if the lists differ in length, if a resonance
    /// lies within the band, where n falls below 1, and on NaN.
    pub fn sellmeier(b: &[f64], c_um2: &[f64]) -> Result<Self> {
        if b.len() != c_um2.len() {
            let what = format!("{} Sellmeier coefficients b but {} c", b.len(), c_um2.len());
            return Err(Error::input(what).expected("as many b as c"));
        }
        let poles = b.iter().zip(c_um2).map(|(&b, &c)| Pole { b, c }).collect();
        Self::new(Dispersion::Sellmeier { c0: 0.0, poles }, BAND_NM)
    }

    /// The two-term Cauchy formula through n_d whose Abbe number (n_d − 1)/(n_F − n_C) is `vd` > 0. Fails where n falls below 1 in
    /// the band, and on NaN.
    pub fn abbe(nd: f64, vd: f64) -> Result<Self> {
        if !(vd > 0.0 && vd.is_finite()) {
            return Err(Error::input(format!("an Abbe number of {vd}")).expected("a positive number"));
        }
        let per_um2 = |nm: f64| 1e6 / (nm * nm);
        let b = (nd - 1.0) / (vd * (per_um2(lines::F_NM) - per_um2(lines::C_NM)));
        Self::cauchy(nd - b * per_um2(lines::D_NM), b, 0.0)
    }

    /// Straight lines between the points (`nm`, `n`); the end values are held outside. Fails if the lists are empty or differ in
    /// length, if `nm` does not increase, where n is below 1, and on NaN.
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
        if let Some(i) = n.iter().position(|n| !index_is_possible(*n)) {
            return Err(impossible(n[i], nm[i]));
        }
        Self::new(Dispersion::Table { nm: nm.into(), n: n.into() }, (nm[0], nm[nm.len() - 1]))
    }

    /// The catalogue's formula for a material, found without regard to case. Fails on an unknown name.
    pub fn catalogue(name: &str) -> Result<Self> {
        Ok(catalogue::find(name)?.index.clone())
    }

    /// The catalogue's Cauchy fit for a material (its error is [`super::CauchyFit::max_error`]). Fails on an unknown name.
    pub fn catalogue_cauchy(name: &str) -> Result<Self> {
        catalogue::find(name)?.cauchy_index()
    }

    /// A formula that holds within `range_nm`, two increasing wavelengths in nm (the end values are held outside). Fails where n is
    /// below 1 in the band, if a resonance lies within the range, and on NaN.
    pub fn new(dispersion: Dispersion, range_nm: (f64, f64)) -> Result<Self> {
        let in_order = range_nm.0 <= range_nm.1;
        if !in_order {
            let what = format!("a range from {} nm to {} nm", range_nm.0, range_nm.1);
            return Err(Error::input(what).expected("two increasing wavelengths"));
        }
        if let Dispersion::Sellmeier { poles, .. } = &dispersion {
            refuse_resonances(poles, range_nm)?;
        }
        let mut index = Self { dispersion, range_nm, dispersive: false, warning: None };
        let at_start = index.n(BAND_NM.0);
        for step in 0..=(BAND_NM.1 - BAND_NM.0) as usize {
            let nm = BAND_NM.0 + step as f64;
            let n = index.n(nm);
            if !index_is_possible(n) {
                return Err(impossible(n, nm));
            }
            index.dispersive |= n != at_start;
        }
        Ok(index)
    }

    /// Adds the warning that a material's range and reference medium call for.
    pub(super) fn explain(&mut self, name: &str, relative_to: RelativeTo) {
        let (from, to) = self.range_nm;
        let mut warnings = Vec::new();
        if from > BAND_NM.0 || to < BAND_NM.1 {
            let range =
                format!("the index of {name} is known from {from} to {to} nm; outside, the value at the end is held");
            warnings.push(range);
        }
        match relative_to {
            RelativeTo::Air | RelativeTo::Unstated => {}
            RelativeTo::Vacuum => {
                warnings
                    .push(format!("the index of {name} is relative to vacuum, those of glasses are relative to air"));
            }
        }
        self.warning = (!warnings.is_empty()).then(|| warnings.join("; "));
    }

    /// The index at a wavelength in nm; outside the range, that of the range's end.
    pub fn n(&self, wavelength_nm: f64) -> f64 {
        match self.dispersion {
            Dispersion::Constant(n) => n,
            Dispersion::Cauchy { .. }
            | Dispersion::Sellmeier { .. }
            | Dispersion::SquaredPowers { .. }
            | Dispersion::Powers { .. }
            | Dispersion::Rational(_)
            | Dispersion::Gas { .. }
            | Dispersion::Conrady { .. }
            | Dispersion::Herzberger(_)
            | Dispersion::Table { .. } => self.dispersion.n(wavelength_nm.clamp(self.range_nm.0, self.range_nm.1)),
        }
    }

    /// Whether n differs between any two wavelengths of the band.
    pub fn is_dispersive(&self) -> bool {
        self.dispersive
    }

    /// n at the d line, 587.5618 nm.
    pub fn nd(&self) -> f64 {
        self.n(lines::D_NM)
    }

    /// The Abbe number (n_d − 1)/(n_F − n_C); `None` where n_F = n_C or where the range does not hold both lines.
    pub fn vd(&self) -> Option<f64> {
        let spread = self.n(lines::F_NM) - self.n(lines::C_NM);
        let known = self.range_nm.0 <= lines::F_NM && self.range_nm.1 >= lines::C_NM;
        (known && spread != 0.0).then(|| (self.nd() - 1.0) / spread)
    }

    /// The wavelengths in nm within which the formula holds.
    pub fn range_nm(&self) -> (f64, f64) {
        self.range_nm
    }

    /// The formula.
    pub fn dispersion(&self) -> &Dispersion {
        &self.dispersion
    }

    /// What a user should know: that part of the band lies outside the formula's range, or that the index is relative to
    /// vacuum.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }
}

fn index_is_possible(n: f64) -> bool {
    n.is_finite() && n >= 1.0
}

fn impossible(n: f64, nm: f64) -> Error {
    let what = if n.is_nan() {
        format!("the index is not a number at {nm} nm")
    } else {
        format!("an index of {n} at {nm} nm")
    };
    Error::input(what)
        .expected(format!("an index of at least 1 over the whole band ({} to {} nm)", BAND_NM.0, BAND_NM.1))
}

/// A resonance between two steps of the check in [`Index::new`] could slip through it.
fn refuse_resonances(poles: &[Pole], range_nm: (f64, f64)) -> Result<()> {
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

    fn complaint(result: Result<Index>) -> String {
        result.expect_err("this index should be refused").to_string()
    }

    #[test]
    fn an_index_below_one_anywhere_in_the_band_is_refused_and_named() {
        assert!(complaint(Index::constant(0.99)).contains("0.99"));
        assert!(complaint(Index::cauchy(0.95, 0.02, 0.0)).contains("at least 1"));
        assert!(complaint(Index::abbe(1.05, 0.5)).contains("at least 1"));
        assert!(complaint(Index::table(&[400.0, 500.0], &[1.2, 0.8])).contains("500 nm"));
    }

    #[test]
    fn values_that_are_no_numbers_are_refused() {
        assert!(complaint(Index::constant(f64::NAN)).contains("not a number"));
        assert!(complaint(Index::constant(f64::INFINITY)).contains("inf"));
        assert!(complaint(Index::cauchy(1.5, f64::NAN, 0.0)).contains("not a number"));
        assert!(complaint(Index::sellmeier(&[1.0], &[f64::NAN])).contains("finite"));
        assert!(complaint(Index::abbe(1.5, f64::NAN)).contains("positive"));
        assert!(complaint(Index::abbe(f64::NAN, 50.0)).contains("not a number"));
        assert!(complaint(Index::table(&[f64::NAN], &[1.5])).contains("wavelength"));
        assert!(complaint(Index::table(&[500.0], &[f64::NAN])).contains("not a number"));
    }

    #[test]
    fn tables_must_match_in_length_and_increase() {
        assert!(complaint(Index::table(&[], &[])).contains("at least one"));
        assert!(complaint(Index::table(&[400.0, 500.0], &[1.5])).contains("2 wavelengths and 1 indices"));
        assert!(complaint(Index::table(&[500.0, 400.0], &[1.5, 1.6])).contains("increasing"));
        assert!(complaint(Index::table(&[500.0, 500.0], &[1.5, 1.6])).contains("increasing"));
        assert!(complaint(Index::sellmeier(&[1.0, 2.0], &[0.01])).contains("2 Sellmeier coefficients b but 1 c"));
    }

    #[test]
    fn a_resonance_inside_the_band_is_refused_even_between_whole_nanometres() {
        let c = 0.5005_f64 * 0.5005;
        assert!(complaint(Index::sellmeier(&[1e-9], &[c])).contains("resonances (√c) outside the band"));
    }

    #[test]
    fn an_abbe_number_gives_back_its_index_and_itself() {
        let index = Index::abbe(1.62, 36.4).unwrap();
        assert!((index.nd() - 1.62).abs() < 1e-14);
        assert!((index.vd().unwrap() - 36.4).abs() < 1e-9);
        assert!(index.is_dispersive());
    }

    #[test]
    fn outside_its_range_an_index_holds_the_value_at_the_end() {
        let index = Index::catalogue("N-SF10").unwrap();
        assert_eq!(index.range_nm(), (380.0, 2500.0));
        assert_eq!(index.n(360.0), index.n(380.0));
        assert!(index.n(380.0) > index.n(381.0));
        assert!(index.warning().unwrap().contains("380 to 2500 nm"));
        assert_eq!(Index::catalogue("N-BK7").unwrap().warning(), None);
        assert!(Index::catalogue("air (Ciddor)").unwrap().warning().unwrap().contains("relative to vacuum"));
    }

    #[test]
    fn only_what_varies_is_dispersive() {
        assert!(!Index::constant(1.5).unwrap().is_dispersive());
        assert!(!Index::cauchy(1.5, 0.0, 0.0).unwrap().is_dispersive());
        assert!(Index::table(&[500.0, 600.0], &[1.5, 1.49]).unwrap().is_dispersive());
        assert_eq!(Index::constant(1.5).unwrap().vd(), None);
    }

    #[test]
    fn the_catalogue_s_cauchy_fit_stays_within_its_stated_error() {
        for name in ["N-BK7", "N-SF10", "diamond", "water 20C"] {
            let (exact, fit) = (Index::catalogue(name).unwrap(), Index::catalogue_cauchy(name).unwrap());
            let bound = catalogue::find(name).unwrap().cauchy.max_error;
            let (from, to) = fit.range_nm();
            let mut worst: f64 = 0.0;
            for step in 0..=((to - from) / 5.0) as usize {
                let nm = from + 5.0 * step as f64;
                worst = worst.max((exact.n(nm) - fit.n(nm)).abs());
            }
            // The fit's coefficients are stated to 11 digits.
            assert!(worst <= bound + 1e-10, "{name}: {worst} > {bound}");
            assert!(worst >= bound * 0.99, "{name}: the stated error {bound} is not reached ({worst})");
        }
    }
}
