//! Tone curves: the treatment of colours that are brighter than a display can show.

use super::Rgb;
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// The tone curve of a picture for a display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToneCurve {
    /// Compresses bright colours, so that highlights keep their colour and their gradations.
    #[default]
    RollOff,
    /// Changes no colour. The gamut mapping handles colours that are too bright.
    Clip,
}

/// The curve is the identity up to this component.
const KNEE: f64 = 0.6;

/// The strength with which very bright colours turn white. A component of 1/`DESATURATION` loses
/// half of its saturation.
const DESATURATION: f64 = 0.02;

impl ToneCurve {
    /// Every curve.
    pub const ALL: [Self; 2] = [Self::RollOff, Self::Clip];

    /// Returns the name of the curve.
    pub fn name(self) -> &'static str {
        match self {
            Self::RollOff => "roll_off",
            Self::Clip => "clip",
        }
    }

    /// Returns a curve by its name: `roll_off` or `clip`.
    ///
    /// # Errors
    /// Returns an error if the name is unknown.
    pub fn by_name(name: &str) -> Result<Self> {
        let names = Self::ALL.map(Self::name);
        Self::ALL
            .into_iter()
            .find(|curve| curve.name().eq_ignore_ascii_case(name))
            .ok_or_else(|| Error::unknown_name("tone curve", name, names).expected(names.join(", ")))
    }

    /// Applies the curve to linear components.
    #[inline]
    pub fn apply(self, rgb: Rgb) -> Rgb {
        match self {
            Self::RollOff => roll_off(rgb),
            Self::Clip => rgb,
        }
    }
}

/// Compresses the largest component p of a colour to less than 1.
///
/// The curve is the highlight compression of the Khronos PBR Neutral tone mapper (Khronos Group,
/// 2024). The largest component becomes 1 − (1 − k)²/(p + 1 − 2k) above the knee k, and its slope
/// is continuous. The other components are scaled by the same factor, so the chromaticity is
/// preserved. Then the colour moves a little towards white. The desaturation is weaker than in the
/// Khronos curve, because a spectrum must keep its colours. The offset of the Khronos curve for
/// dark colours is omitted.
#[inline]
fn roll_off(rgb: Rgb) -> Rgb {
    let peak = rgb[0].max(rgb[1]).max(rgb[2]);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dark_colours_stay_and_bright_ones_keep_their_order() {
        let grey = |y: f64| ToneCurve::RollOff.apply([y; 3])[1];
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
        let [r, g, b] = ToneCurve::RollOff.apply([10.0, 4.0, 1.0]);
        assert!(r < 1.0 && (0.4..0.55).contains(&(g / r)) && (0.1..0.3).contains(&(b / r)), "{r} {g} {b}");
        assert!(ToneCurve::RollOff.apply([3.0, 1.0, -0.5])[2] < 0.0, "the gamut mapping sees the same hue");
        assert_eq!(ToneCurve::RollOff.apply([f64::INFINITY, 1.0, 0.0]), [1.0; 3]);
        assert_eq!(ToneCurve::Clip.apply([10.0, 4.0, 1.0]), [10.0, 4.0, 1.0]);
    }

    #[test]
    fn names_select_curves() {
        assert!(ToneCurve::ALL.into_iter().all(|curve| ToneCurve::by_name(curve.name()) == Ok(curve)));
        assert_eq!(ToneCurve::by_name("filmic").unwrap_err().exit_status(), 2);
    }
}
