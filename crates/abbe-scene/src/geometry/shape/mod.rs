//! The shapes of a scene in their local frames.
//!
//! Every analytic shape implements the same operations. They find the next crossing of a line
//! (`LocalLine`). They project a point onto a face, and compute the normal and the texture
//! coordinates there. They also compute the area of a face, and sample a face uniformly. The origin
//! and the axes of a local frame are the same as in the scene file. [`geometry`](super) places the
//! shapes in the world, traces rays and samples points on the shapes.

mod cylinder;
mod flat;
mod lens;
mod local;
mod polyhedron;
mod solid;
mod sphere;
mod triangle;
mod volume;

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::mesh::TriangleMesh;

pub(crate) use local::{Crossing, LocalLine};
pub(crate) use solid::{Solid, ValidShape, bounds_of};
pub(crate) use triangle::TriangleRay;

/// A shape in its local frame. Lengths are in m and angles are in degrees.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A sphere about the origin.
    Sphere {
        /// Radius in m.
        radius: f64,
    },
    /// A rectangle in the xz plane, centred on the origin, facing +y.
    Rectangle {
        /// Extent along x in m.
        width: f64,
        /// Extent along z in m.
        height: f64,
    },
    /// A disk in the xz plane, centred on the origin, facing +y.
    Disk {
        /// Radius in m.
        radius: f64,
    },
    /// A box centred on the origin.
    Box {
        /// Extents along x, y, z in m.
        size: DVec3,
    },
    /// A closed cylinder centred on the origin, with its axis along y.
    Cylinder {
        /// Radius in m.
        radius: f64,
        /// Extent along y in m.
        height: f64,
    },
    /// A closed triangular prism with its axis along z and its apex towards +y. The centroid of its
    /// triangle is the origin.
    Prism {
        /// Length of each of the two legs that meet at the apex, in m.
        side: f64,
        /// Extent along z in m.
        length: f64,
        /// Angle at the apex in degrees, in (0, 180).
        apex_deg: f64,
    },
    /// A lens: two spherical surfaces about the z axis and a cylindrical edge. The front vertex is
    /// the origin.
    Lens {
        /// Radius of curvature of the front surface in m. It is positive if the centre of curvature
        /// lies towards +z. A radius of 0 means a plane.
        radius1: f64,
        /// Radius of curvature of the back surface in m. The sign convention is the same as for
        /// `radius1`. For a biconvex lens, `radius1` is positive and `radius2` is negative.
        radius2: f64,
        /// Distance between the vertices in m.
        thickness: f64,
        /// Diameter of the edge in m.
        diameter: f64,
    },
    /// A triangle mesh.
    Mesh(Arc<TriangleMesh>),
}

/// A shape placed in the world.
#[derive(Debug, Clone)]
pub struct PlacedShape {
    /// The shape in its local frame.
    pub shape: Shape,
    /// Map from the local frame to the world, in m. Any invertible map is valid, including
    /// mirroring and unequal scales.
    pub to_world: DAffine3,
    /// Number of the object. Several placed shapes may belong to one object.
    pub object: u32,
}
