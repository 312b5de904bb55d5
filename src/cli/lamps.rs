//! `abbe lamps`: compares two or three lamps, or a lamp with its best match from primaries. For
//! luminaire files, see [`super::luminaire`].

use std::path::{Path, PathBuf};

use abbe_format::luminaire::is_luminaire;
use abbe_session::output::figures::{difference_text, report_rows};
use abbe_session::output::file;
use abbe_spectra::colour::lamps::{ALIKE, DIFFERENT, LampComparison, PatchDifference};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Observer;

use super::spectrum::light;
use super::{Outcome, print};
use crate::reports::lamps::{LampsCompared, LampsReport};
use crate::reports::named::NamedSpectrum;

#[derive(Debug, clap::Args)]
#[command(override_usage = "abbe lamps A [B [C]] [--match PRIMARY...] [OPTIONS]\n       abbe lamps FILE.ies [OPTIONS]")]
pub(crate) struct LampsArgs {
    /// The first lamp: a name of the library, a file (columns nm,value; IES TM-27 .spdx; or CGATS),
    /// or a spectrum in the JSON form of scenes; or a luminaire file (.ies, .ldt, .tm33 or .xml)
    /// whose figures and polar diagram are shown
    #[arg(value_name = "A")]
    a: String,
    /// The second lamp [default: the match of A]
    #[arg(value_name = "B")]
    b: Option<String>,
    /// A third lamp, which is compared with A
    #[arg(value_name = "C", requires = "b", conflicts_with = "html")]
    c: Option<String>,
    /// Find the mix of these lights that has the colour closest to A; if B is missing, compare A
    /// with this mix
    #[arg(long = "match", value_name = "PRIMARY", num_args = 1..)]
    primaries: Vec<String>,
    /// The standard observer: cie1931, cie1964, cie2015_2 or cie2015_10
    #[arg(long, value_name = "O", default_value = "cie1931")]
    observer: String,
    /// Write an HTML page with spectra, colour swatches and all numbers; or with the polar diagram
    /// of a luminaire
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &LampsArgs) -> Result<Outcome> {
    // A lamp that is no file has the name of a spectrum, or is its text.
    let lamps = [Some(&arguments.a), arguments.b.as_ref(), arguments.c.as_ref()].into_iter().flatten();
    file::check_keeps_inputs(arguments.html.as_deref(), lamps.chain(&arguments.primaries))?;
    let luminaire = Path::new(&arguments.a);
    if is_luminaire(luminaire) {
        if arguments.b.is_some() || !arguments.primaries.is_empty() {
            let what = "a luminaire file together with other lamps";
            return Err(Error::input(what).expected("one luminaire file alone, or spectra of lamps"));
        }
        return super::luminaire::run(luminaire, arguments.html.as_deref(), arguments.json);
    }
    let compared = compared(arguments)?;
    let warning = compared.warning();
    if let Some(path) = &arguments.html {
        file::write_whole(path, compared.html()?.as_bytes())?;
    }
    if let Some(warning) = &warning {
        print::remark(&format!("warning: {warning}"));
    }
    if arguments.json {
        print::json(&LampsReport::of(&compared))?;
    } else {
        print::result(&text(&compared))?;
    }
    Ok(Outcome::Done)
}

/// Resolves the lamps of the arguments in this order: A, the primaries, B, C.
fn compared(arguments: &LampsArgs) -> Result<LampsCompared> {
    let observer = Observer::by_name(&arguments.observer)?;
    let a = light(&arguments.a)?;
    let primaries = arguments.primaries.iter().map(|text| light(text)).collect::<Result<Vec<NamedSpectrum>>>()?;
    let other = |text: &Option<String>| text.as_deref().map(light).transpose();
    LampsCompared::of(a, [other(&arguments.b)?, other(&arguments.c)?], primaries, observer)
}

/// The largest number of surface pairs that the printed text lists.
const SHOWN_PAIRS: usize = 12;

