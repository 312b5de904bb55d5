//! The interface of the library for its users: scenes, options, images. The crate root re-exports
//! its public items. The command line also uses the helpers [`PlanReport`], [`memory`] and
//! [`provenance`], so that both write the same files.

pub mod memory;
mod observer;
mod options;
mod plan_report;
pub mod provenance;
mod rendered_image;
mod scene;
mod scene_text;

pub use observer::{RenderObserver, UnfinishedRender};
pub use options::RenderOptions;
pub use plan_report::PlanReport;
pub use rendered_image::{Image, PixelSpectrum};
pub use scene::Scene;
pub use scene_text::{SceneText, read_scene_text, scene_inputs};
