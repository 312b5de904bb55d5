//! Bundles of parallel rays at an angle to the axis: the chief ray, which passes through the centre
//! of the stop, and the spot of the bundle on the sensor. All rays are traced exactly. The chief
//! ray lies in the meridional plane x = 0.

use glam::{DVec2, DVec3};

use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay, MonochromaticLens};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{cos, sin};

/// The spot of a bundle on the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensSpot {
    /// Height of the centroid above the axis in mm.
    pub centroid_mm: f64,
    /// Root mean square distance, in mm, of the rays from the centroid.
    pub rms_mm: f64,
    /// Number of rays of the bundle that reached the sensor.
    pub rays: usize,
}

/// A ray behind the lens, where it crosses the plane of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ImageRay {
    /// The point (x, y) in mm.
    pub(super) point_mm: DVec2,
    /// The slopes (dx/dz, dy/dz).
    pub(super) slope: DVec2,
}

impl ImageRay {
    /// Returns the crossing of a ray behind the lens with the plane z = `sensor_z_mm`.
    pub(super) fn of(ray: LensRay, sensor_z_mm: f64) -> Self {
        Self { point_mm: ray.at_z(sensor_z_mm).truncate(), slope: ray.direction.truncate() / ray.direction.z }
    }

    /// Returns the point in mm at which the ray crosses a plane `shift_mm` behind the sensor.
    pub(super) fn at(&self, shift_mm: f64) -> DVec2 {
        self.point_mm + shift_mm * self.slope
    }
}

/// First and smallest step of the field angle in degrees: the search for a chief ray follows the
/// moving pupil from the axis, and halves the step when it finds none.
const FIELD_STEP_DEG: f64 = 2.0;
const LEAST_STEP_DEG: f64 = 0.02;
/// Maximum number of Newton steps for a chief ray. About four steps are usual.
const MAX_CHIEF_RAY_STEPS: usize = 40;
/// Number of rays across a bundle, and its width relative to the pupil, for the apertures to cut.
const RAYS_ACROSS_BUNDLE: u32 = 96;
const BUNDLE_WIDTH: f64 = 2.0;

impl LensSpot {
    /// Returns the spot of rays on a plane `shift_mm` behind the sensor, or `None` without rays.
    pub(super) fn of(rays: &[ImageRay], shift_mm: f64) -> Option<Self> {
        if rays.is_empty() {
            return None;
        }
        let (count, points) = (rays.len() as f64, || rays.iter().map(|ray| ray.at(shift_mm)));
        let centroid = points().sum::<DVec2>() / count;
        let variance = points().map(|point| point.distance_squared(centroid)).sum::<f64>() / count;
        Some(Self { centroid_mm: centroid.y, rms_mm: variance.sqrt(), rays: rays.len() })
    }
}

