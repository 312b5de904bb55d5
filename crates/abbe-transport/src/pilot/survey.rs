//! The pilot's survey: one camera path per pixel, and the pilot photons around it.

use super::keep_probability::DepositCounts;
use super::volume_radii::{PixelVolumeCounts, VolumeKernelWidths};
use super::volume_samples::VolumeSamples;
use crate::emit::EmissionStrata;
use crate::gather::{CameraPass, CameraSegment, PathBuffers, PixelSampler, SurfaceExtents, VisiblePoint};
use crate::map::radius;
use crate::map::{LightMaps, PhotonMap, PixelRadii};
use crate::pass::{EmissionRequest, KEEP_ALL, PassContext, PhotonDeposits, RecordingOptions, trace_photons};
use crate::plan::partition::{CameraView, PerClass, PerSet, PhotonClass, PhotonSet};
use crate::plan::{DirectPlan, LightOrigin, PathClass, Plan, Tally};
use crate::sensor::Film;
use crate::walk::{SensorResponse, Sink};
use abbe_scene::Scene;
use abbe_spectra::math::random::Purpose;
use rayon::prelude::*;
use std::f64::consts::SQRT_2;
use std::num::NonZero;

/// The largest first kernel radius on surfaces, in pixels.
///
/// A wide kernel would spread the light of a sharp caustic into the dark region for many passes.
/// For indirect light, a narrow kernel is noisier, but this noise vanishes after a few passes, and
/// the bias of a wider kernel would remain visible.
pub(super) const MAX_SURFACE_RADIUS_PX: PerClass<f64> = PerClass { caustic: 3.0, indirect: 24.0 };

/// The same for indirect light, as a fraction of the picture's shorter side. On a small film, 24
/// pixels would be wider than the view.
const MAX_SURFACE_RADIUS_OF_PICTURE: f64 = 0.25;

/// The fraction of a pass's photon paths that the survey traces, over all shutter times.
const PHOTON_FRACTION: f64 = 0.25;

/// The least number of photon paths of each set at each shutter time, unless a pass has fewer.
const MIN_PHOTONS: f64 = 10_000.0;

/// The smallest first radius on surfaces is a pixel, but at most this fraction of the object: a
/// wider kernel would reach over the edges of an object as large as a pixel.
const LEAST_RADIUS_OF_OBJECT: f64 = 1.0 / 16.0;

/// The largest first radius on surfaces, as a fraction of the object. A much larger kernel contains
/// few of the photons that it is normalised for.
const LARGEST_RADIUS_OF_OBJECT: f64 = 0.5;

/// The least number of indirect photons of a pass within the first radius. Close to a wall in a
/// large world, 24 pixels cover so little of the wall that they contain no photons.
const FEWEST_PHOTONS: f64 = 8.0;

/// The side in pixels of blocks, which search the nearest photons once for each surface.
const BLOCK: usize = 2;

/// The least ratio of the lengths of two camera segments that share a count of photons. Beside the
/// edge of a body, segments are short and few photons are near them.
const SIMILAR_LENGTH: f64 = 0.9;

/// The measurements of the pilot in all pixels, or in some of them.
#[derive(Default)]
pub(super) struct PixelSurvey {
    /// The first radii on surfaces, `None` for a set that the pixel's path did not read there.
    pub(super) radii: Vec<PixelRadii<Option<f32>>>,
    pub(super) visible: Vec<Option<VisiblePoint>>,
    /// The photons near the camera rays of each pixel. Empty without media.
    pub(super) volume: Vec<PixelVolumeCounts>,
    pub(super) stored: PerClass<DepositCounts>,
    /// For each photon set, the number of pixels whose camera paths read this set.
    pub(super) readers: PerSet<u64>,
}

