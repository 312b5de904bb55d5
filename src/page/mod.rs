//! The page of the live view, apart from how it is served: its text, the data of its panels, the
//! pictures that it shows, and the answers to its requests. `abbe view` serves it over HTTP, and
//! the page in `web/` has the same answers from a WebAssembly module in a worker.

mod answer;
mod cells;
mod engine;
mod export;
mod layers;
mod loaded_scene;
mod photons;
mod pick;
mod probe;
mod scene_panels;
mod sketch;
mod snapshot;
mod state;

pub use answer::{Answer, Refusal};
pub use engine::PageEngine;
pub use loaded_scene::LoadedScene;

#[cfg(feature = "view")]
pub(crate) use answer::{ANSWERED, ANSWERED_OF_SCENE, answer, answer_of_scene};
#[cfg(feature = "view")]
pub(crate) use export::COLOURS;
#[cfg(feature = "view")]
pub(crate) use scene_panels::ScenePanels;
#[cfg(feature = "view")]
pub(crate) use sketch::SketchSize;
#[cfg(feature = "view")]
pub(crate) use snapshot::{Shown, Snapshot};
#[cfg(feature = "view")]
pub(crate) use state::{PageState, SessionState, ViewProgress};

/// The parts of the page in their order. `link` is the script that asks for answers.
pub fn text(link: &str) -> String {
    [
        include_str!("page_head.html"),
        include_str!("colours.css"),
        include_str!("page.css"),
        include_str!("page_body.html"),
        link,
        include_str!("colour.js"),
        include_str!("plots.js"),
        include_str!("page.js"),
        include_str!("compare.js"),
        include_str!("photons.js"),
        include_str!("plan.js"),
        include_str!("objects.js"),
        include_str!("ruler.js"),
        include_str!("export.js"),
        include_str!("controls.js"),
        "</script></body></html>\n",
    ]
    .concat()
}
