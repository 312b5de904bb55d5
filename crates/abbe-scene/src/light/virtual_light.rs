//! A virtual light: one fixed point or direction of a light, chosen before the illuminated points
//! are known.
//!
//! It represents the whole light if the light has no extent. Otherwise, the mean irradiance from
//! random virtual lights equals the irradiance from the light (compare the virtual point lights of
//! Keller 1997). There is exactly one straight connection from a virtual light to each point, so a
//! light map can store its transmittance.

use crate::geometry::{Ray, SurfaceId, SurfaceSample};
use glam::DVec3;

/// One point of a light, or one direction to a distant light.
#[derive(Debug, Clone, Copy)]
pub struct VirtualLight {
    kind: VirtualLightKind,
    surface: Option<SurfaceId>,
    u: [f64; 3],
}

#[derive(Debug, Clone, Copy)]
enum VirtualLightKind {
    /// A point.
    Point(DVec3),
    /// A point of a surface, with its unit normal. `flux` is the radiance (W/m²/sr over the band)
    /// divided by the pdf of the point, per m².
    Surface { position: DVec3, normal: DVec3, flux: f64 },
    /// Parallel light. The unit vector `direction` points towards its source, at infinity or on the
    /// plane through this point that is perpendicular to `direction`.
    Parallel { direction: DVec3, plane: Option<DVec3> },
}

/// The straight connection from a point to a virtual light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightConnection {
    /// A unit vector from the point towards the light.
    pub direction: DVec3,
    /// In m: infinite for a distant light, and 0 if the point is on the light. For a parallel beam,
    /// it is 0 on the plane of the disk, and negative behind this plane.
    pub distance: f64,
    pub target: Option<SurfaceId>,
}

impl VirtualLight {
    /// A virtual light at a point without a surface, which the random numbers `u` selected.
    pub(super) fn at_point(position: DVec3, u: [f64; 3]) -> Self {
        Self { kind: VirtualLightKind::Point(position), surface: None, u }
    }

    /// A virtual light at a sampled point of a surface with this radiance (W/m²/sr over the band).
    pub(super) fn on_surface(sample: &SurfaceSample, radiance: f64, u: [f64; 3]) -> Self {
        let flux = radiance / sample.pdf_area;
        let kind = VirtualLightKind::Surface { position: sample.position, normal: sample.normal, flux };
        Self { kind, surface: Some(sample.surface), u }
    }

    /// A virtual light of parallel rays from the direction `direction`, which start on a plane
    /// through `plane`, or at infinity.
    pub(super) fn parallel(direction: DVec3, plane: Option<DVec3>, u: [f64; 3]) -> Self {
        Self { kind: VirtualLightKind::Parallel { direction, plane }, surface: None, u }
    }

    pub fn randoms(&self) -> [f64; 3] {
        self.u
    }

    /// The connection from a point to the light, even if the light does not shine there.
    pub fn connection_from(&self, from: DVec3) -> LightConnection {
        let (direction, distance) = match self.kind {
            VirtualLightKind::Point(position) | VirtualLightKind::Surface { position, .. } => {
                (position - from).normalize_and_length()
            }
            VirtualLightKind::Parallel { direction, plane: None } => (direction, f64::INFINITY),
            VirtualLightKind::Parallel { direction, plane: Some(point) } => (direction, (point - from).dot(direction)),
        };
        LightConnection { direction, distance, target: self.surface }
    }

    /// The ray from the light to a point, and its length in m: `far_m` if the light is at infinity.
    pub fn ray_to(&self, to: DVec3, far_m: f64) -> (Ray, f64) {
        let LightConnection { direction, distance, .. } = self.connection_from(to);
        let length = if distance.is_finite() { distance } else { far_m };
        (Ray::new(to + length * direction, -direction), length)
    }

    /// The irradiance on a plane perpendicular to a connection, in W/m² over the band, from the
    /// surface point at its end. `None` if the light has no surface.
    pub(super) fn surface_irradiance(&self, connection: &LightConnection) -> Option<f64> {
        let VirtualLightKind::Surface { normal, flux, .. } = self.kind else { return None };
        let LightConnection { direction, distance, .. } = *connection;
        Some(flux * -direction.dot(normal) / (distance * distance))
    }
}
