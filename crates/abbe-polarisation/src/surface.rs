//! Smooth surfaces: dielectrics, metals and stacks of thin films.

use super::diattenuating_retarder::DiattenuatingRetarder;
use abbe_optics::thin_film::{PolarisedResponse, StackResponse, response};
use abbe_spectra::math::complex::Complex;
use abbe_spectra::math::elementary::{atan, atan2};

/// The Mueller matrices of a smooth surface for power. Radiance has the further factor (n_t/n_i)²
/// in transmission. The axis s is perpendicular to the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceMatrices {
    /// Reflection.
    pub reflected: DiattenuatingRetarder,
    /// Transmission.
    pub transmitted: DiattenuatingRetarder,
}

impl SurfaceMatrices {
    /// Returns the matrices of an interface from index `n_i` to index `n_t`, both positive, with
    /// the phases of total reflection. The sign of the cosine of incidence is ignored.
    ///
    /// As in [`abbe_optics::fresnel`], no difference of similar numbers occurs.
    #[inline]
    pub fn dielectric(cos_i: f64, n_i: f64, n_t: f64) -> Self {
        let c = cos_i.abs().min(1.0);
        let step = (n_t - n_i) * (n_t + n_i);
        if step == 0.0 {
            return Self { reflected: DiattenuatingRetarder::OPAQUE, transmitted: DiattenuatingRetarder::IDENTITY };
        }
        let squared = step + (n_i * c) * (n_i * c);
        if squared < 0.0 {
            let outside = (-squared).sqrt();
            let quotient = |z: Complex| z.conjugate() / z;
            let s = quotient(Complex::new(n_i * c, outside));
            let p = quotient(Complex::new(n_t * n_t * c, n_i * outside));
            let reflected = DiattenuatingRetarder { s: 1.0, p: 1.0, cross: s * p.conjugate() };
            return Self { reflected, transmitted: DiattenuatingRetarder::OPAQUE };
        }
        let q = squared.sqrt();
        let (sum_s, sum_p) = (n_i * c + q, n_t * n_t * c + n_i * q);
        let s = -step / (sum_s * sum_s);
        let p = step * (c * c * (n_t * n_t + n_i * n_i) - n_i * n_i) / (sum_p * sum_p);
        let reflected = DiattenuatingRetarder { s: (s * s).min(1.0), p: (p * p).min(1.0), cross: (s * p).into() };
        let cross = 4.0 * n_i * n_t * c * q / (sum_s * sum_p);
        let transmitted = DiattenuatingRetarder { s: 1.0 - reflected.s, p: 1.0 - reflected.p, cross: cross.into() };
        Self { reflected, transmitted }
    }

    /// Returns the matrices of a metal of index `n` + i`k` in a medium of index `n_outside`. The
    /// metal absorbs what enters it, so the transmitted light is that just below the surface.
    pub fn conductor(cos_i: f64, n: f64, k: f64, n_outside: f64) -> Self {
        // A bare surface does not depend on the wavelength.
        const ANY_NM: f64 = 550.0;
        Self::of_films(&response(cos_i, n_outside, std::iter::empty(), Complex::new(n, k), ANY_NM))
    }

    /// Returns the matrices of a surface with films.
    pub fn of_films(StackResponse { s, p }: &StackResponse) -> Self {
        let transmitted = DiattenuatingRetarder {
            s: s.transmittance,
            p: p.transmittance,
            cross: unit(s.transmitted * p.transmitted.conjugate()) * (s.transmittance * p.transmittance).sqrt(),
        };
        Self { reflected: DiattenuatingRetarder::from_amplitudes(s.reflected, p.reflected), transmitted }
    }
}

/// Returns the number of the same argument with the absolute value 1, or 0 for 0.
fn unit(z: Complex) -> Complex {
    let length = z.norm_squared().sqrt();
    if length > 0.0 { z * (1.0 / length) } else { z }
}

/// The ellipsometric angles of a reflection, in degrees: r_p/r_s = tan Ψ·exp(iΔ) for fields that
/// vary as exp(+iωt), with r_p = −r_s at normal incidence (Azzam & Bashara, *Ellipsometry and
/// Polarized Light*).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EllipsometricAngles {
    /// Ψ, from 0 to 90.
    pub psi_deg: f64,
    /// Δ, from 0 to below 360.
    pub delta_deg: f64,
}

impl EllipsometricAngles {
    /// Returns the angles of a surface. Ψ is 90 if only p is reflected, and Δ 0 if s or p is not.
    pub fn of(s: &PolarisedResponse, p: &PolarisedResponse) -> Self {
        let (s, p) = (s.reflected, p.reflected);
        let psi_deg = atan2(p.norm_squared().sqrt(), s.norm_squared().sqrt()).to_degrees();
        // Abbe's fields vary as exp(−iωt), which conjugates all amplitudes.
        let delta_deg = argument_deg(s * p.conjugate());
        Self { psi_deg, delta_deg: if delta_deg < 0.0 { delta_deg + 360.0 } else { delta_deg } }
    }
}

/// Returns the argument of a complex number in degrees, above −180 and up to 180, and 0 for 0.
pub fn argument_deg(z: Complex) -> f64 {
    // A negative real number has the argument 180, also with the imaginary part −0.
    if z.im == 0.0 && z.re < 0.0 { 180.0 } else { atan2(z.im, z.re).to_degrees() }
}

/// Returns the largest phase difference δ of s and p in degrees that one total reflection gives,
/// and its angle of incidence in degrees, from index `n_i` to the smaller index `n_t` (Born & Wolf,
/// §1.5.4). Returns `None` without total reflection.
pub fn largest_total_reflection_delta_deg(n_i: f64, n_t: f64) -> Option<(f64, f64)> {
    let n = n_t / n_i;
    (n < 1.0).then(|| {
        let delta = 2.0 * atan((1.0 - n * n) / (2.0 * n));
        let sin2 = 2.0 * n * n / (1.0 + n * n);
        (delta.to_degrees(), atan2(sin2.sqrt(), (1.0 - sin2).sqrt()).to_degrees())
    })
}

/// Returns the two angles of incidence in degrees at which one total reflection gives the phase
/// difference δ, which is below 180. Returns `None` if δ exceeds the largest possible one.
pub fn total_reflection_angles_deg(n_i: f64, n_t: f64, delta_deg: f64) -> Option<[f64; 2]> {
    // tan(δ/2) = cosθ·√(sin²θ − n²)/sin²θ is a quadratic equation of sin²θ.
    let n2 = (n_t / n_i) * (n_t / n_i);
    let t = abbe_spectra::math::elementary::tan(0.5 * delta_deg.to_radians());
    let (a, b) = (1.0 + t * t, 1.0 + n2);
    let discriminant = b * b - 4.0 * a * n2;
    (n2 < 1.0 && discriminant >= 0.0).then(|| {
        let angle = |sin2: f64| atan2(sin2.sqrt(), (1.0 - sin2).max(0.0).sqrt()).to_degrees();
        let larger = (b + discriminant.sqrt()) / (2.0 * a);
        [angle(n2 / (a * larger)), angle(larger)]
    })
}
