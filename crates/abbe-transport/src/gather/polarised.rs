//! Polarised light that camera paths gather.
//!
//! Where natural light arrives at the end of a path, the throughput of the path contains the
//! fraction that reaches the camera, and [`PathFactors::received`] corrects it for a surface or a
//! medium that polarises the light before. A photon brings its Stokes vector along, so its light
//! is the product of all matrices with this vector.

use super::camera::throughput::{PathFactors, SpectralMode, product};
use super::density::photon_light::{PhotonLight, biased_by};
use crate::map::StoredPolarisation;
use crate::map::kernel::KernelValues;
use crate::plan::LightOrigin;
use crate::walk::{Sink, SurfaceInteraction};
use abbe_polarisation::{ScatteringEvent, Stokes};
use abbe_scene::medium::Medium;
use abbe_spectra::spectrum::LANES;
use glam::DVec3;

impl<'a> PathFactors<'a> {
    /// Returns the event at a surface that scatters natural light from `direction` into the path,
    /// or `None` if it makes no difference to the picture.
    #[inline(always)]
    pub(in crate::gather) fn event_at(
        &self,
        interaction: &SurfaceInteraction<'a>,
        direction: DVec3,
    ) -> Option<ScatteringEvent<'a>> {
        self.depends_on_polarisation().then(|| interaction.event_of_camera(direction, false))
    }

    /// Returns the event in a medium that scatters natural light into the path, or `None`. The
    /// directions are those of the arriving and of the leaving light.
    #[inline(always)]
    pub(in crate::gather) fn event_in_medium(
        &self,
        medium: &'a Medium,
        [arriving, leaving]: [DVec3; 2],
    ) -> Option<ScatteringEvent<'a>> {
        self.depends_on_polarisation().then(|| ScatteringEvent::in_medium(&medium.phase, arriving, leaving))
    }

    /// Returns true if the picture depends on the polarisation of light at the end of the path.
    #[inline(always)]
    pub(in crate::gather) fn depends_on_polarisation(&self) -> bool {
        !self.events.is_empty() || self.to_picture.is_some()
    }

    /// Returns what the camera receives of natural light that an event scatters into the path, for a
    /// throughput of 1. Without an event, the light arrives at the end of the path as it is.
    #[inline(never)]
    pub(in crate::gather) fn received(&self, nm: f64, event: Option<&ScatteringEvent<'_>>) -> Stokes {
        let (matrix, natural) = (self.matrix(nm), Stokes::unpolarised(1.0));
        let light = matrix * event.map_or(natural, |event| event.matrix(nm) * natural);
        let throughput = matrix.0[0][0];
        if throughput > 0.0 { light * throughput.recip() } else { Stokes::default() }
    }

    /// Adds a `weight` of natural light with its relative bias, which an event scatters into the
    /// path, or which arrives at the end of the path as it is.
    #[inline(always)]
    pub(in crate::gather) fn deliver<S: Sink>(
        &self,
        (origin, nm): (LightOrigin, f64),
        (weight, bias): (f64, f64),
        event: Option<&ScatteringEvent<'_>>,
        sink: &mut S,
    ) {
        if self.depends_on_polarisation() {
            self.deliver_polarised((origin, nm), (weight, bias), event, sink);
        } else {
            sink.biased(origin, nm, weight, weight * bias);
        }
    }

    #[inline(never)]
    fn deliver_polarised<S: Sink>(
        &self,
        (origin, nm): (LightOrigin, f64),
        (weight, bias): (f64, f64),
        event: Option<&ScatteringEvent<'_>>,
        sink: &mut S,
    ) {
        let received = self.received(nm, event);
        let radiance = weight * received.power().max(0.0);
        sink.biased(origin, nm, radiance, radiance * bias);
        self.deliver_stokes(nm, weight, &received, sink);
    }

    #[inline(always)]
    pub(in crate::gather) fn deliver_stokes<S: Sink>(&self, nm: f64, weight: f64, received: &Stokes, sink: &mut S) {
        if let Some(to_picture) = self.to_picture {
            let Stokes([_, stokes @ ..]) = to_picture * *received;
            sink.stokes(nm, stokes.map(|part| weight * part));
        }
    }
}

/// The polarisation of a photon, and the event that scatters its light into a camera path.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct PolarisedPhoton<'p, 'a> {
    pub(in crate::gather) polarisation: &'p StoredPolarisation,
    pub(in crate::gather) event: ScatteringEvent<'a>,
}

impl PolarisedPhoton<'_, '_> {
    /// Returns what the camera receives of the photon, for a power of 1 and a throughput of 1
    /// without polarising events.
    fn received(&self, factors: &PathFactors<'_>, lane: usize, nm: f64) -> Stokes {
        factors.matrix(nm) * (self.event.matrix(nm) * self.polarisation.stokes(lane))
    }
}

/// Adds a photon with its polarisation; see [`super::density::photon_light::add_photon`].
pub(in crate::gather) fn add_polarised_photon<S: Sink>(
    PhotonLight { power, spectra, class }: PhotonLight<'_>,
    photon: &PolarisedPhoton<'_, '_>,
    kernels: KernelValues,
    path_bias: f64,
    (spectral_mode, factors): (SpectralMode, &PathFactors<'_>),
    sink: &mut S,
    response: impl Fn(f64) -> f64,
) {
    let (estimate, bias) = (kernels.estimate, biased_by(kernels, path_bias));
    let origin = LightOrigin { class, light: spectra.light_of(power.wavelength_code()) };
    let mut add = |nm: f64, weight: f64, received: Stokes| {
        let radiance = weight * received.power().max(0.0);
        sink.biased(origin, nm, radiance * estimate, radiance * bias);
        factors.deliver_stokes(nm, weight * estimate, &received, sink);
    };
    match spectral_mode {
        SpectralMode::Free => {
            let powers = power.powers();
            for lane in (0..LANES).filter(|&lane| powers[lane] > 0.0) {
                let nm = spectra.wavelength(power.wavelength_code(), lane);
                let weight = response(nm) * product(&factors.natural, nm) * f64::from(powers[lane]);
                add(nm, weight, photon.received(factors, lane, nm));
            }
        }
        SpectralMode::Shared { lane, nm, throughput } => {
            if let Some(power) = power.at_lane(lane) {
                add(nm, response(nm) * throughput * power, photon.received(factors, lane, nm));
            }
        }
    }
}
