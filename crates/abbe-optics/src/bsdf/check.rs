//! Validation of material parameters.

use crate::texture::SurfaceSpectrum;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{BAND_NM, Spectrum};

/// Iterates over the whole nanometres of the band, at which material spectra are checked.
pub(super) fn whole_nm() -> impl Iterator<Item = f64> {
    (0..=(BAND_NM.1 - BAND_NM.0) as usize).map(|step| BAND_NM.0 + step as f64)
}

/// Returns an error for `what` if the spectrum leaves \[0, `most`\] from 300 to 830 nm.
pub(super) fn check_within(what: &str, spectrum: &Spectrum, most: f64) -> Result<()> {
    let possible = |value: f64| value.is_finite() && (0.0..=most).contains(&value);
    // Whole nanometres locate a fault; minimum and maximum also find those in between.
    let at_nm = whole_nm().find(|nm| !possible(spectrum.at(*nm)));
    let at_nm = at_nm.map(|nm| (spectrum.at(nm), format!(" at {nm} nm")));
    let extreme = || {
        let below = spectrum.ultraviolet_range();
        [spectrum.min(), spectrum.max(), below.0, below.1].into_iter().find(|value| !possible(*value))
    };
    let Some((value, place)) = at_nm.or_else(|| extreme().map(|value| (value, String::new()))) else {
        return Ok(());
    };
    let expected = if most.is_finite() { format!("values from 0 to {most}") } else { "values from 0 up".into() };
    Err(Error::input(format!("a {what} of {value}{place}")).expected(expected))
}

/// Returns an error if a uniform spectrum leaves \[0, 1\], in which textures always lie.
pub(super) fn check_fraction(what: &str, spectrum: &SurfaceSpectrum) -> Result<()> {
    spectrum.uniform().map_or(Ok(()), |uniform| check_within(what, uniform, 1.0))
}

pub(super) fn check_alpha(alpha: f64) -> Result<()> {
    if (0.0..=1.0).contains(&alpha) {
        return Ok(());
    }
    Err(Error::input(format!("a roughness of {alpha}")).expected("a number from 0 to 1"))
}
