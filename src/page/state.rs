//! Holds what the page shows besides the pixels: the state of the session, its progress and its
//! faults.

use super::scene_panels::ScenePanels;
use super::snapshot::Snapshot;
#[cfg(feature = "view")]
use abbe_session::render::Progress;
use serde_json::{Value, json};
use std::sync::Arc;
#[cfg(feature = "view")]
use std::time::Duration;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SessionState {
    Starting,
    /// The session renders passes.
    Rendering,
    Finished,
    /// The scene has a fault. The last picture stays.
    Failed,
}

impl SessionState {
    fn word(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Rendering => "rendering",
            Self::Finished => "finished",
            Self::Failed => "failed",
        }
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ViewProgress {
    pub(crate) passes: u64,
    pub(crate) passes_wanted: Option<u64>,
    /// The time of the render without pauses in s.
    pub(crate) elapsed_s: f64,
    pub(crate) photons_per_second: f64,
    pub(crate) relative_error: Option<f64>,
    /// The relative error of a typical pixel.
    pub(crate) typical_error: Option<f64>,
}

impl ViewProgress {
    #[cfg(feature = "view")]
    pub(crate) fn new(progress: &Progress, paused: Duration) -> Self {
        let total_s = progress.elapsed.as_secs_f64();
        let elapsed_s = (total_s - paused.as_secs_f64()).max(1e-3);
        Self {
            passes: progress.passes,
            passes_wanted: progress.passes_wanted,
            elapsed_s,
            photons_per_second: progress.photons_per_second * total_s / elapsed_s,
            relative_error: progress.relative_error,
            typical_error: progress.typical_error,
        }
    }

    /// Returns the time until the last pass in s, or `None` if it is unknown.
    fn left_s(&self) -> Option<f64> {
        let left = self.passes_wanted?.saturating_sub(self.passes);
        (self.passes > 0).then(|| self.elapsed_s / self.passes as f64 * left as f64)
    }
}

#[derive(Debug, Clone)]
pub(crate) struct PageState {
    pub(crate) session: SessionState,
    pub(crate) progress: ViewProgress,
    pub(crate) error: Option<String>,
    pub(crate) scene: Option<Arc<ScenePanels>>,
    pub(crate) snapshot: Option<Arc<Snapshot>>,
    /// The picture with which the page compares the published one.
    pub(crate) reference: Option<Arc<Snapshot>>,
}

impl Default for PageState {
    fn default() -> Self {
        Self {
            session: SessionState::Starting,
            progress: ViewProgress::default(),
            error: None,
            scene: None,
            snapshot: None,
            reference: None,
        }
    }
}

impl PageState {
    /// Begins the render of a scene, or shows a saved picture. The last picture stays.
    pub(crate) fn begin(&mut self, scene: Arc<ScenePanels>) {
        (self.session, self.progress) = (SessionState::Starting, ViewProgress::default());
        (self.error, self.scene) = (None, Some(scene));
    }

    /// Keeps the published picture as the reference, unless it is coarse.
    pub(crate) fn keep_as_reference(&mut self) {
        if let Some(snapshot) = self.snapshot.as_ref().filter(|snapshot| snapshot.metadata.is_some()) {
            self.reference = Some(Arc::clone(snapshot));
        }
    }

    /// Returns the state for the page. `version` counts its changes.
    pub(crate) fn to_json(&self, version: u64) -> Value {
        let Self { session, progress, error, scene, snapshot, reference } = self;
        json!({
            "version": version,
            "session": session.word(),
            "error": error,
            "scene": scene.as_ref().map(|scene| scene.number),
            "passes": progress.passes,
            "passes_wanted": progress.passes_wanted,
            "elapsed_s": progress.elapsed_s,
            "left_s": progress.left_s(),
            "photons_per_second": progress.photons_per_second,
            "relative_error": progress.relative_error,
            "typical_error": progress.typical_error,
            "picture": snapshot.as_ref().map(|snapshot| snapshot.summary()),
            "reference": reference.as_ref().map(|reference| reference.reference_summary()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_counts_no_pauses() {
        let progress = ViewProgress { passes: 4, passes_wanted: Some(6), elapsed_s: 8.0, ..ViewProgress::default() };
        assert_eq!(progress.left_s(), Some(4.0));
        assert_eq!(ViewProgress { passes: 0, ..progress }.left_s(), None);
    }
}