impl PixelSurvey {
    /// Surveys all pixels at time `moment` of `moments`. A pass has `photons` paths.
    pub(super) fn of_moment(
        context: &PassContext<'_>,
        scene: &Scene,
        (moment, moments): (u64, usize),
        strata: &EmissionStrata,
        photons: PerSet<u64>,
    ) -> Self {
        let plan = context.plan;
        // Direct light has no kernel, so the survey needs none.
        let without_direct = Plan { direct: DirectPlan::Absent, ..plan.clone() };
        let shared = context.shared_wavelengths(moment);
        let blank = Film::new(1, 1, scene.film.observer, 0);
        let mut stored = PerClass::default();
        let maps = PerSet::from_fn(|set| {
            let (wavelengths, pass) = (shared.sampling(set), 2 * moment + set as u64);
            let fraction = photon_fraction(photons[set], moments);
            let count = (fraction * photons[set] as f64) as u64;
            let request = EmissionRequest { wavelengths, count, purpose: Purpose::SurveyPhoton, pass };
            let source = context.photon_source(scene, strata, request);
            let recording = RecordingOptions { keep: KEEP_ALL, photons_per_sample: photons[set] as f64, sensors: None };
            let deposits = trace_photons(&source, plan, set, recording, || blank.splat_sink()).deposits;
            let here = PerClass::from_fn(|class| DepositCounts::of(&deposits.volume[class], fraction.recip()));
            stored = stored.zip_with(here, DepositCounts::max);
            SurveyMaps::new(&deposits, context, fraction)
        });
        let (no_photons, no_light_maps, no_surface_extents) =
            (PerSet::default(), LightMaps::default(), SurfaceExtents::default());
        let selector = context.light_selector(scene);
        let kernels = (&no_surface_extents, PerSet::from_fn(|set| photons[set] as f64));
        let camera_pass = CameraPass {
            plan: &without_direct,
            responses: None,
            ..context.camera_pass((scene, &selector), (&no_photons, &no_light_maps), shared, kernels)
        };
        let extents = object_extents(scene);
        let mut all = Self::blank(scene);
        let readers = all
            .bands(scene.camera.width())
            .into_par_iter()
            .map(|mut band| {
                band.measure(context, &camera_pass, &maps, &extents, moment);
                band.readers
            })
            .collect::<Vec<_>>();
        let sum = |one: PerSet<u64>, other| one.zip_with(other, |one, other| one + other);
        all.readers = readers.into_iter().fold(PerSet::default(), sum);
        all.stored = stored;
        all
    }

    fn blank(scene: &Scene) -> Self {
        let count = scene.camera.pixel_count();
        let crosses_media = !scene.media.is_empty();
        Self {
            radii: vec![PixelRadii::splat(None); count],
            visible: vec![None; count],
            volume: vec![PixelVolumeCounts::default(); if crosses_media { count } else { 0 }],
            ..Self::default()
        }
    }

    /// Divides the pixels into bands of [`BLOCK`] rows.
    fn bands(&mut self, width: usize) -> Vec<BandSurvey<'_>> {
        let band = BLOCK * width;
        let mut volume = self.volume.chunks_mut(band);
        let surfaces = self.radii.chunks_mut(band).zip(self.visible.chunks_mut(band));
        surfaces
            .enumerate()
            .map(|(number, (radii, visible))| BandSurvey {
                first_pixel: number * band,
                radii,
                visible,
                volume: volume.next().unwrap_or_default(),
                readers: PerSet::default(),
            })
            .collect()
    }

    /// Merges the measurements of the same pixels at another time. A pixel keeps the smaller radii.
    pub(super) fn merge(&mut self, other: Self) {
        if self.radii.is_empty() {
            *self = other;
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
        self.stored = self.stored.zip_with(other.stored, DepositCounts::max);
        self.readers = self.readers.zip_with(other.readers, |one, other| one + other);
    }
}

struct BandSurvey<'s> {
    first_pixel: usize,
    radii: &'s mut [PixelRadii<Option<f32>>],
    visible: &'s mut [Option<VisiblePoint>],
    /// This slice is empty if the scene has no media.
    volume: &'s mut [PixelVolumeCounts],
    readers: PerSet<u64>,
}

impl BandSurvey<'_> {
    fn measure<'a>(
        &mut self,
        context: &PassContext<'_>,
        camera_pass: &CameraPass<'a>,
        maps: &PerSet<SurveyMaps>,
        extents: &[f64],
        moment: u64,
    ) {
        let (width, count) = (camera_pass.scene.camera.width(), self.radii.len());
        let largest_px = largest_surface_radii_px(width, camera_pass.scene.camera.pixel_count());
        let mut buffers = PathBuffers::recording();
        let streams = context.budget.seed.streams(Purpose::SurveyCamera);
        let widths = VolumeKernelWidths::of(context);
        for first_column in (0..width).step_by(BLOCK) {
            let columns = first_column..(first_column + BLOCK).min(width);
            let mut block = BlockSurvey::default();
            for index in (0..count / width).flat_map(|row| columns.clone().map(move |column| row * width + column)) {
                let pixel = (self.first_pixel + index) as u64;
                let sampler = PixelSampler::new(streams, moment, pixel);
                let (no_radii, mut tally) = (PixelRadii::splat(0.0), Tally::default());
                camera_pass.sample(pixel, sampler, &no_radii, &mut buffers, &mut tally, &mut NullSink);
                self.radii[index] = block.surface_radii(context, maps, (extents, largest_px), &buffers.visible_points);
                if let Some(counts) = self.volume.get_mut(index) {
                    let media = &camera_pass.scene.media;
                    let samples = PerSet { free: &maps.free.volume, shared: &maps.shared.volume };
                    *counts = block.volume_counts(&buffers.camera_segments, |segments| {
                        PixelVolumeCounts::along(segments, media, samples, &widths)
                    });
                }
                let reads = PerSet::from_fn(|set| {
                    let mut in_media = buffers.camera_segments.iter();
                    buffers.visible_points.iter().any(|point| point.reads(set))
                        || in_media.any(|segment| segment.reads(set))
                });
                self.readers.free += u64::from(reads.free);
                self.readers.shared += u64::from(reads.shared);
                let first = buffers.visible_points.iter().find(|point| point.is_diffuse).copied();
                self.visible[index] = first.filter(|point| point.view == CameraView::Direct);
            }
        }
    }
}

