//! `abbe glass`: prints the refractive index of a glass.

use std::path::PathBuf;

use abbe_format::resolve;
use abbe_optics::glass::catalogue::{self, Glass, GlassKind};
use abbe_optics::glass::{CauchyFit, Dispersion, SellmeierTerm};
use abbe_session::output::file;
use abbe_session::output::plot::{SpectralCurve, SpectralPlot};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::BAND_NM;
use serde::Serialize;

use super::{Outcome, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct GlassArgs {
    /// The name of a glass, crystal, polymer, liquid or gas of the catalogue
    #[arg(value_name = "NAME", required_unless_present = "list")]
    name: Option<String>,
    /// Look the name up in this Zemax catalogue instead of the built-in one
    #[arg(long, value_name = "FILE.agf")]
    catalogue: Option<PathBuf>,
    /// Print the index at these wavelengths in nm
    #[arg(long, value_name = "NM,...", value_delimiter = ',', value_parser = values::wavelength_nm)]
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

/// The optical data of a glass.
#[derive(Debug, Serialize)]
pub(super) struct GlassReport<'a> {
    name: &'a str,
    kind: &'static str,
    nd: f64,
    /// Null if `range_nm` does not contain the wavelengths of the F and C lines.
    vd: Option<f64>,
    range_nm: [f64; 2],
    /// Null if the data of the material does not use the Sellmeier formula.
    sellmeier: Option<SellmeierJson>,
    cauchy: CauchyJson,
    /// The index at the wavelengths of `--at`. Omitted without `--at`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    n: Vec<IndexSample>,
    source: &'a str,
    warning: Option<&'a str>,
}

/// The Sellmeier formula n² = 1 + c0 + Σ b λ²/(λ² − c), with λ in µm.
#[derive(Debug, Serialize)]
struct SellmeierJson {
    c0: f64,
    b: Vec<f64>,
    c: Vec<f64>,
}

/// The Cauchy formula n = a + b/λ² + c/λ⁴, with λ in µm. The coefficients were fitted to the index
/// at the wavelengths in `range_nm`.
#[derive(Debug, Serialize)]
struct CauchyJson {
    a: f64,
    b: f64,
    c: f64,
    max_error: f64,
    range_nm: [f64; 2],
}

#[derive(Debug, Serialize)]
struct IndexSample {
    nm: f64,
    n: f64,
}

/// An entry of the list.
#[derive(Debug, Serialize)]
struct GlassListing<'a> {
    name: &'a str,
    kind: &'static str,
    nd: f64,
    vd: Option<f64>,
}

#[derive(Debug, Serialize)]
struct GlassList<'a> {
    glasses: Vec<GlassListing<'a>>,
}

pub(crate) fn run(arguments: &GlassArgs) -> Result<Outcome> {
    let file = arguments.catalogue.as_deref().map(resolve::glass_file).transpose()?;
    match (&arguments.name, &file) {
        (Some(name), None) => one(catalogue::find(name)?, arguments)?,
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
    check_wavelengths(glass, &arguments.at)?;
    if let Some(path) = &arguments.svg {
        file::write_whole(path, plot(glass).svg().as_bytes())?;
    }
    let report = report(glass, &arguments.at);
    if arguments.json { print::json(&report) } else { print::result(&text(&report)) }
}

/// Refuses wavelengths (nm) outside the visible band at which the data of the glass is not valid.
pub(crate) fn check_wavelengths(glass: &Glass, at: &[f64]) -> Result<()> {
    let Some(bad) = at.iter().find(|&&nm| !(BAND_NM.0..=BAND_NM.1).contains(&nm) && !in_range(glass, nm)) else {
        return Ok(());
    };
    let (from, to) = glass.index.range_nm();
    let what = format!("the index of {} at {bad} nm", glass.name);
    Err(Error::input(what).expected(format!("wavelengths from {from} to {to} nm")))
}

fn in_range(glass: &Glass, nm: f64) -> bool {
    let (from, to) = glass.index.range_nm();
    (from..=to).contains(&nm)
}

fn list(glasses: &[Glass], json: bool) -> Result<()> {
    let listed = |glass| {
        let glass: &Glass = glass;
        GlassListing { name: &glass.name, kind: kind_word(glass.kind), nd: glass.index.nd(), vd: glass.index.vd() }
    };
    let glasses: Vec<GlassListing<'_>> = glasses.iter().map(listed).collect();
    if json {
        return print::json(&GlassList { glasses });
    }
    let line = |glass: &GlassListing<'_>| {
        let vd = glass.vd.map_or(String::new(), |vd| format!("V_d {vd:.2}"));
        format!("{:<24} {:<14} n_d {:.5}  {vd}", glass.name, glass.kind, glass.nd).trim_end().to_string() + "\n"
    };
    print::result(&glasses.iter().map(line).collect::<String>())
}

