//! The records for the pilot: visible points and camera segments.

use crate::plan::partition::{CameraView, PhotonSet};
use abbe_scene::geometry::Ray;
use glam::DVec3;

/// A visible point: a point where a camera path read the photon map, at a diffuse or a glossy
/// surface (Hachisuka & Jensen 2009, "Stochastic Progressive Photon Mapping").
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisiblePoint {
    pub position: DVec3,
    /// The surface's unit normal on the visible side.
    pub facing: DVec3,
    pub object: u32,
    /// The side length (m) of the pixel's footprint. The footprint is computed as if the path were
    /// straight.
    pub footprint_m: f64,
    /// The events on the camera path before it reaches the point.
    pub view: CameraView,
    /// True if the path carries a shared wavelength.
    pub shared: bool,
    /// True if the surface is diffuse. The path then ends at the point.
    pub is_diffuse: bool,
    /// True if the surface is fluorescent. Free photons excite it, also if the path carries a
    /// shared wavelength.
    pub is_fluorescent: bool,
}

/// A segment of a camera path in a scattering medium. The path gathered photons along this segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraSegment {
    pub ray: Ray,
    /// The length in m.
    pub length_m: f64,
    /// The length of the path from the camera to the ray's origin, in m.
    pub behind_m: f64,
    pub medium: usize,
    /// True if the path carries a shared wavelength.
    pub shared: bool,
    /// True if the medium is fluorescent. Free photons excite it, also if the path carries a shared
    /// wavelength.
    pub is_fluorescent: bool,
}

impl CameraSegment {
    /// Returns true if the path reads photons of this set along the segment.
    pub fn reads(&self, set: PhotonSet) -> bool {
        PhotonSet::of_path(self.shared) == set || (self.is_fluorescent && set == PhotonSet::Free)
    }
}

/// Two points belong to one smooth surface only if the cosine of the angle between their normals is
/// larger than this value.
const LEAST_COSINE: f64 = 0.9;

/// The upper limit of a ratio: the height of a point above the tangent plane, divided by the
/// distance of the point. If the ratio is above this limit, the point does not belong to the same
/// smooth surface.
const LARGEST_SLOPE: f64 = 0.25;

impl VisiblePoint {
    /// Returns true if the path reads photons of this set at the point.
    pub fn reads(&self, set: PhotonSet) -> bool {
        PhotonSet::of_path(self.shared) == set || (self.is_fluorescent && set == PhotonSet::Free)
    }

    /// Returns true if the surface continues smoothly to another position. `facing` is the normal
    /// at that position.
    pub fn continues_to(&self, position: DVec3, facing: DVec3) -> bool {
        let offset = position - self.position;
        self.facing.dot(facing) > LEAST_COSINE && offset.dot(self.facing).abs() <= LARGEST_SLOPE * offset.length()
    }
}
