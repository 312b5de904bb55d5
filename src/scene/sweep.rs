//! What moving things sweep over while the shutter is open: in space, and in the picture.

use super::Scene;
use super::camera::Camera;
use super::light::Light;
use super::medium::{Density, Medium};
use super::motion::{MovingShape, Pose, about, since};
use crate::optics::surface::{Class, Surface};
use glam::{DAffine3, DVec2, DVec3};

/// Moments at which the scene is looked at, spread as the shutter lets light through.
const MOMENTS: usize = 33;

/// Pixels on a side of the grid of places that the picture shows.
const PLACES: usize = 17;

/// A box: least and largest coordinates, relative to the scene's centre, in m.
pub type Bounds = (DVec3, DVec3);

impl Scene {
    /// Boxes that hold whatever moves, wherever it is while the shutter is open.
    pub fn swept_boxes(&self) -> Vec<Bounds> {
        let moments = self.moments();
        let moving = self.motions.shapes.iter().filter(|shape| shape.motion.is_some());
        moving
            .map(|shape| {
                let ways = lattice(shape).map(|place| self.way(shape, place, &moments));
                let (mut low, mut high, mut step) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0.0_f64);
                for way in ways {
                    way.iter().for_each(|&place| (low, high) = (low.min(place), high.max(place)));
                    step = way.windows(2).map(|pair| pair[0].distance(pair[1])).fold(step, f64::max);
                }
                // Between two moments nothing bulges out by more than half of what it moves.
                (low - 0.5 * step, high + 0.5 * step)
            })
            .collect()
    }

    /// How far, in pixels, things move over the picture while the shutter is open: the longest way of a point of a moving thing's box; of what a
    /// moving camera sees; and of light that a turning mirror or prism, or a moving lamp, sends over what is seen.
    pub fn image_motion_px(&self) -> f64 {
        if !self.moves() {
            return 0.0;
        }
        let moments = self.moments();
        let cameras: Vec<Camera> = moments.iter().map(|&time_s| self.camera_at(time_s)).collect();
        let length = |way: &[DVec3]| {
            let seen: Vec<Option<DVec2>> =
                cameras.iter().zip(way).map(|(camera, &place)| seen_at(camera, place)).collect();
            seen.windows(2).filter_map(|pair| Some(pair[0]?.distance(pair[1]?))).sum::<f64>()
        };
        let moving = self.motions.shapes.iter().filter(|shape| shape.motion.is_some());
        let of_shapes = moving.flat_map(|shape| lattice(shape).map(|place| length(&self.way(shape, place, &moments))));
        let places = self.places_seen();
        let still = |place: &DVec3| length(&vec![*place; moments.len()]);
        let of_camera = places.iter().filter(|_| self.motions.camera.is_some()).map(still);
        let swings = self.swings(&moments);
        let carried =
            |swing: &[DAffine3], place: DVec3| swing.iter().map(|map| map.transform_point3(place)).collect::<Vec<_>>();
        let of_light = swings.iter().flat_map(|swing| places.iter().map(|&place| length(&carried(swing, place))));
        let of_media =
            self.media.iter().flat_map(|medium| self.ways_of_medium(medium, &moments)).map(|way| length(&way));
        of_shapes.chain(of_camera).chain(of_light).chain(of_media).fold(0.0, f64::max)
    }

    fn moments(&self) -> Vec<f64> {
        (0..MOMENTS).map(|i| self.shutter.time_s(i as f64 / (MOMENTS - 1) as f64)).collect()
    }

    /// Where a place of a shape's own frame is at each moment.
    fn way(&self, shape: &MovingShape, place: DVec3, moments: &[f64]) -> Vec<DVec3> {
        moments.iter().map(|&time_s| shape.to_world(time_s).transform_point3(place) - self.centre).collect()
    }

    /// The ways of the corners of a medium's box, if it moves.
    fn ways_of_medium(&self, medium: &Medium, moments: &[f64]) -> Vec<Vec<DVec3>> {
        let (Some(motion), Density::Field(field)) = (&medium.motion, &medium.density) else {
            return Vec::new();
        };
        let at = |time_s: f64| about(self.centre, since(motion, self.shutter.open_s, time_s));
        let maps: Vec<DAffine3> = moments.iter().map(|&time_s| at(time_s)).collect();
        let way = |corner| maps.iter().map(|map| map.transform_point3(corner)).collect();
        field.corners().into_iter().map(way).collect()
    }

    /// Places all over the picture, as they are when the shutter opens.
    fn places_seen(&self) -> Vec<DVec3> {
        let size = DVec2::new(self.camera.width() as f64, (self.camera.pixel_count() / self.camera.width()) as f64);
        let at = |i: usize| (i as f64 + 0.5) / PLACES as f64;
        let seen = |index: usize| {
            let film = size * DVec2::new(at(index % PLACES), at(index / PLACES));
            let ray = self.camera.ray(film, [0.5; 2]);
            self.geometry.intersect(&ray, None, f64::INFINITY).map(|hit| hit.position)
        };
        (0..PLACES * PLACES).filter_map(seen).collect()
    }

    /// What becomes, at each moment, of a place that light falls on when the shutter opens, for everything that sends light about: with a lamp it
    /// moves as the lamp does; with a mirror or glass it moves along, and turns twice as far.
    fn swings(&self, moments: &[f64]) -> Vec<Vec<DAffine3>> {
        let of_lamp = |light: &Light| {
            let motion = light.motion.as_ref()?;
            Some(moments.iter().map(|&time_s| about(self.centre, since(motion, self.shutter.open_s, time_s))).collect())
        };
        let of_shape = |shape: &MovingShape| {
            let (motion, _) = shape.motion.as_ref()?;
            let material = self.material_of(shape.placed.object);
            if !material.surface.components().map(Surface::class).any(|class| class == Class::Specular) {
                return None;
            }
            let (low, high) = shape.placed.shape.bounds()?;
            let middle = shape.placed.to_world.transform_point3(0.5 * (low + high));
            let twice = |time_s: f64| {
                let map = since(motion, self.shutter.open_s, time_s);
                let turn = Pose::of(&map).rotation;
                let moved = map.transform_point3(middle);
                let turned = DAffine3::from_quat(turn * turn);
                DAffine3::from_translation(moved - self.centre)
                    * turned
                    * DAffine3::from_translation(self.centre - middle)
            };
            Some(moments.iter().map(|&time_s| twice(time_s)).collect())
        };
        self.lights.iter().filter_map(of_lamp).chain(self.motions.shapes.iter().filter_map(of_shape)).collect()
    }
}

/// 3 × 3 × 3 places of a box around a shape, in its own frame.
fn lattice(shape: &MovingShape) -> impl Iterator<Item = DVec3> {
    let share = |digit: usize| (digit % 3) as f64 * 0.5;
    let place =
        move |(low, high): (DVec3, DVec3), i| low + (high - low) * DVec3::new(share(i), share(i / 3), share(i / 9));
    shape.placed.shape.bounds().into_iter().flat_map(move |bounds| (0..27).map(move |i| place(bounds, i)))
}

/// Where on the film a place is seen; what is far beside the picture counts as half a picture beside it.
fn seen_at(camera: &Camera, place: DVec3) -> Option<DVec2> {
    let size = DVec2::new(camera.width() as f64, (camera.pixel_count() / camera.width()) as f64);
    Some(camera.project(place)?.clamp(-0.5 * size, 1.5 * size))
}
