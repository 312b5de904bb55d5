//! One wavelength of a ribbon: its way from the light to a surface that the camera sees.

use crate::emit::connect::PhotonConnector;
use crate::emit::launch::Launch;
use crate::walk::{
    DepthLimit, RayState, ScatteredRay, SurfaceInteraction, SurfaceLookup, long_path_survival, next_interaction,
    path_transmittance, scatter, single_lane, transmittance,
};
use abbe_optics::bsdf::{Bsdf, BsdfClass, BsdfSample, ScatterEvent, TransportMode};
use abbe_optics::fresnel;
use abbe_scene::Scene;
use abbe_spectra::math::random::{Seed, Stream};
use abbe_spectra::spectrum::Wavelengths;
use glam::{DVec2, DVec3};

/// The point where a wavelength lands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Landing {
    /// The position on the plane of the film in pixels, on the film or beside it.
    pub(super) film: DVec2,
    /// The radiance (W/m²/sr) that the pixel sees per watt of the light, as if all of the light had
    /// this wavelength.
    pub(super) radiance: f64,
    /// Equal for landings behind the same sequence of objects and events.
    pub(super) sequence: u64,
}

/// The part of a ribbon that all wavelengths share: the way to the first dispersive surface.
#[derive(Debug)]
pub(super) struct Chain<'a> {
    connector: PhotonConnector<'a>,
    segments: Vec<(RayState, f64)>,
    events: Vec<(SurfaceInteraction<'a>, BsdfSample)>,
    /// The probabilities of reflection at the clear interfaces behind the first dispersive surface.
    reflection: Vec<f64>,
    limit: u32,
}

/// The least probability of each event at a clear interface. Other wavelengths may only have the
/// event that the reference has not.
const LEAST_PROBABILITY: f64 = 0.02;

/// The wavelength that decides the probabilities of reflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// The wavelength decides them for all.
    Reference,
    /// The wavelength takes those of the reference, with its own weights.
    Follower,
}

/// What a ribbon adds to [`Chain`]: the first dispersive surface, and the random numbers behind it.
#[derive(Debug)]
pub(super) struct Fan<'a> {
    surface: SurfaceInteraction<'a>,
    pub(super) launch: Launch,
    stream: Stream,
    lens: [f64; 2],
    seed: Seed,
}

impl<'a> Chain<'a> {
    pub(super) fn new(connector: PhotonConnector<'a>) -> Self {
        let limit = DepthLimit::of(connector.scene).events();
        Self { connector, segments: Vec::new(), events: Vec::new(), reflection: Vec::new(), limit }
    }

