//! The HTML page of a measurement.

use super::measurement::{position, rounded, significant, summary, title};
use super::requirements::{Judgement, Verdict};
use abbe_scene::light::Light;
use abbe_session::output::date::today;
use abbe_session::output::meters_page::{self, MeterSection, MetersPage, VerdictRow};
use abbe_session::output::plan_map::PlanMap;
use abbe_session::render::{Job, MeasurementReport, MeterReport, Value};
use abbe_spectra::colour::cct_duv;
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer};
use std::path::Path;

/// Returns the readings, the judgements of the requirements and the lights as an HTML page. `scene`
/// is the scene file, and `scene_title` its title.
pub fn page(
    report: &MeasurementReport,
    judgements: &[Judgement],
    job: &Job,
    (scene, scene_title): (&Path, Option<&str>),
) -> String {
    let name =
        scene.file_name().map_or_else(|| scene.display().to_string(), |name| name.to_string_lossy().into_owned());
    let class = |judgement: &Judgement| match judgement.verdict {
        Verdict::Met => "met",
        Verdict::NotMet => "missed",
        Verdict::Undecided => "undecided",
    };
    let verdict = |judgement: &Judgement| VerdictRow { cells: judgement.cells(), class: class(judgement) };
    let of_file = format!("Light in {name}");
    let passes = if report.passes == 1 { "pass" } else { "passes" };
    let made = format!(
        "{name}, measured on {} by Abbe {}: {} {passes} by the {} integrator.",
        today(),
        env!("CARGO_PKG_VERSION"),
        report.passes,
        report.integrator
    );
    meters_page::page(&MetersPage {
        title: scene_title.unwrap_or(&of_file),
        made,
        verdicts: judgements.iter().map(verdict).collect(),
        lights: job.scene.lights.iter().filter(|light| !light.is_distant()).map(|light| schedule(light, job)).collect(),
        sections: report.meters.iter().map(section).collect(),
        notes: &report.notes,
    })
}

/// Returns the row of a light in the schedule.
fn schedule(light: &Light, job: &Job) -> [String; 5] {
    let (watts, xyz) = (light.power_w(job.scene.extent()), Observer::cie1931().xyz(&light.spectrum));
    let efficacy = LUMENS_PER_WATT * xyz[1];
    let temperature = cct_duv(xyz).map_or_else(|| "–".to_string(), |found| format!("{:.0}", found.cct_k));
    [light.name.clone(), three_digits(watts), three_digits(watts * efficacy), three_digits(efficacy), temperature]
}

fn section(meter: &MeterReport) -> MeterSection {
    let bands = meter.wavelength_nm.as_deref();
    let mut columns: Vec<&str> = vec!["position"];
    columns.extend(bands.map(|_| "wavelength in nm"));
    columns.extend(["value", "95 % interval", "noise", "bias"]);
    let with_flux = meter.points.iter().any(|point| point.flux.is_some());
    columns.extend(with_flux.then_some("flux"));
    let rows = meter.points.iter().flat_map(|point| {
        let count = bands.map_or(1, <[f64]>::len);
        (0..count).map(move |band| {
            let number = |value: Option<&Value>| match value {
                Some(Value::Number(value)) => significant(*value),
                Some(Value::Spectrum(values)) => values.get(band).map_or_else(String::new, |value| significant(*value)),
                None => "–".to_string(),
            };
            let ends = point.interval_95.as_ref();
            let interval = ends.map_or_else(
                || "–".to_string(),
                |[low, high]| format!("{} to {}", number(Some(low)), number(Some(high))),
            );
            let mut cells = vec![position(point)];
            cells.extend(bands.map(|nm| nm[band].to_string()));
            cells.extend([number(Some(&point.value)), interval]);
            cells.extend([number(point.noise.as_ref()), number(point.bias.as_ref())]);
            cells.extend(with_flux.then(|| point.flux.map_or_else(String::new, significant)));
            cells
        })
    });
    MeterSection {
        title: title(meter),
        plan: plan(meter),
        columns: columns.into_iter().map(str::to_string).collect(),
        rows: rows.collect(),
        summary: summary(meter),
    }
}

/// Returns the plan of a grid. `None` for other meters and for spectra.
fn plan(meter: &MeterReport) -> Option<PlanMap> {
    let grid = meter.grid.as_ref()?;
    let values = meter.points.iter().map(|point| match point.value {
        Value::Number(value) => Some(value),
        Value::Spectrum(_) => None,
    });
    let normal = meter.points.first()?.normal.unwrap_or([0.0, 1.0, 0.0]);
    Some(PlanMap {
        frame: [grid.u, grid.v, normal].map(glam::DVec3::from),
        count: grid.count.map(|count| count as usize),
        values: values.collect::<Option<_>>()?,
        unit: meter.unit,
        number: three_digits,
    })
}

fn three_digits(value: f64) -> String {
    rounded(value, 3.0)
}
