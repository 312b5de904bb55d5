//! The plots and the page of a system that is no camera lens.

use abbe_optics::lens::folded::{FieldFoci, FoldedAnalysis, FoldedSystem};
use abbe_optics::lens::section::DrawnRay;
use abbe_session::output::drawing::{LensDrawing, RayStroke};
use abbe_session::output::lens_page::{self, LensPage, PageSection, PageTable};
use abbe_session::output::plot_grid::PlotGrid;
use abbe_session::output::spot_figure::SpotFigure;
use abbe_spectra::error::{Error, Result};
use glam::DVec3;

use super::folded_lens::{FoldedFieldReport, FoldedLensReport};
use super::lens::{line_colour, line_name};
use super::lens_plots::{LensPlot, fan_grid, foci_grid, mtf_grid, number, short_name, spot_figure};

/// Returns a plot as an SVG document that contains the name of the system. Returns an error for a
/// plot that needs an axis of symmetry, or a focus that the system lacks.
pub fn svg(plot: LensPlot, system: &FoldedSystem, analysis: &FoldedAnalysis) -> Result<String> {
    let titled = |what: &str| format!("{}: {what}", system.name);
    Ok(match plot {
        LensPlot::Section => drawing(system, analysis)?.svg(),
        LensPlot::Spots => SpotFigure { title: titled("spot diagrams"), ..spots(system, analysis) }.svg(),
        LensPlot::RayFans => PlotGrid { title: titled("ray fans"), ..fans(system, analysis)? }.svg(),
        LensPlot::Mtf => PlotGrid { title: titled("MTF"), ..mtf_grid(&system.mtf(analysis)?) }.svg(),
        LensPlot::FieldCurves => {
            PlotGrid { title: titled("field curvature"), ..foci(system, analysis, &system.field_foci(analysis)?) }.svg()
        }
        LensPlot::ThroughFocus | LensPlot::LateralColour | LensPlot::Illumination | LensPlot::AxialColour => {
            let what = "this plot needs a lens with an axis of symmetry and a real image";
            return Err(Error::input(what).expected("section, spots, ray-fans, mtf or field-curves"));
        }
    })
}

/// Returns the page, without the plots that the system cannot have.
pub fn page(system: &FoldedSystem, analysis: &FoldedAnalysis) -> Result<String> {
    let report = FoldedLensReport::of(system, analysis);
    let names: Vec<String> = analysis.conditions.lines().iter().map(line_name).collect();
    let object = report.object_mm.map_or("Distant object".to_string(), |mm| {
        format!("Object {} mm in front of the first surface", number(mm, 3))
    });
    let mut sections = vec![section("Spot diagrams", spots(system, analysis).svg(), SPOTS)];
    sections.push(section("Ray fans", fans(system, analysis)?.svg(), FANS));
    if let Ok(curves) = system.mtf(analysis) {
        sections.push(section("Modulation transfer function", mtf_grid(&curves).svg(), MTF));
    }
    if let Ok(curves) = system.field_foci(analysis) {
        sections.push(section("Field curvature", foci(system, analysis, &curves).svg(), FOCI));
    }
    Ok(lens_page::page(&LensPage {
        title: system.name.clone(),
        conditions: format!("{object}; wavelengths {}; image plane of the file.", names.join("; ")),
        source: None,
        notes: system.notes.clone(),
        figures: figures(&report),
        section: drawing(system, analysis)?.svg(),
        prescription: prescription(system),
        sections,
        fields: fields(analysis, &report),
    }))
}

fn section(heading: &str, figure: String, caption: &str) -> PageSection {
    PageSection { heading: heading.to_string(), figures: vec![figure], caption: caption.to_string() }
}

fn unit(system: &FoldedSystem) -> &'static str {
    if system.object_mm.is_some() { " mm" } else { "°" }
}

fn spots(system: &FoldedSystem, analysis: &FoldedAnalysis) -> SpotFigure {
    spot_figure(analysis.conditions.lines(), &system.spots(analysis), unit(system))
}

fn fans(system: &FoldedSystem, analysis: &FoldedAnalysis) -> Result<PlotGrid> {
    Ok(fan_grid(analysis.conditions.lines(), &system.fans(analysis)?, unit(system)))
}

fn foci(system: &FoldedSystem, analysis: &FoldedAnalysis, curves: &FieldFoci) -> PlotGrid {
    let field = if system.object_mm.is_some() { "height of the object in mm" } else { "field angle in °" };
    foci_grid(analysis.conditions.lines(), field, &curves.fields, [&curves.sagittal_mm, &curves.tangential_mm])
}

