//! Light that fluorophores emit into camera paths.
//!
//! The excitation of a fluorophore at a point is the sum of irradiance × a(λ) × λ over all
//! wavelengths of the arriving light. The emitted radiance at a wavelength is the excitation times
//! a function of this wavelength alone. The wavelengths of the arriving light and of the camera
//! path therefore need no relation.

use super::camera::path::CameraPath;
use super::camera::throughput::{SpectralMode, product};
use super::camera_pass::{CameraPass, PathContext};
use super::direct::lighting::LightSample;
use crate::map::PhotonSpectra;
use crate::optics::bsdf::Fluorescent;
use crate::plan::LightOrigin;
use crate::scene::light::{EmittedSpd, Light};
use crate::spectrum::{LANES, Wavelengths};
use crate::walk::{SegmentTransmittance, Sink, SurfaceInteraction, transmittance};

/// The emission of a fluorophore into a camera path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Luminescence<'a> {
    surface: &'a Fluorescent,
    /// The wavelengths at which the camera path sees the emission, and their weights: the radiance
    /// for an excitation of 1 W·nm/m², multiplied by the throughput and divided by the density of
    /// the wavelength.
    seen: [(f64, f64); LANES],
    /// The number of entries of `seen` that are in use.
    count: usize,
}

/// A sample of light that excites a fluorophore.
pub(super) struct ExcitingLight<'s> {
    /// The number of the light.
    pub(super) number: usize,
    pub(super) light: &'s Light,
    pub(super) spd: EmittedSpd,
    /// The irradiance divided by the spectrum of the light, without attenuation.
    pub(super) irradiance: f64,
    /// The transmittance between the light and the surface.
    pub(super) along: &'s [SegmentTransmittance<'s>],
}

impl<'s> ExcitingLight<'s> {
    /// Returns the light of a sample of the light with the number `number`.
    pub(super) fn of_sample(number: usize, sample: &LightSample<'s>, along: &'s [SegmentTransmittance<'s>]) -> Self {
        Self { number, light: sample.light, spd: sample.spd, irradiance: sample.strength, along }
    }
}

impl<'a> Luminescence<'a> {
    /// Returns the emission into a path that sees the wavelengths `nm` with these weights. The
    /// weights contain the throughput and the density of the wavelengths.
    pub(super) fn at_wavelengths(surface: &'a Fluorescent, wavelengths: &Wavelengths, weights: &[f64; LANES]) -> Self {
        let weight = |k: usize| weights[k] * surface.emitted_radiance(wavelengths.nm[k]);
        let seen =
            std::array::from_fn(|k| if k < wavelengths.count { (wavelengths.nm[k], weight(k)) } else { (0.0, 0.0) });
        Self { surface, seen, count: wavelengths.count }
    }

    /// Returns the same emission, seen at other wavelengths (nm): those at which the camera sees
    /// the light.
    pub(super) fn observed_at(self, observed: &[f64; LANES]) -> Self {
        let seen = std::array::from_fn(|k| (observed[k], self.seen[k].1));
        Self { seen, ..self }
    }

    /// Returns the excitation by a sample of light, in W·nm/m². The excitation is estimated at
    /// stratified wavelengths that the fluorophore absorbs. `u` in [0, 1) shifts these wavelengths.
    pub(super) fn excitation(&self, sample: &ExcitingLight<'_>, spectra: &PhotonSpectra, u: f64) -> f64 {
        let ExcitingLight { number, light, spd, irradiance, along } = *sample;
        let Some(wavelengths) = spectra.excitation(number, self.surface.number) else { return 0.0 };
        let at = |k: usize| {
            let (nm, pdf) = wavelengths.sample((u + k as f64) / LANES as f64);
            light.spd_at(spd, nm) * self.surface.fluorophore.excitation(nm) * transmittance(along, nm)
                / (pdf * LANES as f64)
        };
        irradiance * (0..LANES).map(at).sum::<f64>()
    }

    /// Returns the excitation by a photon per unit of power, in nm.
    #[inline]
    pub(super) fn excitation_at(&self, nm: f64) -> f64 {
        self.surface.fluorophore.excitation(nm)
    }

    /// Adds the radiance that an excitation causes. `bias` is the bias of the excitation. Both are
    /// in W·nm/m².
    pub(super) fn add<S: Sink>(&self, origin: LightOrigin, excitation: f64, bias: f64, sink: &mut S) {
        for &(nm, weight) in &self.seen[..self.count] {
            sink.biased(origin, nm, weight * excitation, weight * bias);
        }
    }
}

impl<'a> CameraPass<'a> {
    /// Returns the emission of the surface into a path. Returns `None` if the surface is not
    /// fluorescent. A free path samples wavelengths from the emission. A shared path sees its own
    /// wavelength.
    #[inline(always)]
    pub(super) fn luminescence<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) -> Option<Luminescence<'a>> {
        interaction.bsdf.model.as_fluorescent().map(|surface| luminescence_of(surface, *path, context))
    }
}

/// Returns the emission of a fluorescent surface into a path.
#[inline(never)]
fn luminescence_of<'a, S: Sink>(
    surface: &'a Fluorescent,
    path: CameraPath,
    context: &mut PathContext<'_, '_, S>,
) -> Luminescence<'a> {
    context.tally.fluorescent_events += 1;
    match path.spectral_mode {
        SpectralMode::Free => {
            let u = context.sampler.stream.uniform();
            let sampled: [(f64, f64); LANES] =
                std::array::from_fn(|k| surface.fluorophore.wavelengths().sample((u + k as f64) / LANES as f64));
            let factors = &context.buffers.factors;
            let weights = sampled.map(|(nm, pdf)| product(factors, nm) / (pdf * LANES as f64));
            Luminescence::at_wavelengths(surface, &Wavelengths::new(sampled.map(|(nm, _)| nm)), &weights)
        }
        SpectralMode::Shared { nm, throughput, .. } => {
            Luminescence::at_wavelengths(surface, &Wavelengths::single(nm), &[throughput, 0.0, 0.0, 0.0])
        }
    }
}
