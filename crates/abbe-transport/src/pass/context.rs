//! The inputs of a pass.

use super::sums::PassSums;
use crate::emit::{EmissionStrata, LightSampler, PhotonSource, SpectrumCoverage, WavelengthSampling};
use crate::gather::{CameraPass, DirectLighting, LightSelector, Portals, SensorResponses, SurfaceExtents};
use crate::map::radius::PerKernel;
use crate::map::{LightMaps, PhotonSpectra, SetMaps};
use crate::plan::partition::{PerSet, PhotonSet};
use crate::plan::{Budget, MotionPlan, Plan};
use crate::walk::StopFlag;
use abbe_scene::Scene;
use abbe_spectra::error::Result;
use abbe_spectra::math::kronecker::{golden_ratio, sqrt3};
use abbe_spectra::math::random::{Purpose, REPLICATES};
use abbe_spectra::spectrum::{LANES, Lanes};
use std::borrow::Cow;
use web_time::Instant;

#[derive(Debug, Clone, Copy)]
pub struct PassContext<'a> {
    /// The scene at the time when the shutter opens.
    pub scene: &'a Scene,
    pub plan: &'a Plan,
    pub budget: &'a Budget,
    pub lights: &'a LightSampler,
    /// Selects the lights that a point samples, in the scene at this time.
    pub selector: &'a LightSelector,
    pub spectra: &'a PhotonSpectra,
    /// `None` if the sensor needs the wavelengths.
    pub responses: Option<&'a SensorResponses>,
    pub portals: &'a Portals,
    /// Ends the work early; its result must then be discarded.
    pub stop: &'a StopFlag,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct SharedWavelengths {
    pub(crate) nm: Lanes,
    /// The probability densities of the wavelengths, per nm.
    pub(crate) pdf: Lanes,
}

impl SharedWavelengths {
    pub(crate) fn sampling(self, set: PhotonSet) -> WavelengthSampling {
        let Self { nm, pdf } = self;
        match set {
            PhotonSet::Free => WavelengthSampling::Free,
            PhotonSet::Shared => WavelengthSampling::Shared { nm, pdf },
        }
    }
}

/// The emission of a photon set: the number of photons, their wavelengths and their random streams.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EmissionRequest {
    pub(crate) wavelengths: WavelengthSampling,
    pub(crate) count: u64,
    pub(crate) purpose: Purpose,
    pub(crate) pass: u64,
}

impl<'a> PassContext<'a> {
    /// Returns a source of photons in the scene of this context or a posed copy of it.
    pub(crate) fn photon_source<'s>(
        &self,
        scene: &'s Scene,
        strata: &'s EmissionStrata,
        request: EmissionRequest,
    ) -> PhotonSource<'s>
    where
        'a: 's,
    {
        let EmissionRequest { wavelengths, count, purpose, pass } = request;
        let free = matches!(wavelengths, WavelengthSampling::Free);
        PhotonSource {
            scene,
            strata,
            spectra: self.spectra,
            ray_densities: None,
            wavelengths,
            fluorescent: self.plan.fluorescence,
            polarised: self.plan.polarisation.is_on(),
            photons_per_ribbon: u64::from(free && self.plan.ribbons),
            count,
            streams: self.budget.seed.streams(purpose).pass(pass),
            media_plan: self.plan.media_plan,
            stop: self.stop,
        }
    }

    /// Returns the inputs of camera paths in the scene of this context or a posed copy of it, with
    /// the first radii, no missing light and no photon that competes with camera paths.
    /// `photons_per_sample` is the number of photon paths of each set per camera sample of a pixel.
    pub(crate) fn camera_pass<'s>(
        &self,
        (scene, selector): (&'s Scene, &'s LightSelector),
        (maps, light_maps): (&'s PerSet<SetMaps>, &'s LightMaps<'s>),
        SharedWavelengths { nm, pdf }: SharedWavelengths,
        (surface_extents, photons_per_sample): (&'s SurfaceExtents, PerSet<f64>),
    ) -> CameraPass<'s>
    where
        'a: 's,
    {
        CameraPass {
            scene,
            plan: self.plan,
            direct: DirectLighting::new(scene, selector, self.plan.media_plan).with_portals(self.portals),
            maps: maps.as_ref(),
            photons_per_sample,
            truncated: None,
            light_maps,
            shared_nm: nm,
            shared_pdf: pdf,
            scales: PerKernel::splat(1.0),
            explicit_radius_m: self.budget.radius_m,
            lens_systems: scene.camera.system().map(|system| nm.map(|nm| system.at(nm))),
            spectra: self.spectra,
            responses: self.responses,
            surface_extents,
            final_gather: false,
            sensors: &[],
            stop: self.stop,
        }
    }

    /// Samples the shared wavelengths of a pass, one in each of four strata of equal probability of
    /// the lights' wavelengths. A golden-ratio sequence of each replicate shifts them from pass to
    /// pass.
    pub(crate) fn shared_wavelengths(&self, pass: u64) -> SharedWavelengths {
        let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64);
        let shift = golden_ratio(index as u32, self.budget.seed.streams(Purpose::Pass).pass(replicate).hash());
        let samples: [(f64, f64); LANES] =
            std::array::from_fn(|k| self.lights.wavelengths.sample((shift + k as f64) / LANES as f64));
        SharedWavelengths { nm: samples.map(|(nm, _)| nm), pdf: samples.map(|(_, pdf)| pdf) }
    }

    /// Removes the spectra that the shared wavelengths of a pass sample from the missing ones.
    pub fn add_wavelengths(&self, pass: u64, coverage: &mut SpectrumCoverage) {
        let SharedWavelengths { nm, pdf } = self.shared_wavelengths(pass);
        coverage.add_pass(&nm, &pdf);
    }

    /// Returns the selector of the lights in the scene of this context or a posed copy of it.
    pub(crate) fn light_selector(&self, scene: &Scene) -> Cow<'a, LightSelector> {
        match self.plan.motion {
            MotionPlan::Still => Cow::Borrowed(self.selector),
            MotionPlan::PosedPerPass => {
                Cow::Owned(LightSelector::new(scene, &self.lights.lights).with_learned_of(self.selector))
            }
        }
    }

    /// Poses the scene at the shutter time of a pass, and adds the time for this to `sums`.
    ///
    /// The shutter times follow the shutter's transmission, by a low-discrepancy sequence of each
    /// replicate, independent of the wavelengths. Returns an error if the scene cannot be posed.
    pub(super) fn scene_of_pass(&self, pass: u64, sums: &mut PassSums) -> Result<Cow<'a, Scene>> {
        if self.plan.motion == MotionPlan::Still {
            return Ok(Cow::Borrowed(self.scene));
        }
        let start = Instant::now();
        let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64);
        let u = sqrt3(index as u32, self.budget.seed.streams(Purpose::Moment).pass(replicate).hash());
        let scene = self.scene.at(self.scene.shutter.time_s(u));
        sums.tally.moments += 1;
        sums.seconds.pose += start.elapsed().as_secs_f64();
        scene
    }
}
