//! Spectra for RGB colours (spectral upsampling): smooth reflectances within [0, 1].
//!
//! Method: W. Jakob and J. Hanika, "A low-dimensional function space for efficient spectral
//! upsampling", Computer Graphics Forum 38 (2019). A reflectance is S(c₀ + c₁x + c₂x²) with the
//! sigmoid S(y) = ½ + y/(2√(1 + y²)). The three coefficients are fitted when a colour is read, so
//! no coefficient table is needed.

use std::sync::OnceLock;

use super::observer::Observer;
use super::value::Spectrum;
use super::{BAND_NM, library, smooth};
use crate::error::{Error, Result};
use crate::math::elementary::powf;

/// The matrix that converts XYZ to linear sRGB (IEC 61966-2-1). The white point is x = 0.3127, y =
/// 0.3290.
const XYZ_TO_LINEAR_SRGB: [[f64; 3]; 3] = [
    [3.240_969_941_904_521, -1.537_383_177_570_093, -0.498_610_760_293],
    [-0.969_243_636_280_879_4, 1.875_967_501_507_72, 0.041_555_057_407_175_56],
    [0.055_630_079_696_993_59, -0.203_976_958_888_976_5, 1.056_971_514_242_878],
];

/// The number of samples of a fit: one per nm of the band.
const FIT_SAMPLES: usize = (BAND_NM.1 - BAND_NM.0) as usize + 1;

/// The fit stops when the error in linear RGB is below this value. One step of an 8-bit display
/// value is much larger.
const FIT_TOLERANCE: f64 = 1e-9;

type Vec3 = [f64; 3];

/// The illuminant and observer of the fit: D65 and CIE 1931.
struct FitBasis {
    /// D65, scaled so that its Y is 1.
    d65: Spectrum,
    /// For each sample, its contribution to the linear sRGB colour if the reflectance is 1. The sum
    /// over all samples is (1, 1, 1).
    to_rgb: Vec<Vec3>,
}

fn basis() -> &'static FitBasis {
    static BASIS: OnceLock<FitBasis> = OnceLock::new();
    BASIS.get_or_init(|| {
        let table = library::find("D65").expect("the built-in library holds D65").spectrum;
        let observer = Observer::cie1931();
        let d65 = table.scaled(observer.xyz(&table)[1].recip());
        let mut to_rgb: Vec<Vec3> = (0..FIT_SAMPLES)
            .map(|i| {
                let nm = BAND_NM.0 + i as f64;
                let xyz = observer.xyz_bar(nm).map(|bar| bar * d65.at(nm));
                XYZ_TO_LINEAR_SRGB.map(|row| dot(row, xyz))
            })
            .collect();
        // The linear sRGB colour of D65 differs from (1, 1, 1) by up to 3·10⁻⁴. Each channel is
        // normalised to a sum of 1, so that a constant reflectance is exactly grey.
        for channel in 0..3 {
            let sum: f64 = to_rgb.iter().map(|rgb| rgb[channel]).sum();
            to_rgb.iter_mut().for_each(|rgb| rgb[channel] /= sum);
        }
        FitBasis { d65, to_rgb }
    })
}

impl Spectrum {
    /// Returns a smooth reflectance within [0, 1]. Under D65 and for the CIE 1931 observer, the
    /// reflectance has the given linear sRGB colour. The error is at most 10⁻³ for every colour of
    /// the RGB cube. Greys are constant.
    ///
    /// # Errors
    /// Returns an error if a component is outside [0, 1].
    pub fn rgb_reflectance(rgb: [f64; 3]) -> Result<Self> {
        if !rgb.iter().all(|component| (0.0..=1.0).contains(component)) {
            return Err(
                Error::input(format!("the colour {rgb:?} for a reflectance")).expected("components from 0 to 1")
            );
        }
        if rgb == [rgb[0]; 3] {
            return Ok(Self::constant(rgb[0]));
        }
        let coefficients = fit(rgb);
        Ok(Self::upsampled(smooth::sampled(|nm| reflectance(coefficients, nm), &[])))
    }

