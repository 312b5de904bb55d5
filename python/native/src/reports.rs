//! Reports as JSON text: lenses, comparisons of lamps, regression tests, measurements and studies.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::errors::OrException;
use super::render::{SIGNAL_INTERVAL, SceneArguments, integrator};
use abbe::cli::{self, ComparedLamps, MeasureRequest, StudyRequest};
use abbe::study::StudyMonitor;
use abbe_optics::lens::catalogue;
use abbe_session::render::{Monitor, Progress, StopRules};
use abbe_spectra::error::{Error, Result};

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

/// The surfaces of a lens, with their indices of refraction at wavelengths in nm.
#[pyfunction]
pub(super) fn lens_prescription(py: Python<'_>, name: &str, nm: Vec<f64>, glasses: Vec<PathBuf>) -> PyResult<String> {
    py.detach(|| cli::prescription_json(name, &nm, &glasses)).or_exception(py)
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

/// The regression set.
#[pyfunction]
pub(super) fn regression_set(py: Python<'_>) -> String {
    py.detach(cli::regression_set_json)
}

/// Judges the colours of a converter.
#[pyfunction]
pub(super) fn regression_report(
    py: Python<'_>,
    colours: &str,
    delta_e: Option<f64>,
    component: Option<f64>,
    page: Option<PathBuf>,
) -> PyResult<String> {
    py.detach(|| cli::regression_json(colours, delta_e, component, page.as_deref())).or_exception(py)
}

/// An event of a long computation that ends with a report.
enum ReportEvent {
    Step(String),
    End(Result<Option<String>>),
}

/// A study or a measurement that runs in a thread of its own.
#[pyclass(module = "abbe._native", frozen)]
pub(super) struct ReportTask {
    receiver: Mutex<Receiver<ReportEvent>>,
    stop: Arc<AtomicBool>,
}

/// Sends the steps of the computation to the thread of the caller.
struct StepSender {
    sender: Sender<ReportEvent>,
    stop: Arc<AtomicBool>,
}

impl Monitor for StepSender {
    fn after_pass(&mut self, _: &Progress) -> bool {
        !self.stop.load(Ordering::SeqCst)
    }
}

impl StudyMonitor for StepSender {
    fn begin(&mut self, step: &str, _: bool) {
        if self.sender.send(ReportEvent::Step(step.to_string())).is_err() {
            self.stop.store(true, Ordering::SeqCst);
        }
    }
}

/// Returns a duration in seconds.
fn duration(seconds: f64) -> Result<Duration> {
    let fault = |_| Error::input(format!("a time of {seconds} s")).expected("a positive number of seconds");
    Duration::try_from_secs_f64(seconds).map_err(fault)
}

/// The meters and the limits of a measurement.
#[derive(FromPyObject)]
struct MeasureArguments {
    #[pyo3(item)]
    meters: Vec<String>,
    #[pyo3(item)]
    integrator: Option<String>,
    #[pyo3(item)]
    passes: Option<u64>,
    #[pyo3(item)]
    seconds: Option<f64>,
    #[pyo3(item)]
    target_error: Option<f64>,
}

impl ReportTask {
    /// Runs `work` in a thread.
    fn start(
        py: Python<'_>,
        work: impl FnOnce(&mut StepSender) -> Result<Option<String>> + Send + 'static,
    ) -> PyResult<Self> {
        let (sender, receiver) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let mut steps = StepSender { sender, stop: Arc::clone(&stop) };
        let run = move || {
            let report = work(&mut steps);
            // The caller may have lost interest in the report.
            let _ = steps.sender.send(ReportEvent::End(report));
        };
        std::thread::Builder::new()
            .name("abbe report".to_string())
            .spawn(run)
            .map_err(|error| Error::machine(format!("threads cannot be started: {error}")))
            .or_exception(py)?;
        Ok(Self { receiver: Mutex::new(receiver), stop })
    }
}

#[pymethods]
impl ReportTask {
    /// Starts a study. `seconds` is the time that the study may take.
    #[staticmethod]
    fn study(
        py: Python<'_>,
        scene: SceneArguments,
        folder: PathBuf,
        seconds: f64,
        reference: Option<PathBuf>,
        threads: Option<u32>,
    ) -> PyResult<Self> {
        let budget = duration(seconds).or_exception(py)?;
        let request = StudyRequest { scene: scene.into(), folder, budget, reference, threads };
        Self::start(py, move |steps| cli::study_json(request, steps))
    }

    /// Starts a measurement with the meters of a scene.
    #[staticmethod]
    fn measure(py: Python<'_>, scene: SceneArguments, options: MeasureArguments) -> PyResult<Self> {
        let MeasureArguments { meters, integrator: name, passes, seconds, target_error } = options;
        let integrator = name.map(|name| integrator(&name)).transpose().or_exception(py)?;
        let time = seconds.map(duration).transpose().or_exception(py)?;
        let stop = StopRules { passes, time, target_error };
        let request = MeasureRequest { scene: scene.into(), meters, integrator, stop };
        Self::start(py, move |steps| cli::measure_json(request, steps))
    }

    /// Asks the task to stop after the current pass.
    fn stop(&self) {
        self.stop.store(true, Ordering::SeqCst);
    }

    /// Waits for the next event. Returns whether the study has ended, and a text: the name of a
    /// step, or the report. An interrupted task has no report.
    fn next_event(&self, py: Python<'_>) -> PyResult<(bool, Option<String>)> {
        loop {
            let event = py
                .detach(|| self.receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(SIGNAL_INTERVAL));
            match event {
                Ok(ReportEvent::Step(step)) => return Ok((false, Some(step))),
                Ok(ReportEvent::End(report)) => return Ok((true, report.or_exception(py)?)),
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => {
                    let message = "internal error: the computation ended without a report; this is a bug in abbe";
                    return Err(PyRuntimeError::new_err(message));
                }
            }
        }
    }
}
