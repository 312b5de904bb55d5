//! The records for the pilot: visible points and camera segments.

use crate::plan::partition::{CameraView, PhotonSet};
use abbe_scene::geometry::Ray;
use glam::DVec3;

/// A point where a camera path read the photon map, at a diffuse or a glossy surface (Hachisuka &
/// Jensen 2009, "Stochastic Progressive Photon Mapping").
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisiblePoint {
    pub position: DVec3,
    /// The surface's unit normal on the visible side.
    pub facing: DVec3,
    pub object: u32,
    /// The side length (m) of the pixel's footprint on a straight path.
    pub footprint_m: f64,
    /// The events on the camera path before it reaches the point.
    pub view: CameraView,
    pub shared: bool,
    /// True if the surface is diffuse. The path then ends at the point.
    pub is_diffuse: bool,
    /// Free photons excite the surface, also if the path carries a shared wavelength.
    pub is_fluorescent: bool,
}

/// A segment of a camera path in a scattering medium. The path gathered photons along this segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraSegment {
    pub ray: Ray,
    pub length_m: f64,
    pub behind_m: f64,
    pub medium: usize,
    pub shared: bool,
    /// Free photons excite the medium, also if the path carries a shared wavelength.
    pub is_fluorescent: bool,
}

impl CameraSegment {
    pub fn reads(&self, set: PhotonSet) -> bool {
        PhotonSet::of_path(self.shared) == set || (self.is_fluorescent && set == PhotonSet::Free)
    }
}

/// The least cosine between the normals of two points of one smooth surface.
const LEAST_COSINE: f64 = 0.9;

/// The largest height above the tangent plane, divided by the distance, on a smooth surface.
const LARGEST_SLOPE: f64 = 0.25;

impl VisiblePoint {
    pub fn reads(&self, set: PhotonSet) -> bool {
        PhotonSet::of_path(self.shared) == set || (self.is_fluorescent && set == PhotonSet::Free)
    }

    /// Returns true if the surface continues smoothly to another position with the normal `facing`.
    pub fn continues_to(&self, position: DVec3, facing: DVec3) -> bool {
        let offset = position - self.position;
        self.facing.dot(facing) > LEAST_COSINE && offset.dot(self.facing).abs() <= LARGEST_SLOPE * offset.length()
    }
}
