//! The identity of a render: all inputs that affect its passes.

use super::job::Job;
use super::request::Integrator;
use super::scene_difference::first_difference;
use crate::output::metadata::{Metadata, names};
use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::LayerSet;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// All inputs of a pass except its index. Runs with equal identities can share passes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderIdentity {
    integrator: String,
    seed: u64,
    photons: u64,
    size: (u32, u32),
    spectral_bands: u32,
    layers: LayerSet,
    effects: Vec<String>,
    scene_hash: String,
    /// The scene, to name a difference. The header of a saved run contains it, the record does not.
    #[serde(skip)]
    scene: String,
}

impl RenderIdentity {
    /// `header` contains the effective scene, and the hash of this scene and its files.
    pub fn of(job: &Job, integrator: Integrator, header: &Metadata) -> Self {
        let film = &job.scene.film;
        Self {
            integrator: integrator.word().to_string(),
            seed: job.budget.seed.number(),
            photons: job.budget.photons,
            size: (film.width, film.height),
            spectral_bands: film.spectral_bands,
            layers: job.layers.clone(),
            effects: job.rows.iter().map(|row| format!("{} {}", row.effect.name, row.state.word())).collect(),
            scene_hash: header.get(names::SCENE_HASH).unwrap_or_default().to_string(),
            scene: String::new(),
        }
        .with_scene_of(header)
    }

    /// Takes the scene from the header of a file.
    pub(super) fn with_scene_of(self, header: &Metadata) -> Self {
        Self { scene: header.get(names::SCENE).unwrap_or_default().to_string(), ..self }
    }

    /// Returns the width and height of the film in pixels, and the number of spectral bands.
    pub(super) fn film_size(&self) -> ([usize; 2], usize) {
        let (width, height) = self.size;
        ([width as usize, height as usize], self.spectral_bands as usize)
    }

    pub(super) fn layers(&self) -> &LayerSet {
        &self.layers
    }

    /// Finds the first difference. Returns the actual and the expected value as text.
    fn difference(&self, expected: &Self) -> Option<(String, String)> {
        let Self { integrator, seed, photons, size, spectral_bands, layers, effects, scene_hash, scene } = self;
        let effects = effects.iter().find(|effect| !expected.effects.contains(effect));
        let other_effect = expected.effects.iter().find(|effect| !self.effects.contains(effect));
        let parsed = |scene: &str| serde_json::from_str::<Value>(scene).unwrap_or_default();
        let other_scene = || match first_difference(&parsed(scene), &parsed(&expected.scene)) {
            Some([here, there]) => (format!("another scene: {here}"), format!("a scene in which {there}")),
            None => {
                let what = "another scene: a file that the scene names, or the order of its keys, has changed";
                (what.to_string(), "the same scene, with unchanged files".to_string())
            }
        };
        let pixels = |(width, height): (u32, u32)| format!("{width} × {height} pixels");
        let effect = |effect: Option<&String>| format!("the effect {}", effect.map_or("none", String::as_str));
        let pairs = [
            (integrator != &expected.integrator)
                .then(|| (format!("integrator {integrator}"), format!("integrator {}", expected.integrator))),
            (seed != &expected.seed).then(|| (format!("seed {seed}"), format!("seed {}", expected.seed))),
            (photons != &expected.photons)
                .then(|| (format!("{photons} photons per pass"), format!("{} photons per pass", expected.photons))),
            (size != &expected.size).then(|| (pixels(*size), pixels(expected.size))),
            (spectral_bands != &expected.spectral_bands).then(|| {
                (format!("{spectral_bands} spectral bands"), format!("{} spectral bands", expected.spectral_bands))
            }),
            (layers.words() != expected.layers.words()).then(|| (layers.words(), expected.layers.words())),
            (effects.is_some() || other_effect.is_some()).then(|| (effect(effects), effect(other_effect))),
            (scene_hash != &expected.scene_hash).then(other_scene),
        ];
        pairs.into_iter().flatten().next()
    }

    /// Returns an input error that names the first difference from the expected identity.
    pub(super) fn check(&self, expected: &Self) -> Result<()> {
        match self.difference(expected) {
            None => Ok(()),
            Some((here, there)) => Err(Error::input(format!("was rendered with {here}")).expected(there)),
        }
    }
}
