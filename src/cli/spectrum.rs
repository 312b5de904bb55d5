//! `abbe spectrum`: prints the colour of a light, or of a surface under a light.

use std::path::PathBuf;

use abbe_format::resolve::Role;
use abbe_format::{SpectrumFile, SpectrumPathFile};
use abbe_session::output::figures::report_rows;
use abbe_session::output::file;
use abbe_session::output::plot::SpectralPlot;
use abbe_spectra::colour::ColourReport;
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::Observer;

use super::expectation::{self, Expectation};
use super::{Outcome, print};
use crate::reports::colour::{NamedColour, colour};
use crate::reports::named::{NamedSpectrum, SpectrumList, SpectrumListing, light_remark, spectrum};

#[derive(Debug, clap::Args)]
pub(crate) struct SpectrumArgs {
    /// A name of the library, a file (columns nm,value; IES TM-27 .spdx; or CGATS, such as .ti3),
    /// or a spectrum in the JSON form of scenes
    #[arg(value_name = "NAME|FILE|JSON", required_unless_present = "list")]
    spectrum: Option<String>,
    /// The sample of a CGATS file with several samples, by SAMPLE_ID, SAMPLE_NAME or SAMPLE_LOC
    #[arg(long, value_name = "NAME", conflicts_with = "list")]
    sample: Option<String>,
    /// The standard observer: cie1931, cie1964, cie2015_2 or cie2015_10
    #[arg(long, value_name = "O", default_value = "cie1931")]
    observer: String,
    /// Treat the spectrum as the reflectance of a surface under this lamp
    #[arg(long, value_name = "LAMP")]
    reflectance_under: Option<String>,
    /// Plot the spectrum
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Exit with status 3 if a figure of --json differs from a value, such as cct_k=6504:5 or
    /// xy=0.3127,0.3290:0.1%. Without a tolerance after the colon, the figure must round to the
    /// given digits (repeatable)
    #[arg(long, value_name = "FIGURE=VALUE[:TOLERANCE]", value_parser = expectation::parse, conflicts_with = "list")]
    expect: Vec<Expectation>,
    /// List all spectra of the library; `abbe metal --list` lists the metals
    #[arg(long, conflicts_with_all = ["spectrum", "reflectance_under", "svg"])]
    list: bool,
}

pub(crate) fn run(arguments: &SpectrumArgs) -> Result<Outcome> {
    let observer = Observer::by_name(&arguments.observer)?;
    match &arguments.spectrum {
        Some(text) => one(text, observer, arguments),
        None => list(arguments.json).map(|()| Outcome::Done),
    }
}

fn list(json: bool) -> Result<()> {
    let list = SpectrumList::of_library();
    if json {
        return print::json(&list);
    }
    let line = |SpectrumListing { name, kind, description, .. }: &SpectrumListing| {
        format!("{name:<34} {kind:<13} {description}\n")
    };
    print::result(&list.spectra.iter().map(line).collect::<String>())
}

fn one(text: &str, observer: &'static Observer, arguments: &SpectrumArgs) -> Result<Outcome> {
    let under = arguments.reflectance_under.as_deref();
    file::check_keeps_inputs(arguments.svg.as_deref(), [Some(text), under].into_iter().flatten())?;
    let of_sample = arguments.sample.as_ref().map(|sample| {
        let file = SpectrumPathFile { path: text.to_string(), sample: Some(sample.clone()) };
        serde_json::to_string(&SpectrumFile::File(Box::new(file))).expect("texts are JSON")
    });
    let text = of_sample.as_deref().unwrap_or(text);
    let (named, light) = match under {
        Some(lamp) => {
            let reflectance = spectrum(text, Role::Reflectance)?;
            print_notes(&reflectance);
            (reflectance, Some(light(lamp)?))
        }
        None => (light(text)?, None),
    };
    let report = colour(text, &named.spectrum, light.as_ref().map(|light| &light.spectrum), observer)?;
    if let Some(path) = &arguments.svg {
        let title = if of_sample.is_some() { &named.name } else { text };
        file::write_whole(path, SpectralPlot::of_spectrum(title, &named.spectrum, "value", None).svg().as_bytes())?;
    }
    let json = serde_json::to_value(NamedColour::new(&named.name, &report, observer, under))
        .expect("a report has text keys and no fallible values");
    let failures = arguments.expect.iter().map(|expectation| expectation.failure(&json)).collect::<Result<Vec<_>>>()?;
    if arguments.json {
        print::json(&json)?;
    } else {
        print::result(&words(&named.name, &report, observer.name(), under))?;
    }
    let failures: Vec<String> = failures.into_iter().flatten().collect();
    failures.iter().for_each(|failure| print::remark(&format!("failed: {failure}")));
    Ok(if failures.is_empty() { Outcome::Done } else { Outcome::Exceeded })
}

/// Returns the light given by an argument, with a note if the library does not list it as a light.
pub(super) fn light(text: &str) -> Result<NamedSpectrum> {
    let light = spectrum(text, Role::Light)?;
    light_remark(text).iter().for_each(|remark| print::remark(&format!("note: {remark}")));
    print_notes(&light);
    Ok(light)
}

fn print_notes(spectrum: &NamedSpectrum) {
    spectrum.notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
}

/// Writes the report, one quantity per line.
fn words(name: &str, report: &ColourReport, observer: &str, under: Option<&str>) -> String {
    let mut text = match under {
        Some(lamp) => {
            format!("{name}, a reflectance under {lamp}, observer {observer} (Y of the perfect diffuser = 100)\n")
        }
        None => format!("{name}, a light, observer {observer} (Y = 100)\n"),
    };
    report_rows(report).iter().for_each(|(figure, value)| text += &format!("{figure:<12} {value}\n"));
    text
}
