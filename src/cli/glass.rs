//! `abbe glass`: prints the refractive index of a glass.

use std::path::PathBuf;

use abbe_format::resolve;
use abbe_optics::glass::CauchyFit;
use abbe_optics::glass::catalogue::{self, Glass};
use abbe_optics::glass::makers;
use abbe_session::output::file;
use abbe_spectra::error::Result;

use super::{Outcome, print, values};
use crate::reports::glass::{GlassList, GlassListing, GlassReport, IndexSample, SellmeierCoefficients, plot};

#[derive(Debug, clap::Args)]
pub(crate) struct GlassArgs {
    /// The name of a glass, crystal, polymer, liquid or gas of the catalogue
    #[arg(value_name = "NAME", required_unless_present = "list")]
    name: Option<String>,
    /// Look the name up in this Zemax catalogue instead of the built-in one
    #[arg(long, value_name = "FILE.agf")]
    catalogue: Option<PathBuf>,
    /// Print the index at these wavelengths in nm
    #[arg(long, visible_alias = "nm", value_name = "NM,...", value_delimiter = ',', value_parser = values::wavelength_nm)]
    at: Vec<f64>,
    /// Plot the index against wavelength
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// List all names of the catalogue; `abbe metal --list` lists the metals
    #[arg(long, conflicts_with_all = ["name", "at", "svg"])]
    list: bool,
}

pub(crate) fn run(arguments: &GlassArgs) -> Result<Outcome> {
    file::check_keeps_inputs(arguments.svg.as_deref(), &arguments.catalogue)?;
    let file = arguments.catalogue.as_deref().map(resolve::glass_file).transpose()?;
    match (&arguments.name, &file) {
        (Some(name), None) => one(&makers::find(name)?, arguments)?,
        (Some(name), Some(file)) => one(&file.find(name)?, arguments)?,
        (None, None) => list(catalogue::all(), arguments.json)?,
        (None, Some(file)) => {
            let (mut glasses, mut unusable) = (Vec::new(), Vec::new());
            for name in file.names() {
                match file.find(name) {
                    Ok(glass) => glasses.push(glass),
                    Err(error) => unusable.push(error),
                }
            }
            unusable.iter().for_each(|error| print::remark(&format!("note: skipped: {error}")));
            list(&glasses, arguments.json)?;
        }
    }
    Ok(Outcome::Done)
}

fn one(glass: &Glass, arguments: &GlassArgs) -> Result<()> {
    let report = GlassReport::of(glass, &arguments.at)?;
    if let Some(path) = &arguments.svg {
        file::write_whole(path, plot(glass).svg().as_bytes())?;
    }
    if arguments.json { print::json(&report) } else { print::result(&text(&report)) }
}

fn list(glasses: &[Glass], json: bool) -> Result<()> {
    let list = GlassList::of(glasses);
    if json {
        return print::json(&list);
    }
    let line = |glass: &GlassListing<'_>| {
        let vd = glass.vd.map_or(String::new(), |vd| format!("V_d {vd:.2}"));
        format!("{:<24} {:<14} n_d {:.5}  {vd}", glass.name, glass.kind, glass.nd).trim_end().to_string() + "\n"
    };
    print::result(&list.glasses.iter().map(line).collect::<String>())
}

fn text(report: &GlassReport<'_>) -> String {
    let [from, to] = report.range_nm;
    let mut text = format!("{} ({})\nn_d        {:.6}\n", report.name, report.kind, report.nd);
    text += &match report.vd {
        Some(vd) => format!("V_d        {vd:.3}\n"),
        None => "V_d        undefined: the range does not contain the F and C lines\n".to_string(),
    };
    text += &format!("range      {from} to {to} nm\n");
    text += &match &report.sellmeier {
        Some(SellmeierCoefficients { c0, b, c }) => {
            let shift = if *c0 == 0.0 { String::new() } else { format!("   c0 = {c0}") };
            format!("Sellmeier  B = {b:?}   C = {c:?} µm²{shift}\n")
        }
        None => "Sellmeier  none: the material has a different formula\n".to_string(),
    };
    let CauchyFit { a, b, c, max_error, range_nm: (from, to) } = report.cauchy;
    text +=
        &format!("Cauchy     a = {a}   b = {b} µm²   c = {c} µm⁴   (error below {max_error:.1e}, {from} to {to} nm)\n");
    report.n.iter().for_each(|IndexSample { nm, n }| text += &format!("n({nm} nm) = {n:.7}\n"));
    text += &format!("source     {}\n", report.source);
    text += &report.warning.map_or(String::new(), |warning| format!("note       {warning}\n"));
    text
}
