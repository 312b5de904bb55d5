//! A grid of angles at which albedos of rough surfaces are tabulated.

use crate::microfacet::Ggx;
use abbe_spectra::math::cubic::CubicStencil;
use abbe_spectra::math::quadrature::gauss_legendre;

/// Number of angles at which a function is computed.
const COMPUTED_ANGLES: usize = 96;
/// Number of cells between two computed angles, filled by cubic interpolation.
const CELLS_BETWEEN: usize = 5;
const ANGLES: usize = (COMPUTED_ANGLES - 1) * CELLS_BETWEEN + 1;
/// Number of points of the quadrature of the mean in each cell.
const POINTS_PER_CELL: usize = 4;

/// The cosines μ at which functions of the angle are tabulated for facets of one roughness. The
/// albedo changes fast at grazing angles, where μ is of the order of α or smaller. With s = √μ and
/// a = √α, the nodes are evenly spaced in the mean of s and (1 + a)·s/(s + a).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AngleGrid {
    root: f64,
    /// The weights of ∫ 2μ·f(μ) dμ for the interpolated function.
    mean_weights: Vec<f64>,
}

/// A cosine between two neighbouring nodes of an [`AngleGrid`].
#[derive(Debug, Clone, Copy)]
pub(super) struct GridPoint {
    cell: usize,
    /// Between the nodes, from 0 to 1.
    fraction: f64,
}

impl AngleGrid {
    pub(super) fn new(facets: &Ggx) -> Self {
        let mut grid = Self { root: facets.alpha().sqrt(), mean_weights: vec![0.0; ANGLES] };
        let rule = gauss_legendre(POINTS_PER_CELL);
        // With ∫ 2μ·f dμ = ∫ f d(μ²), the weights of a cell sum to the difference of μ².
        for cell in 0..ANGLES - 1 {
            for (x, weight) in &rule {
                let fraction = weight * grid.slope_of_squared_cosine(cell as f64 + x);
                grid.mean_weights[cell] += fraction * (1.0 - x);
                grid.mean_weights[cell + 1] += fraction * x;
            }
        }
        grid
    }

    pub(super) fn tabulate<const N: usize>(&self, f: impl Fn(f64) -> [f64; N]) -> Vec<[f64; N]> {
        let computed: Vec<[f64; N]> =
            (0..COMPUTED_ANGLES).map(|angle| f(self.cosine((angle * CELLS_BETWEEN) as f64))).collect();
        let interpolated = |node: usize| {
            let stencil = CubicStencil::new(node as f64 / CELLS_BETWEEN as f64, COMPUTED_ANGLES);
            let mut values = [0.0; N];
            for (angle, weight) in stencil.nodes() {
                values.iter_mut().zip(&computed[angle]).for_each(|(sum, value)| *sum += weight * value);
            }
            values
        };
        (0..ANGLES).map(interpolated).collect()
    }

    pub(super) fn locate(&self, cos: f64) -> GridPoint {
        let s = cos.sqrt();
        let position = 0.5 * (ANGLES - 1) as f64 * (s + (1.0 + self.root) * s / (s + self.root));
        let cell = (position as usize).min(ANGLES - 2);
        GridPoint { cell, fraction: position - cell as f64 }
    }

    /// Returns ∫ 2μ·f(μ) dμ for the interpolation of f between these values at the nodes.
    pub(super) fn mean(&self, values: impl Iterator<Item = f64>) -> f64 {
        self.mean_weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
    }

    /// Returns s at a position among the nodes, and its derivative with respect to the position.
    fn root_of_cosine(&self, position: f64) -> (f64, f64) {
        // The solution of s² + b·s − 2·t·a = 0, where t is the position from 0 to 1.
        let t = position / (ANGLES - 1) as f64;
        let b = 1.0 + 2.0 * self.root - 2.0 * t;
        let discriminant = (b * b + 8.0 * t * self.root).sqrt();
        let s = 0.5 * (discriminant - b);
        (s, (s + self.root) * 2.0 / (discriminant * (ANGLES - 1) as f64))
    }

    fn cosine(&self, position: f64) -> f64 {
        self.root_of_cosine(position).0.powi(2).min(1.0)
    }

    /// Returns the derivative of μ² with respect to the position.
    fn slope_of_squared_cosine(&self, position: f64) -> f64 {
        let (s, slope) = self.root_of_cosine(position);
        4.0 * s.powi(3) * slope
    }
}

impl GridPoint {
    pub(super) fn between(self, value: impl Fn(usize) -> f64) -> f64 {
        let (low, high) = (value(self.cell), value(self.cell + 1));
        low + (high - low) * self.fraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALPHAS: [f64; 3] = [1e-3, 0.05, 1.0];

    /// ∫ 2μ dμ = 1, ∫ 2μ² dμ = 2/3 and ∫ 2μ·√μ dμ = 4/5.
    #[test]
    fn means_of_interpolated_powers_are_exact() {
        for alpha in ALPHAS {
            let grid = AngleGrid::new(&Ggx::new(alpha));
            let powers = grid.tabulate(|cos| [1.0, cos, cos.sqrt()]);
            for (power, exact) in [1.0, 2.0 / 3.0, 0.8].into_iter().enumerate() {
                let mean = grid.mean(powers.iter().map(|values| values[power]));
                assert!((mean - exact).abs() < 5e-6, "alpha {alpha}, power {power}: {mean}");
            }
        }
    }

    #[test]
    fn a_cosine_is_found_between_its_neighbours() {
        for alpha in ALPHAS {
            let grid = AngleGrid::new(&Ggx::new(alpha));
            let cosines = grid.tabulate(|cos| [cos]);
            for i in 0..=50 {
                let cos = f64::from(i * i) / 2500.0;
                let found = grid.locate(cos).between(|node| cosines[node][0]);
                assert!((found - cos).abs() < 2e-5, "alpha {alpha}, cosine {cos}: {found}");
            }
        }
    }
}
