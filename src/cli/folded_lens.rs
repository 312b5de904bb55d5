//! The report of `abbe lens` for a system with mirrors or coordinate breaks.

use abbe_optics::lens::LINES;
use abbe_optics::lens::folded::{FoldedAnalysis, FoldedField, FoldedSystem};
use abbe_spectra::error::Result;
use serde::Serialize;

use super::{lens, print};

/// The documentation of [`FoldedAnalysis`] defines the quantities. The focal length and the back
/// focus are those along y.
#[derive(Debug, Serialize)]
struct FoldedReport<'a> {
    name: &'a str,
    surfaces: usize,
    mirrors: usize,
    efl_mm: f64,
    efl_x_mm: f64,
    bfd_mm: f64,
    bfd_x_mm: f64,
    image_distance_mm: f64,
    f_number: f64,
    entrance_diameter_mm: f64,
    half_field_deg: f64,
    fields: Vec<FoldedFieldReport>,
}

#[derive(Debug, Serialize)]
struct FoldedFieldReport {
    angle_deg: f64,
    image_x_mm: f64,
    image_height_mm: f64,
    spots: Vec<FoldedSpotReport>,
    passing: f64,
}

#[derive(Debug, Serialize)]
struct FoldedSpotReport {
    line: &'static str,
    rms_mm: f64,
}

/// Analyses the system and prints the figures.
pub(super) fn report(system: &FoldedSystem, half_field_deg: Option<f64>, as_json: bool) -> Result<()> {
    lens::notes(&system.notes);
    let analysis = system.analysis(half_field_deg)?;
    let report = figures(system, &analysis);
    if as_json { print::json(&report) } else { print::result(&text(&report)) }
}

/// Analyses the system, and returns the figures as JSON.
pub(super) fn json(system: &FoldedSystem, half_field_deg: Option<f64>) -> Result<String> {
    let analysis = system.analysis(half_field_deg)?;
    Ok(serde_json::to_string(&figures(system, &analysis)).expect("reports have text keys and no fallible values"))
}

fn figures<'a>(system: &'a FoldedSystem, analysis: &FoldedAnalysis) -> FoldedReport<'a> {
    let spot = |(line, rms_mm): (&(&'static str, f64), f64)| FoldedSpotReport { line: line.0, rms_mm };
    let field = |field: &FoldedField| FoldedFieldReport {
        angle_deg: field.angle_deg,
        image_x_mm: field.centroid_mm.x,
        image_height_mm: field.centroid_mm.y,
        spots: LINES.iter().zip(field.rms_mm).map(spot).collect(),
        passing: field.passing,
    };
    FoldedReport {
        name: &system.name,
        surfaces: system.surfaces.len(),
        mirrors: system.mirrors(),
        efl_mm: analysis.efl_mm[0],
        efl_x_mm: analysis.efl_mm[1],
        bfd_mm: analysis.back_focus_mm[0],
        bfd_x_mm: analysis.back_focus_mm[1],
        image_distance_mm: analysis.image_distance_mm,
        f_number: analysis.f_number,
        entrance_diameter_mm: analysis.entrance_mm,
        half_field_deg: analysis.half_field_deg,
        fields: analysis.fields.iter().map(field).collect(),
    }
}

fn text(report: &FoldedReport<'_>) -> String {
    let FoldedReport { name, surfaces, mirrors, .. } = report;
    let mut text = format!("{name} ({surfaces} surfaces, {mirrors} of them mirrors)\n");
    let pair = |along_y: f64, along_x: f64| {
        if (along_y - along_x).abs() <= 1e-5 * along_y.abs() {
            format!("{along_y:.4} mm")
        } else {
            format!("{along_y:.4} mm along y, {along_x:.4} mm along x")
        }
    };
    for (label, value) in [
        ("focal length", pair(report.efl_mm, report.efl_x_mm)),
        ("back focus", pair(report.bfd_mm, report.bfd_x_mm) + " from the last surface"),
        ("image plane", format!("{:.4} mm from the last surface, as in the file", report.image_distance_mm)),
        ("f-number", format!("{:.4}", report.f_number)),
        ("entrance", format!("{:.4} mm wide", report.entrance_diameter_mm)),
    ] {
        text += &format!("{label:<15} {value}\n");
    }
    text += "\nfield       image x     image y   spot radius (RMS) in F, d, C     passing\n";
    for field in &report.fields {
        let spots = field.spots.iter().map(|spot| format!("{:>9.2}", 1e3 * spot.rms_mm)).collect::<String>();
        let FoldedFieldReport { angle_deg, image_x_mm, image_height_mm, passing, .. } = field;
        let angle = format!("{angle_deg:.2}°");
        // Rounded before it is printed, so that no zero has a sign.
        let rounded = |mm: f64| (1e3 * mm).round() / 1e3 + 0.0;
        let (image_x_mm, image_height_mm) = (rounded(*image_x_mm), rounded(*image_height_mm));
        text += &format!(
            "{angle:<7} {image_x_mm:>8.3} mm {image_height_mm:>8.3} mm {spots} µm {:>7.1} %\n",
            100.0 * passing
        );
    }
    text
}
