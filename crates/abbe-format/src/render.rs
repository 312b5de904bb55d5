//! Render settings in the scene file.

use crate::prelude::*;
use crate::{JsonPath, check};
use abbe_spectra::error::Result;

/// The render settings.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Render settings", example = json!({"passes": 64, "photons": 200_000, "camera_samples": 2,
    "max_depth": 8, "nearest": 50, "seed": 0, "threads": 8, "checkpoint_seconds": 60, "march_steps": 64,
    "light_map": {"resolution": 32}, "force": ["dispersion"], "forbid": ["caustics"]}))]
#[schemars(example = json!({"radius": 0.01}))]
pub struct RenderFile {
    /// Number of passes. Noise falls with the square root of this number.
    #[schemars(range(min = 1), extend("x-default" = "64, more for fast motion"))]
    pub passes: Option<u64>,
    /// Number of photon paths in each pass.
    #[schemars(range(min = 1), extend("x-default" = "200 000; for films with more pixels, one per pixel, at most 1 000 000; fewer for fast motion; the pilot then multiplies the number by 1/8 to 4, so that the noise falls fastest"))]
    pub photons: Option<u64>,
    /// Number of camera samples in each pixel and pass.
    #[schemars(range(min = 1, max = 1024), extend("x-default" = "1 to 16, chosen from the noise of photons and of camera samples"))]
    pub camera_samples: Option<u32>,
    /// Largest number of surface events on the whole way of the light from its source to the camera
    /// or to a meter. A reflection at a surface is an event, and so is each transmission through
    /// one: light passes a glass ball in two events. Emission, scattering in a medium and the
    /// arrival at a meter are none, so a lamp that the camera sees directly has 0 events, and
    /// direct light on a wall has 1. Without this key, paths end by Russian roulette, and no light
    /// is lost. The light that the limit removes from the picture is in the bias bars.
    #[schemars(range(min = 1), extend("x-default" = "no limit"))]
    pub max_depth: Option<u32>,
    /// Number of photons that the gather radius of the first pass encloses, if the pilot does not
    /// change the number of photon paths. Not together with `radius`.
    #[schemars(range(min = 1), extend("default" = 50))]
    pub nearest: Option<u32>,
    /// Gather radius of the first pass. Not together with `nearest`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit", "x-default" = "found from `nearest`"))]
    pub radius: Option<f64>,
    /// Seed of the random numbers.
    #[schemars(extend("default" = 0))]
    pub seed: Option<u64>,
    /// Number of threads.
    #[schemars(range(min = 1), extend("x-default" = "all hardware threads"))]
    pub threads: Option<u32>,
    /// Time between checkpoints.
    #[schemars(range(min = 0), extend("default" = 60, "x-unit" = "s"))]
    pub checkpoint_seconds: Option<f64>,
    /// Number of steps for media with the transmittance estimator "march".
    #[schemars(range(min = 1), extend("default" = 64))]
    pub march_steps: Option<u32>,
    /// The maps of direct light in media.
    pub light_map: Option<LightMapFile>,
    /// Names of effects to simulate even if the scene does not need them. `abbe explain` lists the
    /// effects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub force: Vec<String>,
    /// Names of effects to leave out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub forbid: Vec<String>,
}

/// The maps of direct light in media.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Light map", example = json!({"resolution": 32}))]
pub struct LightMapFile {
    /// Number of cells along the longest side of each medium's box in the first pass. The number
    /// grows from pass to pass.
    #[schemars(range(min = 2, max = 1024), extend("x-unit" = "cells"))]
    pub resolution: u32,
}

impl RenderFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let counts = [
            ("passes", self.passes),
            ("photons", self.photons),
            ("max_depth", self.max_depth.map(u64::from)),
            ("nearest", self.nearest.map(u64::from)),
            ("threads", self.threads.map(u64::from)),
            ("march_steps", self.march_steps.map(u64::from)),
        ];
        let counts =
            counts.map(|(key, value)| value.map_or(Ok(()), |value| check::count(&at.key(key), value, 1, u64::MAX)));
        let radius = match self.radius {
            Some(_) if self.nearest.is_some() => {
                Err(check::fault(&at.key("radius"), "found together with `nearest`", "at most one of nearest, radius"))
            }
            radius => radius.map_or(Ok(()), |radius| check::positive(&at.key("radius"), radius)),
        };
        let samples = |n: u32| check::count(&at.key("camera_samples"), u64::from(n), 1, 1024);
        let seconds = |seconds: f64| check::not_negative(&at.key("checkpoint_seconds"), seconds);
        let at_map = at.key("light_map");
        let map = |map: LightMapFile| check::count(&at_map.key("resolution"), u64::from(map.resolution), 2, 1024);
        check::all(counts.into_iter().chain([
            self.camera_samples.map_or(Ok(()), samples),
            radius,
            self.checkpoint_seconds.map_or(Ok(()), seconds),
            self.light_map.map_or(Ok(()), map),
        ]))
    }
}
