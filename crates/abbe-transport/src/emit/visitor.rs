//! The interface between photon tracing and the code that stores or connects photons.

use super::launch::Launch;
use super::photon_path::PhotonState;
use crate::walk::{MediumSegment, NumberedMedium, PathTransmittance, SurfaceInteraction};
use abbe_scene::geometry::Ray;
use abbe_spectra::math::random::{Seed, Stream};
use glam::DVec3;

#[derive(Debug)]
pub struct SurfaceArrival<'a> {
    pub interaction: &'a SurfaceInteraction<'a>,
    /// The photon before the surface scatters it.
    pub photon: &'a PhotonState,
    /// The number of surface events on the path, including this arrival.
    pub depth: u32,
}

/// A straight part of a photon path, uninterrupted by surfaces.
#[derive(Debug)]
pub struct PhotonFlight<'a> {
    pub ray: Ray,
    /// The length in m. It is infinite if the photon leaves the scene.
    pub length_m: f64,
    pub photon: &'a PhotonState,
    /// The media along the flight. `None` if nothing absorbs or scatters.
    pub(super) segment: Option<&'a MediumSegment<'a>>,
}

impl<'a> PhotonFlight<'a> {
    /// Returns the transmittance along the first `length_m` metres.
    pub fn transmittance(&self, length_m: f64) -> PathTransmittance<'a> {
        let Some(segment) = self.segment else { return PathTransmittance::new() };
        // Parallel light has the same length to all points of a plane.
        let [x, y, z] = self.ray.origin.to_array();
        segment.path_transmittance(length_m, Seed::of_numbers([x, y, z, length_m]))
    }
}

/// A photon that enters a path segment in a medium.
#[derive(Debug)]
pub struct MediumCrossing<'a> {
    /// Ends with the medium or at a surface. The photon may collide before.
    pub segment: &'a MediumSegment<'a>,
    pub medium: NumberedMedium<'a>,
    /// The photon at the start of the segment.
    pub photon: &'a PhotonState,
}

#[derive(Debug)]
pub struct MediumCollision<'a> {
    pub position: DVec3,
    /// The photon's direction before the collision, as a unit vector.
    pub incoming: DVec3,
    pub medium: NumberedMedium<'a>,
    /// The photon. Its power is all that the medium scatters here, or that a dye absorbs.
    pub photon: &'a PhotonState,
}

pub trait PhotonVisitor {
    /// Called with the stratum of the path's first ray, and `aim` its point in the aiming grid.
    fn on_emission(&mut self, stratum: usize, aim: [f64; 2]);

    #[inline]
    fn on_start(&mut self, _ray: &Ray, _photon: &PhotonState) {}

    /// Called after [`Self::on_start`] if the photon paints a ribbon.
    fn on_launch(&mut self, _launch: &Launch) {}

    #[inline]
    fn on_arrival(&mut self, _arrival: &SurfaceArrival<'_>) {}

    #[inline]
    fn on_escape(&mut self, _ray: &Ray, _photon: &PhotonState) {}

    /// A photon flies straight to a surface or the end of a medium, in which it may collide.
    #[inline]
    fn on_flight(&mut self, _flight: &PhotonFlight<'_>) {}

    /// A photon arrives at a diffuse or glossy surface, but not straight from a light, because
    /// direct lighting includes this.
    fn on_surface(&mut self, arrival: &SurfaceArrival<'_>, stream: &mut Stream);

    fn on_body_face(&mut self) {}

    fn on_medium_crossing(&mut self, _crossing: &MediumCrossing<'_>, _stream: &mut Stream) {}

    fn on_medium_collision(&mut self, _collision: &MediumCollision<'_>, _stream: &mut Stream) {}
}

impl SurfaceArrival<'_> {
    /// Returns the unit vector back towards the photon's previous vertex.
    #[inline]
    pub fn to_light(&self) -> DVec3 {
        -self.interaction.incoming
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::PhotonDepth;
    use crate::emit::launch::RibbonPart;
    use crate::map::WavelengthCode;
    use crate::plan::partition::LightPath;
    use crate::walk::{NumberedMedium, PhotonPolarisation, RayDensity, transmittance};
    use abbe_format::{self as format, resolve::resolve};
    use abbe_scene::medium::TransmittanceEstimator;
    use abbe_scene::medium_stack::MediumStack;
    use abbe_spectra::spectrum::{LANES, Wavelengths};

    /// Parallel photons travel equally far to a plane. By ratio tracking, each of them arrives with
    /// the probability 1/e or not at all.
    #[test]
    fn parallel_flights_have_positions_of_their_own() {
        let text = r#"{
  "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "media": {"fog": {"homogeneous": {"absorption": 1, "scattering": 0, "phase": "isotropic"}}},
  "materials": {"fog": {"boundary": {"medium": "fog"}}},
  "objects": [{"shape": {"box": {"size": [9, 9, 9]}}, "material": "fog"}],
  "lights": [{"point": {"at": [0, 0, 3], "spectrum": "E", "power": 1}}]
}"#;
        let (written, source) = format::parse(text, "fog.json".as_ref(), &[]).unwrap();
        let mut scene = resolve(&written, &source).unwrap();
        scene.media[0].transmittance = TransmittanceEstimator::Ratio;
        let photon = PhotonState {
            light_path: LightPath::Direct,
            depth: PhotonDepth::Unlimited,
            wavelengths: Wavelengths::single(550.0),
            power: [0.25; LANES],
            wavelength_code: WavelengthCode::default(),
            lane: None,
            ribbon: RibbonPart::Missed,
            excitation: false,
            polarisation: PhotonPolarisation::NATURAL,
            ray_density: RayDensity::NONE,
        };
        let arriving = |number: u32| {
            let ray = Ray { origin: DVec3::new(0.01 * f64::from(number), 0.5, 0.0), direction: DVec3::Z };
            let segment = MediumSegment {
                ray,
                length_m: 1.0,
                medium_stack: MediumStack::AIR,
                medium: Some(NumberedMedium { number: 0, medium: &scene.media[0] }),
                absorption: None,
            };
            let flight = PhotonFlight { ray, length_m: 1.0, photon: &photon, segment: Some(&segment) };
            transmittance(&flight.transmittance(1.0), 550.0)
        };
        let mean = (0..200).map(arriving).sum::<f64>() / 200.0;
        assert!((mean - (-1.0_f64).exp()).abs() < 0.1, "{mean}");
    }
}
