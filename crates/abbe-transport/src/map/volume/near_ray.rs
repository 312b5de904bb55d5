//! A photon in a medium near a camera ray.

use crate::map::kernel::KernelValues;
use crate::map::photon::PhotonPower;
use glam::DVec3;

/// A photon whose kernel intersects a camera ray.
#[derive(Debug)]
pub struct PhotonNearRay<'m> {
    /// The wavelengths and powers.
    pub power: &'m PhotonPower,
    /// The unit direction in which the photon travels.
    pub incoming: DVec3,
    /// The medium's number.
    pub medium: usize,
    /// The distance (m) along the ray to the point of closest approach.
    pub t: f64,
    /// The vector from the point of closest approach on the ray to the photon, in m.
    pub offset: DVec3,
    /// The kernel radius at the point of closest approach, in m.
    pub radius_m: f64,
    /// The kernel values, in 1/m². The values of a beam are divided by the sine of the angle
    /// between the beam and the ray.
    pub kernels: KernelValues,
    /// The part of the beam between the start of the beam and the camera ray. `None` for a point,
    /// because the stored power of a point needs no correction.
    pub beam: Option<BeamPath>,
}

/// The part of a beam between its start and a camera ray.
#[derive(Debug, Clone, Copy)]
pub struct BeamPath {
    pub start: DVec3,
    /// The distance from the start to the closest approach, in m.
    pub distance_m: f64,
}
