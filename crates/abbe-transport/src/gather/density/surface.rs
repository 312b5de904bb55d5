//! Light from photons at surfaces on a camera path.

use super::gather_point::{GatherPoint, ResponseSums};
use super::responses::SurfaceResponses;
use super::surface_extent::{PixelSurfaceExtent, SurfaceExtent};
use crate::gather::camera::path::CameraPath;
use crate::gather::camera::throughput::SpectralMode;
use crate::gather::camera_pass::{AllPhotons, CameraPass, EventFilter, EventRange, PathContext, TruncatedMaps};
use crate::gather::luminescence::Luminescence;
use crate::map::kernel::BoundaryCorrection;
use crate::map::{NearbyPhoton, PhotonMap, PhotonSpectra, SetMaps, radius};
use crate::plan::partition::{CameraView, Estimator, LightPath, PhotonClass, PhotonSet, estimator};
use crate::plan::{IndirectPlan, PathClass};
use crate::walk::{CausticWeights, Sink, SurfaceInteraction};
use abbe_optics::bsdf::BsdfClass;
use std::f64::consts::PI;

/// The radius of kernels behind a final gather, relative to that in place. Each camera sample reads
/// photons elsewhere, so few of them suffice.
const FINAL_RADIUS: f64 = 0.3;

/// Returns the view that selects the estimator of photons. Only free photons are connected to the
/// camera, so a shared path uses the photon map even if it sees the surface directly.
#[inline(always)]
fn photon_view(path: &CameraPath) -> CameraView {
    match path.spectral_mode {
        SpectralMode::Free => path.view,
        SpectralMode::Shared { .. } => CameraView::Indirect,
    }
}

/// The photons that a camera path gathers at a surface, and their effect.
#[derive(Clone, Copy)]
struct Gathered<'l, 'a> {
    set: PhotonSet,
    /// The emission that the photons excite. `None` if the surface scatters the photons.
    luminescence: Option<&'l Luminescence<'a>>,
}

