//! `abbe lens`: analyses a lens of several elements.

use std::path::{Path, PathBuf};

use abbe_optics::lens::folded::FoldedSystem;
use abbe_optics::lens::image_quality::FAN_PUPIL;
use abbe_optics::lens::zemax::ZmxSystem;
use abbe_optics::lens::{AnalysisConditions, LensAnalysis, LineFocus, Pupil, SensorFocus};
use abbe_session::output::file;
use abbe_spectra::error::{Error, Result};

use super::{Outcome, folded_lens, print, values};
use crate::reports::folded_lens::FoldedLensReport;
use crate::reports::folded_plots;
use crate::reports::lens::{FieldReport, LensList, LensListing, LensReport, find};
use crate::reports::lens_page;
use crate::reports::lens_plots::{self, LensPlot};

#[derive(Debug, clap::Args)]
pub(crate) struct LensArgs {
    /// The name of a built-in lens, or a file with a prescription: JSON, Zemax (.zmx), CODE V
    /// (.seq), OSLO (.len) or the Optical Bench of photonstophotos.net (.txt)
    #[arg(value_name = "NAME|FILE", required_unless_present = "list")]
    lens: Option<String>,
    /// Half the field of view in degrees [default: the field of the design, or at most 20 if the
    /// design states none]
    #[arg(long, value_name = "DEG", value_parser = values::half_field_deg)]
    field: Option<f64>,
    /// Analyse these wavelengths, at most 6, instead of the F, d and C lines: `450,550,650` or
    /// `450:650:50`. The middle one is the reference wavelength
    #[arg(long, value_name = "NM,...", value_parser = values::wavelengths, conflicts_with = "list")]
    wavelengths: Option<values::WavelengthList>,
    /// Place the sensor this far behind the paraxial focus of the reference wavelength, or with
    /// `best` where the spots of all fields are smallest [default: 0]
    #[arg(
        long, value_name = "MM|best", value_parser = values::sensor_focus, allow_hyphen_values = true,
        conflicts_with = "list"
    )]
    focus: Option<SensorFocus>,
    /// Look up the glasses of a lens file, except JSON, in this catalogue (.agf), or in all
    /// catalogues of this folder, first (repeatable) [default: the files and folders of
    /// ABBE_GLASS_PATH, the catalogues that the file names, if they are in its folder, and then the
    /// built-in catalogue]
    #[arg(long = "glass-catalogue", visible_alias = "glasses", value_name = "FILE|FOLDER", conflicts_with = "list")]
    glasses: Vec<PathBuf>,
    /// Draw the plot of `--plot`, by default the cross-section with rays
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// What `--svg` draws
    #[arg(long, value_name = "PLOT", value_enum, default_value_t = LensPlot::Section, requires = "svg")]
    plot: LensPlot,
    /// Write a page for A4 paper with all figures and plots
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// List all built-in lenses
    #[arg(long, conflicts_with_all = ["lens", "field", "svg", "html"])]
    list: bool,
}

pub(crate) fn run(arguments: &LensArgs) -> Result<Outcome> {
    match &arguments.lens {
        Some(name) => one(name, arguments)?,
        None => list(arguments.json)?,
    }
    Ok(Outcome::Done)
}

