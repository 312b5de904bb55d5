//! The HTML page of a regression report: the worst cases with their expected and converted colours.

use maud::{Markup, html};

use super::page::document;
use abbe_spectra::colour::gamut::{brightest, desaturate};
use abbe_spectra::colour::regress::{CaseComparison, CaseGroup, ColourComparison, RegressionReport};
use abbe_spectra::colour::{RgbSpace, srgb_hex};

/// The largest number of cases that the page shows.
const SHOWN: usize = 40;

/// Returns the page. `source` is the name of the file with the converted colours.
pub fn page(report: &RegressionReport, source: &str) -> String {
    let title = format!("{source} against {}", report.set);
    let tolerances = report.tolerances;
    let body = html! {
        h1 { (title) }
        p { strong { (report.verdict()) } }
        @if let Some(cause) = report.cause_in_words() { p.warning { (cause) "." } }
        p.soft { "A case passes if ΔE2000 is at most " (tolerances.delta_e_2000) " and no component differs by more than "
            (tolerances.component) " of white or of the largest expected component." }
        (groups(report))
        h2 { "Worst cases" }
        div.table { table.patches {
            thead { tr {
                th { "expected, found" } th { "case" } th.number { "ΔE2000" } th.number { "component" }
                th { "form" } th { "expected" br; "found" }
            } }
            tbody { @for case in report.cases.iter().take(SHOWN) { (row(case)) } }
        } }
        @if report.cases.len() > SHOWN { p.soft { "The other " (report.cases.len() - SHOWN) " cases differ less." } }
        p.soft { "Each swatch shows the expected colour in its left half and the converted colour in its right half. "
            "Colours outside sRGB lose saturation, and lights are shown as bright as their chromaticity allows." }
    };
    document(&title, include_str!("lamps_page.css"), &body)
}

fn groups(report: &RegressionReport) -> Markup {
    html! {
        table.patches {
            thead { tr { th { "group" } th.number { "cases" } th.number { "failed" } th.number { "largest ΔE2000" } } }
            tbody {
                @for summary in &report.groups {
                    tr {
                        td { (summary.group.name()) }
                        td.number { (summary.compared) }
                        td.number { (summary.failed) }
                        td.number { (number(summary.delta_e_2000)) }
                    }
                }
            }
        }
    }
}

fn row(case: &CaseComparison) -> Markup {
    let worst = case.colours.iter().max_by(|a, b| difference(a).total_cmp(&difference(b)));
    html! {
        @if let Some(colour) = worst {
            tr {
                td { span.swatch {
                    span style={"background:" (swatch(case, colour, colour.expected))} {}
                    span style={"background:" (swatch(case, colour, colour.found))} {}
                } }
                td { (case.id) @if !case.passed { " " strong { "failed" } } }
                td.number { (number(case.delta_e_2000())) }
                td.number { (number(case.component())) }
                td { (colour.form.name()) }
                td { (triple(colour.expected)) br; (triple(colour.found)) }
            }
        }
    }
}

fn difference(colour: &ColourComparison) -> f64 {
    colour.delta_e_2000.unwrap_or(f64::INFINITY)
}

/// Returns a colour that a browser can show. A colour that is not finite is transparent.
fn swatch(case: &CaseComparison, colour: &ColourComparison, value: [f64; 3]) -> String {
    if value.iter().any(|component| !component.is_finite()) {
        return "transparent".to_string();
    }
    let linear = colour.form.linear_srgb(value);
    let is_surface = matches!(case.group, CaseGroup::Surfaces | CaseGroup::Metamers | CaseGroup::Fluorescent);
    srgb_hex(if is_surface { desaturate(linear, RgbSpace::Srgb) } else { brightest(linear) })
}

fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:.5}") } else { "not finite".to_string() }
}

fn triple(values: [f64; 3]) -> String {
    values.map(|value| format!("{value:.4}")).join(", ")
}
