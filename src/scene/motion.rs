//! What moves: the pose of a thing at any moment, from its keyframes; and the whole scene as it stands at a moment.
//!
//! Between keys translation and scale interpolate linearly and rotation along the shortest arc (slerp, Shoemake 1985); outside them
//! the end poses hold. At a key, and between equal keys, the pose is exactly the one written, so that a thing that its keys leave where it is
//! gives the same picture as one without keys.

use super::Scene;
use super::camera::Camera;
use super::geometry::Geometry;
use super::light::{Area, Emitter};
use super::shape::Placed;
use crate::error::Result;
use glam::{DAffine3, DQuat, DVec3};
use std::borrow::Cow;
use std::sync::Arc;

/// A pose in the parts that interpolate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Where to.
    pub translation: DVec3,
    /// The turn after the scaling.
    pub rotation: DQuat,
    /// Scales along the axes; the first is negative where the pose mirrors.
    pub scale: DVec3,
}

impl Pose {
    /// The parts of a placing that has no shear.
    pub fn of(placing: &DAffine3) -> Self {
        let (scale, rotation, translation) = placing.to_scale_rotation_translation();
        Self { translation, rotation, scale }
    }

    /// Whether a placing has a shear, which no translation, rotation and scale make.
    pub fn is_sheared(placing: &DAffine3) -> bool {
        let [x, y, z] = [placing.matrix3.x_axis, placing.matrix3.y_axis, placing.matrix3.z_axis];
        [(x, y), (y, z), (z, x)].iter().any(|(a, b)| a.dot(*b).abs() > 1e-9 * a.length() * b.length())
    }

    /// The placing a share of the way to another pose.
    fn towards(&self, to: &Self, share: f64) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(
            self.scale.lerp(to.scale, share),
            self.rotation.slerp(to.rotation, share),
            self.translation.lerp(to.translation, share),
        )
    }
}

/// States of a thing at rising times (s); at least one.
#[derive(Debug, Clone, PartialEq)]
struct Keys<T>(Vec<(f64, T)>);

impl<T: Clone + PartialEq> Keys<T> {
    /// The state at a moment: a key's own at its time, where its neighbour is equal, and beyond the ends.
    fn at(&self, time_s: f64, between: impl Fn(&T, &T, f64) -> T) -> T {
        let Self(keys) = self;
        let next = keys.partition_point(|key| key.0 <= time_s).min(keys.len() - 1);
        let (before, after) = (&keys[next.saturating_sub(1)], &keys[next]);
        if time_s <= before.0 || before.1 == after.1 {
            return before.1.clone();
        }
        if time_s >= after.0 {
            return after.1.clone();
        }
        between(&before.1, &after.1, (time_s - before.0) / (after.0 - before.0))
    }

    /// Whether the state changes between two moments, if `at` gives it at each.
    fn changes(&self, (from_s, to_s): (f64, f64), at: impl Fn(f64) -> T) -> bool {
        let inside = self.0.iter().filter(|key| from_s < key.0 && key.0 < to_s).map(|key| key.1.clone());
        let first = at(from_s);
        inside.chain([at(to_s)]).any(|state| state != first)
    }
}

/// A thing's way through space.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    keys: Keys<Stance>,
    /// The thing's own transform, with which the keys' are composed.
    own: DAffine3,
}

/// A keyframe's transform, and where it takes the thing: after the thing's own transform.
#[derive(Debug, Clone, PartialEq)]
struct Stance {
    pose: DAffine3,
    placing: DAffine3,
}

impl Motion {
    /// The way of a thing with a transform of its `own`; each key (at rising times) has the transform that comes after it, by itself and composed
    /// with it. `None` without keys.
    pub fn new(own: DAffine3, keys: impl Iterator<Item = (f64, DAffine3, DAffine3)>) -> Option<Self> {
        let keys: Vec<_> = keys.map(|(time_s, pose, placing)| (time_s, Stance { pose, placing })).collect();
        (!keys.is_empty()).then_some(Self { keys: Keys(keys), own })
    }

