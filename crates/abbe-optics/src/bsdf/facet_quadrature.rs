//! Integrals over the microfacets that a direction sees.
//!
//! Let o be the direction of the viewer, θ the angle between o and the normal m of a facet, and φ
//! the azimuth of m around o. At one θ, Fresnel's equations give one reflectance. The pdf of the
//! normals, and the heights of the reflected and of the refracted direction above the surface,
//! depend only on the height z = cosθ·cosθ_o + sinθ·sinθ_o·cosφ of the normal. A facet is visible
//! if θ < 90° and z > 0.
//!
//! The inner integral over φ is divided where a direction passes the horizon, and the outer
//! integral over θ where such a φ reaches 0 or π. All these angles have closed forms, and the
//! integrands are smooth in between, so few points suffice.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::fresnel;
use crate::microfacet::Ggx;
use abbe_spectra::math::elementary::{acos, asinh, atan, atan2, sin, sin_cos, sinh};
use abbe_spectra::math::quadrature::gauss_legendre;

/// Number of points in a short interval.
const FEWEST_POINTS: usize = 6;
/// Number of further points per unit of t, where θ = θ_o + α·sinh t.
const POLAR_POINTS: f64 = 2.0;
/// Number of further points per radian of ψ, where tan(φ/2) = k·tan(ψ/2).
const AZIMUTH_POINTS: f64 = 12.0 / PI;
/// The most further points: t is longest for the least roughness, asinh(π/(2α)) = 8.05.
const MOST_FURTHER_POINTS: usize = 17;

/// How much light each facet of an interface reflects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FacetKind {
    Mirror,
    /// Fresnel's equations at this index of the far medium relative to the near medium.
    Dielectric(f64),
}

impl FacetKind {
    pub(super) fn reflectance(self, cos: f64) -> f64 {
        match self {
            Self::Mirror => 1.0,
            Self::Dielectric(index) => fresnel::dielectric(cos, 1.0, index),
        }
    }
}

/// The visible facets at one angle θ. Over all visited bands, `visible` sums to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct FacetBand {
    pub(super) cos: f64,
    /// The fraction of the visible area in this band.
    pub(super) visible: f64,
    /// The part of `visible` from which reflected light hits another facet.
    pub(super) reflected_shadowed: f64,
    /// The part of `visible` from which refracted light, if any, hits another facet.
    pub(super) refracted_shadowed: f64,
}

/// The quadrature for the facets of one roughness.
#[derive(Debug, Clone)]
pub(super) struct FacetQuadrature {
    facets: Ggx,
    /// For 0, 1, … further points.
    rules: Vec<Vec<(f64, f64)>>,
}

impl FacetQuadrature {
    pub(super) fn new(facets: Ggx) -> Self {
        Self::refined(facets, 1)
    }

    /// Creates a quadrature with `times` as many points.
    pub(super) fn refined(facets: Ggx, times: usize) -> Self {
        let rules = (0..=MOST_FURTHER_POINTS).map(|further| graded(times * (FEWEST_POINTS + further))).collect();
        Self { facets, rules }
    }

    /// The nodes and weights of the rule for an interval of this length.
    fn rule(&self, points_per_unit: f64, length: f64) -> &[(f64, f64)] {
        &self.rules[((points_per_unit * length).ceil() as usize).min(MOST_FURTHER_POINTS)]
    }

    /// Calls `visit` for every band of facets that are visible from a cosine `cos_o` in \[0, 1\].
    pub(super) fn each_band(&self, kind: FacetKind, cos_o: f64, mut visit: impl FnMut(FacetBand)) {
        let view = FacetView::new(self.facets, kind, cos_o);
        let alpha = self.facets.alpha();
        // Most visible facets have an angle θ within a few α of θ_o, but the distribution has a
        // long tail. With θ = θ_o + α·sinh t, the integrand is smooth in t.
        let place = |theta: f64| asinh((theta - view.theta_o) / alpha);
        for ends in view.polar_ends().windows(2) {
            let (from, to) = (place(ends[0]), place(ends[1]));
            if to <= from {
                continue;
            }
            for &(x, weight) in self.rule(POLAR_POINTS, to - from) {
                let distance = sinh(from + (to - from) * x);
                let theta = view.theta_o + alpha * distance;
                let width = weight * (to - from) * alpha * (1.0 + distance * distance).sqrt();
                visit(view.band(theta, width, self));
            }
        }
    }
}

