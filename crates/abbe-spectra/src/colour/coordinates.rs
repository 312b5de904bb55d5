//! Conversion of XYZ to chromaticities and colour coordinates, and back.

use super::matrix::{Matrix3, apply, inverse};
use super::space::{RgbSpace, xyz_to_linear_srgb};
use super::tristimulus::Xyz;
use crate::math::elementary::cbrt;

/// Returns the CIE 1931 chromaticity x, y, which is that of the equal-energy white for black.
pub fn xy(xyz: Xyz) -> [f64; 2] {
    let sum = xyz[0] + xyz[1] + xyz[2];
    if sum == 0.0 { [1.0 / 3.0; 2] } else { [xyz[0] / sum, xyz[1] / sum] }
}

/// Returns the XYZ of a chromaticity and a luminance Y, or black if y is 0.
pub fn from_xy(xy: [f64; 2], y: f64) -> Xyz {
    if xy[1] == 0.0 {
        return [0.0; 3];
    }
    [xy[0] / xy[1] * y, y, (1.0 - xy[0] - xy[1]) / xy[1] * y]
}

/// Returns the CIE 1976 chromaticity u′, v′ (CIE 15), or (0, 0) for black.
pub fn uv1976(xyz: Xyz) -> [f64; 2] {
    let sum = xyz[0] + 15.0 * xyz[1] + 3.0 * xyz[2];
    if sum == 0.0 { [0.0; 2] } else { [4.0 * xyz[0] / sum, 9.0 * xyz[1] / sum] }
}

/// Returns the CIE 1960 chromaticity u, v, in whose plane correlated colour temperature is defined.
pub fn uv1960(xyz: Xyz) -> [f64; 2] {
    let [u, v] = uv1976(xyz);
    [u, v * 2.0 / 3.0]
}

/// The constant δ of CIE 15: below δ³, a linear function replaces the cube root.
const DELTA: f64 = 6.0 / 29.0;

fn lightness_curve(t: f64) -> f64 {
    if t > DELTA * DELTA * DELTA { cbrt(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

fn lightness_curve_inverse(f: f64) -> f64 {
    if f > DELTA { f * f * f } else { 3.0 * DELTA * DELTA * (f - 4.0 / 29.0) }
}

/// Returns CIE 1976 L*, a*, b* relative to a white (CIE 15). Where a component of the white is 0
/// (for example Z of deep red light), Y relative to the Y of the white is used instead.
pub fn lab(xyz: Xyz, white: Xyz) -> [f64; 3] {
    let [x, y, z] = [0, 1, 2].map(|i| {
        let i = if white[i] == 0.0 { 1 } else { i };
        lightness_curve(xyz[i] / white[i])
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Inverts [`lab`].
pub fn from_lab(lab: [f64; 3], white: Xyz) -> Xyz {
    let y = (lab[0] + 16.0) / 116.0;
    let curve = [y + lab[1] / 500.0, y, y - lab[2] / 200.0];
    [0, 1, 2].map(|i| white[i] * lightness_curve_inverse(curve[i]))
}

/// Returns CIE 1976 L*, u*, v* relative to a white (CIE 15).
pub fn luv(xyz: Xyz, white: Xyz) -> [f64; 3] {
    let lightness = 116.0 * lightness_curve(xyz[1] / white[1]) - 16.0;
    let ([u, v], [white_u, white_v]) = (uv1976(xyz), uv1976(white));
    [lightness, 13.0 * lightness * (u - white_u), 13.0 * lightness * (v - white_v)]
}

/// Inverts [`luv`], with black where L* is 0.
pub fn from_luv(luv: [f64; 3], white: Xyz) -> Xyz {
    if luv[0] == 0.0 {
        return [0.0; 3];
    }
    let y = white[1] * lightness_curve_inverse((luv[0] + 16.0) / 116.0);
    let [white_u, white_v] = uv1976(white);
    let (u, v) = (luv[1] / (13.0 * luv[0]) + white_u, luv[2] / (13.0 * luv[0]) + white_v);
    [y * 9.0 * u / (4.0 * v), y, y * (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v)]
}

/// The matrices from linear sRGB to Oklab's cones, and from their cube roots to L, a, b.
const OKLAB_CONES: Matrix3 = [
    [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
    [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
    [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
];
const OKLAB: Matrix3 = [
    [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
];
const OKLAB_CONES_INVERSE: Matrix3 = inverse(&OKLAB_CONES);
const OKLAB_INVERSE: Matrix3 = inverse(&OKLAB);

/// Returns Oklab L, a, b (Björn Ottosson, "A perceptual color space for image processing", 2020).
/// The white of sRGB has Y = 1.
pub fn oklab(xyz: Xyz) -> [f64; 3] {
    apply(&OKLAB, apply(&OKLAB_CONES, xyz_to_linear_srgb(xyz)).map(cbrt))
}

/// Inverts [`oklab`].
pub fn from_oklab(oklab: [f64; 3]) -> Xyz {
    let cones = apply(&OKLAB_INVERSE, oklab).map(|root| root * root * root);
    RgbSpace::Srgb.to_xyz(apply(&OKLAB_CONES_INVERSE, cones))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_no_hue() {
        let white = RgbSpace::Srgb.white();
        assert!(lab(white, white).iter().zip([100.0, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(luv(white, white).iter().zip([100.0, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(oklab(white).iter().zip([1.0, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-6));
    }

    #[test]
    fn red_has_the_published_oklab_coordinates() {
        let red = oklab(RgbSpace::Srgb.to_xyz([1.0, 0.0, 0.0]));
        assert!(red.iter().zip([0.627_955, 0.224_863, 0.125_846]).all(|(a, b)| (a - b).abs() < 1e-5), "{red:?}");
    }

    #[test]
    fn black_has_finite_coordinates() {
        let white = RgbSpace::Srgb.white();
        for value in [lab([0.0; 3], white), luv([0.0; 3], white), oklab([0.0; 3]), from_luv([0.0; 3], white)] {
            assert!(value.iter().all(|component| component.abs() < 1e-12), "{value:?}");
        }
    }
}
