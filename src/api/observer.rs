//! Observers of a render.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Image;
use abbe_session::output::file;
use abbe_session::output::metadata::{Metadata, names};
use abbe_session::render::{Job, Monitor, PassPart, Progress, RenderIdentity, Rendered, Request, Run, SavedRun};
use abbe_spectra::error::{Error, Result};
use abbe_transport::plan::Budget;
use abbe_transport::walk::StopFlag;

/// Observes a render, and may stop it.
pub trait RenderObserver: Send {
    /// Receives the planned budget before the render starts.
    ///
    /// # Errors
    /// An error refuses the render.
    fn planned(&mut self, _budget: &Budget) -> Result<()> {
        Ok(())
    }

    /// Returns a flag that another thread may raise to stop the render at once. The unfinished pass
    /// is discarded, and the image contains the whole passes, which may be none.
    fn stop_flag(&self) -> Arc<StopFlag> {
        Arc::default()
    }

    /// Receives the progress after each pass. Returns [`ControlFlow::Break`] to stop the render.
    fn after_pass(&mut self, progress: &Progress) -> ControlFlow<()>;

    /// Receives the unfinished render after each pass except the last one.
    fn show(&mut self, _unfinished: &UnfinishedRender<'_>) {}
}

/// An observer that only reports the progress to a function.
pub(super) struct ProgressFunction<F>(pub(super) F);

impl<F: FnMut(&Progress) -> ControlFlow<()> + Send> RenderObserver for ProgressFunction<F> {
    fn after_pass(&mut self, progress: &Progress) -> ControlFlow<()> {
        (self.0)(progress)
    }
}

/// A render between two passes.
#[derive(Debug)]
pub struct UnfinishedRender<'a> {
    job: &'a Job,
    run: &'a Run,
    metadata: &'a Metadata,
    progress: Progress,
}

impl UnfinishedRender<'_> {
    /// The progress after the last pass.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Develops the image of the passes so far. The image has no statistics.
    pub fn image(&self) -> Image {
        let metadata = self.metadata.clone().with(names::PREVIEW, "true");
        let metadata = metadata.with(names::PASSES, &self.run.passes().to_string());
        Image::of_run(self.run, self.job, metadata)
    }
}

pub(super) struct Checkpoint<'a> {
    pub(super) path: &'a Path,
    pub(super) resume: bool,
}

/// Renders a job. `metadata` contains the header entries that describe the scene.
///
/// # Errors
/// Returns the errors of [`Job::continue_run`], and an error if the checkpoint cannot be read or
/// cannot be written at the end.
pub(super) fn render(
    job: &Job,
    request: Request,
    metadata: &Metadata,
    checkpoint: Option<Checkpoint<'_>>,
    observer: &mut dyn RenderObserver,
) -> Result<Rendered> {
    let identity = RenderIdentity::of(job, request.integrator, metadata);
    let saver = checkpoint.as_ref().map(|checkpoint| RunSaver { path: checkpoint.path, job, identity, metadata });
    let begin = match (&saver, &checkpoint) {
        (Some(saver), Some(Checkpoint { path, resume: true })) if path.exists() => {
            SavedRun::resume(path, job, &saver.identity, PassPart::WHOLE)?
        }
        _ => Run::new(job, PassPart::WHOLE),
    };
    if let Some(saver) = &saver {
        file::check_writable(saver.path)?;
    }
    let next = Instant::now() + SHORTEST_PAUSE;
    let mut monitor =
        ObserverMonitor { observer, job, metadata, saver: saver.as_ref(), progress: None, next, failed: None };
    let mut rendered = job.continue_run(request, begin, &mut monitor)?;
    let note = |error: &Error| format!("a checkpoint could not be written during the render: {error}");
    rendered.stats.notes.extend(monitor.failed.as_ref().map(note));
    match &saver {
        Some(_) if rendered.stats.passes == 0 => {}
        Some(saver) if rendered.interrupted => saver.save(&rendered.run)?,
        Some(saver) => file::remove_if_present(saver.path)?,
        None => {}
    }
    Ok(rendered)
}

/// The least time between two checkpoints.
const SHORTEST_PAUSE: Duration = Duration::from_secs(60);

/// The pause between two checkpoints is at least this multiple of the time for saving.
const LEAST_RATIO: u32 = 20;

/// Saves the sums of a run.
struct RunSaver<'a> {
    path: &'a Path,
    job: &'a Job,
    identity: RenderIdentity,
    metadata: &'a Metadata,
}

impl RunSaver<'_> {
    fn save(&self, run: &Run) -> Result<()> {
        let metadata = self.metadata.clone().with(names::PASSES, &run.passes().to_string());
        SavedRun::write(self.path, self.job, &self.identity, run, metadata)
    }
}

/// Passes the events of a render on to an observer, and writes checkpoints.
struct ObserverMonitor<'a> {
    observer: &'a mut dyn RenderObserver,
    job: &'a Job,
    metadata: &'a Metadata,
    saver: Option<&'a RunSaver<'a>>,
    progress: Option<Progress>,
    /// The time of the next checkpoint.
    next: Instant,
    /// The failure of the last checkpoint. The render continues, and it writes the next checkpoint
    /// later.
    failed: Option<Error>,
}

impl Monitor for ObserverMonitor<'_> {
    fn stop_flag(&self) -> Arc<StopFlag> {
        self.observer.stop_flag()
    }

    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.progress = Some(*progress);
        self.observer.after_pass(progress).is_continue()
    }

    fn checkpoint(&mut self, run: &mut Run) {
        if let Some(progress) = self.progress {
            self.observer.show(&UnfinishedRender { job: self.job, run, metadata: self.metadata, progress });
        }
        let begin = Instant::now();
        if let Some(saver) = self.saver.filter(|_| begin >= self.next) {
            self.failed = saver.save(run).err();
            self.next = Instant::now() + SHORTEST_PAUSE.max(begin.elapsed() * LEAST_RATIO);
        }
    }
}
