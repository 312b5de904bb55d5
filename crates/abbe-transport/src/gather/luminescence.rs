//! Light that fluorophores emit into camera paths.
//!
//! The excitation of an emission at a point is the sum of irradiance × a(λ) × λ over all
//! wavelengths of the arriving light. The emitted radiance is the excitation times a function of
//! its own wavelength alone, so the wavelengths of the arriving light and of the camera path need
//! no relation.

use super::camera::path::CameraPath;
use super::camera::throughput::{SpectralMode, product};
use super::camera_pass::{CameraPass, PathContext};
use super::direct::lighting::LightSample;
use crate::map::PhotonSpectra;
use crate::plan::LightOrigin;
use crate::walk::{SegmentTransmittance, Sink, SurfaceInteraction, pane_matrix, transmittance};
use abbe_optics::bsdf::Fluorescent;
use abbe_optics::fluorophore::Fluorophore;
use abbe_scene::light::{EmittedSpd, Light};
use abbe_scene::medium::Medium;
use abbe_spectra::spectrum::{LANES, Lanes, Wavelengths};
use std::f64::consts::FRAC_1_PI;

#[derive(Debug, Clone, Copy)]
pub(super) struct Luminescence<'a> {
    fluorophore: &'a Fluorophore,
    wavelengths: Wavelengths,
    /// The wavelengths at which the camera sees these wavelengths, in nm.
    observed: Lanes,
    /// The throughput divided by the density of the wavelengths and by π, or 4π in a medium.
    weights: Lanes,
    /// The radiance of the first emission for an excitation of 1 W·nm/m².
    first: Lanes,
}

pub(super) struct ExcitingLight<'s> {
    pub(super) number: usize,
    pub(super) light: &'s Light,
    pub(super) spd: EmittedSpd,
    /// Irradiance (fluence in a medium) divided by the light's spectrum, without attenuation.
    pub(super) irradiance: f64,
    pub(super) along: &'s [SegmentTransmittance<'s>],
}

impl<'s> ExcitingLight<'s> {
    pub(super) fn of_sample(number: usize, sample: &LightSample<'s>, along: &'s [SegmentTransmittance<'s>]) -> Self {
        Self { number, light: sample.light, spd: sample.spd, irradiance: sample.strength, along }
    }
}

impl<'a> Luminescence<'a> {
    /// Returns the emission of a surface at these wavelengths. The weights contain the throughput
    /// and the density of the wavelengths.
    pub(super) fn of_surface(surface: &'a Fluorescent, wavelengths: &Wavelengths, weights: &Lanes) -> Self {
        Self::new(&surface.fluorophore, wavelengths, &weights.map(|weight| weight * FRAC_1_PI))
    }

    fn new(fluorophore: &'a Fluorophore, wavelengths: &Wavelengths, weights: &Lanes) -> Self {
        let emitted = wavelengths.each(|nm| fluorophore.emissions()[0].emitted(nm));
        let first = std::array::from_fn(|k| emitted[k] * weights[k]);
        Self { fluorophore, wavelengths: *wavelengths, observed: wavelengths.nm, weights: *weights, first }
    }

    /// Returns the same emission, seen at other wavelengths (nm).
    pub(super) fn observed_at(self, observed: &Lanes) -> Self {
        Self { observed: *observed, ..self }
    }

    /// Returns the radiance that a sample of light excites at each wavelength of the path, by
    /// stratified wavelengths that the fluorophore absorbs, shifted by `u` in [0, 1).
    pub(super) fn excited_radiance(&self, sample: &ExcitingLight<'_>, spectra: &PhotonSpectra, u: f64) -> Lanes {
        let ExcitingLight { number, light, spd, irradiance, along } = *sample;
        let mut radiance = [0.0; LANES];
        let Some(wavelengths) = spectra.excitation(number, self.fluorophore.number) else { return radiance };
        for k in 0..LANES {
            let (nm, pdf) = wavelengths.sample((u + k as f64) / LANES as f64);
            let arriving =
                irradiance * light.spd_at(spd, nm) * transmittance(along, nm) * pane_matrix(along, nm).0[0][0];
            self.excite(nm, arriving / (pdf * LANES as f64), &mut radiance);
        }
        radiance
    }

