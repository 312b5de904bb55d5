//! Tone curves: the treatment of colours that are brighter than a display can show.

use super::by_name;
use super::matrix::{Matrix3, apply};
use super::space::RgbSpace;
use super::tristimulus::Rgb;
use crate::error::Result;
use crate::math::elementary::{log2, powf};
use serde::{Deserialize, Serialize};

/// The tone curve of a picture for a display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToneCurve {
    /// Compresses bright colours, so that highlights keep their colour and their gradations.
    #[default]
    RollOff,
    /// Changes no colour, and leaves colours that are too bright to the gamut mapping.
    Clip,
    /// The Khronos PBR Neutral tone mapper (Khronos Group 2024).
    PbrNeutral,
    /// AgX (Sobotka 2022).
    Agx,
}

const KNEE: f64 = 0.6;

/// Desaturates very bright colours: a component of 1/`DESATURATION` loses half its saturation.
const DESATURATION: f64 = 0.03;

impl ToneCurve {
    /// Every curve.
    pub const ALL: [Self; 4] = [Self::RollOff, Self::Clip, Self::PbrNeutral, Self::Agx];

    /// Returns the name of the curve.
    pub fn name(self) -> &'static str {
        match self {
            Self::RollOff => "roll_off",
            Self::Clip => "clip",
            Self::PbrNeutral => "pbr_neutral",
            Self::Agx => "agx",
        }
    }

    /// Returns a curve by its name (`roll_off`, `clip`, `pbr_neutral` or `agx`), or an error.
    pub fn by_name(name: &str) -> Result<Self> {
        by_name("tone curve", name, &Self::ALL.map(|any| (any.name(), any)))
    }

    /// Applies the curve to linear components of `space`.
    #[inline]
    pub fn apply(self, rgb: Rgb, space: RgbSpace) -> Rgb {
        match self {
            Self::RollOff => roll_off(rgb),
            Self::Clip => rgb,
            Self::PbrNeutral => pbr_neutral(rgb),
            Self::Agx => space.from_xyz(RgbSpace::Rec2020.to_xyz(agx(RgbSpace::Rec2020.from_xyz(space.to_xyz(rgb))))),
        }
    }
}

/// Compresses the largest component p of a colour to less than 1, as the Khronos PBR Neutral tone
/// mapper (Khronos Group, 2024) does. Above the knee k = [`KNEE`], up to which the curve is the
/// identity, it becomes 1 − (1 − k)²/(p + 1 − 2k), whose slope is continuous there. The other
/// components are scaled by the same factor, which preserves the chromaticity, and then the colour
/// moves a little towards white. The desaturation is weaker than that of Khronos, because a
/// spectrum must keep its colours, and the offset for dark colours is omitted. Instead of p, the
/// curve takes [`rounded_peak`].
#[inline]
fn roll_off(rgb: Rgb) -> Rgb {
    let peak = rounded_peak(rgb);
    if peak <= KNEE || peak.is_nan() {
        return rgb;
    }
    if peak == f64::INFINITY {
        return [1.0; 3];
    }
    let compressed = 1.0 - (1.0 - KNEE) * (1.0 - KNEE) / (peak + 1.0 - 2.0 * KNEE);
    let saturation = 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    rgb.map(|component| compressed * (saturation * component / peak + 1.0 - saturation))
}

/// Returns the largest component, and a little more if the second largest is nearly as large and
/// the third is not: without this, a spectrum has a bright ridge at yellow, where the largest
/// component changes from green to red. At that place, the slopes of both sides are equal. The
/// largest component of a neutral colour does not change.
#[inline]
fn rounded_peak(rgb: Rgb) -> f64 {
    const POWER: i32 = 8;
    const EXCESS: f64 = 1.0 / (2 * POWER - 1) as f64;
    let [r, g, b] = rgb;
    let peak = r.max(g).max(b);
    if peak <= 0.0 || peak.is_nan() || peak == f64::INFINITY {
        return peak;
    }
    let second = r.min(g).max(r.max(g).min(b)).max(0.0);
    let least = r.min(g).min(b).max(0.0);
    peak * (1.0 + EXCESS * (second / peak).powi(POWER) * (1.0 - least / peak))
}

/// The Khronos PBR Neutral tone mapper (Khronos Group, "Khronos PBR Neutral Tone Mapper
/// Specification", 2024). It subtracts the reflection of a dielectric at normal incidence, 0.04,
/// compresses components above 0.76, and moves bright colours towards white.
fn pbr_neutral(rgb: Rgb) -> Rgb {
    const F90: f64 = 0.04;
    const START: f64 = 0.8 - F90;
    const DESATURATION: f64 = 0.15;
    let least = rgb[0].min(rgb[1]).min(rgb[2]);
    let offset = if least < 2.0 * F90 { least - least * least / (4.0 * F90) } else { F90 };
    let shifted = rgb.map(|component| component - offset);
    let peak = shifted[0].max(shifted[1]).max(shifted[2]);
    if peak < START || peak.is_nan() {
        return shifted;
    }
    if peak == f64::INFINITY {
        return [1.0; 3];
    }
    let range = 1.0 - START;
    let compressed = 1.0 - range * range / (peak + range - START);
    let saturation = 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    shifted.map(|component| compressed * (saturation * component / peak + 1.0 - saturation))
}

/// AgX's inset of the primaries for Rec. 2020 (E. Chow, `AgXBaseRec2020`, 2023).
const AGX_INSET: Matrix3 = [
    [0.856_627_153_315_983, 0.095_121_240_538_158_8, 0.048_251_606_145_858_3],
    [0.137_318_972_929_847, 0.761_241_990_602_591, 0.101_439_036_467_562],
    [0.111_898_212_999_950, 0.076_799_418_603_190_3, 0.811_302_368_396_859],
];

