//! Smooth reflectances of RGB colours: a sigmoid of a quadratic polynomial.
//!
//! Method: W. Jakob and J. Hanika, "A low-dimensional function space for efficient spectral
//! upsampling", Computer Graphics Forum 38 (2019). A reflectance is S(c₀ + c₁x + c₂x²) with the
//! sigmoid S(y) = ½ + y/(2√(1 + y²)), whose coefficients are fitted when a colour is read, so no
//! coefficient table is needed.

use std::sync::OnceLock;

use super::band::BAND_NM;
use super::library;
use super::observer::Observer;
use super::value::Spectrum;
use wide::f32x4;

/// The matrix from XYZ to linear sRGB (IEC 61966-2-1) for the white point x = 0.3127, y = 0.3290.
pub(super) const XYZ_TO_LINEAR_SRGB: [[f64; 3]; 3] = [
    [3.240_969_941_904_521, -1.537_383_177_570_093, -0.498_610_760_293],
    [-0.969_243_636_280_879_4, 1.875_967_501_507_72, 0.041_555_057_407_175_56],
    [0.055_630_079_696_993_59, -0.203_976_958_888_976_5, 1.056_971_514_242_878],
];

const FIT_SAMPLES: usize = (BAND_NM.1 - BAND_NM.0) as usize + 1;

/// The error in linear RGB below which the fit stops, far below one step of an 8-bit display value.
const FIT_TOLERANCE: f64 = 1e-9;

/// The error of a fit near a known colour, below one 8-bit step except for the darkest values.
const NEAR_TOLERANCE: f64 = 1e-5;

/// The number of steps of a fit near a known colour, after which the fit starts from a grey.
const NEAR_STEPS: usize = 30;

/// The size of the first coefficient of white, whose reflectance differs from 1 by less than 10⁻¹⁶.
const BLACK_OR_WHITE: f64 = 1e9;

pub(super) type Vec3 = [f64; 3];

pub(super) struct FitBasis {
    /// D65, scaled so that its Y is 1.
    pub(super) d65: Spectrum,
    /// The linear sRGB colour of each sample at reflectance 1. Their sum is (1, 1, 1).
    to_rgb: Vec<Vec3>,
}

pub(super) fn basis() -> &'static FitBasis {
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

/// A smooth reflectance within [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothReflectance(Vec3);

impl SmoothReflectance {
    /// Returns the reflectance of this linear sRGB colour, with components in [0, 1], under D65 and
    /// for the CIE 1931 observer. The error is at most 10⁻³, and greys are constant.
    pub fn of_rgb(rgb: [f64; 3]) -> Self {
        if rgb == [rgb[0]; 3] { Self([grey(rgb[0]), 0.0, 0.0]) } else { Self(fit(rgb)) }
    }

    /// Returns the same as [`Self::of_rgb`] up to an error of 10⁻⁵ in linear sRGB, by a fit that
    /// starts at the reflectance of a similar colour.
    pub fn of_rgb_near(rgb: [f64; 3], similar: Self) -> Self {
        if rgb == [rgb[0]; 3] {
            return Self::of_rgb(rgb);
        }
        let (coefficients, error) = solve_from(similar.0, rgb, NEAR_TOLERANCE, NEAR_STEPS, fast_residual);
        if error < NEAR_TOLERANCE { Self(coefficients) } else { Self::of_rgb(rgb) }
    }

    /// Returns the reflectance at a wavelength (nm).
    #[inline]
    pub fn at(self, nm: f64) -> f64 {
        sigmoid(polynomial(self.0, nm))
    }

    /// Returns the coefficients c₀, c₁ and c₂ in x, which is −1 at 360 nm and 1 at 830 nm.
    pub fn coefficients(self) -> [f64; 3] {
        self.0
    }

    /// Returns the reflectance of the given coefficients.
    pub fn from_coefficients(coefficients: [f64; 3]) -> Self {
        Self(coefficients)
    }
}

/// Maps the band to [−1, 1], so that the fit is well conditioned.
#[inline]
fn abscissa(nm: f64) -> f64 {
    (2.0 * nm - (BAND_NM.0 + BAND_NM.1)) / (BAND_NM.1 - BAND_NM.0)
}

#[inline]
fn polynomial(c: Vec3, nm: f64) -> f64 {
    let x = abscissa(nm);
    c[0] + x * (c[1] + x * c[2])
}

#[inline]
fn sigmoid(y: f64) -> f64 {
    // For y far below 0, the form in the first branch has no cancellation.
    let root = (1.0 + y * y).sqrt();
    if y < 0.0 { 0.5 / (root * (root - y)) } else { 0.5 + 0.5 * y / root }
}

/// Returns the first coefficient of a constant reflectance.
fn grey(value: f64) -> f64 {
    let level = 2.0 * value - 1.0;
    let root = (1.0 - level * level).max(0.0).sqrt();
    if root > 0.0 { (level / root).clamp(-BLACK_OR_WHITE, BLACK_OR_WHITE) } else { BLACK_OR_WHITE.copysign(level) }
}

/// Fits the coefficients to a colour with components in [0, 1] by Levenberg–Marquardt (damped
/// Gauss–Newton). The target of the fit moves in eight stages from the grey of the same mean
/// component to the colour.
fn fit(rgb: Vec3) -> Vec3 {
    let mean = (rgb.iter().sum::<f64>() / 3.0).clamp(0.01, 0.99);
    let mut c = [grey(mean), 0.0, 0.0];
    for step in 1..=8 {
        let fraction = f64::from(step) / 8.0;
        let target = rgb.map(|component| mean + fraction * (component - mean));
        (c, _) = solve_from(c, target, FIT_TOLERANCE, if step == 8 { 200 } else { 8 }, residual);
    }
    c
}

