//! The emission of a set of photons.

use super::launch::{Launch, RibbonPart};
use super::photon_path::{PhotonDepth, PhotonPath, PhotonState};
use super::strata::EmissionStrata;
use super::visitor::PhotonVisitor;
use crate::map::PhotonSpectra;
use crate::plan::MediumPlan;
use crate::plan::partition::LightPath;
use crate::walk::{BodyMode, PhotonPolarisation, RayDensities, RayDensity, RayState, StopFlag};
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::light::{LeRandoms, LeSample, Light};
use abbe_spectra::math::random::{Stream, StreamKey};
use abbe_spectra::math::sobol::Sobol;
use abbe_spectra::spectrum::{LANES, Lanes, Wavelengths};

/// The fraction of the photons of the shared set that are excitation photons.
const EXCITATION_FRACTION: f64 = 0.5;

#[derive(Debug, Clone, Copy)]
pub enum WavelengthSampling {
    /// Each photon samples its own, by the spectrum of its light and the observer's sensitivity.
    Free,
    Shared {
        nm: Lanes,
        /// The density of each wavelength, per nm.
        pdf: Lanes,
    },
}

/// The inputs common to all photons of one set.
#[derive(Debug)]
pub struct PhotonSource<'a> {
    pub scene: &'a Scene,
    pub strata: &'a EmissionStrata,
    pub spectra: &'a PhotonSpectra,
    /// The densities of the emitted rays. `None` if no photon competes with camera paths.
    pub ray_densities: Option<&'a RayDensities>,
    pub wavelengths: WavelengthSampling,
    pub fluorescent: bool,
    /// True if photons carry their polarisation.
    pub polarised: bool,
    /// One of this many photons paints a ribbon. 0 if there are no ribbons.
    pub photons_per_ribbon: u64,
    pub count: u64,
    /// The streams of the set in a pass, one per path.
    pub streams: StreamKey,
    pub media_plan: MediumPlan,
    /// No further photon is emitted after it is raised.
    pub stop: &'a StopFlag,
}

