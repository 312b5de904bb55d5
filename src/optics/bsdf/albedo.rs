//! A table of the directional albedo of a rough dielectric coat. The table is indexed by angle and
//! by refractive index.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::math::cubic::CubicStencil;
use crate::math::elementary::{cos, sin};
use crate::optics::fresnel;
use crate::optics::microfacet::Ggx;

/// Number of angles in the table. The cosines are (i/(ANGLES−1))², so the table is dense near
/// grazing angles, where the albedo changes fast.
const ANGLES: usize = 64;
/// Number of quadrature points in each of the two dimensions of the albedo integral.
const QUADRATURE_POINTS: usize = 32;

/// The directional albedo E(μ) of dielectric GGX facets, and the cosine-weighted mean of E(μ).
///
/// The integral E(μ) = ∫ f·cosθ_i dω_i lies in \[0, 1\]. The interpolation is cubic in the angle,
/// and quadratic in the refractive index. Quadratic interpolation is sufficient because the index
/// of one material varies little over the band.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CoatAlbedo {
    /// One column per refractive index. There is one column if the index is constant, otherwise
    /// three columns at evenly spaced indices.
    columns: Vec<AlbedoColumn>,
}

#[derive(Debug, Clone, PartialEq)]
struct AlbedoColumn {
    index: f64,
    by_angle: Vec<f64>,
    /// The integral 2·∫ E(μ)·μ dμ of the interpolated column.
    mean: f64,
}

impl CoatAlbedo {
    /// Computes the table for relative indices from `lowest` to `highest`. Both must be ≥ 1.
    pub(super) fn new(facets: &Ggx, lowest: f64, highest: f64) -> Self {
        let indices = if lowest == highest { vec![lowest] } else { vec![lowest, 0.5 * (lowest + highest), highest] };
        Self { columns: indices.into_iter().map(|index| AlbedoColumn::new(facets, index)).collect() }
    }

    /// Returns E(μ) for a cosine in \[0, 1\] and a relative index.
    pub(super) fn at(&self, cos: f64, index: f64) -> f64 {
        let stencil = stencil(cos.clamp(0.0, 1.0).sqrt());
        self.over_index(index, |column| stencil.apply(&column.by_angle)).clamp(0.0, 1.0)
    }

    /// Returns the cosine-weighted mean of E(μ): the albedo under uniform incident radiance.
    pub(super) fn mean(&self, index: f64) -> f64 {
        self.over_index(index, |column| column.mean).clamp(0.0, 1.0)
    }

    fn over_index(&self, index: f64, value: impl Fn(&AlbedoColumn) -> f64) -> f64 {
        let [low, middle, high] = self.columns.as_slice() else {
            return value(&self.columns[0]);
        };
        // Lagrange interpolation by a parabola through three evenly spaced points.
        let x = ((index - middle.index) / (high.index - middle.index)).clamp(-1.0, 1.0);
        0.5 * x * (x - 1.0) * value(low) + (1.0 - x * x) * value(middle) + 0.5 * x * (x + 1.0) * value(high)
    }
}

impl AlbedoColumn {
    fn new(facets: &Ggx, index: f64) -> Self {
        let quadrature = gauss_legendre(QUADRATURE_POINTS);
        let by_angle: Vec<f64> =
            (0..ANGLES).map(|i| directional_albedo(facets, index, node(i) * node(i), &quadrature)).collect();
        // With μ = t², dμ = 2t dt. Within a cell the integrand is a polynomial of degree 6, so four
        // Gauss points are exact.
        let rule = gauss_legendre(4);
        let mut mean = 0.0;
        for cell in 0..ANGLES - 1 {
            let width = node(cell + 1) - node(cell);
            for (x, weight) in &rule {
                let t = node(cell) + width * x;
                mean += weight * width * 4.0 * t * t * t * stencil(t).apply(&by_angle);
            }
        }
        Self { index, by_angle, mean }
    }
}

/// Returns √μ, where μ is the cosine of the i-th angle.
fn node(i: usize) -> f64 {
    i as f64 / (ANGLES - 1) as f64
}

/// Returns the stencil of an angle with √μ = `t`.
fn stencil(t: f64) -> CubicStencil {
    CubicStencil::new(t * (ANGLES - 1) as f64, ANGLES)
}

