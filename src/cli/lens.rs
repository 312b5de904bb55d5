//! `abbe lens`: analyses a lens of several elements.

use std::path::{Path, PathBuf};

use abbe_format::resolve;
use abbe_optics::glass::AgfCatalogue;
use abbe_optics::lens::image_quality::{FAN_PUPIL, ImageQuality, MtfPoint, RayFan};
use abbe_optics::lens::section::{DrawnRay, FocusWindow, LensSection, section};
use abbe_optics::lens::zemax::ZmxSystem;
use abbe_optics::lens::{FieldPoint, LINES, Lens, LensAnalysis, Pupil, catalogue};
use abbe_session::output::drawing::{FocusInset, LensDrawing, RayStroke};
use abbe_session::output::file;
use abbe_spectra::error::{Error, Result};
use serde::Serialize;

use super::{Outcome, folded_lens, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct LensArgs {
    /// The name of a built-in lens, or a file with a prescription in JSON or in Zemax form (.zmx)
    #[arg(value_name = "NAME|FILE", required_unless_present = "list")]
    lens: Option<String>,
    /// Half the field of view in degrees [default: the field of the design, or at most 20 if the
    /// design states none]
    #[arg(long, value_name = "DEG", value_parser = values::half_field_deg)]
    field: Option<f64>,
    /// Look up the glasses of a Zemax file in this catalogue (.agf) first (repeatable) [default:
    /// the catalogues that the file names, if they are in its folder, and then the built-in
    /// catalogue]
    #[arg(long, value_name = "FILE.agf", conflicts_with = "list")]
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

/// The analysis of a lens. The documentation of [`LensAnalysis`] defines the quantities.
#[derive(Debug, Serialize)]
pub(super) struct LensReport<'a> {
    name: &'a str,
    source: Option<&'a str>,
    surfaces: usize,
    length_mm: f64,
    efl_mm: f64,
    bfd_mm: f64,
    fc_shift_mm: f64,
    /// Null if the entrance pupil lies at infinity.
    f_number: Option<f64>,
    entrance_pupil: Option<PupilReport>,
    exit_pupil: Option<PupilReport>,
    lines: Vec<LineReport>,
    half_field_deg: f64,
    fields: Vec<FieldReport>,
}

#[derive(Debug, Serialize)]
struct PupilReport {
    z_mm: f64,
    diameter_mm: f64,
}

#[derive(Debug, Serialize)]
struct LineReport {
    line: &'static str,
    nm: f64,
    efl_mm: f64,
    bfd_mm: f64,
    transmittance: f64,
}

#[derive(Debug, Serialize)]
struct FieldReport {
    angle_deg: f64,
    image_height_mm: f64,
    /// Null for a field point on the axis.
    distortion: Option<f64>,
    lateral_colour_mm: f64,
    spots: Vec<SpotReport>,
    mtf: Vec<MtfReport>,
    ray_fans: Vec<FanReport>,
}

/// The documentation of [`MtfPoint`] defines the quantities.
#[derive(Debug, Serialize)]
struct MtfReport {
    cycles_per_mm: f64,
    tangential: f64,
    sagittal: f64,
    diffraction_limit: f64,
}

/// The documentation of [`RayFan`] defines the quantities. Null stands for a vignetted ray.
#[derive(Debug, Serialize)]
struct FanReport {
    line: &'static str,
    pupil: [f64; FAN_PUPIL.len()],
    tangential_mm: [Option<f64>; FAN_PUPIL.len()],
    sagittal_mm: [Option<f64>; FAN_PUPIL.len()],
}

#[derive(Debug, Serialize)]
struct SpotReport {
    line: &'static str,
    rms_mm: f64,
}

/// An entry of the list.
#[derive(Debug, Serialize)]
struct LensListing<'a> {
    name: &'a str,
    efl_mm: f64,
    f_number: Option<f64>,
    half_field_deg: f64,
    surfaces: usize,
}

#[derive(Debug, Serialize)]
struct LensList<'a> {
    lenses: Vec<LensListing<'a>>,
}