    fn stance(&self, time_s: f64) -> Stance {
        self.keys.at(time_s, |from, to, share| {
            let pose = Pose::of(&from.pose).towards(&Pose::of(&to.pose), share);
            Stance { pose, placing: pose * self.own }
        })
    }

    /// Where the thing stands at a moment: its own frame → world.
    pub fn at(&self, time_s: f64) -> DAffine3 {
        self.stance(time_s).placing
    }

    /// Whether it moves between two moments.
    pub fn moves(&self, from_s: f64, to_s: f64) -> bool {
        self.keys.changes((from_s, to_s), |time_s| self.stance(time_s))
    }

    /// The same with all lengths multiplied.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |placing: DAffine3| DAffine3 { translation: placing.translation * factor, ..placing };
        let stance = |stance: &Stance| Stance { pose: scaled(stance.pose), placing: scaled(stance.placing) };
        Self { keys: Keys(self.keys.0.iter().map(|(time, key)| (*time, stance(key))).collect()), own: scaled(self.own) }
    }
}

/// Where a camera stands, where it looks and what is up.
pub type Stand = [DVec3; 3];

/// A camera's way: each of its three vectors interpolates linearly.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraMotion(Keys<Stand>);

impl CameraMotion {
    /// From keys at rising times (s); `None` without keys.
    pub fn new(keys: impl Iterator<Item = (f64, Stand)>) -> Option<Self> {
        let keys: Vec<_> = keys.collect();
        (!keys.is_empty()).then_some(Self(Keys(keys)))
    }

    /// How it stands at a moment.
    pub fn at(&self, time_s: f64) -> Stand {
        self.0.at(time_s, |from, to, share| std::array::from_fn(|i| from[i].lerp(to[i], share)))
    }

    /// Whether it moves between two moments.
    pub fn moves(&self, from_s: f64, to_s: f64) -> bool {
        self.0.changes((from_s, to_s), |time_s| self.at(time_s))
    }

    /// The same with every stand changed.
    #[must_use]
    pub fn map(&self, change: impl Fn(Stand) -> Stand) -> Self {
        Self(Keys(self.0.0.iter().map(|(time, stand)| (*time, change(*stand))).collect()))
    }

    /// The first moment between two keys, if any, at which the camera would look at itself, or along its `up`.
    pub fn lost_s(&self) -> Option<f64> {
        const STEPS: usize = 1024;
        // Less than the largest step of a half turn.
        const LEAST: f64 = 2e-3;
        self.0.0.windows(2).find_map(|pair| {
            let view = |stand: Stand| stand[1] - stand[0];
            let size = view(pair[0].1).length().max(view(pair[1].1).length());
            let is_lost = |time_s: f64| {
                let stand = self.at(time_s);
                let (view, up) = (view(stand), stand[2].normalize_or_zero());
                view.length() < LEAST * size || view.normalize_or_zero().cross(up).length() < LEAST
            };
            let moments = (1..STEPS).map(|i| pair[0].0 + (pair[1].0 - pair[0].0) * i as f64 / STEPS as f64);
            moments.into_iter().find(|&time_s| is_lost(time_s))
        })
    }
}

/// A shape, and its way if it moves while the shutter is open.
#[derive(Debug, Clone)]
pub struct MovingShape {
    /// The shape where it stands when the shutter opens.
    pub placed: Placed,
    /// Its way in m, and where the shape stands in the frame that moves.
    pub motion: Option<(Motion, DAffine3)>,
}

impl MovingShape {
    /// Where the shape's frame stands in the world at a moment.
    pub fn to_world(&self, time_s: f64) -> DAffine3 {
        self.motion.as_ref().map_or(self.placed.to_world, |(motion, local)| motion.at(time_s) * *local)
    }
}

/// What moves in a scene while the shutter is open; nothing by default. (Lights know their own ways.)
#[derive(Debug, Clone, Default)]
pub struct Motions {
    /// All shapes, if any of them moves.
    pub shapes: Arc<[MovingShape]>,
    /// The camera's way, relative to the scene's centre, in m.
    pub camera: Option<CameraMotion>,
}

