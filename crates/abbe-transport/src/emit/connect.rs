//! Connection of photons to the camera (light tracing), without kernel and bias.

use super::photon_path::PhotonState;
use super::visitor::SurfaceArrival;
use crate::plan::{MediumPlan, Plan};
use crate::walk::{
    CausticWeights, PathTransmittance, RayDensity, SurfaceInteraction, event_at_camera_filter, path_transmittance,
    rotation_to_picture, transmittance,
};
use abbe_optics::bsdf::{BsdfClass, TransportMode};
use abbe_optics::fluorophore::Fluorophore;
use abbe_polarisation::Stokes;
use abbe_scene::Scene;
use abbe_scene::camera::CameraConnection;
use abbe_spectra::math::random::Seed;
use abbe_spectra::spectrum::{LANES, REFERENCE_NM};
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_PI;

#[derive(Debug, Clone, Copy)]
pub struct Splat {
    pub pixel: u32,
    /// The wavelengths in nm, and the radiance at each in W/m²/sr, already divided by all
    /// densities: first at the photon's wavelengths, then, at a fluorescent surface, at those of
    /// its emission.
    lanes: [(f64, f64); 2 * LANES],
    count: usize,
}

/// S1, S2 and S3 of a splat at the photon's wavelengths, divided by the radiance, in the frame of the
/// picture.
pub type SplatStokes = [[f64; 3]; LANES];

impl Splat {
    /// Returns the photon's wavelengths in nm, and S1, S2 and S3 of the radiance there, from those that
    /// [`PhotonConnector::connect`] sets.
    pub fn stokes(&self, stokes: &SplatStokes) -> impl Iterator<Item = (f64, [f64; 3])> {
        let lanes = self.lanes.iter().zip(stokes).take(self.count);
        lanes.map(|(&(nm, radiance), stokes)| (nm, stokes.map(|part| radiance * part)))
    }

    pub fn lanes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.lanes[..self.count].iter().copied()
    }
}

#[derive(Debug, Clone, Copy)]
pub struct PhotonConnector<'a> {
    pub scene: &'a Scene,
    pub media_plan: MediumPlan,
    /// True if photons carry their polarisation.
    pub polarised: bool,
    /// The number of photon paths in the photon's set.
    pub photons_per_sample: f64,
}

impl<'a> PhotonConnector<'a> {
    pub fn new(scene: &'a Scene, plan: &Plan, photons_per_sample: f64) -> Self {
        Self { scene, media_plan: plan.media_plan, polarised: plan.polarisation.is_on(), photons_per_sample }
    }

    /// Connects a photon at a surface to the camera, or returns `None` if the camera does not see
    /// it. `lens` in [0, 1)² selects the point of the aperture, and `emission` in [0, 1) the
    /// wavelengths of the emission at a fluorescent surface. It sets `stokes` if photons carry their
    /// polarisation.
    pub fn connect(
        &self,
        arrival: &SurfaceArrival<'_>,
        lens: [f64; 2],
        emission: f64,
        stokes: &mut SplatStokes,
    ) -> Option<Splat> {
        let scene = self.scene;
        let SurfaceArrival { interaction, photon, .. } = arrival;
        let connection = scene.camera.connect(interaction.hit.position, lens)?;
        let pixel = scene.camera.pixel_at(connection.film)?;
        let to_camera = interaction.frame.to_local(connection.direction);
        let to_light = interaction.wo;
        let sides = interaction.sides_towards(connection.direction);
        let geometry = self.geometry(interaction, photon.ray_density, &connection);
        let mut lanes = [(0.0, 0.0); 2 * LANES];
        let mut count = photon.wavelengths.count;
        for (k, &nm) in photon.wavelengths.active().iter().enumerate() {
            let f = interaction.bsdf.eval(to_camera, to_light, sides, TransportMode::Radiance, nm);
            lanes[k] = (nm, f * photon.power[k] * geometry);
        }
        if self.polarised {
            *stokes = self.polarise(arrival, connection.direction, &mut lanes);
        }
        if let Some(surface) = interaction.bsdf.model.as_fluorescent()
            && interaction.bsdf.pdf(to_camera, to_light, sides, photon.wavelengths.hero()) > 0.0
        {
            let emitted = emission_into_camera(&surface.fluorophore, photon, emission);
            let filtered =
                |nm: f64| if self.polarised { self.filter_of_natural(connection.direction, nm) } else { 1.0 };
            let emitted = emitted.map(|(nm, radiance)| (nm, radiance * geometry * filtered(nm)));
            lanes[count..count + LANES].copy_from_slice(&emitted);
            count += LANES;
        }
        let any = lanes[..count].iter().any(|(_, radiance)| *radiance > 0.0);
        if !(any && interaction.is_unoccluded(scene, connection.direction, connection.distance, None)) {
            return None;
        }
        if !self.media_plan.is_clear() {
            // A pinhole has one point, so the numbers of the lens would not separate the photons.
            let seed = Seed::of_pixel(u64::from(pixel), interaction.hit.position.to_array());
            let along = self.path_to_camera(interaction, &connection, seed);
            lanes[..count].iter_mut().for_each(|(nm, radiance)| *radiance *= transmittance(&along, *nm));
        }
        Some(Splat { pixel, lanes, count })
    }