/// Improves the coefficients in at most `steps` steps until the error in linear RGB, which
/// `residual` returns with its derivatives, is below `tolerance`. Returns them and their error.
fn solve_from(
    mut c: Vec3,
    target: Vec3,
    tolerance: f64,
    steps: usize,
    residual: fn(Vec3, Vec3) -> (Vec3, [Vec3; 3]),
) -> (Vec3, f64) {
    let mut damping = 1e-4;
    let (mut error, mut jacobian) = residual(c, target);
    for _ in 0..steps {
        let size = dot(error, error);
        if size < tolerance * tolerance {
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
    (c, dot(error, error).sqrt())
}

/// Returns the error of a fit in linear sRGB and its derivatives with respect to the coefficients,
/// indexed by `[channel][coefficient]`.
fn residual(c: Vec3, target: Vec3) -> (Vec3, [Vec3; 3]) {
    let mut error = target.map(|component| -component);
    let mut jacobian = [[0.0; 3]; 3];
    for (i, to_rgb) in basis().to_rgb.iter().enumerate() {
        let nm = BAND_NM.0 + i as f64;
        let (x, y) = (abscissa(nm), polynomial(c, nm));
        let square = 1.0 + y * y;
        let slope = 0.5 / (square * square.sqrt());
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

/// The samples of [`FitBasis`] in single precision, four at a time.
struct FastBasis {
    /// The variables of the polynomial, and the contributions to red, green and blue.
    groups: Vec<(f32x4, [f32x4; 3])>,
}

fn fast_basis() -> &'static FastBasis {
    static BASIS: OnceLock<FastBasis> = OnceLock::new();
    BASIS.get_or_init(|| {
        let to_rgb = &basis().to_rgb;
        let group = |first: usize| {
            // Samples beyond the band contribute nothing.
            let lanes = |value: &dyn Fn(usize) -> f64| {
                let of_sample = |lane: usize| if first + lane < FIT_SAMPLES { value(first + lane) as f32 } else { 0.0 };
                f32x4::from(std::array::from_fn::<f32, 4, _>(of_sample))
            };
            let x = lanes(&|i| abscissa(BAND_NM.0 + i as f64));
            (x, std::array::from_fn(|channel| lanes(&|i| to_rgb[i][channel])))
        };
        FastBasis { groups: (0..FIT_SAMPLES).step_by(4).map(group).collect() }
    })
}

/// Computes [`residual`] in single precision, with errors of the sums of about 10⁻⁶.
fn fast_residual(c: Vec3, target: Vec3) -> (Vec3, [Vec3; 3]) {
    let [c0, c1, c2] = c.map(|coefficient| f32x4::splat(coefficient as f32));
    let (one, half) = (f32x4::splat(1.0), f32x4::splat(0.5));
    let (mut values, mut slopes) = ([f32x4::splat(0.0); 3], [[f32x4::splat(0.0); 3]; 3]);
    for (x, to_rgb) in &fast_basis().groups {
        let y = c0 + *x * (c1 + *x * c2);
        let square = one + y * y;
        let inverse_root = one / square.sqrt();
        let value = half + half * y * inverse_root;
        let slope = half * inverse_root * inverse_root * inverse_root;
        for channel in 0..3 {
            values[channel] += to_rgb[channel] * value;
            let weight = to_rgb[channel] * slope;
            let weight_x = weight * *x;
            slopes[channel][0] += weight;
            slopes[channel][1] += weight_x;
            slopes[channel][2] += weight_x * *x;
        }
    }
    let sum = |lanes: f32x4| f64::from(lanes.reduce_add());
    (std::array::from_fn(|i| sum(values[i]) - target[i]), slopes.map(|row| row.map(sum)))
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

pub(super) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_near_a_similar_colour_agree_with_fits_from_grey() {
        let colours = [[0.2, 0.5, 0.1], [0.21, 0.5, 0.1], [1.0, 0.0, 0.0], [0.98, 0.02, 0.0], [0.3, 0.3, 0.31]];
        let mut similar = SmoothReflectance::of_rgb([0.5; 3]);
        for rgb in colours {
            let (near, full) = (SmoothReflectance::of_rgb_near(rgb, similar), SmoothReflectance::of_rgb(rgb));
            let errors = [near, full].map(|found| residual(found.0, rgb).0.map(f64::abs));
            assert!(errors.as_flattened().iter().all(|error| *error < 1e-3), "{rgb:?}: {errors:?}");
            similar = near;
        }
    }

    #[test]
    fn the_fast_residual_is_the_residual() {
        for c in [[0.3, -0.2, 0.8], [-4.0, 3.0, 20.0], [300.0, -700.0, 90.0]] {
            let ((error, jacobian), (fast, fast_jacobian)) = (residual(c, [0.5; 3]), fast_residual(c, [0.5; 3]));
            let pairs = error.iter().zip(&fast).chain(jacobian.as_flattened().iter().zip(fast_jacobian.as_flattened()));
            pairs.for_each(|(a, b)| assert!((a - b).abs() < 5e-6, "{c:?}: {a} and {b}"));
        }
    }

    #[test]
    fn black_grey_and_white_are_constant() {
        for value in [0.0, 0.18, 0.5, 1.0] {
            let reflectance = SmoothReflectance::of_rgb([value; 3]);
            for nm in [360.0, 555.0, 830.0] {
                assert!((reflectance.at(nm) - value).abs() < 1e-15, "{value}: {}", reflectance.at(nm));
            }
        }
    }
}