impl Scene {
    /// Whether anything moves while the shutter is open.
    pub fn moves(&self) -> bool {
        !self.motions.shapes.is_empty()
            || self.motions.camera.is_some()
            || self.moving_lights().next().is_some()
            || self.media.iter().any(|medium| medium.motion.is_some())
    }

    /// The lights that move by themselves.
    pub fn moving_lights(&self) -> impl Iterator<Item = &super::light::Light> {
        self.lights.iter().filter(|light| light.motion.is_some())
    }

    /// The scene as it stands at a moment while the shutter is open; what moves is built anew, the rest shared. A scene in which nothing moves is
    /// itself at every moment.
    ///
    /// # Errors
    /// The input's: a shape that its motion takes so far away that nothing is left of it.
    pub fn at(&self, time_s: f64) -> Result<Cow<'_, Self>> {
        if !self.moves() {
            return Ok(Cow::Borrowed(self));
        }
        let mut posed = self.clone();
        if !self.motions.shapes.is_empty() {
            let build = |boundaries: bool| {
                let is_boundary = |shape: &&MovingShape| self.material_of(shape.placed.object).is_boundary();
                let shapes = self.motions.shapes.iter().filter(|shape| is_boundary(shape) == boundaries);
                let placed = |shape: &MovingShape| Placed { to_world: shape.to_world(time_s), ..shape.placed.clone() };
                Geometry::build(shapes.map(placed).collect(), self.centre).map(Arc::new)
            };
            (posed.geometry, posed.boundaries) = (build(false)?, build(true)?);
            posed.radius_m = self.radius_m.max(posed.geometry.radius_m());
        }
        posed.camera = self.camera_at(time_s);
        for (medium, here) in self.media.iter().zip(&mut posed.media) {
            if let Some(motion) = &medium.motion {
                *here = medium.moved(&about(self.centre, since(motion, self.shutter.open_s, time_s)));
            }
        }
        for light in &mut posed.lights {
            if let Some(motion) = &light.motion {
                light.emitter = light.emitter.moved(&about(self.centre, since(motion, self.shutter.open_s, time_s)));
            }
            if let Emitter::Area(Area { object, area_m2, .. }) = &mut light.emitter {
                *area_m2 = posed.geometry.area(*object);
            }
        }
        posed.find_interiors();
        Ok(Cow::Owned(posed))
    }

    /// Stops everything where it stands when the shutter opens.
    pub fn stop(&mut self) {
        self.motions = Motions::default();
        self.lights.iter_mut().for_each(|light| light.motion = None);
        self.media.iter_mut().for_each(|medium| medium.motion = None);
    }

    /// The camera as it stands at a moment.
    pub fn camera_at(&self, time_s: f64) -> Camera {
        let mut camera = self.camera.clone();
        if let Some(motion) = &self.motions.camera {
            camera.stand(motion.at(time_s));
        }
        camera
    }
}

/// What a motion does to a thing between two moments; nothing at all where it stands still.
pub(super) fn since(motion: &Motion, from_s: f64, to_s: f64) -> DAffine3 {
    let (from, to) = (motion.at(from_s), motion.at(to_s));
    if from == to { DAffine3::IDENTITY } else { to * from.inverse() }
}

