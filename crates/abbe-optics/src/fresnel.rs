//! Reflectance and refraction at a smooth interface between two media.
//!
//! In the usual form of Fresnel's equations, the amplitude for s polarisation is (n₁cosθ₁ −
//! n₂cosθ₂)/(n₁cosθ₁ + n₂cosθ₂), whose numerator cancels if n₁ ≈ n₂. The functions for dielectrics
//! therefore multiply both numerator and denominator by n₁cosθ₁ + n₂cosθ₂, which gives the
//! numerator (n₁ − n₂)(n₁ + n₂), and treat the equation for p polarisation in the same way.

use abbe_spectra::math::elementary::{asin, atan2, hypot};
use glam::DVec3;

/// Returns n_t²·cos²θ_t = (n_t − n_i)(n_t + n_i) + n_i²·cos²θ_i by Snell's law, negative beyond the
/// critical angle, on which reflectance and refraction therefore agree.
fn squared_transmitted(cos_i: f64, n_i: f64, n_t: f64) -> f64 {
    (n_t - n_i) * (n_t + n_i) + (n_i * cos_i) * (n_i * cos_i)
}

/// Returns the reflectances, for s and p polarisation, of a smooth interface from index `n_i` to
/// index `n_t`, both positive (Born & Wolf, *Principles of Optics*, §1.5.2). The sign of the cosine
/// of incidence `cos_i` is ignored. The reflectances lie in \[0, 1\]: both are 1 beyond the
/// critical angle, and 0 at every angle if the indices are equal.
pub fn dielectric_sp(cos_i: f64, n_i: f64, n_t: f64) -> (f64, f64) {
    let c = cos_i.abs().min(1.0);
    let step = (n_t - n_i) * (n_t + n_i);
    if step == 0.0 {
        return (0.0, 0.0);
    }
    let squared = squared_transmitted(c, n_i, n_t);
    if squared < 0.0 {
        return (1.0, 1.0);
    }
    let q = squared.sqrt();
    let s = step / ((n_i * c + q) * (n_i * c + q));
    let below = n_t * n_t * c + n_i * q;
    let p = step * (c * c * (n_t * n_t + n_i * n_i) - n_i * n_i) / (below * below);
    ((s * s).min(1.0), (p * p).min(1.0))
}

/// Returns the mean of [`dielectric_sp`], for unpolarised light. The transmittance is the rest.
pub fn dielectric(cos_i: f64, n_i: f64, n_t: f64) -> f64 {
    let (s, p) = dielectric_sp(cos_i, n_i, n_t);
    0.5 * (s + p)
}

/// Returns the cosine of refraction by Snell's law, 0 beyond the critical angle, for |`cos_i`|.
pub fn cos_transmitted(cos_i: f64, n_i: f64, n_t: f64) -> f64 {
    (squared_transmitted(cos_i, n_i, n_t).max(0.0).sqrt() / n_t).min(1.0)
}

/// Returns the reflectances, in \[0, 1\], for s and p polarisation of a smooth metal of complex
/// index `n` + i·`k` in a medium of the positive index `n_outside` (Born & Wolf, *Principles of
/// Optics*, §14.2). The sign of `cos_i` is ignored, as in [`dielectric_sp`].
pub fn conductor_sp(cos_i: f64, n: f64, k: f64, n_outside: f64) -> (f64, f64) {
    let c = cos_i.abs().min(1.0);
    let (eta, kappa) = (n / n_outside, k / n_outside);
    let sin2 = (1.0 - c) * (1.0 + c);
    if eta == 1.0 && kappa == 0.0 {
        return (0.0, 0.0);
    }
    if c == 0.0 {
        return (1.0, 1.0);
    }
    // (a + ib)² = (η + iκ)² − sin²θ. To avoid cancellation, a square root gives the larger of |a|
    // and |b|, and the other follows from a·b = ηκ.
    let real = (eta - 1.0) * (eta + 1.0) + c * c - kappa * kappa;
    let imaginary = eta * kappa;
    let modulus = hypot(real, 2.0 * imaginary);
    let larger = (0.5 * (modulus + real.abs())).sqrt();
    let a = if real >= 0.0 || larger == 0.0 { larger } else { imaginary / larger };
    let s = (modulus + c * c - 2.0 * a * c) / (modulus + c * c + 2.0 * a * c);
    let (even, odd) = (modulus * c * c + sin2 * sin2, 2.0 * a * c * sin2);
    let ratio = if even + odd > 0.0 { (even - odd) / (even + odd) } else { 1.0 };
    let s = s.clamp(0.0, 1.0);
    (s, (s * ratio).clamp(0.0, 1.0))
}

