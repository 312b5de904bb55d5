//! Fits power laws by least squares on logarithms.

use abbe_spectra::math::elementary::{log10, powf};
use serde::{Deserialize, Serialize};

/// A power law y = c·xᵖ, fitted to points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PowerLawFit {
    pub slope: f64,
    /// The standard error of the exponent, from the scatter of the points around the line.
    pub standard_error: f64,
    /// log₁₀ of c.
    #[serde(skip)]
    pub intercept: f64,
    pub points: usize,
}

impl PowerLawFit {
    /// Fits a power law, unless fewer than three points are positive or all have the same x.
    pub fn of(points: impl Iterator<Item = (f64, f64)>) -> Option<Self> {
        let logs: Vec<(f64, f64)> =
            points.filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (log10(x), log10(y))).collect();
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

    pub fn words(&self) -> String {
        format!("{:.2} ± {:.2}", self.slope, self.standard_error).replace('-', "−")
    }

    pub fn at(&self, x: f64) -> f64 {
        powf(10.0_f64, self.intercept + self.slope * log10(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_exactly() {
        let law = |x: f64| (x, 3.0 * x.powf(-0.8));
        let fit = PowerLawFit::of([1.0, 2.0, 8.0, 64.0].into_iter().map(law)).unwrap();
        assert!((fit.slope + 0.8).abs() < 1e-12 && fit.standard_error < 1e-7 && fit.points == 4, "{fit:?}");
        assert!((fit.at(5.0) / law(5.0).1 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_standard_error_matches_the_textbook_formula() {
        // log y = 0, 1, 0 at log x = 0, 1, 2. The fitted line is log y = 1/3, with squared
        // residuals of 2/3 in sum, and squared deviations of log x of 2.
        let fit = PowerLawFit::of([(1.0, 1.0), (10.0, 10.0), (100.0, 1.0)].into_iter()).unwrap();
        assert!(fit.slope.abs() < 1e-12 && (fit.intercept - 1.0 / 3.0).abs() < 1e-12);
        assert!((fit.standard_error - (1.0_f64 / 3.0).sqrt()).abs() < 1e-12, "{fit:?}");
    }

    #[test]
    fn too_few_points_have_no_slope() {
        assert_eq!(PowerLawFit::of([(1.0, 1.0), (2.0, 0.5), (3.0, -1.0)].into_iter()), None);
        assert_eq!(PowerLawFit::of([(2.0, 1.0), (2.0, 0.5), (2.0, 0.2)].into_iter()), None);
    }
}
