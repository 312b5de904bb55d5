//! Two lamps compared, as one page that needs no other file: their spectra, their colours, and what surfaces look like
//! under both.

use maud::{Markup, PreEscaped, html};

use super::chromaticity::Diagram;
use super::figures::{apart, figures};
use super::page::document;
use super::plot::Plot;
use crate::colour::gamut::desaturate;
use crate::colour::lamps::{ALIKE, DIFFERENT, LampComparison, PatchDifference, SplitPair};
use crate::colour::{RgbSpace, Xyz, from_lab, report, srgb_hex, xy, xyz_to_linear_srgb};
use crate::error::Result;
use crate::spectrum::{LUMENS_PER_WATT, Observer, Spectrum};

/// A light with its name and where it comes from.
#[derive(Debug, Clone, Copy)]
pub struct Lamp<'a> {
    /// Its name.
    pub name: &'a str,
    /// What it is and whose numbers these are.
    pub origin: &'a str,
    /// Its light, on any scale.
    pub spectrum: &'a Spectrum,
}

/// What the page shows.
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// A and B.
    pub lamps: [Lamp<'a>; 2],
    /// Their comparison.
    pub comparison: &'a LampComparison,
    /// Whose eye it is.
    pub observer: &'a Observer,
    /// Of what A's match is mixed, where one was asked for.
    pub primaries: Vec<Lamp<'a>>,
    /// What the reader must know first.
    pub warning: Option<&'a str>,
}

/// How many split pairs are shown.
const SHOWN_PAIRS: usize = 12;

/// Longest name in a plot's title, in characters.
const LONGEST_TITLE: usize = 70;

/// The page.
///
/// # Errors
/// The machine's: a picture that PNG cannot hold.
pub fn page(page: &Page<'_>) -> Result<String> {
    let Page { lamps: [a, b], comparison, observer, primaries: _, warning } = page;
    let title = format!("{} against {}", a.name, b.name);
    let body = html! {
        h1 { (title) }
        @for (badge, lamp) in [("A", a), ("B", b)] {
            p.lamp { span.badge { (badge) } " " strong { (lamp.name) } ": " span.soft { (lamp.origin) } }
        }
        @if let Some(warning) = warning { p.warning { (warning) "." } }
        (lights(page)?)
        h2 { "Spectra" }
        div.two.spectra {
            @for (badge, lamp) in [("A", a), ("B", b)] { figure { (PreEscaped(plot(badge, lamp, observer).svg())) } }
        }
        p.soft { "Spectral power of each lamp for one lumen of its light; lines are as high as their share of the tallest. The axes differ." }
        (charts(comparison))
        (pairs(comparison))
        h2 { "Every patch" }
        (table(comparison))
        (notes(observer))
    };
    Ok(document(&title, include_str!("lamps_page.css"), &body))
}

/// The lamps' own colours: figures, and a diagram.
fn lights(page: &Page<'_>) -> Result<Markup> {
    let Page { comparison, observer, primaries, .. } = page;
    let [a, b] = &comparison.reports;
    let place = |lamp: &Lamp<'_>| xy(report::xyz(lamp.spectrum, observer));
    let diagram = Diagram { observer, lights: [a.xy, b.xy], primaries: primaries.iter().map(place).collect() };
    let rows = figures(a).into_iter().zip(figures(b));
    Ok(html! {
        h2 { "The light itself" }
        div.two {
            div {
                table.figures {
                    thead { tr { th {} @for badge in ["A", "B"] { th { span.badge { (badge) } } } } }
                    tbody {
                        tr { th { "white" } @for report in [a, b] { td { div.light style={"background:" (report.srgb_hex)} {} } } }
                        @for ((name, of_a), (_, of_b)) in rows { tr { th scope="row" { (name) } td { (of_a) } td { (of_b) } } }
                    }
                }
                p { "Side by side at equal luminance, to an eye used to D65: " strong { (apart(comparison.lights)) } "." }
                p.soft { "XYZ has Y = 100, linear sRGB Y = 1; sRGB is the colour as bright as a screen can show it. "
                    "Efficacy is per watt of radiation from 360 to 830 nm." }
            }
            figure.diagram {
                (PreEscaped(diagram.svg()?))
                figcaption {
                    "Chromaticities by " (observer.name()) ": the spectral locus in nm, the line of black bodies, A (ring) and B (cross)"
                    @for (i, primary) in primaries.iter().enumerate() { "; " (i + 1) " is " (primary.name) }
                    "."
                }
            }
        }
    })
}

/// The lamp's spectral power for one lumen.
fn plot(badge: &str, lamp: &Lamp<'_>, observer: &Observer) -> Plot {
    let lumens = LUMENS_PER_WATT * report::xyz(lamp.spectrum, observer)[1];
    let mut name: String = lamp.name.chars().take(LONGEST_TITLE).collect();
    if name.len() < lamp.name.len() {
        name += "…";
    }
    Plot::of_spectrum(&format!("{badge}: {name}"), &lamp.spectrum.scaled(1000.0 / lumens), "mW/(nm lm)", Some("mW/lm"))
}

