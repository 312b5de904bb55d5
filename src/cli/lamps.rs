//! `abbe lamps`: compares two or three lamps, or a lamp with its best match from primaries. The
//! module [`super::luminaire`] describes luminaire files.

use std::path::{Path, PathBuf};

use abbe_format::luminaire::is_luminaire;
use abbe_optics::bsdf::Fluorescent;
use abbe_optics::fluorescent_samples;
use abbe_session::output::figures::{difference_text, report_rows};
use abbe_session::output::file;
use abbe_session::output::lamps_page::{LampsPage, NamedLamp, page};
use abbe_spectra::colour::lamps::{
    ALIKE, DIFFERENT, LampComparison, PatchDifference, SplitPair, compare_returned_light,
};
use abbe_spectra::colour::{LightDifference, PrimaryMatch, Xyz, light_difference, match_primaries, report};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Observer, Spectrum};
use serde::Serialize;

use super::colour::ColourJson;
use super::named::{self, NamedSpectrum};
use super::{Outcome, print};

#[derive(Debug, clap::Args)]
#[command(override_usage = "abbe lamps A [B [C]] [--match PRIMARY...] [OPTIONS]\n       abbe lamps FILE.ies [OPTIONS]")]
pub(crate) struct LampsArgs {
    /// The first lamp: a name of the library, a file (columns nm,value; or IES TM-27 .spdx), or a
    /// spectrum in the JSON form of scenes; or a luminaire file (.ies or .ldt) whose figures and
    /// polar diagram are shown
    #[arg(value_name = "A")]
    pub(super) a: String,
    /// The second lamp [default: the match of A]
    #[arg(value_name = "B")]
    pub(super) b: Option<String>,
    /// A third lamp, which is compared with A
    #[arg(value_name = "C", requires = "b", conflicts_with = "html")]
    pub(super) c: Option<String>,
    /// Find the mix of these lights that has the colour closest to A; if B is missing, compare A
    /// with this mix
    #[arg(long = "match", value_name = "PRIMARY", num_args = 1..)]
    pub(super) primaries: Vec<String>,
    /// The standard observer: cie1931, cie1964, cie2015_2 or cie2015_10
    #[arg(long, value_name = "O", default_value = "cie1931")]
    pub(super) observer: String,
    /// Write an HTML page with spectra, colour swatches and all numbers; or with the polar diagram
    /// of a luminaire
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

/// The comparison of two lamps.
#[derive(Debug)]
pub(super) struct LampsCompared {
    observer: &'static Observer,
    /// The two lights: A, and either B or the match of A.
    lamps: [NamedSpectrum; 2],
    comparison: LampComparison,
    /// Fluorescent surfaces under A and B.
    fluorescent: Vec<PatchDifference>,
    /// The third lamp, and its comparison with A.
    third: Option<(NamedSpectrum, LampComparison)>,
    /// The match of A, if primaries were given.
    mix: Option<PrimaryMix>,
}

/// A mix of primaries. Its colour is as close as possible to the colour of a lamp.
#[derive(Debug)]
struct PrimaryMix {
    primaries: Vec<NamedSpectrum>,
    found: PrimaryMatch,
    /// The difference between the lamp and the mix at equal luminance.
    difference: LightDifference,
}

pub(crate) fn run(arguments: &LampsArgs) -> Result<Outcome> {
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

pub(super) fn compared(arguments: &LampsArgs) -> Result<LampsCompared> {
    let observer = Observer::by_name(&arguments.observer)?;
    let a = named::light(&arguments.a)?;
    let primaries =
        arguments.primaries.iter().map(|text| named::light(text)).collect::<Result<Vec<NamedSpectrum>>>()?;
    let mix = if primaries.is_empty() { None } else { Some(PrimaryMix::nearest(&a, primaries, observer)?) };
    let b = match (&arguments.b, &mix) {
        (Some(b), _) => named::light(b)?,
        (None, Some(mix)) => mix.lamp(&a),
        (None, None) => {
            return Err(Error::input("a second lamp is required to compare with A").expected("B or --match"));
        }
    };
    let comparison = LampComparison::between([&a.spectrum, &b.spectrum], observer)?;
    let third = match &arguments.c {
        None => None,
        Some(c) => {
            let c = named::light(c)?;
            let comparison = LampComparison::between([&a.spectrum, &c.spectrum], observer)?;
            Some((c, comparison))
        }
    };
    let surfaces = fluorescent_samples::surfaces()?;
    let returned = |light: &Spectrum| {
        let colours = surfaces.iter().map(|surface| xyz_of_fluorescent(surface, light, observer));
        fluorescent_samples::NAMES.into_iter().zip(colours).collect()
    };
    let fluorescent = compare_returned_light([&a.spectrum, &b.spectrum], returned, observer);
    Ok(LampsCompared { observer, lamps: [a, b], comparison, fluorescent, third, mix })
}

/// Returns the XYZ of the light that a fluorescent surface returns, on the scale of the light.
fn xyz_of_fluorescent(surface: &Fluorescent, light: &Spectrum, observer: &Observer) -> Xyz {
    let reflected = report::xyz_under(surface.reflectance(), light, observer);
    let fluorophore = &surface.fluorophore;
    let [_, excitation, _] = report::xyz_under(fluorophore.excitation_spectrum(), light, Observer::radiometric());
    let excitation = excitation + light.ultraviolet_sum(&|nm| fluorophore.excitation_spectrum().at(nm));
    let emitted = report::xyz(fluorophore.emitted_power(), observer);
    std::array::from_fn(|c| reflected[c] + excitation * fluorophore.quantum_yield() * emitted[c])
}

impl PrimaryMix {
    fn nearest(lamp: &NamedSpectrum, primaries: Vec<NamedSpectrum>, observer: &Observer) -> Result<Self> {
        let colours: Vec<[f64; 3]> = primaries.iter().map(|primary| report::xyz(&primary.spectrum, observer)).collect();
        let target = report::xyz(&lamp.spectrum, observer);
        let found = match_primaries(target, &colours)?;
        let unit = |xyz: [f64; 3]| xyz.map(|value| value / xyz[1]);
        let difference = light_difference(unit(target), unit(found.xyz));
        Ok(Self { primaries, found, difference })
    }

    /// The mix as a lamp. The field `origin` of the lamp contains the weights of the primaries.
    fn lamp(&self, of: &NamedSpectrum) -> NamedSpectrum {
        NamedSpectrum {
            name: format!("its match from {}", self.names()),
            origin: format!("the non-negative mix nearest to {} in XYZ: {}", of.name, self.weights_text()),
            spectrum: self.found.mix(self.primaries.iter().map(|primary| &primary.spectrum)),
        }
    }

    /// The weights of the primaries as text.
    fn weights_text(&self) -> String {
        let part = |(primary, weight): (&NamedSpectrum, &f64)| format!("{weight:.6} × {}", primary.name);
        self.primaries.iter().zip(&self.found.weights).map(part).collect::<Vec<String>>().join(" + ")
    }

    /// The names of the primaries, joined as "a, b and c".
    fn names(&self) -> String {
        let names: Vec<&str> = self.primaries.iter().map(|primary| primary.name.as_str()).collect();
        match names.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => names.join(""),
        }
    }
}

impl LampsCompared {
    /// A warning if the mix does not match the lamp.
    pub(super) fn warning(&self) -> Option<String> {
        let mix = self.mix.as_ref().filter(|mix| !mix.found.is_reached())?;
        let left = difference_text(mix.difference);
        Some(format!(
            "{} cannot be matched with {}; the closest mix differs by {left}, luminance {:+.4} %",
            self.lamps[0].name,
            mix.names(),
            100.0 * mix.found.delta_y
        ))
    }
}

fn lamp(NamedSpectrum { name, origin, spectrum }: &NamedSpectrum) -> NamedLamp<'_> {
    NamedLamp { name, origin, spectrum }
}

