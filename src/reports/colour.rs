//! The colour of a light or of a surface.

use abbe_spectra::colour::{ColourRendition, ColourReport};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Observer, Spectrum};
use serde::Serialize;

/// Computes the colour of a light, or of a reflectance under a light. Returns an error that names
/// the spectrum if the light has no luminance for the observer.
pub fn colour(name: &str, spectrum: &Spectrum, under: Option<&Spectrum>, observer: &Observer) -> Result<ColourReport> {
    let report = match under {
        Some(light) => ColourReport::of_reflectance(spectrum, light, observer),
        None => ColourReport::of_light(spectrum, observer),
    };
    report.map_err(|error| Error { what: format!("{name}: {}", error.what), ..error })
}

/// The colour of a light or of a surface, with its name. [`ColourReport`] defines the figures.
#[derive(Debug, Serialize)]
pub struct NamedColour<'a> {
    /// The name of the light or of the reflectance.
    pub name: &'a str,
    /// The name of the observer, such as `cie1931`.
    pub observer: &'static str,
    /// The lamp that illuminates the reflectance, or `None` for a light.
    pub under: Option<&'a str>,
    /// Tristimulus values, with Y = 100 for a light, or for the perfect diffuser under it.
    pub xyz: [f64; 3],
    /// Chromaticity.
    pub xy: [f64; 2],
    /// Linear sRGB. A colour with Y = 100 in `xyz` has the luminance 1 in these components.
    pub linear_srgb: [f64; 3],
    pub srgb_hex: &'a str,
    /// The dominant wavelength in nm.
    pub dominant_nm: Option<f64>,
    /// True if `dominant_nm` is the complementary wavelength, because the colour is a purple.
    pub complementary: Option<bool>,
    /// Excitation purity, from 0 to 1.
    pub purity: Option<f64>,
    pub cct_k: Option<f64>,
    /// The distance from the Planckian locus in CIE 1960 uv, positive above it.
    pub duv: Option<f64>,
    /// The general colour rendering index (CIE 13.3).
    pub ra: Option<f64>,
    /// The special colour rendering index of a saturated red (CIE 13.3).
    pub r9: Option<f64>,
    /// The colour rendition of a light (TM-30).
    pub tm30: Option<&'a ColourRendition>,
    /// The melanopic daylight efficacy ratio of a light (CIE S 026).
    pub melanopic_ratio: Option<f64>,
    /// The luminous efficacy of the radiation of a light.
    pub efficacy_lm_per_w: Option<f64>,
}

impl<'a> NamedColour<'a> {
    /// Names the figures of a report. `under` is the lamp that illuminates a reflectance.
    pub fn new(name: &'a str, report: &'a ColourReport, observer: &'static Observer, under: Option<&'a str>) -> Self {
        let ColourReport { xyz, xy, linear_srgb, srgb_hex, dominant, temperature, .. } = report;
        let ColourReport { rendering, rendition, melanopic_ratio, efficacy_lm_per_w, .. } = report;
        Self {
            name,
            observer: observer.name(),
            under,
            xyz: *xyz,
            xy: *xy,
            linear_srgb: *linear_srgb,
            srgb_hex,
            dominant_nm: dominant.map(|dominant| dominant.nm),
            complementary: dominant.map(|dominant| dominant.complementary),
            purity: dominant.map(|dominant| dominant.purity),
            cct_k: temperature.map(|temperature| temperature.cct_k),
            duv: temperature.map(|temperature| temperature.duv),
            ra: rendering.as_ref().map(|rendering| rendering.ra),
            r9: rendering.as_ref().map(|rendering| rendering.special[8]),
            tm30: rendition.as_ref(),
            melanopic_ratio: *melanopic_ratio,
            efficacy_lm_per_w: *efficacy_lm_per_w,
        }
    }
}
