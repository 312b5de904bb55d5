//! Publishes the pictures of a render.

use super::channel::ViewChannel;
use crate::page::{LoadedScene, ScenePanels, Shown, Snapshot};
use abbe_session::render::{CoarsePicture, Run};
use abbe_transport::sensor::Picture;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The largest fraction of the render's time for published pictures. The first one may take more.
const LARGEST_FRACTION: f64 = 0.03;

/// The shortest time between two pictures of passes.
const SHORTEST_PAUSE: Duration = Duration::from_millis(250);

/// Publishes the pictures of one render. The pictures share the numbers of their view.
#[derive(Debug)]
pub(super) struct Publisher<'a> {
    channel: &'a ViewChannel,
    loaded: &'a LoadedScene,
    scene: Arc<ScenePanels>,
    /// The revision of the scene that is rendered.
    revision: u64,
    last: Option<Arc<Snapshot>>,
    schedule: PublicationSchedule,
}

impl<'a> Publisher<'a> {
    pub(super) fn new(
        channel: &'a ViewChannel,
        loaded: &'a LoadedScene,
        scene: Arc<ScenePanels>,
        revision: u64,
    ) -> Self {
        Self { channel, loaded, scene, revision, last: None, schedule: PublicationSchedule::new() }
    }

    pub(super) fn coarse(&self, coarse: &CoarsePicture) {
        self.channel.publish(self.revision, self.snapshot(Shown::Coarse(coarse.clone())));
    }

    /// Publishes a coarse picture while the reader moves a slider or the camera.
    pub(super) fn draft(&self, coarse: CoarsePicture) {
        self.channel.publish_draft(self.snapshot(Shown::Coarse(coarse)));
    }

    /// Publishes the picture of a run if it is due.
    pub(super) fn update(&mut self, run: &Run) {
        let start = Instant::now();
        if self.schedule.is_due(start) {
            self.publish(run, run.picture_with_denoised());
            self.schedule.published(start, start.elapsed());
        }
    }

    pub(super) fn publish(&mut self, run: &Run, picture: Picture) {
        if self.last.as_ref().is_none_or(|last| last.passes < run.passes()) {
            let snapshot = self.snapshot(Shown::Passes(picture, run));
            self.last = Some(Arc::clone(&snapshot));
            self.channel.publish(self.revision, snapshot);
        }
    }

    fn snapshot(&self, shown: Shown<'_>) -> Arc<Snapshot> {
        let number = self.channel.next_picture();
        let scene = (self.loaded, Arc::clone(&self.scene));
        Arc::new(Snapshot::of_render(number, scene, shown, self.last.as_deref()))
    }
}

/// The times of published pictures. The first picture is due at once.
#[derive(Debug, Clone, Copy)]
struct PublicationSchedule {
    start: Instant,
    next: Instant,
    /// The time that all pictures have taken.
    spent: Duration,
}

impl PublicationSchedule {
    fn new() -> Self {
        let start = Instant::now();
        Self { start, next: start, spent: Duration::ZERO }
    }

    fn is_due(&self, now: Instant) -> bool {
        now >= self.next
    }

    /// Notes a picture that took `cost`. The next one is due when all together, with another one,
    /// take at most [`LARGEST_FRACTION`] of the time.
    fn published(&mut self, begin: Instant, cost: Duration) {
        self.spent += cost;
        let end = begin + cost;
        let affordable = self.start + (self.spent + cost).div_f64(LARGEST_FRACTION);
        self.next = affordable.max(end + SHORTEST_PAUSE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_take_little_time() {
        let mut schedule = PublicationSchedule::new();
        let cost = Duration::from_millis(60);
        let (mut now, mut spent) = (schedule.start, Duration::ZERO);
        assert!(schedule.is_due(now), "the first picture comes at once");
        while now < schedule.start + Duration::from_secs(300) {
            if schedule.is_due(now) {
                schedule.published(now, cost);
                (now, spent) = (now + cost, spent + cost);
            }
            now += Duration::from_millis(10);
        }
        assert!((0.02..0.031).contains(&(spent.as_secs_f64() / 300.0)), "{spent:?}");
    }
}
