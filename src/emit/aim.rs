//! Aiming: photons go where photons have proved useful.
//!
//! A grid over the two random numbers that decide where a light's ray goes, learned by the pilot and then fixed: cell weights are
//! the root mean square of what photons from there contributed (the variance-optimal choice). A share of photons stays
//! unaimed, so that no direction has density 0 and the estimate stays unbiased whatever the pilot missed.
//! After Jensen 1995 (projection maps) and Peter & Pietrek 1998 (importance-driven emission).

use crate::math::distribution::Grid;

/// Cells per side of the grid.
pub const CELLS: usize = 64;

/// The share of photons that is not aimed.
const DEFENSIVE: f64 = 0.25;

/// Where to send the photons of one light.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Aim(Option<Grid>);

impl Aim {
    /// Everywhere alike.
    pub fn plain() -> Self {
        Self(None)
    }

    /// Towards the cells whose `scores` (root-mean-square usefulness, rows of [`CELLS`]) are high.
    pub fn learned(scores: &[f64]) -> Self {
        Self(Grid::new(CELLS, scores))
    }

    /// Whether anything was learned.
    pub fn is_plain(&self) -> bool {
        self.0.is_none()
    }

    /// Draws the aiming pair; returns it with its density relative to the unaimed draw.
    pub fn draw(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let Some(grid) = &self.0 else {
            return (u, 1.0);
        };
        let point = if u[0] < DEFENSIVE {
            [u[0] / DEFENSIVE, u[1]]
        } else {
            grid.sample([(u[0] - DEFENSIVE) / (1.0 - DEFENSIVE), u[1]]).0
        };
        (point, DEFENSIVE + (1.0 - DEFENSIVE) * grid.density(point))
    }

    /// The cell of an aiming pair.
    pub fn cell(point: [f64; 2]) -> usize {
        let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
        cell(point[1]) * CELLS + cell(point[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sobol::Sobol;

    #[test]
    fn aimed_photons_carry_the_same_power_in_the_mean() {
        let mut scores = vec![0.0; CELLS * CELLS];
        scores[700] = 3.0;
        scores[701] = 1.0;
        let aim = Aim::learned(&scores);
        let sobol = Sobol::new(1);
        let n = 1 << 14;
        let (mut power, mut inside) = (0.0, 0);
        for i in 0..n {
            let (point, density) = aim.draw([sobol.at(i, 0), sobol.at(i, 1)]);
            power += 1.0 / density / f64::from(n);
            inside += usize::from(Aim::cell(point) == 700);
        }
        assert!((power - 1.0).abs() < 2e-3, "{power}");
        assert!((inside as f64 / f64::from(n) - 0.75 * 0.75).abs() < 1e-2);
    }
}
