//! Bundles of parallel light at an angle to the axis: the chief ray, which goes through the middle of the stop, and the spot that a
//! bundle makes on the sensor. All of it by exact rays in the meridional plane x = 0 and around it.

use glam::{DVec2, DVec3};

use super::trace::{Limits, Monochromatic, Ray, Travel};
use crate::error::{Error, Result};

/// What a bundle leaves on the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Its centroid in mm above the axis.
    pub centroid_mm: f64,
    /// Root mean square distance from the centroid, in mm.
    pub rms_mm: f64,
    /// How many of the bundle's rays got through.
    pub rays: usize,
}

/// Steps of the angle, in degrees, in which a chief ray is followed outwards: pupils wander with the field. They are halved where
/// the pupil wanders fast, down to the least.
const FIELD_STEP_DEG: f64 = 2.0;
const LEAST_STEP_DEG: f64 = 0.02;
/// Steps of Newton's method on a chief ray; it takes about four.
const MAX_STEPS: usize = 40;
/// Rays across a bundle, which is twice as wide as the entrance pupil: apertures cut out what passes.
const ACROSS: u32 = 96;
const WIDTH: f64 = 2.0;

impl Monochromatic<'_> {
    /// The chief ray at a field angle in degrees, |angle| < 90: from the scene through the middle of the stop; its origin is on the
    /// axis. It rises towards the sensor for angles above 0. Apertures do not count. Fails where no such ray is found.
    pub fn chief_ray(&self, field_deg: f64) -> Result<Ray> {
        let Some(pupil) = self.paraxial()?.entrance_pupil else {
            return Err(Error::input("the entrance pupil lies at infinity: the lens sees no field of parallel light"));
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
                let what = format!("at {field_deg} degrees no ray goes through the middle of the stop");
                return Err(Error::input(what).expected(format!("a field below {least:.1} degrees")));
            }
        }
        Ok(ray_at(end, z_mm))
    }

    /// Where the chief ray crosses the axis, by Newton's method from a near value.
    fn pupil_z_mm(&self, field: f64, start_mm: f64, diameter_mm: f64) -> Option<f64> {
        let height = |z_mm: f64| self.stop_height_mm(ray_at(field, z_mm));
        let tolerance_mm = 1e-12 * self.lens().surfaces()[self.lens().stop()].semi_aperture_mm;
        let (mut z_mm, mut y_mm) = (start_mm, height(start_mm)?);
        for _ in 0..MAX_STEPS {
            if y_mm.abs() <= tolerance_mm {
                break;
            }
            let shift_mm = 1e-5 * diameter_mm;
            let mut step_mm = y_mm * shift_mm / (height(z_mm + shift_mm)? - y_mm);
            // A step that leads farther away, or to where no ray gets through, is halved.
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

    /// How high a ray goes at the stop, if it gets there.
    fn stop_height_mm(&self, ray: Ray) -> Option<f64> {
        let mut height_mm = None;
        let stop = self.lens().stop();
        let end = self.trace_through(ray, Travel::ToSensor, Limits::None, |i, point| {
            if i == stop {
                height_mm = Some(point.y);
            }
        });
        // Rays may be lost behind the stop: their height there counts all the same.
        end.map_or(height_mm, |_| height_mm)
    }

    /// The spot on the plane z = `sensor_z_mm` of the bundle around a chief ray, `None` where all of it is vignetted.
    pub fn spot(&self, chief: Ray, sensor_z_mm: f64) -> Result<Option<Spot>> {
        let radius_mm = self.bundle_radius_mm()?;
        let offset = |i: u32| ((2 * i + 1) as f64 / f64::from(ACROSS) - 1.0) * radius_mm;
        let mut landed = Vec::new();
        for (i, j) in (0..ACROSS).flat_map(|i| (0..ACROSS).map(move |j| (i, j))) {
            let ray = beside(chief, offset(i), offset(j));
            if let Ok(out) = self.trace(ray, Travel::ToSensor, Limits::Apertures) {
                landed.push(out.at_z(sensor_z_mm).truncate());
            }
        }
        if landed.is_empty() {
            return Ok(None);
        }
        let count = landed.len() as f64;
        let centroid = landed.iter().sum::<DVec2>() / count;
        let variance = landed.iter().map(|point| point.distance_squared(centroid)).sum::<f64>() / count;
        Ok(Some(Spot { centroid_mm: centroid.y, rms_mm: variance.sqrt(), rays: landed.len() }))
    }

    /// The offsets of the lowest and the highest ray of the meridional plane that pass beside a chief ray, in mm across it; `None`
    /// where all are vignetted.
    pub(super) fn passing_mm(&self, chief: Ray) -> Result<Option<(f64, f64)>> {
        const STEPS: u32 = 800;
        let radius_mm = self.bundle_radius_mm()?;
        let offsets = (0..=STEPS).map(|i| (2.0 * f64::from(i) / f64::from(STEPS) - 1.0) * radius_mm);
        let passes =
            |offset: &f64| self.trace(beside(chief, 0.0, *offset), Travel::ToSensor, Limits::Apertures).is_ok();
        let passing: Vec<f64> = offsets.filter(passes).collect();
        Ok(passing.first().copied().zip(passing.last().copied()))
    }

    fn bundle_radius_mm(&self) -> Result<f64> {
        Ok(self.paraxial()?.entrance_pupil.map_or(0.0, |pupil| 0.5 * WIDTH * pupil.diameter_mm))
    }
}

/// The ray of the meridional plane that crosses the axis at `z_mm`, at a field angle in radians.
fn ray_at(field: f64, z_mm: f64) -> Ray {
    Ray { origin: DVec3::new(0.0, 0.0, z_mm), direction: DVec3::new(0.0, field.sin(), field.cos()) }
}

/// The parallel ray shifted across the chief ray, `up_mm` in the meridional plane and `aside_mm` out of it.
pub(super) fn beside(chief: Ray, aside_mm: f64, up_mm: f64) -> Ray {
    let up = DVec3::new(0.0, chief.direction.z, -chief.direction.y);
    Ray { origin: chief.origin + DVec3::X * aside_mm + up * up_mm, ..chief }
}
