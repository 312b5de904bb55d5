//! A photon in a medium near a camera ray.

use crate::map::kernel::KernelValues;
use crate::map::photon::PhotonPower;
use crate::map::polarisation::StoredPolarisation;
use glam::DVec3;

#[derive(Debug)]
pub struct PhotonNearRay<'m> {
    pub power: &'m PhotonPower,
    /// `None` if the plan does not contain polarisation.
    pub polarisation: Option<&'m StoredPolarisation>,
    pub incoming: DVec3,
    pub medium: usize,
    /// The number of surface events before, or 0 if the scene does not limit it.
    pub events: u32,
    /// The distance (m) along the ray to the point of closest approach.
    pub t: f64,
    /// The vector from the point of closest approach on the ray to the photon, in m.
    pub offset: DVec3,
    /// The kernel radius at the point of closest approach, in m.
    pub radius_m: f64,
    /// In 1/m². Those of a beam are divided by the sine of its angle to the ray.
    pub kernels: KernelValues,
    /// The beam from its start to the ray. `None` for a point, whose power needs no correction.
    pub beam: Option<BeamPath>,
}

#[derive(Debug, Clone, Copy)]
pub struct BeamPath {
    pub start: DVec3,
    /// The distance from the start to the closest approach, in m.
    pub distance_m: f64,
}
