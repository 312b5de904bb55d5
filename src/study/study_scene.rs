//! The scene of a study, and the render settings varied in the study.

use std::path::PathBuf;

use abbe_format::resolve::resolve;
use abbe_format::{self as format, FileAccess, SceneFile};
use abbe_session::render::{Integrator, Job};
use abbe_spectra::error::Result;
use serde::{Deserialize, Serialize};

/// The scene of a study. Its text is read once, so that all steps use the same scene.
#[derive(Debug, Clone)]
pub struct StudyScene {
    pub path: PathBuf,
    pub text: String,
    pub file_access: FileAccess,
    pub hash: String,
}

impl StudyScene {
    pub(super) fn scene_file(&self) -> Result<SceneFile> {
        Ok(format::parse(&self.text, &self.path, &[])?.0)
    }

    /// Applies changes in the form `PATH=JSON`, and then resolves and plans the scene.
    pub(super) fn job(&self, changes: &[String]) -> Result<Job> {
        let (scene, source) = format::parse(&self.text, &self.path, changes)?;
        let scene = resolve(&scene, &source.with_file_access(self.file_access))?;
        Job::new(scene).map_err(|error| error.in_file(&self.path))
    }
}

/// A render setting that trades time for accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// The number of photon paths in a pass.
    Photons,
    /// The number of photons within the first radius.
    Nearest,
    /// The first radius, in the scene's unit.
    Radius,
    /// The largest number of surface events on a path.
    MaxDepth,
    /// The number of steps of a ray march through a medium.
    MarchSteps,
}

impl Setting {
    /// The name of the setting as text.
    pub fn words(self) -> &'static str {
        match self {
            Self::Photons => "photons per pass",
            Self::Nearest => "nearest photons",
            Self::Radius => "first radius",
            Self::MaxDepth => "maximum path depth",
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

/// A setting with a value that differs from the scene's value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SettingChange {
    pub setting: Setting,
    /// The new value; an integer except for radii.
    pub value: f64,
}

impl SettingChange {
    /// The change in the form `PATH=JSON`.
    pub(super) fn patch(&self) -> String {
        format!("render.{}={}", self.setting.key(), self.value)
    }

    fn option(&self) -> String {
        match self.setting {
            Setting::Photons => format!("--photons {}", self.value),
            Setting::Nearest | Setting::Radius | Setting::MaxDepth | Setting::MarchSteps => {
                format!("--set {}", self.patch())
            }
        }
    }

    pub fn words(&self) -> String {
        format!("{}: {}", self.setting.words(), self.value)
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderSettings {
    pub integrator: Integrator,
    /// The difference from the scene's own settings, if there is one.
    pub change: Option<SettingChange>,
}

impl RenderSettings {
    pub const DEFAULT: Self = Self { integrator: Integrator::Photon, change: None };

    pub fn words(&self) -> String {
        match (self.integrator, &self.change) {
            (Integrator::Path, _) => "path tracer".to_string(),
            (Integrator::Photon, None) => "the scene's settings".to_string(),
            (Integrator::Photon, Some(change)) => change.words(),
        }
    }

    pub fn command(&self, study_scene: &StudyScene, passes: u64) -> String {
        let integrator = match self.integrator {
            Integrator::Photon => None,
            Integrator::Path => Some("--integrator path".to_string()),
        };
        let words = [format!("abbe render {}", study_scene.path.display()), format!("--passes {passes}")];
        words
            .into_iter()
            .chain(integrator)
            .chain(self.change.map(|change| change.option()))
            .collect::<Vec<_>>()
            .join(" ")
    }
}

/// Returns the title of an integrator. The argument is the name of the integrator in files.
pub fn integrator_title(integrator: &str) -> &'static str {
    if integrator == "path" { "path tracer" } else { "photons" }
}
