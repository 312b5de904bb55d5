//! The self-contained HTML page that compares two lamps: their spectra, their colours, and the
//! colours of surfaces under both.

use maud::{Markup, PreEscaped, html};

use super::chromaticity::ChromaticityDiagram;
use super::colour_vectors::colour_vector_graphic;
use super::figures::{difference_text, report_rows};
use super::page::document;
use super::plot::SpectralPlot;
use abbe_spectra::colour::gamut::desaturate;
use abbe_spectra::colour::lamps::{ALIKE, DIFFERENT, LampComparison, PatchDifference, SplitPair};
use abbe_spectra::colour::{ColourRendition, RgbSpace, Xyz, from_lab, report, srgb_hex, xy, xyz_to_linear_srgb};
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer, Spectrum};

#[derive(Debug, Clone, Copy)]
pub struct NamedLamp<'a> {
    pub name: &'a str,
    pub origin: &'a str,
    /// The spectrum of the lamp's light. The scale of the spectrum does not matter.
    pub spectrum: &'a Spectrum,
}

#[derive(Debug, Clone)]
pub struct LampsPage<'a> {
    pub lamps: [NamedLamp<'a>; 2],
    pub comparison: &'a LampComparison,
    pub fluorescent: &'a [PatchDifference],
    pub observer: &'a Observer,
    /// The primaries that are mixed to match A, or an empty list if A is not matched.
    pub primaries: Vec<NamedLamp<'a>>,
    pub warning: Option<&'a str>,
}

/// The largest number of surface pairs that the page shows.
pub const SHOWN_PAIRS: usize = 12;

/// The maximum number of characters of a name in the title of a plot.
const LONGEST_TITLE: usize = 70;

/// Returns the page. Returns a machine error if an image cannot be encoded as PNG.
pub fn page(page: &LampsPage<'_>) -> Result<String> {
    let LampsPage { lamps: [a, b], comparison, fluorescent, observer, primaries: _, warning } = page;
    let title = format!("{} against {}", a.name, b.name);
    let body = html! {
        h1 { (title) }
        @for (badge, lamp) in [("A", a), ("B", b)] {
            p.lamp { span.badge { (badge) } " " strong { (lamp.name) } ": " span.soft { (lamp.origin) } }
        }
        @if let Some(warning) = warning { p.warning { (warning) "." } }
        p { strong { (comparison.verdict([a.name, b.name])) } }
        (lights(page)?)
        h2 { "Spectra" }
        div.two.spectra {
            @for (badge, lamp) in [("A", a), ("B", b)] { figure { (PreEscaped(plot(badge, lamp, observer).svg())) } }
        }
        p.soft { "Spectral power of each lamp for one lumen. The height of a line is its power relative to the strongest line. The two plots have different scales." }
        (rendition(comparison))
        (charts(comparison))
        (pairs(comparison))
        h2 { "All patches" }
        (table(&comparison.patches, comparison.worst().delta_e_2000))
        h2 { "Fluorescent surfaces" }
        p { "These surfaces absorb light and emit light of longer wavelengths. The spectra are typical." }
        (table(fluorescent, fluorescent.iter().map(|surface| surface.delta_e_2000).fold(0.0, f64::max)))
        (notes(observer))
    };
    Ok(document(&title, include_str!("lamps_page.css"), &body))
}

fn lights(page: &LampsPage<'_>) -> Result<Markup> {
    let LampsPage { comparison, observer, primaries, .. } = page;
    let [a, b] = &comparison.reports;
    let place = |lamp: &NamedLamp<'_>| xy(report::xyz(lamp.spectrum, observer));
    let diagram =
        ChromaticityDiagram { observer, lights: [a.xy, b.xy], primaries: primaries.iter().map(place).collect() };
    let rows = report_rows(a).into_iter().zip(report_rows(b));
    Ok(html! {
        h2 { "Colours of the lamps" }
        div.two {
            div {
                table.figures {
                    thead { tr { th {} @for badge in ["A", "B"] { th { span.badge { (badge) } } } } }
                    tbody {
                        tr { th { "white" } @for report in [a, b] { td { div.light style={"background:" (report.srgb_hex)} {} } } }
                        @for ((name, of_a), (_, of_b)) in rows { tr { th scope="row" { (name) } td { (of_a) } td { (of_b) } } }
                    }
                }
                p { "Difference at equal luminance, for an observer adapted to D65: " strong { (difference_text(comparison.lights)) } "." }
                p.soft { "XYZ has Y = 100 and linear sRGB has Y = 1. sRGB is the brightest displayable colour of this chromaticity. "
                    "Efficacy is per watt of radiation from 360 to 830 nm." }
            }
            figure.diagram {
                (PreEscaped(diagram.svg()?))
                figcaption {
                    "Chromaticities for " (observer.name()) ": the spectral locus in nm, the Planckian locus, A (ring) and B (cross)"
                    @for (i, primary) in primaries.iter().enumerate() { "; " (i + 1) " is " (primary.name) }
                    "."
                }
            }
        }
    })
}

fn plot(badge: &str, lamp: &NamedLamp<'_>, observer: &Observer) -> SpectralPlot {
    let lumens = LUMENS_PER_WATT * report::xyz(lamp.spectrum, observer)[1];
    let mut name: String = lamp.name.chars().take(LONGEST_TITLE).collect();
    if name.len() < lamp.name.len() {
        name += "…";
    }
    SpectralPlot::of_spectrum(
        &format!("{badge}: {name}"),
        &lamp.spectrum.scaled(1000.0 / lumens),
        "mW/(nm lm)",
        Some("mW/lm"),
    )
}

