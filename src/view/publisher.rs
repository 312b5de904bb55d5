//! Publishes the pictures of a render.

use super::channel::ViewChannel;
use super::host::LoadedScene;
use super::layers;
use super::scene_panels::ScenePanels;
use super::snapshot::{BandNoise, Snapshot};
use crate::api::provenance;
use abbe_session::render::Run;
use abbe_transport::plan::EffectState;
use abbe_transport::sensor::Picture;
use std::sync::{Arc, OnceLock};
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

    pub(super) fn coarse(&self, picture: &Picture) {
        self.channel.publish(self.revision, self.snapshot(picture.clone(), None));
    }

    /// Publishes a coarse picture while the reader moves a slider or the camera.
    pub(super) fn draft(&self, picture: &Picture) {
        self.channel.publish_draft(self.snapshot(picture.clone(), None));
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
            let snapshot = self.snapshot(picture, Some(run));
            self.last = Some(Arc::clone(&snapshot));
            self.channel.publish(self.revision, snapshot);
        }
    }

    fn snapshot(&self, picture: Picture, run: Option<&Run>) -> Arc<Snapshot> {
        let (job, scene) = (&self.loaded.job, Arc::clone(&self.scene));
        let number = self.channel.snapshot().map_or(1, |snapshot| snapshot.number + 1);
        let metadata = run.map(|run| {
            let of_scene = &self.loaded.metadata;
            let metadata = provenance::of_passes(of_scene, run.passes(), &run.ledger_stats(job), run.seconds());
            provenance::reproducible(metadata)
        });
        let events = run.map(|run| run.effect_stats(job)).unwrap_or_default();
        let passes = run.map_or(0, Run::passes);
        Arc::new(Snapshot {
            number,
            name: self.loaded.source.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            passes,
            exposure: scene.display.factor(&picture),
            reaches: scene.reaches(&picture),
            band_noise: self.band_noise(&picture, passes),
            without: self.forbidden(),
            mean_y: picture.mean_y(),
            comparison_exposure: OnceLock::new(),
            class_means: layers::class_means(&picture),
            effort: run.map(|run| (run.stage_seconds(), run.ledger_stats(job))),
            events: events.into_iter().map(|(name, effect)| (name, effect.events)).collect(),
            metadata,
            xyz_bytes: OnceLock::new(),
            scene,
            picture,
        })
    }

    fn forbidden(&self) -> Vec<&'static str> {
        let rows = self.loaded.job.rows.iter();
        rows.filter(|row| row.state == EffectState::Forbidden).map(|row| row.effect.name).collect()
    }

    fn band_noise(&self, picture: &Picture, passes: u64) -> Option<BandNoise> {
        let after = &picture.bands.as_ref()?.values;
        match self.last.as_ref().and_then(|last| Some((last.band_noise.as_ref()?, last.picture.bands.as_ref()?))) {
            Some((noise, before)) => Some(noise.next(&before.values, after, passes)),
            None => Some(BandNoise::first(passes, after.len())),
        }
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
