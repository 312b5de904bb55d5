//! What the pilot fixes for all passes.

use super::context::{EmissionRequest, PassContext, SharedWavelengths};
use super::keep_probability::KeepProbability;
use super::recorder::RecordingOptions;
use crate::emit::{EmissionStrata, PhotonSource};
use crate::gather::{CameraPass, LightSelector, SurfaceExtents};
use crate::map::radius::PerKernel;
use crate::map::{FirstRadii, LightMaps, SetMaps};
use crate::plan::partition::{PerClass, PerSet, PhotonSet};
use crate::walk::RayDensities;
use abbe_scene::Scene;

/// The same in all passes. They must not learn from each other, so the pilot chooses it.
#[derive(Debug)]
pub struct PassParameters {
    pub(crate) strata: EmissionStrata,
    /// The densities of the emitted rays. `None` if no photon competes with camera paths.
    pub(crate) ray_densities: Option<RayDensities>,
    pub(crate) radii: FirstRadii,
    /// The first kernel radius of each sensor in m. Empty if there are no sensors or caustics.
    pub(crate) sensor_radii: Vec<f64>,
    pub(crate) surface_extents: SurfaceExtents,
    pub(crate) photons: PerSet<u64>,
    /// True if camera paths gather indirect photons behind the first diffuse surface.
    pub(crate) final_gather: bool,
    /// One of this many photons paints a ribbon, if the plan has ribbons.
    pub(crate) photons_per_ribbon: u64,
    pub(crate) camera_samples: CameraSamples,
    /// The number of photons that a pass stores, divided by the number for which the first radii
    /// are chosen. Always 1 if the scene sets the first radius.
    pub(crate) stored_photons: PerKernel<f64>,
    pub(crate) keep: PerClass<KeepProbability>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum CameraSamples {
    Same(u64),
    /// A number for each pixel, and the mean over the pixels.
    Each(Vec<u8>, f64),
}

impl PassParameters {
    /// Returns the photon paths of each set per camera sample of a pixel.
    pub(crate) fn photons_per_sample(&self) -> PerSet<f64> {
        PerSet::from_fn(|set| self.photons[set] as f64 / self.camera_samples.mean())
    }

    pub(crate) fn recording(&self, set: PhotonSet) -> RecordingOptions<'static> {
        RecordingOptions { keep: self.keep, photons_per_sample: self.photons_per_sample()[set], sensors: None }
    }

    pub(crate) fn photon_source<'s>(
        &'s self,
        context: &PassContext<'s>,
        scene: &'s Scene,
        request: EmissionRequest,
    ) -> PhotonSource<'s> {
        let source = context.photon_source(scene, &self.strata, request);
        PhotonSource {
            ray_densities: self.ray_densities.as_ref(),
            photons_per_ribbon: source.photons_per_ribbon * self.photons_per_ribbon,
            ..source
        }
    }

    /// Returns the inputs of the camera paths with the first radii and without missing light.
    pub(crate) fn camera_pass<'s>(
        &'s self,
        context: &PassContext<'s>,
        (scene, selector): (&'s Scene, &'s LightSelector),
        (maps, light_maps): (&'s PerSet<SetMaps>, &'s LightMaps<'s>),
        shared: SharedWavelengths,
    ) -> CameraPass<'s> {
        let kernels = (&self.surface_extents, self.photons_per_sample());
        let plain = context.camera_pass((scene, selector), (maps, light_maps), shared, kernels);
        let direct = plain.direct.with_ray_densities(self.ray_densities.as_ref());
        CameraPass { direct, final_gather: self.final_gather, ..plain }
    }
}

impl CameraSamples {
    #[inline]
    pub(crate) fn of(&self, pixel: usize) -> u64 {
        match self {
            Self::Same(count) => *count,
            Self::Each(counts, _) => u64::from(counts[pixel]),
        }
    }

    pub(crate) fn mean(&self) -> f64 {
        match self {
            Self::Same(count) => *count as f64,
            Self::Each(_, mean) => *mean,
        }
    }
}
