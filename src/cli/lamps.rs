//! `abbe lamps`: two lamps compared, or a lamp and its match from primaries.

use std::path::PathBuf;

use abbe::colour::lamps::{ALIKE, DIFFERENT, LampComparison, PatchDifference, SplitPair};
use abbe::colour::{LightDifference, Match, match_primaries, report};
use abbe::error::{Error, Result};
use abbe::output::figures::{apart, figures};
use abbe::output::file;
use abbe::output::lamps_page::{Lamp, Page, page};
use abbe::spectrum::Observer;
use serde::Serialize;

use super::colour::Colour;
use super::named::{self, Named};
use super::{Outcome, print};

#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("against").required(true).multiple(true).args(["b", "primaries"])))]
#[command(override_usage = "abbe lamps A [B] [--match PRIMARY...] [OPTIONS]")]
pub(crate) struct Arguments {
    /// A lamp: a name of the library, a file (columns nm,value; or IES TM-27 .spdx), or a spectrum as JSON
    #[arg(value_name = "A")]
    a: String,
    /// The lamp that it is compared with (default: its match)
    #[arg(value_name = "B")]
    b: Option<String>,
    /// Find the mix of these lights that comes nearest to A; without B, compare A with it
    #[arg(long = "match", value_name = "PRIMARY", num_args = 1..)]
    primaries: Vec<String>,
    /// Whose eye: cie1931, cie1964, cie2015_2 or cie2015_10
    #[arg(long, value_name = "O", default_value = "cie1931")]
    observer: String,
    /// Write a page with spectra, swatches and the figures
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Two lamps and all that is known of them.
#[derive(Debug)]
struct Compared {
    observer: &'static Observer,
    /// A, and B or A's match.
    lamps: [Named; 2],
    comparison: LampComparison,
    /// A's match, where one was asked for.
    mix: Option<Mix>,
}

/// The mix of primaries that comes nearest to a lamp.
#[derive(Debug)]
struct Mix {
    primaries: Vec<Named>,
    found: Match,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let compared = compared(arguments)?;
    let warning = compared.warning();
    if let Some(path) = &arguments.html {
        file::write_whole(path, html(&compared, warning.as_deref())?.as_bytes())?;
    }
    if let Some(warning) = &warning {
        print::remark(&format!("warning: {warning}"));
    }
    if arguments.json {
        print::json(&json(&compared, warning))?;
    } else {
        print::result(&text(&compared))?;
    }
    Ok(Outcome::Done)
}

fn compared(arguments: &Arguments) -> Result<Compared> {
    let observer = Observer::by_name(&arguments.observer)?;
    let a = named::light(&arguments.a)?;
    let primaries = arguments.primaries.iter().map(|text| named::light(text)).collect::<Result<Vec<Named>>>()?;
    let mix = if primaries.is_empty() { None } else { Some(Mix::nearest(&a, primaries, observer)?) };
    let b = match (&arguments.b, &mix) {
        (Some(b), _) => named::light(b)?,
        (None, Some(mix)) => mix.lamp(&a),
        (None, None) => return Err(Error::input("nothing to compare A with").expected("B or --match")),
    };
    let comparison = LampComparison::between([&a.spectrum, &b.spectrum], observer)?;
    Ok(Compared { observer, lamps: [a, b], comparison, mix })
}

impl Mix {
    fn nearest(lamp: &Named, primaries: Vec<Named>, observer: &Observer) -> Result<Self> {
        let colours: Vec<[f64; 3]> = primaries.iter().map(|primary| report::xyz(&primary.spectrum, observer)).collect();
        let found = match_primaries(report::xyz(&lamp.spectrum, observer), &colours)?;
        Ok(Self { primaries, found })
    }

    /// The mix as a lamp; its origin is its recipe.
    fn lamp(&self, of: &Named) -> Named {
        Named {
            name: format!("its match from {}", self.names()),
            origin: format!("the non-negative mix nearest to {} in XYZ: {}", of.name, self.recipe()),
            spectrum: self.found.mix(self.primaries.iter().map(|primary| &primary.spectrum)),
        }
    }

