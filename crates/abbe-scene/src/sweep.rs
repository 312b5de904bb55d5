//! The extent of motion while the shutter is open: boxes in space, and lengths in the picture.

use super::Scene;
use super::camera::Camera;
use super::light::Light;
use super::medium::{Density, Medium};
use super::motion::{AnimatedShape, DecomposedTransform};
use abbe_optics::bsdf::{Bsdf, BsdfClass};
use glam::{DAffine3, DVec2, DVec3};

/// The number of times at which motion is evaluated. Equal amounts of light pass through the
/// shutter between them.
const TIMES: usize = 33;

/// The lowest and highest corner of a box in m, relative to the scene's centre.
pub type Bounds = (DVec3, DVec3);

impl Scene {
    /// One box around each moving shape, which contains it at all times.
    pub fn swept_boxes(&self) -> Vec<Bounds> {
        let times = self.shutter_times();
        let moving = self.motions.shapes.iter().filter(|shape| shape.motion.is_some());
        moving
            .map(|shape| {
                let trajectories = lattice(shape).map(|point| self.trajectory(shape, point, &times));
                let (mut low, mut high, mut step) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0.0_f64);
                for trajectory in trajectories {
                    trajectory.iter().for_each(|&place| (low, high) = (low.min(place), high.max(place)));
                    step = trajectory.windows(2).map(|pair| pair[0].distance(pair[1])).fold(step, f64::max);
                }
                // Between two times, a point leaves the box by at most half of the distance that it
                // moves in a step.
                (low - 0.5 * step, high + 0.5 * step)
            })
            .collect()
    }

    /// The length in pixels of the longest motion in the picture while the shutter is open, among
    /// points in the boxes of moving shapes, the corners of moving media, visible points at rest if
    /// the camera moves, and the illumination at each visible point if a light or a specular object
    /// moves.
    pub fn image_motion_px(&self) -> f64 {
        if !self.moves() {
            return 0.0;
        }
        let times = self.shutter_times();
        let cameras: Vec<Camera> = times.iter().map(|&time_s| self.camera_at(time_s)).collect();
        let length = |trajectory: &[DVec3]| {
            let seen: Vec<Option<DVec2>> =
                cameras.iter().zip(trajectory).map(|(camera, &place)| project_clamped(camera, place)).collect();
            seen.windows(2).filter_map(|pair| Some(pair[0]?.distance(pair[1]?))).sum::<f64>()
        };
        let moving = self.motions.shapes.iter().filter(|shape| shape.motion.is_some());
        let of_shapes =
            moving.flat_map(|shape| lattice(shape).map(|point| length(&self.trajectory(shape, point, &times))));
        let visible = self.visible_points();
        let at_rest = |point: &DVec3| length(&vec![*point; times.len()]);
        let of_camera = visible.iter().filter(|_| self.motions.camera.is_some()).map(at_rest);
        let light_maps = self.motions_of_light(&times);
        let carried =
            |maps: &[DAffine3], point: DVec3| maps.iter().map(|map| map.transform_point3(point)).collect::<Vec<_>>();
        let of_light = light_maps.iter().flat_map(|maps| visible.iter().map(|&point| length(&carried(maps, point))));
        let of_media = self.media.iter().flat_map(|medium| self.trajectories_of_medium(medium, &times));
        let of_media = of_media.map(|trajectory| length(&trajectory));
        of_shapes.chain(of_camera).chain(of_light).chain(of_media).fold(0.0, f64::max)
    }

    fn shutter_times(&self) -> Vec<f64> {
        (0..TIMES).map(|i| self.shutter.time_s(i as f64 / (TIMES - 1) as f64)).collect()
    }

    /// The positions in m, relative to the scene's centre, of a point of the shape's own frame at
    /// these times.
    fn trajectory(&self, shape: &AnimatedShape, point: DVec3, times: &[f64]) -> Vec<DVec3> {
        times.iter().map(|&time_s| shape.to_world(time_s).transform_point3(point) - self.centre).collect()
    }

    /// The trajectories of the corners of a medium's box, if the medium moves.
    fn trajectories_of_medium(&self, medium: &Medium, times: &[f64]) -> Vec<Vec<DVec3>> {
        let (Some(motion), Density::Field(field)) = (&medium.motion, &medium.density) else {
            return Vec::new();
        };
        let at = |time_s: f64| motion.displacement_about(self.centre, self.shutter.open_s, time_s);
        let maps: Vec<DAffine3> = times.iter().map(|&time_s| at(time_s)).collect();
        let trajectory = |corner| maps.iter().map(|map| map.transform_point3(corner)).collect();
        field.corners().into_iter().map(trajectory).collect()
    }

    /// For each moving light and each moving specular object: the transforms that move the
    /// illuminated points, one per time. The illumination from a moving light moves with it. A
    /// moving specular object translates the illumination by its own vector, and rotates it by
    /// twice its own angle.
    fn motions_of_light(&self, times: &[f64]) -> Vec<Vec<DAffine3>> {
        let of_light = |light: &Light| {
            let motion = light.motion.as_ref()?;
            let at = |time_s: f64| motion.displacement_about(self.centre, self.shutter.open_s, time_s);
            Some(times.iter().map(|&time_s| at(time_s)).collect())
        };
        let of_shape = |shape: &AnimatedShape| {
            let (motion, _) = shape.motion.as_ref()?;
            let material = self.material_of(shape.placed.object);
            if !material.surface.components().map(Bsdf::class).any(|class| class == BsdfClass::Specular) {
                return None;
            }
            let (low, high) = shape.placed.shape.bounds()?;
            let middle = shape.placed.to_world.transform_point3(0.5 * (low + high));
            let twice = |time_s: f64| {
                let map = motion.displacement(self.shutter.open_s, time_s);
                let rotation = DecomposedTransform::of(&map).rotation;
                let moved = map.transform_point3(middle);
                let rotated = DAffine3::from_quat(rotation * rotation);
                DAffine3::from_translation(moved - self.centre)
                    * rotated
                    * DAffine3::from_translation(self.centre - middle)
            };
            Some(times.iter().map(|&time_s| twice(time_s)).collect())
        };
        self.lights.iter().filter_map(of_light).chain(self.motions.shapes.iter().filter_map(of_shape)).collect()
    }
}

/// A lattice of 3 × 3 × 3 points in the box around a shape, in the shape's frame.
fn lattice(shape: &AnimatedShape) -> impl Iterator<Item = DVec3> {
    let fraction = |digit: usize| (digit % 3) as f64 * 0.5;
    let point = move |(low, high): (DVec3, DVec3), i| {
        low + (high - low) * DVec3::new(fraction(i), fraction(i / 3), fraction(i / 9))
    };
    shape.placed.shape.bounds().into_iter().flat_map(move |bounds| (0..27).map(move |i| point(bounds, i)))
}

/// The film position of a point, clamped to at most half a picture outside each edge. `None` if the
/// point is behind the camera.
fn project_clamped(camera: &Camera, point: DVec3) -> Option<DVec2> {
    let size = DVec2::new(camera.width() as f64, (camera.pixel_count() / camera.width()) as f64);
    Some(camera.project(point)?.clamp(-0.5 * size, 1.5 * size))
}
