//! `abbe lens`: analyses a lens of several elements.

use std::path::{Path, PathBuf};

use abbe_optics::lens::image_quality::FAN_PUPIL;
use abbe_optics::lens::zemax::ZmxSystem;
use abbe_optics::lens::{LensAnalysis, LineFocus, Pupil};
use abbe_session::output::file;
use abbe_spectra::error::{Error, Result};

use super::{Outcome, folded_lens, print, values};
use crate::reports::folded_lens::FoldedLensReport;
use crate::reports::lens::{FieldReport, LensList, LensListing, LensReport, drawing, find};

#[derive(Debug, clap::Args)]
pub(crate) struct LensArgs {
    /// The name of a built-in lens, or a file with a prescription: JSON, Zemax (.zmx) or CODE V
    /// (.seq)
    #[arg(value_name = "NAME|FILE", required_unless_present = "list")]
    lens: Option<String>,
    /// Half the field of view in degrees [default: the field of the design, or at most 20 if the
    /// design states none]
    #[arg(long, value_name = "DEG", value_parser = values::half_field_deg)]
    field: Option<f64>,
    /// Look up the glasses of a Zemax or CODE V file in this catalogue (.agf), or in all catalogues
    /// of this folder, first (repeatable) [default: the files and folders of ABBE_GLASS_PATH, the
    /// catalogues that the file names, if they are in its folder, and then the built-in catalogue]
    #[arg(long = "glass-catalogue", visible_alias = "glasses", value_name = "FILE|FOLDER", conflicts_with = "list")]
    glasses: Vec<PathBuf>,
    /// Draw the cross-section with rays of the F, d and C lines
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// List all built-in lenses
    #[arg(long, conflicts_with_all = ["lens", "field", "svg"])]
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
    let inputs = arguments.glasses.iter().map(PathBuf::as_path).chain([Path::new(name)]);
    file::check_keeps_inputs(arguments.svg.as_deref(), inputs)?;
    let lens = match find(name, &arguments.glasses)? {
        ZmxSystem::Lens(lens) => lens,
        ZmxSystem::Folded(system) => {
            if arguments.svg.is_some() {
                let error = Error::input("a system with mirrors or coordinate breaks cannot be drawn yet");
                return Err(error.expected("no --svg"));
            }
            notes(&system.notes);
            let report = FoldedLensReport::of(&system, arguments.field)?;
            return if arguments.json { print::json(&report) } else { print::result(&folded_lens::text(&report)) };
        }
    };
    notes(lens.notes());
    let analysis = LensAnalysis::of(&lens, arguments.field)?;
    if let Some(path) = &arguments.svg {
        file::write_whole(path, drawing(&lens, &analysis)?.svg().as_bytes())?;
    }
    let report = LensReport::of(&lens, &analysis)?;
    if arguments.json { print::json(&report) } else { print::result(&text(&report)) }
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

fn text(report: &LensReport<'_>) -> String {
    let mut text = format!("{} ({} surfaces, {:.3} mm long)\n", report.name, report.surfaces, report.length_mm);
    let pupil = |pupil: &Option<Pupil>| match pupil {
        Some(Pupil { z_mm, diameter_mm }) => {
            format!("{diameter_mm:.4} mm wide, {z_mm:.4} mm from the first surface")
        }
        None => "at infinity".to_string(),
    };
    let f_number = report.f_number.map_or("undefined".to_string(), |f_number| format!("{f_number:.4}"));
    for (name, value) in [
        ("focal length", format!("{:.4} mm", report.efl_mm)),
        ("back focus", format!("{:.4} mm from the last surface to the sensor", report.bfd_mm)),
        ("f-number", f_number),
        ("entrance pupil", pupil(&report.entrance_pupil)),
        ("exit pupil", pupil(&report.exit_pupil)),
        ("F' - C'", format!("{:+.4} mm of the back focus (longitudinal chromatic aberration)", report.fc_shift_mm)),
    ] {
        text += &format!("{name:<15} {value}\n");
    }
    text += "\nline         nm   focal length     back focus   transmittance\n";
    for LineFocus { line, wavelength_nm: nm, efl_mm, bfd_mm, transmittance } in &report.lines {
        let percent = 100.0 * transmittance;
        text += &format!("{line:<4} {nm:>10.4} {efl_mm:>11.4} mm {bfd_mm:>11.4} mm {percent:>13.3} %\n");
    }
    text += "\nfield       height  distortion  lateral colour   spot radius (RMS) in F, d, C\n";
    for field in &report.fields {
        let distortion = field.distortion.map_or("-".to_string(), |fraction| format!("{:+.3} %", 100.0 * fraction));
        let spots = field.spots.iter().map(|spot| format!("{:>9.2}", 1e3 * spot.rms_mm)).collect::<String>();
        let (angle, height) = (format!("{:.2}°", field.angle_deg), field.image_height_mm);
        let colour_um = 1e3 * field.lateral_colour_mm;
        text += &format!("{angle:<7} {height:>7.3} mm {distortion:>11} {colour_um:>12.2} µm {spots} µm\n");
    }
    text += &quality_text(&report.fields);
    text += &report.source.map_or(String::new(), |source| format!("\nsource          {source}\n"));
    text
}

/// Returns the tables of the MTF and of the ray fans.
fn quality_text(fields: &[FieldReport]) -> String {
    let mut text = "\nMTF (geometric, times the limit of diffraction), tangential and sagittal\nfield  ".to_string();
    let frequencies = fields.first().map_or(&[][..], |field| &field.mtf);
    text += &frequencies.iter().map(|point| format!("{:>10} /mm", point.per_mm)).collect::<String>();
    for FieldReport { angle_deg, mtf, .. } in fields {
        let cells = mtf.iter().map(|point| format!("{:>9.2} {:.2}", point.tangential, point.sagittal));
        text += &format!("\n{:<7}{}", format!("{angle_deg:.2}°"), cells.collect::<String>());
    }
    let limits = frequencies.iter().map(|point| format!("{:>14.2}", point.diffraction_limit));
    text += &format!("\nlimit  {}\n", limits.collect::<String>());
    text += "\nray fans of the d line: transverse aberration in µm by the height in the pupil\nfield    ";
    text += &FAN_PUPIL.iter().map(|p| format!("{p:>8.2}")).collect::<String>();
    for FieldReport { angle_deg, ray_fans, .. } in fields {
        for fan in ray_fans.iter().filter(|fan| fan.line == "d") {
            for (plane, values) in [("y", fan.tangential_mm), ("x", fan.sagittal_mm)] {
                let cell = |value: Option<f64>| value.map_or("-".to_string(), |mm| format!("{:.1}", 1e3 * mm));
                let cells = values.map(|value| format!("{:>8}", cell(value))).concat();
                text += &format!("\n{:<7}{plane} {cells}", format!("{angle_deg:.2}°"));
            }
        }
    }
    text + "\n"
}
