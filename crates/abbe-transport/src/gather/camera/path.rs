//! The state of a camera path, and how a scattering event changes it.

use super::throughput::{Factor, PathFactors, SpectralMode};
use super::visible_point::{CameraSegment, VisiblePoint};
use crate::gather::direct::light_tree::ReceivingPoint;
use crate::gather::direct::lighting::HitWeighting;
use crate::plan::CameraEvents;
use crate::plan::partition::CameraView;
use crate::walk::{CausticWeights, RayState, ScatteredRay, SurfaceInteraction};
use abbe_optics::bsdf::{BsdfSample, TransportMode};
use abbe_scene::geometry::Ray;
use abbe_scene::medium_stack::MediumStack;
use abbe_spectra::spectrum::{Lanes, REFERENCE_NM, Wavelengths};

/// Buffers of one worker, reused from path to path.
#[derive(Debug, Default)]
pub struct PathBuffers<'a> {
    pub(in crate::gather) factors: PathFactors<'a>,
    /// The extinction coefficients of all media and bodies that attenuate the light in a light map.
    pub(in crate::gather) coefficients: Vec<Lanes>,
    /// True if the camera walk fills `visible_points` and `camera_segments`.
    pub(in crate::gather) records: bool,
    pub visible_points: Vec<VisiblePoint>,
    /// The path segments of the last sample that lie in scattering media.
    pub camera_segments: Vec<CameraSegment>,
}

impl PathBuffers<'_> {
    /// Removes what the last path left.
    pub(in crate::gather) fn start_path(&mut self, polarised: bool) {
        self.factors.start_path(polarised);
        self.visible_points.clear();
        self.camera_segments.clear();
    }

    /// Creates buffers that record visible points and camera segments.
    pub fn recording() -> Self {
        Self { records: true, ..Self::default() }
    }
}

/// The data of a camera path that arrives at a glossy surface.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct GlossyEvent {
    pub(in crate::gather) caustic: Option<CausticWeights>,
    /// The wavelength (nm) of [`CameraPath::reference_nm`] before the event.
    pub(in crate::gather) reference_nm: f64,
}

impl GlossyEvent {
    /// The value for events at specular surfaces.
    pub(in crate::gather) const NONE: Self = Self { caustic: None, reference_nm: REFERENCE_NM };
}

#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct CameraPath {
    pub(in crate::gather) ray_state: RayState,
    pub(in crate::gather) spectral_mode: SpectralMode,
    pub(in crate::gather) view: CameraView,
    /// The events that decide the class of the path's light.
    pub(in crate::gather) events: CameraEvents,
    pub(in crate::gather) hit_weighting: HitWeighting,
    /// The throughput at the reference wavelength. Russian roulette uses this value.
    pub(in crate::gather) reference_throughput: f64,
    /// The length of the path so far, in m.
    pub(in crate::gather) distance_m: f64,
    pub(in crate::gather) depth: u32,
    /// The error that ray marching causes in the path's optical depth.
    pub(in crate::gather) excess_depth: f64,
    /// A body has absorbed or scattered most of the light.
    pub(in crate::gather) is_faint: bool,
    /// The first kernel radius (m) behind a final gather.
    pub(in crate::gather) final_radius_m: Option<f64>,
}

impl CameraPath {
    /// Creates a path at the camera. The path is free: its throughput is a function of wavelength.
    pub(in crate::gather) fn new(ray: Ray, medium_stack: MediumStack) -> Self {
        Self {
            ray_state: RayState { ray, from: None, medium_stack },
            spectral_mode: SpectralMode::Free,
            view: CameraView::Direct,
            events: CameraEvents::Specular,
            hit_weighting: HitWeighting::Full,
            reference_throughput: 1.0,
            distance_m: 0.0,
            depth: 0,
            excess_depth: 0.0,
            is_faint: false,
            final_radius_m: None,
        }
    }

    /// Returns the wavelength (nm) at which the path samples directions. For a free path, its
    /// factors correct the throughput at all other wavelengths.
    pub(in crate::gather) fn reference_nm(&self) -> f64 {
        match self.spectral_mode {
            SpectralMode::Free => REFERENCE_NM,
            SpectralMode::Shared { nm, .. } => nm,
        }
    }

    pub(in crate::gather) fn multiply<'a>(&mut self, factor: Factor<'a>, buffers: &mut PathBuffers<'a>) {
        let at_reference = factor.at(self.reference_nm());
        self.reference_throughput *= at_reference;
        match &mut self.spectral_mode {
            SpectralMode::Free => {
                let factor = if factor.is_grey() { Factor::Grey(at_reference) } else { factor };
                buffers.factors.natural.push(factor);
            }
            SpectralMode::Shared { throughput, .. } => *throughput *= at_reference,
        }
    }

    /// Continues the path along a sampled direction, unless it is on the wrong side of the surface,
    /// as below a rough interface.
    pub(in crate::gather) fn continue_along<'a>(
        &mut self,
        interaction: &SurfaceInteraction<'a>,
        sample: &BsdfSample,
        glossy: GlossyEvent,
        buffers: &mut PathBuffers<'a>,
    ) -> bool {
        let SurfaceInteraction { bsdf, wo, sides, .. } = *interaction;
        let direction = interaction.frame.to_world(sample.wi);
        if !interaction.is_consistent(direction, sample.event) {
            return false;
        }
        let factor = Factor::Scattering { bsdf, wo, sample: *sample, sides, probability: sample.probability };
        self.multiply(factor, buffers);
        if buffers.factors.polarised {
            buffers.factors.events.push(interaction.event_of_camera(direction, sample.delta));
        }
        // Shadow rays and photons at the surface use the wavelength of the arriving path, so their
        // weights refer to the density there.
        let pdf = if sample.delta || glossy.reference_nm == self.reference_nm() {
            sample.probability
        } else {
            bsdf.pdf(wo, sample.wi, sides, glossy.reference_nm)
        };
        self.view = CameraView::Indirect;
        self.events = if sample.delta { self.events.after_specular_event() } else { self.events.after_surface() };
        self.hit_weighting = match (sample.delta, self.hit_weighting) {
            (false, _) => {
                HitWeighting::Mis { from: ReceivingPoint::on_surface(interaction), pdf, caustic: glossy.caustic }
            }
            (true, weighting) => weighting.after_specular_event(),
        };
        self.ray_state = interaction.spawn_ray(direction, interaction.medium_stack_after(sample.event));
        true
    }

    /// Continues the path of one wavelength at a crystal.
    pub(in crate::gather) fn continue_at_crystal<'a>(
        &mut self,
        interaction: &SurfaceInteraction<'a>,
        scattered: &ScatteredRay,
        buffers: &mut PathBuffers<'a>,
    ) {
        let wavelengths = Wavelengths::single(self.reference_nm());
        self.multiply(Factor::Grey(scattered.weight[0]), buffers);
        buffers.factors.events.push(interaction.event_of(scattered, &wavelengths, TransportMode::Radiance));
        self.view = CameraView::Indirect;
        self.events = self.events.after_specular_event();
        self.hit_weighting = self.hit_weighting.after_specular_event();
        self.ray_state = interaction.spawn_scattered(scattered);
    }
}