    /// Returns a light of the given linear sRGB colour: D65 times a smooth filter. Its XYZ values,
    /// computed without the factor 683, match the colour. The error is at most 10⁻³ times the
    /// largest component of the colour.
    ///
    /// # Errors
    /// Returns an error if a component is negative or not finite.
    pub fn rgb_light(rgb: [f64; 3]) -> Result<Self> {
        if !rgb.iter().all(|component| component.is_finite() && *component >= 0.0) {
            return Err(
                Error::input(format!("the colour {rgb:?} for a light")).expected("finite components of 0 or more")
            );
        }
        // The filter is fitted to a scaled colour whose brightest component is 0.5. A filter with
        // values near 1 would be less smooth.
        let scale = 2.0 * rgb.iter().copied().fold(0.0, f64::max);
        let d65 = &basis().d65;
        if scale == 0.0 || rgb == [rgb[0]; 3] {
            return Ok(d65.scaled(rgb[0]));
        }
        let coefficients = fit(rgb.map(|component| component / scale));
        let light = |nm: f64| scale * reflectance(coefficients, nm) * d65.at(nm);
        Ok(Self::upsampled(smooth::sampled(light, &[])))
    }
}

/// Maps the band to [−1, 1], so that the fit is well conditioned.
fn abscissa(nm: f64) -> f64 {
    (2.0 * nm - (BAND_NM.0 + BAND_NM.1)) / (BAND_NM.1 - BAND_NM.0)
}

fn polynomial(c: Vec3, nm: f64) -> f64 {
    let x = abscissa(nm);
    c[0] + x * (c[1] + x * c[2])
}

fn reflectance(c: Vec3, nm: f64) -> f64 {
    sigmoid(polynomial(c, nm))
}

fn sigmoid(y: f64) -> f64 {
    // For y far below 0, the form in the first branch has no cancellation.
    let root = (1.0 + y * y).sqrt();
    if y < 0.0 { 0.5 / (root * (root - y)) } else { 0.5 + 0.5 * y / root }
}

/// Fits the coefficients to a colour whose components lie in [0, 1]. The method is
/// Levenberg–Marquardt (damped Gauss–Newton). The target of the fit moves in eight stages from a
/// grey to the given colour. The grey and the colour have the same mean of the three components.
fn fit(rgb: Vec3) -> Vec3 {
    let grey = (rgb.iter().sum::<f64>() / 3.0).clamp(0.01, 0.99);
    let level = 2.0 * grey - 1.0;
    let mut c = [level / (1.0 - level * level).sqrt(), 0.0, 0.0];
    for step in 1..=8 {
        let share = f64::from(step) / 8.0;
        let target = rgb.map(|component| grey + share * (component - grey));
        c = solve_from(c, target, if step == 8 { 200 } else { 8 });
    }
    c
}

fn solve_from(mut c: Vec3, target: Vec3, steps: usize) -> Vec3 {
    let mut damping = 1e-4;
    let (mut error, mut jacobian) = residual(c, target);
    for _ in 0..steps {
        let size = dot(error, error);
        if size < FIT_TOLERANCE * FIT_TOLERANCE {
            break;
        }
        let next = step(c, error, jacobian, damping);
        let (next_error, next_jacobian) = residual(next, target);
        if dot(next_error, next_error) < size {
            (c, error, jacobian) = (next, next_error, next_jacobian);
            damping *= 0.2;
        } else {
            damping *= 5.0;
        }
    }
    c
}

