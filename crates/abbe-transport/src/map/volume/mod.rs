//! Photons in media, gathered along camera rays. Points are the collisions of photons, and beams
//! are whole segments of photon paths. The module also contains the light maps for direct light in
//! media.

mod beam;
mod light_map;
mod point;

pub use beam::PhotonBeam;
pub use light_map::{LightMap, LightMapLookup, LightMaps};
pub use point::VolumePhoton;

use super::kernel::KernelValues;
use super::photon::PhotonPower;
use super::query_cone::QueryCone;
use beam::BeamMap;
use glam::DVec3;
use point::PointMap;

/// The photons of one class in media: points in some media, beams in others.
#[derive(Debug, Default)]
pub struct VolumeMaps {
    /// Collisions of photons.
    pub points: VolumeMap,
    /// Segments of photon paths.
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
    /// The start of the beam.
    pub start: DVec3,
    /// The distance from the start to the closest approach, in m.
    pub distance_m: f64,
}

impl VolumeMap {
    /// Creates a map of points.
    pub fn of_points(points: Vec<VolumePhoton>) -> Self {
        Self { index: VolumeIndex::Points(PointMap::new(points)) }
    }

    /// Creates a map of beams.
    pub fn of_beams(beams: Vec<PhotonBeam>) -> Self {
        Self { index: VolumeIndex::Beams(BeamMap::new(beams)) }
    }

    /// Returns true if the map has no photons.
    pub fn is_empty(&self) -> bool {
        match &self.index {
            VolumeIndex::Points(points) => points.is_empty(),
            VolumeIndex::Beams(beams) => beams.is_empty(),
        }
    }

    /// Calls `visit` for each photon whose kernel intersects the ray of the cone. Allocates
    /// nothing.
    pub fn along(&self, cone: &QueryCone, visit: impl FnMut(PhotonNearRay<'_>)) {
        match &self.index {
            VolumeIndex::Points(points) => points.along(cone, visit),
            VolumeIndex::Beams(beams) => beams.along(cone, visit),
        }
    }
}
