//! The shapes of a scene in their local frames.
//!
//! Every analytic shape finds the next crossing of a line (`LocalLine`), projects a point onto a
//! face, computes the normal and the texture coordinates there, and computes the area of a face and
//! samples it uniformly. Local frames have the origin and the axes of the scene file.
//! [`geometry`](super) places the shapes in the world, traces rays and samples points.

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
        radius: f64,
    },
    /// A rectangle in the xz plane (`width` along x), centred on the origin, facing +y.
    Rectangle {
        width: f64,
        height: f64,
    },
    /// A disk in the xz plane, centred on the origin, facing +y.
    Disk {
        radius: f64,
    },
    /// A box centred on the origin.
    Box {
        size: DVec3,
    },
    /// A closed cylinder centred on the origin, with its axis along y.
    Cylinder {
        radius: f64,
        height: f64,
    },
    /// A closed triangular prism along z, apex towards +y, triangle's centroid at the origin.
    Prism {
        /// Length of each of the two legs that meet at the apex.
        side: f64,
        /// Extent along z.
        length: f64,
        /// In (0, 180).
        apex_deg: f64,
    },
    /// A lens: spherical surfaces about z and a cylindrical edge, front vertex at the origin.
    Lens {
        /// Radius of curvature in front: positive if its centre lies towards +z, 0 for a plane.
        radius1: f64,
        /// That of the back surface, with the same sign: negative for a biconvex lens.
        radius2: f64,
        /// Distance between the vertices.
        thickness: f64,
        diameter: f64,
    },
    Mesh(Arc<TriangleMesh>),
}

#[derive(Debug, Clone)]
pub struct PlacedShape {
    pub shape: Shape,
    /// From the local frame to the world, in m: any invertible map, also a mirroring one.
    pub to_world: DAffine3,
    /// Several placed shapes may belong to one object.
    pub object: u32,
}
