//! The pilot's survey: one camera path per pixel, and the pilot photons around it.

use super::context::{EmissionRequest, PassContext, SharedWavelengths};
use super::keep_probability::KEEP_ALL;
use super::trace::trace_photons;
use super::volume_radii::{DepositCounts, PilotMaps, PixelVolumeCounts, VolumeKernelWidths, thin_out_for_pilot};
use crate::emit::{EmissionStrata, WavelengthSampling};
use crate::gather::{CameraPass, DirectLighting, Outlines, PathBuffers, PixelSampler, VisiblePoint};
use crate::map::radius::{self, RadiusScales};
use crate::map::{LightMaps, PhotonMap, PixelRadii, SetMaps};
use crate::math::random::Purpose;
use crate::plan::Tally;
use crate::plan::partition::{PerClass, PerSet, PhotonClass, PhotonSet, View};
use crate::scene::Scene;
use crate::sensor::Film;
use crate::walk::Sink;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZero;
use std::ops::Range;

/// The upper limit of the first kernel radius on surfaces, in pixels.
///
/// Caustics have sharp edges. Near a caustic, a wide kernel would spread the light of the caustic
/// into the dark region for many passes. For indirect light, a narrow kernel is noisier, but this
/// noise vanishes after a few passes. The bias of a wider kernel would remain visible.
pub(super) const MAX_SURFACE_RADIUS_PX: PerClass<f64> = PerClass { caustic: 3.0, indirect: 24.0 };

/// The lower limit of the first kernel radius on surfaces is a pixel, but at most this fraction of
/// the object. A wider kernel would reach over the edges of an object that is as large as a pixel.
const LEAST_RADIUS_OF_OBJECT: f64 = 1.0 / 16.0;

/// Separates the camera samples of the pilot from the camera samples of the passes. The samples are
/// hashes of the seed, the replicate and the pixel. The bytes of this number are the word "pilot"
/// in ASCII.
const CAMERA_SEED_MASK: u64 = 0x0070_696c_6f74;

/// The measurements of the pilot in all pixels, or in some of them.
#[derive(Default)]
pub(super) struct PixelSurvey {
    /// The first kernel radii of each pixel on surfaces. A radius is `None` if the pixel's camera
    /// path did not read the corresponding photon set on a surface.
    pub(super) radii: Vec<PixelRadii<Option<f32>>>,
    /// The directly visible surface point of each pixel.
    pub(super) visible: Vec<Option<VisiblePoint>>,
    /// The photons in media near the camera rays of each pixel.
    pub(super) volume: Vec<PixelVolumeCounts>,
    /// The number of photons stored in media.
    pub(super) stored: PerClass<DepositCounts>,
    /// For each photon set, the number of pixels whose camera paths read this set.
    pub(super) readers: PerSet<u64>,
}

impl PixelSurvey {
    /// Surveys all pixels at one shutter time. `moment` is the index of the time, and `scene` is
    /// the scene at that time.
    pub(super) fn of_moment(
        context: &PassContext<'_>,
        scene: &Scene,
        moment: u64,
        strata: &EmissionStrata,
        photons: PerSet<u64>,
    ) -> Self {
        let PassContext { plan, budget, lights, .. } = *context;
        let SharedWavelengths { nm, pdf } = context.shared_wavelengths(moment);
        let blank = Film::new(1, 1, scene.film.observer, 0);
        let mut stored = PerClass::default();
        let maps = PerSet::from_fn(|set| {
            let (wavelengths, pass) = match set {
                PhotonSet::Free => (WavelengthSampling::Free, 2 * moment),
                PhotonSet::Shared => (WavelengthSampling::Shared { nm, pdf }, 2 * moment + 1),
            };
            let request = EmissionRequest { wavelengths, count: photons[set], purpose: Purpose::Pilot, pass };
            let source = context.photon_source(scene, strata, request);
            let mut deposits = trace_photons(&source, plan, set, KEEP_ALL, || blank.splat_sink()).deposits;
            stored = stored.zip_with(DepositCounts::of(&deposits), DepositCounts::max);
            let kept = thin_out_for_pilot(&mut deposits);
            PilotMaps { maps: deposits.into_maps(), kept }
        });
        let (no_photons, no_outlines) = (SetMaps::default(), Outlines::default());
        let camera_pass = CameraPass {
            scene,
            plan,
            direct: DirectLighting::new(scene, &lights.lights, plan.media_plan),
            maps: PerSet { free: &no_photons, shared: &no_photons },
            missing: None,
            light_maps: &LightMaps::default(),
            shared_nm: nm,
            shared_pdf: pdf,
            scales: RadiusScales::of_pass(0),
            stated_radius_m: budget.radius_m,
            lens_systems: scene.camera.system().map(|system| nm.map(|nm| system.at(nm))),
            outlines: &no_outlines,
            depth_limit: context.depth_limit(),
        };
        let (width, extents) = (scene.camera.width(), object_extents(scene));
        let rows: Vec<Self> = (0..scene.camera.pixel_count() / width)
            .into_par_iter()
            .map(|row| {
                let pixels = row * width..(row + 1) * width;
                Self::of_pixels(context, &camera_pass, &maps, &extents, moment, pixels)
            })
            .collect();
        let mut all = Self { stored, ..Self::default() };
        rows.into_iter().for_each(|row| all.append(row));
        all
    }

