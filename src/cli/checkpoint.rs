//! Writes checkpoints during a render.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use abbe_session::output::file as files;
use abbe_session::output::metadata::{Metadata, names};
use abbe_session::render::{
    CoarseLevel, CoarsePicture, Job, Monitor, PassPart, Progress, RenderIdentity, Run, SavedRun,
};
use abbe_spectra::error::{Error, Result};
use abbe_transport::walk::StopFlag;

use super::preview::Preview;
use super::print;
use super::progress::ProgressDisplay;

/// The checkpoint file of a run, and the data for the header of this file.
#[derive(Debug)]
pub(crate) struct CheckpointFile<'a> {
    pub(crate) path: PathBuf,
    pub(crate) job: &'a Job,
    pub(crate) identity: &'a RenderIdentity,
    /// The header entries that describe the scene.
    pub(crate) metadata: &'a Metadata,
}

impl CheckpointFile<'_> {
    /// Returns the saved run if `resume` is set, and otherwise a new run.
    pub(crate) fn start(&self, part: PassPart, resume: bool) -> Result<Run> {
        if !resume {
            return Ok(Run::new(self.job, part));
        }
        if !self.path.exists() {
            let expected = "the checkpoint of an interrupted render, or one kept with --keep-checkpoint; \
                            `--resume auto` starts without one";
            return Err(Error::input("the checkpoint does not exist").expected(expected).in_file(&self.path));
        }
        SavedRun::resume(&self.path, self.job, self.identity, part)
    }

    pub(crate) fn write(&self, run: &Run) -> Result<()> {
        self.write_to(&self.path, run, self.metadata.clone())
    }

    /// Writes a run to the file `path`, with `metadata` in its header.
    pub(crate) fn write_to(&self, path: &Path, run: &Run, metadata: Metadata) -> Result<()> {
        let metadata = match metadata.get(names::PASSES) {
            Some(_) => metadata,
            None => metadata.with(names::PASSES, &run.passes().to_string()),
        };
        SavedRun::write(path, self.job, self.identity, run, metadata)
    }

    /// Writes the final checkpoint if `keep` is set, and removes the file otherwise.
    pub(crate) fn finish(&self, run: &Run, keep: bool) -> Result<()> {
        if keep { self.write(run) } else { files::remove_if_present(&self.path) }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CheckpointInterval {
    Fixed(Duration),
    /// The next checkpoint is written after a minute, or later if saving is slow.
    Automatic,
}

impl CheckpointInterval {
    /// Returns the time until the next checkpoint, if the last one took `duration`.
    fn pause(self, duration: Duration) -> Duration {
        /// The pause is at least `duration` multiplied by this number.
        const LEAST_RATIO: u32 = 20;
        match self {
            Self::Fixed(interval) => interval,
            Self::Automatic => Duration::from_secs(60).max(duration * LEAST_RATIO),
        }
    }
}

/// Shows the progress of a render, and writes its previews and checkpoints.
#[derive(Debug)]
pub(crate) struct RenderMonitor<'a> {
    pub(crate) display: ProgressDisplay,
    checkpoint: &'a CheckpointFile<'a>,
    pub(crate) preview: Preview<'a>,
    start: Instant,
    interval: CheckpointInterval,
    next: Instant,
    has_failed: bool,
}

impl<'a> RenderMonitor<'a> {
    pub(crate) fn new(
        display: ProgressDisplay,
        checkpoint: &'a CheckpointFile<'a>,
        preview: Preview<'a>,
        interval: CheckpointInterval,
    ) -> Self {
        let start = Instant::now();
        let next = start + interval.pause(Duration::ZERO);
        Self { display, checkpoint, preview, start, interval, next, has_failed: false }
    }
}

impl Monitor for RenderMonitor<'_> {
    fn stop_flag(&self) -> Arc<StopFlag> {
        self.display.stop_flag()
    }

    fn before_pilot(&mut self) {
        self.display.before_pilot();
    }

    fn coarse_levels(&self) -> &'static [CoarseLevel] {
        if self.preview.is_possible() { &[CoarseLevel::Sketch(1.0)] } else { &[] }
    }

    fn show_coarse_picture(&mut self, coarse: &CoarsePicture) {
        self.preview.show(&coarse.enlarged(), 0);
    }

    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.display.after_pass(progress)
    }

    fn checkpoint(&mut self, run: &mut Run) {
        self.preview.update(self.start, run);
        let begun = Instant::now();
        if begun < self.next {
            return;
        }
        if let Err(error) = self.checkpoint.write(run)
            && !self.has_failed
        {
            self.has_failed = true;
            print::remark(&format!("warning: the checkpoint cannot be written: {error}; the render continues"));
        }
        self.next = Instant::now() + self.interval.pause(begun.elapsed());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn automatic_checkpoints_take_little_time() {
        let seconds = Duration::from_secs;
        assert_eq!(CheckpointInterval::Automatic.pause(seconds(1)), seconds(60));
        assert_eq!(CheckpointInterval::Automatic.pause(seconds(10)), seconds(200));
        assert_eq!(CheckpointInterval::Fixed(seconds(5)).pause(seconds(10)), seconds(5));
    }
}
