//! `abbe spectrum`: the colour of a light, or of a reflectance under a light.

use std::path::{Path, PathBuf};

use abbe::colour::Report;
use abbe::error::{Error, Result};
use abbe::output::file as files;
use abbe::output::plot::{Curve, Plot};
use abbe::scene::file::{self, SpectrumFile};
use abbe::scene::resolve::{self, Role};
use abbe::spectrum::library::{self, Kind};
use abbe::spectrum::{BAND_NM, Observer, Spectrum, read};
use serde::Serialize;

use super::{Outcome, print};

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// A name of the library, a file (columns nm,value; or IES TM-27 .spdx), or any spectrum of a scene as JSON
    #[arg(value_name = "NAME|FILE|JSON", required_unless_present = "list")]
    spectrum: Option<String>,
    /// Whose eye: cie1931, cie1964, cie2015_2 or cie2015_10
    #[arg(long, value_name = "O", default_value = "cie1931")]
    observer: String,
    /// Take the spectrum as a reflectance, seen under this lamp
    #[arg(long, value_name = "LAMP")]
    reflectance_under: Option<String>,
    /// Plot the spectrum
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// List the library
    #[arg(long, conflicts_with_all = ["spectrum", "reflectance_under", "svg"])]
    list: bool,
}

/// A colour for programs to read.
#[derive(Debug, Serialize)]
struct Colour<'a> {
    name: &'a str,
    observer: &'static str,
    /// The lamp, for a reflectance.
    under: Option<&'a str>,
    /// Y = 100; for a reflectance, Y of the perfect diffuser = 100.
    xyz: [f64; 3],
    xy: [f64; 2],
    /// Y = 1 where `xyz` has Y = 100.
    linear_srgb: [f64; 3],
    srgb_hex: &'a str,
    dominant_nm: Option<f64>,
    /// Whether `dominant_nm` is the complementary wavelength of a purple.
    complementary: Option<bool>,
    purity: Option<f64>,
    cct_k: Option<f64>,
    duv: Option<f64>,
    ra: Option<f64>,
    efficacy_lm_per_w: Option<f64>,
}

/// A line of the list.
#[derive(Debug, Serialize)]
struct Listed {
    name: &'static str,
    kind: &'static str,
    description: &'static str,
    source: &'static str,
}

#[derive(Debug, Serialize)]
struct List {
    spectra: Vec<Listed>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let observer = Observer::by_name(&arguments.observer)?;
    match &arguments.spectrum {
        Some(text) => one(text, observer, arguments)?,
        None => list(arguments.json)?,
    }
    Ok(Outcome::Done)
}

fn list(json: bool) -> Result<()> {
    let entries = library::list().iter();
    if json {
        let listed = entries.map(|entry| Listed {
            name: entry.name,
            kind: entry.kind.name(),
            description: entry.description,
            source: entry.source,
        });
        return print::json(&List { spectra: listed.collect() });
    }
    let line =
        |entry: &library::Listing| format!("{:<34} {:<13} {}\n", entry.name, entry.kind.name(), entry.description);
    print::result(&entries.map(line).collect::<String>())
}

fn one(text: &str, observer: &'static Observer, arguments: &Arguments) -> Result<()> {
    let under = arguments.reflectance_under.as_deref();
    let role = if under.is_some() { Role::Reflectance } else { Role::Light };
    let spectrum = named(text, role)?;
    let report = match under {
        Some(lamp) => Report::of_reflectance(&spectrum, &named(lamp, Role::Light)?, observer),
        None => Report::of_light(&spectrum, observer),
    };
    let report = report.map_err(|error| Error { what: format!("{text}: {}", error.what), ..error })?;
    if under.is_none() && library::find(text).is_ok_and(|entry| entry.kind != Kind::Light) {
        print::remark(&format!("note: {text} is no light; with --reflectance-under D65 it is seen as a reflectance"));
    }
    if let Some(path) = &arguments.svg {
        files::write_whole(path, plot(text, &spectrum).svg().as_bytes())?;
    }
    let colour = colour(text, &report, observer, under);
    if arguments.json { print::json(&colour) } else { print::result(&words(&colour)) }
}