    /// Follows an emission to the first dispersive surface. Returns `None` if another surface
    /// scatters or absorbs the light before.
    pub(super) fn start(&mut self, launch: &Launch) -> Option<Fan<'a>> {
        let mut stream = launch.streams.path(0);
        let (lens, seed) = (stream.pair(), Seed::of_numbers(stream.triple()));
        self.segments.clear();
        self.events.clear();
        let mut ray_state = launch.ray_state;
        loop {
            let lookup = SurfaceLookup::of_line(stream.uniform());
            let surface = next_interaction(self.connector.scene, ray_state, lookup)?;
            self.segments.push((ray_state, surface.distance_m));
            if surface.bsdf.class() != BsdfClass::Specular || self.depth() > self.limit {
                return None;
            }
            if surface.disperses() {
                return Some(Fan { surface, launch: *launch, stream, lens, seed });
            }
            let sample = surface.bsdf.sample(surface.wo, surface.sides, launch.hero_nm, stream.triple())?;
            if !sample.delta || stream.uniform() >= long_path_survival(self.depth()) {
                return None;
            }
            let direction = surface.frame.to_world(sample.wi);
            self.events.push((surface, sample));
            ray_state = surface.spawn_ray(direction, surface.medium_stack_after(sample.event));
        }
    }

    pub(super) fn scene(&self) -> &'a Scene {
        self.connector.scene
    }

    /// The number of surface events up to the surface at the end of the segments.
    fn depth(&self) -> u32 {
        self.segments.len() as u32
    }

    /// Traces one wavelength to the surface where it lands. Returns `None` if the camera sees
    /// nothing of it.
    pub(super) fn land(&mut self, fan: &Fan<'a>, nm: f64, role: Role) -> Option<Landing> {
        if role == Role::Reference {
            self.reflection.clear();
        }
        let mut interfaces = 0;
        let scene = self.connector.scene;
        let mut stream = fan.stream.clone();
        let (scattered, event, share) = split(&fan.surface, nm, &mut stream)?;
        let mut flux = fan.launch.flux_w * share * self.flux_before(fan, nm);
        let mut ray_state = fan.surface.spawn_ray(scattered, fan.surface.medium_stack_after(event));
        let mut sequence = extended(0, &fan.surface, event);
        for depth in self.depth() + 1..=self.limit {
            let surface = next_interaction(scene, ray_state, SurfaceLookup::of_line(stream.uniform()))?;
            flux *= self.transmittance(fan, depth, (ray_state, surface.distance_m), nm);
            let scattered = match surface.bsdf.class() {
                BsdfClass::Absorbing => return None,
                // Single photons carry the light that a fluorescent surface scatters and emits.
                _ if surface.bsdf.model.as_fluorescent().is_some() => return None,
                BsdfClass::Diffuse | BsdfClass::Glossy => {
                    let (film, response) = self.connector.response(&surface, fan.launch.ray_density, nm, fan.lens)?;
                    let radiance = flux * response;
                    let sequence = extended(sequence, &surface, ScatterEvent::Reflection);
                    return (radiance > 0.0).then_some(Landing { film, radiance, sequence });
                }
                BsdfClass::Specular if matches!(surface.bsdf.model, Bsdf::Dielectric(_)) => {
                    let scattered = self.pass_interface(&surface, nm, (interfaces, role), &mut stream)?;
                    interfaces += 1;
                    scattered
                }
                BsdfClass::Specular => {
                    scatter(&surface, &Wavelengths::single(nm), TransportMode::Importance, &mut stream)?
                }
            };
            let survival = long_path_survival(depth);
            if !scattered.delta || stream.uniform() >= survival {
                return None;
            }
            flux *= scattered.weight[0] / survival;
            sequence = extended(sequence, &surface, scattered.event);
            ray_state = surface.spawn_scattered(&scattered);
        }
        None
    }

    /// Reflects or refracts one wavelength at the interface with this number. All wavelengths have
    /// the same event, so that the ribbon has no gap where their reflectances differ.
    fn pass_interface(
        &mut self,
        surface: &SurfaceInteraction<'a>,
        nm: f64,
        (number, role): (usize, Role),
        stream: &mut Stream,
    ) -> Option<ScatteredRay> {
        let (n_here, n_there) = (surface.sides.here.n(nm), surface.sides.there.n(nm));
        let wo = surface.wo;
        let reflectance = fresnel::dielectric(wo.z.abs(), n_here, n_there);
        if role == Role::Reference {
            self.reflection.push(reflectance.clamp(LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY));
        }
        // A wavelength may pass more interfaces than the reference.
        let probability = self.reflection.get(number).copied().unwrap_or(0.5);
        let (wi, event, weight) = if stream.uniform() < probability {
            (DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, reflectance / probability)
        } else {
            let refracted = fresnel::refract(wo, DVec3::Z, n_here, n_there)?;
            (refracted, ScatterEvent::Transmission, (1.0 - reflectance) / (1.0 - probability))
        };
        Some(ScatteredRay::specular(surface.frame.to_world(wi), single_lane(0, weight), event))
    }

    /// Returns the factor of the flux before the first dispersive surface.
    fn flux_before(&self, fan: &Fan<'a>, nm: f64) -> f64 {
        let segments = self.segments.iter().zip(1..);
        let passed: f64 = segments.map(|(&segment, depth)| self.transmittance(fan, depth, segment, nm)).product();
        let events = self.events.iter().zip(1..).map(|((surface, sample), depth)| {
            let (weights, _) =
                surface.bsdf.weights(surface.wo, sample, surface.sides, TransportMode::Importance, &[nm]);
            weights[0] / long_path_survival(depth)
        });
        passed * events.product::<f64>()
    }

    fn transmittance(&self, fan: &Fan<'a>, depth: u32, (ray_state, length_m): (RayState, f64), nm: f64) -> f64 {
        if self.connector.media_plan.is_clear() {
            return 1.0;
        }
        let along = path_transmittance(self.connector.scene, ray_state, length_m, fan.seed.part(u64::from(depth)));
        transmittance(&along, nm)
    }
}

/// Returns the direction of one wavelength behind the first dispersive surface, the event, and its
/// share of the flux. Smooth glass always refracts: ribbons do not contain its reflections.
fn split(surface: &SurfaceInteraction<'_>, nm: f64, stream: &mut Stream) -> Option<(DVec3, ScatterEvent, f64)> {
    if let Bsdf::Dielectric(_) = surface.bsdf.model {
        let (n_here, n_there) = (surface.sides.here.n(nm), surface.sides.there.n(nm));
        let refracted = fresnel::refract(surface.wo, DVec3::Z, n_here, n_there)?;
        let share = 1.0 - fresnel::dielectric(surface.wo.z.abs(), n_here, n_there);
        return Some((surface.frame.to_world(refracted), ScatterEvent::Transmission, share));
    }
    let scattered = scatter(surface, &Wavelengths::single(nm), TransportMode::Importance, stream)?;
    let splits = matches!(surface.bsdf.model, Bsdf::Grating(_)) || scattered.event == ScatterEvent::Transmission;
    (splits && scattered.delta).then_some((scattered.direction, scattered.event, scattered.weight[0]))
}

fn extended(sequence: u64, surface: &SurfaceInteraction<'_>, event: ScatterEvent) -> u64 {
    let step = 2 * u64::from(surface.hit.object) + u64::from(event == ScatterEvent::Transmission) + 1;
    (sequence ^ step).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23)
}
