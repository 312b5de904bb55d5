//! The complex refractive index of a metal.

use abbe_optics::fresnel;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::library::LibraryMetal;
use abbe_spectra::spectrum::{BAND_NM, library};
use serde::Serialize;

#[derive(Debug, Serialize)]
pub struct MetalIndex {
    /// The wavelength in nm.
    pub nm: f64,
    pub n: f64,
    /// The imaginary part, which is positive.
    pub k: f64,
    /// Reflectance at normal incidence from air.
    pub reflectance: f64,
}

/// The optical data of a metal.
#[derive(Debug, Serialize)]
pub struct MetalReport {
    /// The chemical symbol, such as `Au`.
    pub symbol: &'static str,
    pub name: &'static str,
    pub source: &'static str,
    /// The index at the requested wavelengths.
    pub index: Vec<MetalIndex>,
}

#[derive(Debug, Serialize)]
pub struct MetalList {
    /// The entries, in the order of the library.
    pub metals: Vec<LibraryMetal>,
}

impl MetalReport {
    /// Describes the metal with this symbol or English name, at wavelengths in nm. Returns an error
    /// if the name is unknown, or if a wavelength is outside the visible band.
    pub fn of(name: &str, nm: &[f64]) -> Result<Self> {
        if let Some(nm) = nm.iter().find(|nm| !(BAND_NM.0..=BAND_NM.1).contains(*nm)) {
            let expected = format!("wavelengths from {} to {} nm", BAND_NM.0, BAND_NM.1);
            return Err(Error::input(format!("the index at {nm} nm")).expected(expected));
        }
        let metal = library::metal(name)?;
        let (n, k) = metal.index();
        let at = |&nm: &f64| {
            let (n, k) = (n.at(nm), k.at(nm));
            MetalIndex { nm, n, k, reflectance: fresnel::conductor(1.0, n, k, 1.0) }
        };
        let LibraryMetal { symbol, name, source, .. } = metal;
        Ok(Self { symbol, name, source, index: nm.iter().map(at).collect() })
    }
}
