//! Samples of the pilot's photons in media. The cost of a count must not depend on the number of
//! photons, so a camera segment counts in small samples, until it has found enough.

use super::keep_probability::DepositCounts;
use crate::gather::CameraSegment;
use crate::map::{KernelWidth, PhotonBeam, QueryCone, VolumeMap};
use crate::pass::{KeepProbability, VolumeDeposits};
use crate::plan::VolumePlan;
use abbe_scene::medium::Medium;
use abbe_spectra::math::elementary::exp;
use abbe_spectra::spectrum::REFERENCE_NM;

/// The points in the samples, in the order of the search.
const POINT_SAMPLES: [usize; 4] = [256, 1024, 4096, 16_384];

const BEAM_SAMPLE: usize = 256;

/// The number of photons at which a segment stops counting. More would hardly change the radius,
/// which depends on a root of the number.
const ENOUGH: f64 = 16.0;

/// A kernel width contains enough photons if a pass stores at least this number within it.
const FEWEST: f64 = 8.0;

/// The points at which a segment stops counting, even if most are hidden by the medium.
const ENOUGH_HIDDEN: u32 = 256;

/// The photons of one set and class near a camera ray, within the upper limit of the first radius,
/// as if the media stored all photons of a pass. In single precision, because the pilot keeps them
/// for each pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct NearbyPhotons {
    /// Weighted by the transmittance between each point and the start of the segment.
    pub(super) points: f32,
    pub(super) beams: f32,
    /// The mean optical depth around the points with these weights, along a length that appears one
    /// radian wide from the camera.
    pub(super) free_paths: f32,
    /// The kernel width of the count: the ratio of the radius to the distance from the camera,
    /// unless the scene fixes the radius.
    pub(super) width: f32,
}

/// Samples of the photons of one set and class that the pilot traced in media.
#[derive(Debug)]
pub(super) struct VolumeSamples {
    plan: VolumePlan,
    points: Vec<PointSample>,
    /// Beams in the order of emission.
    beams: Vec<PhotonBeam>,
    pass_per_beam: f64,
    /// The probabilities of storing photons, as far as the limits of a pass determine them.
    keep: KeepProbability,
}

#[derive(Debug)]
struct PointSample {
    map: VolumeMap,
    pass_per_point: f64,
}

impl VolumeSamples {
    /// `pass_per_pilot` is the ratio of the photon paths of a pass and of the pilot.
    pub(super) fn new(deposits: &VolumeDeposits, plan: VolumePlan, pass_per_pilot: f64) -> Self {
        let sample = |number: usize| {
            let points = evenly_spaced(&deposits.points, number);
            let pass_per_point = pass_per_pilot * deposits.points.len() as f64 / points.len() as f64;
            PointSample { map: VolumeMap::of_points(points, &[]), pass_per_point }
        };
        let beams = evenly_spaced(&deposits.beams, BEAM_SAMPLE);
        let largest = POINT_SAMPLES.iter().position(|&number| number >= deposits.points.len());
        let samples = largest.map_or(POINT_SAMPLES.len(), |largest| largest + 1);
        let points = if deposits.points.is_empty() { &[] } else { &POINT_SAMPLES[..samples] };
        Self {
            plan,
            points: points.iter().map(|&number| sample(number)).collect(),
            pass_per_beam: pass_per_pilot * deposits.beams.len() as f64 / beams.len().max(1) as f64,
            beams,
            keep: KeepProbability::within_limits(DepositCounts::of(deposits, pass_per_pilot)),
        }
    }

    /// Counts the photons within the first width that contains enough, or the last.
    pub(super) fn count(
        &self,
        segment: &CameraSegment,
        medium: &Medium,
        widths: impl Iterator<Item = KernelWidth>,
    ) -> NearbyPhotons {
        let mut nearby = NearbyPhotons::default();
        for width in widths {
            nearby = self.count_within(segment, medium, width);
            let stored = f64::from(nearby.points) * self.keep.points + f64::from(nearby.beams) * self.keep.beams;
            if stored >= FEWEST {
                break;
            }
        }
        nearby
    }

