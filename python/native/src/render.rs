//! Renders in a thread of their own.
//!
//! A render runs in a worker thread. The thread of the caller waits for events without the global
//! interpreter lock, and it wakes up often enough to handle Ctrl-C.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::errors::OrException;
use super::picture::NativePicture;
use abbe::api::{RenderObserver, UnfinishedRender, memory, read_scene_text};
use abbe::{Image, Integrator, Progress, RenderOptions, Scene};
use abbe_format::{self as format, FileAccess, JsonSource, SceneFile};
use abbe_spectra::error::{Error, Result};
use abbe_transport::plan::Budget;
use abbe_transport::walk::StopFlag;

/// The time between two checks for Ctrl-C.
pub(super) const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// The description of a scene: its text or its file, and changes of the form `PATH=JSON`.
#[derive(FromPyObject)]
pub(super) struct SceneArguments {
    /// JSON text, or nothing if `path` names a file.
    #[pyo3(item)]
    pub(super) text: Option<String>,
    #[pyo3(item)]
    pub(super) path: PathBuf,
    #[pyo3(item)]
    pub(super) changes: Vec<String>,
    #[pyo3(item)]
    pub(super) allow_outside: bool,
}

impl SceneArguments {
    /// Returns the files that the scene may use.
    fn access(&self) -> FileAccess {
        if self.allow_outside { FileAccess::Anywhere } else { FileAccess::default() }
    }

    fn scene(&self) -> Result<Scene> {
        let access = self.access();
        match &self.text {
            Some(text) => Scene::parse_with_changes(text, &self.path, &self.changes, access),
            None => Scene::load_with_changes(&self.path, &self.changes, access),
        }
    }

    /// Reads the scene file, and applies the changes.
    pub(super) fn file(&self) -> Result<(SceneFile, JsonSource)> {
        let text = match &self.text {
            Some(text) => text.clone(),
            None => read_scene_text(&self.path, self.access(), None)?.text,
        };
        format::parse_with_access(text, &self.path, &self.changes, self.access())
    }
}

/// The limits and the settings of a render.
#[derive(FromPyObject)]
struct OptionArguments {
    #[pyo3(item)]
    passes: Option<u64>,
    #[pyo3(item)]
    seconds: Option<f64>,
    #[pyo3(item)]
    target_error: Option<f64>,
    #[pyo3(item)]
    integrator: String,
    #[pyo3(item)]
    photons: Option<u64>,
    #[pyo3(item)]
    size: Option<(u32, u32)>,
    #[pyo3(item)]
    seed: Option<u64>,
    #[pyo3(item)]
    threads: Option<u32>,
    #[pyo3(item)]
    spectral_bands: Option<u32>,
    #[pyo3(item)]
    checkpoint: Option<PathBuf>,
    #[pyo3(item)]
    resume: bool,
}

impl OptionArguments {
    fn options(&self) -> Result<RenderOptions> {
        let integrator = integrator(&self.integrator)?;
        let mut options = RenderOptions::default().integrator(integrator).resume(self.resume);
        if self.passes == Some(0) {
            return Err(Error::input("0 passes").expected("at least 1 pass"));
        }
        if let Some(passes) = self.passes {
            options = options.passes(passes);
        }
        if let Some(seconds) = self.seconds {
            let fault = |_| Error::input(format!("a time of {seconds} s")).expected("a positive number of seconds");
            options = options.time(Duration::try_from_secs_f64(seconds).map_err(fault)?);
        }
        if let Some(error) = self.target_error {
            if !(error > 0.0 && error < 1.0) {
                return Err(Error::input(format!("a target error of {error}")).expected("a number between 0 and 1"));
            }
            options = options.target_error(error);
        }
        if let Some(photons) = self.photons {
            options = options.photons(photons);
        }
        if let Some((width, height)) = self.size {
            options = options.size(width, height);
        }
        if let Some(seed) = self.seed {
            options = options.seed(seed);
        }
        if let Some(threads) = self.threads {
            options = options.threads(threads);
        }
        if let Some(bands) = self.spectral_bands {
            options = options.spectral_bands(bands);
        }
        if let Some(path) = &self.checkpoint {
            options = options.checkpoint(path);
        }
        Ok(options)
    }
}

/// Returns the integrator with this name.
pub(super) fn integrator(name: &str) -> Result<Integrator> {
    match name {
        "photon" => Ok(Integrator::Photon),
        "path" => Ok(Integrator::Path),
        other => Err(Error::unknown_name("integrator", other, ["photon", "path"]).expected("photon or path")),
    }
}

