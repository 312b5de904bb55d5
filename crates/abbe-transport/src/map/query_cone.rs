//! The region around a camera ray. Photons in this region contribute to the ray.

use abbe_scene::geometry::Ray;

/// A part of a ray, and a radius around this part. The radius may grow linearly along the ray.
#[derive(Debug, Clone, Copy)]
pub struct QueryCone {
    pub ray: Ray,
    pub length_m: f64,
    /// The radius at the ray's origin, in m.
    pub radius_m: f64,
    /// The increase of the radius per unit of distance along the ray.
    pub slope: f64,
}

#[derive(Debug, Clone, Copy)]
pub enum KernelWidth {
    /// The radius is constant along the path. This number is the radius in m.
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

    /// Returns the radius in m at the distance `t` (m) along the ray.
    pub fn radius_at(&self, t: f64) -> f64 {
        self.radius_m + self.slope * t
    }
}
