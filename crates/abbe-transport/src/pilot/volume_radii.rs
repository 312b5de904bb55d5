//! First kernel radii and probabilities in media, from the photons near each camera ray.

use super::keep_probability::DepositCounts;
use super::volume_samples::{NearbyPhotons, VolumeSamples};
use crate::gather::CameraSegment;
use crate::map::{KernelWidth, PixelRadii};
use crate::pass::{KeepProbability, PassContext};
use crate::plan::partition::{PerClass, PerSet, PhotonClass, PhotonSet};
use abbe_scene::medium::Medium;
use abbe_spectra::math::elementary::powf;
use std::iter;

/// The photons of one class within the first radius around a camera ray: fewer than at a surface
/// point, because a ray collects along its whole length.
const PHOTONS_PER_RAY: f64 = 10.0;

/// The same for photon points. Dense media spread their light evenly over a free path, and a kernel
/// contains several points of the same photon.
const POINTS_PER_RAY: f64 = 30.0;

/// The lower limit of the first kernel radius in media, in pixels.
const MIN_VOLUME_RADIUS_PX: f64 = 0.7;

/// The largest, in pixels. Caustics have sharp edges.
const MAX_VOLUME_RADIUS_PX: PerClass<f64> = PerClass { caustic: 4.0, indirect: 24.0 };

/// The largest, as a fraction of the shorter side: 24 pixels blur bodies on a small film.
const MAX_VOLUME_RADIUS_OF_PICTURE: f64 = 0.1;

/// The largest for indirect light, divided by the distance from the camera, if the other limits
/// leave almost no photons near a ray and the camera is in or near the medium. In fog of a large
/// world, 24 pixels may contain one photon in a thousand passes.
const WIDEST_KERNEL: f64 = 1.0;

/// The largest for photon points, in mean free paths. Most light leaves a dense medium near its
/// boundary, where a kernel finds no photons outside, so the estimate loses light in proportion to
/// the radius.
const MAX_RADIUS_FREE_PATHS: f64 = 0.5;

/// The camera segments of a pixel at which the pilot counts photons. Reflections inside glass can
/// leave many, but the light of later ones is faint.
const MAX_SEGMENTS: usize = 8;

#[derive(Debug, Clone, Copy)]
pub(super) struct VolumeKernelWidths {
    /// The angle that a pixel subtends, in rad.
    pixel_angle: f64,
    /// The upper limit of the first kernel width, in pixels.
    largest_px: PerClass<f64>,
    /// The radius in m, if the scene fixes it.
    radius_m: Option<f64>,
}

/// The photons near a ray, per set; `None` if no camera path with its wavelengths crosses a medium.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct PixelVolumeCounts(PerSet<Option<PerClass<NearbyPhotons>>>);

impl VolumeKernelWidths {
    /// Returns the first kernel widths for a render. They depend on its camera and its budget.
    pub(super) fn of(context: &PassContext<'_>) -> Self {
        let camera = &context.scene.camera;
        let (width, pixels) = (camera.width(), camera.pixel_count());
        let of_picture = MAX_VOLUME_RADIUS_OF_PICTURE * width.min(pixels / width) as f64;
        let largest_px =
            PerClass::from_fn(|class| MAX_VOLUME_RADIUS_PX[class].min(of_picture).max(MIN_VOLUME_RADIUS_PX));
        let pixel_angle = camera.pixel_angle_at(context.scene.radius_m);
        Self { pixel_angle, largest_px, radius_m: context.budget.radius_m }
    }

    /// Returns the upper limits of the first width: each applies if a kernel of this width contains
    /// photons, or else the next. If the scene fixes the radius, it is the only one.
    fn largest(&self, class: PhotonClass, segment: &CameraSegment) -> impl Iterator<Item = KernelWidth> {
        let first = self.largest_px[class] * self.pixel_angle;
        let is_close = segment.behind_m < segment.length_m;
        let widest = if class == PhotonClass::Indirect && is_close { WIDEST_KERNEL } else { first };
        let wider = move |width: &f64| (*width < widest).then(|| (2.0 * width).min(widest));
        let per_distance = iter::successors(Some(first), wider).map(KernelWidth::PerDistance);
        let explicit = self.radius_m.map(KernelWidth::Constant);
        explicit.into_iter().chain(per_distance.take(if explicit.is_some() { 0 } else { usize::MAX }))
    }

