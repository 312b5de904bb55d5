//! A colour for programs to read.

use abbe::colour::Report;
use abbe::spectrum::Observer;
use serde::Serialize;

/// What `abbe spectrum --json` prints, and `abbe lamps --json` of each lamp.
#[derive(Debug, Serialize)]
pub(crate) struct Colour<'a> {
    name: &'a str,
    observer: &'static str,
    /// The lamp, for a reflectance.
    under: Option<&'a str>,
    /// Y = 100; for a reflectance, Y of the perfect diffuser = 100.
    xyz: [f64; 3],
    xy: [f64; 2],
    /// Y = 1 where `xyz` has Y = 100.
    linear_srgb: [f64; 3],
    srgb_hex: &'a str,
    dominant_nm: Option<f64>,
    /// Whether `dominant_nm` is the complementary wavelength of a purple.
    complementary: Option<bool>,
    purity: Option<f64>,
    cct_k: Option<f64>,
    duv: Option<f64>,
    ra: Option<f64>,
    efficacy_lm_per_w: Option<f64>,
}

impl<'a> Colour<'a> {
    /// A report's figures under a name; `under` is the lamp of a reflectance.
    pub(crate) fn new(name: &'a str, report: &'a Report, observer: &'static Observer, under: Option<&'a str>) -> Self {
        let Report { xyz, xy, linear_srgb, srgb_hex, dominant, temperature, rendering, efficacy_lm_per_w } = report;
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
            efficacy_lm_per_w: *efficacy_lm_per_w,
        }
    }
}