impl<'a> CameraPass<'a> {
    /// Gathers the photons of the path classes that the partition assigns to the photon map.
    #[inline(always)]
    pub(in crate::gather) fn gather_photons<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        bsdf_class: BsdfClass,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let set = path.spectral_mode.photon_set();
        let gathered = Gathered { set, luminescence: None };
        match self.truncated {
            None => self.gather_set(self.maps[set], (gathered, AllPhotons), path, interaction, bsdf_class, context),
            Some(beyond) => self.gather_to_limit(beyond, gathered, path, (interaction, bsdf_class), context),
        }
    }

    /// Adds the light that free photons excite, also if the path carries a shared wavelength,
    /// because their wavelengths represent the whole light.
    #[inline(never)]
    pub(in crate::gather) fn gather_excitation<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        luminescence: &Luminescence<'a>,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let gathered = Gathered { set: PhotonSet::Free, luminescence: Some(luminescence) };
        let class = BsdfClass::Diffuse;
        match self.truncated {
            None => self.gather_set(self.maps.free, (gathered, AllPhotons), path, interaction, class, context),
            Some(beyond) => self.gather_to_limit(beyond, gathered, path, (interaction, class), context),
        }
    }

    /// Gathers the photons within a limit, and those beyond for the estimated bias.
    #[inline(never)]
    fn gather_to_limit<S: Sink>(
        &self,
        truncated: TruncatedMaps<'a>,
        gathered: Gathered<'_, 'a>,
        path: &CameraPath,
        (interaction, bsdf_class): (&SurfaceInteraction<'a>, BsdfClass),
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let within = self.maps[gathered.set];
        match truncated {
            TruncatedMaps::Cap { factor } => {
                self.gather_set(within, (gathered, AllPhotons), path, interaction, bsdf_class, context);
                context.with_truncated_light(factor, |bias| {
                    self.gather_set(within, (gathered, AllPhotons), path, interaction, bsdf_class, bias);
                });
            }
            TruncatedMaps::Explicit { beyond } if context.is_truncated() => {
                for maps in [within, beyond[gathered.set]] {
                    self.gather_set(maps, (gathered, EventRange::ANY), path, interaction, bsdf_class, context);
                }
            }
            TruncatedMaps::Explicit { beyond } => {
                // The photon and the camera path arrive at the same surface, so it counts once.
                let most = context.events + 1 - path.depth;
                let admitted = (gathered, EventRange::up_to(most));
                self.gather_set(within, admitted, path, interaction, bsdf_class, context);
                context.with_truncated_light(1.0, |bias| {
                    let admitted = (gathered, EventRange::beyond(most));
                    self.gather_set(within, admitted, path, interaction, bsdf_class, bias);
                    let admitted = (gathered, EventRange::ANY);
                    self.gather_set(beyond[gathered.set], admitted, path, interaction, bsdf_class, bias);
                });
            }
        }
    }

    /// Returns the kernel radius (m) of a photon class at a surface point.
    #[inline(always)]
    fn kernel_radius<S: Sink>(
        &self,
        path: &CameraPath,
        (set, class): (PhotonSet, PhotonClass),
        interaction: &SurfaceInteraction<'a>,
        context: &PathContext<'_, 'a, S>,
    ) -> f64 {
        let of_pixel = || f64::from(context.radii.surface[set][class]);
        let radius = path.final_radius_m.unwrap_or_else(of_pixel) * self.scales.surface[class];
        radius.max(radius::least(interaction.hit.position))
    }

    /// Returns the first kernel radius (m) of both photon classes behind a final gather at the end
    /// of a path.
    pub(in crate::gather) fn final_radius<S: Sink>(&self, path: &CameraPath, context: &PathContext<'_, 'a, S>) -> f64 {
        FINAL_RADIUS * f64::from(context.radii.surface[path.spectral_mode.photon_set()].indirect)
    }

    /// Returns the weights of caustic photons and of camera paths, if the two compete.
    #[inline(always)]
    pub(in crate::gather) fn caustic_weights<S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        context: &PathContext<'_, 'a, S>,
    ) -> Option<CausticWeights> {
        let bsdf_class = interaction.bsdf.class();
        if self.direct.ray_densities.is_none() || bsdf_class != BsdfClass::Glossy {
            return None;
        }
        let set = path.spectral_mode.photon_set();
        let area_m2 = if estimator(LightPath::Caustic, bsdf_class, photon_view(path)) == Estimator::Connection {
            self.scene.camera.pixel_width_m(path.distance_m).powi(2)
        } else {
            PI * self.kernel_radius(path, (set, PhotonClass::Caustic), interaction, context).powi(2)
        };
        Some(CausticWeights { photons_m2: self.photons_per_sample[set] * area_m2 })
    }

    /// Returns true if the camera paths of the plan gather this class from the photon map.
    #[inline(always)]
    fn gathers(&self, class: PhotonClass, bsdf_class: BsdfClass, view: CameraView) -> bool {
        let planned = match class {
            PhotonClass::Indirect => self.plan.indirect != IndirectPlan::Absent,
            PhotonClass::Caustic => true,
        };
        planned && estimator(class.light_path(), bsdf_class, view) == Estimator::PhotonMap
    }

    /// Returns the extent within the kernel radius (m) around a surface point.
    #[inline(always)]
    fn surface_extent_around(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        radius: f64,
        pixel: u64,
    ) -> KernelExtent<'_> {
        if self.surface_extents.is_empty() || path.view == CameraView::Indirect {
            return KernelExtent::Absent;
        }
        let point = self.visible_point(path, interaction);
        match self.surface_extents.find(pixel as usize, &point) {
            PixelSurfaceExtent::Absent => KernelExtent::Absent,
            PixelSurfaceExtent::Stored(surface_extent) => KernelExtent::Stored(surface_extent),
            PixelSurfaceExtent::Varies => {
                KernelExtent::Measured(SurfaceExtent::around(&self.scene.geometry, &point, radius))
            }
        }
    }

    #[inline(always)]
    fn gather_set<S: Sink>(
        &self,
        maps: &SetMaps,
        (Gathered { set, luminescence }, filter): (Gathered<'_, 'a>, impl EventFilter),
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        bsdf_class: BsdfClass,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let view = photon_view(path);
        for class in PhotonClass::ALL {
            let map = &maps[class].surface;
            if map.is_empty() || !self.gathers(class, bsdf_class, view) {
                continue;
            }
            context.tally.map_queries += 1;
            let radius = self.kernel_radius(path, (set, class), interaction, context);
            let surface_extent = self.surface_extent_around(path, interaction, radius, context.pixel);
            let surface_extent = surface_extent.limiting();
            let correction =
                surface_extent.map_or(BoundaryCorrection::WHOLE, |surface_extent| surface_extent.correction(radius));
            let weights = match class {
                PhotonClass::Caustic => self.caustic_weights(path, interaction, context),
                PhotonClass::Indirect => None,
            };
            let gather_point =
                GatherPoint::new(interaction, radius, correction, path, &context.buffers.factors).competing_by(weights);
            let centre = interaction.hit.position.as_vec3().to_array();
            let photons = PhotonsAround { map, filter, centre, radius: radius as f32, surface_extent };
            let (spectra, path_class) = (self.spectra, path.events.class_at_surface(class.light_path()));
            let responses = if gather_point.is_plain() { self.responses } else { None };
            let sink = &mut *context.sink;
            match (responses.and_then(|responses| responses.of_surface(interaction)), luminescence) {
                // The tabulated responses contain the emission.
                (Some(_), Some(_)) => {}
                (None, Some(luminescence)) => {
                    context.tally.gathered += photons
                        .visit(|nearby| gather_point.add_excitation(nearby, spectra, path_class, luminescence, sink));
                }
                (Some(surface), None) => {
                    context.tally.tabulated +=
                        add_responses(&photons, &gather_point, surface, spectra, path_class, sink);
                }
                (None, None) if self.plan.polarisation.is_on() && gather_point.depends_on_polarisation() => {
                    let (light, of) = ((spectra, path_class), |number| map.polarisation(number));
                    context.tally.gathered += photons.visit(|nearby| {
                        gather_point.add_polarised(nearby, of(nearby.number), interaction, light, sink);
                    });
                }
                (None, None) => {
                    context.tally.gathered +=
                        photons.visit(|nearby| gather_point.add(nearby, spectra, path_class, sink));
                }
            }
        }
    }
}

