//! Photons where they met particles of a medium, seen by the beam radiance estimate (Jarosz, Zwicker & Jensen 2008): the kernel is a disk across the ray.

use super::Neighbour;
use crate::map::kernel::Disk;
use crate::map::near_ray::Cone;
use crate::map::photon::{Load, Octahedral};
use glam::{DVec3, Vec3};

/// A photon where it met a particle.
#[derive(Debug, Clone, Copy)]
pub struct VolumePhoton {
    /// Where, in m relative to the scene's centre.
    pub position: [f32; 3],
    incoming: Octahedral,
    medium: u16,
    /// The light that the particle scatters, all directions together.
    load: Load,
}

impl VolumePhoton {
    /// A photon that came along the unit vector `incoming` and whose `load` is scattered at `position`, in the medium of this number.
    pub fn new(position: DVec3, incoming: DVec3, medium: usize, load: Load) -> Self {
        Self {
            position: position.as_vec3().to_array(),
            incoming: Octahedral::encode(incoming),
            medium: medium as u16,
            load,
        }
    }

    pub(super) fn seen_from(&self, cone: &Cone) -> Option<Neighbour<'_>> {
        let offset = Vec3::from(self.position).as_dvec3() - cone.ray.origin;
        let t = offset.dot(cone.ray.direction);
        if !(t > 0.0 && t < cone.length_m) {
            return None;
        }
        let (d2, r) = ((offset - t * cone.ray.direction).length_squared(), cone.radius_at(t));
        (d2 < r * r).then(|| Neighbour {
            load: &self.load,
            incoming: self.incoming.decode(),
            medium: usize::from(self.medium),
            t,
            kernels: Disk::new(r * r).at(d2),
            came: None,
        })
    }
}
