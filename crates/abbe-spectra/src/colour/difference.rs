//! Colour differences: between L*, a*, b* values, and between lights.

use super::coordinates::{lab, xy};
use super::space::RgbSpace;
use super::tristimulus::Xyz;
use crate::math::elementary::{atan2, cos, exp, hypot, sin};

/// Returns ΔE*ab (CIE 1976), the Euclidean distance of two L*, a*, b* values.
pub fn delta_e_76(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Returns ΔE00 (CIEDE2000) with kL = kC = kH = 1 (CIE 142-2001), by G. Sharma, W. Wu and E. Dalal,
/// "The CIEDE2000 color-difference formula", Color Research and Application 30 (2005).
pub fn delta_e_2000(a: [f64; 3], b: [f64; 3]) -> f64 {
    let mean_chroma = 0.5 * (hypot(a[1], a[2]) + hypot(b[1], b[2]));
    let stretch = 1.5 - 0.5 * chroma_fraction(mean_chroma);
    let (a1, b1) = (a[1] * stretch, b[1] * stretch);
    let (chroma_a, chroma_b) = (hypot(a1, a[2]), hypot(b1, b[2]));
    let (hue_a, hue_b) = (hue_degrees(a1, a[2]), hue_degrees(b1, b[2]));

    let achromatic = chroma_a * chroma_b == 0.0;
    let hue_step = if achromatic { 0.0 } else { wrapped(hue_b - hue_a) };
    let delta_lightness = b[0] - a[0];
    let delta_chroma = chroma_b - chroma_a;
    let delta_hue = 2.0 * (chroma_a * chroma_b).sqrt() * sin((0.5 * hue_step).to_radians());

    let lightness = 0.5 * (a[0] + b[0]);
    let chroma = 0.5 * (chroma_a + chroma_b);
    let hue = if achromatic { hue_a + hue_b } else { mean_hue_degrees(hue_a, hue_b) };
    let cos = |degrees: f64| cos(degrees.to_radians());
    let t = 1.0 - 0.17 * cos(hue - 30.0) + 0.24 * cos(2.0 * hue) + 0.32 * cos(3.0 * hue + 6.0)
        - 0.20 * cos(4.0 * hue - 63.0);
    let offset = (lightness - 50.0).powi(2);
    let lightness_part = delta_lightness / (1.0 + 0.015 * offset / (20.0 + offset).sqrt());
    let chroma_part = delta_chroma / (1.0 + 0.045 * chroma);
    let hue_part = delta_hue / (1.0 + 0.015 * chroma * t);
    let rotation_degrees = 30.0 * exp(-((hue - 275.0) / 25.0).powi(2));
    let rotation = -2.0 * chroma_fraction(chroma) * sin((2.0 * rotation_degrees).to_radians());
    // For equal colours, rounding may give a value slightly below 0.
    let square = lightness_part.powi(2) + chroma_part.powi(2) + hue_part.powi(2) + rotation * chroma_part * hue_part;
    square.max(0.0).sqrt()
}

/// The colour difference of two lights seen side by side.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LightDifference {
    /// The distance of the chromaticities x, y.
    pub delta_xy: f64,
    /// ΔE2000 for an observer adapted to daylight: the white point is D65, because the light itself
    /// would exaggerate differences in b* for lights with almost no Z, such as sodium light.
    pub delta_e_2000: f64,
}

/// Returns the colour difference of two lights with Y > 0, whose XYZ must have the same scale.
pub fn light_difference(light: Xyz, other: Xyz) -> LightDifference {
    let seen = |xyz: Xyz| lab(xyz.map(|value| value / light[1]), RgbSpace::Srgb.white());
    let (from, to) = (xy(light), xy(other));
    LightDifference {
        delta_xy: hypot(to[0] - from[0], to[1] - from[1]),
        delta_e_2000: delta_e_2000(seen(light), seen(other)),
    }
}

/// Returns √(C⁷ / (C⁷ + 25⁷)).
fn chroma_fraction(chroma: f64) -> f64 {
    let power = chroma.powi(7);
    (power / (power + 25.0_f64.powi(7))).sqrt()
}

/// Returns the hue angle from 0 to 360 degrees, or 0 for grey.
fn hue_degrees(a: f64, b: f64) -> f64 {
    if a == 0.0 && b == 0.0 { 0.0 } else { atan2(b, a).to_degrees().rem_euclid(360.0) }
}

fn wrapped(degrees: f64) -> f64 {
    if degrees > 180.0 {
        degrees - 360.0
    } else if degrees < -180.0 {
        degrees + 360.0
    } else {
        degrees
    }
}

fn mean_hue_degrees(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if (a - b).abs() <= 180.0 {
        0.5 * sum
    } else if sum < 360.0 {
        0.5 * (sum + 360.0)
    } else {
        0.5 * (sum - 360.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn similar_lights_without_blue_have_a_small_difference() {
        // Low-pressure sodium and a metameric mix of 550 nm and 620 nm.
        let found = light_difference([1.329_710, 1.0, 0.001_484], [1.329_725, 0.999_965, 0.004_689]);
        assert!((found.delta_xy - 0.000_978).abs() < 1e-6 && (found.delta_e_2000 - 0.7662).abs() < 1e-3, "{found:?}");
        let itself = light_difference([2.0, 3.0, 4.0], [2.0, 3.0, 4.0]);
        assert_eq!((itself.delta_xy, itself.delta_e_2000), (0.0, 0.0));
    }

    #[test]
    fn ciede2000_matches_the_published_test_pairs() {
        // Sharma, Wu and Dalal 2005, table 1 (a selection that covers every branch).
        let pairs = [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, 3.1571, -77.2803], [50.0, 0.0, -82.7485], 2.8615),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
            ([50.0, -0.001, 2.49], [50.0, 0.0009, -2.49], 4.8045),
            ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [61.0, -5.0, 29.0], 22.8977),
            ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.9030),
            ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
            ([63.0109, -31.0961, -5.8663], [62.8187, -29.7946, -4.0864], 1.2630),
            ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
            ([6.7747, -0.2908, -2.4247], [5.8714, -0.0985, -2.2286], 0.6377),
            ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
        ];
        for (a, b, known) in pairs {
            assert!((delta_e_2000(a, b) - known).abs() < 5e-5, "{a:?} {b:?}: {}", delta_e_2000(a, b));
            assert!((delta_e_2000(b, a) - known).abs() < 5e-5, "{b:?} {a:?}");
        }
        assert_eq!(delta_e_2000([50.0, 3.0, -4.0], [50.0, 3.0, -4.0]), 0.0);
        assert_eq!(delta_e_76([50.0, 3.0, -4.0], [50.0, 0.0, 0.0]), 5.0);
    }
}
