//! Trials of lights: how much light reaches a surface from which emitter.

use super::learned_lights::LightTrial;
use super::light_tree::ReceivingPoint;
use super::lighting::DirectLighting;
use abbe_scene::geometry::{Ray, SurfaceId};

impl DirectLighting<'_> {
    /// Samples an emitter of the tree for one side of a surface, and measures its irradiance.
    /// Returns `None` if there is no such side or no light.
    pub(in crate::gather) fn light_trial(
        &self,
        receiver: ReceivingPoint,
        from: Option<SurfaceId>,
        u: [f64; 3],
    ) -> Option<LightTrial> {
        let (selected, emitter, importance) = self.selector.select_for_trial(receiver, u)?;
        let ReceivingPoint { position, normal } = receiver;
        let light = &self.scene.lights[selected.number];
        let incident = self.sample_li(light, position, selected.u).filter(|incident| {
            let ray = Ray { origin: position, direction: incident.direction };
            let towards = incident.direction.dot(normal) > 0.0 && incident.irradiance > 0.0;
            towards && self.line_to_light(ray, [from, incident.target], incident.distance, selected.u).is_some()
        });
        let light_per_importance = incident.map_or(0.0, |incident| {
            // The probability of a triangle changes the density of the samples of its mesh.
            let irradiance = incident.irradiance * incident.direction.dot(normal) / selected.probability;
            irradiance * light.importance_per_watt / importance
        });
        Some(LightTrial { position, normal, emitter, light_per_importance })
    }
}