fn charts(comparison: &LampComparison) -> Markup {
    let exposure = exposure(comparison);
    let left = |patch: &PatchDifference| patch.xyz.map(|xyz| shown(xyz.map(|value| value * exposure)));
    html! {
        h2 { "The ColorChecker under both" }
        p { "Each patch shows A in its left half and B in its right half." }
        div.two {
            figure {
                (chart(comparison, adapted, true))
                figcaption.chart-caption { "As an eye sees them that has adapted to each lamp, with ΔE2000 between the halves: "
                    (format!("mean {:.2}, largest {:.2} ({})", comparison.mean(), comparison.worst().delta_e_2000, comparison.worst().short_name()))
                    "." }
            }
            figure {
                (chart(comparison, left, false))
                figcaption.chart-caption { "As an eye used to D65 would see the same light, at equal luminance of the lamps." }
            }
        }
    }
}

fn chart(
    comparison: &LampComparison,
    colours: impl Fn(&PatchDifference) -> [String; 2],
    with_difference: bool,
) -> Markup {
    html! {
        div.chart {
            @for patch in &comparison.patches {
                div.patch {
                    (halves("pair", &colours(patch)))
                    div.name {
                        span { (patch.short_name()) }
                        @if with_difference { b { (format!("{:.1}", patch.delta_e_2000)) } }
                    }
                }
            }
        }
    }
}

fn halves(class: &str, colours: &[String; 2]) -> Markup {
    html! { div class=(class) { @for colour in colours { span style={"background:" (colour)} {} } } }
}

fn pairs(comparison: &LampComparison) -> Markup {
    let found = comparison.pairs.len();
    html! {
        h2 { "Metameric pairs that split" }
        p {
            "Two surfaces that look alike under one lamp (ΔE2000 at most " (ALIKE) ") and different under the other (at least "
            (DIFFERENT) "), of " (comparison.pair_count()) " pairs of ColorChecker patches, CIE test colours and leaves: "
            @if found == 0 { strong { "none" } "." } @else { strong { (found) } "." }
            @if found > SHOWN_PAIRS { " These split the most." }
        }
        @if found > 0 { div.splits { @for pair in comparison.pairs.iter().take(SHOWN_PAIRS) { (split(comparison, pair)) } } }
    }
}

fn split(comparison: &LampComparison, pair: &SplitPair) -> Markup {
    let surfaces = comparison.surfaces_of(pair);
    let colours = surfaces.map(adapted);
    html! {
        div.split {
            (surfaces[0].short_name()) " and " (surfaces[1].short_name())
            @for (i, badge) in ["A", "B"].into_iter().enumerate() {
                div.under {
                    span.badge { (badge) }
                    (halves("pair", &[colours[0][i].clone(), colours[1][i].clone()]))
                    b { (format!("{:.1}", pair.delta_e_2000[i])) }
                }
            }
        }
    }
}

fn table(comparison: &LampComparison) -> Markup {
    let widest = comparison.worst().delta_e_2000.max(1.0);
    html! {
        div.table { table.patches {
            thead {
                tr { th {} th {} th.group colspan="3" { "under A" } th.group colspan="3" { "under B" } th {} th {} }
                tr {
                    th { "patch" } th { "A, B" }
                    @for name in ["L*", "a*", "b*", "L*", "a*", "b*", "ΔE2000"] { th.number { (name) } }
                    th.bar {}
                }
            }
            tbody { @for patch in &comparison.patches { tr {
                th scope="row" { (patch.short_name()) }
                td { (halves("swatch", &adapted(patch))) }
                @for value in patch.lab.as_flattened() { td.number { (signed(*value)) } }
                td.number { (format!("{:.2}", patch.delta_e_2000)) }
                td.bar { div style={"width:" (format!("{:.1}", 100.0 * patch.delta_e_2000 / widest)) "%"} {} }
            } } }
        } }
    }
}

/// One decimal, with a true minus and none before a zero.
fn signed(value: f64) -> String {
    let text = format!("{value:.1}");
    if text == "-0.0" { "0.0".to_string() } else { text.replace('-', "−") }
}

fn notes(observer: &Observer) -> Markup {
    html! {
        h2 { "How it is computed" }
        p.soft {
            "By " (observer.name()) ", with sums every nm from 360 to 830 nm; spectral lines count at their wavelength. L*a*b* under a lamp "
            "have that lamp's XYZ for white, the perfect diffuser having Y = 100. Adapted swatches show the same L*a*b* with D65 for "
            "white; colours that sRGB does not hold are desaturated at constant luminance. Patches: N. Ohta's measurement of the "
            "ColorChecker; test colours: CIE 13.3; leaves: PROSPECT-D. Ra by CIE 13.3, undefined farther than 0.05 from the "
            "line of black bodies. Written by abbe " (env!("CARGO_PKG_VERSION")) "."
        }
    }
}

/// What makes the brightest component of both lamps' white 1, as a factor of XYZ with the white at Y = 100.
fn exposure(comparison: &LampComparison) -> f64 {
    let components = comparison.reports.iter().flat_map(|report| report.linear_srgb);
    0.01 / components.fold(1.0, f64::max)
}

/// A colour, white having Y = 1, as a screen shows it.
fn shown(xyz: Xyz) -> String {
    srgb_hex(desaturate(xyz_to_linear_srgb(xyz), RgbSpace::Srgb))
}

/// The patch under each lamp, as it looks once the eye has adapted to that lamp.
fn adapted(patch: &PatchDifference) -> [String; 2] {
    patch.lab.map(|lab| shown(from_lab(lab, RgbSpace::Srgb.white())))
}
