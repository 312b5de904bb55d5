//! Validation: measurements of public test cases with known results.
//!
//! `abbe validate` runs the cases and writes a report. Each case states its expected values, and
//! the modules [`cie171`] and [`closed_forms`] build its scenes.

pub mod cie171;
pub mod closed_forms;
mod report;

pub use report::markdown;

use abbe_format::resolve::resolve_meters;
use abbe_format::{FileAccess, parse_with_access};
use abbe_session::render::{Job, MeasurementReport, Monitor, StopRules, Value};
use abbe_spectra::error::Result;
use serde::Serialize;
use std::path::Path;

/// A test case: a scene with meters, and the expected readings.
#[derive(Debug, Clone)]
pub struct Case {
    /// The name, such as `5.9/roof-1x1/type-5`.
    pub id: String,
    /// A sentence about the case.
    pub title: String,
    /// True if the case belongs to the quick subset.
    pub quick: bool,
    /// The unit of the expected values.
    pub unit: String,
    /// The scenes of the case with their expected values. Each scene is the text of a scene file.
    pub scenes: Vec<(String, Vec<Expected>)>,
    /// A value passes if its deviation is at most this share of the expected value, or at most
    /// `absolute`.
    pub relative: f64,
    /// See `relative`.
    pub absolute: f64,
}

/// An expected reading. The readings of a scene are listed in the order of its meters.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// The name of the point or of the surface.
    pub id: String,
    /// The expected value.
    pub value: f64,
    /// The value printed in the publication, if there is one.
    pub published: Option<f64>,
    /// The factor from the reading to the unit of the expected value.
    pub scale: f64,
    /// This amount is subtracted from the scaled reading.
    pub offset: f64,
}

/// The result of a case.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseResult {
    /// The name.
    pub id: String,
    /// A sentence about the case.
    pub title: String,
    /// The unit of the values.
    pub unit: String,
    /// The values.
    pub values: Vec<CheckedValue>,
    /// The duration in s.
    pub seconds: f64,
}

/// A measured value with its expected value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckedValue {
    /// The name of the point or of the surface.
    pub id: String,
    /// The expected value.
    pub expected: f64,
    /// The value printed in the publication, if there is one.
    pub published: Option<f64>,
    /// The measured value.
    pub measured: f64,
    /// The 95 % interval of the measured value.
    pub interval_95: [f64; 2],
    /// The largest allowed deviation.
    pub tolerance: f64,
    /// True if the deviation and half the interval are within the tolerance.
    pub passes: bool,
}

impl CaseResult {
    /// Returns the number of values that do not pass.
    pub fn failures(&self) -> usize {
        self.values.iter().filter(|value| !value.passes).count()
    }

    /// Returns the largest deviation, divided by its tolerance.
    pub fn largest_deviation(&self) -> f64 {
        let ratio = |value: &CheckedValue| (value.measured - value.expected).abs() / value.tolerance;
        self.values.iter().map(ratio).fold(0.0, f64::max)
    }

    /// Returns the number of expected values inside their intervals. Expected values are rounded,
    /// so a deviation of 10⁻⁵ does not count.
    pub fn covered(&self) -> usize {
        let inside = |value: &&CheckedValue| {
            let [low, high] = value.interval_95;
            let slack = 1e-5 * value.expected.abs() + 1e-3 * value.tolerance;
            value.expected >= low - slack && value.expected <= high + slack
        };
        self.values.iter().filter(inside).count()
    }
}

/// Measures the scene with this text. The folder `files` contains the files that the scene names.
fn measure_scene(text: &str, files: &Path, stop: StopRules, monitor: &mut dyn Monitor) -> Result<MeasurementReport> {
    let (scene, source) = parse_with_access(text, &files.join("case.json"), &[], FileAccess::default())?;
    let job = Job::new(resolve_meters(&scene, &source)?)?;
    Ok(job.measure(None, stop, monitor)?.0)
}

/// Measures a case. The folder `files` contains the files that the scene names. `monitor` may end a
/// measurement early.
///
/// # Errors
/// Returns an error if the scene has a fault. This is a bug of the case.
pub fn run(case: &Case, files: &Path, stop: StopRules, monitor: &mut dyn Monitor) -> Result<CaseResult> {
    let (mut values, mut seconds) = (Vec::new(), 0.0);
    for (text, expected) in &case.scenes {
        let report = measure_scene(text, files, stop, monitor)?;
        seconds += report.seconds;
        let points = report.meters.iter().flat_map(|meter| &meter.points);
        for (expected, point) in expected.iter().zip(points) {
            let number = |value: &Value| match value {
                Value::Number(number) => number * expected.scale - expected.offset,
                Value::Spectrum(_) => f64::NAN,
            };
            let measured = number(&point.value);
            let interval_95 = point.interval_95.as_ref().map_or([f64::NAN; 2], |ends| ends.each_ref().map(number));
            let tolerance = (case.relative * expected.value).max(case.absolute);
            let half = 0.5 * (interval_95[1] - interval_95[0]);
            values.push(CheckedValue {
                id: expected.id.clone(),
                expected: expected.value,
                published: expected.published,
                measured,
                interval_95,
                tolerance,
                passes: (measured - expected.value).abs() <= tolerance && half <= tolerance,
            });
        }
    }
    Ok(CaseResult { id: case.id.clone(), title: case.title.clone(), unit: case.unit.clone(), values, seconds })
}
