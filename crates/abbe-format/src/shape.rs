//! Shapes in the scene file.

use crate::prelude::*;
use crate::{JsonPath, check, forms};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::Result;
use glam::DVec3;

/// A shape in its local coordinates. The object's `transform` places it in the scene.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Shape")]
pub enum ShapeFile {
    /// A sphere.
    #[schemars(example = json!({"sphere": {"center": [0, 0.5, 0], "radius": 0.5}}))]
    Sphere {
        /// Centre of the sphere.
        #[serde(default, skip_serializing_if = "forms::is_default")]
        #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "scene unit"))]
        center: [f64; 3],
        /// Radius of the sphere.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        radius: f64,
    },
    /// A rectangle in the plane y = 0, centred at the origin. Its front faces +y.
    #[schemars(example = json!({"rectangle": {"width": 2, "height": 1}}))]
    Rectangle {
        /// Size along x.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        width: f64,
        /// Size along z.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        height: f64,
    },
    /// A disk in the plane y = 0, centred at the origin. Its front faces +y.
    #[schemars(example = json!({"disk": {"radius": 0.5}}))]
    Disk {
        /// Radius of the disk.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        radius: f64,
    },
    /// A box with edges along the axes, centred at the origin.
    #[schemars(example = json!({"box": {"size": [1, 2, 0.5]}}))]
    Box {
        /// Size along x, y and z.
        #[schemars(transform = crate::schema::positive_items, extend("x-unit" = "scene unit"))]
        size: [f64; 3],
    },
    /// A closed cylinder around the y axis, centred at the origin.
    #[schemars(example = json!({"cylinder": {"radius": 0.2, "height": 1}}))]
    Cylinder {
        /// Radius of the cylinder.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        radius: f64,
        /// Length along y.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        height: f64,
    },
    /// A triangular prism along z with the apex up. The centroid of the triangle is at the origin.
    #[schemars(example = json!({"prism": {"side": 0.5, "length": 0.6, "apex": 60}}))]
    Prism {
        /// Length of the two sides that meet at the apex.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        side: f64,
        /// Length along z.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        length: f64,
        /// Angle at the apex.
        #[serde(default = "default_apex")]
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180, "x-unit" = "°"))]
        apex: f64,
    },
    /// A lens with spherical surfaces around the z axis. The vertex of the front surface is at the
    /// origin, and the lens extends towards +z.
    #[schemars(example = json!({"lens": {"radius1": 100, "radius2": -100, "thickness": 8, "diameter": 50}}))]
    Lens {
        /// Radius of curvature of the front surface, positive if its centre of curvature lies
        /// towards +z. 0 or null is a plane. The magnitude must be at least half the diameter.
        #[serde(deserialize_with = "forms::deserialize_radius")]
        #[schemars(schema_with = "crate::schema::radius_or_plane", extend("x-unit" = "scene unit"))]
        radius1: f64,
        /// Radius of curvature of the back surface, with the same sign convention.
        #[serde(deserialize_with = "forms::deserialize_radius")]
        #[schemars(schema_with = "crate::schema::radius_or_plane", extend("x-unit" = "scene unit"))]
        radius2: f64,
        /// Distance between the two vertices.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        thickness: f64,
        /// Diameter of the cylindrical edge.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        diameter: f64,
    },
    /// A triangle mesh from an OBJ, PLY, STL, glTF or GLB file, or a gem design of GemCad (`.asc`,
    /// `.gem`) or of Gem Cut Studio (`.gcs`).
    #[schemars(example = json!({"mesh": {"path": "bunny.ply"}}))]
    #[schemars(example = json!({"mesh": {"path": "lamp.obj", "part": 0, "reverse": true, "flat": true, "smooth": false,
        "flip_v": true}}))]
    Mesh(MeshShapeFile),
    /// A triangle mesh whose vertices are in the scene file.
    #[schemars(example = json!({"triangles": {"positions": [[0, 0, 0], [1, 0, 0], [0, 0, -1]], "indices": [[0, 1, 2]],
        "normals": [[0, 1, 0], [0, 1, 0], [0, 1, 0]], "uv": [[0, 1], [1, 1], [0, 0]]}}))]
    Triangles(TrianglesFile),
    /// Name of a shape of the scene's `shapes`. Objects with the same large mesh need little more
    /// memory than one of them.
    #[schemars(example = json!({"shared": "tree"}))]
    Shared(String),
}

/// A triangle mesh from a file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "the keys of the scene file are independent switches")]
pub struct MeshShapeFile {
    /// Path of the file, relative to the scene's folder. A gem has the width 1, the table at +y and
    /// y = 0 at half its height.
    pub path: String,
    /// Number of one part of the file, from 0. In a glTF file, the parts are the primitives of all
    /// meshes, in the order of the file and without the transforms of the nodes. In a serialized
    /// file of Mitsuba, the parts are the meshes.
    #[schemars(extend("x-default" = "all parts, at their places"))]
    pub part: Option<u32>,
    /// True to exchange the front and the back of the surface.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub reverse: bool,
    /// True to ignore the vertex normals of the file, so that each triangle looks flat.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub flat: bool,
    /// True to compute smooth vertex normals if the file has none.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub smooth: bool,
    /// True to replace the texture coordinate v by 1 − v.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub flip_v: bool,
}

