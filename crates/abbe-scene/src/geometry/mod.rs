//! Geometry of the scene in world coordinates: ray intersection, surface properties at a hit, and
//! sampling of points on objects.
//!
//! All positions are in double precision, relative to a centre chosen by the caller, because
//! coordinates near 0 are the most precise. No intersection test uses a fixed epsilon, so results
//! do not depend on the scale of the scene. A ray that starts on a face carries it as a
//! [`SurfaceId`], which excludes the crossing of this face at t = 0 by construction. It can cross a
//! curved start face again only at the other root of the quadratic equation. Surfaces that touch,
//! such as a prism on a floor or cemented lenses, are crossed in one fixed order; see
//! `coincidence`.

pub mod box_tree;
mod build;
mod bvh;
mod coincidence;
mod enclosure;
mod hit;
mod instance;
mod luminous;
pub mod mesh;
mod object;
mod primitive;
mod ray;
mod sample;
mod shading_frame;
pub mod shape;
mod shells;
mod spherical_rectangle;
mod trace;
mod world;

pub use enclosure::ConvexBody;
pub use hit::{Hit, SurfaceId, SurfaceSample};
pub use luminous::LuminousFace;
pub use ray::Ray;
pub use shading_frame::ShadingFrame;
pub use world::Geometry;

#[cfg(test)]
mod tests;