    fn count_within(&self, segment: &CameraSegment, medium: &Medium, width: KernelWidth) -> NearbyPhotons {
        let cone = QueryCone::of_camera(segment.ray, segment.length_m, segment.behind_m, width);
        let (KernelWidth::Constant(number) | KernelWidth::PerDistance(number)) = width;
        let mut nearby = NearbyPhotons { width: number as f32, ..NearbyPhotons::default() };
        if self.plan.keeps_beams(medium.dense) {
            nearby.beams = self.count_beams(&cone, segment.medium) as f32;
        }
        if self.plan.keeps_points(medium.dense) {
            self.count_points(segment, medium, &cone, &mut nearby);
        }
        nearby
    }

    fn count_beams(&self, cone: &QueryCone, medium: usize) -> f64 {
        let (mut tested, mut found) = (0.0, 0.0);
        for beam in &self.beams {
            tested += 1.0;
            found += f64::from(u8::from(beam.medium_near_ray(cone) == Some(medium)));
            if found >= ENOUGH {
                break;
            }
        }
        // With no beams, `tested` is 0.
        found * self.pass_per_beam * self.beams.len() as f64 / f64::max(tested, 1.0)
    }

    /// Counts the points near a camera segment, and measures the optical depth around them.
    fn count_points(
        &self,
        CameraSegment { ray, behind_m, medium: number, .. }: &CameraSegment,
        medium: &Medium,
        cone: &QueryCone,
        nearby: &mut NearbyPhotons,
    ) {
        for PointSample { map, pass_per_point } in &self.points {
            let (mut found, mut visible, mut free_paths) = (0, 0.0, 0.0);
            map.along(cone, |near| {
                if near.medium == *number {
                    let transmittance = exp(-medium.optical_depth(REFERENCE_NM, medium.column_m(ray, near.t)));
                    let across_m = (behind_m + near.t) * medium.density_at(ray.at(near.t));
                    found += 1;
                    visible += transmittance;
                    free_paths += transmittance * medium.optical_depth(REFERENCE_NM, across_m);
                }
            });
            nearby.points = (visible * pass_per_point) as f32;
            nearby.free_paths = if visible > 0.0 { (free_paths / visible) as f32 } else { 0.0 };
            if visible >= ENOUGH || found >= ENOUGH_HIDDEN {
                return;
            }
        }
    }
}

impl NearbyPhotons {
    /// Returns the counts within the narrower kernels, or the larger of each count.
    pub(super) fn denser(self, other: Self) -> Self {
        if self.width < other.width {
            return self;
        }
        if self.width > other.width {
            return other;
        }
        Self {
            width: self.width,
            points: self.points.max(other.points),
            beams: self.beams.max(other.beams),
            free_paths: self.free_paths.max(other.free_paths),
        }
    }
}

