//! First kernel radii in media, and probabilities of storing photons in media.
//!
//! Both follow from the number of pilot photons near each camera ray.

use super::context::PassContext;
use super::deposits::{PhotonDeposits, VolumeDeposits};
use super::keep_probability::KeepProbability;
use crate::gather::CameraSegment;
use crate::map::{KernelWidth, PixelRadii, QueryCone, SetMaps, VolumeMaps};
use crate::plan::partition::{PerClass, PerSet, PhotonClass, PhotonSet};
use crate::scene::medium::Medium;
use crate::spectrum::REFERENCE_NM;

/// The desired number of photons of one class within the first radius around a camera ray. This
/// number is smaller than the number for a surface point, because a ray collects photons along its
/// whole length.
const PHOTONS_PER_RAY: f64 = 10.0;

/// The lower limit of the first kernel radius in media, in pixels.
const MIN_VOLUME_RADIUS_PX: f64 = 0.7;

/// The upper limit of the first kernel radius in media, in pixels. The limit for caustics is
/// smaller because caustics have sharp edges.
const MAX_VOLUME_RADIUS_PX: PerClass<f64> = PerClass { caustic: 4.0, indirect: 24.0 };

/// The upper limit of the first kernel radius for photon points, in mean free paths.
///
/// Most light that leaves a dense medium comes from points near its boundary. A kernel near the
/// boundary finds no photons outside the medium, so the estimate loses light in proportion to the
/// radius.
const MAX_RADIUS_FREE_PATHS: f64 = 0.5;

/// The largest number of photon points of one class in the maps of the pilot.
const PILOT_POINTS: usize = 10_000;

/// The largest number of photon beams of one class in the maps of the pilot.
const PILOT_BEAMS: usize = 2_000;

/// The largest number of photon points of one class that a photon set stores in a pass. A photon in
/// a dense medium leaves hundreds of points. Most of these points add little information.
const MAX_POINTS: f64 = 50_000.0;

/// The largest number of photon beams of one class that a photon set stores in a pass.
const MAX_BEAMS: f64 = 15_000.0;

/// The pilot's first kernel widths in media.
#[derive(Debug, Clone, Copy)]
pub(super) struct VolumeKernelWidths {
    /// The angle that a pixel subtends, in rad.
    pixel_angle: f64,
    /// The radius in m, if the scene fixes it.
    radius_m: Option<f64>,
}

/// The photons of one set and class near a camera ray. A photon is near if its distance from the
/// ray is within the upper limit of the first radius. The counts are scaled as if the media stored
/// all photons.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct NearbyPhotons {
    /// The weighted number of points. The weight of a point is the transmittance of the medium
    /// between the point and the start of the camera segment.
    points: f64,
    /// The number of beams.
    beams: f64,
    /// The mean optical depth around the points, with the same weights as `points`. It is measured
    /// at each point, along a length that appears one radian wide from the camera.
    free_paths: f64,
}

/// The photons near the camera rays of a pixel, per set. The entry of a set is `None` if no camera
/// path that carries the set's wavelengths crosses a medium.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct PixelVolumeCounts(PerSet<Option<PerClass<NearbyPhotons>>>);

/// The photon maps of a set in the pilot.
#[derive(Debug)]
pub(super) struct PilotMaps {
    pub(super) maps: SetMaps,
    /// The share of the traced photons that the maps of media contain.
    pub(super) kept: PerClass<KeepProbability>,
}

/// The number of photons of one class stored in media.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct DepositCounts {
    points: usize,
    beams: usize,
}

impl VolumeKernelWidths {
    /// Returns the first kernel widths for a render. They depend on its camera and its budget.
    pub(super) fn of(context: &PassContext<'_>) -> Self {
        Self { pixel_angle: context.scene.camera.pixel_angle(), radius_m: context.budget.radius_m }
    }

