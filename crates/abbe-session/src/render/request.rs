//! The user's choice of the integrator and the stop rules of a render.

use abbe_transport::plan::Budget;
use std::time::Duration;

/// The algorithm that solves the light transport.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integrator {
    /// Photon mapping.
    #[default]
    Photon,
    /// The reference path tracer.
    Path,
}

impl Integrator {
    /// Returns the name of the integrator: `photon` or `path`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Photon => "photon",
            Self::Path => "path",
        }
    }
}

/// The render stops by the first rule, or by the passes of the budget without any rule.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StopRules {
    pub passes: Option<u64>,
    pub time: Option<Duration>,
    /// Stop if the relative error of a typical pixel is at most this value.
    pub target_error: Option<f64>,
}

impl StopRules {
    /// Returns the number of passes above `passes` after which a target error may next end the
    /// render: fixed numbers, so that the result does not depend on the speed of the machine, with
    /// at least two passes per replicate to estimate the noise.
    pub fn next_decision(passes: u64) -> u64 {
        (passes + 1).next_multiple_of(8).max(16)
    }

    /// Returns the passes at which the whole picture stops, or `None` without limit.
    pub fn passes_wanted(&self, budget: &Budget) -> Option<u64> {
        let by_default = self.time.is_none() && self.target_error.is_none();
        self.passes.or(by_default.then_some(budget.passes))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Request {
    pub integrator: Integrator,
    pub stop: StopRules,
}
