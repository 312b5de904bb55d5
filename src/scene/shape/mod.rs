//! The shapes a scene is made of, in their own frames.
//!
//! Every shape answers the same four questions: where does a line cross it next (`line`), which
//! surface is at a point of it (position snapped to the surface, normal, uv), how large are its faces, and what
//! is a uniform point on a face. The frame's origin and axes are those of the scene file; placing, tracing and
//! sampling in the world are the business of [`geometry`](super::geometry).

mod cylinder;
mod flat;
mod lens;
mod line;
mod polyhedron;
mod solid;
mod sphere;
mod triangle;
mod volume;

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::mesh::TriangleMesh;
use crate::error::Result;

pub(crate) use line::{Crossing, Line};
pub(crate) use solid::{Solid, around};
pub(crate) use triangle::TriangleRay;

/// A shape in its own frame; every number is resolved (lengths in m, angles in degrees).
#[derive(Debug, Clone)]
pub enum Shape {
    /// A sphere about the origin.
    Sphere {
        /// Radius in m.
        radius: f64,
    },
    /// A flat rectangle in the xz plane about the origin, facing +y.
    Rectangle {
        /// Extent along x in m.
        width: f64,
        /// Extent along z in m.
        height: f64,
    },
    /// A flat disk in the xz plane about the origin, facing +y.
    Disk {
        /// Radius in m.
        radius: f64,
    },
    /// A box about the origin.
    Box {
        /// Extents along x, y, z in m.
        size: DVec3,
    },
    /// A closed cylinder about the origin, its axis along y.
    Cylinder {
        /// Radius in m.
        radius: f64,
        /// Extent along y in m.
        height: f64,
    },
    /// A closed triangular prism, its axis along z, the apex up, about the triangle's centroid.
    Prism {
        /// Length of the two legs that meet at the apex, in m.
        side: f64,
        /// Extent along z in m.
        length: f64,
        /// Angle at the apex in degrees, in (0, 180).
        apex_deg: f64,
    },
    /// A lens: two spherical surfaces about the z axis, the front vertex at the origin, and a cylindrical edge.
    Lens {
        /// Radius of curvature of the front surface in m; positive where its centre lies towards +z, 0 for a plane.
        radius1: f64,
        /// Radius of curvature of the back surface in m; the same convention, so that biconvex is (+, −).
        radius2: f64,
        /// Distance between the vertices in m.
        thickness: f64,
        /// Diameter of the edge in m.
        diameter: f64,
    },
    /// Triangles.
    Mesh(Arc<TriangleMesh>),
}

impl Shape {
    /// Checks that the numbers make a body.
    ///
    /// # Errors
    /// What `Geometry::build` would say of the shape: numbers that are not finite or not positive, a lens whose
    /// surfaces cannot span its diameter or whose edge has negative thickness. The path names the number.
    pub fn validate(&self) -> Result<()> {
        Solid::new(self).map(|_| ())
    }
}

/// A shape where it stands in the world.
#[derive(Debug, Clone)]
pub struct Placed {
    /// The shape in its own frame.
    pub shape: Shape,
    /// Shape frame → world, in m. Any invertible map: mirroring and unequal scales are allowed.
    pub to_world: DAffine3,
    /// The object it belongs to; several placed shapes may share one.
    pub object: u32,
}
