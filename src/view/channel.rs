//! The state that the session, the server and the watch thread share.

use super::host::LoadedScene;
use super::scene_panels::ScenePanels;
use super::snapshot::Snapshot;
use abbe_session::render::Progress;
use abbe_transport::walk::StopFlag;
use serde_json::{Value, json};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Orders {
    /// Counts the changes of the scene: of its file, and by the page.
    pub(super) revision: u64,
    /// True if the render waits.
    pub(super) paused: bool,
    /// Changes of the scene in the form `PATH=JSON`.
    pub(super) changes: Vec<String>,
    /// The names of forbidden effects.
    pub(super) forbidden: Vec<String>,
    /// True while the reader moves a slider or the camera, when only coarse pictures are rendered.
    pub(super) is_draft: bool,
    /// Counts the wishes for more passes.
    pub(super) extensions: u64,
    /// True if the user interrupted the program.
    pub(super) interrupted: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SessionState {
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
pub(super) struct ViewProgress {
    pub(super) passes: u64,
    pub(super) passes_wanted: Option<u64>,
    /// The time of the render without pauses in s.
    pub(super) elapsed_s: f64,
    pub(super) photons_per_second: f64,
    pub(super) relative_error: Option<f64>,
    /// The relative error of a typical pixel.
    pub(super) typical_error: Option<f64>,
}

impl ViewProgress {
    pub(super) fn new(progress: &Progress, paused: Duration) -> Self {
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
struct ViewState {
    orders: Orders,
    /// Ends the render of this revision of the scene.
    stop: (u64, Arc<StopFlag>),
    session: SessionState,
    progress: ViewProgress,
    error: Option<String>,
    scene: Option<Arc<ScenePanels>>,
    /// The scene that is rendered, or `None` if a saved picture is shown.
    loaded: Option<Arc<LoadedScene>>,
    snapshot: Option<Arc<Snapshot>>,
    /// The picture with which the page compares the published one.
    reference: Option<Arc<Snapshot>>,
}

impl ViewState {
    fn stop_if_over(&self) {
        let (revision, flag) = &self.stop;
        if self.orders.interrupted || self.orders.revision != *revision {
            flag.raise();
        }
    }
}

/// The state that the threads share. Each lock is held only for a short time.
#[derive(Debug)]
pub(super) struct ViewChannel {
    state: Mutex<ViewState>,
    /// Wakes the session.
    changed: Condvar,
    /// Counts the changes that the page should see.
    version: watch::Sender<u64>,
}

impl ViewChannel {
    pub(super) fn new() -> Self {
        let state = ViewState {
            orders: Orders::default(),
            stop: (0, Arc::default()),
            session: SessionState::Starting,
            progress: ViewProgress::default(),
            error: None,
            scene: None,
            loaded: None,
            snapshot: None,
            reference: None,
        };
        Self { state: Mutex::new(state), changed: Condvar::new(), version: watch::Sender::new(1) }
    }

    /// No thread leaves the state inconsistent, so a panic elsewhere does not matter here.
    fn lock(&self) -> MutexGuard<'_, ViewState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn update(&self, change: impl FnOnce(&mut ViewState)) {
        change(&mut self.lock());
        self.version.send_modify(|version| *version += 1);
    }

    pub(super) fn order(&self, change: impl FnOnce(&mut Orders)) {
        self.update(|state| {
            change(&mut state.orders);
            state.stop_if_over();
        });
        self.changed.notify_all();
    }

    /// Returns the flag that ends the render of a revision if the scene changes or the user
    /// interrupts.
    pub(super) fn stop_flag(&self, revision: u64) -> Arc<StopFlag> {
        let mut state = self.lock();
        state.stop = (revision, Arc::default());
        state.stop_if_over();
        Arc::clone(&state.stop.1)
    }

    pub(super) fn scene_file_changed(&self) {
        self.order(|orders| orders.revision += 1);
    }

    pub(super) fn interrupt(&self) {
        self.order(|orders| orders.interrupted = true);
    }

    pub(super) fn orders(&self) -> Orders {
        self.lock().orders.clone()
    }

    /// Waits until `is_done` is true, or until the time is over. Returns the last orders.
    pub(super) fn wait(&self, limit: Option<Duration>, is_done: impl Fn(&Orders) -> bool) -> Orders {
        let end = limit.map(|limit| Instant::now() + limit);
        let mut state = self.lock();
        while !is_done(&state.orders) {
            let Some(end) = end else {
                state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            state = self.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0;
        }
        state.orders.clone()
    }

    /// Begins the render of a scene, or shows a saved picture.
    pub(super) fn begin(&self, scene: Arc<ScenePanels>, loaded: Option<Arc<LoadedScene>>) {
        self.update(|state| {
            state.session = SessionState::Starting;
            state.progress = ViewProgress::default();
            (state.error, state.scene, state.loaded) = (None, Some(scene), loaded);
        });
    }

    /// Reports a fault of the scene. The last picture stays.
    pub(super) fn fail(&self, revision: u64, error: String) {
        self.update(|state| {
            if state.orders.revision == revision {
                (state.session, state.error) = (SessionState::Failed, Some(error));
            }
        });
    }

    /// Reports the progress of the render of a revision. The channel ignores abandoned renders.
    pub(super) fn report(&self, revision: u64, session: SessionState, progress: ViewProgress) {
        self.update(|state| {
            if state.orders.revision == revision {
                (state.session, state.progress) = (session, progress);
            }
        });
    }

    /// Publishes a coarse picture while the reader moves a slider, also if it moved on.
    pub(super) fn publish_draft(&self, snapshot: Arc<Snapshot>) {
        self.update(|state| state.snapshot = Some(snapshot));
    }

    /// Publishes a picture of a revision. The channel ignores abandoned renders.
    pub(super) fn publish(&self, revision: u64, snapshot: Arc<Snapshot>) {
        self.update(|state| {
            if state.orders.revision == revision {
                state.snapshot = Some(snapshot);
            }
        });
    }

    pub(super) fn snapshot(&self) -> Option<Arc<Snapshot>> {
        self.lock().snapshot.clone()
    }

    /// Sets the picture with which the page compares the published one.
    pub(super) fn set_reference(&self, reference: Arc<Snapshot>) {
        self.update(|state| state.reference = Some(reference));
    }

    /// Keeps the published picture as the reference, unless it is coarse.
    pub(super) fn keep_as_reference(&self) {
        self.update(|state| {
            if let Some(snapshot) = state.snapshot.as_ref().filter(|snapshot| snapshot.metadata.is_some()) {
                state.reference = Some(Arc::clone(snapshot));
            }
        });
    }

    pub(super) fn reference(&self) -> Option<Arc<Snapshot>> {
        self.lock().reference.clone()
    }

    pub(super) fn loaded(&self) -> Option<(Arc<LoadedScene>, u64)> {
        let state = self.lock();
        Some((state.loaded.clone()?, state.scene.as_ref()?.number))
    }

    pub(super) fn scene(&self) -> Option<Arc<ScenePanels>> {
        self.lock().scene.clone()
    }

    pub(super) fn versions(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    pub(super) fn to_json(&self) -> Value {
        // A change after this line has a newer version, so the page asks again.
        let version = *self.version.borrow();
        // The summaries take time for large pictures, and the render must not wait for them.
        let ViewState { orders, session, progress, error, scene, snapshot, reference, .. } = self.lock().clone();
        json!({
            "version": version,
            "session": session.word(),
            "paused": orders.paused,
            "draft": orders.is_draft,
            "changes": orders.changes,
            "forbidden": orders.forbidden,
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
    fn orders_wake_a_waiting_session() {
        let channel = Arc::new(ViewChannel::new());
        let other = Arc::clone(&channel);
        let waiting = std::thread::spawn(move || other.wait(None, |orders| orders.revision > 0).revision);
        channel.scene_file_changed();
        assert_eq!(waiting.join().unwrap(), 1);
        let orders = channel.wait(Some(Duration::from_millis(1)), |orders| orders.interrupted);
        assert!(!orders.interrupted);
        assert!(*channel.versions().borrow() > 1);
    }

    #[test]
    fn the_time_left_counts_no_pauses() {
        let progress = ViewProgress { passes: 4, passes_wanted: Some(6), elapsed_s: 8.0, ..ViewProgress::default() };
        assert_eq!(progress.left_s(), Some(4.0));
        assert_eq!(ViewProgress { passes: 0, ..progress }.left_s(), None);
    }
}
