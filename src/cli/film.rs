//! `abbe film`: the reflectance, the transmittance and the colours of a stack of thin films.

use std::path::{Path, PathBuf};

use super::values::{self, WavelengthList};
use super::{Outcome, named, print};
use abbe_format::resolve::{FilmSystem, lone_coating};
use abbe_format::{self as format, CoatingFile, JsonSource};
use abbe_optics::thin_film::{PolarisedResponse, StackResponse};
use abbe_session::output::file;
use abbe_session::output::plot::{SpectralCurve, SpectralPlot};
use abbe_spectra::colour::xy;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::cos;
use abbe_spectra::spectrum::{BAND_NM, Observer, Spectrum};
use serde::Serialize;

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

/// A value for s polarised, p polarised and unpolarised light, at each wavelength.
#[derive(Debug, Default, Serialize)]
struct Polarised {
    s: Vec<f64>,
    p: Vec<f64>,
    mean: Vec<f64>,
}

impl Polarised {
    /// Adds the values at one wavelength.
    fn push(&mut self, found: &StackResponse, of: impl Fn(&PolarisedResponse) -> f64) {
        let (s, p) = (of(&found.s), of(&found.p));
        self.s.push(s);
        self.p.push(p);
        self.mean.push(0.5 * (s + p));
    }
}

/// CIE 1931 chromaticities of unpolarised light. Null if there is no light.
#[derive(Debug, Serialize)]
struct FilmColours {
    reflected: Option<[f64; 2]>,
    transmitted: Option<[f64; 2]>,
}

#[derive(Debug, Serialize)]
struct FilmAngle {
    degrees: f64,
    wavelength_nm: Vec<f64>,
    reflectance: Polarised,
    transmittance: Polarised,
    xy: FilmColours,
}

#[derive(Debug, Serialize)]
struct FilmReport {
    angles: Vec<FilmAngle>,
}

/// The wavelengths of the table if none are given.
const TABLE_NM: (u32, u32, usize) = (400, 700, 25);

pub(crate) fn run(arguments: &FilmArgs) -> Result<Outcome> {
    let (file, source) = stack(&arguments.stack)?;
    let system = lone_coating(&file, &source)?;
    let lamp = named::light(&arguments.lamp)?;
    let whole_band = || (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let table = || (TABLE_NM.0..=TABLE_NM.1).step_by(TABLE_NM.2).map(f64::from).collect();
    let default = || if arguments.json { whole_band() } else { table() };
    let wavelengths = arguments.wavelengths.as_ref().map_or_else(default, |list| list.0.clone());
    if let Some(path) = &arguments.svg {
        file::write_whole(path, plot(&system, &arguments.angle).svg().as_bytes())?;
    }
    let angles = arguments.angle.iter().map(|&degrees| at_angle(&system, degrees, &wavelengths, &lamp.spectrum));
    let report = FilmReport { angles: angles.collect() };
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

fn response(system: &FilmSystem, degrees: f64, nm: f64) -> StackResponse {
    // The cosine of 90 degrees is not exactly 0.
    let cosine = if degrees == 90.0 { 0.0 } else { cos(degrees.to_radians()) };
    system.films.response(cosine, system.incident.n(nm), system.substrate.at(nm), nm, 0.0)
}

fn at_angle(system: &FilmSystem, degrees: f64, wavelengths: &[f64], lamp: &Spectrum) -> FilmAngle {
    let (mut reflectance, mut transmittance) = (Polarised::default(), Polarised::default());
    for &nm in wavelengths {
        let found = response(system, degrees, nm);
        reflectance.push(&found, |it| it.reflectance);
        transmittance.push(&found, |it| it.transmittance);
    }
    let colour = |of: fn(&StackResponse) -> f64| chromaticity(lamp, |nm| of(&response(system, degrees, nm)));
    let xy = FilmColours {
        reflected: colour(StackResponse::reflectance),
        transmitted: colour(StackResponse::transmittance),
    };
    FilmAngle { degrees, wavelength_nm: wavelengths.to_vec(), reflectance, transmittance, xy }
}

/// Returns the CIE 1931 chromaticity of a light times a factor. The continuum is summed over whole
/// nanometres, and the factor of a line is that at its centre. Returns `None` if there is no light.
fn chromaticity(light: &Spectrum, factor: impl Fn(f64) -> f64) -> Option<[f64; 2]> {
    let observer = Observer::cie1931();
    let mut sum = [0.0; 3];
    let mut add = |nm: f64, power: f64| {
        let weight = power * factor(nm);
        sum.iter_mut().zip(observer.xyz_bar(nm)).for_each(|(sum, bar)| *sum += weight * bar);
    };
    (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).for_each(|nm| add(nm, light.continuum_at(nm)));
    light.line_segments().iter().for_each(|line| add(line.centre(), line.power));
    (sum.iter().sum::<f64>() > 0.0).then(|| xy(sum))
}

fn text(report: &FilmReport, lamp: &str) -> String {
    let mut text = String::new();
    for angle in &report.angles {
        let FilmAngle { degrees, wavelength_nm, reflectance: r, transmittance: t, xy } = angle;
        text += &format!("{degrees}° of incidence\n      nm        R      R_s      R_p        T      T_s      T_p\n");
        for (i, nm) in wavelength_nm.iter().enumerate() {
            let cell = |list: &[f64]| format!("{:>8.3} %", 100.0 * list[i]).replace(" %", "%");
            let cells = [&r.mean, &r.s, &r.p, &t.mean, &t.s, &t.p].map(|list| cell(list)).concat();
            text += &format!("{nm:>8}{cells}\n");
        }
        for (name, colour) in [("reflected", xy.reflected), ("transmitted", xy.transmitted)] {
            text += &match colour {
                Some([x, y]) => format!("{name} light under {lamp}: xy ({x:.5}, {y:.5})\n"),
                None => format!("{name} light under {lamp}: none\n"),
            };
        }
    }
    text
}

/// Plots the powers of unpolarised light. If the substrate transmits nothing, only the reflectance
/// is plotted.
fn plot(system: &FilmSystem, angles: &[f64]) -> SpectralPlot {
    let mut curves = Vec::new();
    for &degrees in angles {
        let mut add = |name: &str, of: fn(&StackResponse) -> f64| {
            let nm = (0..=470).map(|i| BAND_NM.0 + f64::from(i));
            let points: Vec<(f64, f64)> = nm.map(|nm| (nm, of(&response(system, degrees, nm)))).collect();
            if points.iter().any(|point| point.1 > 0.0) {
                curves.push(SpectralCurve { name: format!("{name} at {degrees}°"), points });
            }
        };
        add("reflectance", StackResponse::reflectance);
        add("transmittance", StackResponse::transmittance);
    }
    SpectralPlot {
        title: "Thin films".to_string(),
        values: "fraction of the power".to_string(),
        curves,
        lines: Vec::new(),
        from_zero: true,
    }
}
