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
    /// `None` if no photon path reaches a limit.
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
    /// True if camera paths gather indirect photons behind the first diffuse surface.
    pub final_gather: bool,
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
pub enum TruncatedMaps<'a> {
    /// The cap ended some paths. The factor is the ratio of the missing light to the light of the
    /// photons within the cap.
    Cap { factor: f64 },
    /// The scene sets a limit, beyond which these photons have been followed. The photons within
    /// the limit have numbers of events.
    Explicit { beyond: PerSet<&'a SetMaps> },
}

/// Selects the photons of a map by their numbers of surface events.
pub(super) trait EventFilter: Copy {
    fn admits(self, events: impl FnOnce() -> u32) -> bool;
}

/// Selects all photons. Their maps need no numbers of events.
#[derive(Clone, Copy)]
pub(super) struct AllPhotons;

impl EventFilter for AllPhotons {
    #[inline(always)]
    fn admits(self, _events: impl FnOnce() -> u32) -> bool {
        true
    }
}

/// Selects photons with a number of events in this range.
#[derive(Clone, Copy)]
pub(super) struct EventRange {
    least: u32,
    most: u32,
}

impl EventRange {
    pub(super) const ANY: Self = Self { least: 0, most: u32::MAX };

    pub(super) fn up_to(most: u32) -> Self {
        Self { least: 0, most }
    }

    pub(super) fn beyond(most: u32) -> Self {
        Self { least: most + 1, most: u32::MAX }
    }
}

impl EventFilter for EventRange {
    #[inline(always)]
    fn admits(self, events: impl FnOnce() -> u32) -> bool {
        (self.least..=self.most).contains(&events())
    }
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
    /// Returns true beyond an explicit limit of the scene, where the light changes only the bias.
    pub(super) fn is_truncated(&self) -> bool {
        self.events >= MAX_EVENTS
    }

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
