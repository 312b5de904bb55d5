//! The size of a pass: a time limit makes passes smaller, so that enough of them fit.

use web_time::Instant;

/// The passes that have to fit into a time limit: eight give error bars, and the rest is for the
/// end of the pilot and for writing the picture.
const PASSES: f64 = 9.5;

/// The limit on the work of a pass.
#[derive(Debug, Clone, Copy)]
pub enum PassSize {
    /// The pilot chooses the size without regard to time.
    Free,
    /// At most this work in instructions, which a limited pilot has found before. A continued run
    /// has the passes of its beginning.
    AtMost(f64),
    /// At least eight passes end at this time. The size depends on the speed of the machine.
    Until(Instant),
}

impl PassSize {
    /// Returns the largest work of a pass in instructions. `speed` measures the instructions per
    /// second.
    pub(super) fn largest_work(self, speed: impl FnOnce() -> f64) -> f64 {
        match self {
            Self::Free => f64::INFINITY,
            Self::AtMost(work) => work,
            Self::Until(end) => speed() * end.saturating_duration_since(Instant::now()).as_secs_f64() / PASSES,
        }
    }

    pub(super) fn is_limited(self) -> bool {
        !matches!(self, Self::Free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_speed_of_the_machine_and_the_time_limit_the_work() {
        assert_eq!(PassSize::Free.largest_work(|| 1e9), f64::INFINITY);
        assert_eq!(PassSize::AtMost(7e8).largest_work(|| 1e9), 7e8);
        let until = PassSize::Until(Instant::now() + Duration::from_secs(95));
        assert!((until.largest_work(|| 1e9) / 1e10 - 1.0).abs() < 0.1);
        assert_eq!(PassSize::Until(Instant::now()).largest_work(|| 1e9), 0.0);
    }
}
