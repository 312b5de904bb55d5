//! Reports as JSON text: lenses, comparisons of lamps, and studies.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::errors::OrException;
use super::render::{SIGNAL_INTERVAL, SceneArguments};
use crate::cli::{self, ComparedLamps, StudyRequest};
use crate::error::{Error, Result};
use crate::optics::lens::catalogue;
use crate::render::{Monitor, Progress};
use crate::study::StudyMonitor;

/// Analyses a lens.
#[pyfunction]
pub(super) fn lens_report(
    py: Python<'_>,
    name: &str,
    field: Option<f64>,
    glasses: Vec<PathBuf>,
    svg: Option<PathBuf>,
) -> PyResult<String> {
    py.detach(|| cli::lens_json(name, field, &glasses, svg.as_deref())).or_exception(py)
}

/// The names of the built-in lenses.
#[pyfunction]
pub(super) fn lens_names() -> Vec<&'static str> {
    catalogue::all().iter().map(|lens| lens.name()).collect()
}

/// Compares two or three lamps.
#[pyfunction]
pub(super) fn lamps_report(
    py: Python<'_>,
    a: String,
    others: (Option<String>, Option<String>),
    primaries: Vec<String>,
    observer: String,
    html: Option<PathBuf>,
) -> PyResult<String> {
    let (b, c) = others;
    let lamps = ComparedLamps { a, b, c, primaries, observer };
    py.detach(|| cli::lamps_json(lamps, html.as_deref())).or_exception(py)
}

/// An event of a study.
enum StudyEvent {
    Step(String),
    End(Result<Option<String>>),
}

/// A study that runs in a thread of its own.
#[pyclass(module = "abbe._native", frozen)]
pub(super) struct StudyTask {
    receiver: Mutex<Receiver<StudyEvent>>,
    stop: Arc<AtomicBool>,
}

/// Sends the steps of a study to the thread of the caller.
struct StepSender {
    sender: Sender<StudyEvent>,
    stop: Arc<AtomicBool>,
}

impl Monitor for StepSender {
    fn after_pass(&mut self, _: &Progress) -> bool {
        !self.stop.load(Ordering::SeqCst)
    }
}

impl StudyMonitor for StepSender {
    fn begin(&mut self, step: &str, _: bool) {
        if self.sender.send(StudyEvent::Step(step.to_string())).is_err() {
            self.stop.store(true, Ordering::SeqCst);
        }
    }
}

#[pymethods]
impl StudyTask {
    /// Starts a study. `seconds` is the time that the study may take.
    #[new]
    fn new(
        py: Python<'_>,
        scene: SceneArguments,
        folder: PathBuf,
        seconds: f64,
        reference: Option<PathBuf>,
        threads: Option<u32>,
    ) -> PyResult<Self> {
        let budget = Duration::try_from_secs_f64(seconds)
            .map_err(|_| Error::input(format!("a time of {seconds} s")).expected("a positive number of seconds"))
            .or_exception(py)?;
        let SceneArguments { text, path, changes, allow_outside } = scene;
        let access = SceneArguments::access(allow_outside);
        let request = StudyRequest { text, path, changes, access, folder, budget, reference, threads };
        let (sender, receiver) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let mut steps = StepSender { sender, stop: Arc::clone(&stop) };
        let work = move || {
            let report = cli::study_json(request, &mut steps);
            // The caller may have lost interest in the report.
            let _ = steps.sender.send(StudyEvent::End(report));
        };
        std::thread::Builder::new()
            .name("abbe study".to_string())
            .spawn(work)
            .map_err(|error| Error::machine(format!("threads cannot be started: {error}")))
            .or_exception(py)?;
        Ok(Self { receiver: Mutex::new(receiver), stop })
    }

    /// Asks the study to stop after the current pass.
    fn stop(&self) {
        self.stop.store(true, Ordering::SeqCst);
    }

    /// Waits for the next event. Returns whether the study has ended, and a text: the name of a
    /// step, or the report. An interrupted study has no report.
    fn next_event(&self, py: Python<'_>) -> PyResult<(bool, Option<String>)> {
        loop {
            let event = py
                .detach(|| self.receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(SIGNAL_INTERVAL));
            match event {
                Ok(StudyEvent::Step(step)) => return Ok((false, Some(step))),
                Ok(StudyEvent::End(report)) => return Ok((true, report.or_exception(py)?)),
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => {
                    let message = "internal error: the study ended without a report; this is a bug in abbe";
                    return Err(PyRuntimeError::new_err(message));
                }
            }
        }
    }
}