/// A triangle mesh whose vertices are in the scene file. The corners of a triangle are
/// counter-clockwise seen from the front.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrianglesFile {
    /// Positions of the vertices.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub positions: Vec<[f64; 3]>,
    /// Three vertex numbers for each triangle. The first vertex has the number 0.
    #[schemars(length(min = 1))]
    pub indices: Vec<[u32; 3]>,
    /// One normal for each vertex, of any length.
    #[schemars(extend("x-default" = "flat triangles"))]
    pub normals: Option<Vec<[f64; 3]>>,
    /// One pair of texture coordinates for each vertex. (0, 0) is the upper left corner of a
    /// picture.
    pub uv: Option<Vec<[f64; 2]>>,
}

impl TrianglesFile {
    /// Returns the mesh in the scene's unit, with the errors of [`TriangleMesh::new`].
    pub fn mesh(&self) -> Result<TriangleMesh> {
        let vectors = |list: &[[f64; 3]]| list.iter().copied().map(DVec3::from_array).collect();
        let normals = self.normals.as_deref().map(vectors);
        TriangleMesh::new(vectors(&self.positions), normals, self.uv.clone(), self.indices.clone())
    }
}

/// Returns the default apex angle in degrees. With this angle, the prism is equilateral.
fn default_apex() -> f64 {
    60.0
}

impl ShapeFile {
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
                check::all(size.iter().enumerate().map(|(i, &size)| check::positive(&at.index(i), size)))
            }
            Self::Cylinder { radius, height } => {
                positive(&at.key("cylinder"), &[("radius", *radius), ("height", *height)])
            }
            Self::Prism { side, length, apex } => {
                let at = at.key("prism");
                let sizes = positive(&at, &[("side", *side), ("length", *length)]);
                check::all([sizes, check::between(&at.key("apex"), *apex, 0.0, 180.0)])
            }
            Self::Lens { radius1, radius2, thickness, diameter } => {
                let at = at.key("lens");
                positive(&at, &[("thickness", *thickness), ("diameter", *diameter)])?;
                validate_lens(&at, [*radius1, *radius2], *thickness, *diameter)
            }
            Self::Mesh(_) | Self::Shared(_) => Ok(()),
            Self::Triangles(triangles) => {
                triangles.mesh().map(|_| ()).map_err(|error| error.on_path(at.key("triangles").to_string()))
            }
        }
    }
}

fn positive(at: &JsonPath, sizes: &[(&str, f64)]) -> Result<()> {
    check::all(sizes.iter().map(|(key, size)| check::positive(&at.key(key), *size)))
}

/// Checks that both surfaces of a lens reach the edge and that the edge thickness is not negative.
///
/// An edge with a thickness of 0 is sharp, as in a ball lens. The tolerance of 1e-12 allows for
/// rounding.
fn validate_lens(at: &JsonPath, radii: [f64; 2], thickness: f64, diameter: f64) -> Result<()> {
    let half = diameter / 2.0;
    for (key, radius) in ["radius1", "radius2"].into_iter().zip(radii) {
        let allowed = format!("0 (a plane) or a magnitude of at least half the diameter, {}", check::number(half));
        check::rule(&at.key(key), radius, radius == 0.0 || radius.abs() >= half, &allowed)?;
    }
    let edge = thickness + sagitta(radii[1], half) - sagitta(radii[0], half);
    if edge >= -1e-12 * diameter {
        return Ok(());
    }
    let (edge, least) = (check::number(edge), check::number(thickness - edge));
    let found = format!("found {}, which gives an edge thickness of {edge}", check::number(thickness));
    Err(check::fault(&at.key("thickness"), found, format!("at least {least}, or a smaller diameter")))
}

/// Returns the sagitta of a spherical surface at the distance `from_axis` from the axis. The
/// sagitta is the distance of the surface from the plane through its vertex, positive towards +z.
fn sagitta(radius: f64, from_axis: f64) -> f64 {
    if radius == 0.0 {
        return 0.0;
    }
    // This form of r − √(r² − h²) has no cancellation for a large radius.
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
    fn a_ball_lens_is_accepted_and_a_thinner_one_is_not() {
        assert_eq!(validate_lens(&JsonPath::Root, [1.0, -1.0], 2.0, 2.0), Ok(()));
        assert_eq!(validate_lens(&JsonPath::Root, [0.1, -0.1], 0.2, 0.2), Ok(()));
        assert!(validate_lens(&JsonPath::Root, [1.0, -1.0], 1.99, 2.0).is_err());
        assert_eq!(validate_lens(&JsonPath::Root, [-1.0, 1.0], 0.01, 2.0), Ok(()), "biconcave: the edge is thick");
    }
}