/// Returns the reflectance of a smooth metal for unpolarised light: the mean of [`conductor_sp`].
pub fn conductor(cos_i: f64, n: f64, k: f64, n_outside: f64) -> f64 {
    let (s, p) = conductor_sp(cos_i, n, k, n_outside);
    0.5 * (s + p)
}

/// Returns the refracted direction by Snell's law, or `None` under total reflection.
///
/// The unit vector `w` points away from the surface into the medium of index `n_i`, and the result
/// into the medium of index `n_t`; its length differs from 1 by at most a few 1e-16. The unit
/// vector `normal` may point to either side. If the indices are equal, the result is exactly −`w`.
pub fn refract(w: DVec3, normal: DVec3, n_i: f64, n_t: f64) -> Option<DVec3> {
    if n_i == n_t {
        return Some(-w);
    }
    let projection = w.dot(normal);
    let (c, normal) = if projection >= 0.0 { (projection, normal) } else { (-projection, -normal) };
    Some((normal * refraction_along_normal(c, n_i, n_t)? - w * n_i).normalize())
}

/// Returns the number a of Snell's law n_t·t = a·normal − n_i·w, where t is the refracted direction
/// and `cos_i` ≥ 0 that of `w`, or `None` under total reflection.
pub(crate) fn refraction_along_normal(cos_i: f64, n_i: f64, n_t: f64) -> Option<f64> {
    let squared = squared_transmitted(cos_i, n_i, n_t);
    if squared < 0.0 {
        return None;
    }
    // The difference n_i·cosθ_i − n_t·cosθ_t is written as a quotient to avoid cancellation.
    Some((n_i - n_t) * (n_i + n_t) / (n_i * cos_i + squared.sqrt()))
}

/// Returns the mirror direction for unit vectors. `w` and the result point away from the surface.
pub fn reflect(w: DVec3, normal: DVec3) -> DVec3 {
    normal * (2.0 * w.dot(normal)) - w
}

/// Returns the critical angle of total reflection in degrees, or `None` if `n_i` ≤ `n_t`.
pub fn critical_angle_deg(n_i: f64, n_t: f64) -> Option<f64> {
    (n_i > n_t).then(|| asin(n_t / n_i).to_degrees())
}

