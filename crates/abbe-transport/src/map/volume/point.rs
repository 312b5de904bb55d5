//! Photon points in media, gathered by the beam radiance estimate (Jarosz, Zwicker & Jensen 2008,
//! "The Beam Radiance Estimate for Volumetric Photon Mapping") with a disk perpendicular to the
//! camera ray.

use super::near_ray::PhotonNearRay;
use crate::map::box_tree::BoxTree;
use crate::map::kernel::DiskKernel;
use crate::map::octahedral::Octahedral;
use crate::map::photon::PhotonPower;
use crate::map::polarisation::StoredPolarisation;
use crate::map::query_cone::QueryCone;
use glam::{DVec3, Vec3};

#[derive(Debug, Clone, Copy)]
pub struct VolumePhoton {
    /// The position in m, relative to the scene's centre.
    pub position: [f32; 3],
    incoming: Octahedral<16>,
    medium: u16,
    /// The number of surface events before, or 0 if the scene does not limit it.
    events: u16,
    /// The power scattered by the medium, summed over all directions.
    power: PhotonPower,
}

impl VolumePhoton {
    /// Takes the unit direction of arrival, and the power that the medium scatters.
    pub fn new(position: DVec3, incoming: DVec3, medium: usize, power: PhotonPower) -> Self {
        Self {
            position: position.as_vec3().to_array(),
            incoming: Octahedral::encode(incoming),
            medium: medium as u16,
            events: 0,
            power,
        }
    }

    /// Returns the stored direction of arrival, a unit vector.
    pub fn incoming(&self) -> DVec3 {
        self.incoming.decode()
    }

    #[must_use]
    pub fn with_events(self, events: u16) -> Self {
        Self { events, ..self }
    }

    pub(super) fn near_ray<'m>(
        &'m self,
        polarisation: Option<&'m StoredPolarisation>,
        cone: &QueryCone,
    ) -> Option<PhotonNearRay<'m>> {
        let offset = Vec3::from(self.position).as_dvec3() - cone.ray.origin;
        let t = offset.dot(cone.ray.direction);
        if !(t > 0.0 && t < cone.length_m) {
            return None;
        }
        let offset = offset - t * cone.ray.direction;
        let (d2, r) = (offset.length_squared(), cone.radius_at(t));
        (d2 < r * r).then(|| PhotonNearRay {
            power: &self.power,
            polarisation,
            incoming: self.incoming.decode(),
            medium: usize::from(self.medium),
            events: u32::from(self.events),
            t,
            offset,
            radius_m: r,
            kernels: DiskKernel::new(r * r).at(d2),
            beam: None,
        })
    }
}

#[derive(Debug, Default)]
pub(super) struct PointMap {
    /// The points, in the order of the tree's leaves.
    points: Vec<VolumePhoton>,
    /// The polarisation of each point. Empty if the plan does not contain it.
    polarisation: Vec<StoredPolarisation>,
    /// The number of the first point of each leaf, and the number of points.
    starts: Vec<u32>,
    tree: BoxTree,
}

impl PointMap {
    pub(super) fn new(points: Vec<VolumePhoton>, polarisation: &[StoredPolarisation]) -> Self {
        let boxes: Vec<(Vec3, Vec3)> = points.iter().map(|p| (p.position.into(), p.position.into())).collect();
        let (tree, leaves) = BoxTree::build(&boxes);
        let order = |number: &u32| *number as usize;
        let points = leaves.boxes.iter().map(|number| points[order(number)]).collect();
        let of_points = if polarisation.is_empty() { &[][..] } else { &leaves.boxes[..] };
        let polarisation = of_points.iter().map(|number| polarisation[order(number)]).collect();
        Self { points, polarisation, starts: leaves.starts, tree }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    pub(super) fn along(&self, cone: &QueryCone, mut visit: impl FnMut(PhotonNearRay<'_>)) {
        self.tree.visit(cone, |leaf| {
            let range = self.starts[leaf] as usize..self.starts[leaf + 1] as usize;
            for number in range {
                if let Some(near) = self.points[number].near_ray(self.polarisation.get(number), cone) {
                    visit(near);
                }
            }
        });
    }
}