const AGX_OUTSET: Matrix3 = [
    [1.127_100_581_814_436_8, -0.110_606_643_096_603_23, -0.016_493_938_717_834_573],
    [-0.141_329_763_498_438_3, 1.157_823_702_216_272, -0.016_493_938_717_834_257],
    [-0.141_329_763_498_438_26, -0.110_606_643_096_602_94, 1.251_936_406_595_040_5],
];

/// The base-2 logarithms of the darkest and the brightest component of AgX.
const AGX_RANGE_EV: [f64; 2] = [-12.473_93, 4.026_069];

/// AgX's contrast curve, from the constant term up (B. Wrensch, "Minimal AgX implementation",
/// 2023).
const AGX_CONTRAST: [f64; 7] = [-0.002_32, 0.119_1, 0.429_8, -6.868, 31.96, -40.14, 15.5];

/// The exponent with which a display decodes the output of AgX.
const AGX_DISPLAY_EXPONENT: f64 = 2.2;

/// Compresses components of Rec. 2020 on a logarithmic scale after an inset of the primaries, so
/// that bright colours turn white as on film, and returns linear components (AgX).
fn agx(rgb: Rgb) -> Rgb {
    let [darkest, brightest] = AGX_RANGE_EV;
    let curve = |component: f64| {
        let ev = log2(component.max(1e-10)).clamp(darkest, brightest);
        let x = (ev - darkest) / (brightest - darkest);
        AGX_CONTRAST.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
    };
    let compressed = apply(&AGX_INSET, rgb).map(curve);
    apply(&AGX_OUTSET, compressed).map(|encoded| powf(encoded.max(0.0), AGX_DISPLAY_EXPONENT))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the specification: dielectrics below 0.8 lose 0.04, and 2 becomes 0.96.
    #[test]
    fn pbr_neutral_has_the_values_of_its_specification() {
        let grey = |y: f64| ToneCurve::PbrNeutral.apply([y; 3], RgbSpace::Srgb)[1];
        for (y, expected) in [(0.0, 0.0), (0.02, 0.0025), (0.5, 0.46), (0.8, 0.76), (2.0, 0.96), (f64::INFINITY, 1.0)] {
            assert!((grey(y) - expected).abs() < 1e-12, "{y}: {}", grey(y));
        }
        let [r, g, b] = ToneCurve::PbrNeutral.apply([8.0, 4.0, 0.5], RgbSpace::Srgb);
        assert!(1.0 > r && r > g && g > b && b > 0.3, "bright colours turn white: {r} {g} {b}");
    }

    /// Grey stays grey. AgX shows 0.18 in the middle of the display's range, and 2⁴ as white.
    #[test]
    fn agx_shows_middle_grey_in_the_middle() {
        for space in RgbSpace::ALL {
            let shown = ToneCurve::Agx.apply(space.from_xyz(RgbSpace::Rec2020.to_xyz([0.18; 3])), space);
            let [r, g, b] = RgbSpace::Rec2020.from_xyz(space.to_xyz(shown)).map(|c| powf(c, 1.0 / 2.2));
            assert!((g - 0.5).abs() < 0.005 && (r - g).abs() < 1e-9 && (b - g).abs() < 1e-9, "{r} {g} {b}");
        }
        let grey = |y: f64| ToneCurve::Agx.apply([y; 3], RgbSpace::Rec2020)[1];
        assert!(grey(0.0) < 1e-3 && (grey(17.0) - 1.0).abs() < 0.03, "{} {}", grey(0.0), grey(17.0));
        let [r, _, b] = ToneCurve::Agx.apply([16.0, 0.1, 0.1], RgbSpace::Srgb);
        assert!(r > 0.9 && b > 0.2, "a bright red turns pink: {r} {b}");
    }

    #[test]
    fn dark_colours_stay_and_bright_ones_keep_their_order() {
        let grey = |y: f64| ToneCurve::RollOff.apply([y; 3], RgbSpace::Srgb)[1];
        assert_eq!([0.0, 0.18, KNEE].map(grey), [0.0, 0.18, KNEE]);
        assert!((grey(1.0) - 0.8).abs() < 1e-12);
        let steps: Vec<f64> = (0..400).map(|i| grey(1.05_f64.powi(i - 200))).collect();
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1] && pair[1] < 1.0));
        let slope = (grey(KNEE + 1e-6) - grey(KNEE)) / 1e-6;
        assert!((slope - 1.0).abs() < 1e-4, "the slope is continuous: {slope}");
    }

    #[test]
    fn highlights_keep_their_colour() {
        // An orange that is ten times too bright, and a colour outside of the gamut.
        let [r, g, b] = ToneCurve::RollOff.apply([10.0, 4.0, 1.0], RgbSpace::Srgb);
        assert!(r < 1.0 && (0.4..0.55).contains(&(g / r)) && (0.1..0.3).contains(&(b / r)), "{r} {g} {b}");
        assert!(
            ToneCurve::RollOff.apply([3.0, 1.0, -0.5], RgbSpace::Srgb)[2] < 0.0,
            "the gamut mapping sees the same hue"
        );
        assert_eq!(ToneCurve::RollOff.apply([f64::INFINITY, 1.0, 0.0], RgbSpace::Srgb), [1.0; 3]);
        assert_eq!(ToneCurve::Clip.apply([10.0, 4.0, 1.0], RgbSpace::Srgb), [10.0, 4.0, 1.0]);
    }

    #[test]
    fn names_select_curves() {
        assert!(ToneCurve::ALL.into_iter().all(|curve| ToneCurve::by_name(curve.name()) == Ok(curve)));
        assert_eq!(ToneCurve::by_name("filmic").unwrap_err().exit_status(), 2);
    }
}
