//! A scene that is ready to render, and what its pictures say of it.

use crate::api::memory;
use crate::api::provenance::{self, SceneFiles};
use abbe_format::{JsonSource, SceneFile, resolve};
use abbe_session::output::Metadata;
use abbe_session::render::{Integrator, Job};
use abbe_spectra::error::Result;

#[derive(Debug)]
pub struct LoadedScene {
    /// The text of the scene after all changes.
    pub source: JsonSource,
    pub job: Job,
    /// The header entries that describe the scene.
    pub metadata: Metadata,
}

impl LoadedScene {
    /// Resolves a scene and plans its render. Returns an input error if values of the scene
    /// contradict each other, or if a file of it cannot be read, and a machine error if the render
    /// needs too much memory.
    pub fn new(scene: &SceneFile, source: JsonSource) -> Result<Self> {
        let job = Job::of_picture(resolve::resolve(scene, &source)?).map_err(|error| error.in_file(&source.path))?;
        memory::check(&job.budget)?;
        let files = SceneFiles::of(&source);
        let metadata =
            provenance::reproducible(provenance::of_scene(Some((&source, &files)), &job, Integrator::Photon));
        Ok(Self { source, job, metadata })
    }

    /// Returns the change of the scene that forbids effects in addition to those that it forbids
    /// itself, or `None` without effects.
    pub fn change_to_forbid(scene: &SceneFile, effects: &[String]) -> Option<String> {
        let all: Vec<&String> = scene.render.forbid.iter().chain(effects).collect();
        let list = serde_json::to_string(&all).expect("a list of texts is JSON");
        (!effects.is_empty()).then(|| format!("render.forbid={list}"))
    }
}