struct FacetView {
    facets: Ggx,
    kind: FacetKind,
    cos_o: f64,
    sin_o: f64,
    theta_o: f64,
}

impl FacetView {
    fn new(facets: Ggx, kind: FacetKind, cos_o: f64) -> Self {
        let sin_o = ((1.0 - cos_o) * (1.0 + cos_o)).sqrt();
        Self { facets, kind, cos_o, sin_o, theta_o: atan2(sin_o, cos_o) }
    }

    /// Returns the angles θ at which the integral over φ is not smooth, in ascending order.
    fn polar_ends(&self) -> [f64; 8] {
        let elevation = FRAC_PI_2 - self.theta_o;
        // Total reflection begins at √(1 − n²). For n > 1, R changes fast below √(n² − 1).
        let (refracted_at_horizon, fresnel_end) = match self.kind {
            FacetKind::Dielectric(n) => {
                let (sin, cos) = sin_cos(elevation);
                let at_horizon = if n < 1.0 { atan2(n * sin, 1.0 - n * cos) } else { 0.0 };
                (at_horizon, acos(((n - 1.0) * (n + 1.0)).abs().sqrt().min(1.0)))
            }
            FacetKind::Mirror => (0.0, 0.0),
        };
        let mut ends = [
            0.0,
            FRAC_PI_2,
            self.theta_o,
            // From this θ on, some normals at φ = π lie below the horizon.
            elevation,
            // Light reflected at φ = π, and light reflected at φ = 0, lies in the horizon.
            0.5 * elevation,
            FRAC_PI_2 - 0.5 * elevation,
            // Light refracted at φ = 0 lies in the horizon.
            refracted_at_horizon,
            fresnel_end,
        ];
        ends.sort_by(f64::total_cmp);
        ends
    }

    /// Integrates over φ at one θ with the weight dθ = `width`.
    ///
    /// GGX's density is D = α²/(π·(1 − b²z²)²) with b² = 1 − α². For z = z₀ + z₁cosφ, the
    /// substitution tan(φ/2) = k·tan(ψ/2) makes dφ/(1 − bz) proportional to dψ.
    fn band(&self, theta: f64, width: f64, quadrature: &FacetQuadrature) -> FacetBand {
        let alpha = self.facets.alpha();
        let b = ((1.0 - alpha) * (1.0 + alpha)).sqrt();
        let (sin, cos) = sin_cos(theta);
        let (z0, z1) = (cos * self.cos_o, sin * self.sin_o);
        let k = ((1.0 - b * (z0 + z1)) / (1.0 - b * (z0 - z1))).sqrt();
        let place = |z: f64| {
            let cos_phi = (z - z0) / z1;
            // The comparisons also hold for z₁ = 0.
            if cos_phi <= -1.0 {
                PI
            } else if cos_phi < 1.0 {
                2.0 * atan(((1.0 - cos_phi) / (1.0 + cos_phi)).sqrt() / k)
            } else {
                0.0
            }
        };
        // The index, and a of the refracted direction (a·m − o)/n, unless all is reflected.
        let refraction = match self.kind {
            FacetKind::Dielectric(index) => fresnel::refraction_along_normal(cos, 1.0, index).map(|a| (index, a)),
            FacetKind::Mirror => None,
        };
        let last = place(0.0);
        let reflected_at_horizon = place(0.5 * self.cos_o / cos).min(last);
        let refracted_at_horizon = match refraction {
            Some((_, along)) if along > 0.0 => place(self.cos_o / along).min(last),
            _ => 0.0,
        };
        let mut ends = [0.0, reflected_at_horizon, refracted_at_horizon, last];
        ends.sort_by(f64::total_cmp);

        let shadowed = |up: f64| if up > 0.0 { self.facets.shadowed_fraction(self.cos_o, up.min(1.0)) } else { 1.0 };
        let mut band = FacetBand { cos, visible: 0.0, reflected_shadowed: 0.0, refracted_shadowed: 0.0 };
        for piece in ends.windows(2) {
            let (from, length) = (piece[0], piece[1] - piece[0]);
            if length == 0.0 {
                continue;
            }
            for &(x, weight) in quadrature.rule(AZIMUTH_POINTS, length) {
                let (half_sin, half_cos) = sin_cos(0.5 * (from + length * x));
                let (sin2, cos2) = (k * k * half_sin * half_sin, half_cos * half_cos);
                let z = z0 + z1 * (cos2 - sin2) / (cos2 + sin2);
                let t = 1.0 - b * b * z * z;
                let facets = weight * length * k / (cos2 + sin2) * alpha * alpha / (PI * t * t);
                band.visible += facets;
                band.reflected_shadowed += facets * shadowed(2.0 * cos * z - self.cos_o);
                if let Some((index, along)) = refraction {
                    band.refracted_shadowed += facets * shadowed((self.cos_o - along * z) / index);
                }
            }
        }
        // The pdf of visible normals is D·G₁·cosθ/cosθ_o (Heitz 2014), doubled for negative φ.
        let scale = 2.0 * width * sin * cos * self.facets.g1_per_cos(self.cos_o);
        band.visible *= scale;
        band.reflected_shadowed *= scale;
        band.refracted_shadowed *= scale;
        band
    }
}

