//! The change of the missing energy by thin films on the microfacets.
//!
//! Films change the transmittance of a facet from T = 1 − F to T·(1 − w), so the facet reflects F +
//! w·T. The missing energy is then
//!
//! l_films(μ) = l(μ) + ⟨w·T·(λ_r − λ_t)⟩,
//!
//! where λ_r and λ_t are the fractions of the reflected and of the refracted light that hit another
//! facet, and the mean extends over the normals that are visible from the direction. A ray and its
//! refracted ray have the same w, so for light from both sides w is a function of x, the cosine of
//! the angle of incidence in the medium of lower index. A polynomial in x approximates it.

use super::angle_grid::{AngleGrid, GridPoint};
use super::facet_quadrature::{FacetKind, FacetQuadrature};
use crate::fresnel;
use abbe_spectra::math::quadrature::gauss_legendre;

/// Number of polynomials, of degrees from 0.
pub(super) const MOMENTS: usize = 7;

/// Number of points at which w is computed: integrals of polynomials of degree 17 are exact.
pub(super) const NODES: usize = 9;

/// The projection of functions of a cosine to polynomials.
#[derive(Debug, Clone)]
pub(super) struct CosineFit {
    /// The cosines at which the function is needed.
    pub(super) nodes: [f64; NODES],
    /// The fraction of the value at each node in each coefficient.
    fractions: [[f64; NODES]; MOMENTS],
    /// The weights of ∫ 2x·f(x) dx.
    means: [f64; NODES],
}

impl CosineFit {
    pub(super) fn new() -> Self {
        let rule = gauss_legendre(NODES);
        let mut fit = Self { nodes: [0.0; NODES], fractions: [[0.0; NODES]; MOMENTS], means: [0.0; NODES] };
        let mut squares = [0.0; MOMENTS];
        for (node, (x, weight)) in rule.into_iter().enumerate() {
            fit.nodes[node] = x;
            fit.means[node] = 2.0 * x * weight;
            for (degree, value) in polynomials(x).into_iter().enumerate() {
                fit.fractions[degree][node] = x * weight * value;
                squares[degree] += x * weight * value * value;
            }
        }
        for (fractions, square) in fit.fractions.iter_mut().zip(squares) {
            fractions.iter_mut().for_each(|fraction| *fraction /= square);
        }
        fit
    }

    /// Returns the coefficients of the moments for a function w with these values at the nodes.
    pub(super) fn coefficients(&self, values: &[f64; NODES]) -> [f64; MOMENTS] {
        self.fractions.map(|fractions| fractions.iter().zip(values).map(|(fraction, value)| fraction * value).sum())
    }

    /// Returns ∫ 2x·f(x) dx from the values of f at the nodes.
    pub(super) fn mean(&self, values: &[f64; NODES]) -> f64 {
        self.means.iter().zip(values).map(|(weight, value)| weight * value).sum()
    }
}

/// Returns the polynomials at x: Jacobi's, orthogonal on \[0, 1\] with the weight x, and scaled so
/// that the first coefficient is 1 (Abramowitz & Stegun, §22.7).
fn polynomials(x: f64) -> [f64; MOMENTS] {
    let mut values = [1.0; MOMENTS];
    let (mut last, mut before) = (1.0, 0.0);
    for (k, value) in values.iter_mut().enumerate().skip(1) {
        let (low, high) = ((2 * k - 1) as f64, (2 * k + 1) as f64);
        let middle = 0.5 + 0.5 / (low * high);
        let ratio = ((k - 1) * k) as f64 / (4.0 * low * low);
        (last, before) = ((x - middle) * last - ratio * before, last);
        *value = last;
    }
    values
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct FilmMoments {
    /// For light in the medium of lower index.
    pub(super) from_rare: FilmSideMoments,
    /// For light in the medium of higher index.
    pub(super) from_dense: FilmSideMoments,
    /// The means of ⟨p·T·(1 − λ_t)⟩ at the lower index: the loss of transmitted energy.
    pub(super) transmitted: [f64; MOMENTS],
}

/// The change of the missing energy by each moment, for light from one side.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FilmSideMoments {
    /// At the cosines of the grid.
    by_angle: Vec<[f64; MOMENTS]>,
    /// Means ∫ 2μ·f(μ) dμ.
    pub(super) mean: [f64; MOMENTS],
}

impl FilmMoments {
    /// Computes the moments at a relative index above 1.
    pub(super) fn new(quadrature: &FacetQuadrature, grid: &AngleGrid, index: f64) -> Self {
        let (from_rare, transmitted) = FilmSideMoments::new(quadrature, grid, index);
        let (from_dense, _) = FilmSideMoments::new(quadrature, grid, index.recip());
        Self { from_rare, from_dense, transmitted }
    }
}