    /// Returns the upper limit of the first kernel width for a class. If the scene fixes the
    /// radius, returns this radius.
    fn largest(&self, class: PhotonClass) -> KernelWidth {
        let per_distance = || KernelWidth::PerDistance(MAX_VOLUME_RADIUS_PX[class] * self.pixel_angle);
        self.radius_m.map_or_else(per_distance, KernelWidth::Stated)
    }

    /// Returns the upper limit of the first kernel width of caustics, divided by its lower limit.
    fn caustic_ratio(&self) -> f64 {
        if self.radius_m.is_some() { 1.0 } else { MAX_VOLUME_RADIUS_PX.caustic / MIN_VOLUME_RADIUS_PX }
    }
}

impl PixelVolumeCounts {
    /// Counts the photons near the camera segments of a pixel. The result contains the largest of
    /// each count over all segments.
    pub(super) fn along(
        camera_segments: &[CameraSegment],
        media: &[Medium],
        maps: &PerSet<PilotMaps>,
        widths: &VolumeKernelWidths,
    ) -> Self {
        let mut counts = Self::default();
        for segment in camera_segments {
            let set = PhotonSet::of_path(segment.shared);
            let PilotMaps { maps, kept } = &maps[set];
            let here = PerClass::from_fn(|class| {
                NearbyPhotons::count(segment, media, &maps[class].volume, kept[class], widths.largest(class))
            });
            let known = &mut counts.0[set];
            *known = Some(known.map_or(here, |known| known.zip_with(here, NearbyPhotons::max)));
        }
        counts
    }

    /// Compares the counts at two shutter times. Returns the larger value of each count.
    pub(super) fn max(self, other: Self) -> Self {
        Self(self.0.zip_with(other.0, |one, other| match (one, other) {
            (Some(one), Some(other)) => Some(one.zip_with(other, NearbyPhotons::max)),
            (one, None) | (None, one) => one,
        }))
    }

    /// Sets the pixel's first radii in media. `keep` contains the probabilities of storing photons
    /// in a pass.
    pub(super) fn set_radii(
        &self,
        radii: &mut PixelRadii<Option<f32>>,
        keep: PerClass<KeepProbability>,
        widths: &VolumeKernelWidths,
    ) {
        for set in [PhotonSet::Free, PhotonSet::Shared] {
            let Some(nearby) = self.0[set] else { continue };
            for class in PhotonClass::ALL {
                let radius = nearby[class].first_radius(keep[class], MAX_VOLUME_RADIUS_PX[class] * widths.pixel_angle);
                let radius = radius.max(MIN_VOLUME_RADIUS_PX * widths.pixel_angle) as f32;
                radii.volume[set][class] = Some(radius);
            }
        }
    }
}

impl NearbyPhotons {
    /// Counts the photons within a kernel width around a camera segment. `kept` is the share of the
    /// traced photons that the maps contain.
    fn count(
        segment: &CameraSegment,
        media: &[Medium],
        maps: &VolumeMaps,
        kept: KeepProbability,
        width: KernelWidth,
    ) -> Self {
        let CameraSegment { ray, length_m, behind_m, medium: number, .. } = *segment;
        let medium = &media[number];
        let cone = QueryCone::of_camera(ray, length_m, behind_m, width);
        let (mut points, mut beams, mut free_paths) = (0.0, 0.0, 0.0);
        maps.points.along(&cone, |found| {
            if found.medium == number {
                let transmittance = (-medium.optical_depth(REFERENCE_NM, medium.column_m(&ray, found.t))).exp();
                let across_m = (behind_m + found.t) * medium.density_at(ray.at(found.t));
                points += transmittance;
                free_paths += transmittance * medium.optical_depth(REFERENCE_NM, across_m);
            }
        });
        maps.beams.along(&cone, |found| {
            if found.medium == number {
                beams += 1.0;
            }
        });
        let free_paths = if points > 0.0 { free_paths / points } else { 0.0 };
        Self { points: points / kept.points, beams: beams / kept.beams, free_paths }
    }

