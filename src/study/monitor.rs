//! The observer of a study, and the reasons for an early stop of a study.

use abbe_session::render::Monitor;
use abbe_spectra::error::Error;

/// Receives the progress of a study: its steps, and the passes of each render.
pub trait StudyMonitor: Monitor {
    /// A step begins. The step ends immediately if its result is cached.
    fn begin(&mut self, step: &str, cached: bool);
}

/// The reason for the early stop of a study.
#[derive(Debug)]
pub(super) enum StudyError {
    Interrupted,
    Failed(Error),
}

impl From<Error> for StudyError {
    fn from(error: Error) -> Self {
        Self::Failed(error)
    }
}
