use glam::DVec3;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Origin relative to the scene's centre, in m.
    pub origin: DVec3,
    pub direction: DVec3,
}

impl Ray {
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction }
    }

    /// Returns the point at distance `t` in m.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}
