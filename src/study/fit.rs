//! How fast an error falls: least squares on logarithms.

use serde::{Deserialize, Serialize};

/// The power law that comes nearest to points: y = c·xᵖ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The exponent p.
    pub slope: f64,
    /// Its standard error, from the scatter around the line.
    pub standard_error: f64,
    /// log₁₀ of c.
    #[serde(skip)]
    pub intercept: f64,
    /// How many points there were.
    pub points: usize,
}

impl Fit {
    /// Fits a power law; `None` with fewer than three points above 0, or all at the same x.
    pub fn of(points: impl Iterator<Item = (f64, f64)>) -> Option<Self> {
        let logs: Vec<(f64, f64)> =
            points.filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.log10(), y.log10())).collect();
        let count = logs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|point| point.0), mean(|point| point.1));
        let spread: f64 = logs.iter().map(|point| (point.0 - x).powi(2)).sum();
        if logs.len() < 3 || spread < 1e-12 {
            return None;
        }
        let slope = logs.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / spread;
        let intercept = y - slope * x;
        let left: f64 = logs.iter().map(|point| (point.1 - intercept - slope * point.0).powi(2)).sum();
        Some(Self { slope, standard_error: (left / (count - 2.0) / spread).sqrt(), intercept, points: logs.len() })
    }

    /// The exponent with its standard error.
    pub fn words(&self) -> String {
        format!("{:.2} ± {:.2}", self.slope, self.standard_error).replace('-', "−")
    }

    /// The law's value.
    pub fn at(&self, x: f64) -> f64 {
        10.0_f64.powf(self.intercept + self.slope * x.log10())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_exactly() {
        let law = |x: f64| (x, 3.0 * x.powf(-0.8));
        let fit = Fit::of([1.0, 2.0, 8.0, 64.0].into_iter().map(law)).unwrap();
        assert!((fit.slope + 0.8).abs() < 1e-12 && fit.standard_error < 1e-7 && fit.points == 4, "{fit:?}");
        assert!((fit.at(5.0) / law(5.0).1 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_standard_error_is_that_of_the_textbook() {
        // log y = 0, 1, 0 at log x = 0, 1, 2: the line is level at 1/3, squares left 2/3, spread 2.
        let fit = Fit::of([(1.0, 1.0), (10.0, 10.0), (100.0, 1.0)].into_iter()).unwrap();
        assert!(fit.slope.abs() < 1e-12 && (fit.intercept - 1.0 / 3.0).abs() < 1e-12);
        assert!((fit.standard_error - (1.0_f64 / 3.0).sqrt()).abs() < 1e-12, "{fit:?}");
    }

    #[test]
    fn too_few_points_have_no_slope() {
        assert_eq!(Fit::of([(1.0, 1.0), (2.0, 0.5), (3.0, -1.0)].into_iter()), None);
        assert_eq!(Fit::of([(2.0, 1.0), (2.0, 0.5), (2.0, 0.2)].into_iter()), None);
    }
}
