//! `abbe metal`: the complex refractive index of a metal.

use super::{Outcome, print, values};
use abbe_optics::fresnel;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::library::LibraryMetal;
use abbe_spectra::spectrum::{BAND_NM, library};
use serde::Serialize;

#[derive(Debug, clap::Args)]
pub(crate) struct MetalArgs {
    /// The symbol or the English name of a metal, as in `"conductor": {"metal": "gold"}`
    #[arg(value_name = "NAME", required_unless_present = "list")]
    name: Option<String>,
    /// Print the index at these wavelengths in nm
    #[arg(long, value_name = "NM,...", value_delimiter = ',', value_parser = values::wavelength_nm)]
    #[arg(default_values_t = [450.0, 550.0, 650.0])]
    at: Vec<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// List all metals
    #[arg(long, conflicts_with_all = ["name", "at"])]
    list: bool,
}

/// The complex index n + ik at a wavelength.
#[derive(Debug, Serialize)]
struct MetalIndex {
    nm: f64,
    n: f64,
    k: f64,
    /// Reflectance at normal incidence from air.
    reflectance: f64,
}

#[derive(Debug, Serialize)]
struct MetalReport<'a> {
    symbol: &'a str,
    name: &'a str,
    source: &'a str,
    index: Vec<MetalIndex>,
}

#[derive(Debug, Serialize)]
struct MetalList {
    metals: Vec<LibraryMetal>,
}

pub(crate) fn run(arguments: &MetalArgs) -> Result<Outcome> {
    match &arguments.name {
        Some(name) => one(name, arguments)?,
        None => list(arguments.json)?,
    }
    Ok(Outcome::Done)
}

fn list(json: bool) -> Result<()> {
    let metals: Vec<LibraryMetal> = library::metals().collect();
    if json {
        return print::json(&MetalList { metals });
    }
    let line = |metal: &LibraryMetal| format!("{:<4} {:<12} {}\n", metal.symbol, metal.name, metal.source);
    print::result(&metals.iter().map(line).collect::<String>())
}

fn one(name: &str, arguments: &MetalArgs) -> Result<()> {
    let outside = |nm: &&f64| !(BAND_NM.0..=BAND_NM.1).contains(*nm);
    if let Some(nm) = arguments.at.iter().find(outside) {
        let expected = format!("wavelengths from {} to {} nm", BAND_NM.0, BAND_NM.1);
        return Err(Error::input(format!("the index at {nm} nm")).expected(expected));
    }
    let metal = library::metal(name)?;
    let (n, k) = metal.index();
    let at = |&nm: &f64| {
        let (n, k) = (n.at(nm), k.at(nm));
        MetalIndex { nm, n, k, reflectance: fresnel::conductor(1.0, n, k, 1.0) }
    };
    let LibraryMetal { symbol, name, source, .. } = metal;
    let report = MetalReport { symbol, name, source, index: arguments.at.iter().map(at).collect() };
    if arguments.json {
        return print::json(&report);
    }
    let mut text = format!("{} ({})\n      nm         n         k  reflectance\n", report.name, report.symbol);
    for MetalIndex { nm, n, k, reflectance } in &report.index {
        text += &format!("{nm:>8} {n:>9.5} {k:>9.5} {:>10.2} %\n", 100.0 * reflectance);
    }
    print::result(&(text + &format!("source {}\n", report.source)))
}