/// An event of a render.
enum Event {
    Progress(Progress),
    Picture(Progress, Box<Image>),
    End(Box<Result<Image>>),
}

/// Sends the events of a render to the thread of the caller.
struct EventSender {
    sender: SyncSender<Event>,
    stop: Arc<StopFlag>,
    sends_pictures: bool,
}

impl RenderObserver for EventSender {
    fn planned(&mut self, budget: &Budget) -> Result<()> {
        memory::check(budget)
    }

    fn stop_flag(&self) -> Arc<StopFlag> {
        Arc::clone(&self.stop)
    }

    fn after_pass(&mut self, progress: &Progress) -> ControlFlow<()> {
        // The channel is closed if the caller has lost interest in the render.
        if self.stop.is_raised() || (!self.sends_pictures && self.sender.send(Event::Progress(*progress)).is_err()) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    fn show(&mut self, unfinished: &UnfinishedRender<'_>) {
        if self.sends_pictures {
            let event = Event::Picture(*unfinished.progress(), Box::new(unfinished.image()));
            if self.sender.send(event).is_err() {
                self.stop.raise();
            }
        }
    }
}

/// A render that runs in a thread of its own.
#[pyclass(module = "abbe._native", frozen)]
pub(super) struct RenderTask {
    receiver: Mutex<Receiver<Event>>,
    stop: Arc<StopFlag>,
}

/// The progress after a pass: passes, wanted passes, seconds, relative error, photons per second.
type ProgressTuple = (u64, Option<u64>, f64, Option<f64>, f64, Option<f64>);

fn progress_tuple(progress: &Progress) -> ProgressTuple {
    let Progress { passes, passes_wanted, elapsed, relative_error, typical_error, photons_per_second, .. } = *progress;
    (passes, passes_wanted, elapsed.as_secs_f64(), relative_error, photons_per_second, typical_error)
}

#[pymethods]
impl RenderTask {
    /// Checks the scene and starts the render. If `sends_pictures` is set, every pass sends its
    /// picture.
    #[new]
    fn new(py: Python<'_>, scene: SceneArguments, options: OptionArguments, sends_pictures: bool) -> PyResult<Self> {
        let options = options.options().or_exception(py)?;
        let scene = py.detach(|| scene.scene()).or_exception(py)?;
        let (sender, receiver) = sync_channel(1);
        let stop = Arc::<StopFlag>::default();
        let mut observer = EventSender { sender, stop: Arc::clone(&stop), sends_pictures };
        let work = move || {
            let image = scene.render_observed(&options, &mut observer);
            // The caller may have lost interest in the picture.
            let _ = observer.sender.send(Event::End(Box::new(image)));
        };
        let name = std::thread::Builder::new().name("abbe render".to_string());
        name.spawn(work)
            .map_err(|error| Error::machine(format!("threads cannot be started: {error}")))
            .or_exception(py)?;
        Ok(Self { receiver: Mutex::new(receiver), stop })
    }

    /// Stops the render. The current pass is discarded.
    fn stop(&self) {
        self.stop.raise();
    }

    /// Waits for the next event. Returns the progress and the picture, either of which may be
    /// missing. The last event has a picture without progress.
    fn next_event(&self, py: Python<'_>) -> PyResult<(Option<ProgressTuple>, Option<NativePicture>)> {
        loop {
            let event = py
                .detach(|| self.receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(SIGNAL_INTERVAL));
            match event {
                Ok(Event::Progress(progress)) => return Ok((Some(progress_tuple(&progress)), None)),
                Ok(Event::Picture(progress, image)) => {
                    return Ok((Some(progress_tuple(&progress)), Some(NativePicture::from(*image))));
                }
                Ok(Event::End(image)) => {
                    return Ok((None, Some(NativePicture::from((*image).or_exception(py)?))));
                }
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => {
                    let message = "internal error: the render ended without a picture; this is a bug in abbe";
                    return Err(PyRuntimeError::new_err(message));
                }
            }
        }
    }
}

/// Checks a scene, and returns its notes.
#[pyfunction]
pub(super) fn check_scene(py: Python<'_>, scene: SceneArguments) -> PyResult<Vec<String>> {
    py.detach(|| scene.scene()?.check()).or_exception(py)
}

/// Describes in words which effects the renderer simulates.
#[pyfunction]
pub(super) fn explain_scene(py: Python<'_>, scene: SceneArguments) -> PyResult<String> {
    py.detach(|| scene.scene()?.explain()).or_exception(py)
}
