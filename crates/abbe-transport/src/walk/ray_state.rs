//! A ray with its medium stack.

use abbe_scene::geometry::{Ray, SurfaceId};
use abbe_scene::medium_stack::MediumStack;

/// The start of a path segment: the ray, the surface it leaves, and the bodies around.
#[derive(Debug, Clone, Copy)]
pub struct RayState {
    pub ray: Ray,
    /// The surface that the ray leaves. The ray cannot hit this surface again at distance 0.
    pub from: Option<SurfaceId>,
    pub medium_stack: MediumStack,
}
