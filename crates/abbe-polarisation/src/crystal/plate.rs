//! Plates of crystals.

use super::indices::UniaxialIndices;
use super::surface::CrystalSurface;
use super::wave::CrystalMode;
use abbe_spectra::math::elementary::sin;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A plate with parallel faces, below the surface z = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrystalPlate {
    /// The front face.
    pub front: CrystalSurface,
    /// The thickness, in the unit of the results.
    pub thickness: f64,
}

impl CrystalPlate {
    /// Returns the points at which the ordinary and the extraordinary ray leave the plate, relative
    /// to the point of entry, for light from outside with the direction of travel `travel` (z < 0).
    /// Both beams then continue along `travel`. A ray that does not exist has no point.
    pub fn exits(&self, travel: DVec3) -> [Option<DVec2>; 2] {
        let exit = |ray: DVec3| ray.truncate() * (self.thickness / -ray.z);
        self.front.refracted(travel).map(|wave| wave.map(|wave| exit(wave.ray)))
    }

    /// Returns the phase in radians by which the ordinary wave is ahead of the extraordinary one
    /// behind the plate, 2πd(k_z,o − k_z,e)/λ with k_z downwards, for a wavelength in the unit of
    /// the thickness. Returns `None` if one of the waves does not exist.
    pub fn phase_difference(&self, travel: DVec3, wavelength: f64) -> Option<f64> {
        let [o, e] = self.front.refracted(travel);
        Some(TAU * self.thickness * (e?.k.z - o?.k.z) / wavelength)
    }
}

/// Returns the phase difference of [`CrystalPlate::phase_difference`] for a plate in air that is
/// cut perpendicular to its axis, at an angle of incidence in radians. It determines the rings of
/// conoscopic pictures.
pub fn conoscopic_phase(indices: UniaxialIndices, thickness: f64, wavelength: f64, incidence: f64) -> f64 {
    let tangential = DVec3::X * sin(incidence);
    let normal = |mode| indices.normal_component(mode, DVec3::Z, tangential, true).re;
    TAU * thickness * (normal(CrystalMode::Ordinary) - normal(CrystalMode::Extraordinary)) / wavelength
}