pub(super) fn report<'a>(glass: &'a Glass, at: &[f64]) -> GlassReport<'a> {
    let index = &glass.index;
    let (from, to) = index.range_nm();
    let CauchyFit { a, b, c, range_nm, max_error } = glass.cauchy;
    GlassReport {
        name: &glass.name,
        kind: kind_word(glass.kind),
        nd: index.nd(),
        vd: index.vd(),
        range_nm: [from, to],
        sellmeier: sellmeier(index.dispersion()),
        cauchy: CauchyJson { a, b, c, max_error, range_nm: [range_nm.0, range_nm.1] },
        n: at.iter().map(|&nm| IndexSample { nm, n: index.n(nm) }).collect(),
        source: &glass.source,
        warning: index.warning(),
    }
}

fn sellmeier(dispersion: &Dispersion) -> Option<SellmeierJson> {
    match dispersion {
        Dispersion::Sellmeier { c0, poles } => {
            let (b, c) = poles.iter().map(|&SellmeierTerm { b, c }| (b, c)).unzip();
            Some(SellmeierJson { c0: *c0, b, c })
        }
        Dispersion::Constant(_)
        | Dispersion::Cauchy { .. }
        | Dispersion::SquaredPowers { .. }
        | Dispersion::Powers { .. }
        | Dispersion::Rational(_)
        | Dispersion::Gas { .. }
        | Dispersion::Conrady { .. }
        | Dispersion::Herzberger(_)
        | Dispersion::Table { .. } => None,
    }
}

fn kind_word(kind: GlassKind) -> &'static str {
    match kind {
        GlassKind::Glass => "glass",
        GlassKind::GlassCeramic => "glass ceramic",
        GlassKind::Crystal => "crystal",
        GlassKind::Polymer => "polymer",
        GlassKind::Liquid => "liquid",
        GlassKind::Gas => "gas",
    }
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
        Some(SellmeierJson { c0, b, c }) => {
            let shift = if *c0 == 0.0 { String::new() } else { format!("   c0 = {c0}") };
            format!("Sellmeier  B = {b:?}   C = {c:?} µm²{shift}\n")
        }
        None => "Sellmeier  none: the material has a different formula\n".to_string(),
    };
    let CauchyJson { a, b, c, max_error, range_nm: [from, to] } = report.cauchy;
    text +=
        &format!("Cauchy     a = {a}   b = {b} µm²   c = {c} µm⁴   (error below {max_error:.1e}, {from} to {to} nm)\n");
    report.n.iter().for_each(|IndexSample { nm, n }| text += &format!("n({nm} nm) = {n:.7}\n"));
    text += &format!("source     {}\n", report.source);
    text += &report.warning.map_or(String::new(), |warning| format!("note       {warning}\n"));
    text
}

/// Plots the refractive index over its range of wavelengths, together with the Cauchy fit.
fn plot(glass: &Glass) -> SpectralPlot {
    let (from, to) = glass.index.range_nm();
    let CauchyFit { a, b, c, range_nm, .. } = glass.cauchy;
    let fit = Dispersion::Cauchy { a, b, c };
    let curve = |name: &str, (from, to): (f64, f64), n: &dyn Fn(f64) -> f64| {
        let (from, to) = (from.max(BAND_NM.0), to.min(BAND_NM.1));
        let points = (0..=235).map(|i| from + (to - from) * f64::from(i) / 235.0).map(|nm| (nm, n(nm))).collect();
        SpectralCurve { name: name.to_string(), points }
    };
    let own = curve(&glass.name, (from, to), &|nm| glass.index.n(nm));
    let cauchy = curve("Cauchy fit", range_nm, &|nm| fit.n(nm));
    SpectralPlot {
        title: format!("{}: index of refraction", glass.name),
        values: "n".to_string(),
        curves: vec![own, cauchy],
        lines: Vec::new(),
        from_zero: false,
    }
}
