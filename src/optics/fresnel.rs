//! Reflectance and refraction at a smooth interface between two media.
//!
//! The printed form of Fresnel's equations, (n₁cosθ₁ − n₂cosθ₂)/(n₁cosθ₁ + n₂cosθ₂), loses all its digits where the two
//! products are nearly equal, which is where n₁ ≈ n₂. Multiplied by its own denominator the numerator becomes
//! n₁² − n₂², which a product of sum and difference gives exactly; everything here is built on that.

use glam::DVec3;

/// n_t²·cos²θ_t, from Snell's law without an angle: (n_t − n_i)(n_t + n_i) + n_i²·cos²θ_i. Negative beyond the critical
/// angle. Reflectance and refraction both ask this one function, so that they agree on where total reflection begins.
fn squared_transmitted(cos_i: f64, n_i: f64, n_t: f64) -> f64 {
    (n_t - n_i) * (n_t + n_i) + (n_i * cos_i) * (n_i * cos_i)
}

/// Reflectances for s and p polarisation, each in \[0, 1\], of a smooth interface from index `n_i` to index `n_t`, both > 0.
///
/// `cos_i` is the cosine of the angle of incidence; its sign does not matter. Beyond the critical angle both are 1;
/// between equal indices both are 0, at any angle. (Born & Wolf, Principles of Optics, §1.5.2.)
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

/// Reflectance in \[0, 1\] for unpolarised light: the mean of [`dielectric_sp`]. What is not reflected is transmitted,
/// T = 1 − R.
pub fn dielectric(cos_i: f64, n_i: f64, n_t: f64) -> f64 {
    let (s, p) = dielectric_sp(cos_i, n_i, n_t);
    0.5 * (s + p)
}

/// Reflectances for s and p polarisation, each in \[0, 1\], of a smooth metal of complex index `n` + i·`k` seen from a medium of
/// index `n_outside` > 0; `cos_i` as in [`dielectric_sp`]. (Born & Wolf, §14.2.)
pub fn conductor_sp(cos_i: f64, n: f64, k: f64, n_outside: f64) -> (f64, f64) {
    let c = cos_i.abs().min(1.0);
    let (eta, kappa) = (n / n_outside, k / n_outside);
    let sin2 = (1.0 - c) * (1.0 + c);
    // (a + ib)² = (η + iκ)² − sin²θ. Take the larger of a, b by the square root, the other from a·b = ηκ.
    let real = (eta - kappa) * (eta + kappa) - sin2;
    let imaginary = eta * kappa;
    let modulus = real.hypot(2.0 * imaginary);
    if c == 0.0 {
        return if modulus == 0.0 { (0.0, 0.0) } else { (1.0, 1.0) };
    }
    let larger = (0.5 * (modulus + real.abs())).sqrt();
    let a = if real >= 0.0 || larger == 0.0 { larger } else { imaginary / larger };
    let s = (modulus + c * c - 2.0 * a * c) / (modulus + c * c + 2.0 * a * c);
    let (even, odd) = (modulus * c * c + sin2 * sin2, 2.0 * a * c * sin2);
    let ratio = if even + odd > 0.0 { (even - odd) / (even + odd) } else { 1.0 };
    let s = s.clamp(0.0, 1.0);
    (s, (s * ratio).clamp(0.0, 1.0))
}

/// Reflectance in \[0, 1\] for unpolarised light of a smooth metal: the mean of [`conductor_sp`].
pub fn conductor(cos_i: f64, n: f64, k: f64, n_outside: f64) -> f64 {
    let (s, p) = conductor_sp(cos_i, n, k, n_outside);
    0.5 * (s + p)
}

/// The refracted direction, by Snell's law, or `None` under total reflection.
///
/// `w` is a unit vector that points away from the surface into the medium of index `n_here`; the result points away from it
/// on the other side, into the medium of index `n_there`, and is of unit length to a few 1e-16. `normal` is a unit vector;
/// either of its two signs will do. Between equal indices the result is exactly −`w`.
pub fn refract(w: DVec3, normal: DVec3, n_here: f64, n_there: f64) -> Option<DVec3> {
    if n_here == n_there {
        return Some(-w);
    }
    let projection = w.dot(normal);
    let (c, normal) = if projection >= 0.0 { (projection, normal) } else { (-projection, -normal) };
    let squared = squared_transmitted(c, n_here, n_there);
    if squared < 0.0 {
        return None;
    }
    // t = −(n_h/n_t)·w + ((n_h·c − n_t·cosθ_t)/n_t)·normal, the difference again as a quotient.
    let q = squared.sqrt();
    let along = (n_here - n_there) * (n_here + n_there) / (n_here * c + q);
    Some((normal * along - w * n_here).normalize())
}

/// The mirrored direction: `w` and the result are unit vectors that point away from the surface, `normal` is a unit vector.
pub fn reflect(w: DVec3, normal: DVec3) -> DVec3 {
    normal * (2.0 * w.dot(normal)) - w
}

/// The angle of incidence, in degrees, beyond which all light is reflected; `None` where `n_i` ≤ `n_t`.
pub fn critical_angle_deg(n_i: f64, n_t: f64) -> Option<f64> {
    (n_i > n_t).then(|| (n_t / n_i).asin().to_degrees())
}

/// The angle of incidence, in degrees, at which p-polarised light is not reflected at all.
pub fn brewster_angle_deg(n_i: f64, n_t: f64) -> f64 {
    n_t.atan2(n_i).to_degrees()
}
