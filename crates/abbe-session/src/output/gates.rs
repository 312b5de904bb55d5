//! Gates: limits on the figures of a comparison, for tests.

use super::compare::Comparison;
use abbe_spectra::error::{Error, Result};

#[derive(Debug, Clone, PartialEq)]
pub struct Gate {
    pub figure: String,
    pub limit: f64,
    pub fails: GateSide,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GateSide {
    Above,
    /// The gate fails if the figure is smaller than the limit.
    Below,
}

impl Comparison {
    /// Returns all figures that a gate can limit, `None` without the error layers that one needs.
    pub fn figures(&self) -> [(&'static str, Option<f64>); 14] {
        let count = |pixels: usize| Some(pixels as f64);
        [
            ("relative_mse", Some(self.relative_mse)),
            ("relative_mse_trimmed", Some(self.relative_mse_trimmed)),
            ("typical_error", Some(self.typical_error)),
            ("typical_difference", Some(self.typical_difference)),
            ("rmse", Some(self.rmse)),
            ("mean_ratio", Some(self.mean_ratio)),
            ("delta_e_2000.mean", Some(self.delta_e_2000.mean)),
            ("delta_e_2000.p95", Some(self.delta_e_2000.p95)),
            ("z.share", self.z.map(|z| z.fraction)),
            ("z.p", self.z.map(|z| z.p)),
            ("covered", self.covered.map(|covered| covered.fraction)),
            ("unknown_pixels", count(self.unknown_pixels)),
            ("pixels", count(self.pixels)),
            ("non_finite_pixels", count(self.non_finite_pixels)),
        ]
    }
}

impl Gate {
    /// Returns a sentence if the gate fails. A figure that is not a number fails every gate.
    /// Returns an input error if the figure is unknown, or if the pictures lack the error layers
    /// that it needs.
    pub fn failure(&self, comparison: &Comparison) -> Result<Option<String>> {
        let Self { figure, limit, fails } = self;
        let figures = comparison.figures();
        let names = figures.map(|(name, _)| name);
        let (_, value) = figures
            .into_iter()
            .find(|(name, _)| name == figure)
            .ok_or_else(|| Error::unknown_name("figure", figure, names).expected(names.join(", ")))?;
        let value = value.ok_or_else(|| {
            Error::input(format!("{figure} is unknown")).expected("pictures with error layers, as abbe renders them")
        })?;
        let (passes, side) = match fails {
            GateSide::Above => (value <= *limit, "above"),
            GateSide::Below => (value >= *limit, "below"),
        };
        Ok((!passes).then(|| format!("{figure} is {value:.6}, which is {side} the limit {limit}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::compare::compare;
    use crate::output::selection::Selection;
    use abbe_transport::sensor::Picture;

    fn comparison(ratio: f64) -> Comparison {
        let mut reference = Picture::black(4, 4);
        reference.xyz.fill([1.0; 3]);
        let mut picture = reference.clone();
        picture.xyz.fill([ratio; 3]);
        compare(&picture, &reference, &Selection::default()).unwrap()
    }

    fn failure(gate: (&str, f64, GateSide), ratio: f64) -> Option<String> {
        let (figure, limit, fails) = gate;
        Gate { figure: figure.to_string(), limit, fails }.failure(&comparison(ratio)).unwrap()
    }

    #[test]
    fn gates_fail_on_their_side_of_the_limit() {
        use GateSide::{Above, Below};
        assert_eq!(failure(("mean_ratio", 1.05, Above), 1.0), None);
        let text = failure(("mean_ratio", 1.05, Above), 1.1).unwrap();
        assert_eq!(text, "mean_ratio is 1.100000, which is above the limit 1.05");
        assert!(failure(("mean_ratio", 1.05, Below), 1.0).is_some() && failure(("pixels", 16.0, Below), 1.0).is_none());
        assert!(failure(("relative_mse", 1.0, Above), f64::NAN).is_some());
        assert!(failure(("mean_ratio", 1.0, Above), f64::NAN).is_some(), "NaN fails on both sides");
        assert!(failure(("mean_ratio", 1.0, Below), f64::NAN).is_some());
    }

    #[test]
    fn unknown_figures_are_refused() {
        let error = |figure: &str| {
            let gate = Gate { figure: figure.to_string(), limit: 1.0, fails: GateSide::Above };
            gate.failure(&comparison(1.0)).unwrap_err().to_string()
        };
        assert!(error("delta_e").contains("delta_e_2000.mean"), "{}", error("delta_e"));
        assert!(error("covered").contains("error layers"));
    }
}
