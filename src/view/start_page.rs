//! The page on which the reader chooses an example scene. It has no script.

use super::examples::{EXAMPLES, Example};
use crate::page;
use abbe_session::output::data_uri::data_uri;
use maud::{DOCTYPE, PreEscaped, html};

/// Returns the text of the page. `open` is the scene that is rendered.
pub(super) fn text(open: Option<&Example>) -> String {
    let style = [page::COLOURS, include_str!("start_page.css")].concat();
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Abbe: choose a scene" }
                style { (PreEscaped(style)) }
            }
            body {
                header {
                    h1 { "Abbe: choose a scene" }
                    p {
                        "Abbe follows photons of real wavelengths from the lamp to the film. A scene renders at once: point "
                        "at its picture for a spectrum, drag its objects, or show the paths of its photons."
                    }
                    @if let Some(example) = open {
                        p class="open" { a href="view" { "Back to “" (example.title().0) "”" } ", which is still open." }
                    }
                }
                main {
                    ul class="cards" {
                        @for example in EXAMPLES { (card(example, open == Some(example))) }
                    }
                }
                footer {
                    p { "For a scene of your own, run " code { "abbe view SCENE.json" } "." }
                }
            }
        }
    };
    markup.into_string()
}

fn card(example: &Example, is_open: bool) -> PreEscaped<String> {
    let (heading, rest) = example.title();
    html! {
        li {
            a href={ "view#" (example.name) } aria-current=[is_open.then_some("true")] {
                img src=(data_uri("image/webp", example.thumbnail)) alt="" width="320" height="180";
                h2 { (heading) }
                @if !rest.is_empty() { p { (rest) } }
            }
        }
    }
}
