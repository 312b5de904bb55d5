//! The colour of a spectrum as tables of colour report it.
//!
//! Smooth spectra and tables are summed over samples every nm from 360 to 830, as colour science does and the
//! reference values assume; lines are multiplied with the colour-matching functions at their wavelength, and peaks
//! narrower than 5 nm are integrated. (Rendering integrates everything exactly; the two agree to 3·10⁻⁴.)

use super::adaptation::{Transform, adapt};
use super::dominant::{Dominant, dominant};
use super::rendering::{ColourRendering, cri};
use super::space::{RgbSpace, srgb_hex, xyz_to_linear_srgb};
use super::temperature::{CorrelatedTemperature, cct_duv};
use super::{Rgb, Xyz, coordinates, gamut};
use crate::error::{Error, Result};
use crate::spectrum::{BAND_NM, LUMENS_PER_WATT, LineSegment, Observer, Spectrum};

/// Lines wider than this, in nm, are integrated instead of evaluated at their centre.
const WIDE_LINE_NM: f64 = 5.0;

/// XYZ of a light: ∫ Φ x̄ȳz̄ dλ by the sums of this module, without the factor 683.
pub fn xyz(light: &Spectrum, observer: &Observer) -> Xyz {
    xyz_under(&Spectrum::constant(1.0), light, observer)
}

/// XYZ of a reflectance under a light, on the light's scale.
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
    // (light − fine)(reflectance − fine) is summed above; what is left of light · reflectance is integrated.
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
    observer.xyz_under(reflectance, &Spectrum::of_segments(&[*line]))
}

/// The colour of a light, or of a reflectance under a light.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// XYZ; Y = 100 for a light, and for the perfect diffuser under a light.
    pub xyz: Xyz,
    /// Chromaticity x, y.
    pub xy: [f64; 2],
    /// Linear sRGB with Y = 1 where `xyz` has Y = 100; unclipped.
    pub linear_srgb: Rgb,
    /// A swatch: the colour mapped into sRGB, a light's as bright as its chromaticity allows.
    pub srgb_hex: String,
    /// Dominant wavelength and excitation purity, against equal energy for a light and against the lamp for a
    /// reflectance; absent for neutral colours.
    pub dominant: Option<Dominant>,
    /// Correlated colour temperature of a light, where it is defined; always by the CIE 1931 observer.
    pub temperature: Option<CorrelatedTemperature>,
    /// Colour rendering of a light, where it is defined.
    pub rendering: Option<ColourRendering>,
    /// Lumens per watt of radiation within the band; lights only.
    pub efficacy_lm_per_w: Option<f64>,
}

impl Report {
    /// The colour of a light.
    ///
    /// # Errors
    /// A spectrum without power that the observer sees.
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
            efficacy_lm_per_w: Some(LUMENS_PER_WATT * raw[1] / power(light)),
        })
    }

    /// The colour of a reflectance under a light, not adapted.
    ///
    /// # Errors
    /// A light without power that the observer sees.
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
            efficacy_lm_per_w: None,
        })
    }

    /// Linear sRGB after adaptation from a white to that of sRGB by Bradford's transform.
    pub fn adapted_srgb(&self, white: Xyz) -> Rgb {
        xyz_to_linear_srgb(adapt(self.xyz, white, RgbSpace::Srgb.white(), Transform::Bradford).map(|v| v / 100.0))
    }
}

/// Power within the band by the same sums.
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
    Err(Error::input("a light without power that the observer sees").expected("power between 360 and 830 nm"))
}
