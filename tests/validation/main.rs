//! Public test cases with known results: readings of meters against CIE 171 and closed forms.
//!
//! `tests/run --test validation` measures a few cases of CIE 171, and `tests/run --test validation
//! -- --ignored` measures all cases in some minutes. With `ABBE_BLESS=1`, the slow tests also write
//! their reports to `docs/validation/cie171.md` and `docs/validation/closed-forms.md`.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod cie171;
mod closed_forms;
mod report;

use abbe_format::resolve::resolve_meters;
use abbe_format::{FileAccess, parse_with_access};
use abbe_session::render::{Job, MeasurementReport, NoMonitor, StopRules, Value};
use std::path::Path;

/// The introduction of the page on CIE 171.
const CIE_171: &str = "\
This page compares readings of `abbe measure` with the analytical test cases 5.2–5.14 of CIE
171:2006. The expected values were computed from first principles, and the printed values of the
report stand beside them. A value passes if its deviation and half its 95 % interval are at most 1 %
of the expected value, or 0.1 % of the largest value of the case. `ABBE_BLESS=1 tests/run --test
validation -- --ignored cie_171` wrote the page.";

/// The introduction of the page on closed forms.
const CLOSED_FORMS: &str = "\
This page compares readings of `abbe measure` with closed forms and with published values:
integrating spheres, slabs and half-spaces that scatter, and the prism of Newton's letter of 1672
(refracting angle 63° 12′, index 1.5453, a hole of ¼ inch, and a wall at 22 feet). A value passes if
its deviation and half its 95 % interval are at most 1 % of the expected value, or 0.001.
`ABBE_BLESS=1 tests/run --test validation -- --ignored closed_forms` wrote the page.";

/// A test case: a scene with meters, and the expected readings.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    /// The name, such as `5.9/roof-1x1/type-5`.
    pub(crate) id: String,
    /// A sentence about the case.
    pub(crate) title: String,
    /// The unit of the expected values.
    pub(crate) unit: String,
    /// The scenes of the case with their expected values. Each scene is the text of a scene file.
    pub(crate) scenes: Vec<(String, Vec<ExpectedReading>)>,
    /// A value passes if its deviation is at most this share of the expected value, or at most
    /// `absolute`.
    pub(crate) relative: f64,
    /// See `relative`.
    pub(crate) absolute: f64,
}

/// An expected reading. The readings of a scene are listed in the order of its meters.
#[derive(Debug, Clone)]
pub(crate) struct ExpectedReading {
    /// The name of the point or of the surface.
    pub(crate) id: String,
    /// The expected value.
    pub(crate) value: f64,
    /// The value printed in the publication, if there is one.
    pub(crate) published: Option<f64>,
    /// The factor from the reading to the unit of the expected value.
    pub(crate) scale: f64,
    /// This amount is subtracted from the scaled reading.
    pub(crate) offset: f64,
}

/// The result of a case.
#[derive(Debug)]
pub(crate) struct CaseResult {
    /// The name.
    pub(crate) id: String,
    /// A sentence about the case.
    pub(crate) title: String,
    /// The unit of the values.
    pub(crate) unit: String,
    /// The values.
    pub(crate) values: Vec<CheckedValue>,
    /// The duration in s.
    pub(crate) seconds: f64,
}

/// A measured value with its expected value.
#[derive(Debug)]
pub(crate) struct CheckedValue {
    /// The name of the point or of the surface.
    pub(crate) id: String,
    /// The expected value.
    pub(crate) expected: f64,
    /// The value printed in the publication, if there is one.
    pub(crate) published: Option<f64>,
    /// The measured value.
    pub(crate) measured: f64,
    /// The 95 % interval of the measured value. `None` where no sample found light.
    pub(crate) interval_95: Option<[f64; 2]>,
    /// The largest allowed deviation.
    pub(crate) tolerance: f64,
    /// True if the deviation and half the interval, which a dark point lacks, are within the
    /// tolerance.
    pub(crate) passes: bool,
}

impl CaseResult {
    /// Returns the number of values that do not pass.
    pub(crate) fn failures(&self) -> usize {
        self.values.iter().filter(|value| !value.passes).count()
    }

    /// Returns the largest deviation, divided by its tolerance.
    pub(crate) fn largest_deviation(&self) -> f64 {
        let ratio = |value: &CheckedValue| (value.measured - value.expected).abs() / value.tolerance;
        self.values.iter().map(ratio).fold(0.0, f64::max)
    }

