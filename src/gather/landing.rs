//! Where a camera path comes to rest: what the pilot learns from.

use crate::plan::partition::View;
use glam::DVec3;

/// Where a camera path came to rest, for the pilot.
#[derive(Debug, Clone, Copy)]
pub struct Landing {
    /// The place.
    pub position: DVec3,
    /// The surface's unit normal.
    pub normal: DVec3,
    /// The side of the pixel's footprint there, in m, as if the way had been straight.
    pub footprint_m: f64,
    /// What stood between it and the camera.
    pub view: View,
    /// Whether the path had refracted dispersively.
    pub shared: bool,
}

impl Landing {
    /// Whether the surface here goes on smoothly to the other place.
    pub fn continues_to(&self, other: &Self) -> bool {
        /// Cosine of the largest turn, and largest height over the tangent plane as a share of the distance.
        const COSINE: f64 = 0.9;
        const SLOPE: f64 = 0.25;
        let offset = other.position - self.position;
        self.normal.dot(other.normal) > COSINE && offset.dot(self.normal).abs() <= SLOPE * offset.length()
    }
}
