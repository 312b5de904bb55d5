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
use crate::walk::{CausticWeights, MAX_EVENTS, Sink, TruncatedLight};
use abbe_scene::Scene;
use abbe_scene::camera::SystemAt;
use abbe_spectra::spectrum::{LANES, Lanes};

/// The inputs common to all camera paths of one pass.
#[derive(Debug)]
pub struct CameraPass<'a> {
    pub scene: &'a Scene,
    /// The plan of the render.
    pub plan: &'a Plan,
    /// Next-event estimation.
    pub direct: DirectLighting<'a>,
    /// The photon maps of both photon sets, free and shared.
    pub maps: PerSet<&'a SetMaps>,
    /// The number of photon paths of each set, divided by the number of camera samples per pixel.
    pub photons_per_sample: PerSet<f64>,
    /// The light that is missing because photon paths ended at a limit.
    pub truncated: Option<TruncatedMaps<'a>>,
    /// The pass's shared wavelengths in nm.
    pub shared_nm: Lanes,
    /// The density of each shared wavelength, per nm. The density is 0 if the lights have no power
    /// at this wavelength.
    pub shared_pdf: Lanes,
    /// The camera's lens system at each shared wavelength. `None` if the camera has no lens system.
    pub lens_systems: Option<[SystemAt<'a>; LANES]>,
    /// The light maps for direct light in media. Empty if the plan uses no light maps.
    pub light_maps: &'a LightMaps<'a>,
    /// The spectra of the lights.
    pub spectra: &'a PhotonSpectra,
    /// The responses of the sensor to photons at diffuse surfaces. `None` if the sink needs the
    /// wavelength of each contribution.
    pub responses: Option<&'a SensorResponses>,
    /// The outlines of directly visible surfaces.
    pub surface_extents: &'a SurfaceExtents,
    /// The weights of paths from receptors, if photons find the same light. Empty if no photon
    /// does.
    pub sensors: &'a [CausticWeights],
    /// The factors by which this pass scales the first kernel radii.
    pub scales: PerKernel<f64>,
    /// The first kernel radius (m) from the scene file. If the value is `None`, each pixel has its
    /// own first radius.
    pub explicit_radius_m: Option<f64>,
}

/// The light of photon paths beyond the limit of their number of events. The light is not part of
/// the picture. It changes only the estimated bias.
#[derive(Debug, Clone, Copy)]
pub struct TruncatedMaps<'a> {
    /// Photon maps with the distribution of the missing light.
    pub maps: PerSet<&'a SetMaps>,
    /// The ratio of the missing light to the light of these photons.
    pub factor: f64,
}

/// The inputs and outputs of one camera sample. All paths of the sample share these inputs and
/// outputs.
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
    /// Calls `gather` with a context in which all light, multiplied by `factor`, changes only the
    /// estimated bias. In this context, only the cap limits the number of events of a path.
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