/// Returns Brewster's angle in degrees, at which the reflectance for p polarisation is 0.
pub fn brewster_angle_deg(n_i: f64, n_t: f64) -> f64 {
    atan2(n_t, n_i).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From grazing to normal incidence.
    fn cosines() -> impl Iterator<Item = f64> {
        (0..=1000).map(|i| (f64::from(i) / 1000.0).powi(3)).chain([1e-300, 1e-16, 1e-8])
    }

    #[test]
    fn reflectance_lies_between_0_and_1_at_any_angle_and_index() {
        for n_i in [1.0, 1.0 + 1e-15, 1.33, 1.5, 2.4] {
            for n_t in [1.0, 1.0 + 1e-15, 1.33, 1.5, 1.5 + 1e-9, 2.4] {
                for cos in cosines() {
                    let r = dielectric(cos, n_i, n_t);
                    assert!((0.0..=1.0).contains(&r), "R = {r} at cosine {cos} from {n_i} to {n_t}");
                    let metal = conductor(cos, n_t, 0.3, n_i);
                    assert!((0.0..=1.0).contains(&metal), "metal: R = {metal} at cosine {cos}");
                }
            }
        }
    }

    #[test]
    fn equal_indices_reflect_nothing_and_grazing_light_is_reflected() {
        for cos in cosines() {
            assert_eq!(dielectric(cos, 1.5, 1.5), 0.0);
        }
        for (n_i, n_t) in [(1.0, 1.5), (1.5, 1.0), (1.0, 1.0 + 1e-12)] {
            assert!((dielectric(0.0, n_i, n_t) - 1.0).abs() < 1e-15);
        }
        assert_eq!(conductor(0.0, 0.2, 3.0, 1.0), 1.0);
    }

    #[test]
    fn nearly_equal_indices_keep_all_digits() {
        let step = 2.0_f64.powi(-40);
        // At normal incidence R = (δ/(2 + δ))². The textbook quotient has a relative error of 1e-4.
        let exact = (step / (2.0 + step)).powi(2);
        assert!((dielectric(1.0, 1.0, 1.0 + step) / exact - 1.0).abs() < 1e-15);
    }

    /// Within 20 ulp of the critical cosine, R is finite, and 1 if `refract` gives `None`.
    #[test]
    fn reflection_and_refraction_agree_at_the_critical_angle() {
        for (n_i, n_t) in [(1.5, 1.0), (2.4175, 1.333), (1.0 + 1e-9, 1.0)] {
            let critical = f64::sqrt((n_i - n_t) * (n_i + n_t)) / n_i;
            let mut cos = critical;
            for _ in 0..20 {
                cos = cos.next_down();
            }
            for _ in 0..40 {
                let r = dielectric(cos, n_i, n_t);
                let w = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                assert!((0.99..=1.0).contains(&r), "R = {r} at cosine {cos}");
                match refract(w, DVec3::Z, n_i, n_t) {
                    None => assert_eq!(r, 1.0),
                    Some(t) => assert!(t.is_finite() && t.z <= 0.0),
                }
                cos = cos.next_up();
            }
            assert_eq!(dielectric(critical * (1.0 - 1e-12), n_i, n_t), 1.0);
            assert!(dielectric(critical * (1.0 + 1e-9), n_i, n_t) < 1.0);
        }
    }

    #[test]
    fn s_and_p_match_the_textbook_formulas_where_stable() {
        for (n_i, n_t) in [(1.0, 1.5), (1.5, 1.0), (1.33, 2.4)] {
            for degrees in [5.0_f64, 20.0, 30.0, 40.0] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let cos_t = (1.0 - (sin * n_i / n_t).powi(2)).sqrt();
                let s = ((n_i * cos - n_t * cos_t) / (n_i * cos + n_t * cos_t)).powi(2);
                let p = ((n_t * cos - n_i * cos_t) / (n_t * cos + n_i * cos_t)).powi(2);
                let (got_s, got_p) = dielectric_sp(cos, n_i, n_t);
                assert!((got_s - s).abs() < 1e-14 && (got_p - p).abs() < 1e-14, "{n_i} to {n_t} at {degrees}°");
            }
        }
    }

    #[test]
    fn p_polarised_light_is_not_reflected_at_brewster_s_angle() {
        let angle = brewster_angle_deg(1.0, 1.5).to_radians();
        assert!(dielectric_sp(angle.cos(), 1.0, 1.5).1 < 1e-30);
    }

    #[test]
    fn a_metal_that_does_not_absorb_is_a_dielectric() {
        for (n_i, n_t) in [(1.0, 1.5), (1.5, 1.0), (1.2, 1.2)] {
            for cos in cosines() {
                let (a, b) = (conductor(cos, n_t, 0.0, n_i), dielectric(cos, n_i, n_t));
                // The modulus cancels near the critical angle, where R has an infinite slope.
                assert!((a - b).abs() < 1e-6, "{a} and {b} at cosine {cos} from {n_i} to {n_t}");
            }
        }
    }

    #[test]
    fn refraction_obeys_snell_to_the_last_digits_in_a_unit_vector() {
        let normal = DVec3::new(0.36, 0.48, 0.8);
        let tangent = normal.any_orthonormal_vector();
        for (n_i, n_t) in [(1.0, 1.5), (1.5, 1.0), (1.0, 1.0 + 1e-10), (2.4, 1.33)] {
            for i in 1..200 {
                let angle = f64::from(i) * 0.005 * std::f64::consts::PI;
                let w = (normal * angle.cos() + tangent * angle.sin()).normalize();
                let Some(t) = refract(w, normal, n_i, n_t) else {
                    assert!(n_i * angle.sin() > n_t);
                    continue;
                };
                assert!((t.length() - 1.0).abs() < 1e-15);
                assert!((n_i * w.dot(tangent) + n_t * t.dot(tangent)).abs() < 1e-15, "{n_i} to {n_t} at {angle}");
                assert!(w.dot(normal) * t.dot(normal) <= 0.0);
                assert_eq!(refract(w, -normal, n_i, n_t), Some(t));
            }
        }
    }

    #[test]
    fn refraction_is_its_own_inverse() {
        let w = DVec3::new(0.6, 0.0, 0.8);
        let t = refract(w, DVec3::Z, 1.0, 1.7).unwrap();
        assert!((refract(t, DVec3::Z, 1.7, 1.0).unwrap() - w).length() < 1e-15);
        assert_eq!(refract(w, DVec3::Z, 1.5, 1.5), Some(-w));
        assert_eq!(reflect(w, DVec3::Z), DVec3::new(-0.6, 0.0, 0.8));
    }
}
