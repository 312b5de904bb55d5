//! How much a rough coat reflects in all, by angle and index, in a table.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::optics::fresnel;
use crate::optics::microfacet::Ggx;

/// Angles of the table: at cosines (i/(ANGLES−1))², dense near grazing, where the albedo turns sharply.
const ANGLES: usize = 64;
/// Points along each of the two dimensions of the integral behind one entry.
const POINTS: usize = 32;

/// The directional albedo E(μ) = ∫ f·cosθ_i dω_i of dielectric GGX facets, in \[0, 1\], and its cosine-weighted mean.
///
/// Cubic between angles; quadratic in the index, which varies little over the band of one material.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CoatAlbedo {
    /// One column an index: one if the index is the same everywhere, else three, evenly spaced.
    columns: Vec<Column>,
}

#[derive(Debug, Clone, PartialEq)]
struct Column {
    index: f64,
    by_angle: Vec<f64>,
    /// 2·∫ E(μ)·μ dμ of the interpolated table.
    mean: f64,
}

impl CoatAlbedo {
    /// The table for relative indices from `lowest` to `highest`, both ≥ 1.
    pub(super) fn new(facets: &Ggx, lowest: f64, highest: f64) -> Self {
        let indices = if lowest == highest { vec![lowest] } else { vec![lowest, 0.5 * (lowest + highest), highest] };
        Self { columns: indices.into_iter().map(|index| Column::new(facets, index)).collect() }
    }

    /// E(μ) at a cosine in \[0, 1\] and a relative index.
    pub(super) fn at(&self, cos: f64, index: f64) -> f64 {
        let stencil = Stencil::new(cos.clamp(0.0, 1.0).sqrt());
        self.over_index(index, |column| stencil.apply(&column.by_angle)).clamp(0.0, 1.0)
    }

    /// The mean of E(μ) over uniform irradiance.
    pub(super) fn mean(&self, index: f64) -> f64 {
        self.over_index(index, |column| column.mean).clamp(0.0, 1.0)
    }

    fn over_index(&self, index: f64, value: impl Fn(&Column) -> f64) -> f64 {
        let [low, middle, high] = self.columns.as_slice() else {
            return value(&self.columns[0]);
        };
        // Lagrange's parabola through three evenly spaced points.
        let x = ((index - middle.index) / (high.index - middle.index)).clamp(-1.0, 1.0);
        0.5 * x * (x - 1.0) * value(low) + (1.0 - x * x) * value(middle) + 0.5 * x * (x + 1.0) * value(high)
    }
}

impl Column {
    fn new(facets: &Ggx, index: f64) -> Self {
        let quadrature = gauss_legendre(POINTS);
        let by_angle: Vec<f64> =
            (0..ANGLES).map(|i| directional_albedo(facets, index, node(i) * node(i), &quadrature)).collect();
        // dμ = 2t dt with μ = t²; within a cell the integrand is a polynomial of degree 6, which four points integrate exactly.
        let rule = gauss_legendre(4);
        let mut mean = 0.0;
        for cell in 0..ANGLES - 1 {
            let width = node(cell + 1) - node(cell);
            for (x, weight) in &rule {
                let t = node(cell) + width * x;
                mean += weight * width * 4.0 * t * t * t * Stencil::new(t).apply(&by_angle);
            }
        }
        Self { index, by_angle, mean }
    }
}

/// √μ of the i-th angle.
fn node(i: usize) -> f64 {
    i as f64 / (ANGLES - 1) as f64
}

/// Lagrange's cubic through the four nodes around a point.
struct Stencil {
    first: usize,
    weights: [f64; 4],
}

impl Stencil {
    fn new(t: f64) -> Self {
        let position = t * (ANGLES - 1) as f64;
        let first = (position.floor() as usize).saturating_sub(1).min(ANGLES - 4);
        let x = position - first as f64;
        let weights = [
            -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
            x * (x - 2.0) * (x - 3.0) / 2.0,
            -x * (x - 1.0) * (x - 3.0) / 2.0,
            x * (x - 1.0) * (x - 2.0) / 6.0,
        ];
        Self { first, weights }
    }

    fn apply(&self, values: &[f64]) -> f64 {
        self.weights.iter().zip(&values[self.first..]).map(|(weight, value)| weight * value).sum()
    }
}

/// E(μ) by quadrature over the visible facets: ∫∫ F·G₂/G₁ du dv, over those that reflect upwards. On the disk from which facets
/// are drawn these lie around the centre: along each radius, with u = sin²φ, the integrand is smooth up to where they end. In v
/// it is even about the plane of incidence, so that half the circle will do.
fn directional_albedo(facets: &Ggx, index: f64, cos: f64, rule: &[(f64, f64)]) -> f64 {
    let wo = DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
    let radii = rule.len();
    let mut sum = 0.0;
    for j in 0..radii {
        let v = (0.5 * (j as f64 + 0.5) / radii as f64 - 0.25).rem_euclid(1.0);
        let facet = |phi: f64| facets.sample_visible(wo, phi.sin().powi(2), v);
        let end = end_of_upwards(|phi| fresnel::reflect(wo, facet(phi)).z > 0.0);
        for (x, weight) in rule {
            let phi = end * x;
            let m = facet(phi);
            let up = fresnel::reflect(wo, m).z.max(0.0);
            let reflected = fresnel::dielectric(wo.dot(m), 1.0, index);
            sum += weight * end * (2.0 * phi).sin() * reflected * facets.escaping(cos, up);
        }
    }
    sum / radii as f64
}

/// The largest φ ≤ π/2 up to which `upwards` holds from 0. The integrand vanishes there, so that a coarse bisection is enough.
fn end_of_upwards(upwards: impl Fn(f64) -> bool) -> f64 {
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

/// Nodes and weights of Gauss's rule of `points` on \[0, 1\], by Newton's method on the Legendre polynomial.
fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    (0..points)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
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

    #[test]
    fn gauss_s_rule_integrates_polynomials_of_degree_2n_minus_1_exactly() {
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
                // Where grazing light meets an almost smooth coat, E turns within a cosine of α, finer than the table; next to no
                // power comes in there, so that it is the error times the cosine that counts.
                assert!(error * cos < 1e-5, "alpha {alpha}, cosine {cos}: error {error}");
                assert!(error < 1e-5 || alpha < 0.1, "alpha {alpha}, cosine {cos}: error {error}");
            }
        }
    }
}
