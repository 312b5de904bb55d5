//! Importance-driven photon emission.
//!
//! Two random numbers select the direction of a ray that a light emits, or its position for a beam
//! or a distant light. A grid divides their unit square into cells, whose weights the pilot learns
//! before pass 0: the root mean square of the contributions of a cell's photons to the picture,
//! which minimises the variance. A fraction of the photons ignores the grid, so that every
//! direction keeps a positive density and the estimate stays unbiased. Sources: Jensen 1995
//! (projection maps); Peter & Pietrek 1998, "Importance Driven Construction of Photon Maps".

use abbe_spectra::math::distribution::PiecewiseConstant2d;

/// The largest number of cells along each side of the grid.
pub const CELLS: usize = 64;

/// The fraction of photons that ignores the grid (defensive sampling).
const DEFENSIVE: f64 = 0.25;

/// The learned emission distribution of one stratum of a light's rays.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Aim(Option<PiecewiseConstant2d>);

impl Aim {
    pub fn plain() -> Self {
        Self(None)
    }

    /// Takes the weights of the cells row by row, with `side` per row.
    pub fn learned(side: usize, scores: &[f64]) -> Self {
        Self(PiecewiseConstant2d::new(side, scores))
    }

    pub fn is_plain(&self) -> bool {
        self.0.is_none()
    }

    /// Maps `u` in [0, 1)² to a point of the grid. Returns the point and its relative pdf.
    pub fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let Some(grid) = &self.0 else { return (u, 1.0) };
        let point = if u[0] < DEFENSIVE {
            [u[0] / DEFENSIVE, u[1]]
        } else {
            grid.sample([(u[0] - DEFENSIVE) / (1.0 - DEFENSIVE), u[1]]).0
        };
        (point, self.relative_pdf(point))
    }

    /// Returns the pdf at a point of the grid, relative to uniform sampling.
    pub fn relative_pdf(&self, point: [f64; 2]) -> f64 {
        self.0.as_ref().map_or(1.0, |grid| DEFENSIVE + (1.0 - DEFENSIVE) * grid.pdf(point))
    }

    /// Returns the mean density of the samples, relative to uniform sampling.
    pub fn mean_relative_pdf(&self) -> f64 {
        self.0.as_ref().map_or(1.0, |grid| {
            // The mean over the samples is the integral of the squared density.
            DEFENSIVE * (2.0 - DEFENSIVE) + (1.0 - DEFENSIVE).powi(2) * grid.integral_of_square()
        })
    }

    /// Returns the index of the cell that contains a point. The grid has `side` cells per row.
    pub fn cell(point: [f64; 2], side: usize) -> usize {
        let cell = |x: f64| ((x * side as f64) as usize).min(side - 1);
        cell(point[1]) * side + cell(point[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::sobol::Sobol;

    /// The mean of 1/density is 1, and the best cell receives its fraction of the samples.
    #[test]
    fn aiming_preserves_the_mean_power() {
        let mut scores = vec![0.0; CELLS * CELLS];
        scores[700] = 3.0;
        scores[701] = 1.0;
        let aim = Aim::learned(CELLS, &scores);
        let sobol = Sobol::new(1);
        let n = 1 << 14;
        let (mut power, mut inside) = (0.0, 0);
        for i in 0..n {
            let (point, relative_pdf) = aim.sample([sobol.at(i, 0), sobol.at(i, 1)]);
            power += 1.0 / relative_pdf / f64::from(n);
            inside += usize::from(Aim::cell(point, CELLS) == 700);
        }
        assert!((power - 1.0).abs() < 2e-3, "{power}");
        assert!((inside as f64 / f64::from(n) - 0.75 * 0.75).abs() < 1e-2);
    }
}
