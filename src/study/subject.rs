//! What is studied: a scene, and the settings of its render that may be changed.

use std::path::PathBuf;

use crate::error::Result;
use crate::render::{Integrator, Job};
use crate::scene::file::{self, Reach, SceneFile};
use crate::scene::resolve::resolve;
use serde::{Deserialize, Serialize};

/// A scene whose text has been read once, so that all of a study sees the same.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Its file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Which files it may name.
    pub reach: Reach,
    /// A hash of the scene and of the files that it refers to.
    pub hash: String,
}

impl Subject {
    /// The scene as it is written.
    pub(super) fn written(&self) -> Result<SceneFile> {
        Ok(file::parse(&self.text, &self.path, &[])?.0)
    }

    /// The scene with changes (`PATH=JSON`), planned.
    pub(super) fn job(&self, changes: &[String]) -> Result<Job> {
        let (scene, source) = file::parse(&self.text, &self.path, changes)?;
        let scene = resolve(&scene, &source.reaching(self.reach))?;
        Job::new(scene).map_err(|error| error.in_file(&self.path))
    }
}

/// A setting of `render` that trades time for accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// Photon paths in a pass.
    Photons,
    /// Photons within the first radius.
    Nearest,
    /// The first radius, in the scene's unit.
    Radius,
    /// Most surface events on a path.
    MaxDepth,
    /// Steps of a march through a medium.
    MarchSteps,
}

impl Setting {
    /// What it is, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Photons => "photons a pass",
            Self::Nearest => "nearest photons",
            Self::Radius => "first radius",
            Self::MaxDepth => "most surface events",
            Self::MarchSteps => "march steps",
        }
    }

    fn key(self) -> &'static str {
        match self {
            Self::Photons => "photons",
            Self::Nearest => "nearest",
            Self::Radius => "radius",
            Self::MaxDepth => "max_depth",
            Self::MarchSteps => "march_steps",
        }
    }
}

/// A setting with another value than the scene's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// The setting.
    pub setting: Setting,
    /// Its value; whole numbers but for radii.
    pub value: f64,
}

impl Change {
    /// The change as a patch of the scene.
    pub(super) fn patch(&self) -> String {
        format!("render.{}={}", self.setting.key(), self.value)
    }

    /// The change as an option of `abbe render`.
    fn option(&self) -> String {
        match self.setting {
            Setting::Photons => format!("--photons {}", self.value),
            Setting::Nearest | Setting::Radius | Setting::MaxDepth | Setting::MarchSteps => {
                format!("--set {}", self.patch())
            }
        }
    }

    /// The change in words.
    pub fn words(&self) -> String {
        format!("{}: {}", self.setting.words(), self.value)
    }
}

/// How a picture is rendered, but for its number of passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// Who solves the transport.
    pub integrator: Integrator,
    /// What differs from the scene's own settings.
    pub change: Option<Change>,
}

impl Recipe {
    /// Photon mapping by the scene's own settings.
    pub const DEFAULT: Self = Self { integrator: Integrator::Photon, change: None };

    /// In words.
    pub fn words(&self) -> String {
        match (self.integrator, &self.change) {
            (Integrator::Path, _) => "path tracer".to_string(),
            (Integrator::Photon, None) => "the scene's settings".to_string(),
            (Integrator::Photon, Some(change)) => change.words(),
        }
    }

    /// The command that renders so.
    pub fn command(&self, subject: &Subject, passes: u64) -> String {
        let integrator = match self.integrator {
            Integrator::Photon => None,
            Integrator::Path => Some("--integrator path".to_string()),
        };
        let words = [format!("abbe render {}", subject.path.display()), format!("--passes {passes}")];
        words
            .into_iter()
            .chain(integrator)
            .chain(self.change.map(|change| change.option()))
            .collect::<Vec<_>>()
            .join(" ")
    }
}