/// A spectrum as the command line names it: JSON, a name of the library, a file.
fn named(text: &str, role: Role) -> Result<Spectrum> {
    let origin = Path::new("the command line");
    if text.trim_start().starts_with(['{', '"']) || text.trim().parse::<f64>().is_ok() {
        let (spectrum, source) = file::parse_spectrum(text, origin)?;
        return resolve::lone_spectrum(&spectrum, &source, role);
    }
    let unknown = match library::find(text) {
        Ok(_) => {
            // By way of JSON, so that a name means what it means in a scene.
            let name = serde_json::to_string(text).expect("a text is JSON");
            let (_, source) = file::parse_spectrum(&name, origin)?;
            return resolve::lone_spectrum(&SpectrumFile::Name(text.to_string()), &source, role);
        }
        Err(unknown) => unknown,
    };
    let path = Path::new(text);
    if path.exists() || path.extension().is_some() || text.contains(std::path::is_separator) {
        let outside = match role {
            Role::Light => abbe::spectrum::Outside::Zero,
            Role::Reflectance | Role::Coefficient => abbe::spectrum::Outside::Hold,
        };
        return read::spectrum_file(path, outside);
    }
    Err(unknown.expected("a name of `abbe spectrum --list`, a file, or a spectrum as JSON"))
}

fn colour<'a>(name: &'a str, report: &'a Report, observer: &'static Observer, under: Option<&'a str>) -> Colour<'a> {
    let Report { xyz, xy, linear_srgb, srgb_hex, dominant, temperature, rendering, efficacy_lm_per_w } = report;
    Colour {
        name,
        observer: observer.name(),
        under,
        xyz: *xyz,
        xy: *xy,
        linear_srgb: *linear_srgb,
        srgb_hex,
        dominant_nm: dominant.map(|dominant| dominant.nm),
        complementary: dominant.map(|dominant| dominant.complementary),
        purity: dominant.map(|dominant| dominant.purity),
        cct_k: temperature.map(|temperature| temperature.cct_k),
        duv: temperature.map(|temperature| temperature.duv),
        ra: rendering.as_ref().map(|rendering| rendering.ra),
        efficacy_lm_per_w: *efficacy_lm_per_w,
    }
}

fn words(colour: &Colour<'_>) -> String {
    let three = |values: [f64; 3], decimals: usize| values.map(|value| format!("{value:.decimals$}")).join("  ");
    let (eye, name) = (colour.observer, colour.name);
    let mut text = match colour.under {
        Some(lamp) => format!("{name}, a reflectance under {lamp}, seen by {eye}\n"),
        None => format!("{name}, a light, seen by {eye}\n"),
    };
    let white = if colour.under.is_some() { "Y of the perfect diffuser = 100" } else { "Y = 100" };
    text += &format!("XYZ          {}   ({white})\n", three(colour.xyz, 4));
    text += &format!("xy           {:.6}  {:.6}\n", colour.xy[0], colour.xy[1]);
    text += &format!("linear sRGB  {}\nsRGB         {}\n", three(colour.linear_srgb, 6), colour.srgb_hex);
    let undefined = || "undefined".to_string();
    let dominant = colour.dominant_nm.map_or_else(undefined, |nm| {
        let complementary = if colour.complementary == Some(true) { " (complementary: a purple)" } else { "" };
        format!("{nm:.2} nm{complementary}, purity {:.4}", colour.purity.unwrap_or(0.0))
    });
    text += &format!("dominant     {dominant}\n");
    if colour.under.is_none() {
        let temperature = colour.cct_k.zip(colour.duv);
        let temperature = temperature.map_or_else(undefined, |(cct, duv)| format!("{cct:.1} K, Duv {duv:+.5}"));
        let ra = colour.ra.map_or_else(undefined, |ra| format!("{ra:.1}"));
        text += &format!("CCT          {temperature}\nRa           {ra}\n");
    }
    if let Some(efficacy) = colour.efficacy_lm_per_w {
        text += &format!("efficacy     {efficacy:.2} lm per W of radiation within the band\n");
    }
    text
}

/// The continuum as a curve, lines as strokes as high as their share of the strongest line's power.
fn plot(name: &str, spectrum: &Spectrum) -> Plot {
    let lines = spectrum.line_segments();
    let strongest = lines.iter().map(|line| line.power).fold(0.0, f64::max);
    let points = (0..=(BAND_NM.1 - BAND_NM.0) as u32).map(|i| BAND_NM.0 + f64::from(i));
    let curve =
        Curve { name: "continuum".to_string(), points: points.map(|nm| (nm, spectrum.continuum_at(nm))).collect() };
    let values = if lines.is_empty() { "value" } else { "continuum; lines: power relative to the strongest" };
    Plot {
        title: name.to_string(),
        values: values.to_string(),
        curves: vec![curve],
        lines: lines.iter().map(|line| (line.centre(), line.power / strongest)).collect(),
        from_zero: true,
    }
}