    fn max(self, other: Self) -> Self {
        Self {
            points: self.points.max(other.points),
            beams: self.beams.max(other.beams),
            free_paths: self.free_paths.max(other.free_paths),
        }
    }

    /// Returns the ratio of the first radius to the distance from the camera. The ratio is at most
    /// `largest`. `keep` contains the probabilities of storing photons in a pass.
    fn first_radius(&self, keep: KeepProbability, largest: f64) -> f64 {
        let within =
            |found: f64, dimensions: f64| (PHOTONS_PER_RAY / found.max(PHOTONS_PER_RAY)).powf(1.0 / dimensions);
        let narrow = within(self.points * keep.points, 2.0).min(within(self.beams * keep.beams, 1.0));
        (largest * narrow).min(MAX_RADIUS_FREE_PATHS / self.free_paths)
    }
}

impl DepositCounts {
    /// Counts the stored photons of each class.
    pub(super) fn of(deposits: &PhotonDeposits) -> PerClass<Self> {
        PerClass::from_fn(|class| {
            let VolumeDeposits { points, beams } = &deposits.volume[class];
            Self { points: points.len(), beams: beams.len() }
        })
    }

    /// Compares the counts of two sets or two shutter times. Returns the larger value of each
    /// count.
    pub(super) fn max(self, other: Self) -> Self {
        Self { points: self.points.max(other.points), beams: self.beams.max(other.beams) }
    }
}

/// Reduces a list to at most `most` items. These items are evenly spaced in the list. Returns the
/// share of the items that remain.
fn thin_out<T: Copy>(items: &mut Vec<T>, most: usize) -> f64 {
    let step = items.len().div_ceil(most).max(1);
    *items = items.iter().copied().step_by(step).collect();
    1.0 / step as f64
}

/// Reduces the number of photons in media to the pilot's limits. Returns the share of the photons
/// that remain.
pub(super) fn thin_out_for_pilot(deposits: &mut PhotonDeposits) -> PerClass<KeepProbability> {
    PerClass::from_fn(|class| {
        let VolumeDeposits { points, beams } = &mut deposits.volume[class];
        KeepProbability { points: thin_out(points, PILOT_POINTS), beams: thin_out(beams, PILOT_BEAMS) }
    })
}

/// Returns probabilities of storing photons in media, chosen so that each pass stores enough
/// photons.
///
/// For each set and class, the number of points and the number of beams are limited. A second limit
/// applies to beams. Among the camera rays with beams around them, the mean number of beams per ray
/// is at most [`PHOTONS_PER_RAY`]. For caustics, the beams are counted within the lower limit of
/// the first radius. For indirect light, which is smooth, they are counted within the upper limit.
/// If the scene fixes the radius, all beams are counted within that radius.
pub(super) fn keep_probabilities(
    pixels: &[PixelVolumeCounts],
    stored: PerClass<DepositCounts>,
    widths: &VolumeKernelWidths,
) -> PerClass<KeepProbability> {
    let beams_per_ray = |class: PhotonClass| {
        let all = pixels.iter().flat_map(|counts| [counts.0.free, counts.0.shared]).flatten();
        let counts = all.map(|nearby| nearby[class].beams).filter(|&beams| beams > 0.0);
        let (rays, sum) = counts.fold((0.0, 0.0), |(rays, sum), beams| (rays + 1.0, sum + beams));
        sum / f64::max(rays, 1.0)
    };
    let at_most = |count: usize, most: f64| most / (count as f64).max(most);
    PerClass::from_fn(|class| {
        let beams = match class {
            PhotonClass::Caustic => beams_per_ray(class) / widths.caustic_ratio(),
            PhotonClass::Indirect => beams_per_ray(class),
        };
        KeepProbability {
            points: at_most(stored[class].points, MAX_POINTS),
            beams: (PHOTONS_PER_RAY / beams.max(PHOTONS_PER_RAY)).min(at_most(stored[class].beams, MAX_BEAMS)),
        }
    })
}
