//! Self-contained HTML pages, in light or dark mode as the reader prefers.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const COMMON_STYLE: &str = include_str!("page.css");

/// Returns an HTML page that contains `body`. `style` is appended to the common style sheet.
pub fn document(title: &str, style: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(COMMON_STYLE)) (PreEscaped(style)) }
            }
            body { (body) }
        }
    };
    page.into_string()
}