/// Pixels of a block share measurements where they see the same surface or cross the same media.
#[derive(Default)]
struct BlockSurvey {
    /// For each photon set, a visible point and the first radii there.
    surface: PerSet<Option<(VisiblePoint, PerClass<f64>)>>,
    volume: Option<(Vec<CameraSegment>, PixelVolumeCounts)>,
}

impl BlockSurvey {
    /// Returns the first radii at the visible points of a pixel. `extents` is that of each object
    /// in m, and `largest_px` limits the radii in pixels.
    fn surface_radii(
        &mut self,
        context: &PassContext<'_>,
        maps: &PerSet<SurveyMaps>,
        (extents, largest_px): (&[f64], PerClass<f64>),
        visible_points: &[VisiblePoint],
    ) -> PixelRadii<Option<f32>> {
        let mut radii = PixelRadii::splat(None);
        for set in [PhotonSet::Free, PhotonSet::Shared] {
            // Paths read more photons at diffuse surfaces than at glossy surfaces.
            let points = || visible_points.iter().rev();
            let reads_set = |point: &&VisiblePoint| point.reads(set);
            let diffuse = points().filter(|point| point.is_diffuse).find(reads_set);
            let Some(point) = diffuse.or_else(|| points().find(reads_set)) else { continue };
            let known = self.surface[set].filter(|(known, _)| is_alike(known, point));
            let (_, found) = known.unwrap_or_else(|| {
                let extent_m = extents[point.object as usize];
                let least_m = point.footprint_m.min(LEAST_RADIUS_OF_OBJECT * extent_m);
                let found = PerClass::from_fn(|class| {
                    let object_m = LARGEST_RADIUS_OF_OBJECT * extent_m;
                    let largest_m = object_m.min(largest_px[class] * point.footprint_m);
                    let limits = RadiusLimits { least_m, largest_m, object_m };
                    maps[set].first_radius_m(context, point, limits, class)
                });
                (*point, found)
            });
            if known.is_none() {
                self.surface[set] = Some((*point, found));
            }
            radii.surface[set] = PerClass::from_fn(|class| Some(found[class] as f32).filter(|&radius| radius > 0.0));
        }
        radii
    }

    /// Returns the photons near the segments of a pixel. `count` counts them.
    fn volume_counts(
        &mut self,
        segments: &[CameraSegment],
        count: impl FnOnce(&[CameraSegment]) -> PixelVolumeCounts,
    ) -> PixelVolumeCounts {
        if segments.is_empty() {
            return PixelVolumeCounts::default();
        }
        match &self.volume {
            Some((known, counts)) if segments_are_alike(known, segments) => *counts,
            _ => {
                let counts = count(segments);
                self.volume = Some((segments.to_vec(), counts));
                counts
            }
        }
    }
}

/// Returns true if the segments of two pixels cross the same media along similar lengths.
fn segments_are_alike(one: &[CameraSegment], other: &[CameraSegment]) -> bool {
    let similar = |(one, other): (&CameraSegment, &CameraSegment)| {
        let (shorter, longer) = (one.length_m.min(other.length_m), one.length_m.max(other.length_m));
        (one.medium, one.shared) == (other.medium, other.shared) && shorter >= SIMILAR_LENGTH * longer
    };
    one.len() == other.len() && one.iter().zip(other).all(similar)
}

/// Returns the upper limits of the first kernel radii on surfaces, in pixels.
fn largest_surface_radii_px(width: usize, pixels: usize) -> PerClass<f64> {
    let of_picture = MAX_SURFACE_RADIUS_OF_PICTURE * width.min(pixels / width) as f64;
    PerClass { indirect: MAX_SURFACE_RADIUS_PX.indirect.min(of_picture.max(1.0)), ..MAX_SURFACE_RADIUS_PX }
}

