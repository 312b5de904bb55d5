//! Photon points in media, gathered by the beam radiance estimate (Jarosz, Zwicker & Jensen 2008,
//! "The Beam Radiance Estimate for Volumetric Photon Mapping"): the kernel is a disk perpendicular
//! to the camera ray.

use super::PhotonNearRay;
use crate::map::kernel::DiskKernel;
use crate::map::octahedral::Octahedral;
use crate::map::photon::PhotonPower;
use crate::map::query_cone::QueryCone;
use glam::{DVec3, Vec3};

/// A collision of a photon with a medium.
#[derive(Debug, Clone, Copy)]
pub struct VolumePhoton {
    /// The position in m, relative to the scene's centre.
    pub position: [f32; 3],
    incoming: Octahedral<16>,
    medium: u16,
    /// The power scattered by the medium, summed over all directions.
    power: PhotonPower,
}

impl VolumePhoton {
    /// Creates a photon at a collision. The photon arrives at `position` in the unit direction
    /// `incoming`. The medium number `medium` scatters the power `power` there.
    pub fn new(position: DVec3, incoming: DVec3, medium: usize, power: PhotonPower) -> Self {
        Self {
            position: position.as_vec3().to_array(),
            incoming: Octahedral::encode(incoming),
            medium: medium as u16,
            power,
        }
    }

    /// Returns the photon if the cone contains it.
    pub(super) fn near_ray(&self, cone: &QueryCone) -> Option<PhotonNearRay<'_>> {
        let offset = Vec3::from(self.position).as_dvec3() - cone.ray.origin;
        let t = offset.dot(cone.ray.direction);
        if !(t > 0.0 && t < cone.length_m) {
            return None;
        }
        let offset = offset - t * cone.ray.direction;
        let (d2, r) = (offset.length_squared(), cone.radius_at(t));
        (d2 < r * r).then(|| PhotonNearRay {
            power: &self.power,
            incoming: self.incoming.decode(),
            medium: usize::from(self.medium),
            t,
            offset,
            radius_m: r,
            kernels: DiskKernel::new(r * r).at(d2),
            beam: None,
        })
    }
}
