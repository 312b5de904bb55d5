//! Progress reports of a render.

use super::forecast::Forecast;
use super::run::Run;
use abbe_transport::pilot::{CoarseLevel, CoarsePicture};
use abbe_transport::walk::StopFlag;
use std::sync::Arc;
use std::time::Duration;

/// The progress of a render after a pass.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// The number of passes done.
    pub passes: u64,
    /// The number of passes at which the render stops, or `None` without limit.
    pub passes_wanted: Option<u64>,
    /// The time of the run so far, without that between an interruption and the continuation.
    pub elapsed: Duration,
    /// The time at which the render stops, or `None` if the time is not limited.
    pub time_wanted: Option<Duration>,
    /// The mean number of photons per second so far.
    pub photons_per_second: f64,
    /// The root mean square error, divided by the mean luminance, at the last measurement.
    pub relative_error: Option<f64>,
    /// The relative error of a typical pixel at the last measurement.
    pub typical_error: Option<f64>,
    /// The error of a typical pixel at which the render stops, or `None` if no stop rule sets a
    /// target error.
    pub error_wanted: Option<f64>,
    /// The forecast of the typical error at the last measurement.
    pub forecast: Option<Forecast>,
}

/// Observes a render, and may end it.
pub trait Monitor {
    /// Returns a flag that another thread may raise to end the render before the pilot or a pass is
    /// done. The unfinished pass is discarded, so the result is that of the last whole pass.
    fn stop_flag(&self) -> Arc<StopFlag> {
        Arc::default()
    }

    fn before_pilot(&mut self) {}

    /// Returns the levels of the coarse pictures that the monitor shows before pass 0. A sketch
    /// costs little, and the others together at most as much as a pass.
    fn coarse_levels(&self) -> &'static [CoarseLevel] {
        &[]
    }

    /// Receives a coarse picture. Small films have none, and the path tracer has only a sketch.
    fn show_coarse_picture(&mut self, _coarse: &CoarsePicture) {}

    /// Receives the progress after each pass. Returns false to end the render.
    fn after_pass(&mut self, progress: &Progress) -> bool;

    /// Receives the run after each pass except the last one, and may save the run, or move its
    /// passes elsewhere.
    fn checkpoint(&mut self, _run: &mut Run) {}
}

/// A monitor that ignores all progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoMonitor;

impl Monitor for NoMonitor {
    fn after_pass(&mut self, _: &Progress) -> bool {
        true
    }
}