    /// Returns the upper limit of the first kernel width of caustics, divided by its lower limit.
    fn caustic_ratio(&self) -> f64 {
        if self.radius_m.is_some() { 1.0 } else { self.largest_px.caustic / MIN_VOLUME_RADIUS_PX }
    }
}

impl PixelVolumeCounts {
    /// Counts along the segment with the most photons.
    pub(super) fn along(
        camera_segments: &[CameraSegment],
        media: &[Medium],
        samples: PerSet<&PerClass<VolumeSamples>>,
        widths: &VolumeKernelWidths,
    ) -> Self {
        let mut counts = Self::default();
        for segment in camera_segments.iter().take(MAX_SEGMENTS) {
            let medium = &media[segment.medium];
            for set in [PhotonSet::Free, PhotonSet::Shared].into_iter().filter(|set| segment.reads(*set)) {
                let samples = samples[set];
                let here =
                    PerClass::from_fn(|class| samples[class].count(segment, medium, widths.largest(class, segment)));
                let known = &mut counts.0[set];
                *known = Some(known.map_or(here, |known| known.zip_with(here, NearbyPhotons::denser)));
            }
        }
        counts
    }

    /// Compares the counts at two shutter times. Returns the larger value of each count.
    pub(super) fn max(self, other: Self) -> Self {
        Self(self.0.zip_with(other.0, |one, other| match (one, other) {
            (Some(one), Some(other)) => Some(one.zip_with(other, NearbyPhotons::denser)),
            (one, None) | (None, one) => one,
        }))
    }

    /// Sets the first radii in media, for the `keep` of a pass.
    pub(super) fn set_radii(
        &self,
        radii: &mut PixelRadii<Option<f32>>,
        keep: PerClass<KeepProbability>,
        widths: &VolumeKernelWidths,
    ) {
        for set in [PhotonSet::Free, PhotonSet::Shared] {
            let Some(nearby) = self.0[set] else { continue };
            for class in PhotonClass::ALL {
                let radius = nearby[class].first_radius(keep[class]);
                let radius = radius.max(MIN_VOLUME_RADIUS_PX * widths.pixel_angle) as f32;
                radii.volume[set][class] = Some(radius);
            }
        }
    }
}

impl NearbyPhotons {
    /// Returns the ratio of radius and distance from the camera. `keep` is that of a pass.
    fn first_radius(&self, keep: KeepProbability) -> f64 {
        let within = |found: f64, dimensions: f64| powf(PHOTONS_PER_RAY / found.max(PHOTONS_PER_RAY), 1.0 / dimensions);
        let [points, beams, free_paths, width] = [self.points, self.beams, self.free_paths, self.width].map(f64::from);
        let points = points * keep.points * PHOTONS_PER_RAY / POINTS_PER_RAY;
        let narrow = within(points, 2.0).min(within(beams * keep.beams, 1.0));
        (width * narrow).min(MAX_RADIUS_FREE_PATHS / free_paths)
    }
}

/// Returns probabilities for which each pass stores enough photons.
///
/// For each set and class, the points and the beams are limited. Among the camera rays with beams
/// around them, the mean number of beams per ray is also at most [`PHOTONS_PER_RAY`]: counted
/// within the lower limit of the first radius for caustics, within the upper limit for smooth
/// indirect light, or within the radius that the scene fixes.
pub(super) fn keep_probabilities(
    pixels: &[PixelVolumeCounts],
    stored: PerClass<DepositCounts>,
    widths: &VolumeKernelWidths,
) -> PerClass<KeepProbability> {
    let beams_per_ray = |class: PhotonClass| {
        let all = pixels.iter().flat_map(|counts| [counts.0.free, counts.0.shared]).flatten();
        let counts = all.map(|nearby| f64::from(nearby[class].beams)).filter(|&beams| beams > 0.0);
        let (rays, sum) = counts.fold((0.0, 0.0), |(rays, sum), beams| (rays + 1.0, sum + beams));
        sum / f64::max(rays, 1.0)
    };
    PerClass::from_fn(|class| {
        let beams = match class {
            PhotonClass::Caustic => beams_per_ray(class) / widths.caustic_ratio(),
            PhotonClass::Indirect => beams_per_ray(class),
        };
        let limits = KeepProbability::within_limits(stored[class]);
        KeepProbability { beams: limits.beams.min(PHOTONS_PER_RAY / beams.max(PHOTONS_PER_RAY)), ..limits }
    })
}
