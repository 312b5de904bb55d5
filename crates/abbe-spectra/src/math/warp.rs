//! Mappings of the unit square onto disks, spheres and cones, each with its pdf.

use crate::math::elementary::{asin, sin, sin_cos};
use crate::math::rotation::unit_vector;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Maps the unit square onto the unit disk with pdf 1/π and little distortion (Shirley & Chiu
/// 1997).
pub fn disk(u: [f64; 2]) -> DVec2 {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b)) };
    radius * unit_vector(angle)
}

/// Maps the unit square uniformly onto a regular polygon of circumradius 1 with a corner at (1, 0).
pub fn regular_polygon(corners: u32, u: [f64; 2]) -> DVec2 {
    let place = u[0] * f64::from(corners);
    let (triangle, across) = (place.floor(), place.fract());
    let corner = |number: f64| unit_vector(number / f64::from(corners) * TAU);
    // The square root compensates for the width of a triangle away from the centre.
    (corner(triangle) * (1.0 - across) + corner(triangle + 1.0) * across) * u[1].sqrt()
}

/// Samples a direction around +z with the pdf cos θ / π per steradian (Malley's method).
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let d = disk(u);
    d.extend((1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Samples a direction uniformly over the whole sphere (pdf 1/(4π) per steradian).
pub fn sphere(u: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u[0];
    let (sin, cos) = sin_cos(TAU * u[1]);
    let r = (2.0 * u[0].sqrt() * (1.0 - u[0]).sqrt()).min(1.0);
    DVec3::new(r * cos, r * sin, z)
}

/// Returns 1 − cos θ for the half-angle θ of a cone in radians, accurate even for narrow cones.
pub fn one_minus_cos(half_angle: f64) -> f64 {
    let s = sin(0.5 * half_angle);
    2.0 * s * s
}

/// Returns the half-angle of a cone in radians, as the inverse of [`one_minus_cos`].
pub fn half_angle(one_minus_cos: f64) -> f64 {
    2.0 * asin((0.5 * one_minus_cos).sqrt().min(1.0))
}

/// Returns the solid angle, in steradians, of a cone with a half-angle in radians.
pub fn cone_solid_angle(half_angle: f64) -> f64 {
    TAU * one_minus_cos(half_angle)
}

/// Samples a direction uniformly over a cone around +z, with the pdf 1/(2π·`one_minus_cos`). The
/// argument is 1 − cos θ of the half-angle θ, so even very narrow cones are accurate.
pub fn cone(one_minus_cos: f64, u: [f64; 2]) -> DVec3 {
    spherical_direction(u[0] * one_minus_cos, u[1])
}

/// Returns the direction at the angle θ from +z and at the azimuth 2π·`u`. The argument is 1 − cos
/// θ, so even very small angles are accurate.
pub fn spherical_direction(one_minus_cos: f64, u: f64) -> DVec3 {
    let (sin, cos) = sin_cos(TAU * u);
    let r = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    DVec3::new(r * cos, r * sin, 1.0 - one_minus_cos)
}

/// Returns the pdf of [`cosine_hemisphere`] per steradian.
pub fn cosine_hemisphere_pdf(cos_theta: f64) -> f64 {
    cos_theta.max(0.0) / PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sobol::Sobol;

    fn mean(n: u32, f: impl Fn([f64; 2]) -> f64) -> f64 {
        let sobol = Sobol::new(3);
        (0..n).map(|i| f([sobol.at(i, 0), sobol.at(i, 1)])).sum::<f64>() / f64::from(n)
    }

    #[test]
    fn moments_match_the_pdfs() {
        let n = 1 << 16;
        assert!((mean(n, |u| disk(u).length_squared()) - 0.5).abs() < 1e-4);
        assert!((mean(n, |u| cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < 1e-4);
        assert!((mean(n, |u| sphere(u).z * sphere(u).z) - 1.0 / 3.0).abs() < 1e-4);
        let omc = one_minus_cos(0.5);
        assert!((mean(n, |u| cone(omc, u).z) - (1.0 - omc / 2.0)).abs() < 1e-6);
    }

    #[test]
    fn directions_are_unit_at_the_ends_of_u() {
        let ends = [0.0, 0.5, crate::math::random::ONE_MINUS_ULP];
        for a in ends {
            for b in ends {
                for d in [cosine_hemisphere([a, b]), sphere([a, b]), cone(1e-12, [a, b])] {
                    assert!((d.length() - 1.0).abs() < 1e-12, "{a} {b} {d}");
                }
            }
        }
    }
}
