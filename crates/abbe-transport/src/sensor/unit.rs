//! The unit of a film's sums.

use abbe_scene::Scene;
use abbe_scene::light::Emitter;
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

/// Up to this exponent, a unit and its inverse are normal numbers of double precision.
const LARGEST_EXPONENT: i32 = 1000;

impl FilmUnit {
    /// Returns the unit for the lights of a scene: about the power of its local lights per m², or
    /// per squared radius of a smaller scene, plus the irradiance by its distant lights.
    pub fn of(scene: &Scene) -> Self {
        let extent = scene.extent();
        let radius2 = extent.radius_m * extent.radius_m;
        let per_m2 = scene.lights.iter().map(|light| {
            let area_m2 = match light.emitter {
                Emitter::Directional(_) | Emitter::Environment(_) => radius2,
                _ => radius2.min(1.0),
            };
            light.power_w(extent) / area_m2
        });
        Self::near(per_m2.sum())
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
