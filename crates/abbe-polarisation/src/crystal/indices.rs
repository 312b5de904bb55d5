//! The two principal indices of a uniaxial crystal.

use abbe_spectra::math::elementary::{atan2, sin_cos};
use std::f64::consts::TAU;

/// The principal indices at one wavelength, relative to air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniaxialIndices {
    /// The index n_o of fields perpendicular to the optic axis.
    pub ordinary: f64,
    /// The index n_e of fields along the optic axis.
    pub extraordinary: f64,
}

impl UniaxialIndices {
    /// Returns the birefringence n_e − n_o.
    pub fn birefringence(&self) -> f64 {
        self.extraordinary - self.ordinary
    }

    /// Returns the index of the extraordinary wave whose wave vector encloses an angle in radians
    /// with the optic axis.
    pub fn extraordinary_at(&self, angle: f64) -> f64 {
        let (sin, cos) = sin_cos(angle);
        let (o, e) = (self.ordinary, self.extraordinary);
        o * e / ((e * cos) * (e * cos) + (o * sin) * (o * sin)).sqrt()
    }

    /// Returns the walk-off in radians: the angle from the wave vector to the ray of the
    /// extraordinary wave, for an angle in radians between the optic axis and the wave vector. It
    /// is positive if the ray is farther from the axis, as in negative crystals.
    pub fn walk_off(&self, angle: f64) -> f64 {
        let (sin, cos) = sin_cos(angle);
        let (o, e) = (self.ordinary, self.extraordinary);
        // The ray encloses with the axis the angle whose tangent is (n_o/n_e)² tan θ.
        atan2((o * o - e * e) * sin * cos, (e * cos) * (e * cos) + (o * sin) * (o * sin))
    }

    /// Returns the phase in radians by which the extraordinary wave lags behind the ordinary one
    /// after a plate with the axis in its surface, at normal incidence. The thickness and the
    /// wavelength have the same unit. A negative crystal has a negative phase. With x along the
    /// axis, the plate is the [`retarder`](crate::filter::retarder) of minus this phase.
    pub fn retardance(&self, thickness: f64, wavelength: f64) -> f64 {
        TAU * thickness * self.birefringence() / wavelength
    }
}
