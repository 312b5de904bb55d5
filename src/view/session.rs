//! The session: loads the scene, renders it, and follows the orders of the page.

use super::channel::{Orders, ViewChannel};
use super::host::ViewHost;
use super::publisher::Publisher;
use crate::page::{LoadedScene, ScenePanels, SessionState, SketchSize, ViewProgress};
use abbe_session::render::{
    CoarseLevel, CoarsePicture, Integrator, Monitor, PassPart, Progress, Rendered, Request, Run, StopRules, on_threads,
};
use abbe_spectra::error::{Error, Result};
use abbe_transport::walk::StopFlag;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The session renders all passes again when a slider has not moved for this time.
const DRAFT_END: Duration = Duration::from_millis(400);

#[derive(Debug)]
pub struct SessionEnd {
    /// The last scene and its render, unless the scene has a fault, or no pass of it is done.
    pub last: Option<(Arc<LoadedScene>, Box<Rendered>)>,
}

/// Renders until the host is interrupted, each render on its own thread. If the scene changes, the
/// session starts the next render at once, and the abandoned one ends soon. Returns an
/// error if the first load of the scene fails, or if a thread cannot be started.
pub(super) fn run(host: &dyn ViewHost, channel: &Arc<ViewChannel>, stop: StopRules) -> Result<SessionEnd> {
    let (mut number, mut size) = (0, SketchSize::default());
    loop {
        let orders = channel.orders();
        if orders.interrupted {
            return Ok(SessionEnd { last: None });
        }
        if host.scene_path().is_none() && orders.example.is_none() {
            wait_for_change(channel, &orders);
            continue;
        }
        let start = Instant::now();
        let loaded = match host.load(orders.example, &orders.changes, &orders.forbidden) {
            Ok(loaded) => Arc::new(loaded),
            Err(error) if number == 0 && orders.example.is_none() => return Err(error),
            Err(error) => {
                channel.fail(orders.revision, with_carets(&error, host.scene_path()));
                wait_for_change(channel, &orders);
                continue;
            }
        };
        number += 1;
        let scene = Arc::new(ScenePanels::new(number, &loaded));
        channel.begin(Arc::clone(&scene), Some(Arc::clone(&loaded)));
        let threads = loaded.job.scene.settings.threads;
        if orders.is_draft {
            let load_s = start.elapsed().as_secs_f64();
            let publisher = Publisher::new(channel, &loaded, Arc::clone(&scene), orders.revision);
            match on_threads(threads, || draft(&loaded, &publisher, (&mut size, load_s)))? {
                Ok(true) => {
                    end_draft(channel, &orders);
                    continue;
                }
                // The whole picture is small enough.
                Ok(false) => channel.order(|orders| orders.is_draft = false),
                Err(error) => {
                    channel.fail(orders.revision, error.to_string());
                    wait_for_change(channel, &orders);
                    continue;
                }
            }
        }
        let (of_thread, own_channel, own_orders) = (Arc::clone(&loaded), Arc::clone(channel), orders.clone());
        let work = move || {
            let mut publisher = Publisher::new(&own_channel, &of_thread, scene, own_orders.revision);
            let render = || render(&of_thread, &own_channel, &mut publisher, &own_orders, stop);
            let ended = panic::catch_unwind(AssertUnwindSafe(|| on_threads(threads, render)?));
            let failed = || Error::machine("the render failed; this is a bug in abbe, please report it");
            ended.unwrap_or_else(|_| Err(failed())).unwrap_or_else(|error| {
                own_channel.fail(own_orders.revision, error.to_string());
                None
            })
        };
        let render = std::thread::Builder::new().name("abbe-render".to_string()).spawn(work);
        let render = render.map_err(|error| Error::machine(format!("a thread cannot be started: {error}")))?;
        let now = wait_for_change(channel, &orders);
        if now.interrupted {
            let rendered = render.join().map_err(|_| Error::machine("the render failed; this is a bug in abbe"))?;
            return Ok(SessionEnd { last: rendered.map(|rendered| (loaded, rendered)) });
        }
    }
}

fn wait_for_change(channel: &ViewChannel, orders: &Orders) -> Orders {
    channel.wait(None, |now| now.revision != orders.revision || now.interrupted)
}

/// Publishes a coarse picture. Returns false if the picture is too small for one.
fn draft(loaded: &LoadedScene, publisher: &Publisher<'_>, (size, load_s): (&mut SketchSize, f64)) -> Result<bool> {
    let start = Instant::now();
    let Some(coarse) = loaded.job.sketch(size.get())? else { return Ok(false) };
    size.update(load_s, start.elapsed().as_secs_f64());
    publisher.draft(coarse);
    Ok(true)
}