pub(super) fn html(compared: &LampsCompared, warning: Option<&str>) -> Result<String> {
    let LampsCompared { observer, lamps, comparison, fluorescent, third: _, mix } = compared;
    let primaries = mix.iter().flat_map(|mix| &mix.primaries).map(lamp).collect();
    let lamps = [lamp(&lamps[0]), lamp(&lamps[1])];
    page(&LampsPage { lamps, comparison, fluorescent, observer, primaries, warning })
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
        let state = if found.is_reached() { "exact" } else { "inexact" };
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

/// The JSON form of the comparison.
#[derive(Debug, Serialize)]
pub(super) struct LampsJson<'a> {
    a: ColourJson<'a>,
    b: ColourJson<'a>,
    /// The difference between the colours of the lamps. Both lamps have equal luminance, and the
    /// observer is adapted to D65.
    lights: DifferenceJson,
    /// The match of A, if primaries were given.
    r#match: Option<MatchJson<'a>>,
    patches: Vec<PatchJson<'a>>,
    /// Fluorescent surfaces under A and B.
    fluorescent: Vec<PatchJson<'a>>,
    /// The mean and the maximum of the colour differences of all patches.
    delta_e_2000: DeltaESummary,
    metameric_pairs: MetamericPairsJson<'a>,
    /// A sentence that says how different A and B are.
    verdict: String,
    /// The third lamp, and its comparison with A.
    c: Option<ThirdJson<'a>>,
    warning: Option<String>,
}

