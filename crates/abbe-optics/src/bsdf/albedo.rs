//! A table of the directional albedo of a rough dielectric coat over angle and refractive index.

use super::angle_grid::AngleGrid;
use super::facet_quadrature::{FacetKind, FacetQuadrature};
use crate::microfacet::Ggx;

/// The directional albedo E(μ) = ∫ f·cosθ_i dω_i of dielectric GGX facets, and its cosine-weighted
/// mean.
///
/// The interpolation is linear in the angle and quadratic in the refractive index, which suffices
/// because the index of one material varies little over the band.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CoatAlbedo {
    grid: AngleGrid,
    /// One column if the index is constant, otherwise three at evenly spaced indices.
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
    /// Computes the table for relative indices from `lowest` ≥ 1 to `highest`.
    pub(super) fn new(facets: &Ggx, lowest: f64, highest: f64) -> Self {
        let (grid, quadrature) = (AngleGrid::new(facets), FacetQuadrature::new(*facets));
        let indices = if lowest == highest { vec![lowest] } else { vec![lowest, 0.5 * (lowest + highest), highest] };
        let columns = indices.into_iter().map(|index| AlbedoColumn::new(&quadrature, &grid, index)).collect();
        Self { grid, columns }
    }

    /// Returns E(μ) for a cosine in \[0, 1\] and a relative index.
    pub(super) fn at(&self, cos: f64, index: f64) -> f64 {
        let point = self.grid.locate(cos.clamp(0.0, 1.0));
        self.over_index(index, |column| point.between(|node| column.by_angle[node])).clamp(0.0, 1.0)
    }

    /// Returns the cosine-weighted mean of E(μ): the albedo under uniform radiance.
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
    fn new(quadrature: &FacetQuadrature, grid: &AngleGrid, index: f64) -> Self {
        let table = grid.tabulate(|cos| [directional_albedo(quadrature, index, cos)]);
        let by_angle: Vec<f64> = table.into_iter().flatten().collect();
        Self { index, mean: grid.mean(by_angle.iter().copied()), by_angle }
    }
}

/// Returns E(μ): the fraction of the light that the facets reflect and that hits no other facet.
fn directional_albedo(quadrature: &FacetQuadrature, index: f64, cos: f64) -> f64 {
    let kind = FacetKind::Dielectric(index);
    let mut sum = 0.0;
    quadrature.each_band(kind, cos, |band| {
        sum += kind.reflectance(band.cos) * (band.visible - band.reflected_shadowed);
    });
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel;

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
        for alpha in [1e-3, 0.01, 0.1, 0.3, 1.0] {
            let facets = Ggx::new(alpha);
            let fine_quadrature = FacetQuadrature::refined(facets, 3);
            let albedo = CoatAlbedo::new(&facets, 1.5, 1.55);
            for i in 0..40 {
                let cos = ((f64::from(i) + 0.37) / 40.0).powi(2);
                let index = 1.5 + 0.05 * f64::from(i) / 39.0;
                let fine = directional_albedo(&fine_quadrature, index, cos);
                let error = (albedo.at(cos, index) - fine).abs();
                // For a nearly smooth coat, E changes too fast for the table where the cosine is of
                // the order of α or smaller. Little power arrives at these angles, so the test
                // bounds the error times the cosine.
                assert!(error * cos < 1e-5, "alpha {alpha}, cosine {cos}: error {error}");
                assert!(error < 1e-5 || alpha < 0.1, "alpha {alpha}, cosine {cos}: error {error}");
            }
        }
    }
}
