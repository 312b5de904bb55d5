//! Trials of lights at the surfaces that camera paths reach.

use super::camera::sampler::PixelSampler;
use super::direct::learned_lights::LightTrial;
use super::direct::light_tree::ReceivingPoint;
use super::direct::lighting::DirectLighting;
use crate::walk::{BodyMode, SurfaceLookup, WithBodies, scatter};
use abbe_optics::bsdf::TransportMode;
use abbe_spectra::math::random::Streams;
use abbe_spectra::spectrum::{REFERENCE_NM, Wavelengths};
use std::ops::Range;

/// The largest number of surface events of a path.
const MAX_SURFACES: usize = 6;

/// The largest number of trials on a path.
const MAX_TRIALS: usize = 3;

impl DirectLighting<'_> {
    /// Makes trials at the surfaces that camera paths with these numbers reach. They are
    /// distributed evenly over the pixels by the number of all `paths`.
    pub fn light_trials(&self, streams: Streams, range: Range<u64>, paths: u64) -> Vec<LightTrial> {
        let (scene, wavelengths) = (self.scene, Wavelengths::single(REFERENCE_NM));
        let pixels = scene.camera.pixel_count() as u64;
        let mut trials = Vec::new();
        for path in range {
            let pixel = if pixels < paths { path % pixels } else { path * pixels / paths };
            let mut sampler = PixelSampler::new(streams, path, pixel);
            let last = trials.len() + MAX_TRIALS;
            if let Some((_, sensor)) = scene.camera.sensor(pixel) {
                let start = sampler.sensor_sample(scene, sensor, self.portals);
                let receiver = ReceivingPoint::on_sensor(&start.point);
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
}