impl FilmSideMoments {
    /// Computes the moments, and the means of the lost transmission, at a relative index.
    fn new(quadrature: &FacetQuadrature, grid: &AngleGrid, index: f64) -> (Self, [f64; MOMENTS]) {
        let table = grid.tabulate(|cos| moments(quadrature, index, cos));
        let means: [f64; 2 * MOMENTS] = std::array::from_fn(|number| grid.mean(table.iter().map(|row| row[number])));
        let by_angle = table.iter().map(|row| parts(row).0).collect();
        let (mean, transmitted) = parts(&means);
        (Self { by_angle, mean }, transmitted)
    }

    /// Returns the change of the missing energy at an angle, linearly interpolated.
    pub(super) fn at(&self, point: GridPoint, coefficients: &[f64; MOMENTS]) -> f64 {
        let moment = |number: usize| point.between(|node| self.by_angle[node][number]);
        coefficients.iter().enumerate().map(|(number, coefficient)| coefficient * moment(number)).sum()
    }
}

/// Separates the moments of the missing energy from those of the transmitted energy.
fn parts(row: &[f64; 2 * MOMENTS]) -> ([f64; MOMENTS], [f64; MOMENTS]) {
    (std::array::from_fn(|i| row[i]), std::array::from_fn(|i| row[MOMENTS + i]))
}

/// Integrates ⟨p·T·(λ_r − λ_t)⟩, and then ⟨p·T·(1 − λ_t)⟩, over the visible normals.
fn moments(quadrature: &FacetQuadrature, index: f64, cos: f64) -> [f64; 2 * MOMENTS] {
    let kind = FacetKind::Dielectric(index);
    let mut sums = [0.0; 2 * MOMENTS];
    quadrature.each_band(kind, cos, |band| {
        let through = 1.0 - kind.reflectance(band.cos);
        if through == 0.0 {
            return;
        }
        let x = if index > 1.0 { band.cos } else { fresnel::cos_transmitted(band.cos, 1.0, index) };
        for (degree, value) in polynomials(x).into_iter().enumerate() {
            sums[degree] += value * through * (band.reflected_shadowed - band.refracted_shadowed);
            sums[MOMENTS + degree] += value * through * (band.visible - band.refracted_shadowed);
        }
    });
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::missing_energy::MissingEnergy;
    use crate::microfacet::Ggx;

    /// If w is 1, the facets are mirrors, whose missing energy has its own table.
    #[test]
    fn films_that_reflect_everything_lead_from_glass_to_a_mirror() {
        let mut constant = [0.0; MOMENTS];
        constant[0] = 1.0;
        for alpha in [0.01, 0.09, 0.36, 1.0] {
            let facets = Ggx::new(alpha);
            let (grid, quadrature) = (AngleGrid::new(&facets), FacetQuadrature::new(facets));
            let mirror = MissingEnergy::new(&quadrature, &grid, FacetKind::Mirror);
            for index in [1.5_f64, 1.5_f64.recip()] {
                let glass = MissingEnergy::new(&quadrature, &grid, FacetKind::Dielectric(index));
                let both = FilmMoments::new(&quadrature, &grid, index.max(index.recip()));
                let moments = if index > 1.0 { &both.from_rare } else { &both.from_dense };
                for step in 0..20 {
                    let point = grid.locate((f64::from(step) + 0.5) / 20.0);
                    let off = glass.at(point) + moments.at(point, &constant) - mirror.at(point);
                    assert!(off.abs() < 2e-3, "alpha {alpha}, index {index}, step {step}: {off}");
                }
                assert!((glass.mean + moments.mean[0] - mirror.mean).abs() < 1e-3, "alpha {alpha}, index {index}");
                let rest = glass.transmitted - both.transmitted[0];
                assert!(index < 1.0 || rest.abs() < 1e-3, "alpha {alpha}, index {index}: {rest}");
            }
        }
    }

    #[test]
    fn a_cubic_polynomial_is_its_own_fit() {
        let fit = CosineFit::new();
        let cubic = |x: f64| 0.3 - x + 2.0 * x * x + 0.7 * x * x * x;
        let values = fit.nodes.map(cubic);
        let coefficients = fit.coefficients(&values);
        for x in [0.0, 0.2, 0.9, 1.0] {
            let found: f64 =
                polynomials(x).iter().zip(coefficients).map(|(value, coefficient)| value * coefficient).sum();
            assert!((found - cubic(x)).abs() < 1e-12, "{found}");
        }
        // ∫ 2x·f dx = 0.3 − 2/3 + 2·2/4 + 0.7·2/5.
        assert!((fit.mean(&values) - (0.3 - 2.0 / 3.0 + 1.0 + 0.28)).abs() < 1e-12);
    }
}
