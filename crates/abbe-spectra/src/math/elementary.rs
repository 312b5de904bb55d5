//! Elementary functions that return the same bits on every machine.
//!
//! The methods of `f64`, such as `f64::sin`, call the C library of the system, whose results differ
//! in the last bit between versions and, in the GNU C library, between processors. The functions of
//! this module consist of operations that IEEE 754 rounds exactly (additions, multiplications,
//! divisions and square roots), so their results depend only on the arguments. The renderer calls
//! only these functions, and `clippy.toml` disallows the methods.
//!
//! [`exp`], [`sin_cos`] and [`atan2_f32`] run for most path segments or photons, so they are
//! polynomials of this module, which the compiler can inline. The others are those of the crate
//! `libm`.
//!
//! Some methods of `f64` are allowed, because their results are determined:
//!
//! - `sqrt`, `mul_add`, `floor`, `ceil`, `round`, `%`, `rem_euclid` and the like are rounded
//!   exactly.
//! - `powi` squares repeatedly from the lowest bit of the exponent, and divides once if the
//!   exponent is negative. The compiler calls this loop from its run-time library, or emits the
//!   same sequence if the exponent is constant.
//!
//! Two dependencies of the renderer still call the C library. `obvhs` rounds the logarithm of the
//! size of a box up to an integer, which decides how tightly a box encloses its contents, but not
//! what a ray hits. `exr` computes the constants of the DWA compression of input images.

pub use libm::{
    acos, asin, asinh, atan, atan2, cbrt, exp2, expm1 as exp_m1, hypot, j1 as bessel_j1, log as ln, log1p as ln_1p,
    log2, log10, pow as powf, sinh, tan,
};

/// 1.5·2⁵²: adding it rounds a smaller number to an integer, in two's complement in the low bits.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;

/// The high part of ln 2, whose product with an integer below 2²¹ is exact.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// The coefficients of r² to r¹¹ of a polynomial that approximates exp(r) for |r| ≤ ln(2)/2; those
/// of 1 and r are 1. The largest relative error is nearly minimal: 1.1·10⁻¹⁷.
const EXP: [f64; 10] = [
    0.500_000_000_000_001_1,
    0.166_666_666_666_664_13,
    0.041_666_666_666_530_044,
    0.008_333_333_333_494_593,
    0.001_388_888_894_366_424_3,
    0.000_198_412_695_063_773_52,
    2.480_149_305_995_927_4e-5,
    2.755_758_647_779_769e-6,
    2.763_026_339_755_995_5e-7,
    2.500_005_286_105_610_3e-8,
];

/// Returns eˣ with an error below 1 unit in the last place.
#[inline]
pub fn exp(x: f64) -> f64 {
    // Powers of 2 beyond this limit are not normal numbers. The condition is false for NaN.
    if x.abs() < 708.0 { exp_in_range(x) } else { libm::exp(x) }
}

/// Returns eˣ for |x| < 708: 2ᵏ·exp(r) with r = x − k·ln 2.
#[inline]
fn exp_in_range(x: f64) -> f64 {
    let shifted = x * std::f64::consts::LOG2_E + TO_INTEGER;
    let k = shifted - TO_INTEGER;
    let r = (x - k * LN_2_HIGH) - k * LN_2_LOW;
    let r2 = r * r;
    let r4 = r2 * r2;
    // Estrin's scheme has short chains of dependent operations.
    let low = (EXP[0] + EXP[1] * r) + (EXP[2] + EXP[3] * r) * r2;
    let high = (EXP[4] + EXP[5] * r) + (EXP[6] + EXP[7] * r) * r2;
    let sum = low + (high + (EXP[8] + EXP[9] * r) * r4) * r4;
    let power = 1.0 + (r + r2 * sum);
    // This adds k to the exponent.
    f64::from_bits(power.to_bits().wrapping_add(shifted.to_bits() << 52))
}

/// π/2 in three parts. Products of the first two parts with an integer below 2²⁰ are exact.
const FRAC_PI_2_PARTS: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// The coefficients of r³, r⁵, …, r¹³ in the approximation of sin r for |r| ≤ π/4, from `k_sin.c`
/// of FreeBSD (copyright 1993 Sun Microsystems, Inc.; permission to use, copy, modify and
/// distribute it is freely granted).
const SIN: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_49,
    -0.000_198_412_698_298_579_5,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// The coefficients of r⁴, r⁶, …, r¹⁴ in the approximation of cos r for |r| ≤ π/4, from `k_cos.c`
/// of FreeBSD, with the same copyright.
const COS: [f64; 6] = [
    0.041_666_666_666_666_6,
    -0.001_388_888_888_887_411,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Returns the sine and the cosine of an angle in radians with errors below 1 ulp.
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    // The integer multiple of π/2 must be below 2²⁰. The condition is false for NaN.
    if x.abs() < 1.6e6 { sin_cos_in_range(x) } else { libm::sincos(x) }
}

