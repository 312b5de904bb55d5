//! The bounds of each kind of light.

use super::intensity_bounds::IntensityBounds;
use super::{Emitter, Light, SceneExtent};
use glam::DVec3;
use std::f64::consts::PI;

impl Light {
    /// Returns bounds of the light, or `None` for distant lights, sets of rays and beams of
    /// parallel rays, whose irradiance does not fall with the distance.
    pub fn intensity_bounds(&self, extent: SceneExtent<'_>) -> Option<IntensityBounds> {
        let over_sphere = self.power_w(extent) / (4.0 * PI);
        match &self.emitter {
            Emitter::Point(light) => {
                Some(IntensityBounds::into_all_directions((light.position, light.position), light.intensity))
            }
            Emitter::Spot(light) => Some(light.intensity_bounds()),
            Emitter::Goniometric(light) => Some(light.intensity_bounds()),
            Emitter::Beam(light) => light.intensity_bounds(),
            Emitter::Rays(_) | Emitter::Directional(_) | Emitter::Environment(_) => None,
            Emitter::Area(light) => {
                let corners = extent.geometry.bounds_of(light.object)?;
                Some(match extent.geometry.normal_of_flat(light.object) {
                    Some(normal) => IntensityBounds::of_flat_surface(corners, light.radiance * light.area_m2, normal),
                    None => IntensityBounds::into_all_directions(corners, over_sphere),
                })
            }
            Emitter::Volume(light) => {
                let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(f64::from).into();
                let corners = (0..8).map(|i| light.box_map().transform_point3(corner(i)));
                let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
                let around = corners.fold(start, |(low, high), corner| (low.min(corner), high.max(corner)));
                Some(IntensityBounds::into_all_directions(around, over_sphere))
            }
        }
    }
}
