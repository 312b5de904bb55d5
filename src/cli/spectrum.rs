//! `abbe spectrum`: the colour of a light, or of a reflectance under a light.

use std::path::PathBuf;

use abbe::colour::Report;
use abbe::error::{Error, Result};
use abbe::output::figures::figures;
use abbe::output::file;
use abbe::output::plot::Plot;
use abbe::scene::resolve::Role;
use abbe::spectrum::Observer;
use abbe::spectrum::library;
use serde::Serialize;

use super::colour::Colour;
use super::{Outcome, named, print};

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
    let (named, report) = match under {
        Some(lamp) => {
            let reflectance = named::spectrum(text, Role::Reflectance)?;
            let lamp = named::spectrum(lamp, Role::Light)?;
            let report = Report::of_reflectance(&reflectance.spectrum, &lamp.spectrum, observer);
            (reflectance, report)
        }
        None => {
            let light = named::light(text)?;
            let report = Report::of_light(&light.spectrum, observer);
            (light, report)
        }
    };
    let report = report.map_err(|error| Error { what: format!("{text}: {}", error.what), ..error })?;
    if let Some(path) = &arguments.svg {
        file::write_whole(path, Plot::of_spectrum(text, &named.spectrum, "value", None).svg().as_bytes())?;
    }
    if arguments.json {
        print::json(&Colour::new(&named.name, &report, observer, under))
    } else {
        print::result(&words(&named.name, &report, observer.name(), under))
    }
}

/// The figures, one a line.
fn words(name: &str, report: &Report, eye: &str, under: Option<&str>) -> String {
    let mut text = match under {
        Some(lamp) => format!("{name}, a reflectance under {lamp}, seen by {eye} (Y of the perfect diffuser = 100)\n"),
        None => format!("{name}, a light, seen by {eye} (Y = 100)\n"),
    };
    figures(report).iter().for_each(|(figure, value)| text += &format!("{figure:<12} {value}\n"));
    text
}