/// Returns at most `most` items of a list. These items are evenly spaced in the list.
fn evenly_spaced<T: Copy>(items: &[T], most: usize) -> Vec<T> {
    items.iter().copied().step_by(items.len().div_ceil(most).max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{PhotonPower, VolumePhoton, WavelengthCode};
    use abbe_optics::phase::PhaseFunction;
    use abbe_scene::geometry::Ray;
    use abbe_scene::medium::Density;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};
    use abbe_spectra::spectrum::Spectrum;
    use glam::DVec3;
    use std::iter;

    /// Returns photons in a cube of fog. Each photon has a point and a beam.
    fn deposits(count: usize) -> VolumeDeposits {
        let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
        let mut place = || DVec3::new(stream.uniform(), stream.uniform(), stream.uniform());
        let power = PhotonPower::new(WavelengthCode::default(), [1.0; 4], None, 0.0);
        let ends: Vec<[DVec3; 2]> = (0..count).map(|_| [place(), place()]).collect();
        VolumeDeposits {
            points: ends.iter().map(|ends| VolumePhoton::new(ends[0], DVec3::X, 0, power)).collect(),
            beams: ends.iter().map(|ends| PhotonBeam::new(*ends, 0, power)).collect(),
            ..VolumeDeposits::default()
        }
    }

    /// The samples are small, and the counts in them agree with the counts among all photons.
    #[test]
    fn nearby_photons_are_counted_in_small_samples() {
        const COUNT: usize = 100_000;
        let (all, clear) = (deposits(COUNT), Spectrum::constant(0.0));
        let mut medium = Medium::new("fog".into(), (clear.clone(), clear), PhaseFunction::Isotropic, Density::Uniform);
        medium.dense = true;
        let ray = Ray::new(DVec3::new(-0.5, 0.45, 0.55), DVec3::X);
        let segment =
            CameraSegment { ray, length_m: 2.0, behind_m: 0.0, medium: 0, shared: false, is_fluorescent: false };
        for radius_m in [0.2, 0.05, 0.02] {
            let width = KernelWidth::Constant(radius_m);
            let cone = QueryCone::of_camera(ray, 2.0, 0.0, width);
            let (mut points, mut beams) = (0.0, 0.0);
            VolumeMap::of_points(all.points.clone(), &[]).along(&cone, |_| points += 1.0);
            all.beams.iter().for_each(|beam| beams += f64::from(u8::from(beam.medium_near_ray(&cone).is_some())));
            let of_points =
                VolumeSamples::new(&all, VolumePlan::Points, 4.0).count(&segment, &medium, iter::once(width));
            let of_beams = VolumeSamples::new(&all, VolumePlan::Beams, 4.0).count(&segment, &medium, iter::once(width));
            println!("{radius_m} m: {} of {points} points, {} of {beams} beams", of_points.points, of_beams.beams);
            assert!((f64::from(of_points.points) / (4.0 * points) - 1.0).abs() < 0.5);
            assert!((f64::from(of_beams.beams) / (4.0 * beams) - 1.0).abs() < 0.6);
            assert_eq!((of_points.beams, of_beams.points), (0.0, 0.0));
        }
        let samples = VolumeSamples::new(&all, VolumePlan::ByDensity, 1.0);
        assert!(samples.beams.len() <= BEAM_SAMPLE && samples.points.len() == POINT_SAMPLES.len());
    }

    #[test]
    fn kernels_become_wider_until_they_contain_photons() {
        let clear = Spectrum::constant(0.0);
        let mut medium = Medium::new("fog".into(), (clear.clone(), clear), PhaseFunction::Isotropic, Density::Uniform);
        medium.dense = true;
        let ray = Ray::new(DVec3::new(-0.5, 0.45, 0.55), DVec3::X);
        let segment =
            CameraSegment { ray, length_m: 2.0, behind_m: 1.0, medium: 0, shared: false, is_fluorescent: false };
        let widths = || [0.02, 0.1, 0.5, 2.5].into_iter().map(KernelWidth::PerDistance);
        for plan in [VolumePlan::Points, VolumePlan::Beams] {
            let width =
                |count: usize| VolumeSamples::new(&deposits(count), plan, 1.0).count(&segment, &medium, widths()).width;
            assert_eq!([width(100_000), width(0)], [0.02, 2.5], "{plan:?}");
            assert!([0.1, 0.5].contains(&width(30)), "{plan:?}: {}", width(30));
        }
    }

    #[test]
    fn no_photons_give_no_counts() {
        let none = VolumeSamples::new(&VolumeDeposits::default(), VolumePlan::Beams, 1.0);
        let cone = QueryCone { ray: Ray::new(DVec3::ZERO, DVec3::X), length_m: 1.0, radius_m: 1.0, slope: 0.0 };
        assert_eq!(none.count_beams(&cone, 0), 0.0);
    }
}
