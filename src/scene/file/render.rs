//! Render settings as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::path::JsonPath;
use crate::error::Result;

/// How the picture is computed; the command line overrides it.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RenderFile {
    /// Number of passes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub passes: Option<u64>,
    /// Photon paths in a pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub photons: Option<u64>,
    /// Most surface events on a path (default 64).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub max_depth: Option<u32>,
    /// Number of photons whose distance gives the first radius; not with `radius`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub nearest: Option<u32>,
    /// First radius in the scene's unit; not with `nearest`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: Option<f64>,
    /// Seed of all randomness (default 0).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Number of threads (default: as many as the machine runs at once).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub threads: Option<u32>,
    /// Seconds between checkpoints (default 60).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub checkpoint_seconds: Option<f64>,
    /// Steps of a ray that marches through a medium (default 64).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1))]
    pub march_steps: Option<u32>,
    /// Volumetric light maps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light_map: Option<LightMapFile>,
    /// Effects to simulate although nothing calls for them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub force: Vec<String>,
    /// Effects to leave out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub forbid: Vec<String>,
}

/// Maps of the light that lamps bring into media.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightMapFile {
    /// Cells along the longest side of each medium's box in the first pass; their number grows from pass to pass.
    #[schemars(range(min = 2, max = 1024))]
    pub resolution: u32,
}

impl RenderFile {
    /// Checks ranges.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let counts = [
            ("passes", self.passes),
            ("photons", self.photons),
            ("max_depth", self.max_depth.map(u64::from)),
            ("nearest", self.nearest.map(u64::from)),
            ("threads", self.threads.map(u64::from)),
            ("march_steps", self.march_steps.map(u64::from)),
        ];
        for (key, value) in counts {
            value.map_or(Ok(()), |value| check::count(&at.key(key), value, 1, u64::MAX))?;
        }
        self.radius.map_or(Ok(()), |radius| check::positive(&at.key("radius"), radius))?;
        if self.nearest.is_some() && self.radius.is_some() {
            return Err(check::fault(&at.key("radius"), "found beside `nearest`", "at most one of nearest, radius"));
        }
        let seconds_at = at.key("checkpoint_seconds");
        self.checkpoint_seconds.map_or(Ok(()), |seconds| check::not_negative(&seconds_at, seconds))?;
        let resolution_at = at.key("light_map");
        self.light_map
            .map_or(Ok(()), |map| check::count(&resolution_at.key("resolution"), u64::from(map.resolution), 2, 1024))
    }
}
