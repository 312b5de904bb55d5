//! Geometry of the scene in world coordinates: ray intersection, surface properties at a hit, and
//! sampling of points on objects.
//!
//! All positions are in double precision. They are relative to a centre chosen by the caller,
//! because coordinates near 0 are the most precise. No intersection test uses a fixed epsilon. If a
//! ray starts on a face, this face is passed with the ray as a [`SurfaceId`]. The crossing of this
//! face at t = 0 is excluded by construction. If a ray starts on a curved face, it can cross this
//! face again only at the other root of the quadratic equation. Surfaces that touch, such as a
//! prism on a floor or cemented lenses, are crossed in one fixed order; see `coincidence`. Results
//! therefore do not depend on the scale of the scene.

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
pub mod shape;
mod spherical_rectangle;
mod trace;
mod world;

pub use hit::{Hit, SurfaceId, SurfaceSample};
pub use luminous::LuminousFace;
pub use ray::Ray;
pub use world::Geometry;

#[cfg(test)]
mod tests;