impl PhotonSource<'_> {
    /// Returns the set's low-discrepancy points. The points are scrambled differently in each pass.
    pub fn points(&self) -> Sobol {
        Sobol::of(self.streams)
    }

    pub(super) fn stream(&self, index: u64) -> Stream {
        self.streams.path(index)
    }

    /// Emits the photon with this index and reports its emission to the visitor.
    #[inline(always)]
    pub(super) fn emit<M: BodyMode>(
        &self,
        points: &Sobol,
        index: u32,
        stream: &mut Stream,
        visitor: &mut impl PhotonVisitor,
    ) -> (PhotonPath, Launch) {
        let mixed = self.has_excitation_photons();
        let excitation = mixed && stream.uniform() < EXCITATION_FRACTION;
        let u = points.point(index);
        let mut u_light = u[1];
        let number = self.strata.choice.sample(&mut u_light);
        let stratum = &self.strata.list[number];
        let light = &self.scene.lights[stratum.light];
        let (aim, relative_pdf) = stratum.aim.sample([u[2], u[3]]);
        visitor.on_emission(number, aim);
        let randoms = LeRandoms { aim, rest: [u[4], u[5], u[6]] };
        let emission = self.strata.sample_le(stratum, light, self.scene.extent(), randoms);
        let (wavelengths, power_of_watt) = self.sample_wavelengths(light, &emission, excitation, u[0]);
        let mut flux = emission.flux_w / (self.count as f64 * self.strata.choice.probability(number) * relative_pdf);
        if mixed {
            flux /= if excitation { EXCITATION_FRACTION } else { 1.0 - EXCITATION_FRACTION };
        }
        let ray = Ray { origin: emission.origin, direction: emission.direction };
        let medium_stack = M::initial_medium_stack(|| self.scene.medium_stack_of_emission(light, ray, emission.from));
        let ray_state = RayState { ray, from: emission.from, medium_stack };
        let wavelength_code = self.spectra.code(stratum.light, u[0]);
        let ray_density = self
            .ray_densities
            .map_or(RayDensity::NONE, |densities| densities.of_stratum(number, light.radiance_of(&emission)));
        let launch = Launch {
            light: stratum.light,
            spd: emission.spd,
            flux_w: flux,
            ray_state,
            ray_density,
            wavelength_code,
            streams: self.streams.second_sequence().part(u64::from(index)),
            hero_nm: wavelengths.hero(),
        };
        let photon = PhotonState {
            light_path: if light.is_ray_set() { LightPath::Caustic } else { LightPath::Direct },
            depth: PhotonDepth::Unlimited,
            wavelengths,
            power: power_of_watt.map(|s| s * flux),
            wavelength_code,
            lane: None,
            ribbon: if self.has_ribbons() { RibbonPart::Ahead } else { RibbonPart::Missed },
            excitation,
            polarisation: PhotonPolarisation::NATURAL,
            ray_density,
        };
        (PhotonPath { ray_state, photon, polarised: self.polarised, watts: self.watts(excitation) }, launch)
    }

    pub(super) fn has_ribbons(&self) -> bool {
        self.photons_per_ribbon > 0
    }

    /// Returns the factor of the flux of a photon's ribbon, or `None` if it has none. Whole blocks
    /// of photons have ribbons, because low-discrepancy points are well distributed in each block.
    pub(super) fn ribbon_factor(&self, index: u64) -> Option<f64> {
        const BLOCK: u64 = 64;
        let blocks = BLOCK * self.photons_per_ribbon;
        if blocks == 0 || index % blocks >= BLOCK {
            return None;
        }
        let with_ribbons = self.count / blocks * BLOCK + (self.count % blocks).min(BLOCK);
        Some(self.count as f64 / with_ribbons as f64)
    }

    /// Samples the wavelengths of a photon from this light. Also returns the power of each lane for
    /// a total power of 1 W: S(λ)/(n p(λ)) in W for free photons with n lanes, and S(λ) in W/nm for
    /// shared photons.
    #[inline(always)]
    fn sample_wavelengths(&self, light: &Light, emission: &LeSample, excitation: bool, u: f64) -> (Wavelengths, Lanes) {
        match self.wavelengths {
            WavelengthSampling::Shared { nm, .. } if !excitation => {
                (Wavelengths::new(nm), nm.map(|nm| light.spd_at(emission.spd, nm)))
            }
            WavelengthSampling::Free | WavelengthSampling::Shared { .. } => {
                let mut nm = [0.0; LANES];
                let mut power = [0.0; LANES];
                for k in 0..LANES {
                    let (sampled, pdf) = light.photon_wavelengths().sample((u + k as f64) / LANES as f64);
                    nm[k] = sampled;
                    power[k] = light.spd_at(emission.spd, sampled) / (pdf * LANES as f64);
                }
                (Wavelengths::new(nm), power)
            }
        }
    }

    #[inline]
    pub(super) fn excites(&self, photon: &PhotonState) -> bool {
        photon.excitation || matches!(self.wavelengths, WavelengthSampling::Free)
    }

    #[inline]
    fn has_excitation_photons(&self) -> bool {
        self.fluorescent && matches!(self.wavelengths, WavelengthSampling::Shared { .. })
    }

    /// Returns the factor that converts the power of a lane to W, for the energy ledger. If a part
    /// of the photons are excitation photons, both parts represent the whole emission, and each
    /// counts by its fraction of the photons.
    #[inline]
    pub(super) fn watts(&self, excitation: bool) -> Lanes {
        match self.wavelengths {
            WavelengthSampling::Free => [1.0; LANES],
            WavelengthSampling::Shared { .. } if excitation => [EXCITATION_FRACTION; LANES],
            WavelengthSampling::Shared { pdf, .. } => {
                let fraction = if self.has_excitation_photons() { 1.0 - EXCITATION_FRACTION } else { 1.0 };
                pdf.map(|pdf| if pdf > 0.0 { fraction / (pdf * LANES as f64) } else { 0.0 })
            }
        }
    }
}