/// Computes E(μ) = ∫∫ F·G₂/G₁ du dv, where u and v are the random numbers of
/// [`Ggx::sample_visible`]. The integral extends over the visible normals that reflect light
/// upwards.
///
/// `sample_visible` samples points of a disk. On this disk, the normals that reflect light upwards
/// form a region around the centre. Along each radius, the substitution u = sin²φ makes the
/// integrand smooth up to the boundary of the region. The integrand is symmetric about the plane of
/// incidence, so the integral over half of the disk suffices.
fn directional_albedo(facets: &Ggx, index: f64, cos: f64, rule: &[(f64, f64)]) -> f64 {
    let wo = DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
    let radii = rule.len();
    let mut sum = 0.0;
    for j in 0..radii {
        let v = (0.5 * (j as f64 + 0.5) / radii as f64 - 0.25).rem_euclid(1.0);
        let facet = |phi: f64| facets.sample_visible(wo, sin(phi).powi(2), v);
        let end = largest_upward_phi(|phi| fresnel::reflect(wo, facet(phi)).z > 0.0);
        for (x, weight) in rule {
            let phi = end * x;
            let m = facet(phi);
            let up = fresnel::reflect(wo, m).z.max(0.0);
            let reflected = fresnel::dielectric(wo.dot(m), 1.0, index);
            sum += weight * end * sin(2.0 * phi) * reflected * facets.g2_over_g1(cos, up);
        }
    }
    sum / radii as f64
}

/// Returns the largest φ ≤ π/2 such that `upwards` is true on the whole interval \[0, φ\]. The
/// integrand vanishes at this φ, so 16 bisection steps are accurate enough.
fn largest_upward_phi(upwards: impl Fn(f64) -> bool) -> f64 {
    if upwards(FRAC_PI_2) {
        return FRAC_PI_2;
    }
    let (mut inside, mut outside) = (0.0, FRAC_PI_2);
    for _ in 0..16 {
        let middle = 0.5 * (inside + outside);
        if upwards(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

/// Computes the nodes and weights of the Gauss–Legendre rule on \[0, 1\]. Newton's method finds the
/// roots of the Legendre polynomial.
pub(super) fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    (0..points)
        .map(|i| {
            let mut x = cos(PI * (i as f64 + 0.75) / (n + 0.5));
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut previous, mut current) = (1.0, x);
                for k in 2..=points {
                    let k = k as f64;
                    (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
                }
                slope = n * (x * current - previous) / (x * x - 1.0);
                x -= current / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Gauss–Legendre rule of n points integrates polynomials of degree 2n − 1 exactly.
    #[test]
    fn gauss_rule_is_exact_up_to_degree_2n_minus_1() {
        for points in [4, 5, 32] {
            let degree = 2 * points - 1;
            let sum: f64 = gauss_legendre(points).iter().map(|(x, weight)| weight * x.powi(degree as i32)).sum();
            assert!((sum * (degree + 1) as f64 - 1.0).abs() < 1e-13, "{points} points: {sum}");
        }
    }

    #[test]
    fn a_nearly_smooth_coat_reflects_as_fresnel_says() {
        let albedo = CoatAlbedo::new(&Ggx::new(1e-3), 1.5, 1.5);
        for cos in [0.3, 0.55, 0.9, 1.0] {
            let fresnel = fresnel::dielectric(cos, 1.0, 1.5);
            assert!((albedo.at(cos, 1.5) - fresnel).abs() < 1e-4, "{cos}: {} {fresnel}", albedo.at(cos, 1.5));
        }
    }

    #[test]
    fn the_table_agrees_with_a_finer_quadrature_between_its_nodes() {
        let fine_rule = gauss_legendre(160);
        for alpha in [1e-3, 0.01, 0.1, 0.3, 1.0] {
            let facets = Ggx::new(alpha);
            let albedo = CoatAlbedo::new(&facets, 1.5, 1.55);
            for i in 0..40 {
                let cos = ((f64::from(i) + 0.37) / 40.0).powi(2);
                let index = 1.5 + 0.05 * f64::from(i) / 39.0;
                let fine = directional_albedo(&facets, index, cos, &fine_rule);
                let error = (albedo.at(cos, index) - fine).abs();
                // For a nearly smooth coat, E changes fast where the cosine is of the order of α or
                // smaller. The table does not resolve this change. Little power arrives at these
                // angles, so the test bounds the error times the cosine.
                assert!(error * cos < 1e-5, "alpha {alpha}, cosine {cos}: error {error}");
                assert!(error < 1e-5 || alpha < 0.1, "alpha {alpha}, cosine {cos}: error {error}");
            }
        }
    }
}
