//! The part of a scene that the camera sees.

use super::Scene;
use super::meter::Sensor;
use abbe_spectra::math::sphere::BoundingSphere;
use glam::{DVec2, DVec3};

/// Visible points are sampled on a square grid over the film with this number of points on each
/// side.
const VISIBLE_GRID: usize = 17;

/// The sphere around the visible points contains this fraction of them.
const VISIBLE_FRACTION: f64 = 0.9;

/// Photon positions in single precision suffice for the view if the distance between the view and
/// the scene's centre is at most this multiple of the view's radius.
const FARTHEST_VIEW: f64 = 256.0;

/// The radius of the sphere around the sensors of a measurement, divided by that of the sphere that
/// contains most of them. Photons are denser inside of a sphere at which they are aimed, and with
/// the margin, the kernel of a sensor does not reach beyond its edge.
pub const SENSOR_MARGIN: f64 = 2.0;

/// Sensors closer together than this fraction of the scene's radius count as one point.
const SAME_POINT: f64 = 1e-6;

impl Scene {
    /// Visible points over the whole picture when the shutter opens.
    pub(super) fn visible_points(&self) -> Vec<DVec3> {
        if self.measures() {
            return self.points_of_sensors();
        }
        let (width, pixels) = (self.camera.width(), self.camera.pixel_count());
        if pixels == 0 {
            return Vec::new();
        }
        let size = DVec2::new(width as f64, (pixels / width) as f64);
        let at = |i: usize| (i as f64 + 0.5) / VISIBLE_GRID as f64;
        let visible = |index: usize| {
            let film = size * DVec2::new(at(index % VISIBLE_GRID), at(index / VISIBLE_GRID));
            let ray = self.camera.ray(film, [0.5; 2]);
            self.geometry.intersect(&ray, None, f64::INFINITY).map(|hit| hit.position)
        };
        (0..VISIBLE_GRID * VISIBLE_GRID).filter_map(visible).collect()
    }

    /// Points on the sensors of a measurement.
    pub(super) fn points_of_sensors(&self) -> Vec<DVec3> {
        let corner = |i: u32, bit: u32| if i >> bit & 1 == 0 { 0.25 } else { 0.75 };
        let points = |sensor: &Sensor| {
            let on_surface = |i: u32| {
                let u = [0, 1, 2, 0].map(|bit| corner(i, bit));
                self.sensor_point(sensor, u).position
            };
            sensor.position().map_or_else(|| (0..8).map(on_surface).collect(), |position| vec![position])
        };
        self.camera.sensors().iter().flat_map(points).collect()
    }

    /// A sphere around most of the visible points, or `None` if no surface is visible. The sphere
    /// of a measurement has a margin around most of the sensors, and is `None` if all are at the
    /// same point.
    pub fn visible_sphere(&self) -> Option<BoundingSphere> {
        let around = around_most(&self.visible_points())?;
        if !self.measures() {
            return Some(around);
        }
        let apart = around.radius_m > SAME_POINT * self.radius_m;
        apart.then_some(BoundingSphere { radius_m: SENSOR_MARGIN * around.radius_m, ..around })
    }

    /// The centre of the view in the world, in m, if photons in a scene about the present centre
    /// would have imprecise positions there.
    pub fn distant_view(&self) -> Option<DVec3> {
        let BoundingSphere { centre, radius_m } = self.visible_sphere()?;
        (radius_m > 0.0 && centre.length() > FARTHEST_VIEW * radius_m).then(|| self.centre + centre)
    }
}

/// Returns a sphere around most of the points, if any. Its centre is the median of each coordinate,
/// so a few distant points do not move it.
fn around_most(points: &[DVec3]) -> Option<BoundingSphere> {
    let median = |axis: usize| {
        let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let centre = DVec3::new(median(0)?, median(1)?, median(2)?);
    let mut distances: Vec<f64> = points.iter().map(|point| point.distance(centre)).collect();
    distances.sort_by(f64::total_cmp);
    let last = ((distances.len() as f64 * VISIBLE_FRACTION) as usize).min(distances.len() - 1);
    Some(BoundingSphere { centre, radius_m: distances[last] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few points on the horizon do not widen the sphere.
    #[test]
    fn the_visible_target_ignores_outliers() {
        let mut points: Vec<DVec3> = (0..100).map(|i| DVec3::new(f64::from(i % 10), 0.0, f64::from(i / 10))).collect();
        points.extend([DVec3::splat(1e6); 5]);
        let target = around_most(&points).unwrap();
        assert!(target.radius_m < 10.0 && target.centre.distance(DVec3::new(5.0, 0.0, 5.0)) < 1.0, "{target:?}");
        assert_eq!(around_most(&[]), None);
    }
}
