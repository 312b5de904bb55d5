//! Maps of texture coordinates.

use crate::prelude::*;

/// A map of texture coordinates: scale, then rotation, then offset.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Map of texture coordinates", example = json!({"scale": [4, 4], "rotate": 30, "offset": [0.5, 0]}))]
pub struct UvFile {
    /// Factors of u and v. A picture appears smaller by these factors.
    #[serde(default = "no_scale")]
    pub scale: [f64; 2],
    /// Angle by which a picture appears turned counter-clockwise.
    #[serde(default)]
    #[schemars(extend("x-unit" = "degrees"))]
    pub rotate: f64,
    /// Offset of u and v.
    #[serde(default)]
    pub offset: [f64; 2],
}

fn no_scale() -> [f64; 2] {
    [1.0; 2]
}

impl Default for UvFile {
    fn default() -> Self {
        Self { scale: no_scale(), rotate: 0.0, offset: [0.0; 2] }
    }
}
