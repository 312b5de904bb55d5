//! Where a camera path comes to rest, and which ways through media it took.

use crate::plan::partition::View;
use crate::scene::geometry::Ray;
use glam::DVec3;

/// Where a camera path came to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landing {
    /// The place.
    pub position: DVec3,
    /// The surface's unit normal on the side that was seen.
    pub facing: DVec3,
    /// The side of the pixel's footprint there, in m, as if the way had been straight.
    pub footprint_m: f64,
    /// What stood between it and the camera.
    pub view: View,
    /// Whether the path had refracted dispersively.
    pub shared: bool,
}

/// A way through a medium that scatters, along which a camera path looked for photons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sightline {
    /// The way.
    pub ray: Ray,
    /// Its length in m.
    pub length_m: f64,
    /// How far the camera is from its start, along the path, in m.
    pub behind_m: f64,
    /// The number of the medium that it goes through.
    pub medium: usize,
    /// Whether the path had refracted dispersively.
    pub shared: bool,
}

impl Landing {
    /// Whether the surface here goes on smoothly to another place, where it faces another way.
    pub fn goes_on_to(&self, position: DVec3, facing: DVec3) -> bool {
        /// Cosine of the largest turn, and largest height over the tangent plane as a share of the distance.
        const COSINE: f64 = 0.9;
        const SLOPE: f64 = 0.25;
        let offset = position - self.position;
        self.facing.dot(facing) > COSINE && offset.dot(self.facing).abs() <= SLOPE * offset.length()
    }
}
