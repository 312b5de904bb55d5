//! Discrete and piecewise-constant distributions with exact densities.

/// Draws an index with probability proportional to its weight.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    /// Cumulative probabilities; entry i is the sum below index i, the last is 1.
    cumulative: Vec<f64>,
}

impl Discrete {
    /// Weights must be finite and not negative; `None` if their sum is 0.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for weight in weights {
            sum += weight;
            cumulative.push(sum);
        }
        if sum <= 0.0 {
            return None;
        }
        cumulative.iter_mut().for_each(|c| *c /= sum);
        Some(Self { cumulative })
    }

    /// How many indices there are.
    pub fn len(&self) -> usize {
        self.cumulative.len() - 1
    }

    /// Never true: a distribution has at least one index of positive weight.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The probability of an index.
    pub fn probability(&self, index: usize) -> f64 {
        self.cumulative[index + 1] - self.cumulative[index]
    }

    /// Draws an index by `u` in [0, 1) and leaves in `u` a fresh uniform number. Never draws an index of probability 0.
    pub fn sample(&self, u: &mut f64) -> usize {
        let above = self.cumulative.partition_point(|&c| c <= *u).clamp(1, self.len());
        let index = above - 1;
        *u = ((*u - self.cumulative[index]) / self.probability(index)).clamp(0.0, super::random::ONE_MINUS_ULP);
        index
    }
}

/// A density over the unit square, constant on each cell of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    columns: usize,
    rows: Discrete,
    within_row: Vec<Option<Discrete>>,
}

impl Grid {
    /// The density proportional to `weights` (rows of `columns` cells; row index along the second coordinate).
    /// `None` if all are 0.
    pub fn new(columns: usize, weights: &[f64]) -> Option<Self> {
        let rows = Discrete::new(weights.chunks(columns).map(|row| row.iter().sum()))?;
        let within_row = weights.chunks(columns).map(|row| Discrete::new(row.iter().copied())).collect();
        Some(Self { columns, rows, within_row })
    }

    /// Draws a point of the unit square; returns it with its density.
    pub fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let [mut a, mut b] = u;
        let row = self.rows.sample(&mut b);
        let cells = self.within_row[row].as_ref().expect("a row of probability 0 is never drawn");
        let column = cells.sample(&mut a);
        let point = [(column as f64 + a) / self.columns as f64, (row as f64 + b) / self.rows.len() as f64];
        (point, self.cell_density(row, column))
    }

    /// The density at a point of the unit square.
    pub fn density(&self, point: [f64; 2]) -> f64 {
        let cell = |x: f64, count: usize| ((x * count as f64) as usize).min(count - 1);
        self.cell_density(cell(point[1], self.rows.len()), cell(point[0], self.columns))
    }

    fn cell_density(&self, row: usize, column: usize) -> f64 {
        let inside = self.within_row[row].as_ref().map_or(0.0, |cells| cells.probability(column));
        self.rows.probability(row) * inside * (self.columns * self.rows.len()) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::ONE_MINUS_ULP;

    #[test]
    fn an_index_is_drawn_in_proportion_and_never_at_weight_zero() {
        let distribution = Discrete::new([0.0, 1.0, 0.0, 3.0, 0.0]).unwrap();
        let mut counts = [0; 5];
        for i in 0..4000 {
            let mut u = f64::from(i) / 4000.0;
            counts[distribution.sample(&mut u)] += 1;
            assert!((0.0..1.0).contains(&u));
        }
        assert_eq!(counts, [0, 1000, 0, 3000, 0]);
        assert_eq!(distribution.sample(&mut ONE_MINUS_ULP.clone()), 3);
        assert_eq!(distribution.sample(&mut 0.0_f64.clone()), 1);
        assert!(Discrete::new([0.0, 0.0]).is_none());
    }

    #[test]
    fn a_grid_density_integrates_to_one_and_matches_its_samples() {
        let grid = Grid::new(3, &[1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 4.0, 1.0, 0.5]).unwrap();
        let n = 300;
        let mut integral = 0.0;
        for i in 0..n {
            for j in 0..n {
                integral += grid.density([(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n)]);
                let (p, density) = grid.sample([f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)]);
                assert!(density > 0.0 && (density - grid.density(p)).abs() < 1e-12 * density);
            }
        }
        assert!((integral / f64::from(n * n) - 1.0).abs() < 1e-9);
    }
}
