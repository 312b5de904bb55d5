//! `abbe film`: powers, amplitudes and colours of a stack of thin films.

use std::path::{Path, PathBuf};

use abbe_format::resolve::lone_coating;
use abbe_format::{self as format, CoatingFile, JsonSource};
use abbe_session::output::file;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::hypot;
use abbe_spectra::spectrum::BAND_NM;

use super::spectrum::light;
use super::values::{self, WavelengthList};
use super::{Outcome, print};
use crate::reports::film::{FilmAmplitudes, FilmAngle, FilmReport, plot};

#[derive(Debug, clap::Args)]
pub(crate) struct FilmArgs {
    /// A stack of films as JSON, or a file with it: `{"incident": "air", "layers": [{"ior": "MgF2",
    /// "thickness_nm": 100}], "substrate": "N-BK7"}`. It has the form of a `coating` in a scene
    #[arg(value_name = "FILE.json|JSON")]
    stack: String,
    /// Angles of incidence in degrees
    #[arg(long, value_name = "DEG,...", value_delimiter = ',', value_parser = values::incidence_deg)]
    #[arg(default_values_t = [0.0])]
    angle: Vec<f64>,
    /// Wavelengths in nm: a list such as 450,550, or a range FROM:TO:STEP [default: 360:830:1 with
    /// --json, 400:700:25 otherwise]
    #[arg(long, value_name = "NM,...", value_parser = values::wavelengths)]
    wavelengths: Option<WavelengthList>,
    /// The light that the films reflect and transmit: a name of the library, a file or JSON
    #[arg(long, value_name = "LIGHT", default_value = "D65")]
    lamp: String,
    /// Plot reflectance and transmittance against wavelength
    #[arg(short = 'o', long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The wavelengths of the table if none are given.
const TABLE_NM: (u32, u32, usize) = (400, 700, 25);

pub(crate) fn run(arguments: &FilmArgs) -> Result<Outcome> {
    file::check_keeps_inputs(arguments.svg.as_deref(), [&arguments.stack, &arguments.lamp])?;
    let (file, source) = stack(&arguments.stack)?;
    let system = lone_coating(&file, &source)?;
    let lamp = light(&arguments.lamp)?;
    let whole_band = || (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let table = || (TABLE_NM.0..=TABLE_NM.1).step_by(TABLE_NM.2).map(f64::from).collect();
    let default = || if arguments.json { whole_band() } else { table() };
    let wavelengths = arguments.wavelengths.as_ref().map_or_else(default, |list| list.0.clone());
    if let Some(path) = &arguments.svg {
        file::write_whole(path, plot(&system, &arguments.angle).svg().as_bytes())?;
    }
    let report = FilmReport::of(&system, &arguments.angle, &wavelengths, &lamp.spectrum);
    if arguments.json {
        print::json(&report)?;
    } else {
        print::result(&text(&report, &lamp.name))?;
    }
    Ok(Outcome::Done)
}

/// Reads the stack that an argument states: JSON, or the path of a file.
fn stack(argument: &str) -> Result<(CoatingFile, JsonSource)> {
    if argument.trim_start().starts_with('{') {
        return format::parse_coating(argument, Path::new("the command line"));
    }
    let path = Path::new(argument);
    if !path.exists() {
        let error = Error::input(format!("{argument} is neither a file nor a JSON object"));
        return Err(error.expected(r#"a stack of films such as {"layers": [{"ior": "MgF2", "thickness_nm": 100}]}"#));
    }
    format::parse_coating(&format::read_text(path)?, path)
}

fn text(report: &FilmReport, lamp: &str) -> String {
    let mut text = String::new();
    for angle in &report.angles {
        let FilmAngle { degrees, wavelength_nm, reflectance: r, transmittance: t, xy, .. } = angle;
        text += &format!("{degrees}° of incidence\n      nm        R      R_s      R_p        T      T_s      T_p\n");
        for (i, nm) in wavelength_nm.iter().enumerate() {
            let cell = |list: &[f64]| format!("{:>8.3} %", 100.0 * list[i]).replace(" %", "%");
            let cells = [&r.mean, &r.s, &r.p, &t.mean, &t.s, &t.p].map(|list| cell(list)).concat();
            text += &format!("{nm:>8}{cells}\n");
        }
        text += &amplitudes(angle);
        for (name, colour) in [("reflected", xy.reflected), ("transmitted", xy.transmitted)] {
            text += &match colour {
                Some([x, y]) => format!("{name} light under {lamp}: xy ({x:.5}, {y:.5})\n"),
                None => format!("{name} light under {lamp}: none\n"),
            };
        }
    }
    text + CONVENTIONS
}

/// Explains the columns of [`amplitudes`].
const CONVENTIONS: &str = "\
r, t: ratios of electric fields that vary as exp(-iωt), at the outer faces; r_p = -r_s at 0°
Ψ, Δ: r_p/r_s = tan Ψ exp(iΔ) for fields that vary as exp(+iωt)
";

/// Returns the table of the absolute values and phases of the amplitudes, and of Ψ and Δ.
fn amplitudes(angle: &FilmAngle) -> String {
    let mut text = "      nm   |r_s|   arg°   |r_p|   arg°   |t_s|   arg°   |t_p|   arg°      Ψ°      Δ°\n".to_string();
    for (i, nm) in angle.wavelength_nm.iter().enumerate() {
        let cells = |field: &FilmAmplitudes| {
            let cell = |[re, im]: [f64; 2], phase: f64| format!("{:>8.5}{phase:>7.1}", hypot(re, im));
            cell(field.s[i], field.phase_s_deg[i]) + &cell(field.p[i], field.phase_p_deg[i])
        };
        let (reflected, transmitted) = (cells(&angle.reflected_field), cells(&angle.transmitted_field));
        let (psi, delta) = (angle.ellipsometry.psi_deg[i], angle.ellipsometry.delta_deg[i]);
        text += &format!("{nm:>8}{reflected}{transmitted}{psi:>8.3}{delta:>8.2}\n");
    }
    text
}
