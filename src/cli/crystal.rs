//! `abbe crystal`: the indices, the walk-off and the interference colours of a crystal.

use std::path::{Path, PathBuf};

use abbe_polarisation::crystal::{CRYSTAL_NAMES, Crystal};
use abbe_session::output::{file, png};
use abbe_spectra::error::{Error, Result};

use super::spectrum::light;
use super::{Outcome, print, values};
use crate::reports::crystal::{CrystalIndex, CrystalReport, CrystalRequest, StripColour, strip};

#[derive(Debug, clap::Args)]
pub(crate) struct CrystalArgs {
    /// The name of a uniaxial crystal, such as calcite
    #[arg(value_name = "NAME", required_unless_present = "list")]
    name: Option<String>,
    /// Print the indices at these wavelengths in nm [default: the Fraunhofer lines]
    #[arg(long, value_name = "NM,...", value_delimiter = ',', value_parser = values::wavelength_nm)]
    at: Vec<f64>,
    /// The angle between the optic axis and the wave vector in degrees, for the index and the
    /// walk-off of the extraordinary wave
    #[arg(long, value_name = "DEG", value_parser = values::incidence_deg, default_value_t = 45.0)]
    axis_angle: f64,
    /// Print the colours of plates of these thicknesses in µm between crossed polarisers [default:
    /// path differences from 0 to 2500 nm]
    #[arg(long, value_name = "UM,...", value_delimiter = ',', value_parser = values::thickness_um)]
    thickness: Vec<f64>,
    /// The light behind the first polariser: a name of the library, a file or JSON
    #[arg(long, value_name = "LIGHT", default_value = "D65")]
    lamp: String,
    /// Draw the Michel-Lévy strip
    #[arg(short = 'o', long, value_name = "FILE.png|FILE.svg")]
    output: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// List all crystals
    #[arg(long, conflicts_with_all = ["name", "at", "axis_angle", "thickness", "lamp", "output"])]
    list: bool,
}

pub(crate) fn run(arguments: &CrystalArgs) -> Result<Outcome> {
    match &arguments.name {
        Some(name) => one(name, arguments)?,
        None if arguments.json => print::json(&serde_json::json!({ "crystals": CRYSTAL_NAMES }))?,
        None => print::result(&CRYSTAL_NAMES.map(|name| format!("{name}\n")).concat())?,
    }
    Ok(Outcome::Done)
}

fn one(name: &str, arguments: &CrystalArgs) -> Result<()> {
    file::check_keeps_inputs(arguments.output.as_deref(), [&arguments.lamp])?;
    let (crystal, lamp) = (Crystal::find(name)?, light(&arguments.lamp)?);
    let request = CrystalRequest {
        nm: &arguments.at,
        axis_angle_deg: arguments.axis_angle,
        thickness_um: &arguments.thickness,
        lamp: &lamp.spectrum,
        lamp_name: &lamp.name,
    };
    let report = CrystalReport::of(&crystal, &request)?;
    if let Some(path) = &arguments.output {
        draw(path, &crystal, &request)?;
    }
    if arguments.json { print::json(&report) } else { print::result(&text(&report)) }
}

fn draw(path: &Path, crystal: &Crystal, request: &CrystalRequest<'_>) -> Result<()> {
    let has_extension = |known: &str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(known));
    let strip = strip(crystal, request.lamp, request.lamp_name);
    if has_extension("png") {
        return png::write(path, &strip.picture());
    }
    if has_extension("svg") {
        return file::write_whole(path, strip.svg()?.as_bytes());
    }
    let error = Error::input(format!("the picture {} has no known extension", path.display()));
    Err(error.expected("a name that ends in .png or .svg"))
}

fn text(report: &CrystalReport) -> String {
    let [from, to] = report.range_nm;
    let angle = report.axis_angle_deg;
    let mut text = format!("{} (uniaxial, valid from {from} to {to} nm)\n", report.name);
    text += &format!("extraordinary wave at {angle}° to the optic axis: index n, walk-off away from the axis\n");
    text += "      nm       n_o       n_e   n_e-n_o         n   walk-off\n";
    for CrystalIndex { nm, n_o, n_e, birefringence, n_wave, walk_off_deg } in &report.index {
        text += &format!("{nm:>8.3} {n_o:>9.6} {n_e:>9.6} {birefringence:>9.6} {n_wave:>9.6} {walk_off_deg:>9.4}°\n");
    }
    text += &format!("between crossed polarisers under {}, axis in the plate at 45°\n", report.michel_levy.lamp);
    text += "path (nm)  thickness (µm)        Y        x        y  sRGB\n";
    for StripColour { path_difference_nm, thickness_um, xyz, xy, srgb_hex } in &report.michel_levy.plates {
        let [x, y] = xy.map_or(["-".to_string(), "-".to_string()], |xy| xy.map(|value| format!("{value:.4}")));
        text += &format!("{path_difference_nm:>9.1} {thickness_um:>15.4} {:>8.5} {x:>8} {y:>8}  {srgb_hex}\n", xyz[1]);
    }
    text += &format!("source {}\n", report.source);
    text += &report.warning.as_ref().map_or(String::new(), |warning| format!("note   {warning}\n"));
    text
}
