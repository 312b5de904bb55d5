use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Bounds of the light of a local light: its normals are within `normals_rad` of the axis, and the
/// light leaves within `emission_rad` of a normal. Between these angles, the intensity falls with
/// the cosine of the angle to the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntensityBounds {
    /// The lowest corner of a box around the light in m, relative to the scene's centre.
    pub low: DVec3,
    pub high: DVec3,
    /// The largest radiant intensity in W/sr over the band. For curved area lights, it is that of a
    /// convex surface in the mean of all directions.
    pub intensity: f64,
    /// A unit vector.
    pub axis: DVec3,
    /// The largest angle between the axis and a normal.
    pub normals_rad: f64,
    /// The largest angle between a normal and the light.
    pub emission_rad: f64,
}

impl IntensityBounds {
    /// A light in a box that emits into all directions.
    pub(super) fn into_all_directions((low, high): (DVec3, DVec3), intensity: f64) -> Self {
        Self { low, high, intensity, axis: DVec3::Z, normals_rad: PI, emission_rad: FRAC_PI_2 }
    }

    /// A point that shines into a cone. The intensity need not fall towards its edge, so each
    /// direction of the cone counts as a normal that emits only along itself.
    pub(super) fn into_cone(at: DVec3, intensity: f64, axis: DVec3, half_angle: f64) -> Self {
        Self { low: at, high: at, intensity, axis, normals_rad: half_angle, emission_rad: 0.0 }
    }

    /// A flat surface that emits on the side of its normal.
    pub fn of_flat_surface((low, high): (DVec3, DVec3), intensity: f64, normal: DVec3) -> Self {
        Self { low, high, intensity, axis: normal, normals_rad: 0.0, emission_rad: FRAC_PI_2 }
    }
}
