//! Reports as JSON text: comparisons of lamps, regression tests, measurements and studies.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use super::errors::OrException;
use super::json::json;
use super::render::{SIGNAL_INTERVAL, SceneArguments, integrator};
use abbe::api::memory;
use abbe::reports::lamps::{LampsCompared, LampsReport};
use abbe::reports::measurement::measure;
use abbe::reports::measurement_page;
use abbe::reports::named::{light_remark, spectrum};
use abbe::reports::regression::{colours_of_json, exported_set};
use abbe::reports::requirements::{JudgedMeasurement, judgements};
use abbe::reports::study::{StudyFiles, study};
use abbe::study::{StudyMonitor, StudyOutcome};
use abbe_format::resolve::{Role, resolve_meters};
use abbe_session::output::{file, regress_page};
use abbe_session::render::{Monitor, Progress, StopRules};
use abbe_spectra::colour::regress::{RegressionSet, RegressionTolerances, compare_given};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Observer;
use abbe_transport::walk::StopFlag;

/// Writes a text to a file, completely or not at all.
#[pyfunction]
pub(super) fn write_whole(py: Python<'_>, path: PathBuf, text: &str) -> PyResult<()> {
    py.detach(|| file::write_whole(&path, text.as_bytes())).or_exception(py)
}

/// Compares two or three lamps, and writes the page of the comparison to the file `html`.
#[pyfunction]
pub(super) fn lamps_report(
    py: Python<'_>,
    a: &str,
    others: (Option<String>, Option<String>),
    primaries: Vec<String>,
    observer: &str,
    html: Option<PathBuf>,
) -> PyResult<String> {
    let light = |text: &str| {
        let light = spectrum(text, Role::Light)?;
        light_remark(text).iter().chain(&light.notes).for_each(|remark| eprintln!("note: {remark}"));
        Ok(light)
    };
    let report = || {
        let observer = Observer::by_name(observer)?;
        let a = light(a)?;
        let primaries = primaries.iter().map(|text| light(text)).collect::<Result<Vec<_>>>()?;
        let other = |text: &Option<String>| text.as_deref().map(light).transpose();
        let compared = LampsCompared::of(a, [other(&others.0)?, other(&others.1)?], primaries, observer)?;
        if let Some(path) = &html {
            file::write_whole(path, compared.html()?.as_bytes())?;
        }
        Ok(json(&LampsReport::of(&compared)))
    };
    py.detach(report).or_exception(py)
}

/// A regression set by its number.
#[pyfunction]
pub(super) fn regression_set(py: Python<'_>, number: u32) -> PyResult<String> {
    py.detach(|| Ok(json(&exported_set(RegressionSet::by_number(number)?)))).or_exception(py)
}

/// Judges the colours of a converter, and writes the page of the judgement to the file `page`.
#[pyfunction]
pub(super) fn regression_report(
    py: Python<'_>,
    set: u32,
    colours: &str,
    delta_e: Option<f64>,
    component: Option<f64>,
    page: Option<PathBuf>,
) -> PyResult<String> {
    let defaults = RegressionTolerances::default();
    let tolerances = RegressionTolerances {
        delta_e_2000: delta_e.unwrap_or(defaults.delta_e_2000),
        component: component.unwrap_or(defaults.component),
    };
    let report = || {
        let set = RegressionSet::by_number(set)?;
        let report = compare_given(set, &colours_of_json(set, colours)?, tolerances)?;
        if let Some(path) = &page {
            file::write_whole(path, regress_page::page(&report, "converter").as_bytes())?;
        }
        Ok(json(&report))
    };
    py.detach(report).or_exception(py)
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
    stop: Arc<StopFlag>,
}

/// Sends the steps of the computation to the thread of the caller.
struct StepSender {
    sender: Sender<ReportEvent>,
    stop: Arc<StopFlag>,
}

impl Monitor for StepSender {
    fn stop_flag(&self) -> Arc<StopFlag> {
        Arc::clone(&self.stop)
    }

    fn after_pass(&mut self, _: &Progress) -> bool {
        !self.stop.is_raised()
    }
}

impl StudyMonitor for StepSender {
    fn begin(&mut self, step: &str, _: bool) {
        if self.sender.send(ReportEvent::Step(step.to_string())).is_err() {
            self.stop.raise();
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
    #[pyo3(item)]
    html: Option<PathBuf>,
}

impl ReportTask {
    /// Runs `work` in a thread.
    fn start(
        py: Python<'_>,
        work: impl FnOnce(&mut StepSender) -> Result<Option<String>> + Send + 'static,
    ) -> PyResult<Self> {
        let (sender, receiver) = channel();
        let stop = Arc::<StopFlag>::default();
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
        Self::start(py, move |steps| {
            let (file, source) = scene.file()?;
            let files = StudyFiles { scene: &scene.path, output: &folder, reference: reference.as_deref() };
            Ok(match study(&file, &source, &files, budget, threads, steps)? {
                StudyOutcome::Finished(report) => Some(json(&report)),
                StudyOutcome::Interrupted => None,
            })
        })
    }

    /// Starts a measurement with the meters of a scene.
    #[staticmethod]
    fn measure(py: Python<'_>, scene: SceneArguments, options: MeasureArguments) -> PyResult<Self> {
        let MeasureArguments { meters, integrator: name, passes, seconds, target_error, html } = options;
        let integrator = name.map(|name| integrator(&name)).transpose().or_exception(py)?;
        let time = seconds.map(duration).transpose().or_exception(py)?;
        let stop = StopRules { passes, time, target_error };
        Self::start(py, move |steps| {
            let (mut scene_file, source) = scene.file()?;
            scene_file.select_meters(&meters).map_err(|error| error.in_file(&scene.path))?;
            let job = memory::plan(resolve_meters(&scene_file, &source)?, &scene.path)?;
            let (report, interrupted) = measure(&job, &scene.path, integrator, stop, steps)?;
            if interrupted {
                return Ok(None);
            }
            let judgements = judgements(&scene_file.requirements, &report);
            if let Some(path) = &html {
                let text =
                    measurement_page::page(&report, &judgements, &job, (&scene.path, scene_file.title.as_deref()));
                file::write_whole(path, text.as_bytes())?;
            }
            Ok(Some(json(&JudgedMeasurement { report: &report, requirements: &judgements })))
        })
    }

    /// Stops the task. The current pass is discarded.
    fn stop(&self) {
        self.stop.raise();
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