    /// Returns the number of expected values inside their intervals. Expected values are rounded,
    /// so a deviation of 10⁻⁵ does not count.
    pub(crate) fn covered(&self) -> usize {
        let inside = |value: &&CheckedValue| {
            let slack = 1e-5 * value.expected.abs() + 1e-3 * value.tolerance;
            value.interval_95.map_or(value.expected == 0.0, |[low, high]| {
                value.expected >= low - slack && value.expected <= high + slack
            })
        };
        self.values.iter().filter(inside).count()
    }
}

/// Measures the scene with this text. The folder `files` contains the files that the scene names.
fn measure_scene(text: &str, files: &Path, stop: StopRules) -> MeasurementReport {
    let (scene, source) = parse_with_access(text, &files.join("case.json"), &[], FileAccess::default()).unwrap();
    Job::new(resolve_meters(&scene, &source).unwrap()).unwrap().measure(None, stop, &mut NoMonitor).unwrap().0
}

/// Measures a case. The folder `files` contains the files that the scene names.
fn run(case: &Case, files: &Path) -> CaseResult {
    let (mut values, mut seconds) = (Vec::new(), 0.0);
    for (text, expected) in &case.scenes {
        let report = measure_scene(text, files, StopRules::default());
        seconds += report.seconds;
        let points = report.meters.iter().flat_map(|meter| &meter.points);
        for (expected, point) in expected.iter().zip(points) {
            let number = |value: &Value| match value {
                Value::Number(number) => number * expected.scale - expected.offset,
                Value::Spectrum(_) => f64::NAN,
            };
            let measured = number(&point.value);
            let interval_95 = point.interval_95.as_ref().map(|ends| ends.each_ref().map(number));
            let tolerance = (case.relative * expected.value).max(case.absolute);
            let is_precise = interval_95.map_or(measured == 0.0, |[low, high]| 0.5 * (high - low) <= tolerance);
            values.push(CheckedValue {
                id: expected.id.clone(),
                expected: expected.value,
                published: expected.published,
                measured,
                interval_95,
                tolerance,
                passes: (measured - expected.value).abs() <= tolerance && is_precise,
            });
        }
    }
    CaseResult { id: case.id.clone(), title: case.title.clone(), unit: case.unit.clone(), values, seconds }
}

/// Returns a folder with the files that the scenes of CIE 171 name.
fn folder_of_lamps() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    cie171::LAMPS.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).unwrap());
    folder
}

/// Checks that all values of all cases pass.
fn check(results: &[CaseResult]) {
    assert!(!results.is_empty());
    for result in results {
        println!("{}: {:.2} of the tolerance", result.id, result.largest_deviation());
        assert_eq!(result.failures(), 0, "{result:#?}");
    }
}

/// Writes a report to a page of `docs/validation` if `ABBE_BLESS` is set.
fn bless(page: &str, text: impl FnOnce() -> String) {
    if std::env::var_os("ABBE_BLESS").is_some() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation").join(page);
        std::fs::write(path, text()).unwrap();
    }
}

/// A quick selection of CIE 171's cases: lamps, panes, interreflection, skies and glazing.
#[test]
fn some_cie_171_cases_are_within_their_tolerances() {
    let chosen = ["5.2/lambertian-3m", "5.3/square-ceiling", "5.5/pane", "5.6/s2-4m", "5.9/roof-4x4/type-12"];
    let (mut cases, folder) = (cie171::cases(), folder_of_lamps());
    cases.retain(|case| chosen.contains(&case.id.as_str()));
    assert_eq!(cases.len(), chosen.len());
    check(&cases.iter().map(|case| run(case, folder.path())).collect::<Vec<_>>());
}

#[test]
#[ignore = "takes some minutes: all 130 cases of CIE 171"]
fn all_cie_171_cases_are_within_their_tolerances() {
    let folder = folder_of_lamps();
    let results: Vec<CaseResult> = cie171::cases().iter().map(|case| run(case, folder.path())).collect();
    bless("cie171.md", || report::markdown("CIE 171:2006, cases 5.2–5.14", CIE_171, &results));
    check(&results);
    let covered: usize = results.iter().map(CaseResult::covered).sum();
    let values: usize = results.iter().map(|result| result.values.len()).sum();
    assert!(covered as f64 > 0.92 * values as f64, "{covered} of {values} values are inside their intervals");
}

#[test]
#[ignore = "takes minutes: integrating spheres, scattering slabs and Newton's prism"]
fn closed_forms_are_within_their_tolerances() {
    let folder = tempfile::tempdir().unwrap();
    let results: Vec<CaseResult> = closed_forms::cases().iter().map(|case| run(case, folder.path())).collect();
    bless("closed-forms.md", || {
        report::markdown("Closed forms", CLOSED_FORMS, &results) + &closed_forms::newtons_length(folder.path())
    });
    check(&results);
}
