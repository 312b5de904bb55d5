//! The identity of a render: all inputs that affect its passes.

use super::job::Job;
use super::request::Integrator;
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// All inputs that affect a pass, except the index of the pass. Runs with equal identities can
/// share passes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderIdentity {
    integrator: String,
    seed: u64,
    photons: u64,
    /// The width and height in pixels.
    size: (u32, u32),
    spectral_bands: u32,
    /// The name and state of each effect.
    effects: Vec<String>,
    scene_hash: String,
}

impl RenderIdentity {
    /// Returns the identity of a job. `scene_hash` is the hash of the effective scene and its
    /// files.
    pub fn of(job: &Job, integrator: Integrator, scene_hash: &str) -> Self {
        let film = &job.scene.film;
        Self {
            integrator: integrator.word().to_string(),
            seed: job.budget.seed,
            photons: job.budget.photons,
            size: (film.width, film.height),
            spectral_bands: film.spectral_bands,
            effects: job.rows.iter().map(|row| format!("{} {}", row.effect.name, row.state.word())).collect(),
            scene_hash: scene_hash.to_string(),
        }
    }

    /// Returns the width and height of the film in pixels, and the number of spectral bands.
    pub(super) fn film_size(&self) -> ([usize; 2], usize) {
        let (width, height) = self.size;
        ([width as usize, height as usize], self.spectral_bands as usize)
    }

    /// Finds the first difference from the expected identity. Returns the actual value and the
    /// expected value as text.
    fn difference(&self, expected: &Self) -> Option<(String, String)> {
        let Self { integrator, seed, photons, size, spectral_bands, effects, scene_hash } = self;
        let effects = effects.iter().find(|effect| !expected.effects.contains(effect));
        let other_effect = expected.effects.iter().find(|effect| !self.effects.contains(effect));
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
            (effects.is_some() || other_effect.is_some()).then(|| (effect(effects), effect(other_effect))),
            (scene_hash != &expected.scene_hash).then(|| {
                let same = "the same scene, with unchanged files".to_string();
                ("another scene".to_string(), same)
            }),
        ];
        pairs.into_iter().flatten().next()
    }

    /// Compares a file's identity with the expected one.
    ///
    /// # Errors
    /// Returns an input error that names the first difference.
    pub(super) fn check(&self, expected: &Self) -> Result<()> {
        match self.difference(expected) {
            None => Ok(()),
            Some((here, there)) => Err(Error::input(format!("was rendered with {here}")).expected(there)),
        }
    }
}