    /// Adds the radiance that light of the wavelength `nm` excites. `irradiance` is in W/m².
    #[inline]
    pub(super) fn excite(&self, nm: f64, irradiance: f64, radiance: &mut Lanes) {
        for i in self.fluorophore.excited_by(nm) {
            let emission = &self.fluorophore.emissions()[i];
            let excitation = irradiance * emission.excitation(nm);
            for (k, radiance) in radiance.iter_mut().enumerate().take(self.wavelengths.count) {
                let per_excitation =
                    if i == 0 { self.first[k] } else { emission.emitted(self.wavelengths.nm[k]) * self.weights[k] };
                *radiance += excitation * per_excitation;
            }
        }
    }

    pub(super) fn attenuate(&self, along: &[SegmentTransmittance<'_>], radiance: &mut Lanes) {
        for (k, &nm) in self.wavelengths.active().iter().enumerate() {
            radiance[k] *= transmittance(along, nm);
        }
    }

    /// Adds an estimate of the radiance and of its bias. Both are given as factors of `radiance`.
    pub(super) fn add<S: Sink>(
        &self,
        origin: LightOrigin,
        radiance: &Lanes,
        (estimate, bias): (f64, f64),
        sink: &mut S,
    ) {
        for (k, radiance) in radiance.iter().enumerate().take(self.wavelengths.count) {
            sink.biased(origin, self.observed[k], radiance * estimate, radiance * bias);
        }
    }
}

impl<'a> CameraPass<'a> {
    /// Returns the emission of a fluorescent surface into a path: at wavelengths from the emission
    /// for a free path, and at its own wavelength for a shared path.
    #[inline(always)]
    pub(super) fn luminescence<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<Luminescence<'a>> {
        let surface = interaction.bsdf.model.as_fluorescent()?;
        Some(luminescence_of(&surface.fluorophore, FRAC_1_PI, *path, context))
    }

    /// Returns the emission of a fluorescent medium into a path, per unit of length.
    #[inline(always)]
    pub(super) fn luminescence_of_medium<S: Sink>(
        &self,
        path: &CameraPath,
        medium: &'a Medium,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<Luminescence<'a>> {
        medium.fluorophore.as_deref().map(|dye| luminescence_of(dye, 0.25 * FRAC_1_PI, *path, context))
    }
}

/// `per_sr` is the fraction of the emission per projected solid angle, or solid angle in media.
#[inline(never)]
fn luminescence_of<'a, S: Sink>(
    fluorophore: &'a Fluorophore,
    per_sr: f64,
    path: CameraPath,
    context: &mut PathContext<'_, '_, S>,
) -> Luminescence<'a> {
    context.tally.fluorescent_events += 1;
    match path.spectral_mode {
        SpectralMode::Free => {
            let u = context.sampler.stream.uniform();
            let sampled: [(f64, f64); LANES] =
                std::array::from_fn(|k| fluorophore.wavelengths().sample((u + k as f64) / LANES as f64));
            let factors = &context.buffers.factors;
            let throughput = |nm| product(&factors.natural, nm) * factors.of_natural_light(nm);
            let weights = sampled.map(|(nm, pdf)| per_sr * throughput(nm) / (pdf * LANES as f64));
            Luminescence::new(fluorophore, &Wavelengths::new(sampled.map(|(nm, _)| nm)), &weights)
        }
        SpectralMode::Shared { nm, throughput, .. } => {
            let weight = per_sr * throughput * context.buffers.factors.of_natural_light(nm);
            Luminescence::new(fluorophore, &Wavelengths::single(nm), &[weight, 0.0, 0.0, 0.0])
        }
    }
}
