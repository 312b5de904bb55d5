//! The self-contained HTML page of a luminaire: a polar diagram and a table of figures.

use maud::{PreEscaped, html};

use super::page::document;
use super::polar::PolarDiagram;

/// Returns the page. `rows` are the names and the values of the table.
pub fn page(title: &str, rows: &[(&str, String)], diagram: &PolarDiagram) -> String {
    let body = html! {
        h1 { (title) }
        div.two {
            figure { (PreEscaped(diagram.svg())) }
            div.table { table { tbody {
                @for (name, value) in rows { tr { th.soft scope="row" { (name) } td { (value) } } }
            } } }
        }
        p.soft {
            "The intensity is interpolated linearly in the angles of the file. The flux is the integral of the interpolated "
            "intensity. The beam angle and the field angle are the angles between the two outermost directions with at least "
            "50 % and 10 % of the largest intensity in the plane. Written by abbe " (env!("CARGO_PKG_VERSION")) "."
        }
    };
    let style = ".two { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 1rem 2.5rem; \
                 align-items: start; max-width: 70rem; }\n.table { margin-top: 2rem; }\n";
    document(title, style, &body)
}
