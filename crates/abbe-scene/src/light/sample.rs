//! Samples of a light: emitted rays, and directions from a point to the light.

use crate::geometry::{Geometry, SurfaceId};
use abbe_optics::texture::Texel;
use glam::DVec3;

/// The relative spectral power distribution of one part of a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EmittedSpd {
    /// The light's own spectrum.
    Own,
    /// Weights, with sum 1, of the red, green and blue basis spectra of an environment map.
    Mixed([f64; 3]),
    /// The spectral bands of this pixel of an environment map.
    Bands(u32),
    /// The light's own spectrum behind this texel of a slide.
    Filtered(Texel),
    /// The emission of hot matter at this temperature in K.
    Thermal(f64),
}

#[derive(Debug, Clone, Copy)]
pub struct LeSample {
    /// In m, relative to the scene's centre.
    pub origin: DVec3,
    /// The direction in which the light travels, as a unit vector.
    pub direction: DVec3,
    /// The surface that emits the ray, for an area light.
    pub from: Option<SurfaceId>,
    /// The flux in W over the band, divided by the pdf of the sample.
    pub flux_w: f64,
    pub spd: EmittedSpd,
}

impl LeSample {
    pub(super) fn dark(self) -> Self {
        Self { flux_w: 0.0, ..self }
    }
}

/// One direction from a point to a light: the result of
/// [`Light::sample_li`](super::Light::sample_li).
#[derive(Debug, Clone, Copy)]
pub struct LiSample {
    /// A unit vector from the point to the light.
    pub direction: DVec3,
    /// In m; infinite for distant lights.
    pub distance: f64,
    /// The light's surface at the end of the shadow ray, which does not block the ray.
    pub target: Option<SurfaceId>,
    /// The radiance divided by the pdf of the sample, in W/m²: for a light without extent, the
    /// irradiance on a plane perpendicular to `direction`.
    pub irradiance: f64,
    /// The pdf of `direction` per steradian, or `None` for delta lights.
    pub pdf_solid_angle: Option<f64>,
    pub spd: EmittedSpd,
}

/// The uniform random numbers in [0, 1) for one emitted ray.
#[derive(Debug, Clone, Copy)]
pub struct LeRandoms {
    /// The pair that photon aiming may sample with a learned pdf: it selects the position of a ray
    /// of a beam or a distant light, and the direction of a ray of all other lights.
    pub aim: [f64; 2],
    pub rest: [f64; 3],
}

/// Returns the origin, outside the scene's bounding sphere, of a ray of a distant light through
/// `point`, or `None` if the ray does not reach that sphere.
pub(super) fn distant_origin(point: DVec3, direction: DVec3, world_radius_m: f64) -> Option<DVec3> {
    let across = point - point.dot(direction) * direction;
    (across.length_squared() <= world_radius_m * world_radius_m).then(|| across - world_radius_m * direction)
}

/// The surfaces of a scene, and the sphere through which light of distant lights passes.
#[derive(Debug, Clone, Copy)]
pub struct SceneExtent<'a> {
    pub geometry: &'a Geometry,
    pub radius_m: f64,
}

/// A point of a light such that the bodies that contain the point also contain the light.
#[derive(Debug, Clone, Copy)]
pub struct RepresentativePoint {
    /// In m, relative to the scene's centre.
    pub position: DVec3,
    /// For area lights: the surface that contains the point, and its outward unit normal.
    pub surface: Option<(SurfaceId, DVec3)>,
}
