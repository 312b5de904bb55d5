//! Shapes as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::check;
use super::forms;
use super::path::JsonPath;
use crate::error::Result;

/// A shape in its own frame, in the scene's unit.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeFile {
    /// A sphere.
    Sphere {
        /// Its centre (default: the origin).
        #[serde(default, skip_serializing_if = "forms::is_default")]
        center: [f64; 3],
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
    },
    /// A rectangle in the plane y = 0, centred, facing +y.
    Rectangle {
        /// Size along x.
        #[schemars(extend("exclusiveMinimum" = 0))]
        width: f64,
        /// Size along z.
        #[schemars(extend("exclusiveMinimum" = 0))]
        height: f64,
    },
    /// A disk in the plane y = 0, centred, facing +y.
    Disk {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
    },
    /// A box, centred.
    Box {
        /// Sizes along x, y and z.
        size: [f64; 3],
    },
    /// A closed cylinder about the y axis, centred.
    Cylinder {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
        /// Its length along y.
        #[schemars(extend("exclusiveMinimum" = 0))]
        height: f64,
    },
    /// A triangular prism along z, apex up, centred at the triangle's centroid.
    Prism {
        /// Length of the two legs that meet in the apex.
        #[schemars(extend("exclusiveMinimum" = 0))]
        side: f64,
        /// Length along z.
        #[schemars(extend("exclusiveMinimum" = 0))]
        length: f64,
        /// Angle at the apex in degrees (default 60).
        #[serde(default = "default_apex")]
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
        apex: f64,
    },
    /// A lens with spherical surfaces along +z, its front vertex at the origin.
    Lens {
        /// Radius of the front surface: above 0 where its centre lies towards +z; 0 or null is a plane.
        #[serde(deserialize_with = "forms::deserialize_radius")]
        #[schemars(schema_with = "forms::radius_or_plane")]
        radius1: f64,
        /// Radius of the back surface, likewise.
        #[serde(deserialize_with = "forms::deserialize_radius")]
        #[schemars(schema_with = "forms::radius_or_plane")]
        radius2: f64,
        /// Distance of the two vertices.
        #[schemars(extend("exclusiveMinimum" = 0))]
        thickness: f64,
        /// Diameter of the cylindrical edge.
        #[schemars(extend("exclusiveMinimum" = 0))]
        diameter: f64,
    },
    /// A mesh from an OBJ, PLY, STL, glTF or GLB file.
    Mesh {
        /// Path of the file, relative to the scene's folder.
        path: String,
    },
}

/// The apex angle of an equilateral prism.
fn default_apex() -> f64 {
    60.0
}

impl ShapeFile {
    /// Checks ranges, and that a lens has an edge.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Sphere { center: _, radius } => positive(&at.key("sphere"), &[("radius", *radius)]),
            Self::Rectangle { width, height } => {
                positive(&at.key("rectangle"), &[("width", *width), ("height", *height)])
            }
            Self::Disk { radius } => positive(&at.key("disk"), &[("radius", *radius)]),
            Self::Box { size } => {
                let at = at.key("box");
                let at = at.key("size");
                size.iter().enumerate().try_for_each(|(i, &size)| check::positive(&at.index(i), size))
            }
            Self::Cylinder { radius, height } => {
                positive(&at.key("cylinder"), &[("radius", *radius), ("height", *height)])
            }
            Self::Prism { side, length, apex } => {
                let at = at.key("prism");
                positive(&at, &[("side", *side), ("length", *length)])?;
                check::between(&at.key("apex"), *apex, 0.0, 180.0)
            }
            Self::Lens { radius1, radius2, thickness, diameter } => {
                let at = at.key("lens");
                positive(&at, &[("thickness", *thickness), ("diameter", *diameter)])?;
                validate_lens(&at, [*radius1, *radius2], *thickness, *diameter)
            }
            Self::Mesh { path: _ } => Ok(()),
        }
    }
}

/// Checks that sizes are above 0.
fn positive(at: &JsonPath, sizes: &[(&str, f64)]) -> Result<()> {
    sizes.iter().try_for_each(|(key, size)| check::positive(&at.key(key), *size))
}

/// Checks that both surfaces reach the edge and that the edge's thickness is not negative (0 is a sharp edge, as a
/// ball lens has; the allowance of 1e-12 is for its rounding).
fn validate_lens(at: &JsonPath, radii: [f64; 2], thickness: f64, diameter: f64) -> Result<()> {
    let half = diameter / 2.0;
    for (key, radius) in ["radius1", "radius2"].into_iter().zip(radii) {
        let allowed = format!("0 (a plane) or a size of at least half the diameter, {}", check::number(half));
        check::rule(&at.key(key), radius, radius == 0.0 || radius.abs() >= half, &allowed)?;
    }
    let edge = thickness + sagitta(radii[1], half) - sagitta(radii[0], half);
    if edge >= -1e-12 * diameter {
        return Ok(());
    }
    let (edge, least) = (check::number(edge), check::number(thickness - edge));
    let found = format!("found {}, which leaves an edge {edge} thick", check::number(thickness));
    Err(check::fault(&at.key("thickness"), found, format!("at least {least}, or a smaller diameter")))
}

/// How far a spherical surface of this radius lies from its vertex plane, towards +z, at a distance from the axis.
fn sagitta(radius: f64, from_axis: f64) -> f64 {
    if radius == 0.0 {
        return 0.0;
    }
    // r − √(r² − h²), written so that it does not cancel for flat surfaces.
    let root = (1.0 - (from_axis / radius).powi(2)).max(0.0).sqrt();
    from_axis * from_axis / (radius * (1.0 + root))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sagitta_of_a_sphere() {
        assert_eq!(sagitta(0.0, 1.0), 0.0);
        assert_eq!(sagitta(5.0, 3.0), 1.0);
        assert_eq!(sagitta(-5.0, 3.0), -1.0);
        assert_eq!(sagitta(1.0, 1.0), 1.0);
    }

    #[test]
    fn a_ball_lens_has_a_sharp_edge_and_a_thinner_one_has_none() {
        assert_eq!(validate_lens(&JsonPath::Root, [1.0, -1.0], 2.0, 2.0), Ok(()));
        assert_eq!(validate_lens(&JsonPath::Root, [0.1, -0.1], 0.2, 0.2), Ok(()));
        assert!(validate_lens(&JsonPath::Root, [1.0, -1.0], 1.99, 2.0).is_err());
        assert_eq!(validate_lens(&JsonPath::Root, [-1.0, 1.0], 0.01, 2.0), Ok(()), "biconcave: the edge is thick");
    }
}
