//! The inputs of the camera paths of one pass.

use super::camera::path::PathBuffers;
use super::camera::sampler::PixelSampler;
use super::density::responses::SensorResponses;
use super::density::surface_extent::SurfaceExtents;
use super::direct::lighting::DirectLighting;
use crate::map::radius::PerKernel;
use crate::map::{LightMaps, PhotonSpectra, PixelRadii, SetMaps};
use crate::plan::partition::PerSet;
use crate::plan::{Plan, Tally};
use crate::walk::{CausticWeights, MAX_EVENTS, Sink, StopFlag, TruncatedLight};
use abbe_scene::Scene;
use abbe_scene::camera::SystemAt;
use abbe_spectra::spectrum::{LANES, Lanes};

#[derive(Debug)]
pub struct CameraPass<'a> {
    pub scene: &'a Scene,
    pub plan: &'a Plan,
    pub direct: DirectLighting<'a>,
    pub maps: PerSet<&'a SetMaps>,
    /// The number of photon paths of each set, divided by the number of camera samples per pixel.
    pub photons_per_sample: PerSet<f64>,
    pub truncated: Option<TruncatedMaps<'a>>,
    /// The pass's shared wavelengths in nm.
    pub shared_nm: Lanes,
    /// Per nm; 0 if the lights have no power there.
    pub shared_pdf: Lanes,
    /// The camera's lens system at each shared wavelength. `None` if the camera has no lens system.
    pub lens_systems: Option<[SystemAt<'a>; LANES]>,
    /// The light maps for direct light in media. Empty if the plan uses no light maps.
    pub light_maps: &'a LightMaps<'a>,
    pub spectra: &'a PhotonSpectra,
    /// `None` if the sink needs the wavelength of each contribution.
    pub responses: Option<&'a SensorResponses>,
    pub surface_extents: &'a SurfaceExtents,
    /// The weights of paths from sensors. Empty if no photon finds the same light.
    pub sensors: &'a [CausticWeights],
    /// The factors by which this pass scales the first kernel radii.
    pub scales: PerKernel<f64>,
    /// The first kernel radius (m) of the scene file. Without it, each pixel has its own.
    pub explicit_radius_m: Option<f64>,
    /// Samples are black after it is raised.
    pub stop: &'a StopFlag,
}

/// The light of photon paths beyond their limit, which changes only the estimated bias.
#[derive(Debug, Clone, Copy)]
pub struct TruncatedMaps<'a> {
    pub maps: PerSet<&'a SetMaps>,
    /// The ratio of the missing light to the light of these photons.
    pub factor: f64,
}

pub(super) struct PathContext<'s, 'a, S> {
    pub(super) pixel: u64,
    /// The number of surface events after which the paths end.
    pub(super) events: u32,
    pub(super) sampler: &'s mut PixelSampler,
    pub(super) radii: &'s PixelRadii,
    pub(super) buffers: &'s mut PathBuffers<'a>,
    pub(super) sink: &'s mut S,
    pub(super) tally: &'s mut Tally,
}

impl<'a, S: Sink> PathContext<'_, 'a, S> {
    /// Calls `gather` with a context in which all light, times `factor`, changes only the estimated
    /// bias, and only the cap limits the number of events of a path.
    pub(super) fn with_truncated_light(
        &mut self,
        factor: f64,
        gather: impl FnOnce(&mut PathContext<'_, 'a, TruncatedLight<'_>>),
    ) {
        let mut sink = TruncatedLight { sink: &mut *self.sink, factor };
        gather(&mut PathContext {
            pixel: self.pixel,
            events: MAX_EVENTS,
            sampler: &mut *self.sampler,
            radii: self.radii,
            buffers: &mut *self.buffers,
            sink: &mut sink,
            tally: &mut *self.tally,
        });
    }
}
