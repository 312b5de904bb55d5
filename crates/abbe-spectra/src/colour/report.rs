//! The colour values of a spectrum, computed as in published tables.
//!
//! By their convention, smooth spectra and tables are summed over samples at every nm from 360 to
//! 830 nm. Each line is multiplied by the colour-matching functions at its wavelength, and peaks of
//! the continuum narrower than 5 nm are integrated exactly. Rendering uses exact integrals instead,
//! which agree with these sums to within 3·10⁻⁴.

use super::dominant::{DominantWavelength, dominant};
use super::rendering::{ColourRendering, cri};
use super::rendition::{ColourRendition, rendition};
use super::space::{RgbSpace, srgb_hex, xyz_to_linear_srgb};
use super::temperature::{CorrelatedTemperature, cct_duv};
use super::tristimulus::{Rgb, Xyz};
use super::{coordinates, gamut};
use crate::error::{Error, Result};
use crate::spectrum::{BAND_NM, LUMENS_PER_WATT, LineSegment, Observer, Spectrum};

/// The width in nm above which lines are integrated; narrower ones are evaluated at their centre.
const WIDE_LINE_NM: f64 = 5.0;

/// Returns the XYZ of a light, without the factor 683, by the sums of this module.
pub fn xyz(light: &Spectrum, observer: &Observer) -> Xyz {
    xyz_under(&Spectrum::constant(1.0), light, observer)
}

/// Returns the XYZ of a reflectance under a light. A reflectance of 1 has that of the light.
pub fn xyz_under(reflectance: &Spectrum, light: &Spectrum, observer: &Observer) -> Xyz {
    if !reflectance.line_segments().is_empty() {
        return observer.xyz_under(reflectance, light);
    }
    let (fine_light, fine_reflectance) = (light.narrow_part(), reflectance.narrow_part());
    let fine = |part: &Option<Spectrum>, nm: f64| part.as_ref().map_or(0.0, |part| part.continuum_at(nm));
    let mut sum = [0.0; 3];
    for nm in (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from) {
        let smooth_light = light.continuum_at(nm) - fine(&fine_light, nm);
        let smooth_reflectance = reflectance.continuum_at(nm) - fine(&fine_reflectance, nm);
        add(&mut sum, smooth_light * smooth_reflectance, observer.xyz_bar(nm));
    }
    // The sum above contains only the product of the smooth parts of the light and of the
    // reflectance. All other terms of the product are integrated.
    if let Some(fine_light) = &fine_light {
        add(&mut sum, 1.0, observer.xyz_under(reflectance, fine_light));
    }
    if let Some(fine_reflectance) = &fine_reflectance {
        add(&mut sum, 1.0, observer.xyz_under(fine_reflectance, &light.continuum_only()));
        if let Some(fine_light) = &fine_light {
            add(&mut sum, -1.0, observer.xyz_under(fine_reflectance, fine_light));
        }
    }
    for line in light.line_segments() {
        add(&mut sum, 1.0, xyz_of_line(line, reflectance, observer));
    }
    sum
}

fn add(sum: &mut Xyz, weight: f64, xyz: Xyz) {
    sum.iter_mut().zip(xyz).for_each(|(sum, value)| *sum += weight * value);
}

fn xyz_of_line(line: &LineSegment, reflectance: &Spectrum, observer: &Observer) -> Xyz {
    if line.nm.1 - line.nm.0 <= WIDE_LINE_NM {
        let power = line.power * reflectance.continuum_at(line.centre());
        return observer.xyz_bar(line.centre()).map(|bar| power * bar);
    }
    observer.xyz_under(reflectance, &Spectrum::from_segments(&[*line]))
}