enum KernelExtent<'o> {
    /// The kernel does not reach over an edge.
    Absent,
    Stored(&'o SurfaceExtent),
    Measured(SurfaceExtent),
}

impl KernelExtent<'_> {
    #[inline(always)]
    fn limiting(&self) -> Option<&SurfaceExtent> {
        match self {
            Self::Absent => None,
            Self::Stored(surface_extent) => Some(surface_extent),
            Self::Measured(surface_extent) => Some(surface_extent).filter(|surface_extent| surface_extent.is_limited()),
        }
    }
}

struct PhotonsAround<'m, F> {
    map: &'m PhotonMap,
    filter: F,
    centre: [f32; 3],
    /// The kernel radius in m.
    radius: f32,
    /// The edge of the surface. Photons beyond it are on another surface.
    surface_extent: Option<&'m SurfaceExtent>,
}

impl<F: EventFilter> PhotonsAround<'_, F> {
    /// Calls `add` for each photon within the surface extent. Returns the number within the radius.
    #[inline(always)]
    fn visit(&self, mut add: impl FnMut(&NearbyPhoton<'_>)) -> u64 {
        let mut count = 0;
        self.map.within(self.centre, self.radius, |nearby| {
            if !self.filter.admits(|| self.map.events(nearby.number)) {
                return;
            }
            count += 1;
            if self.surface_extent.is_none_or(|surface_extent| surface_extent.contains(nearby.position)) {
                add(&nearby);
            }
        });
        count
    }
}

/// Adds the responses to the photons around a gather point. Returns their number within the radius.
#[inline(always)]
fn add_responses<S: Sink>(
    photons: &PhotonsAround<'_, impl EventFilter>,
    gather_point: &GatherPoint<'_>,
    surface: SurfaceResponses<'_>,
    spectra: &PhotonSpectra,
    class: PathClass,
    sink: &mut S,
) -> u64 {
    let mut sums = ResponseSums::default();
    let count = if sink.separates_lights() {
        photons.visit(|nearby| {
            if let Some(response) = gather_point.add_response(nearby, surface, &mut sums) {
                sink.respond_of_light(spectra.light_of(nearby.photon.power.wavelength_code()), response);
            }
        })
    } else {
        photons.visit(|nearby| {
            let _response = gather_point.add_response(nearby, surface, &mut sums);
        })
    };
    sink.respond(class, sums.estimate, sums.bias);
    count
}
