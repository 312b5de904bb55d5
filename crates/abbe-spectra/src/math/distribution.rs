//! Discrete and piecewise-constant distributions with exact pdfs.

/// A distribution over indices whose probabilities are proportional to their weights.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscreteDistribution {
    /// Entry i is the sum of the probabilities below index i; the last entry is 1.
    cumulative: Vec<f64>,
}

impl DiscreteDistribution {
    /// Builds the distribution from finite weights ≥ 0, or returns `None` if their sum is 0.
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

    /// Returns the number of indices.
    pub fn len(&self) -> usize {
        self.cumulative.len() - 1
    }

    /// Returns false, because a distribution has at least one index of positive weight.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Returns the probability of an index.
    pub fn probability(&self, index: usize) -> f64 {
        self.cumulative[index + 1] - self.cumulative[index]
    }

    /// Samples an index, never one of probability 0, by the number `u` in [0, 1), and replaces `u`
    /// by a new uniform number, which can be used again.
    pub fn sample(&self, u: &mut f64) -> usize {
        let above = self.cumulative.partition_point(|&c| c <= *u).clamp(1, self.len());
        let index = above - 1;
        *u = ((*u - self.cumulative[index]) / self.probability(index)).clamp(0.0, super::random::ONE_MINUS_ULP);
        index
    }
}

/// A pdf over the unit square, constant on cells of a grid (pbrt's `PiecewiseConstant2D`).
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseConstant2d {
    columns: usize,
    rows: DiscreteDistribution,
    within_row: Vec<Option<DiscreteDistribution>>,
}

impl PiecewiseConstant2d {
    /// Builds the pdf from the weights of the cells, row by row with `columns` cells each; the rows
    /// follow each other along the second coordinate. Returns `None` if all weights are 0.
    pub fn new(columns: usize, weights: &[f64]) -> Option<Self> {
        let rows = DiscreteDistribution::new(weights.chunks(columns).map(|row| row.iter().sum()))?;
        let within_row = weights.chunks(columns).map(|row| DiscreteDistribution::new(row.iter().copied())).collect();
        Some(Self { columns, rows, within_row })
    }

    /// Samples a point of the unit square, and returns it with its pdf per unit area.
    pub fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        let [mut a, mut b] = u;
        let row = self.rows.sample(&mut b);
        let cells = self.within_row[row].as_ref().expect("a row of probability 0 is never drawn");
        let column = cells.sample(&mut a);
        let point = [(column as f64 + a) / self.columns as f64, (row as f64 + b) / self.rows.len() as f64];
        (point, self.cell_pdf(row, column))
    }

    /// Returns the pdf per unit area at a point of the unit square.
    pub fn pdf(&self, point: [f64; 2]) -> f64 {
        let cell = |x: f64, count: usize| ((x * count as f64) as usize).min(count - 1);
        self.cell_pdf(cell(point[1], self.rows.len()), cell(point[0], self.columns))
    }

    /// Returns the integral of the squared pdf over the unit square.
    pub fn integral_of_square(&self) -> f64 {
        let (rows, columns) = (self.rows.len(), self.columns);
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        cells.map(|(row, column)| self.cell_pdf(row, column).powi(2)).sum::<f64>() / (rows * columns) as f64
    }

    fn cell_pdf(&self, row: usize, column: usize) -> f64 {
        let inside = self.within_row[row].as_ref().map_or(0.0, |cells| cells.probability(column));
        self.rows.probability(row) * inside * (self.columns * self.rows.len()) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::ONE_MINUS_ULP;

    #[test]
    fn indices_are_sampled_in_proportion_to_their_weights() {
        let distribution = DiscreteDistribution::new([0.0, 1.0, 0.0, 3.0, 0.0]).unwrap();
        let mut counts = [0; 5];
        for i in 0..4000 {
            let mut u = f64::from(i) / 4000.0;
            counts[distribution.sample(&mut u)] += 1;
            assert!((0.0..1.0).contains(&u));
        }
        assert_eq!(counts, [0, 1000, 0, 3000, 0]);
        assert_eq!(distribution.sample(&mut ONE_MINUS_ULP.clone()), 3);
        assert_eq!(distribution.sample(&mut 0.0_f64.clone()), 1);
        assert!(DiscreteDistribution::new([0.0, 0.0]).is_none());
    }

    /// After a choice, the number is the place within the fraction of the chosen index.
    #[test]
    fn a_number_is_rescaled_for_reuse_after_a_choice() {
        let distribution = DiscreteDistribution::new([1.0, 3.0]).unwrap();
        for (u, index, rest) in [(0.0, 0, 0.0), (0.125, 0, 0.5), (0.25, 1, 0.0), (0.625, 1, 0.5), (0.925, 1, 0.9)] {
            let mut number = u;
            assert_eq!(distribution.sample(&mut number), index, "{u}");
            assert!((number - rest).abs() < 1e-15, "{u}: {number}");
        }
    }

    #[test]
    fn the_pdf_integrates_to_one_and_matches_its_samples() {
        let grid = PiecewiseConstant2d::new(3, &[1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 4.0, 1.0, 0.5]).unwrap();
        let n = 300;
        let mut integral = 0.0;
        for i in 0..n {
            for j in 0..n {
                integral += grid.pdf([(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n)]);
                let (p, pdf) = grid.sample([f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)]);
                assert!(pdf > 0.0 && (pdf - grid.pdf(p)).abs() < 1e-12 * pdf);
            }
        }
        assert!((integral / f64::from(n * n) - 1.0).abs() < 1e-9);
    }
}