impl MonochromaticLens<'_> {
    /// Returns the chief ray at a field angle in degrees, |angle| < 90, or an error if there is
    /// none. It travels in the meridional plane from the scene through the centre of the stop, and
    /// rises towards the sensor for positive angles. Apertures are ignored.
    pub fn chief_ray(&self, field_deg: f64) -> Result<LensRay> {
        let Some(pupil) = self.paraxial()?.entrance_pupil else {
            return Err(Error::input("the entrance pupil lies at infinity: parallel light has no chief ray"));
        };
        let (end, mut step) = (field_deg.to_radians(), FIELD_STEP_DEG.to_radians().copysign(field_deg));
        let (mut field, mut z_mm, mut drift) = (0.0, pupil.z_mm, 0.0);
        while field != end {
            let next = if (end - field).abs() <= step.abs() { end } else { field + step };
            let guess_mm = z_mm + drift * (next - field);
            if let Some(found_mm) = self.pupil_z_mm(next, guess_mm, pupil.diameter_mm) {
                drift = (found_mm - z_mm) / (next - field);
                (field, z_mm) = (next, found_mm);
            } else if step.abs() > LEAST_STEP_DEG.to_radians() {
                step *= 0.5;
            } else {
                let least = next.to_degrees();
                let what = format!("no ray at {field_deg} degrees passes through the centre of the stop");
                return Err(Error::input(what).expected(format!("a field below {least:.1} degrees")));
            }
        }
        Ok(ray_at(end, z_mm))
    }

    /// Returns z in mm where the incoming chief ray crosses the axis (Newton's method).
    fn pupil_z_mm(&self, field: f64, start_mm: f64, diameter_mm: f64) -> Option<f64> {
        let height = |z_mm: f64| self.stop_height_mm(ray_at(field, z_mm));
        let tolerance_mm = 1e-12 * self.lens().surfaces()[self.lens().stop()].semi_aperture_mm;
        let (mut z_mm, mut y_mm) = (start_mm, height(start_mm)?);
        for _ in 0..MAX_CHIEF_RAY_STEPS {
            if y_mm.abs() <= tolerance_mm {
                break;
            }
            let shift_mm = 1e-5 * diameter_mm;
            let mut step_mm = y_mm * shift_mm / (height(z_mm + shift_mm)? - y_mm);
            // The step is halved until the ray reaches the stop at a smaller height.
            let better = |step_mm: f64| height(z_mm - step_mm).filter(|next| next.abs() < y_mm.abs());
            let found = (0..20).find_map(|_| {
                better(step_mm).or_else(|| {
                    step_mm *= 0.5;
                    None
                })
            });
            let Some(next_mm) = found else { break };
            (z_mm, y_mm) = (z_mm - step_mm, next_mm);
        }
        (y_mm.abs() <= 1e6 * tolerance_mm).then_some(z_mm)
    }

    /// Returns the height in mm at which a ray crosses the stop, if it reaches the stop.
    fn stop_height_mm(&self, ray: LensRay) -> Option<f64> {
        let mut height_mm = None;
        let stop = self.lens().stop();
        let end = self.trace_through(ray, TraceDirection::ToSensor, ApertureCheck::Ignored, |i, point| {
            if i == stop {
                height_mm = Some(point.y);
            }
        });
        // A ray that is lost behind the stop still has a valid height there.
        end.map_or(height_mm, |_| height_mm)
    }

    /// Returns the spot of the bundle on the plane z = `sensor_z_mm`, or `None` if all is
    /// vignetted.
    pub fn spot(&self, chief: LensRay, sensor_z_mm: f64) -> Result<Option<LensSpot>> {
        Ok(LensSpot::of(&self.image_rays(chief, sensor_z_mm)?, 0.0))
    }

    /// Returns the unvignetted rays of the bundle where they reach the plane z = `sensor_z_mm`.
    pub(super) fn image_rays(&self, chief: LensRay, sensor_z_mm: f64) -> Result<Vec<ImageRay>> {
        let radius_mm = self.bundle_radius_mm()?;
        let offset = |i: u32| ((2 * i + 1) as f64 / f64::from(RAYS_ACROSS_BUNDLE) - 1.0) * radius_mm;
        let mut landed = Vec::new();
        for (i, j) in (0..RAYS_ACROSS_BUNDLE).flat_map(|i| (0..RAYS_ACROSS_BUNDLE).map(move |j| (i, j))) {
            landed.extend(self.image_ray(parallel_ray(chief, offset(i), offset(j)), sensor_z_mm));
        }
        Ok(landed)
    }

    /// Returns an unvignetted ray at the plane z = `sensor_z_mm`, or `None` if it is lost.
    pub(super) fn image_ray(&self, ray: LensRay, sensor_z_mm: f64) -> Option<ImageRay> {
        let out = self.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).ok()?;
        Some(ImageRay::of(out, sensor_z_mm))
    }

    /// Returns the signed perpendicular distances in mm from the chief ray of the lowest and the
    /// highest meridional ray that pass the lens, or `None` if all rays are vignetted.
    pub(super) fn passing_range_mm(&self, chief: LensRay) -> Result<Option<(f64, f64)>> {
        const MERIDIONAL_STEPS: u32 = 800;
        let radius_mm = self.bundle_radius_mm()?;
        let offsets =
            (0..=MERIDIONAL_STEPS).map(|i| (2.0 * f64::from(i) / f64::from(MERIDIONAL_STEPS) - 1.0) * radius_mm);
        let passes = |offset: &f64| {
            self.trace(parallel_ray(chief, 0.0, *offset), TraceDirection::ToSensor, ApertureCheck::Enforced).is_ok()
        };
        let passing: Vec<f64> = offsets.filter(passes).collect();
        Ok(passing.first().copied().zip(passing.last().copied()))
    }

    /// Returns half the width in mm of the bundle that the apertures cut.
    pub(super) fn bundle_radius_mm(&self) -> Result<f64> {
        Ok(self.paraxial()?.entrance_pupil.map_or(0.0, |pupil| 0.5 * BUNDLE_WIDTH * pupil.diameter_mm))
    }
}

/// Returns a meridional ray at a field angle in radians that crosses the axis at `z_mm`.
fn ray_at(field: f64, z_mm: f64) -> LensRay {
    LensRay { origin: DVec3::new(0.0, 0.0, z_mm), direction: DVec3::new(0.0, sin(field), cos(field)) }
}

/// Returns a ray parallel to the chief ray, `up_mm` in the meridional plane and `aside_mm` off it.
pub(super) fn parallel_ray(chief: LensRay, aside_mm: f64, up_mm: f64) -> LensRay {
    let up = DVec3::new(0.0, chief.direction.z, -chief.direction.y);
    LensRay { origin: chief.origin + DVec3::X * aside_mm + up * up_mm, ..chief }
}
