//! The throughput of a camera path, as a function of wavelength.

use crate::plan::partition::PhotonSet;
use crate::walk::{RayState, SegmentTransmittance};
use abbe_optics::bsdf::{Bsdf, BsdfSample, InterfaceIors, LocalBsdf, TransportMode};
use abbe_polarisation::{Mueller, Rotation, ScatteringEvent, Stokes};
use abbe_scene::Scene;
use abbe_scene::light::Light;
use abbe_scene::medium_stack::MediumStack;
use abbe_spectra::spectrum::LANES;
use glam::DVec3;

/// The factor by which one event changes the radiance of a camera path.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) enum Factor<'a> {
    Scattering {
        bsdf: LocalBsdf<'a>,
        wo: DVec3,
        sample: BsdfSample,
        sides: InterfaceIors<'a>,
        /// The probability (or density) of the selected direction.
        probability: f64,
    },
    /// Transmittance of glass, liquid or fog.
    SegmentTransmittance(SegmentTransmittance<'a>),
    Grey(f64),
}

impl Factor<'_> {
    /// Returns true if the factor is the same at all wavelengths.
    pub(in crate::gather) fn is_grey(&self) -> bool {
        match self {
            Factor::Scattering { bsdf, sides, .. } => {
                matches!(bsdf.model, Bsdf::Dielectric(_)) && !sides.is_dispersive()
            }
            Factor::SegmentTransmittance(_) => false,
            Factor::Grey(_) => true,
        }
    }

    pub(in crate::gather) fn at(&self, nm: f64) -> f64 {
        match self {
            Factor::Scattering { bsdf, wo, sample, sides, probability } => {
                bsdf.eval_sample(*wo, sample, *sides, TransportMode::Radiance, nm) / probability
            }
            Factor::SegmentTransmittance(segment) => segment.at(nm),
            Factor::Grey(value) => *value,
        }
    }
}

/// All factors of a camera path.
#[derive(Debug, Default)]
pub(in crate::gather) struct PathFactors<'a> {
    /// The factors for natural light. Those behind a dispersive event belong to the throughput of the
    /// path.
    pub(in crate::gather) natural: Vec<Factor<'a>>,
    /// The events that polarise light, from the camera on. Empty unless the plan contains
    /// polarisation.
    pub(in crate::gather) events: Vec<ScatteringEvent<'a>>,
    /// True if the plan contains polarisation.
    pub(in crate::gather) polarised: bool,
    /// From the canonical frame at the camera to that of the picture, if the film records Stokes
    /// vectors.
    pub(in crate::gather) to_picture: Option<Rotation>,
}

impl PathFactors<'_> {
    /// Removes the factors of the last path.
    pub(in crate::gather) fn start_path(&mut self, polarised: bool) {
        self.return_to([0; 2]);
        (self.polarised, self.to_picture) = (polarised, None);
    }

    /// Returns the numbers of factors and of events, for [`Self::return_to`].
    #[inline(always)]
    pub(in crate::gather) fn length(&self) -> [usize; 2] {
        [self.natural.len(), self.events.len()]
    }

    /// Removes what was added to the path since it had this length.
    #[inline(always)]
    pub(in crate::gather) fn return_to(&mut self, [natural, events]: [usize; 2]) {
        self.natural.truncate(natural);
        self.events.truncate(events);
    }

    /// Returns the matrix of everything between the end of the path and the camera.
    #[inline(never)]
    pub(in crate::gather) fn matrix(&self, nm: f64) -> Mueller {
        self.events.iter().fold(Mueller::IDENTITY, |matrix, event| matrix * event.matrix(nm))
    }

    /// Returns the response of the camera to light at the end of the path, for a power of 1.
    pub(in crate::gather) fn response(&self, nm: f64) -> Stokes {
        let Mueller([response, ..]) = self.matrix(nm);
        let scale = if response[0] > 0.0 { response[0].recip() } else { 0.0 };
        Stokes(response.map(|part| part * scale))
    }

    /// Returns the fraction of natural light that the events transmit to the camera, relative to
    /// the other factors.
    #[inline(always)]
    pub(in crate::gather) fn of_natural_light(&self, nm: f64) -> f64 {
        if self.events.is_empty() { 1.0 } else { self.matrix(nm).0[0][0].max(0.0) }
    }
}

#[inline]
pub(in crate::gather) fn product(factors: &[Factor<'_>], nm: f64) -> f64 {
    factors.iter().map(|factor| factor.at(nm)).product()
}

/// Returns (n/n₀)² for the refractive indices at the path's position and at the camera, by which
/// refraction multiplies radiance: radiance/n² stays constant.
pub(in crate::gather) fn relative_n2(scene: &Scene, ray_state: &RayState, nm: f64) -> f64 {
    let n = |medium_stack: &MediumStack| scene.index_in(medium_stack).n(nm);
    (n(&ray_state.medium_stack) / n(&scene.camera.medium_stack)).powi(2)
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::gather) enum SpectralMode {
    /// Without a fixed wavelength: the throughput is the product of the path's factors.
    Free,
    /// The path carries one of the pass's shared wavelengths.
    Shared {
        lane: usize,
        nm: f64,
        /// The throughput, divided by the probability density of the wavelength.
        throughput: f64,
    },
}

impl SpectralMode {
    pub(in crate::gather) fn photon_set(self) -> PhotonSet {
        match self {
            SpectralMode::Free => PhotonSet::Free,
            SpectralMode::Shared { .. } => PhotonSet::Shared,
        }
    }
}

/// Calls `f` with each wavelength (nm) and the throughput of natural light, divided by the density of the
/// wavelength. A free path samples stratified wavelengths from the light's spectrum, shifted by `u`
/// in [0, 1). A shared path has one.
#[inline(always)]
pub(in crate::gather) fn each_wavelength(
    spectral_mode: SpectralMode,
    factors: &PathFactors<'_>,
    light: &Light,
    u: f64,
    mut f: impl FnMut(f64, f64),
) {
    match spectral_mode {
        SpectralMode::Free => {
            for k in 0..LANES {
                let (nm, pdf) = light.wavelengths.sample((u + k as f64) / LANES as f64);
                f(nm, product(&factors.natural, nm) * factors.of_natural_light(nm) / (pdf * LANES as f64));
            }
        }
        SpectralMode::Shared { nm, throughput, .. } => f(nm, throughput * factors.of_natural_light(nm)),
    }
}