fn drawing(system: &FoldedSystem, analysis: &FoldedAnalysis) -> Result<LensDrawing> {
    let section = system.section(analysis)?;
    let stroke = |ray: DrawnRay| RayStroke { colour: ray.line, window: ray.field, points: ray.points };
    let lines = analysis.conditions.lines();
    let focal = analysis.efl_mm[0].map_or("no power".to_string(), |mm| format!("f = {} mm", number(mm, 2)));
    let f_number = analysis.f_number.map_or(String::new(), |f_number| format!(", f/{f_number:.2}"));
    let plane = if section.leaves_plane { "; projected onto the yz plane, which the light leaves" } else { "" };
    Ok(LensDrawing {
        title: system.name.clone(),
        caption: format!("{focal}{f_number}, {} mirrors{plane}", system.mirrors()),
        glass: section.elements,
        sheets: section.sheets,
        stop: section.stop,
        sensor: section.image,
        strokes: section.rays.into_iter().map(stroke).collect(),
        colours: lines.iter().map(|line| (line_name(line), line_colour(line))).collect(),
        windows: Vec::new(),
    })
}

fn figures(report: &FoldedLensReport<'_>) -> Vec<(String, String)> {
    let mm = |value: Option<f64>| value.map_or("none".to_string(), |mm| format!("{} mm", number(mm, 4)));
    let f_number = report.f_number.map_or("undefined".to_string(), |f_number| number(f_number, 3));
    [
        ("focal length along y", mm(report.efl_mm)),
        ("focal length along x", mm(report.efl_x_mm)),
        ("back focus along y", mm(report.bfd_mm)),
        ("back focus along x", mm(report.bfd_x_mm)),
        ("image plane from the last surface", mm(Some(report.image_distance_mm))),
        ("f-number", f_number),
        ("diameter of the entrance pupil", mm(Some(report.entrance_diameter_mm))),
        ("surfaces, of them mirrors", format!("{}, {}", report.surfaces, report.mirrors)),
    ]
    .map(|(name, value)| (name.to_string(), value))
    .to_vec()
}

fn prescription(system: &FoldedSystem) -> PageTable {
    let header = ["surface", "x", "y", "z", "normal", "n_d", "V_d", "remarks"];
    let rows = system.surfaces.iter().enumerate().map(|(i, surface)| {
        let place = surface.frame.translation;
        let normal = surface.frame.transform_vector3(DVec3::Z).to_array().map(|cosine| number(cosine, 4));
        let mut remarks = vec![surface.describe()];
        remarks.extend((i == system.stop).then(|| "stop".to_string()));
        let glass = surface.index.as_ref().filter(|index| index.nd() != 1.0);
        let medium = if surface.index.is_none() { "mirror" } else { "air" };
        let mut row = vec![(i + 1).to_string()];
        row.extend(place.to_array().map(|mm| number(mm, 4)));
        row.push(normal.join(" "));
        row.push(glass.map_or(medium.to_string(), |index| number(index.nd(), 5)));
        row.push(glass.and_then(|index| index.vd()).map_or(String::new(), |vd| number(vd, 2)));
        row.push(remarks.join("; "));
        row
    });
    PageTable { header: header.map(str::to_string).to_vec(), rows: rows.collect() }
}

fn fields(analysis: &FoldedAnalysis, report: &FoldedLensReport<'_>) -> PageTable {
    let mut header: Vec<String> = ["field", "image x\nmm", "image y\nmm", "passing\n%"].map(str::to_string).to_vec();
    let lines = analysis.conditions.lines();
    header.extend(lines.iter().map(|line| format!("RMS\n{}\nµm", short_name(line))));
    let row = |field: &FoldedFieldReport| {
        let mm = |value: Option<f64>| value.map_or("–".to_string(), |mm| number(mm, 3));
        let name = field.angle_deg.map_or_else(|| mm(field.object_height_mm) + " mm", |deg| number(deg, 2) + "°");
        let mut row = vec![name, mm(field.image_x_mm), mm(field.image_height_mm), number(100.0 * field.passing, 1)];
        row.extend(field.spots.iter().map(|spot| number(1e3 * spot.rms_mm, 2)));
        row.resize(4 + lines.len(), "–".to_string());
        row
    };
    PageTable { header, rows: report.fields.iter().map(row).collect() }
}

const SPOTS: &str = "Rays of a point of the object that fill the entering bundle evenly, where they reach the image \
    plane of the file. Each square is centred on the centroid of the rays of all wavelengths.";
const FANS: &str = "Distance on the image plane, along y and along x, between a ray and the chief ray of the reference \
    wavelength, against the height of the ray in the entering bundle along the same axis, divided by half of the width \
    of the bundle. Blocked rays are left out.";
const MTF: &str = "Geometric MTF: the contrast of the ray spots of all wavelengths with equal weights, multiplied by the \
    MTF of a perfect lens with the same f-number and a full round pupil. The diffraction of the aberrated wave and of an \
    obscuration is not computed.";
const FOCI: &str = "Foci of thin bundles around the chief ray of each wavelength in the yz plane (T) and perpendicular to \
    it (S), measured along the normal of the image plane, positive behind it.";