    /// Surveys some pixels.
    fn of_pixels<'a>(
        context: &PassContext<'_>,
        camera_pass: &CameraPass<'a>,
        maps: &PerSet<PilotMaps>,
        extents: &BTreeMap<u32, f64>,
        moment: u64,
        pixels: Range<usize>,
    ) -> Self {
        let mut buffers = PathBuffers::recording();
        let widths = VolumeKernelWidths::of(context);
        let mut survey = Self::default();
        for pixel in pixels {
            let sampler = PixelSampler::new(context.budget.seed ^ CAMERA_SEED_MASK, moment, pixel as u64);
            let (no_radii, mut tally) = (PixelRadii::splat(0.0), Tally::default());
            camera_pass.sample(pixel as u64, sampler, &no_radii, &mut buffers, &mut tally, &mut NullSink);
            let mut radii = PixelRadii::splat(None);
            for point in &buffers.visible_points {
                let set = PhotonSet::of_path(point.shared);
                for class in PhotonClass::ALL {
                    let map = &maps[set].maps[class].surface;
                    let extent_m = extents.get(&point.object).copied().unwrap_or(f64::INFINITY);
                    let least_m = point.footprint_m.min(LEAST_RADIUS_OF_OBJECT * extent_m);
                    let radius = first_radius_m(context, point, map, least_m, MAX_SURFACE_RADIUS_PX[class]) as f32;
                    radii.surface[set][class] = Some(radius).filter(|&radius| radius > 0.0);
                }
            }
            survey.radii.push(radii);
            let media = &camera_pass.scene.media;
            survey.volume.push(PixelVolumeCounts::along(&buffers.camera_segments, media, maps, &widths));
            let on_surfaces = buffers.visible_points.iter().map(|point| point.shared);
            let in_media = buffers.camera_segments.iter().map(|segment| segment.shared);
            let mut reads = PerSet { free: false, shared: false };
            on_surfaces.chain(in_media).for_each(|shared| {
                reads.shared |= shared;
                reads.free |= !shared;
            });
            survey.readers.free += u64::from(reads.free);
            survey.readers.shared += u64::from(reads.shared);
            let first = buffers.visible_points.first().copied();
            survey.visible.push(first.filter(|point| point.view == View::Direct));
        }
        survey
    }

    /// Appends the measurements that `other` contains for a different set of pixels.
    fn append(&mut self, other: Self) {
        self.radii.extend(other.radii);
        self.visible.extend(other.visible);
        self.volume.extend(other.volume);
        self.add_counts(other.stored, other.readers);
    }

    /// Merges the measurements of the same pixels at another time. A pixel keeps the smaller radii.
    pub(super) fn merge(&mut self, other: Self) {
        if self.radii.is_empty() {
            self.append(other);
            return;
        }
        let smaller = |one: Option<f32>, other: Option<f32>| match (one, other) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, None) | (None, one) => one,
        };
        for (radii, other) in self.radii.iter_mut().zip(&other.radii) {
            *radii = radii.zip_with(*other, smaller);
        }
        self.volume.iter_mut().zip(other.volume).for_each(|(here, other)| *here = here.max(other));
        self.add_counts(other.stored, other.readers);
    }

    fn add_counts(&mut self, stored: PerClass<DepositCounts>, readers: PerSet<u64>) {
        self.stored = self.stored.zip_with(stored, DepositCounts::max);
        self.readers.free += readers.free;
        self.readers.shared += readers.shared;
    }
}

/// Returns the length (m) of the diagonal of each object's bounding box, by object number.
fn object_extents(scene: &Scene) -> BTreeMap<u32, f64> {
    scene.geometry.object_bounds().into_iter().map(|(object, (low, high))| (object, low.distance(high))).collect()
}

/// Returns the first kernel radius in m at a visible point. If the scene does not fix the radius,
/// the kernel contains as many photons as the budget specifies. Its radius is then at least
/// `least_m` and at most `largest_px` pixels.
fn first_radius_m(
    context: &PassContext<'_>,
    point: &VisiblePoint,
    map: &PhotonMap,
    least_m: f64,
    largest_px: f64,
) -> f64 {
    if let Some(fixed) = context.budget.radius_m {
        return fixed;
    }
    let nearest = NonZero::new(context.budget.nearest as usize).unwrap_or(NonZero::<usize>::MIN);
    let kth = map.kth_distance(point.position.as_vec3().to_array(), nearest).map(f64::from);
    radius::first(kth, least_m, largest_px * point.footprint_m)
}

/// A sink that discards all light.
struct NullSink;

impl Sink for NullSink {
    fn radiance(&mut self, _nm: f64, _weight: f64) {}

    fn biased(&mut self, _nm: f64, _weight: f64, _bias: f64) {}
}
