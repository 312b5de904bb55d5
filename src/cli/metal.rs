//! `abbe metal`: the complex refractive index of a metal.

use super::{Outcome, print, values};
use crate::reports::metal::{MetalIndex, MetalList, MetalReport};
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::library::{self, LibraryMetal};

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

pub(crate) fn run(arguments: &MetalArgs) -> Result<Outcome> {
    match &arguments.name {
        Some(name) => one(name, arguments)?,
        None => list(arguments.json)?,
    }
    Ok(Outcome::Done)
}

fn list(json: bool) -> Result<()> {
    let list = MetalList { metals: library::metals().collect() };
    if json {
        return print::json(&list);
    }
    let line = |metal: &LibraryMetal| format!("{:<4} {:<12} {}\n", metal.symbol, metal.name, metal.source);
    print::result(&list.metals.iter().map(line).collect::<String>())
}

fn one(name: &str, arguments: &MetalArgs) -> Result<()> {
    let report = MetalReport::of(name, &arguments.at)?;
    if arguments.json {
        return print::json(&report);
    }
    let mut text = format!("{} ({})\n      nm         n         k  reflectance\n", report.name, report.symbol);
    for MetalIndex { nm, n, k, reflectance } in &report.index {
        text += &format!("{nm:>8} {n:>9.5} {k:>9.5} {:>10.2} %\n", 100.0 * reflectance);
    }
    print::result(&(text + &format!("source {}\n", report.source)))
}
