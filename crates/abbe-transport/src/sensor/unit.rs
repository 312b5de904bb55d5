//! The unit of a film's sums.

use abbe_scene::Scene;
use abbe_scene::meter::Sensor;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The unit of the sums of light: 2 to the power of an integer, in W/m²/sr.
///
/// It follows the power of the lights, so that a scene with lights of 10⁻³⁰ W gives the picture of
/// the same scene with lights of 1 W, scaled. Sums in this unit have the precision of 5·10⁻²⁰ and a
/// range of 9·10¹⁸.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FilmUnit {
    exponent: i32,
}

/// The least distance between the camera and a light, as a fraction of the radius of the scene.
const LEAST_DISTANCE: f64 = 1e-3;

/// Up to this exponent, a unit and its inverse are normal numbers of double precision.
const LARGEST_EXPONENT: i32 = 1000;

impl FilmUnit {
    /// Returns the unit for the lights of a scene: about the irradiance of a surface at the
    /// distance from which the camera sees the light.
    pub fn of(scene: &Scene) -> Self {
        let (extent, bounds) = (scene.extent(), scene.geometry.object_bounds());
        let sensors = scene.camera.sensors().iter().filter_map(Sensor::position);
        let viewpoints: Vec<DVec3> = sensors.chain([scene.camera.origin()]).collect();
        let radius2 = extent.radius_m * extent.radius_m;
        let irradiance = scene.lights.iter().map(|light| {
            let distance2 = light.bounds(&bounds).map_or(radius2, |(low, high)| {
                let middle = 0.5 * (low + high);
                let distances2 = viewpoints.iter().map(|viewpoint| viewpoint.distance_squared(middle));
                distances2.fold(radius2, f64::min).max(LEAST_DISTANCE * LEAST_DISTANCE * radius2)
            });
            light.power_w(extent) / distance2
        });
        Self::near(irradiance.sum())
    }

    /// Returns the largest unit that does not exceed `radiance`, or 1 if that is 0 or unusable.
    fn near(radiance: f64) -> Self {
        let is_usable = radiance > 0.0 && radiance.is_finite();
        let biased = (radiance.to_bits() >> (f64::MANTISSA_DIGITS - 1)) as i32;
        let exponent = biased - (f64::MAX_EXP - 1);
        Self { exponent: if is_usable { exponent.clamp(-LARGEST_EXPONENT, LARGEST_EXPONENT) } else { 0 } }
    }

    pub(super) fn value(self) -> f64 {
        2.0_f64.powi(self.exponent)
    }

    pub(super) fn inverse(self) -> f64 {
        2.0_f64.powi(-self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_is_the_power_of_two_below_the_radiance() {
        for (radiance, unit) in [(1.0, 1.0), (0.99, 0.5), (3e-15, 2.0_f64.powi(-49)), (5e20, 2.0_f64.powi(68))] {
            assert_eq!(FilmUnit::near(radiance).value(), unit, "{radiance}");
            assert_eq!(FilmUnit::near(radiance).inverse(), 1.0 / unit, "{radiance}");
        }
        for unusable in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(FilmUnit::near(unusable), FilmUnit::default(), "{unusable}");
        }
        assert!(FilmUnit::near(f64::from_bits(1)).inverse().is_finite());
    }
}