fn one(name: &str, arguments: &LensArgs) -> Result<()> {
    for output in [&arguments.svg, &arguments.html] {
        let inputs = arguments.glasses.iter().map(PathBuf::as_path).chain([Path::new(name)]);
        file::check_keeps_inputs(output.as_deref(), inputs)?;
    }
    let mut conditions = AnalysisConditions::default().with_half_field(arguments.field);
    if let Some(wavelengths) = &arguments.wavelengths {
        conditions = conditions.with_wavelengths(&wavelengths.0)?;
    }
    if let Some(focus) = arguments.focus {
        conditions = conditions.with_focus(focus);
    }
    let lens = match find(name, &arguments.glasses)? {
        ZmxSystem::Lens(lens) => lens,
        ZmxSystem::Folded(system) => return folded(&system, conditions, arguments),
    };
    notes(lens.notes());
    let analysis = LensAnalysis::under(&lens, conditions)?;
    if let Some(path) = &arguments.svg {
        file::write_whole(path, lens_plots::svg(arguments.plot, &lens, &analysis)?.as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        file::write_whole(path, lens_page::page(&lens, &analysis)?.as_bytes())?;
    }
    let report = LensReport::of(&lens, &analysis)?;
    if arguments.json { print::json(&report) } else { print::result(&text(&report, &analysis)) }
}

fn folded(system: &FoldedSystem, conditions: AnalysisConditions, arguments: &LensArgs) -> Result<()> {
    if arguments.focus.is_some() {
        let what = "a system with mirrors, tilts or other surfaces without a common axis is analysed at the image \
                    plane of its file";
        return Err(Error::input(what).expected("no --focus"));
    }
    notes(&system.notes);
    let analysis = system.analysis(conditions)?;
    if let Some(path) = &arguments.svg {
        file::write_whole(path, folded_plots::svg(arguments.plot, system, &analysis)?.as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        file::write_whole(path, folded_plots::page(system, &analysis)?.as_bytes())?;
    }
    let report = FoldedLensReport::of(system, &analysis);
    if arguments.json {
        return print::json(&report);
    }
    let names: Vec<&str> = analysis.conditions.lines().iter().map(|line| line.name.as_ref()).collect();
    print::result(&folded_lens::text(&report, &names))
}

fn notes(notes: &[String]) {
    notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
}

fn list(json: bool) -> Result<()> {
    let list = LensList::built_in()?;
    if json {
        return print::json(&list);
    }
    let line = |lens: &LensListing<'_>| {
        let LensListing { name, efl_mm, f_number, half_field_deg, surfaces } = lens;
        let f_number = f_number.unwrap_or(f64::INFINITY);
        format!("{name:<28} {efl_mm:>8.2} mm  f/{f_number:<5.2} ±{half_field_deg:<5} {surfaces:>2} surfaces\n")
    };
    print::result(&list.lenses.iter().map(line).collect::<String>())
}

fn text(report: &LensReport<'_>, analysis: &LensAnalysis) -> String {
    let lines = analysis.conditions.lines();
    let reference = &lines[analysis.conditions.reference()].name;
    let [shortest, longest] = [&lines[0].name, &lines[lines.len() - 1].name];
    let is_default = lines == AnalysisConditions::default().lines();
    let mut text = format!("{} ({} surfaces, {:.3} mm long)\n", report.name, report.surfaces, report.length_mm);
    let pupil = |pupil: &Option<Pupil>| match pupil {
        Some(Pupil { z_mm, diameter_mm }) => {
            format!("{diameter_mm:.4} mm wide, {z_mm:.4} mm from the first surface")
        }
        None => "at infinity".to_string(),
    };
    let f_number = report.f_number.map_or("undefined".to_string(), |f_number| format!("{f_number:.4}"));
    let colour = format!("{shortest}' - {longest}'");
    let at = if is_default { String::new() } else { format!(" at {reference}{}", unit(reference)) };
    for (name, value) in [
        ("focal length", format!("{:.4} mm{at}", report.efl_mm)),
        ("back focus", format!("{:.4} mm from the last surface to the sensor", report.bfd_mm)),
        ("f-number", f_number),
        ("entrance pupil", pupil(&report.entrance_pupil)),
        ("exit pupil", pupil(&report.exit_pupil)),
        (
            colour.as_str(),
            format!("{:+.4} mm of the back focus (longitudinal chromatic aberration)", report.fc_shift_mm),
        ),
        ("best focus", format!("{:+.4} mm from the paraxial focus", report.best_focus_shift_mm)),
        ("sensor", format!("{:+.4} mm from the paraxial focus", report.focus_shift_mm)),
    ] {
        // One wavelength has no longitudinal colour.
        if lines.len() > 1 || name != colour {
            text += &format!("{name:<15} {value}\n");
        }
    }
    text += "\nline         nm   focal length     back focus   transmittance\n";
    for LineFocus { line, wavelength_nm: nm, efl_mm, bfd_mm, transmittance } in &report.lines {
        let percent = 100.0 * transmittance;
        text += &format!("{line:<4} {nm:>10.4} {efl_mm:>11.4} mm {bfd_mm:>11.4} mm {percent:>13.3} %\n");
    }
    let names = lines.iter().map(|line| line.name.as_ref()).collect::<Vec<_>>().join(", ");
    text += &format!("\nfield       height  distortion  lateral colour   spot radius (RMS) in {names}\n");
    for field in &report.fields {
        let distortion = field.distortion.map_or("-".to_string(), |fraction| format!("{:+.3} %", 100.0 * fraction));
        let spots = field.spots.iter().map(|spot| format!("{:>9.2}", 1e3 * spot.rms_mm)).collect::<String>();
        let (angle, height) = (format!("{:.2}°", field.angle_deg), field.image_height_mm);
        let colour_um = 1e3 * field.lateral_colour_mm;
        text += &format!("{angle:<7} {height:>7.3} mm {distortion:>11} {colour_um:>12.2} µm {spots} µm\n");
    }
    text += &quality_text(&report.fields, reference);
    text += &report.source.map_or(String::new(), |source| format!("\nsource          {source}\n"));
    text
}

/// Returns the unit of the name of a wavelength, if the name is a number.
fn unit(name: &str) -> &'static str {
    if name.parse::<f64>().is_ok() { " nm" } else { "" }
}

/// Returns the tables of the MTF and of the ray fans.
fn quality_text(fields: &[FieldReport], reference: &str) -> String {
    let mut text = "\nMTF (geometric, times the limit of diffraction), tangential and sagittal\nfield  ".to_string();
    let frequencies = fields.first().map_or(&[][..], |field| &field.mtf);
    text += &frequencies.iter().map(|point| format!("{:>10} /mm", point.per_mm)).collect::<String>();
    for FieldReport { angle_deg, mtf, .. } in fields {
        let cells = mtf.iter().map(|point| format!("{:>9.2} {:.2}", point.tangential, point.sagittal));
        text += &format!("\n{:<7}{}", format!("{angle_deg:.2}°"), cells.collect::<String>());
    }
    let limits = frequencies.iter().map(|point| format!("{:>14.2}", point.diffraction_limit));
    text += &format!("\nlimit  {}\n", limits.collect::<String>());
    let line = if unit(reference).is_empty() { format!("the {reference} line") } else { format!("{reference} nm") };
    text += &format!("\nray fans of {line}: transverse aberration in µm by the height in the pupil\nfield    ");
    text += &FAN_PUPIL.iter().map(|p| format!("{p:>8.2}")).collect::<String>();
    for FieldReport { angle_deg, ray_fans, .. } in fields {
        for fan in ray_fans.iter().filter(|fan| fan.line == reference) {
            for (plane, values) in [("y", fan.tangential_mm), ("x", fan.sagittal_mm)] {
                let cell = |value: Option<f64>| value.map_or("-".to_string(), |mm| format!("{:.1}", 1e3 * mm));
                let cells = values.map(|value| format!("{:>8}", cell(value))).concat();
                text += &format!("\n{:<7}{plane} {cells}", format!("{angle_deg:.2}°"));
            }
        }
    }
    text + "\n"
}
