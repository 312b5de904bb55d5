//! A photon path and its state.

use super::launch::RibbonPart;
use crate::map::WavelengthCode;
use crate::plan::partition::LightPath;
use crate::walk::ledger::Ledger;
use crate::walk::{PhotonPolarisation, RayDensity, RayState, ScatteredRay, SurfaceInteraction};
use abbe_optics::bsdf::TransportMode;
use abbe_polarisation::ScatteringEvent;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::{BAND_NM, LANES, Lanes, Wavelengths};

#[derive(Debug, Clone, Copy)]
pub struct PhotonState {
    pub light_path: LightPath,
    pub depth: PhotonDepth,
    pub wavelengths: Wavelengths,
    /// The power at each wavelength. The unit is W for free photons, and W/nm for shared photons.
    pub power: Lanes,
    /// The code with which the map stores the wavelengths of a free photon, the same all along.
    pub wavelength_code: WavelengthCode,
    /// The lane that a dispersive refraction left: the index of the wavelength for shared photons.
    pub lane: Option<usize>,
    /// The relation of the path to the ribbon of the same emission.
    pub ribbon: RibbonPart,
    /// True for a photon of the shared set with wavelengths of its own, which serves only to excite
    /// fluorophores and is not recorded.
    pub excitation: bool,
    /// The polarisation in the canonical frame of the direction. It is natural light unless the plan
    /// contains polarisation.
    pub polarisation: PhotonPolarisation,
    /// The density of the light's rays around the photon's first ray, or 0 if the plan does not
    /// compare photons with camera paths (see [`crate::walk::CausticWeights`]).
    pub ray_density: RayDensity,
}

/// The number of surface events on a photon path so far, which only scenes with an explicit depth
/// limit need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhotonDepth {
    /// The scene sets no limit.
    Unlimited,
    Within(u16),
    /// Beyond the limit, the photon contributes only to the estimated bias.
    Beyond(u16),
}

impl PhotonState {
    /// Returns true beyond the depth limit.
    #[inline]
    pub fn is_truncated(&self) -> bool {
        matches!(self.depth, PhotonDepth::Beyond(_))
    }
}

pub(super) struct PhotonPath {
    pub(super) ray_state: RayState,
    pub(super) photon: PhotonState,
    /// True if the plan contains polarisation.
    pub(super) polarised: bool,
    /// For each lane: the factor that converts `PhotonState::power` to W.
    pub(super) watts: Lanes,
}

impl PhotonPath {
    /// Returns the power of all wavelengths together, in W.
    #[inline]
    pub(super) fn total_w(&self) -> f64 {
        // Lanes that are not in use hold no power.
        (0..LANES).map(|k| self.photon.power[k] * self.watts[k]).sum()
    }

    /// Returns the power of the wavelengths below the band, in W.
    #[cold]
    pub(super) fn ultraviolet_w(&self) -> f64 {
        let below = (0..LANES).filter(|&k| self.photon.wavelengths.nm[k] < BAND_NM.0);
        below.map(|k| self.photon.power[k] * self.watts[k]).sum()
    }

    /// Books the power of a photon whose path ends at the depth limit.
    pub(super) fn book_at_limit(&self, ledger: &mut Ledger) {
        ledger.depth_limit += self.total_w();
        if self.photon.light_path == LightPath::Indirect {
            ledger.depth_limit_indirect += self.total_w();
        }
    }

    #[inline]
    pub(super) fn multiply_power(&mut self, factor: f64) {
        self.photon.power.iter_mut().for_each(|power| *power *= factor);
    }

    #[inline]
    pub(super) fn divide_power(&mut self, divisor: f64) {
        self.photon.power.iter_mut().for_each(|power| *power /= divisor);
    }

    pub(super) fn keep_lane(&mut self, lane: usize) {
        self.photon.lane = Some(lane);
        self.photon.wavelengths = Wavelengths::single(self.photon.wavelengths.nm[lane]);
        let only = |lanes: Lanes| std::array::from_fn(|k| if k == 0 { lanes[lane] } else { 0.0 });
        self.photon.power = only(self.photon.power);
        self.watts = only(self.watts);
        self.photon.polarisation.keep_lane(lane);
    }

    /// Corrects the weights of a surface event by the polarisation of the photon, and polarises it.
    #[inline(never)]
    pub(super) fn polarise(&mut self, interaction: &SurfaceInteraction<'_>, scattered: &mut ScatteredRay) {
        let event = interaction.event_of(scattered, &self.photon.wavelengths, TransportMode::Importance);
        let factors = self.photon.polarisation.scatter(&event, &self.photon.wavelengths);
        for (k, factor) in factors.into_iter().enumerate() {
            // In the mean, the surface absorbs what it does not scatter.
            scattered.absorbed[k] += scattered.weight[k] * (1.0 - factor);
            scattered.weight[k] *= factor;
        }
    }

    /// Polarises the photon by an event in a medium.
    #[inline(never)]
    pub(super) fn polarise_in_medium(&mut self, event: &ScatteringEvent<'_>) {
        let factors = self.photon.polarisation.scatter(event, &self.photon.wavelengths);
        (0..LANES).for_each(|k| self.photon.power[k] *= factors[k]);
    }

    pub(super) fn power_fractions(&self) -> Lanes {
        let total = self.total_w();
        std::array::from_fn(|k| if total > 0.0 { self.photon.power[k] * self.watts[k] / total } else { 0.0 })
    }

    /// Selects the hero: one of the wavelengths, in proportion to its fraction of the power.
    pub(super) fn sample_hero(&self, fractions: &Lanes, stream: &mut Stream) -> usize {
        let mut left = stream.uniform();
        let last = self.photon.wavelengths.count - 1;
        (0..last)
            .find(|&k| {
                left -= fractions[k];
                left < 0.0
            })
            .unwrap_or_else(|| (0..=last).rev().find(|&k| fractions[k] > 0.0).unwrap_or(last))
    }

    /// Weights each wavelength by its density of the sampled event, divided by the mean density.
    /// The weights of this mean are `fractions`, the probabilities with which the wavelengths
    /// become the hero.
    pub(super) fn weight_by_balance_heuristic(&mut self, fractions: &Lanes, pdf: &Lanes) {
        let mean: f64 = fractions.iter().zip(pdf).map(|(fraction, pdf)| fraction * pdf).sum();
        for k in 0..LANES {
            self.photon.power[k] *= if fractions[k] > 0.0 && mean > 0.0 { pdf[k] / mean } else { 0.0 };
        }
    }
}