/// Returns the error of a fit in linear sRGB, and the derivatives of the error with respect to the
/// coefficients. The indices of a derivative are `[channel][coefficient]`.
fn residual(c: Vec3, target: Vec3) -> (Vec3, [Vec3; 3]) {
    let mut error = target.map(|component| -component);
    let mut jacobian = [[0.0; 3]; 3];
    for (i, to_rgb) in basis().to_rgb.iter().enumerate() {
        let nm = BAND_NM.0 + i as f64;
        let (x, y) = (abscissa(nm), polynomial(c, nm));
        let slope = 0.5 * powf(1.0 + y * y, -1.5);
        for channel in 0..3 {
            error[channel] += to_rgb[channel] * sigmoid(y);
            let weight = to_rgb[channel] * slope;
            jacobian[channel][0] += weight;
            jacobian[channel][1] += weight * x;
            jacobian[channel][2] += weight * x * x;
        }
    }
    (error, jacobian)
}

/// Returns c − (JᵀJ + damping·diag(JᵀJ))⁻¹ Jᵀ error.
fn step(c: Vec3, error: Vec3, jacobian: [Vec3; 3], damping: f64) -> Vec3 {
    let column = |i: usize| [jacobian[0][i], jacobian[1][i], jacobian[2][i]];
    let mut normal = [[0.0; 3]; 3];
    for (i, row) in normal.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = dot(column(i), column(j)) * if i == j { 1.0 + damping } else { 1.0 };
        }
    }
    let change = solve(normal, [dot(column(0), error), dot(column(1), error), dot(column(2), error)]);
    let next = [c[0] - change[0], c[1] - change[1], c[2] - change[2]];
    if next.iter().all(|coefficient| coefficient.is_finite()) { next } else { c }
}

/// Solves three linear equations by Cramer's rule.
fn solve(m: [Vec3; 3], right: Vec3) -> Vec3 {
    let determinant = |m: [Vec3; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = determinant(m);
    [0, 1, 2].map(|column| {
        let mut replaced = m;
        replaced.iter_mut().zip(right).for_each(|(row, value)| row[column] = value);
        determinant(replaced) / whole
    })
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear_srgb_under_d65(reflectance: &Spectrum) -> Vec3 {
        let xyz = Observer::cie1931().xyz_under(reflectance, &basis().d65);
        XYZ_TO_LINEAR_SRGB.map(|row| dot(row, xyz))
    }

    /// Tests 9³ colours on a regular grid in the RGB cube. Returns the largest error of any
    /// component, and the colour with this error.
    fn worst(back: impl Fn(Vec3) -> Vec3) -> (f64, Vec3) {
        let colours = (0..729).map(|code| [code / 81, code / 9 % 9, code % 9].map(|level| f64::from(level) / 8.0));
        let error = |rgb: Vec3| {
            let back = back(rgb);
            (0..3).map(|i| (back[i] - rgb[i]).abs()).fold(0.0, f64::max)
        };
        colours.map(|rgb| (error(rgb), rgb)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }

    /// Every colour of the cube must be reproduced by a reflectance within [0, 1].
    #[test]
    fn every_colour_has_a_reflectance_within_0_and_1() {
        let worst = worst(|rgb| {
            let spectrum = Spectrum::rgb_reflectance(rgb).unwrap();
            assert!(spectrum.min() >= 0.0 && spectrum.max() <= 1.0, "{rgb:?}");
            assert_eq!(spectrum.is_upsampled(), rgb != [rgb[0]; 3], "greys are not upsampled");
            linear_srgb_under_d65(&spectrum)
        });
        println!("reflectances: {worst:?}");
        assert!(worst.0 <= 1e-3, "{worst:?}");
    }

    #[test]
    fn every_colour_has_a_light_at_any_strength() {
        for strength in [1.0, 1e-6, 1e6] {
            let worst = worst(|rgb| {
                let light = Spectrum::rgb_light(rgb.map(|component| strength * component)).unwrap();
                assert!(light.min() >= 0.0, "{rgb:?}");
                let xyz = Observer::cie1931().xyz(&light).map(|value| value / strength);
                XYZ_TO_LINEAR_SRGB.map(|row| dot(row, xyz))
            });
            println!("lights of {strength}: {worst:?}");
            assert!(worst.0 <= 1e-3, "{worst:?}");
        }
    }
}
