//! The self-contained HTML page of a measurement: the readings of every meter in a table, and the
//! plan of every grid in false colours with isolines.

use maud::{Markup, PreEscaped, html};

use super::heat;
use super::page::document;
use super::plan_map::PlanMap;

#[derive(Debug, Clone)]
pub struct MeterSection {
    /// The name and the quantity of the meter.
    pub title: String,
    pub plan: Option<PlanMap>,
    pub columns: Vec<String>,
    /// The rows of the table. Numbers are aligned by their columns.
    pub rows: Vec<Vec<String>>,
    /// The mean and the uniformity, if there are several readings.
    pub summary: Option<String>,
}

/// A limit and its judgement.
#[derive(Debug, Clone)]
pub struct VerdictRow {
    /// The meter, the limit, the value, its interval, the verdict and the source.
    pub cells: [String; 6],
    /// The class of the row: `met`, `missed` or `undecided`.
    pub class: &'static str,
}

/// The page of a measurement.
#[derive(Debug, Clone)]
pub struct MetersPage<'a> {
    pub title: &'a str,
    /// The file of the scene and how it was measured.
    pub made: String,
    pub verdicts: Vec<VerdictRow>,
    /// The name, the power, the luminous flux, the efficacy and the colour temperature of each
    /// light.
    pub lights: Vec<[String; 5]>,
    pub sections: Vec<MeterSection>,
    /// Sentences about the whole measurement.
    pub notes: &'a [String],
}

const STYLE: &str = include_str!("meters_page.css");

const VERDICT_COLUMNS: [&str; 6] = ["meter", "requirement", "value", "95 % interval", "verdict", "source"];

const LIGHT_COLUMNS: [&str; 5] = ["light", "power in W", "luminous flux in lm", "lm/W", "colour temperature in K"];

pub fn page(page: &MetersPage<'_>) -> String {
    let MetersPage { title, made, verdicts, lights, sections, notes } = page;
    let body = html! {
        h1 { (title) }
        p.soft { (made) }
        @if !verdicts.is_empty() { (verdict_table(verdicts)) }
        @for section in sections {
            section.meter {
                h2 { (section.title) }
                @if let Some(plan) = &section.plan { (map(plan)) }
                @if let Some(summary) = &section.summary { p { (summary) } }
                (table(section))
            }
        }
        @if !lights.is_empty() { (light_table(lights)) }
        section {
            h2 { "Notes" }
            @for note in *notes { p.soft { (note) } }
            p.soft {
                "An interval contains the true value with a probability of 95 %. The noise is the standard error, and the "
                "bias is its estimated magnitude. Isolines are interpolated linearly between the readings, and continue to "
                "the edges as between the last two."
            }
            @if !verdicts.is_empty() {
                p.soft {
                    "A requirement is met, or not met, if the whole interval lies on one side of its limit. Otherwise it is "
                    "undecided, and more passes narrow the interval. The intervals of means and of uniformities hold "
                    "whatever the readings have in common."
                }
            }
        }
    };
    document(title, STYLE, &body)
}

fn verdict_table(verdicts: &[VerdictRow]) -> Markup {
    html! {
        section {
            h2 { "Requirements" }
            div.table { table.readings.verdicts {
                thead { tr { @for column in VERDICT_COLUMNS { th scope="col" { (column) } } } }
                tbody { @for row in verdicts { tr class=(row.class) { @for cell in &row.cells { td { (cell) } } } } }
            } }
        }
    }
}

fn light_table(lights: &[[String; 5]]) -> Markup {
    html! {
        section {
            h2 { "Lights" }
            div.table { table.readings {
                thead { tr { @for column in LIGHT_COLUMNS { th scope="col" { (column) } } } }
                tbody { @for row in lights { tr { @for cell in row { td { (cell) } } } } }
            } }
            p.soft { "The power is that within 360–830 nm, and the efficacy is relative to it, not to electrical power." }
        }
    }
}

fn map(plan: &PlanMap) -> Markup {
    let bar = format!("background: linear-gradient(to right, {})", heat::css_colours());
    html! {
        figure.map {
            (PreEscaped(plan.svg()))
            div.scale { span { "0" } span.bar style=(bar) {} span { (plan.most_label()) } }
            figcaption { (plan.caption()) }
        }
    }
}

/// Renders the readings. A long table is folded.
fn table(section: &MeterSection) -> Markup {
    /// The number of rows that are shown without a click.
    const OPEN_ROWS: usize = 40;
    let table = html! {
        div.table { table.readings {
            thead { tr { @for column in &section.columns { th scope="col" { (column) } } } }
            tbody { @for row in &section.rows { tr { @for cell in row { td { (cell) } } } } }
        } }
    };
    html! {
        @if section.rows.len() <= OPEN_ROWS { (table) }
        @else { details { summary { (section.rows.len()) " readings" } (table) } }
    }
}
