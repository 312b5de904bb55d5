//! Samples of a light: emitted rays, and directions from a point to the light.

use crate::geometry::{Geometry, SurfaceId};
use abbe_optics::texture::Texel;
use glam::DVec3;

/// The relative spectral power distribution of one part of a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EmittedSpd {
    /// The light's own spectrum.
    Own,
    /// A mixture of the red, green and blue basis spectra of an environment map. The weights sum
    /// to 1.
    Mixed([f64; 3]),
    /// The light's own spectrum behind a slide: the texel of the slide.
    Filtered(Texel),
    /// The emission of hot matter at this temperature in K.
    Thermal(f64),
}

/// One emitted ray.
#[derive(Debug, Clone, Copy)]
pub struct LeSample {
    /// The origin of the ray, relative to the scene's centre, in m.
    pub origin: DVec3,
    /// The direction in which the light travels, as a unit vector.
    pub direction: DVec3,
    /// The surface that emits the ray. `None` if the light is not an area light.
    pub from: Option<SurfaceId>,
    /// The flux in W over the band, divided by the density of the sample.
    pub flux_w: f64,
    /// The spectrum of this ray.
    pub spd: EmittedSpd,
}

impl LeSample {
    /// Returns the sample without light.
    pub(super) fn dark(self) -> Self {
        Self { flux_w: 0.0, ..self }
    }
}

/// One direction from a point to a light: the result of
/// [`Light::sample_li`](super::Light::sample_li).
#[derive(Debug, Clone, Copy)]
pub struct LiSample {
    /// The direction from the point to the light, as a unit vector.
    pub direction: DVec3,
    /// The distance to the light in m; infinite for distant lights.
    pub distance: f64,
    /// The light's surface at the end of the shadow ray. This surface does not block the shadow
    /// ray.
    pub target: Option<SurfaceId>,
    /// The radiance divided by the density of the sample, in W/m². For a light without extent, this
    /// is the irradiance on a plane perpendicular to `direction`.
    pub irradiance: f64,
    /// The density of `direction` per steradian, or `None` for delta lights.
    pub pdf_solid_angle: Option<f64>,
    /// The spectrum of the light from this direction.
    pub spd: EmittedSpd,
}

/// The uniform random numbers in [0, 1) for one emitted ray.
#[derive(Debug, Clone, Copy)]
pub struct LeRandoms {
    /// The pair of numbers that photon aiming may sample with a learned density. For a beam or a
    /// distant light, the pair selects the position of the ray. For all other lights, it selects
    /// the direction of the ray.
    pub aim: [f64; 2],
    /// The remaining numbers.
    pub rest: [f64; 3],
}

/// Returns the origin of a ray of a distant light. The ray passes through `point` and starts outside
/// the scene's bounding sphere. Returns `None` if the ray does not reach that sphere.
pub(super) fn distant_origin(point: DVec3, direction: DVec3, world_radius_m: f64) -> Option<DVec3> {
    let across = point - point.dot(direction) * direction;
    (across.length_squared() <= world_radius_m * world_radius_m).then(|| across - world_radius_m * direction)
}

/// The surfaces of a scene, and the scene's bounding sphere around the origin. Light from distant
/// lights always passes through this sphere.
#[derive(Debug, Clone, Copy)]
pub struct SceneExtent<'a> {
    /// The surfaces.
    pub geometry: &'a Geometry,
    /// The radius of the bounding sphere in m.
    pub radius_m: f64,
}

/// A point of a light. The bodies that contain this point also contain the light.
#[derive(Debug, Clone, Copy)]
pub struct RepresentativePoint {
    /// The point, relative to the scene's centre, in m.
    pub position: DVec3,
    /// For area lights: the surface that contains the point, and the outward unit normal of the
    /// surface.
    pub surface: Option<(SurfaceId, DVec3)>,
}
