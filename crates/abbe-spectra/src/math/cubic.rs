//! Cubic interpolation between evenly spaced nodes.

/// Lagrange weights of the cubic through the four nodes around a position.
#[derive(Debug, Clone, Copy)]
pub struct CubicStencil {
    first: usize,
    weights: [f64; 4],
}

impl CubicStencil {
    /// Creates the stencil of a position among `count` ≥ 4 nodes at 0, 1, …, `count` − 1.
    pub fn new(position: f64, count: usize) -> Self {
        let first = (position.floor() as usize).saturating_sub(1).min(count - 4);
        let x = position - first as f64;
        let weights = [
            -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
            x * (x - 2.0) * (x - 3.0) / 2.0,
            -x * (x - 1.0) * (x - 3.0) / 2.0,
            x * (x - 1.0) * (x - 2.0) / 6.0,
        ];
        Self { first, weights }
    }

    /// Returns the numbers and the weights of the four nodes.
    pub fn nodes(&self) -> impl Iterator<Item = (usize, f64)> {
        (self.first..).zip(self.weights)
    }

    /// Interpolates the values at all nodes.
    pub fn apply(&self, values: &[f64]) -> f64 {
        self.weights.iter().zip(&values[self.first..]).map(|(weight, value)| weight * value).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_interpolated_exactly_up_to_both_ends() {
        let cubic = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x - 0.1 * x * x * x;
        let values: Vec<f64> = (0..9).map(|node| cubic(f64::from(node))).collect();
        for i in 0..=80 {
            let x = 0.1 * f64::from(i);
            let stencil = CubicStencil::new(x, values.len());
            let sum: f64 = stencil.nodes().map(|(node, weight)| weight * values[node]).sum();
            assert!((stencil.apply(&values) - cubic(x)).abs() < 1e-12 && (sum - cubic(x)).abs() < 1e-12, "{x}");
        }
    }
}
