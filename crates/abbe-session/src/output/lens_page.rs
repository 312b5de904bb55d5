//! The self-contained HTML page of a lens: its figures, its prescription and its plots, in light
//! colours for A4 paper.

use maud::{Markup, PreEscaped, html};

use super::page::document;

/// A table with a header line. Cells hold text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PageTable {
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

/// A section with figures.
#[derive(Debug, Clone, PartialEq)]
pub struct PageSection {
    pub heading: String,
    /// SVG documents. Two of a section are side by side if the page is wide enough.
    pub figures: Vec<String>,
    /// What the figures show and how it is computed.
    pub caption: String,
}

/// The content of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct LensPage {
    pub title: String,
    /// The conditions of the analysis, in one line.
    pub conditions: String,
    pub source: Option<String>,
    /// Remarks of the reader of the lens file.
    pub notes: Vec<String>,
    /// Names and values of the paraxial figures.
    pub figures: Vec<(String, String)>,
    pub section: String,
    pub prescription: PageTable,
    pub sections: Vec<PageSection>,
    pub fields: PageTable,
}

/// Returns the page.
pub fn page(page: &LensPage) -> String {
    let half = page.figures.len().div_ceil(2);
    let body = html! {
        h1 { (page.title) }
        p.soft { (page.conditions) }
        @if let Some(source) = &page.source { p.soft { "Source of the design: " (source) } }
        @for note in &page.notes { p.warning { "Note: " (note) "." } }
        figure { (PreEscaped(&page.section)) }
        div.two.figures {
            @for rows in page.figures.chunks(half.max(1)) {
                table { tbody {
                    @for (name, value) in rows { tr { th.soft scope="row" { (name) } td { (value) } } }
                } }
            }
        }
        section {
            h2 { "Fields" }
            (table(&page.fields))
        }
        section {
            h2 { "Prescription" }
            (table(&page.prescription))
            p.soft {
                "Lengths are in mm. A radius is positive if the centre of curvature lies on the side of the sensor. "
                "The index n" sub { "d" } " and the Abbe number V" sub { "d" }
                " are those of the medium behind the surface."
            }
        }
        @for PageSection { heading, figures, caption } in &page.sections {
            section {
                h2 { (heading) }
                div class=(if figures.len() > 1 { "two" } else { "one" }) {
                    @for svg in figures { figure { (PreEscaped(svg)) } }
                }
                p.soft { (caption) }
            }
        }
        p.soft { "Written by abbe " (env!("CARGO_PKG_VERSION")) "." }
    };
    document(&page.title, include_str!("lens_page.css"), &body)
}

fn table(table: &PageTable) -> Markup {
    html! {
        div.table { table.numbers {
            thead { tr { @for name in &table.header { th scope="col" { (heading(name)) } } } }
            tbody { @for row in &table.rows { tr { @for cell in row { td { (cell) } } } } }
        } }
    }
}

/// Returns the name of a column, with the index of a symbol such as `n_d` below the line.
fn heading(name: &str) -> Markup {
    match name.split_once('_') {
        Some((symbol, index)) => html! { (symbol) sub { (index) } },
        None => html! { (name) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_contains_all_parts_and_escapes_text() {
        let words = |list: &[&str]| list.iter().map(|word| (*word).to_string()).collect::<Vec<_>>();
        let content = LensPage {
            title: "a <lens>".to_string(),
            conditions: "at 3 wavelengths".to_string(),
            source: Some("a patent".to_string()),
            notes: words(&["a remark"]),
            figures: vec![("focal length".to_string(), "100 mm".to_string())],
            section: "<svg id=\"section\"></svg>".to_string(),
            prescription: PageTable { header: words(&["radius"]), rows: vec![words(&["61.47"])] },
            sections: vec![PageSection {
                heading: "MTF".to_string(),
                figures: words(&["<svg id=\"mtf\"></svg>", "<svg id=\"through\"></svg>"]),
                caption: "what it is".to_string(),
            }],
            fields: PageTable::default(),
        };
        let page = page(&content);
        for part in ["a &lt;lens&gt;", "3 wavelengths", "a patent", "a remark", "100 mm", "61.47", "what it is"] {
            assert!(page.contains(part), "{part}");
        }
        assert_eq!(page.matches("<svg id=").count(), 3);
    }
}
