//! The state that the session, the server and the watch thread share.

use super::examples::Example;
use crate::page::{LoadedScene, PageState, ScenePanels, SessionState, Snapshot, ViewProgress};
use abbe_transport::walk::StopFlag;
use serde_json::{Value, json};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Orders {
    /// Counts the changes of the scene: of its file, and by the page.
    pub(super) revision: u64,
    /// The example that the reader chose.
    pub(super) example: Option<&'static Example>,
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

#[derive(Debug, Clone)]
struct ViewState {
    orders: Orders,
    /// Ends the render of this revision of the scene.
    stop: (u64, Arc<StopFlag>),
    page: PageState,
    /// The scene that is rendered, or `None` if a saved picture is shown.
    loaded: Option<Arc<LoadedScene>>,
    /// The number of rendered pictures.
    pictures: u64,
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
    /// True if the reader chooses among the examples.
    has_examples: bool,
}

impl ViewChannel {
    pub(super) fn new(has_examples: bool) -> Self {
        let state = ViewState {
            orders: Orders::default(),
            stop: (0, Arc::default()),
            page: PageState::default(),
            loaded: None,
            pictures: 0,
        };
        let version = watch::Sender::new(1);
        Self { state: Mutex::new(state), changed: Condvar::new(), version, has_examples }
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

    pub(super) fn has_examples(&self) -> bool {
        self.has_examples
    }

    /// Opens an example without the changes and the pictures of the last one. Does nothing if it is
    /// open.
    pub(super) fn open(&self, example: &'static Example) {
        self.update(|state| {
            if state.orders.example == Some(example) {
                return;
            }
            let Orders { revision, extensions, interrupted, .. } = state.orders;
            let example = Some(example);
            state.orders = Orders { revision: revision + 1, example, extensions, interrupted, ..Orders::default() };
            (state.page, state.loaded) = (PageState::default(), None);
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
            state.page.begin(scene);
            state.loaded = loaded;
        });
    }

    /// Reports a fault of the scene. The last picture stays.
    pub(super) fn fail(&self, revision: u64, error: String) {
        self.update(|state| {
            if state.orders.revision == revision {
                (state.page.session, state.page.error) = (SessionState::Failed, Some(error));
            }
        });
    }

    /// Reports the progress of the render of a revision. The channel ignores abandoned renders.
    pub(super) fn report(&self, revision: u64, session: SessionState, progress: ViewProgress) {
        self.update(|state| {
            if state.orders.revision == revision {
                (state.page.session, state.page.progress) = (session, progress);
            }
        });
    }

    /// Publishes a coarse picture while the reader moves a slider, also if it moved on.
    pub(super) fn publish_draft(&self, snapshot: Arc<Snapshot>) {
        self.update(|state| state.page.snapshot = Some(snapshot));
    }

    /// Publishes a picture of a revision. The channel ignores abandoned renders.
    pub(super) fn publish(&self, revision: u64, snapshot: Arc<Snapshot>) {
        self.update(|state| {
            if state.orders.revision == revision {
                state.page.snapshot = Some(snapshot);
            }
        });
    }

    /// Returns the number of a new picture.
    pub(super) fn next_picture(&self) -> u64 {
        let mut state = self.lock();
        state.pictures += 1;
        state.pictures
    }

    /// Sets the picture with which the page compares the published one.
    pub(super) fn set_reference(&self, reference: Arc<Snapshot>) {
        self.update(|state| state.page.reference = Some(reference));
    }

    /// Keeps the published picture as the reference, unless it is coarse.
    pub(super) fn keep_as_reference(&self) {
        self.update(|state| state.page.keep_as_reference());
    }

    pub(super) fn page(&self) -> PageState {
        self.lock().page.clone()
    }

    pub(super) fn loaded(&self) -> Option<(Arc<LoadedScene>, u64)> {
        let state = self.lock();
        Some((state.loaded.clone()?, state.page.scene.as_ref()?.number))
    }

    pub(super) fn scene(&self) -> Option<Arc<ScenePanels>> {
        self.lock().page.scene.clone()
    }

    pub(super) fn versions(&self) -> watch::Receiver<u64> {
        self.version.subscribe()
    }

    pub(super) fn to_json(&self) -> Value {
        // A change after this line has a newer version, so the page asks again.
        let version = *self.version.borrow();
        // The summaries take time for large pictures, and the render must not wait for them.
        let ViewState { orders, page, .. } = self.lock().clone();
        let mut json = page.to_json(version);
        json["paused"] = json!(orders.paused);
        json["draft"] = json!(orders.is_draft);
        json["changes"] = json!(orders.changes);
        json["forbidden"] = json!(orders.forbidden);
        json["has_examples"] = json!(self.has_examples);
        json["example"] = json!(orders.example.map(|example| example.name));
        json
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_wake_a_waiting_session() {
        let channel = Arc::new(ViewChannel::new(false));
        let other = Arc::clone(&channel);
        let waiting = std::thread::spawn(move || other.wait(None, |orders| orders.revision > 0).revision);
        channel.scene_file_changed();
        assert_eq!(waiting.join().unwrap(), 1);
        let orders = channel.wait(Some(Duration::from_millis(1)), |orders| orders.interrupted);
        assert!(!orders.interrupted);
        assert!(*channel.versions().borrow() > 1);
    }

    #[test]
    fn an_example_opens_without_the_changes_of_the_last_one() {
        let channel = ViewChannel::new(true);
        let open = |name: &str| channel.open(Example::named(name).unwrap());
        open("prism");
        channel.order(|orders| orders.changes = vec!["film.width=3".to_string()]);
        let before = channel.orders();
        open("prism");
        assert_eq!(channel.orders(), before, "it is open");
        open("grating");
        let after = channel.orders();
        assert_eq!((after.revision, after.changes.len()), (before.revision + 1, 0));
    }
}