/// Returns Gauss–Legendre in y on \[0, 1\], x = sin²(πy/2), for a square root at an end.
fn graded(points: usize) -> Vec<(f64, f64)> {
    let grade = |(y, weight): (f64, f64)| (sin(FRAC_PI_2 * y).powi(2), weight * FRAC_PI_2 * sin(PI * y));
    gauss_legendre(points).into_iter().map(grade).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [FacetKind; 6] = [
        FacetKind::Mirror,
        FacetKind::Dielectric(1.0),
        FacetKind::Dielectric(1.03),
        FacetKind::Dielectric(0.97),
        FacetKind::Dielectric(1.5),
        FacetKind::Dielectric(0.4),
    ];

    fn each_case(mut check: impl FnMut(Ggx, FacetKind, f64)) {
        for alpha in [1e-3, 0.02, 0.2, 0.7, 1.0] {
            for kind in KINDS {
                for cos in [0.0, 1e-3, 0.03, 0.2, 0.5, 0.9, 1.0] {
                    check(Ggx::new(alpha), kind, cos);
                }
            }
        }
    }

    /// Returns the sums of the visible, the shadowed reflecting and the shadowed refracting facets.
    fn sums(quadrature: &FacetQuadrature, kind: FacetKind, cos: f64) -> [f64; 3] {
        let mut sums = [0.0; 3];
        quadrature.each_band(kind, cos, |band| {
            let reflectance = kind.reflectance(band.cos);
            sums[0] += band.visible;
            sums[1] += reflectance * band.reflected_shadowed;
            sums[2] += (1.0 - reflectance) * band.refracted_shadowed;
        });
        sums
    }

    #[test]
    fn visible_facets_sum_to_one() {
        each_case(|facets, kind, cos| {
            let [visible, ..] = sums(&FacetQuadrature::new(facets), kind, cos);
            assert!((visible - 1.0).abs() < 2e-5, "{facets:?}, {kind:?}, cosine {cos}: {visible}");
        });
    }

    #[test]
    fn three_times_as_many_points_change_little() {
        each_case(|facets, kind, cos| {
            let found = sums(&FacetQuadrature::new(facets), kind, cos);
            let finer = sums(&FacetQuadrature::refined(facets, 3), kind, cos);
            for part in [1, 2] {
                let error = found[part] - finer[part];
                assert!(error.abs() < 5e-5, "{facets:?}, {kind:?}, cosine {cos}: {error}");
            }
        });
    }
}