    /// Multiplies the radiance of a photon's lanes by the factor of its polarisation, behind the
    /// surface and the filter of the camera. Returns the rest of the Stokes vector of each lane.
    #[inline(never)]
    fn polarise(&self, arrival: &SurfaceArrival<'_>, direction: DVec3, lanes: &mut [(f64, f64)]) -> [[f64; 3]; LANES] {
        let mut stokes = [[0.0; 3]; LANES];
        let to_picture = rotation_to_picture(&self.scene.camera, direction);
        let SurfaceArrival { interaction, photon, .. } = arrival;
        let event = interaction.event_of_photon(direction, false);
        let filter = event_at_camera_filter(&self.scene.camera, direction);
        for (k, (nm, radiance)) in lanes.iter_mut().take(photon.wavelengths.count).enumerate() {
            let scattered = event.matrix(*nm) * photon.polarisation.stokes(k);
            let received = filter.as_ref().map_or(scattered, |filter| filter.matrix(*nm) * scattered);
            let power = received.power().max(0.0);
            *radiance *= power;
            if power > 0.0 {
                let Stokes([_, parts @ ..]) = to_picture * received;
                stokes[k] = parts.map(|part| part / power);
            }
        }
        stokes
    }

    /// Returns the fraction of natural light that passes the filter of the camera.
    fn filter_of_natural(&self, direction: DVec3, nm: f64) -> f64 {
        event_at_camera_filter(&self.scene.camera, direction).map_or(1.0, |filter| filter.matrix(nm).0[0][0])
    }

    /// Returns the film position of a surface point, which may lie beside the film, and the
    /// radiance that the camera sees there at the wavelength `nm` per watt that arrives. Returns
    /// `None` if the camera does not see the point.
    pub(super) fn response(
        &self,
        interaction: &SurfaceInteraction<'_>,
        ray_density: RayDensity,
        nm: f64,
        lens: [f64; 2],
    ) -> Option<(DVec2, f64)> {
        let connection = self.scene.camera.connect_to_plane(interaction.hit.position, lens)?;
        let CameraConnection { film, direction, distance, .. } = connection;
        let to_camera = interaction.frame.to_local(direction);
        let sides = interaction.sides_towards(direction);
        let f = interaction.bsdf.eval(to_camera, interaction.wo, sides, TransportMode::Radiance, nm);
        let response = f * self.geometry(interaction, ray_density, &connection);
        if !(response > 0.0 && interaction.is_unoccluded(self.scene, direction, distance, None)) {
            return None;
        }
        if self.media_plan.is_clear() {
            return Some((film, response));
        }
        let seed = Seed::of_numbers(interaction.hit.position.to_array());
        Some((film, response * transmittance(&self.path_to_camera(interaction, &connection, seed), nm)))
    }

    /// Returns the media between a surface and the camera.
    fn path_to_camera(
        &self,
        interaction: &SurfaceInteraction<'_>,
        connection: &CameraConnection,
        seed: Seed,
    ) -> PathTransmittance<'_> {
        let medium_stack = interaction.medium_stack_towards(connection.direction);
        let ray_state = interaction.spawn_ray(connection.direction, medium_stack);
        path_transmittance(self.scene, ray_state, connection.distance, seed)
    }

    /// Returns the factor of the light that a surface scatters into a connection: its projection,
    /// the importance of the camera, and the weight of this technique.
    fn geometry(
        &self,
        interaction: &SurfaceInteraction<'_>,
        ray_density: RayDensity,
        connection: &CameraConnection,
    ) -> f64 {
        let to_camera = interaction.frame.to_local(connection.direction);
        let geometry = to_camera.z.abs()
            * interaction.adjoint_correction(-interaction.incoming, connection.direction)
            * connection.importance;
        if ray_density == RayDensity::NONE || interaction.bsdf.class() != BsdfClass::Glossy {
            return geometry;
        }
        let pixel_m = self.scene.camera.pixel_width_m(connection.distance);
        let weights = CausticWeights { photons_m2: self.photons_per_sample * pixel_m * pixel_m };
        let sides = interaction.sides_towards(connection.direction);
        let pdf = interaction.bsdf.pdf(to_camera, interaction.wo, sides, REFERENCE_NM);
        geometry * weights.of_photon(ray_density, pdf)
    }
}

/// Returns wavelengths (nm) of the emission that a photon excites, selected by `u` in [0, 1), and
/// the emitted radiance per unit of area, divided by their density.
fn emission_into_camera(fluorophore: &Fluorophore, photon: &PhotonState, u: f64) -> [(f64, f64); LANES] {
    std::array::from_fn(|k| {
        let (to_nm, pdf) = fluorophore.wavelengths().sample((u + k as f64) / LANES as f64);
        let powers = photon.wavelengths.active().iter().zip(photon.power);
        let emitted: f64 = powers.map(|(&nm, power)| power * fluorophore.bispectral_factor(nm, to_nm)).sum();
        (to_nm, emitted * FRAC_1_PI / (pdf * LANES as f64))
    })
}