/// Waits for the next change. If the reader rests or releases the object, the session renders the
/// whole picture.
fn end_draft(channel: &ViewChannel, orders: &Orders) {
    let is_over = |now: &Orders| now.revision != orders.revision || now.interrupted || !now.is_draft;
    let now = channel.wait(Some(DRAFT_END), is_over);
    if now.revision == orders.revision && now.is_draft {
        channel.order(|orders| orders.is_draft = false);
    }
}

/// Renders passes until the scene changes or the user interrupts, and then returns the render.
fn render(
    loaded: &LoadedScene,
    channel: &ViewChannel,
    publisher: &mut Publisher<'_>,
    orders: &Orders,
    mut stop: StopRules,
) -> Result<Option<Box<Rendered>>> {
    let job = &loaded.job;
    let mut run = Run::new(job, PassPart::WHOLE);
    let mut extensions = orders.extensions;
    loop {
        let request = Request { integrator: Integrator::Photon, stop };
        let mut monitor = ViewMonitor {
            channel,
            publisher: &mut *publisher,
            revision: orders.revision,
            paused: Duration::ZERO,
            last: ViewProgress::default(),
            stop: channel.stop_flag(orders.revision),
        };
        let rendered = job.continue_run(request, run, &mut monitor)?;
        if rendered.stats.passes == 0 {
            return Ok(None);
        }
        let progress = ViewProgress {
            passes: rendered.stats.passes,
            passes_wanted: stop.passes_wanted(&job.budget),
            relative_error: rendered.stats.error.relative.or(monitor.last.relative_error),
            typical_error: rendered.stats.error.typical.or(monitor.last.typical_error),
            ..monitor.last
        };
        publisher.publish(&rendered.run, rendered.picture.clone());
        if !rendered.interrupted {
            channel.report(orders.revision, SessionState::Finished, progress);
        }
        let is_over = |now: &Orders| now.interrupted || now.revision != orders.revision;
        let now = channel.wait(None, |now| is_over(now) || now.extensions != extensions);
        if now.interrupted {
            return Ok(Some(Box::new(rendered)));
        }
        if is_over(&now) {
            return Ok(None);
        }
        extensions = now.extensions;
        stop.passes = Some(2 * rendered.stats.passes);
        run = rendered.run;
    }
}

/// Reports the progress to the page, and follows its orders between the passes.
struct ViewMonitor<'a, 'p> {
    channel: &'a ViewChannel,
    publisher: &'a mut Publisher<'p>,
    /// The revision of the scene that is rendered.
    revision: u64,
    paused: Duration,
    last: ViewProgress,
    stop: Arc<StopFlag>,
}

impl Monitor for ViewMonitor<'_, '_> {
    fn stop_flag(&self) -> Arc<StopFlag> {
        Arc::clone(&self.stop)
    }

    fn coarse_levels(&self) -> &'static [CoarseLevel] {
        &[CoarseLevel::Sketch(1.0), CoarseLevel::Half, CoarseLevel::Full]
    }

    fn show_coarse_picture(&mut self, coarse: &CoarsePicture) {
        self.publisher.coarse(coarse);
    }

    fn after_pass(&mut self, progress: &Progress) -> bool {
        self.last = ViewProgress::new(progress, self.paused);
        self.channel.report(self.revision, SessionState::Rendering, self.last);
        let orders = self.channel.orders();
        !orders.interrupted && orders.revision == self.revision
    }

    fn checkpoint(&mut self, run: &mut Run) {
        if !self.channel.orders().paused {
            self.publisher.update(run);
            return;
        }
        self.publisher.publish(run, run.picture_with_denoised());
        let begin = Instant::now();
        self.channel.wait(None, |now| !now.paused || now.interrupted || now.revision != self.revision);
        self.paused += begin.elapsed();
    }
}

/// Returns an error as text, with the lines of the scene file to which it refers, and carets.
fn with_carets(error: &Error, scene: Option<&Path>) -> String {
    let text = scene.and_then(|scene| std::fs::read_to_string(scene).ok()).unwrap_or_default();
    let fault = |fault: Error| {
        let place = fault.location.line_column.filter(|_| scene.is_some() && fault.location.file.as_deref() == scene);
        let line = place.and_then(|(line, column)| Some((text.lines().nth(line - 1)?, line, column)));
        match line {
            Some((content, line, column)) => {
                let number = format!("{line} | ");
                let indent = " ".repeat(number.chars().count() + column - 1);
                format!("{fault}\n{number}{content}\n{indent}^")
            }
            None => fault.to_string(),
        }
    };
    error.clone().into_faults().into_iter().map(fault).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caret_marks_the_column_of_a_fault() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        std::fs::write(&path, "{\n  \"film\": 3\n}").unwrap();
        let error = Error::input("found 3").in_file(&path).at(2, 11);
        let text = with_carets(&error, Some(&path));
        assert!(text.ends_with("found 3\n2 |   \"film\": 3\n              ^"), "{text}");
    }
}