fn text(compared: &LampsCompared) -> String {
    let LampsCompared { observer, lamps: [a, b], comparison, fluorescent, third, mix } = compared;
    let third = third.as_ref();
    let mut text = format!("A  {}\n   {}\nB  {}\n   {}\n", a.name, a.origin, b.name, b.origin);
    text += &third.map_or(String::new(), |(c, _)| format!("C  {}\n   {}\n", c.name, c.origin));
    text += &format!("\n{}\n", comparison.verdict([&a.name, &b.name]));
    text += &third.map_or(String::new(), |(c, with_c)| with_c.verdict([&a.name, &c.name]) + "\n");
    text += &format!("observer {}; XYZ with Y = 100, linear sRGB with Y = 1\n\n", observer.name());
    let reports = comparison.reports.iter().chain(third.map(|(_, with_c)| &with_c.reports[1]));
    let columns: Vec<_> = reports.map(report_rows).collect();
    let row = |cells: Vec<&str>| {
        let cells: String = cells.iter().map(|cell| format!("{cell:<35}")).collect();
        format!("{}\n", cells.trim_end())
    };
    text += &format!("{:<13} {}", "", row(vec!["A", "B", "C"][..columns.len()].to_vec()));
    for (i, (figure, _)) in columns[0].iter().enumerate() {
        text += &format!("{figure:<13} {}", row(columns.iter().map(|rows| rows[i].1.as_str()).collect()));
    }
    let lights = difference_text(comparison.lights);
    text += &format!("\nA from B      {lights} (at equal luminance, observer adapted to D65)\n");
    let with_c = third.map(|(_, with_c)| format!("A from C      {}\n", difference_text(with_c.lights)));
    text += &with_c.unwrap_or_default();
    if let Some(mix) = mix {
        let found = &mix.found;
        let state = if found.is_exact() { "exact" } else { "inexact" };
        let left = difference_text(mix.difference);
        text += &format!("A's match     {}\n", mix.weights_text());
        text += &format!("              {state}: {left}, luminance {:+.4} %\n", 100.0 * found.delta_y);
    }
    text += &patches_text(comparison, "B");
    text += &fluorescent_text(fluorescent);
    text += &pairs_text(comparison, "B");
    if let Some((_, with_c)) = third {
        text += &patches_text(with_c, "C");
        text += &pairs_text(with_c, "C");
    }
    text
}

/// Returns the table of the ColorChecker patches under A and under another lamp.
fn patches_text(comparison: &LampComparison, other: &str) -> String {
    let mut text = format!("\nColorChecker patches, ΔE2000 between A and {other}, each under its own lamp as white\n");
    for patch in &comparison.patches {
        let bar = "▪".repeat(patch.delta_e_2000.round() as usize);
        text += format!("  {:<15} {:6.2}  {bar}", patch.short_name(), patch.delta_e_2000).trim_end();
        text += "\n";
    }
    let (mean, largest) = (comparison.mean(), comparison.worst().delta_e_2000);
    text + &format!("  {:<15} {mean:6.2}\n  {:<15} {largest:6.2}\n", "mean", "largest")
}

/// Returns the table of the fluorescent surfaces under A and B.
fn fluorescent_text(surfaces: &[PatchDifference]) -> String {
    let mut text = "\nFluorescent surfaces: Y (a perfect diffuser has 100), and ΔE2000 between A and B\n".to_string();
    for surface in surfaces {
        let [a, b] = surface.xyz.map(|xyz| xyz[1]);
        text += &format!("  {:<28} A {a:6.1}   B {b:6.1}   ΔE2000 {:6.2}\n", surface.name, surface.delta_e_2000);
    }
    text
}

fn pairs_text(comparison: &LampComparison, other: &str) -> String {
    let mut text = format!(
        "\nMetameric pairs: ΔE2000 at most {ALIKE} under one lamp and at least {DIFFERENT} under the other\n\
         (of {} pairs of ColorChecker patches, CIE test colours and leaves)\n",
        comparison.pair_count()
    );
    for pair in comparison.pairs.iter().take(SHOWN_PAIRS) {
        let names = comparison.surfaces_of(pair).map(|surface| surface.short_name()).join(" and ");
        let [under_a, under_other] = pair.delta_e_2000;
        text += &format!("  {names:<31} A {under_a:6.2}   {other} {under_other:6.2}\n");
    }
    match comparison.pairs.len() {
        0 => text += "  none\n",
        found if found > SHOWN_PAIRS => text += &format!("  … and {} more (--json)\n", found - SHOWN_PAIRS),
        _ => {}
    }
    text
}