    /// So much of each primary.
    fn recipe(&self) -> String {
        let part = |(primary, weight): (&Named, &f64)| format!("{weight:.6} × {}", primary.name);
        self.primaries.iter().zip(&self.found.weights).map(part).collect::<Vec<String>>().join(" + ")
    }

    /// a, b and c.
    fn names(&self) -> String {
        let names: Vec<&str> = self.primaries.iter().map(|primary| primary.name.as_str()).collect();
        match names.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => names.join(""),
        }
    }
}

impl Compared {
    /// What to say where the mix is no match.
    fn warning(&self) -> Option<String> {
        let mix = self.mix.as_ref().filter(|mix| !mix.found.is_reached())?;
        let left = apart(mix.found.left);
        Some(format!("{} is out of reach of {}; the nearest mix is off by {left}", self.lamps[0].name, mix.names()))
    }
}

fn lamp(Named { name, origin, spectrum }: &Named) -> Lamp<'_> {
    Lamp { name, origin, spectrum }
}

fn html(compared: &Compared, warning: Option<&str>) -> Result<String> {
    let Compared { observer, lamps, comparison, mix } = compared;
    let primaries = mix.iter().flat_map(|mix| &mix.primaries).map(lamp).collect();
    page(&Page { lamps: [lamp(&lamps[0]), lamp(&lamps[1])], comparison, observer, primaries, warning })
}

/// How many pairs the text shows.
const SHOWN_PAIRS: usize = 12;

fn text(compared: &Compared) -> String {
    let Compared { observer, lamps: [a, b], comparison, mix } = compared;
    let mut text = format!("A  {}\n   {}\nB  {}\n   {}\n", a.name, a.origin, b.name, b.origin);
    text += &format!("seen by {}; XYZ with Y = 100, linear sRGB with Y = 1\n\n", observer.name());
    text += &format!("{:<13} {:<34} B\n", "", "A");
    for ((figure, a), (_, b)) in figures(&comparison.reports[0]).iter().zip(figures(&comparison.reports[1])) {
        text += &format!("{figure:<13} {a:<34} {b}\n");
    }
    let lights = apart(comparison.lights);
    text += &format!("\nA from B      {lights} (at equal luminance, to an eye used to D65)\n");
    if let Some(mix) = mix {
        let found = &mix.found;
        let state = if found.is_reached() { "reached" } else { "out of reach" };
        let left = apart(found.left);
        text += &format!("A's match     {}\n", mix.recipe());
        text += &format!("              {state}: {left}, luminance {:+.4} %\n", 100.0 * found.delta_y);
    }
    text += "\nColorChecker patches, ΔE2000 between A and B, each lamp the white of its own column\n";
    for patch in &comparison.patches {
        let bar = "▪".repeat(patch.delta_e_2000.round() as usize);
        text += format!("  {:<15} {:6.2}  {bar}", patch.short_name(), patch.delta_e_2000).trim_end();
        text += "\n";
    }
    text += &format!(
        "  {:<15} {:6.2}\n  {:<15} {:6.2}\n",
        "mean",
        comparison.mean(),
        "largest",
        comparison.worst().delta_e_2000
    );
    text + &pairs_text(comparison)
}

fn pairs_text(comparison: &LampComparison) -> String {
    let mut text = format!(
        "\nMetameric pairs that split: ΔE2000 at most {ALIKE} under one lamp and at least {DIFFERENT} under the other\n\
         (of {} pairs of ColorChecker patches, CIE test colours and leaves)\n",
        comparison.pair_count()
    );
    for pair in comparison.pairs.iter().take(SHOWN_PAIRS) {
        let names = comparison.surfaces_of(pair).map(|surface| surface.short_name()).join(" and ");
        let [under_a, under_b] = pair.delta_e_2000;
        text += &format!("  {names:<31} A {under_a:6.2}   B {under_b:6.2}\n");
    }
    match comparison.pairs.len() {
        0 => text += "  none\n",
        found if found > SHOWN_PAIRS => text += &format!("  … and {} more (--json)\n", found - SHOWN_PAIRS),
        _ => {}
    }
    text
}

