//! What a scene loses if its surfaces treat light as unpolarised.
//!
//! The first reflection or refraction of natural light needs no polarisation. A second one receives
//! partly polarised light, so a slab at an oblique angle transmits more than the product of its two
//! faces says. Rays through the picture, and from what they see to the lights, measure this: each
//! follows all chains of specular events, with the Mueller matrices of the events and without.

use crate::walk::{RayState, SurfaceInteraction, SurfaceLookup, next_interaction};
use abbe_optics::bsdf::{Bsdf, BsdfClass, TransportMode};
use abbe_polarisation::Mueller;
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_spectra::spectrum::REFERENCE_NM;
use glam::{DVec2, DVec3};

/// The tolerance: the mean error of the light of the rays, of which all have the same power.
const MAX_ERROR: f64 = 0.01;

/// The rays through the picture, across and down, or the points of all sensors.
const GRID: [u32; 2] = [16, 10];

/// The lights to which rays from a surface lead.
const MOST_LIGHTS: usize = 4;

/// The chains of a ray end after this many events.
const MOST_EVENTS: u32 = 6;

/// Parts of a chain with less of the ray's power are ignored.
const LEAST_WEIGHT: f64 = 3e-3;

/// The power of all rays, and the error of this power.
#[derive(Debug, Clone, Copy, Default)]
struct ChainSums {
    power: f64,
    error: f64,
}

/// Returns the reason why a scene needs polarisation, if its error without exceeds the tolerance.
pub(super) fn needs_polarisation(scene: &Scene) -> Option<String> {
    let error = error_of_unpolarised_light(scene);
    (error > MAX_ERROR).then(|| {
        format!(
            "oblique faces in a row, which would change the light by {:.2} % without it ({:.0} % is allowed)",
            100.0 * error,
            100.0 * MAX_ERROR
        )
    })
}

/// Returns the reason why a scene with such chains needs no polarisation.
pub(super) fn small_polarisation(scene: &Scene) -> Option<String> {
    let error = error_of_unpolarised_light(scene);
    (error > 0.0 && error <= MAX_ERROR).then(|| {
        format!(
            "oblique faces in a row change the light by {:.2} % if each treats it as unpolarised, and {:.0} % is \
             allowed",
            100.0 * error,
            100.0 * MAX_ERROR
        )
    })
}

/// Returns the mean error of the light of all rays, relative to their power, if each surface treats
/// light as unpolarised. It is 0 without chains of specular events.
fn error_of_unpolarised_light(scene: &Scene) -> f64 {
    let specular = |bsdf: &Bsdf| bsdf.class() == BsdfClass::Specular;
    if !scene.materials.iter().any(|material| material.surface.components().any(specular)) {
        return 0.0;
    }
    let mut sums = ChainSums::default();
    for start in starts(scene) {
        sums.follow(scene, start, (Mueller::IDENTITY, 1.0), 0, true);
    }
    if sums.power > 0.0 { sums.error / sums.power } else { 0.0 }
}

/// Returns the first segments of the rays.
fn starts(scene: &Scene) -> Vec<RayState> {
    let [across, down] = GRID;
    let cells = (0..down).flat_map(move |y| (0..across).map(move |x| DVec2::new(f64::from(x), f64::from(y)) + 0.5));
    let size = DVec2::new(f64::from(across), f64::from(down));
    let camera = &scene.camera;
    if camera.sensors().is_empty() {
        return cells
            .map(|cell| {
                let ray = camera.ray(cell / size * camera.film_size(), [0.5; 2]);
                RayState { ray, from: None, medium_stack: scene.medium_stack_of_camera(ray) }
            })
            .collect();
    }
    let per_sensor = cells.map(|cell| (cell / size).to_array()).collect::<Vec<_>>();
    let points = camera.sensors().iter().flat_map(|sensor| {
        per_sensor.iter().step_by(10).map(|&[u, v]| scene.sensor_point(sensor, [0.5, u, v, 0.5])).collect::<Vec<_>>()
    });
    points
        .flat_map(|point| {
            towards_lights(scene, point.position).map(move |direction| RayState {
                ray: Ray { origin: point.position, direction },
                from: point.from,
                medium_stack: point.medium_stack,
            })
        })
        .collect()
}

/// Returns the directions from a point to the first lights.
fn towards_lights(scene: &Scene, from: DVec3) -> impl Iterator<Item = DVec3> + '_ {
    let lights = scene.lights.iter().take(MOST_LIGHTS);
    lights.filter_map(move |light| Some(light.sample_li(scene.extent(), from, [0.5; 3])?.direction))
}

impl ChainSums {
    /// Follows all chains from a segment, on which the path has this matrix relative to its weight.
    fn follow(&mut self, scene: &Scene, start: RayState, (matrix, weight): (Mueller, f64), events: u32, seen: bool) {
        let next = next_interaction(scene, start, SurfaceLookup::of_line(0.5));
        let Some(interaction) = next.filter(|_| events < MOST_EVENTS) else {
            return self.end(matrix, weight);
        };
        if interaction.bsdf.class() != BsdfClass::Specular {
            if seen {
                // What the ray sees is lit along other chains.
                let position = interaction.hit.position;
                for direction in towards_lights(scene, position) {
                    let stack = interaction.medium_stack_towards(direction);
                    let start = interaction.spawn_ray(direction, stack);
                    self.follow(scene, start, (Mueller::IDENTITY, 1.0), 0, false);
                }
            }
            return self.end(matrix, weight);
        }
        for u in [0.0, ONE_MINUS_ULP] {
            self.scatter(scene, &interaction, (matrix, weight), events, (u, seen));
        }
    }

    fn scatter(
        &mut self,
        scene: &Scene,
        interaction: &SurfaceInteraction<'_>,
        (matrix, weight): (Mueller, f64),
        events: u32,
        (u, seen): (f64, bool),
    ) {
        let SurfaceInteraction { bsdf, wo, sides, .. } = *interaction;
        let Some(sample) = bsdf.sample(wo, sides, REFERENCE_NM, [0.5, 0.5, u]) else { return };
        let other = bsdf.sample(wo, sides, REFERENCE_NM, [0.5, 0.5, 0.0]);
        let is_repeated = u > 0.0 && other.is_some_and(|other| other.event == sample.event);
        let part = bsdf.eval_sample(wo, &sample, sides, TransportMode::Importance, REFERENCE_NM);
        if is_repeated || weight * part < LEAST_WEIGHT {
            return;
        }
        let direction = interaction.frame.to_world(sample.wi);
        let event = interaction.event_of_camera(direction, true);
        let start = interaction.spawn_ray(direction, interaction.medium_stack_after(sample.event));
        self.follow(scene, start, (matrix * event.matrix(REFERENCE_NM), weight * part), events + 1, seen);
    }

    /// Adds the end of a chain. A first event changes no power of natural light.
    fn end(&mut self, matrix: Mueller, weight: f64) {
        self.power += weight;
        self.error += weight * (matrix.0[0][0] - 1.0).abs();
    }
}
