//! A virtual light: one fixed point or direction of a light. It is chosen before the illuminated
//! points are known.
//!
//! If a light has no extent, its virtual light represents the whole light. If a light has extent,
//! the mean irradiance from its random virtual lights equals the irradiance from the light (compare
//! the virtual point lights of Keller 1997). There is exactly one straight connection from a
//! virtual light to each point, so a light map can store the transmittance of that connection.

use crate::geometry::{Ray, SurfaceId, SurfaceSample};
use glam::DVec3;

/// One point of a light, or one direction to a distant light.
#[derive(Debug, Clone, Copy)]
pub struct VirtualLight {
    kind: VirtualLightKind,
    surface: Option<SurfaceId>,
    u: [f64; 3],
}

/// The source of a virtual light.
#[derive(Debug, Clone, Copy)]
enum VirtualLightKind {
    /// A point.
    Point(DVec3),
    /// A point of a surface, with its unit normal. `flux` is the radiance (W/m²/sr over the band)
    /// divided by the density of the point. The density is per m².
    Surface { position: DVec3, normal: DVec3, flux: f64 },
    /// Parallel light. The unit vector `direction` points towards the source of the light. The
    /// light starts at infinity, or on a plane through a point. This plane is perpendicular to
    /// `direction`.
    Parallel { direction: DVec3, plane: Option<DVec3> },
}

/// The straight connection from a point to a virtual light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightConnection {
    /// The unit vector from the point towards the light.
    pub direction: DVec3,
    /// The length in m. The length is infinite for a distant light. It is 0 if the point is on the
    /// light. For a parallel beam, it is 0 on the plane of the disk, and negative behind this
    /// plane.
    pub distance: f64,
    /// The surface on which the connection ends.
    pub target: Option<SurfaceId>,
}

impl VirtualLight {
    /// A virtual light at a point without a surface. `u` are the random numbers that selected the
    /// point.
    pub(super) fn at_point(position: DVec3, u: [f64; 3]) -> Self {
        Self { kind: VirtualLightKind::Point(position), surface: None, u }
    }

    /// A virtual light at a sampled point of a surface. `radiance` is the radiance of the surface
    /// (W/m²/sr over the band).
    pub(super) fn on_surface(sample: &SurfaceSample, radiance: f64, u: [f64; 3]) -> Self {
        let flux = radiance / sample.pdf_area;
        let kind = VirtualLightKind::Surface { position: sample.position, normal: sample.normal, flux };
        Self { kind, surface: Some(sample.surface), u }
    }

    /// A virtual light of parallel rays. The unit vector `direction` points towards the source of
    /// the rays. The rays start on a plane through `plane`, or at infinity.
    pub(super) fn parallel(direction: DVec3, plane: Option<DVec3>, u: [f64; 3]) -> Self {
        Self { kind: VirtualLightKind::Parallel { direction, plane }, surface: None, u }
    }

    /// The random numbers that selected the point.
    pub fn randoms(&self) -> [f64; 3] {
        self.u
    }

    /// The connection from a point to the light. The connection exists even if the light does not
    /// shine towards the point.
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

    /// The ray from the light to a point, and the ray's length in m. If the light is at infinity,
    /// the ray starts at the distance `far_m` from the point.
    pub fn ray_to(&self, to: DVec3, far_m: f64) -> (Ray, f64) {
        let LightConnection { direction, distance, .. } = self.connection_from(to);
        let length = if distance.is_finite() { distance } else { far_m };
        (Ray::new(to + length * direction, -direction), length)
    }

    /// The irradiance on a plane perpendicular to a connection, in W/m² over the band. The light
    /// comes from the surface point at the end of the connection. `None` if the light has no
    /// surface.
    pub(super) fn surface_irradiance(&self, connection: &LightConnection) -> Option<f64> {
        let VirtualLightKind::Surface { normal, flux, .. } = self.kind else { return None };
        let LightConnection { direction, distance, .. } = *connection;
        Some(flux * -direction.dot(normal) / (distance * distance))
    }
}
