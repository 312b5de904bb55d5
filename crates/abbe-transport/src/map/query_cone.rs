//! The region around a camera ray in which photons contribute to it.

use abbe_scene::geometry::Ray;

/// A part of a ray, with a radius that may grow linearly along it.
#[derive(Debug, Clone, Copy)]
pub struct QueryCone {
    pub ray: Ray,
    pub length_m: f64,
    /// The radius at the ray's origin, in m.
    pub radius_m: f64,
    /// The increase of the radius per unit of distance along the ray.
    pub slope: f64,
}

/// The width of the kernels along a camera path.
#[derive(Debug, Clone, Copy)]
pub enum KernelWidth {
    /// In m along the whole path.
    Constant(f64),
    /// In proportion to the distance from the camera.
    PerDistance(f64),
}

impl QueryCone {
    /// Takes the first `length_m` metres of a ray, `behind_m` (m) from the camera along the path.
    pub fn of_camera(ray: Ray, length_m: f64, behind_m: f64, width: KernelWidth) -> Self {
        let (radius_m, slope) = match width {
            KernelWidth::Constant(radius_m) => (radius_m, 0.0),
            KernelWidth::PerDistance(slope) => (slope * behind_m, slope),
        };
        Self { ray, length_m, radius_m, slope }
    }

    /// Returns the radius in m at the distance `t` (m).
    pub fn radius_at(&self, t: f64) -> f64 {
        self.radius_m + self.slope * t
    }
}