/// The comparison for programs to read.
#[derive(Debug, Serialize)]
struct Json<'a> {
    a: Colour<'a>,
    b: Colour<'a>,
    /// Between the lamps' own colours at equal luminance, to an eye used to D65.
    lights: Left,
    /// A's match, where one was asked for.
    r#match: Option<JsonMatch<'a>>,
    patches: Vec<Patch<'a>>,
    /// Over the patches.
    delta_e_2000: Spread,
    metameric_pairs: Pairs<'a>,
    warning: Option<String>,
}

#[derive(Debug, Serialize)]
struct Left {
    delta_xy: f64,
    delta_e_2000: f64,
}

impl From<LightDifference> for Left {
    fn from(LightDifference { delta_xy, delta_e_2000 }: LightDifference) -> Self {
        Self { delta_xy, delta_e_2000 }
    }
}

#[derive(Debug, Serialize)]
struct JsonMatch<'a> {
    primaries: Vec<&'a str>,
    /// What each primary is multiplied with.
    weights: &'a [f64],
    #[serde(flatten)]
    left: Left,
    /// Relative error of Y.
    delta_y: f64,
    reached: bool,
}

/// A surface under A and under B, each time with that lamp for white.
#[derive(Debug, Serialize)]
struct Patch<'a> {
    name: &'a str,
    delta_e_2000: f64,
    /// Y of the perfect diffuser = 100.
    xyz: [[f64; 3]; 2],
    lab: [[f64; 3]; 2],
}

impl<'a> From<&'a PatchDifference> for Patch<'a> {
    fn from(PatchDifference { name, xyz, lab, delta_e_2000 }: &'a PatchDifference) -> Self {
        Self { name, delta_e_2000: *delta_e_2000, xyz: *xyz, lab: *lab }
    }
}

#[derive(Debug, Serialize)]
struct Spread {
    mean: f64,
    max: f64,
}

#[derive(Debug, Serialize)]
struct Pairs<'a> {
    /// Up to this ΔE2000 two surfaces look alike.
    alike: f64,
    /// From this ΔE2000 on they look different.
    different: f64,
    /// How many pairs were looked at.
    of: usize,
    split: Vec<Pair<'a>>,
}

#[derive(Debug, Serialize)]
struct Pair<'a> {
    names: [&'a str; 2],
    /// Between the two surfaces, under A and under B.
    delta_e_2000: [f64; 2],
}

fn json(compared: &Compared, warning: Option<String>) -> Json<'_> {
    let Compared { observer, lamps, comparison, mix } = compared;
    let colour = |i: usize| Colour::new(&lamps[i].name, &comparison.reports[i], observer, None);
    let r#match = mix.as_ref().map(|Mix { primaries, found }| JsonMatch {
        primaries: primaries.iter().map(|primary| primary.name.as_str()).collect(),
        weights: &found.weights,
        left: found.left.into(),
        delta_y: found.delta_y,
        reached: found.is_reached(),
    });
    let pair = |pair: &SplitPair| Pair {
        names: comparison.surfaces_of(pair).map(|surface| surface.name.as_str()),
        delta_e_2000: pair.delta_e_2000,
    };
    Json {
        a: colour(0),
        b: colour(1),
        lights: comparison.lights.into(),
        r#match,
        patches: comparison.patches.iter().map(Patch::from).collect(),
        delta_e_2000: Spread { mean: comparison.mean(), max: comparison.worst().delta_e_2000 },
        metameric_pairs: Pairs {
            alike: ALIKE,
            different: DIFFERENT,
            of: comparison.pair_count(),
            split: comparison.pairs.iter().map(pair).collect(),
        },
        warning,
    }
}