pub(crate) fn run(arguments: &LensArgs) -> Result<Outcome> {
    match &arguments.lens {
        Some(name) => one(name, arguments)?,
        None => list(arguments.json)?,
    }
    Ok(Outcome::Done)
}

fn one(name: &str, arguments: &LensArgs) -> Result<()> {
    let lens = match named(name, &arguments.glasses)? {
        ZmxSystem::Lens(lens) => lens,
        ZmxSystem::Folded(system) => {
            if arguments.svg.is_some() {
                let error = Error::input("a system with mirrors or coordinate breaks cannot be drawn yet");
                return Err(error.expected("no --svg"));
            }
            return folded_lens::report(&system, arguments.field, arguments.json);
        }
    };
    notes(lens.notes());
    let analysis = LensAnalysis::of(&lens, arguments.field)?;
    if let Some(path) = &arguments.svg {
        let drawing = drawing(&lens, &analysis, section(&lens, &analysis)?);
        file::write_whole(path, drawing.svg().as_bytes())?;
    }
    let report = report(&lens, &analysis, &ImageQuality::of(&lens, &analysis)?);
    if arguments.json { print::json(&report) } else { print::result(&text(&report)) }
}

/// Prints the remarks of the reader of a lens file.
pub(crate) fn notes(notes: &[String]) {
    notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
}

/// Returns the lens given by an argument. The catalogues in the files `glasses` are searched first.
pub(super) fn named(name: &str, glasses: &[PathBuf]) -> Result<ZmxSystem> {
    let catalogues: Vec<AgfCatalogue> = glasses.iter().map(|path| resolve::glass_file(path)).collect::<Result<_>>()?;
    let unknown = match catalogue::find(name) {
        Ok(lens) => return Ok(ZmxSystem::Lens(lens.clone())),
        Err(unknown) => unknown,
    };
    let path = Path::new(name);
    // Names of lenses contain blanks and slashes ("Tessar f/4.5"). An argument is a path only if
    // the file exists, or if it has the extension of a lens file.
    let is_lens_file =
        |ending: &std::ffi::OsStr| ["json", "zmx"].iter().any(|known| ending.eq_ignore_ascii_case(known));
    if path.exists() || path.extension().is_some_and(is_lens_file) {
        return resolve::lens_system_file(path, &catalogues);
    }
    Err(unknown.expected("a name of `abbe lens --list`, or a file"))
}

fn list(json: bool) -> Result<()> {
    let mut lenses = Vec::new();
    for lens in catalogue::all() {
        let paraxial = lens.at(LINES[1].1).paraxial()?;
        lenses.push(LensListing {
            name: lens.name(),
            efl_mm: paraxial.efl_mm,
            f_number: paraxial.f_number,
            half_field_deg: lens.half_field_deg().unwrap_or_default(),
            surfaces: lens.surfaces().len(),
        });
    }
    if json {
        return print::json(&LensList { lenses });
    }
    let line = |lens: &LensListing<'_>| {
        let LensListing { name, efl_mm, f_number, half_field_deg, surfaces } = lens;
        let f_number = f_number.unwrap_or(f64::INFINITY);
        format!("{name:<28} {efl_mm:>8.2} mm  f/{f_number:<5.2} ±{half_field_deg:<5} {surfaces:>2} surfaces\n")
    };
    print::result(&lenses.iter().map(line).collect::<String>())
}

