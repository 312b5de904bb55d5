//! Checkpoints while a render goes on.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use abbe::error::{Error, Result};
use abbe::output::file as files;
use abbe::output::metadata::{Metadata, names};
use abbe::render::{Identity, Job, Monitor, Part, Progress, Run, Saved};

use super::print;
use super::progress::Display;

/// Where a run is saved, and what is said of it.
#[derive(Debug)]
pub(crate) struct Checkpoint<'a> {
    pub(crate) path: PathBuf,
    pub(crate) job: &'a Job,
    pub(crate) identity: &'a Identity,
    /// What the header says of the scene.
    pub(crate) metadata: &'a Metadata,
}

impl Checkpoint<'_> {
    /// The run to begin with: the saved one, or a new one.
    pub(crate) fn start(&self, part: Part, resume: bool) -> Result<Run> {
        if !resume {
            return Ok(Run::new(self.job, part));
        }
        if !self.path.exists() {
            let expected = "that of a render that was interrupted, or kept by --keep-checkpoint";
            return Err(Error::input("there is no checkpoint to resume").expected(expected).in_file(&self.path));
        }
        Saved::resume(&self.path, self.job, self.identity, part)
    }

    /// Saves a run in the checkpoint's file.
    pub(crate) fn write(&self, run: &Run) -> Result<()> {
        self.write_to(&self.path, run, self.metadata.clone())
    }

    /// Saves a run in another file, with what its header is to say.
    pub(crate) fn write_to(&self, path: &Path, run: &Run, metadata: Metadata) -> Result<()> {
        let metadata = match metadata.get(names::PASSES) {
            Some(_) => metadata,
            None => metadata.with(names::PASSES, &run.passes().to_string()),
        };
        Saved::write(path, self.job, self.identity, run, metadata)
    }

    /// After the picture: the checkpoint is kept if asked for, or if it is still needed.
    pub(crate) fn end(&self, run: &Run, keep: bool) -> Result<()> {
        if keep { self.write(run) } else { files::remove_if_present(&self.path) }
    }
}

/// How often a run is saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rhythm {
    /// As someone has asked for; whatever it costs.
    Every(Duration),
    /// After a minute, or more where saving is slow.
    Sparing,
}

impl Rhythm {
    /// How long to wait after saving took `took`.
    fn pause(self, took: Duration) -> Duration {
        /// Saving may take one part in this many of the time.
        const PARTS: u32 = 20;
        match self {
            Self::Every(every) => every,
            Self::Sparing => Duration::from_secs(60).max(took * PARTS),
        }
    }
}

/// Shows how a render is going, and saves it now and then.
#[derive(Debug)]
pub(crate) struct Watch<'a> {
    pub(crate) display: Display,
    checkpoint: &'a Checkpoint<'a>,
    rhythm: Rhythm,
    next: Instant,
    has_failed: bool,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(display: Display, checkpoint: &'a Checkpoint<'a>, rhythm: Rhythm) -> Self {
        let next = Instant::now() + rhythm.pause(Duration::ZERO);
        Self { display, checkpoint, rhythm, next, has_failed: false }
    }
}

impl Monitor for Watch<'_> {
    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.display.after_pass(progress)
    }

    fn keep(&mut self, run: &Run) {
        let begun = Instant::now();
        if begun < self.next {
            return;
        }
        if let Err(error) = self.checkpoint.write(run)
            && !self.has_failed
        {
            self.has_failed = true;
            print::remark(&format!("warning: no checkpoint: {error}; rendering goes on"));
        }
        self.next = Instant::now() + self.rhythm.pause(begun.elapsed());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saving_takes_a_small_share_of_the_time_unless_someone_asks_for_more() {
        let seconds = Duration::from_secs;
        assert_eq!(Rhythm::Sparing.pause(seconds(1)), seconds(60));
        assert_eq!(Rhythm::Sparing.pause(seconds(10)), seconds(200));
        assert_eq!(Rhythm::Every(seconds(5)).pause(seconds(10)), seconds(5));
    }
}
