//! Scalar fields of inhomogeneous media in the scene file.

use crate::prelude::*;
use crate::{JsonPath, check, forms};
use abbe_spectra::error::Result;

/// A scalar field over the box of a grid. State exactly one of `values` (with `resolution`),
/// `path`, `constant`, `exponential`, `sphere` and `noise`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Field", example = json!({"values": [0, 1, 2, 3, 4, 5, 6, 7], "resolution": [2, 2, 2]}))]
#[schemars(example = json!({"path": "smoke.npy"}), example = json!({"constant": 1500}))]
#[schemars(example = json!({"exponential": {"value": 1, "scale_height": 0.3}}))]
#[schemars(example = json!({"sphere": {"value": 1, "center": [0, 1, 0], "radius": 0.5}}))]
#[schemars(example = json!({"noise": {"value": 2, "scale": 0.5}}))]
pub struct FieldFile {
    /// Values at the centres of the cells. x varies fastest, then y, then z.
    #[schemars(inner(range(min = 0)))]
    pub values: Option<Vec<f64>>,
    /// Number of cells along x, y and z.
    #[schemars(inner(range(min = 1, max = 65_536)), extend("x-unit" = "cells"))]
    pub resolution: Option<[u32; 3]>,
    /// Path of a volume file (`.npy` or `.npz`), relative to the scene's folder.
    pub path: Option<String>,
    /// A value that is the same everywhere.
    #[schemars(range(min = 0))]
    pub constant: Option<f64>,
    /// A value that decreases exponentially with height.
    pub exponential: Option<ExponentialFieldFile>,
    /// A ball whose value decreases to 0 towards its surface.
    pub sphere: Option<SphereFieldFile>,
    /// Fractal noise, for clouds and smoke.
    pub noise: Option<NoiseFieldFile>,
}

/// The field value · exp(−height/scale_height). The height is measured from the bottom of the box,
/// or from the surface of a planet.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Exponential field", example = json!({"value": 1, "scale_height": 8000,
    "planet": {"center": [0, -6_371_000, 0], "radius": 6_371_000}}))]
pub struct ExponentialFieldFile {
    /// Value at the bottom of the box, or at the surface of the planet.
    #[schemars(range(min = 0))]
    pub value: f64,
    /// Height over which the value decreases to 1/e.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
    pub scale_height: f64,
    /// The planet from whose surface the height is measured.
    #[schemars(extend("x-default" = "flat ground"))]
    pub planet: Option<PlanetFile>,
}

/// A planet. Inside the planet, the field has the value of the planet's surface.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Planet", example = json!({"center": [0, -6_371_000, 0], "radius": 6_371_000}))]
pub struct PlanetFile {
    /// Centre.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub center: [f64; 3],
    /// Radius.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
    pub radius: f64,
}

/// A ball with a constant value, which decreases smoothly to 0 near the surface.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Sphere field", example = json!({"value": 1, "center": [0, 1, 0], "radius": 0.5, "falloff": 0.2}))]
pub struct SphereFieldFile {
    /// Value inside the ball.
    #[schemars(range(min = 0))]
    pub value: f64,
    /// Centre.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub center: [f64; 3],
    /// Radius.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
    pub radius: f64,
    /// Fraction of the radius over which the value decreases to 0.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0, max = 1))]
    pub falloff: f64,
}

/// Fractal noise. It is computed once on a grid with two cells for the smallest feature, but at
/// most 128 cells along the longest side.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Noise field", example = json!({"value": 2, "scale": 0.5, "octaves": 6, "threshold": 0.4,
    "falloff": 0.2, "seed": 7}))]
pub struct NoiseFieldFile {
    /// Largest value.
    #[schemars(range(min = 0))]
    pub value: f64,
    /// Size of the largest features.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
    pub scale: f64,
    /// Number of octaves.
    #[serde(default = "default_octaves")]
    #[schemars(range(min = 1, max = 16))]
    pub octaves: u32,
    /// Noise below this fraction of `value` becomes 0. The rest is rescaled to the full range.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0, max = 1))]
    pub threshold: f64,
    /// Width of the fade to 0 near the ellipsoid that touches the faces of the box from inside. It
    /// is a fraction of the ellipsoid's half-axes. If it is 0, the noise fills the whole box.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", range(min = 0, max = 1))]
    pub falloff: f64,
    /// Seed of the noise.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub seed: u32,
}

fn default_octaves() -> u32 {
    4
}

impl FieldFile {
    /// Checks that the field has exactly one form, and checks the ranges and the number of values.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { values, resolution, path, constant, exponential, sphere, noise } = self;
        let forms = [
            ("values", values.is_some()),
            ("path", path.is_some()),
            ("constant", constant.is_some()),
            ("exponential", exponential.is_some()),
            ("sphere", sphere.is_some()),
            ("noise", noise.is_some()),
        ];
        check::exactly_one(at, &forms)?;
        match (values, resolution) {
            (Some(values), Some(resolution)) => validate_values(at, values, *resolution)?,
            (Some(_), None) => return Err(check::fault(at, "found `values` without `resolution`", "both")),
            (None, Some(_)) => return Err(check::fault(at, "found `resolution` without `values`", "both")),
            (None, None) => {}
        }
        constant.map_or(Ok(()), |value| check::not_negative(&at.key("constant"), value))?;
        if let Some(ExponentialFieldFile { value, scale_height, planet }) = exponential {
            let at = at.key("exponential");
            check::all([
                check::not_negative(&at.key("value"), *value),
                check::positive(&at.key("scale_height"), *scale_height),
                planet.map_or(Ok(()), |planet| check::positive(&at.key("planet").key("radius"), planet.radius)),
            ])?;
        }
        if let Some(SphereFieldFile { value, center: _, radius, falloff }) = sphere {
            let at = at.key("sphere");
            check::all([
                check::not_negative(&at.key("value"), *value),
                check::positive(&at.key("radius"), *radius),
                check::fraction(&at.key("falloff"), *falloff),
            ])?;
        }
        if let Some(NoiseFieldFile { value, scale, octaves, threshold, falloff, seed: _ }) = noise {
            let at = at.key("noise");
            check::all([
                check::not_negative(&at.key("value"), *value),
                check::positive(&at.key("scale"), *scale),
                check::count(&at.key("octaves"), u64::from(*octaves), 1, 16),
                check::fraction(&at.key("threshold"), *threshold),
                check::fraction(&at.key("falloff"), *falloff),
            ])?;
        }
        Ok(())
    }
}

/// Checks that a grid has one value for each cell and no negative value.
fn validate_values(at: &JsonPath, values: &[f64], resolution: [u32; 3]) -> Result<()> {
    let (values_at, resolution_at) = (at.key("values"), at.key("resolution"));
    for (axis, cells) in resolution.into_iter().enumerate() {
        check::count(&resolution_at.index(axis), u64::from(cells), 1, 65_536)?;
    }
    let cells = resolution.into_iter().map(u64::from).product::<u64>();
    if values.len() as u64 != cells {
        let [x, y, z] = resolution;
        let allowed = format!("an array of {cells}, one value for each of {x} × {y} × {z} cells");
        return Err(check::fault(&values_at, format!("found an array of {}", values.len()), allowed));
    }
    values.iter().enumerate().try_for_each(|(i, &value)| check::not_negative(&values_at.index(i), value))
}
