//! Computes the scene at a given time. Moves the shapes, the camera, the lights and the media.

use super::Scene;
use super::camera::Camera;
use super::light::Light;
use super::motion::{AnimatedShape, SceneMotion};
use crate::geometry::Geometry;
use crate::geometry::shape::PlacedShape;
use abbe_spectra::error::Result;
use std::borrow::Cow;
use std::sync::Arc;

impl Scene {
    pub fn moves(&self) -> bool {
        !self.motions.shapes.is_empty()
            || self.motions.camera.is_some()
            || self.moving_lights().next().is_some()
            || self.media.iter().any(|medium| medium.motion.is_some())
    }

    /// The lights that store a motion. An area light stores none, because it moves with its object.
    pub fn moving_lights(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter().filter(|light| light.motion.is_some())
    }

    /// The scene at a time (in s) while the shutter is open: the scene itself if nothing moves,
    /// otherwise a copy that rebuilds the moving parts and shares the others. Returns an error if a
    /// shape moves to coordinates that are not finite.
    pub fn at(&self, time_s: f64) -> Result<Cow<'_, Self>> {
        if !self.moves() {
            return Ok(Cow::Borrowed(self));
        }
        let mut posed = self.clone();
        if !self.motions.shapes.is_empty() {
            let build = |boundaries: bool| {
                let is_boundary = |shape: &&AnimatedShape| self.material_of(shape.placed.object).is_boundary();
                let shapes = self.motions.shapes.iter().filter(|shape| is_boundary(shape) == boundaries);
                let placed =
                    |shape: &AnimatedShape| PlacedShape { to_world: shape.to_world(time_s), ..shape.placed.clone() };
                Geometry::build(shapes.map(placed).collect(), self.centre).map(Arc::new)
            };
            (posed.geometry, posed.boundaries) = (build(false)?, build(true)?);
            posed.radius_m = self.radius_m.max(posed.geometry.radius_m());
        }
        posed.camera = self.camera_at(time_s);
        for (medium, here) in self.media.iter().zip(&mut posed.media) {
            if let Some(motion) = &medium.motion {
                *here = medium.moved(&motion.displacement_about(self.centre, self.shutter.open_s, time_s));
            }
        }
        for light in &mut posed.lights {
            if let Some(motion) = &light.motion {
                let map = motion.displacement_about(self.centre, self.shutter.open_s, time_s);
                light.emitter = light.emitter.moved(&map);
            }
            light.update_area(&posed.geometry);
        }
        posed.find_medium_stacks();
        Ok(Cow::Owned(posed))
    }

    /// Removes all motion. Everything keeps the position that it has when the shutter opens.
    pub fn stop(&mut self) {
        self.motions = SceneMotion::default();
        self.lights.iter_mut().for_each(|light| light.motion = None);
        self.media.iter_mut().for_each(|medium| medium.motion = None);
    }

    pub fn camera_at(&self, time_s: f64) -> Camera {
        let mut camera = self.camera.clone();
        if let Some(motion) = &self.motions.camera {
            camera.look_at(motion.at(time_s));
        }
        camera
    }
}
