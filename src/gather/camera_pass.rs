//! The inputs of the camera paths of one pass.

use super::camera::path::PathBuffers;
use super::camera::sampler::PixelSampler;
use super::density::outline::Outlines;
use super::direct::lighting::DirectLighting;
use crate::map::radius::RadiusScales;
use crate::map::{LightMaps, PixelRadii, SetMaps};
use crate::plan::partition::PerSet;
use crate::plan::{Plan, Tally};
use crate::scene::Scene;
use crate::scene::camera::SystemAt;
use crate::spectrum::{LANES, Lanes};

/// The inputs common to all camera paths of one pass.
#[derive(Debug)]
pub struct CameraPass<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The plan of the render.
    pub plan: &'a Plan,
    /// Next-event estimation.
    pub direct: DirectLighting<'a>,
    /// The photon maps of both photon sets, free and shared.
    pub maps: PerSet<&'a SetMaps>,
    /// The pass's shared wavelengths in nm.
    pub shared_nm: Lanes,
    /// The density of each shared wavelength, per nm. The density is 0 if the lights have no power
    /// at this wavelength.
    pub shared_pdf: Lanes,
    /// The camera's lens system at each shared wavelength. `None` if the camera has no lens system.
    pub lens_systems: Option<[SystemAt<'a>; LANES]>,
    /// The light maps for direct light in media. Empty if the plan uses no light maps.
    pub light_maps: &'a LightMaps<'a>,
    /// The outlines of directly visible surfaces.
    pub outlines: &'a Outlines,
    /// The factors by which this pass scales the first kernel radii.
    pub scales: RadiusScales,
    /// The first kernel radius (m) from the scene file. If the value is `None`, each pixel has its
    /// own first radius.
    pub stated_radius_m: Option<f64>,
    /// The largest number of surface events in a path.
    pub max_depth: u32,
}

/// The inputs and outputs of one camera sample. All paths of the sample share these inputs and
/// outputs.
pub(super) struct PathContext<'s, 'a, S> {
    pub(super) pixel: u64,
    pub(super) sampler: &'s mut PixelSampler,
    pub(super) radii: &'s PixelRadii,
    pub(super) buffers: &'s mut PathBuffers<'a>,
    pub(super) sink: &'s mut S,
    pub(super) tally: &'s mut Tally,
}