pub(super) fn report<'a>(lens: &'a Lens, analysis: &LensAnalysis, quality: &[ImageQuality]) -> LensReport<'a> {
    let LensAnalysis { paraxial, lines, half_field_deg, fields } = analysis;
    let pupil = |Pupil { z_mm, diameter_mm }| PupilReport { z_mm, diameter_mm };
    let spot = |(line, rms_mm): (&(&'static str, f64), f64)| SpotReport { line: line.0, rms_mm };
    let mtf = |MtfPoint { per_mm, tangential, sagittal, diffraction_limit }: &MtfPoint| MtfReport {
        cycles_per_mm: *per_mm,
        tangential: *tangential,
        sagittal: *sagittal,
        diffraction_limit: *diffraction_limit,
    };
    let fan = |RayFan { line, tangential_mm, sagittal_mm }: &RayFan| FanReport {
        line,
        pupil: FAN_PUPIL,
        tangential_mm: *tangential_mm,
        sagittal_mm: *sagittal_mm,
    };
    let field = |(field, quality): (&FieldPoint, &ImageQuality)| FieldReport {
        angle_deg: field.angle_deg,
        image_height_mm: field.image_height_mm,
        distortion: field.distortion,
        lateral_colour_mm: field.lateral_colour_mm,
        spots: LINES.iter().zip(field.spots.map(|spot| spot.rms_mm)).map(spot).collect(),
        mtf: quality.mtf.iter().map(mtf).collect(),
        ray_fans: quality.fans.iter().map(fan).collect(),
    };
    LensReport {
        name: lens.name(),
        source: lens.source(),
        surfaces: lens.surfaces().len(),
        length_mm: lens.length_mm(),
        efl_mm: paraxial.efl_mm,
        bfd_mm: paraxial.bfd_mm,
        fc_shift_mm: analysis.fc_shift_mm(),
        f_number: paraxial.f_number,
        entrance_pupil: paraxial.entrance_pupil.map(pupil),
        exit_pupil: paraxial.exit_pupil.map(pupil),
        lines: lines
            .iter()
            .map(|line| LineReport {
                line: line.line,
                nm: line.wavelength_nm,
                efl_mm: line.efl_mm,
                bfd_mm: line.bfd_mm,
                transmittance: line.transmittance,
            })
            .collect(),
        half_field_deg: *half_field_deg,
        fields: fields.iter().zip(quality).map(field).collect(),
    }
}

fn text(report: &LensReport<'_>) -> String {
    let mut text = format!("{} ({} surfaces, {:.3} mm long)\n", report.name, report.surfaces, report.length_mm);
    let pupil = |pupil: &Option<PupilReport>| match pupil {
        Some(PupilReport { z_mm, diameter_mm }) => {
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
    for LineReport { line, nm, efl_mm, bfd_mm, transmittance } in &report.lines {
        let percent = 100.0 * transmittance;
        text += &format!("{line:<4} {nm:>10.4} {efl_mm:>11.4} mm {bfd_mm:>11.4} mm {percent:>13.3} %\n");
    }
    text += "\nfield       height  distortion  lateral colour   spot radius (RMS) in F, d, C\n";
    for field in &report.fields {
        let distortion = field.distortion.map_or("-".to_string(), |share| format!("{:+.3} %", 100.0 * share));
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
    text += &frequencies.iter().map(|point| format!("{:>10} /mm", point.cycles_per_mm)).collect::<String>();
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

pub(super) fn drawing(lens: &Lens, analysis: &LensAnalysis, section: LensSection) -> LensDrawing {
    let LensSection { elements, stop, sensor, rays, foci } = section;
    let stroke = |ray: DrawnRay| RayStroke { colour: ray.line, window: ray.field, points: ray.points };
    let window = |focus: &FocusWindow| FocusInset {
        title: if focus.angle_deg == 0.0 {
            "focus on the axis".to_string()
        } else {
            format!("focus at {}°, along the bundle", focus.angle_deg)
        },
        centre: focus.centre,
        half_size: focus.half_size,
        slope: focus.slope,
    };
    let colours = LINES.iter().zip(["#1f5fbf", "#d09a00", "#c0302a"]);
    let f_number = analysis.paraxial.f_number.map_or(String::new(), |f_number| format!(", f/{f_number:.2}"));
    LensDrawing {
        title: lens.name().to_string(),
        caption: format!(
            "f = {:.2} mm{f_number}, back focus {:.2} mm, F′ − C′ {:+.4} mm",
            analysis.paraxial.efl_mm,
            analysis.paraxial.bfd_mm,
            analysis.fc_shift_mm()
        )
        .replace('-', "−"),
        glass: elements,
        stop,
        sensor,
        strokes: rays.into_iter().map(stroke).collect(),
        colours: colours.map(|((line, nm), colour)| (format!("{line}, {nm:.1} nm"), colour.to_string())).collect(),
        windows: foci.iter().map(window).collect(),
    }
}
