//! A photon in a medium near a camera ray.

use crate::map::kernel::KernelValues;
use crate::map::photon::PhotonPower;
use glam::DVec3;

#[derive(Debug)]
pub struct PhotonNearRay<'m> {
    pub power: &'m PhotonPower,
    pub incoming: DVec3,
    pub medium: usize,
    /// The distance (m) along the ray to the closest approach.
    pub t: f64,
    /// From the ray's closest approach to the photon, in m.
    pub offset: DVec3,
    /// In m at the closest approach.
    pub radius_m: f64,
    /// In 1/m². Those of a beam are divided by the sine of its angle to the ray.
    pub kernels: KernelValues,
    /// The beam from its start to the ray. `None` for a point, whose power needs no correction.
    pub beam: Option<BeamPath>,
}

#[derive(Debug, Clone, Copy)]
pub struct BeamPath {
    pub start: DVec3,
    /// In m to the closest approach.
    pub distance_m: f64,
}