fn rendition(comparison: &LampComparison) -> Markup {
    let lamps = [0, 1].map(|i| (["A", "B"][i], comparison.reports[i].rendition.as_ref()));
    let bins = lamps.iter().find_map(|(_, found)| *found).map_or(0, |found| found.rf_bins.len());
    html! {
        h2 { "Colour rendition (TM-30)" }
        div.two {
            @for (badge, found) in lamps {
                figure.diagram {
                    @if let Some(found) = found { (PreEscaped(colour_vector_graphic(found))) }
                    figcaption {
                        span.badge { (badge) }
                        @if let Some(found) = found { (format!(" Rf {:.1}, Rg {:.1}", found.rf, found.rg)) } @else { " undefined" }
                    }
                }
            }
        }
        p.soft { "The circle is the reference illuminant of the same colour temperature. The red polygon is the lamp. The numbers are "
            "hue bins. An arrow that points outwards means that surfaces of this hue look more saturated. The grey circles are "
            "chroma shifts of ±20 %." }
        @if bins > 0 { div.table { table.patches {
            thead {
                tr { th {} th.group colspan="3" { "A" } th.group colspan="3" { "B" } }
                tr { th { "hue bin" } @for name in [["Rf", "chroma shift", "hue shift"]; 2].as_flattened() { th.number { (name) } } }
            }
            tbody { @for bin in 0..bins { tr {
                th scope="row" { (bin + 1) }
                @for (_, found) in lamps { @for cell in bin_cells(found, bin) { td.number { (cell) } } }
            } } }
        } } }
    }
}

/// Returns the local fidelity index, chroma shift and hue shift of a hue bin.
fn bin_cells(rendition: Option<&ColourRendition>, bin: usize) -> [String; 3] {
    let Some(found) = rendition else { return ["", "", ""].map(String::from) };
    let hue_shift = signed(found.hue_shift[bin], 2);
    [signed(found.rf_bins[bin], 1), signed(found.chroma_shift_percent[bin], 1) + " %", hue_shift]
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
                figcaption.chart-caption { "Colours for an observer adapted to each lamp, with ΔE2000 between the halves: "
                    (format!("mean {:.2}, largest {:.2} ({})", comparison.mean(), comparison.worst().delta_e_2000, comparison.worst().short_name()))
                    "." }
            }
            figure {
                (chart(comparison, left, false))
                figcaption.chart-caption { "Colours for an observer adapted to D65, at equal luminance of the lamps." }
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
            @if found > SHOWN_PAIRS { " The pairs with the largest split are shown." }
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

/// Returns the table of surfaces. `largest` is the largest ΔE2000 in the table.
fn table(patches: &[PatchDifference], largest: f64) -> Markup {
    let widest = largest.max(1.0);
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
            tbody { @for patch in patches { tr {
                th scope="row" { (patch.short_name()) }
                td { (halves("swatch", &adapted(patch))) }
                @for value in patch.lab.as_flattened() { td.number { (signed(*value, 1)) } }
                td.number { (format!("{:.2}", patch.delta_e_2000)) }
                td.bar { div style={"width:" (format!("{:.1}", 100.0 * patch.delta_e_2000 / widest)) "%"} {} }
            } } }
        } }
    }
}

/// Formats a number with a minus sign (−) instead of a hyphen, and zero without a sign.
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|digit| digit == '0' || digit == '.') => zero.to_string(),
        Some(positive) => format!("−{positive}"),
        None => text,
    }
}

fn notes(observer: &Observer) -> Markup {
    html! {
        h2 { "How it is computed" }
        p.soft {
            "Colours are computed for " (observer.name()) " with sums every nm from 360 to 830 nm. Spectral lines are evaluated at their wavelength. L*a*b* under a lamp "
            "use the XYZ of that lamp as white; the perfect diffuser has Y = 100. Adapted swatches show the same L*a*b* with D65 as "
            "white. Colours outside sRGB are desaturated at constant luminance. Patches: N. Ohta's measurement of the "
            "ColorChecker; test colours: CIE 13.3; leaves: PROSPECT-D. Ra by CIE 13.3 is undefined farther than 0.05 from the "
            "Planckian locus, and so are Rf and Rg by TM-30. Written by abbe " (env!("CARGO_PKG_VERSION")) "."
        }
    }
}

/// Returns the factor on XYZ that makes the largest RGB component of both whites 1.
fn exposure(comparison: &LampComparison) -> f64 {
    let components = comparison.reports.iter().flat_map(|report| report.linear_srgb);
    0.01 / components.fold(1.0, f64::max)
}

/// Returns the display colour of XYZ. White has Y = 1.
fn shown(xyz: Xyz) -> String {
    srgb_hex(desaturate(xyz_to_linear_srgb(xyz), RgbSpace::Srgb))
}

/// Returns the display colours of the patch under each lamp, after adaptation to that lamp.
fn adapted(patch: &PatchDifference) -> [String; 2] {
    patch.lab.map(|lab| shown(from_lab(lab, RgbSpace::Srgb.white())))
}