/// A map of the world as a map of places relative to `centre`.
pub(super) fn about(centre: DVec3, map: DAffine3) -> DAffine3 {
    DAffine3 { translation: map.transform_point3(centre) - centre, ..map }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn motion(keys: &[(f64, DAffine3)]) -> Motion {
        Motion::new(DAffine3::IDENTITY, keys.iter().map(|&(time, pose)| (time, pose, pose))).unwrap()
    }

    #[test]
    fn a_turning_disk_does_not_shrink() {
        let turned = |angle: f64| DAffine3::from_quat(DQuat::from_rotation_y(angle));
        let motion = motion(&[(0.0, turned(0.0)), (1.0, turned(2.0))]);
        for i in 0..=20 {
            let share = f64::from(i) / 20.0;
            let rim = motion.at(share).transform_point3(DVec3::X);
            assert!((rim.length() - 1.0).abs() < 1e-14);
            assert!((rim - turned(2.0 * share).transform_point3(DVec3::X)).length() < 1e-12, "uniform turning");
        }
    }

    #[test]
    fn poses_interpolate_between_keys_and_hold_outside() {
        let far = DAffine3::from_scale_rotation_translation(
            DVec3::splat(3.0),
            DQuat::from_rotation_z(FRAC_PI_2),
            DVec3::new(4.0, 0.0, 0.0),
        );
        let motion = motion(&[(1.0, DAffine3::IDENTITY), (3.0, far)]);
        assert_eq!([-5.0, 1.0].map(|t| motion.at(t)), [DAffine3::IDENTITY; 2]);
        assert_eq!([3.0, 99.0].map(|t| motion.at(t)), [far; 2]);
        let half = motion.at(2.0).transform_point3(DVec3::X);
        let diagonal = 0.5_f64.sqrt();
        assert!((half - DVec3::new(2.0 + 2.0 * diagonal, 2.0 * diagonal, 0.0)).length() < 1e-12, "{half}");
        assert!(
            motion.moves(0.0, 1.5) && motion.moves(-5.0, 5.0) && !motion.moves(0.0, 1.0) && !motion.moves(3.0, 4.0)
        );
        assert!(!motion.moves(2.0, 2.0), "a shutter without length");
    }

    #[test]
    fn keys_come_after_the_things_own_transform() {
        let own = DAffine3::from_quat(DQuat::from_rotation_z(FRAC_PI_2));
        let by = |x: f64| DAffine3::from_translation(DVec3::X * x);
        let motion = Motion::new(own, [(0.0, by(0.0), own), (1.0, by(2.0), by(2.0) * own)].into_iter()).unwrap();
        let place = motion.at(0.5).transform_point3(DVec3::X);
        assert!((place - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-12, "{place}");
        let place = motion.scaled(10.0).at(0.5).transform_point3(DVec3::ZERO);
        assert!((place - DVec3::new(10.0, 0.0, 0.0)).length() < 1e-12, "{place}");
    }

    #[test]
    fn a_mirror_image_turns_without_becoming_flat() {
        let mirrored = |angle: f64| {
            DAffine3::from_quat(DQuat::from_rotation_x(angle)) * DAffine3::from_scale(DVec3::new(1.0, -2.0, 1.0))
        };
        let motion = motion(&[(0.0, mirrored(0.0)), (1.0, mirrored(1.0))]);
        let half = motion.at(0.5);
        assert!((half.matrix3.determinant() + 2.0).abs() < 1e-12);
        let known = mirrored(0.5);
        assert!((half.transform_point3(DVec3::Y) - known.transform_point3(DVec3::Y)).length() < 1e-12);
    }

    #[test]
    fn a_camera_that_would_look_along_up_on_its_way_is_found() {
        let stand = |at: DVec3| [DVec3::ZERO, at, DVec3::Y];
        let over = CameraMotion::new(
            [(0.0, stand(DVec3::new(1.0, 2.0, 0.0))), (1.0, stand(DVec3::new(-1.0, 2.0, 0.0)))].into_iter(),
        );
        assert!((over.unwrap().lost_s().unwrap() - 0.5).abs() < 0.01);
        let beside = CameraMotion::new(
            [(0.0, stand(DVec3::new(1.0, 0.0, 1.0))), (1.0, stand(DVec3::new(-1.0, 0.0, 1.0)))].into_iter(),
        );
        assert_eq!(beside.unwrap().lost_s(), None);
        let through = CameraMotion::new([(0.0, stand(DVec3::X)), (3.0, stand(-2.0 * DVec3::X))].into_iter());
        assert!((through.unwrap().lost_s().unwrap() - 1.0).abs() < 0.01);
    }
}