/// A third lamp, compared with A. The fields have the meaning of those of [`LampsJson`].
#[derive(Debug, Serialize)]
struct ThirdJson<'a> {
    #[serde(flatten)]
    colour: ColourJson<'a>,
    lights: DifferenceJson,
    patches: Vec<PatchJson<'a>>,
    delta_e_2000: DeltaESummary,
    metameric_pairs: MetamericPairsJson<'a>,
    verdict: String,
}

#[derive(Debug, Serialize)]
struct DifferenceJson {
    delta_xy: f64,
    delta_e_2000: f64,
}

impl From<LightDifference> for DifferenceJson {
    fn from(LightDifference { delta_xy, delta_e_2000 }: LightDifference) -> Self {
        Self { delta_xy, delta_e_2000 }
    }
}

#[derive(Debug, Serialize)]
struct MatchJson<'a> {
    primaries: Vec<&'a str>,
    /// The weight of each primary.
    weights: &'a [f64],
    #[serde(flatten)]
    left: DifferenceJson,
    /// The relative error of Y.
    delta_y: f64,
    reached: bool,
}

/// The colours of a surface under A and under B. The white point for each colour is the lamp that
/// illuminates the surface.
#[derive(Debug, Serialize)]
struct PatchJson<'a> {
    name: &'a str,
    delta_e_2000: f64,
    /// Tristimulus values. The perfect diffuser has Y = 100.
    xyz: [[f64; 3]; 2],
    lab: [[f64; 3]; 2],
}

impl<'a> From<&'a PatchDifference> for PatchJson<'a> {
    fn from(PatchDifference { name, xyz, lab, delta_e_2000 }: &'a PatchDifference) -> Self {
        Self { name, delta_e_2000: *delta_e_2000, xyz: *xyz, lab: *lab }
    }
}

#[derive(Debug, Serialize)]
struct DeltaESummary {
    mean: f64,
    max: f64,
}

impl From<&LampComparison> for DeltaESummary {
    fn from(comparison: &LampComparison) -> Self {
        Self { mean: comparison.mean(), max: comparison.worst().delta_e_2000 }
    }
}

impl<'a> From<&'a LampComparison> for MetamericPairsJson<'a> {
    fn from(comparison: &'a LampComparison) -> Self {
        let pair = |pair: &SplitPair| MetamericPairJson {
            names: comparison.surfaces_of(pair).map(|surface| surface.name.as_str()),
            delta_e_2000: pair.delta_e_2000,
        };
        let split = comparison.pairs.iter().map(pair).collect();
        Self { alike: ALIKE, different: DIFFERENT, of: comparison.pair_count(), split }
    }
}

#[derive(Debug, Serialize)]
struct MetamericPairsJson<'a> {
    /// The largest ΔE2000 of two surfaces that look alike.
    alike: f64,
    /// The smallest ΔE2000 of two surfaces that look different.
    different: f64,
    /// The number of examined pairs.
    of: usize,
    split: Vec<MetamericPairJson<'a>>,
}

#[derive(Debug, Serialize)]
struct MetamericPairJson<'a> {
    names: [&'a str; 2],
    /// The difference between the two surfaces: first under A, then under B.
    delta_e_2000: [f64; 2],
}

pub(super) fn json(compared: &LampsCompared, warning: Option<String>) -> LampsJson<'_> {
    let LampsCompared { observer, lamps, comparison, fluorescent, third, mix } = compared;
    let colour = |i: usize| ColourJson::new(&lamps[i].name, &comparison.reports[i], observer, None);
    let r#match = mix.as_ref().map(|PrimaryMix { primaries, found, difference: _ }| MatchJson {
        primaries: primaries.iter().map(|primary| primary.name.as_str()).collect(),
        weights: &found.weights,
        left: found.residual.into(),
        delta_y: found.delta_y,
        reached: found.is_reached(),
    });
    let third = third.as_ref().map(|(c, with_c)| ThirdJson {
        colour: ColourJson::new(&c.name, &with_c.reports[1], observer, None),
        lights: with_c.lights.into(),
        patches: with_c.patches.iter().map(PatchJson::from).collect(),
        delta_e_2000: with_c.into(),
        metameric_pairs: with_c.into(),
        verdict: with_c.verdict([&lamps[0].name, &c.name]),
    });
    LampsJson {
        a: colour(0),
        b: colour(1),
        lights: comparison.lights.into(),
        r#match,
        patches: comparison.patches.iter().map(PatchJson::from).collect(),
        fluorescent: fluorescent.iter().map(PatchJson::from).collect(),
        delta_e_2000: comparison.into(),
        metameric_pairs: comparison.into(),
        verdict: comparison.verdict([&lamps[0].name, &lamps[1].name]),
        c: third,
        warning,
    }
}
