//! Trials of lights: camera paths that measure how much light reaches surfaces from which emitter.

use super::learned_lights::LightTrial;
use super::light_tree::ReceivingPoint;
use super::lighting::DirectLighting;
use crate::gather::camera::sampler::PixelSampler;
use crate::walk::{BodyMode, SurfaceLookup, WithBodies, scatter};
use abbe_optics::bsdf::TransportMode;
use abbe_scene::geometry::{Ray, SurfaceId};
use abbe_spectra::spectrum::{REFERENCE_NM, Wavelengths};
use std::ops::Range;

/// The largest number of surface events of a path.
const MAX_SURFACES: usize = 6;

/// The largest number of trials on a path.
const MAX_TRIALS: usize = 3;

impl DirectLighting<'_> {
    /// Traces camera paths with these numbers, and makes trials at the surfaces that they reach.
    /// The numbers are distributed evenly over the pixels. `paths` is the number of all paths.
    pub fn light_trials(&self, seed: u64, range: Range<u64>, paths: u64) -> Vec<LightTrial> {
        let (scene, wavelengths) = (self.scene, Wavelengths::single(REFERENCE_NM));
        let pixels = scene.camera.pixel_count() as u64;
        let mut trials = Vec::new();
        for path in range {
            let pixel = if pixels < paths { path % pixels } else { path * pixels / paths };
            let mut sampler = PixelSampler::new(seed, path, pixel);
            let last = trials.len() + MAX_TRIALS;
            if let Some((_, receptor)) = scene.camera.receptor(pixel) {
                let start = sampler.receptor_sample(scene, receptor, self.openings);
                let receiver = ReceivingPoint::on_receptor(&start.point);
                trials.extend(self.light_trial(receiver, start.point.from, sampler.stream.triple()));
            }
            let Some((mut ray_state, _)) = sampler.ray_at(scene, pixel, REFERENCE_NM) else { continue };
            for _ in 0..MAX_SURFACES {
                let stream = &mut sampler.stream;
                let lookup = SurfaceLookup::of_line(stream.uniform());
                let Some(interaction) = WithBodies::next_interaction(scene, ray_state, lookup) else { break };
                let receiver = ReceivingPoint::on_surface(&interaction);
                if interaction.bsdf.pdf(interaction.wo, interaction.wo, interaction.sides, REFERENCE_NM) > 0.0 {
                    trials.extend(self.light_trial(receiver, Some(interaction.hit.surface), stream.triple()));
                }
                if trials.len() >= last {
                    break;
                }
                let scattered = scatter(&interaction, &wavelengths, TransportMode::Radiance, stream);
                let Some(scattered) = scattered else { break };
                ray_state = interaction.spawn_scattered(&scattered);
            }
        }
        trials
    }

    /// Samples an emitter of the tree for one side of a surface, and measures its irradiance.
    /// Returns `None` if there is no such side, or if the tree has no light for it.
    fn light_trial(&self, receiver: ReceivingPoint, from: Option<SurfaceId>, u: [f64; 3]) -> Option<LightTrial> {
        let (selected, emitter, importance) = self.selector.select_for_trial(receiver, u)?;
        let ReceivingPoint { position, normal } = receiver;
        let light = &self.scene.lights[selected.number];
        let incident = self.sample_li(light, position, selected.u).filter(|incident| {
            let ray = Ray { origin: position, direction: incident.direction };
            let towards = incident.direction.dot(normal) > 0.0 && incident.irradiance > 0.0;
            towards && self.line_to_light(ray, from, incident.target, incident.distance).is_some()
        });
        let light_per_importance = incident.map_or(0.0, |incident| {
            // The probability of a triangle changes the density of the samples of its mesh.
            let irradiance = incident.irradiance * incident.direction.dot(normal) / selected.probability;
            irradiance * light.importance_per_watt / importance
        });
        Some(LightTrial { position, normal, emitter, light_per_importance })
    }
}
