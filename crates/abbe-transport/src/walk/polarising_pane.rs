//! Panes that polarise the light of shadow rays.

use abbe_optics::bsdf::{LocalRetardance, ThinDielectric};
use abbe_optics::glass::RefractiveIndex;
use abbe_polarisation::ScatteringEvent;
use abbe_scene::Scene;
use abbe_scene::geometry::Hit;
use abbe_spectra::math::frame::Frame;
use glam::{DVec3, Vec3};

/// What decides how a pane polarises the light of a shadow ray, in single precision, so that a segment
/// stays small.
#[derive(Debug, Clone, Copy)]
pub struct PolarisingPane {
    /// The direction of the light.
    travel: Vec3,
    normal: Vec3,
    /// The axis u of a filter.
    u: Vec3,
    retardance: LocalRetardance,
}

impl PolarisingPane {
    /// Takes a pane with its retardance, and the direction of the light.
    pub(crate) fn new(
        scene: &Scene,
        (pane, retardance): (&ThinDielectric, LocalRetardance),
        hit: &Hit,
        travel: DVec3,
    ) -> Self {
        let tangents = pane.filter().and_then(|_| scene.geometry.uv_tangents(hit));
        let u = tangents.map_or_else(|| Frame::new(hit.normal).to_world(DVec3::X), |[u, _]| u.normalize());
        Self { travel: travel.as_vec3(), normal: hit.normal.as_vec3(), u: u.as_vec3(), retardance }
    }

    /// Returns what the pane does to the light.
    pub(super) fn event<'a>(&self, pane: &'a ThinDielectric, outside: &'a RefractiveIndex) -> ScatteringEvent<'a> {
        let [travel, normal, u] = [self.travel, self.normal, self.u].map(|vector| vector.as_dvec3().normalize());
        ScatteringEvent::through_pane((pane, self.retardance), outside, travel, [normal, u])
    }
}