/// Returns true if two visible points are close to each other on the same surface.
fn is_alike(one: &VisiblePoint, other: &VisiblePoint) -> bool {
    one.object == other.object
        && one.is_diffuse == other.is_diffuse
        && one.position.distance(other.position) <= 2.0 * BLOCK as f64 * one.footprint_m
        && one.continues_to(other.position, other.facing)
}

/// Returns the extent (m) of each object: the diagonal of a square with the middle side length of
/// the bounding box. For a square plate and a cube, this is the diagonal of a face, for a thin rod
/// about the diameter. It is infinite without surface.
fn object_extents(scene: &Scene) -> Vec<f64> {
    let mut extents = vec![f64::INFINITY; scene.objects.len()];
    for (object, (low, high)) in scene.geometry.object_bounds() {
        let mut sides = (high - low).to_array();
        sides.sort_by(f64::total_cmp);
        extents[object as usize] = SQRT_2 * sides[1];
    }
    extents
}

/// Returns the fraction of a pass's `photons` paths at one of `moments` shutter times.
fn photon_fraction(photons: u64, moments: usize) -> f64 {
    (PHOTON_FRACTION / moments as f64).max(MIN_PHOTONS / photons.max(1) as f64).min(1.0)
}

/// The limits of a first kernel radius on a surface.
#[derive(Clone, Copy)]
struct RadiusLimits {
    /// The lower limit in m.
    least_m: f64,
    /// The upper limit in m.
    largest_m: f64,
    /// The upper limit in m if the kernel contained almost no photons.
    object_m: f64,
}

/// The photons of one set that the survey traced at one shutter time.
struct SurveyMaps {
    surface: PerClass<PhotonMap>,
    volume: PerClass<VolumeSamples>,
    /// The survey's photons in the first radius, where a pass has as many as the budget.
    nearest: NonZero<usize>,
    /// The least number of indirect photons of the survey within the first radius on a surface.
    fewest: NonZero<usize>,
}

impl SurveyMaps {
    /// Indexes the photons of a survey of the `fraction` of a pass's paths.
    fn new(deposits: &PhotonDeposits, context: &PassContext<'_>, fraction: f64) -> Self {
        let of_pass = |count: f64| NonZero::new((fraction * count).round() as usize).unwrap_or(NonZero::<usize>::MIN);
        let volume = context.plan.volume;
        Self {
            surface: PerClass::from_fn(|class| PhotonMap::build(&deposits.surface[class])),
            volume: PerClass::from_fn(|class| VolumeSamples::new(&deposits.volume[class], volume, fraction.recip())),
            nearest: of_pass(f64::from(context.budget.nearest)),
            fewest: of_pass(FEWEST_PHOTONS),
        }
    }

    /// Returns the first radius in m at a visible point. Unless the scene fixes it, the kernel
    /// contains as many photons as the budget specifies, within the limits. It is larger if a
    /// kernel of the largest radius contained almost no indirect photons.
    fn first_radius_m(
        &self,
        context: &PassContext<'_>,
        point: &VisiblePoint,
        limits: RadiusLimits,
        class: PhotonClass,
    ) -> f64 {
        if let Some(fixed) = context.budget.radius_m {
            return fixed;
        }
        let RadiusLimits { least_m, largest_m, object_m } = limits;
        let position = point.position.as_vec3().to_array();
        let distance =
            |count, largest_m: f64| self.surface[class].kth_distance(position, count, largest_m as f32).map(f64::from);
        let kth = distance(self.nearest, largest_m);
        let radius = radius::first(kth, least_m, largest_m);
        match (class, kth) {
            (PhotonClass::Indirect, None) => distance(self.fewest, object_m).map_or(radius, |few| radius.max(few)),
            (PhotonClass::Indirect, Some(_)) | (PhotonClass::Caustic, _) => radius,
        }
    }
}

struct NullSink;

impl Sink for NullSink {
    fn radiance(&mut self, _origin: LightOrigin, _nm: f64, _weight: f64) {}

    fn biased(&mut self, _origin: LightOrigin, _nm: f64, _weight: f64, _bias: f64) {}

    fn respond(&mut self, _class: PathClass, _radiance: SensorResponse, _bias: SensorResponse) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_survey_traces_a_quarter_of_a_pass_but_enough() {
        assert_eq!(photon_fraction(200_000, 1), 0.25);
        assert_eq!(photon_fraction(200_000, 4), 0.0625);
        assert_eq!(photon_fraction(20_000, 4), 0.5, "at least 10,000 paths");
        assert_eq!(photon_fraction(5_000, 1), 1.0);
        assert_eq!(photon_fraction(0, 1), 1.0, "an unused set");
    }
}
