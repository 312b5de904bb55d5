//! The error of a render as a function of the number of passes.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::monitor::StudyMonitor;
use super::reference::{PictureError, ReferencePicture};
use abbe_session::render::{Monitor, Progress, Run};
use abbe_transport::sensor::Picture;
use abbe_transport::walk::StopFlag;
use serde::{Deserialize, Serialize};

/// The error of a render after some passes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConvergencePoint {
    pub passes: u64,
    /// The seconds of work so far, including the pilot and excluding the measurement of errors.
    pub seconds: f64,
    #[serde(rename = "wrong")]
    pub error: PictureError,
}

/// Measures the error after 1, 2, 4, 8 … passes, and after those in the scene's settings.
pub(super) struct ConvergenceMonitor<'a> {
    monitor: &'a mut (dyn StudyMonitor + Send),
    reference: Option<&'a ReferencePicture>,
    passes_wanted: u64,
    next_passes: u64,
    /// Seconds of work so far.
    seconds: f64,
    /// The total time of the measurements.
    pub(super) measuring: Duration,
    pub(super) points: Vec<ConvergencePoint>,
}

impl<'a> ConvergenceMonitor<'a> {
    pub(super) fn new(
        monitor: &'a mut (dyn StudyMonitor + Send),
        reference: Option<&'a ReferencePicture>,
        passes_wanted: u64,
    ) -> Self {
        let (seconds, measuring, points) = (0.0, Duration::ZERO, Vec::new());
        Self { monitor, reference, passes_wanted, next_passes: 1, seconds, measuring, points }
    }

    /// Records the error of a picture, unless one is known for this number of passes.
    pub(super) fn measure(&mut self, passes: u64, picture: &Picture) {
        let Some(reference) = self.reference else { return };
        if self.points.last().is_none_or(|last| last.passes < passes) {
            self.points.push(ConvergencePoint { passes, seconds: self.seconds, error: reference.error_of(picture) });
        }
    }
}

impl Monitor for ConvergenceMonitor<'_> {
    fn stop_flag(&self) -> Arc<StopFlag> {
        self.monitor.stop_flag()
    }

    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.seconds = (progress.elapsed.saturating_sub(self.measuring)).as_secs_f64();
        self.monitor.after_pass(progress)
    }

    fn checkpoint(&mut self, run: &mut Run) {
        let passes = run.passes();
        if self.reference.is_some() && (passes >= self.next_passes || passes == self.passes_wanted) {
            let begun = Instant::now();
            self.measure(passes, &run.picture());
            self.next_passes = (passes + 1).next_power_of_two();
            self.measuring += begun.elapsed();
        }
    }
}