/// Returns them for |x| < 1.6·10⁶, reduced by a multiple of π/2 (Cody & Waite).
#[inline]
fn sin_cos_in_range(x: f64) -> (f64, f64) {
    let shifted = x * std::f64::consts::FRAC_2_PI + TO_INTEGER;
    let n = shifted - TO_INTEGER;
    let [first, second, third] = FRAC_PI_2_PARTS;
    // The reduced argument is r + tail.
    let (high, part) = (x - n * first, n * second);
    let middle = high - part;
    let low = n * third - ((high - middle) - part);
    let r = middle - low;
    let tail = (middle - r) - low;

    let z = r * r;
    let w = z * z;
    let v = z * r;
    let sum = (SIN[1] + z * (SIN[2] + z * SIN[3])) + z * w * (SIN[4] + z * SIN[5]);
    let sin = r - ((z * (0.5 * tail - v * sum) - tail) - v * SIN[0]);
    let sum = z * (COS[0] + z * (COS[1] + z * COS[2])) + w * w * (COS[3] + z * (COS[4] + z * COS[5]));
    let half = 0.5 * z;
    let rest = 1.0 - half;
    let cos = rest + (((1.0 - rest) - half) + (z * sum - r * tail));

    let quadrant = shifted.to_bits();
    let (sin, cos) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let signed = |value: f64, negative: u64| f64::from_bits(value.to_bits() ^ (negative << 63));
    (signed(sin, quadrant >> 1 & 1), signed(cos, (quadrant + 1) >> 1 & 1))
}

/// Returns the sine of an angle in radians.
#[inline]
pub fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

/// Returns the cosine of an angle in radians.
#[inline]
pub fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

/// The coefficients of a, a³, …, a¹⁷ in the approximation of arctan a for 0 ≤ a ≤ 1. The largest
/// relative error is nearly minimal: 1.5·10⁻⁸.
const ATAN: [f32; 9] = [
    1.0,
    -0.333_330_72,
    0.199_926_18,
    -0.142_036_4,
    0.106_409_125,
    -0.075_042_486,
    0.042_690_974,
    -0.016_068_293,
    0.002_849_805_6,
];

/// Returns the angle of the finite point (`x`, `y`) from the x axis in radians, from −π to π. The
/// error is below 4·10⁻⁷, less than 2 units in the last place of π.
#[inline]
pub fn atan2_f32(y: f32, x: f32) -> f32 {
    let steep = y.abs() > x.abs();
    let (small, large) = if steep { (x.abs(), y.abs()) } else { (y.abs(), x.abs()) };
    // The limit avoids 0/0.
    let a = small / large.max(f32::MIN_POSITIVE);
    let z = a * a;
    let first_octant = a * ATAN.iter().rev().fold(0.0, |sum, coefficient| sum * z + coefficient);
    let first_quadrant = if steep { std::f32::consts::FRAC_PI_2 - first_octant } else { first_octant };
    let angle = if x.is_sign_negative() { std::f32::consts::PI - first_quadrant } else { first_quadrant };
    angle.copysign(y)
}

