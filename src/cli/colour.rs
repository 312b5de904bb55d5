//! The JSON form of a colour report.

use abbe_spectra::colour::{ColourRendition, ColourReport};
use abbe_spectra::spectrum::Observer;
use serde::Serialize;

/// The colour of a light or of a surface, as printed by `abbe spectrum --json` and `abbe lamps
/// --json`.
#[derive(Debug, Serialize)]
pub(crate) struct ColourJson<'a> {
    name: &'a str,
    observer: &'static str,
    /// The lamp that illuminates the reflectance, or null for a light.
    under: Option<&'a str>,
    /// Tristimulus values. A light has Y = 100. The scale for a reflectance gives the perfect
    /// diffuser Y = 100.
    xyz: [f64; 3],
    xy: [f64; 2],
    /// Linear sRGB. A colour with Y = 100 in `xyz` has the luminance 1 in these components.
    linear_srgb: [f64; 3],
    srgb_hex: &'a str,
    dominant_nm: Option<f64>,
    /// True if `dominant_nm` is the complementary wavelength, because the colour is a purple.
    complementary: Option<bool>,
    purity: Option<f64>,
    cct_k: Option<f64>,
    duv: Option<f64>,
    ra: Option<f64>,
    /// The special colour rendering index of a saturated red (CIE 13.3).
    r9: Option<f64>,
    /// The colour rendition of a light (TM-30).
    tm30: Option<&'a ColourRendition>,
    /// The melanopic daylight efficacy ratio of a light (CIE S 026).
    melanopic_ratio: Option<f64>,
    efficacy_lm_per_w: Option<f64>,
}

impl<'a> ColourJson<'a> {
    /// Returns the JSON form of a report. `under` is the name of the lamp that illuminates a
    /// reflectance, or `None` for a light.
    pub(crate) fn new(
        name: &'a str,
        report: &'a ColourReport,
        observer: &'static Observer,
        under: Option<&'a str>,
    ) -> Self {
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
