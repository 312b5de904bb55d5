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

const STYLE: &str = "\
.readings td, .readings th { text-align: right; padding: .1rem 0 .1rem 1.5rem; white-space: nowrap; }
.readings td:first-child, .readings th:first-child { text-align: left; padding-left: 0; }
.readings thead th { color: var(--soft); border-bottom: 1px solid var(--rule); }
.map { max-width: 60rem; margin: 1rem 0; }
.map svg { display: block; width: 100%; height: auto; fill: var(--ink); }
.map .edge { stroke: var(--rule); }
.scale { display: flex; gap: .75rem; align-items: center; margin: .5rem 0; }
.scale span.bar { flex: 0 1 24rem; height: .9rem; border-radius: .2rem; }
";

/// Returns the page. `notes` are sentences about the whole measurement.
pub fn page(title: &str, sections: &[MeterSection], notes: &[String]) -> String {
    let body = html! {
        h1 { (title) }
        @for section in sections {
            h2 { (section.title) }
            @if let Some(plan) = &section.plan { (map(plan)) }
            @if let Some(summary) = &section.summary { p { (summary) } }
            (table(section))
        }
        h2 { "Notes" }
        @for note in notes { p.soft { (note) } }
        p.soft {
            "An interval contains the true value with a probability of 95 %. The noise is the standard error, and the bias is "
            "its estimated magnitude. Isolines are interpolated linearly between the readings. Written by abbe "
            (env!("CARGO_PKG_VERSION")) "."
        }
    };
    document(title, STYLE, &body)
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