/// Returns the Bessel function of the first kind J of an integer order.
pub fn bessel_j(order: i32, x: f64) -> f64 {
    libm::jn(order, x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{Purpose, Seed, Stream};
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Returns the difference of two numbers in units in the last place of the second number.
    fn ulps(found: f64, expected: f64) -> f64 {
        if found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan()) {
            return 0.0;
        }
        (found - expected).abs() / (expected.abs().next_up() - expected.abs())
    }

    fn between(from: f64, to: f64) -> impl Iterator<Item = f64> {
        let mut stream = Stream::new(Seed::new(7), Purpose::Pass, 0, from.to_bits() ^ to.to_bits());
        (0..40_000).map(move |_| from + (to - from) * stream.uniform())
    }

    #[track_caller]
    fn agrees(name: &str, arguments: impl Iterator<Item = f64>, most_ulps: f64, pair: impl Fn(f64) -> [f64; 2]) {
        let mut largest = 0.0_f64;
        for x in arguments {
            let [found, expected] = pair(x);
            let error = ulps(found, expected);
            assert!(error <= most_ulps, "{name}({x:e}) = {found:e}, expected {expected:e}: {error} ulps");
            largest = largest.max(error);
        }
        println!("{name}: {largest} ulps");
    }

    const SPECIAL: [f64; 12] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        5e-324,
        -5e-324,
        1e-310,
        f64::MIN_POSITIVE,
        1e300,
    ];

    #[test]
    fn exp_agrees_with_the_c_library_within_one_ulp() {
        let pair = |x: f64| [exp(x), x.exp()];
        for (from, to) in [(-1.0, 1.0), (-40.0, 0.0), (-708.0, 708.0), (-746.0, -700.0), (700.0, 710.0)] {
            agrees("exp", between(from, to), 1.0, pair);
        }
        // Around the limits between the powers of 2.
        let steps = (-1020..=1020).map(|k| (f64::from(k) + 0.5) * std::f64::consts::LN_2);
        agrees("exp", steps.flat_map(|x| [x.next_down(), x, x.next_up()]), 1.0, pair);
        // Around 0.
        agrees("exp", (1..1000).flat_map(|i| [-0.5, 0.5].map(|base: f64| base.powi(i))), 1.0, pair);
        let ends = [708.0, -708.0, 709.782_712_893_384, -745.133_219_101_941_1];
        agrees("exp", ends.into_iter().flat_map(|x: f64| [x.next_down(), x, x.next_up()]), 1.0, pair);
        agrees("exp", SPECIAL.into_iter(), 1.0, pair);
        // Absorption never amplifies light.
        assert!(between(-1e-15, 0.0).chain(between(-2.0, 0.0)).all(|x| exp(x) <= 1.0));
    }

    #[test]
    fn sin_cos_agrees_with_the_c_library_within_one_ulp() {
        let pairs: [fn(f64) -> [f64; 2]; 2] = [|x| [sin(x), x.sin()], |x| [cos(x), x.cos()]];
        for pair in pairs {
            for to in [1.0, 10.0, 1e3, 1.6e6, 1e9, 1e300] {
                agrees("sin and cos", between(-to, to), 1.0, pair);
            }
            // Near the zeros the relative error must be small, too.
            let near_zeros = (-100_000..100_000).map(|i| f64::from(i) * FRAC_PI_2);
            agrees("sin and cos", near_zeros.flat_map(|x| [x.next_down(), x, x.next_up()]), 1.0, pair);
            let farther = (-100_000..100_000).map(|i| f64::from(i) * 10.0 * FRAC_PI_2);
            agrees("sin and cos", farther, 1.0, pair);
            agrees("sin and cos", (1..1074).map(|i| 0.5_f64.powi(i)), 1.0, pair);
            agrees("sin and cos", SPECIAL.into_iter(), 0.0, pair);
        }
        assert_eq!(sin_cos(1.6e6), (sin(1.6e6), cos(1.6e6)));
        assert!(between(-20.0, 20.0).all(|x| sin(x).abs() <= 1.0 && cos(x).abs() <= 1.0));
    }

    /// The functions and the limits of their arguments. Both libraries promise less than 1 ulp for
    /// most.
    #[test]
    fn other_functions_agree_with_the_c_library() {
        type Case = (&'static str, (f64, f64), fn(f64) -> [f64; 2]);
        let cases: [Case; 19] = [
            ("exp2", (-1080.0, 1030.0), |x| [exp2(x), x.exp2()]),
            ("exp_m1", (-40.0, 10.0), |x| [exp_m1(x), x.exp_m1()]),
            ("exp_m1", (-1e-3, 1e-3), |x| [exp_m1(x), x.exp_m1()]),
            ("ln", (0.0, 3.0), |x| [ln(x), x.ln()]),
            ("ln_1p", (-1.0, 3.0), |x| [ln_1p(x), x.ln_1p()]),
            ("ln_1p", (-1e-3, 1e-3), |x| [ln_1p(x), x.ln_1p()]),
            ("log2", (0.0, 1e6), |x| [log2(x), x.log2()]),
            ("log10", (0.0, 1e6), |x| [log10(x), x.log10()]),
            ("tan", (-7.0, 7.0), |x| [tan(x), x.tan()]),
            ("asin", (-1.0, 1.0), |x| [asin(x), x.asin()]),
            ("acos", (-1.0, 1.0), |x| [acos(x), x.acos()]),
            ("atan", (-10.0, 10.0), |x| [atan(x), x.atan()]),
            ("atan2", (-PI, PI), |x| [atan2(x.sin(), x.cos()), x.sin().atan2(x.cos())]),
            ("sinh", (-5.0, 5.0), |x| [sinh(x), x.sinh()]),
            ("asinh", (-5.0, 5.0), |x| [asinh(x), x.asinh()]),
            ("cbrt", (-1e6, 1e6), |x| [cbrt(x), x.cbrt()]),
            ("hypot", (-9.0, 9.0), |x| [hypot(x, 1.0), x.hypot(1.0)]),
            ("powf", (0.0, 2.0), |x| [powf(x, 0.25), x.powf(0.25)]),
            ("powf", (0.0, 50.0), |x| [powf(x, -2.4), x.powf(-2.4)]),
        ];
        for (name, (from, to), pair) in cases {
            agrees(name, between(from, to), 2.0, pair);
            if name != "atan2" {
                agrees(name, SPECIAL.into_iter(), 2.0, pair);
            }
        }
    }

    #[test]
    fn single_precision_angles_are_within_the_stated_error() {
        let mut largest = 0.0_f64;
        for (radius, turn) in between(-40.0, 40.0).zip(between(-PI, PI)) {
            let (sin, cos) = turn.sin_cos();
            let [x, y] = [cos, sin].map(|side| (radius.exp2() * side) as f32);
            let error = (f64::from(atan2_f32(y, x)) - f64::from(y).atan2(f64::from(x))).abs();
            assert!(error < 4e-7, "{x} {y}: {error}");
            largest = largest.max(error);
        }
        println!("largest error {largest:e}");
        for (y, x) in [(0.0, 1.0), (0.0, -1.0), (-0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 0.0), (-0.0, 0.0)] {
            let (found, expected) = (atan2_f32(y, x), y.atan2(x));
            assert_eq!(found.to_bits(), expected.to_bits(), "{y} {x}");
        }
    }
}
