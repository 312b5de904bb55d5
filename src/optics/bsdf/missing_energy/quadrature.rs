//! The quadrature that computed the table of the missing energy.

use super::FacetKind;
use crate::optics::bsdf::albedo::gauss_legendre;
use crate::optics::fresnel;
use crate::optics::microfacet::Ggx;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Number of quadrature points in each smooth part of a radius of the disk of visible normals.
const RADIAL_POINTS: usize = 16;

/// Number of quadrature points around half of the disk of visible normals.
const AZIMUTHS: usize = 192;

/// Computes the mean over the directions of the energy that single scattering transmits.
pub(super) fn mean_transmitted(facets: &Ggx, kind: FacetKind) -> f64 {
    // With μ = t², the mean ∫ 2μ·T(μ) dμ is ∫ 4t³·T(t²) dt.
    let transmitted = |t: f64| missing_and_transmitted(facets, kind, t * t).1;
    gauss_legendre(32).into_iter().map(|(t, weight)| weight * 4.0 * t.powi(3) * transmitted(t)).sum()
}

/// Computes l(μ), and the fraction of the light that single scattering transmits.
///
/// The integral extends over the visible normals. `sample_visible` samples them from points of a
/// disk. The integrand is symmetric about the plane of incidence, so the integral over half of the
/// disk suffices. Along a radius, the integrand is smooth between the normals at which a direction
/// crosses the surface or total reflection begins. The substitution φ = a + (b − a)·sin²ψ removes
/// the square roots at these normals, and at the edge of the disk.
pub(super) fn missing_and_transmitted(facets: &Ggx, kind: FacetKind, cos: f64) -> (f64, f64) {
    let rule = gauss_legendre(RADIAL_POINTS);
    let wo = DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
    let shadowed = |upwards: f64| if upwards > 0.0 { facets.shadowed_fraction(cos, upwards) } else { 1.0 };
    let refract = |m: DVec3| match kind {
        FacetKind::Mirror => None,
        FacetKind::Dielectric(index) => fresnel::refract(wo, m, 1.0, index),
    };
    let (mut missing, mut transmitted) = (0.0, 0.0);
    for j in 0..AZIMUTHS {
        let v = (0.5 * (j as f64 + 0.5) / AZIMUTHS as f64 - 0.25).rem_euclid(1.0);
        let facet = |phi: f64| facets.sample_visible(wo, phi.sin().powi(2), v);
        let directions = |phi: f64| {
            let m = facet(phi);
            (fresnel::reflect(wo, m).z > 0.0, refract(m).map(|refracted| refracted.z < 0.0))
        };
        for (from, to) in constant_intervals(directions) {
            for &(x, weight) in &rule {
                let psi = FRAC_PI_2 * x;
                let phi = from + (to - from) * psi.sin().powi(2);
                let m = facet(phi);
                let weight = weight * FRAC_PI_2 * (to - from) * (2.0 * psi).sin() * (2.0 * phi).sin();
                let reflected = match kind {
                    FacetKind::Mirror => 1.0,
                    FacetKind::Dielectric(index) => fresnel::dielectric(wo.dot(m), 1.0, index),
                };
                missing += weight * reflected * shadowed(fresnel::reflect(wo, m).z);
                if let Some(refracted) = refract(m) {
                    let lost = shadowed(-refracted.z);
                    missing += weight * (1.0 - reflected) * lost;
                    transmitted += weight * (1.0 - reflected) * (1.0 - lost);
                }
            }
        }
    }
    (missing / AZIMUTHS as f64, transmitted / AZIMUTHS as f64)
}

/// Divides \[0, π/2\] into intervals in which `state` is constant. States on less than a sixteenth
/// of the interval may be missed; the integrands are continuous, so the error is small.
fn constant_intervals<S: PartialEq>(state: impl Fn(f64) -> S) -> impl Iterator<Item = (f64, f64)> {
    const PROBES: usize = 16;
    let mut ends = vec![0.0];
    let mut last = state(0.0);
    for probe in 1..=PROBES {
        let end = FRAC_PI_2 * probe as f64 / PROBES as f64;
        let next = state(end);
        if next != last {
            let (mut inside, mut outside) = (FRAC_PI_2 * (probe - 1) as f64 / PROBES as f64, end);
            for _ in 0..14 {
                let middle = 0.5 * (inside + outside);
                *(if state(middle) == last { &mut inside } else { &mut outside }) = middle;
            }
            ends.push(outside);
        }
        last = next;
    }
    ends.push(FRAC_PI_2);
    (1..ends.len()).map(move |i| (ends[i - 1], ends[i]))
}