/// The colour of a light, or of a reflectance under a light.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourReport {
    /// XYZ. A light, or the perfect diffuser for a reflectance under a light, has Y = 100.
    pub xyz: Xyz,
    /// Chromaticity x, y.
    pub xy: [f64; 2],
    /// Linear sRGB, not clipped. Y = 100 in `xyz` is the luminance 1.
    pub linear_srgb: Rgb,
    /// The colour mapped into sRGB, for a swatch; that of a light is as bright as possible.
    pub srgb_hex: String,
    /// Dominant wavelength and excitation purity, or `None` for neutral colours. White is the
    /// equal-energy white for a light, and the illuminant for a reflectance.
    pub dominant: Option<DominantWavelength>,
    /// Correlated colour temperature of a light, if defined, always for the CIE 1931 observer.
    pub temperature: Option<CorrelatedTemperature>,
    /// Colour rendering indices of a light, if defined.
    pub rendering: Option<ColourRendering>,
    /// Colour rendition of a light by TM-30, if defined.
    pub rendition: Option<ColourRendition>,
    /// The melanopic daylight efficacy ratio of a light (CIE S 026). `None` for a reflectance.
    pub melanopic_ratio: Option<f64>,
    /// The luminous efficacy of the radiation within the band in lm/W. `None` for a reflectance.
    pub efficacy_lm_per_w: Option<f64>,
}

impl ColourReport {
    /// Computes the colour of a light, or returns an error if it has no luminance for the observer.
    pub fn of_light(light: &Spectrum, observer: &Observer) -> Result<Self> {
        let raw = xyz(light, observer);
        let unit = unit_luminance(raw)?;
        let linear_srgb = xyz_to_linear_srgb(unit);
        let temperature = cct_duv(xyz(light, Observer::cie1931()));
        Ok(Self {
            xyz: unit.map(|value| 100.0 * value),
            xy: coordinates::xy(unit),
            linear_srgb,
            srgb_hex: srgb_hex(gamut::brightest(linear_srgb)),
            dominant: dominant(coordinates::xy(unit), [1.0 / 3.0; 2], observer),
            temperature,
            rendering: temperature.and_then(|temperature| cri(light, temperature)),
            rendition: temperature.and_then(|_| rendition(light)),
            melanopic_ratio: Observer::melanopic_ratio(light),
            efficacy_lm_per_w: Some(LUMENS_PER_WATT * raw[1] / power(light)),
        })
    }

    /// Computes the colour of a reflectance under a light, without chromatic adaptation. Returns an
    /// error if the light has no luminance for the observer.
    pub fn of_reflectance(reflectance: &Spectrum, light: &Spectrum, observer: &Observer) -> Result<Self> {
        let white = xyz(light, observer);
        let white_unit = unit_luminance(white)?;
        let unit = xyz_under(reflectance, light, observer).map(|value| value / white[1]);
        let linear_srgb = xyz_to_linear_srgb(unit);
        Ok(Self {
            xyz: unit.map(|value| 100.0 * value),
            xy: coordinates::xy(unit),
            linear_srgb,
            srgb_hex: srgb_hex(gamut::desaturate(linear_srgb, RgbSpace::Srgb)),
            dominant: dominant(coordinates::xy(unit), coordinates::xy(white_unit), observer),
            temperature: None,
            rendering: None,
            rendition: None,
            melanopic_ratio: None,
            efficacy_lm_per_w: None,
        })
    }
}

/// Returns the power within the band, by the sum of this module.
fn power(light: &Spectrum) -> f64 {
    let fine = light.narrow_part();
    let smooth = |nm: f64| light.continuum_at(nm) - fine.as_ref().map_or(0.0, |fine| fine.continuum_at(nm));
    let sum: f64 = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).map(smooth).sum();
    let lines: f64 = light.line_segments().iter().map(|line| line.power).sum();
    sum + fine.map_or(0.0, |fine| fine.integral()) + lines
}

fn unit_luminance(xyz: Xyz) -> Result<Xyz> {
    let unit = xyz.map(|value| value / xyz[1]);
    if unit.iter().all(|value| value.is_finite()) && xyz[1] > 0.0 {
        return Ok(unit);
    }
    Err(Error::input("a light without luminance for the observer")
        .expected("a light with visible power between 360 and 830 nm"))
}
