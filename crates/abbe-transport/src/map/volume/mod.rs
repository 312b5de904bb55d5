//! Photons in media, gathered along camera rays: points are collisions, and beams are whole
//! segments of photon paths. Also the light maps for direct light in media.

mod beam;
mod light_map;
mod near_ray;
mod point;

pub use beam::PhotonBeam;
pub use light_map::{LightMap, LightMapLookup, LightMaps};
pub use near_ray::{BeamPath, PhotonNearRay};
pub use point::VolumePhoton;

/// The largest number of media in a scene: photons store the number of their medium in 16 bits.
pub const MOST_MEDIA: usize = 1 << u16::BITS;

use super::polarisation::StoredPolarisation;
use super::query_cone::QueryCone;
use beam::BeamMap;
use point::PointMap;

/// The photons of one class in media: points in some media, beams in others.
#[derive(Debug, Default)]
pub struct VolumeMaps {
    pub points: VolumeMap,
    pub beams: VolumeMap,
}

/// A spatial index over points or over beams.
#[derive(Debug, Default)]
pub struct VolumeMap {
    index: VolumeIndex,
}

#[derive(Debug)]
enum VolumeIndex {
    Points(PointMap),
    Beams(BeamMap),
}

impl Default for VolumeIndex {
    fn default() -> Self {
        Self::Points(PointMap::default())
    }
}

impl VolumeMap {
    /// Takes points and their polarisation, which may be empty.
    pub fn of_points(points: Vec<VolumePhoton>, polarisation: &[StoredPolarisation]) -> Self {
        Self { index: VolumeIndex::Points(PointMap::new(points, polarisation)) }
    }

    /// Takes beams and their polarisation, which may be empty.
    pub fn of_beams(beams: Vec<PhotonBeam>, polarisation: Vec<StoredPolarisation>) -> Self {
        Self { index: VolumeIndex::Beams(BeamMap::new(beams, polarisation)) }
    }

    pub fn is_empty(&self) -> bool {
        match &self.index {
            VolumeIndex::Points(points) => points.is_empty(),
            VolumeIndex::Beams(beams) => beams.is_empty(),
        }
    }

    /// Calls `visit` for each photon whose kernel intersects the ray of the cone.
    pub fn along(&self, cone: &QueryCone, visit: impl FnMut(PhotonNearRay<'_>)) {
        match &self.index {
            VolumeIndex::Points(points) => points.along(cone, visit),
            VolumeIndex::Beams(beams) => beams.along(cone, visit),
        }
    }
}
