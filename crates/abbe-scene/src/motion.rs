//! Keyframe animation: transforms, camera poses and shapes as functions of time.
//!
//! Translation and scale are interpolated linearly between keyframes, and rotation by slerp
//! (Shoemake 1985). Before the first and after the last keyframe, the transform is constant. At a
//! keyframe, and between two equal ones, it is exactly that of the keyframe, so an object whose
//! keyframes are all equal gives the same picture as an object at rest.

use crate::geometry::shape::PlacedShape;
use abbe_spectra::math::rotation::slerp;
use glam::{DAffine3, DQuat, DVec3};
use std::sync::Arc;

/// A transform without shear, decomposed into the parts that are interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecomposedTransform {
    pub translation: DVec3,
    /// Applied after the scale.
    pub rotation: DQuat,
    /// Along each axis. If the transform mirrors, the first scale is negative.
    pub scale: DVec3,
}

impl DecomposedTransform {
    pub fn of(transform: &DAffine3) -> Self {
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        Self { translation, rotation, scale }
    }

    /// Returns true if a transform has a shear, which the decomposition cannot represent.
    pub fn is_sheared(transform: &DAffine3) -> bool {
        let [x, y, z] = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis];
        [(x, y), (y, z), (z, x)].iter().any(|(a, b)| a.dot(*b).abs() > 1e-9 * a.length() * b.length())
    }

    /// Interpolates between `self` (`fraction` = 0) and `to` (`fraction` = 1).
    fn interpolate(&self, to: &Self, fraction: f64) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(
            self.scale.lerp(to.scale, fraction),
            slerp(self.rotation, to.rotation, fraction),
            self.translation.lerp(to.translation, fraction),
        )
    }
}

/// At least one pair of a time in s and a state, in order of increasing time.
#[derive(Debug, Clone, PartialEq)]
struct Keyframes<T>(Vec<(f64, T)>);

impl<T: Clone + PartialEq> Keyframes<T> {
    /// The state at a time. `between` interpolates only strictly between two unequal keyframes; at
    /// all other times, the result is the state of a keyframe.
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

    /// Returns true if the state, which `at` gives, changes within an interval of time.
    fn changes(&self, (from_s, to_s): (f64, f64), at: impl Fn(f64) -> T) -> bool {
        let inside = self.0.iter().filter(|key| from_s < key.0 && key.0 < to_s).map(|key| key.1.clone());
        let first = at(from_s);
        inside.chain([at(to_s)]).any(|state| state != first)
    }
}

/// A transform as a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct AnimatedTransform {
    keys: Keyframes<TransformKey>,
    /// The object's own transform, which is applied before the interpolated one.
    own: DAffine3,
}

/// The transform of a keyframe: alone, and composed with the object's own transform.
#[derive(Debug, Clone, PartialEq)]
struct TransformKey {
    pose: DAffine3,
    to_world: DAffine3,
}

impl AnimatedTransform {
    /// Creates the motion of an object with the transform `own`. Each keyframe has a time in s,
    /// which increases, a transform that is applied after `own`, and the composition of the two.
    /// Returns `None` if there are no keyframes.
    pub fn new(own: DAffine3, keys: impl Iterator<Item = (f64, DAffine3, DAffine3)>) -> Option<Self> {
        let keys: Vec<_> = keys.map(|(time_s, pose, to_world)| (time_s, TransformKey { pose, to_world })).collect();
        (!keys.is_empty()).then_some(Self { keys: Keyframes(keys), own })
    }

    fn key_at(&self, time_s: f64) -> TransformKey {
        self.keys.at(time_s, |from, to, fraction| {
            let (from, to) = (DecomposedTransform::of(&from.pose), DecomposedTransform::of(&to.pose));
            let pose = from.interpolate(&to, fraction);
            TransformKey { pose, to_world: pose * self.own }
        })
    }

    /// From the object's frame to the world at a time in s.
    pub fn at(&self, time_s: f64) -> DAffine3 {
        self.key_at(time_s).to_world
    }

    pub fn moves(&self, from_s: f64, to_s: f64) -> bool {
        self.keys.changes((from_s, to_s), |time_s| self.key_at(time_s))
    }

    /// The same motion with all lengths multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |map: DAffine3| DAffine3 { translation: map.translation * factor, ..map };
        let key = |key: &TransformKey| TransformKey { pose: scaled(key.pose), to_world: scaled(key.to_world) };
        let keys = self.keys.0.iter().map(|(time_s, state)| (*time_s, key(state))).collect();
        Self { keys: Keyframes(keys), own: scaled(self.own) }
    }

    /// The map of the world that moves the object from its place at one time to that at another.
    pub(super) fn displacement(&self, from_s: f64, to_s: f64) -> DAffine3 {
        let (from, to) = (self.at(from_s), self.at(to_s));
        if from == to { DAffine3::IDENTITY } else { to * from.inverse() }
    }

    /// Like [`displacement`](Self::displacement), for positions relative to `centre`.
    pub(super) fn displacement_about(&self, centre: DVec3, from_s: f64, to_s: f64) -> DAffine3 {
        let map = self.displacement(from_s, to_s);
        DAffine3 { translation: map.transform_point3(centre) - centre, ..map }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookAt {
    pub from: DVec3,
    pub at: DVec3,
    pub up: DVec3,
}

/// The pose of a camera as a function of time, whose three vectors are interpolated linearly.
#[derive(Debug, Clone, PartialEq)]
pub struct AnimatedLookAt(Keyframes<LookAt>);

impl AnimatedLookAt {
    /// Creates the motion from keyframes at increasing times in s, or returns `None` if there are
    /// none.
    pub fn new(keys: impl Iterator<Item = (f64, LookAt)>) -> Option<Self> {
        let keys: Vec<_> = keys.collect();
        (!keys.is_empty()).then_some(Self(Keyframes(keys)))
    }

    pub fn at(&self, time_s: f64) -> LookAt {
        self.0.at(time_s, |a, b, fraction| LookAt {
            from: a.from.lerp(b.from, fraction),
            at: a.at.lerp(b.at, fraction),
            up: a.up.lerp(b.up, fraction),
        })
    }

    pub fn moves(&self, from_s: f64, to_s: f64) -> bool {
        self.0.changes((from_s, to_s), |time_s| self.at(time_s))
    }

    #[must_use]
    pub fn map(&self, change: impl Fn(LookAt) -> LookAt) -> Self {
        Self(Keyframes(self.0.0.iter().map(|(time_s, pose)| (*time_s, change(*pose))).collect()))
    }

    /// The first time (in s) between two keyframes at which the camera would look at its own
    /// position or along its `up` vector, if any.
    pub fn degenerate_time_s(&self) -> Option<f64> {
        const STEPS: usize = 1024;
        /// A pose is degenerate if the relative length of the view vector, or the sine of its angle
        /// to `up`, is below this tolerance. The length changes by at most 2/`STEPS` per step, so
        /// the steps cannot miss a time at which it is 0.
        const LEAST: f64 = 2e-3;
        self.0.0.windows(2).find_map(|pair| {
            let view = |pose: LookAt| pose.at - pose.from;
            let size = view(pair[0].1).length().max(view(pair[1].1).length());
            let is_degenerate = |time_s: f64| {
                let pose = self.at(time_s);
                let (view, up) = (view(pose), pose.up.normalize_or_zero());
                view.length() < LEAST * size || view.normalize_or_zero().cross(up).length() < LEAST
            };
            let times = (1..STEPS).map(|i| pair[0].0 + (pair[1].0 - pair[0].0) * i as f64 / STEPS as f64);
            times.into_iter().find(|&time_s| is_degenerate(time_s))
        })
    }
}

#[derive(Debug, Clone)]
pub struct AnimatedShape {
    /// At its place when the shutter opens.
    pub placed: PlacedShape,
    /// The motion of a frame with lengths in m, and the transform from the shape's frame to the
    /// moving frame, if the shape moves while the shutter is open.
    pub motion: Option<(AnimatedTransform, DAffine3)>,
}

impl AnimatedShape {
    /// From the shape's frame to the world at a time in s.
    pub fn to_world(&self, time_s: f64) -> DAffine3 {
        self.motion.as_ref().map_or(self.placed.to_world, |(motion, local)| motion.at(time_s) * *local)
    }
}

/// The moving parts of a scene, except lights and media, which store their own motion. The default
/// is a scene at rest.
#[derive(Debug, Clone, Default)]
pub struct SceneMotion {
    /// All shapes of the scene, or an empty list if no shape moves.
    pub shapes: Arc<[AnimatedShape]>,
    /// Positions are in m, relative to the scene's centre.
    pub camera: Option<AnimatedLookAt>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn motion(keys: &[(f64, DAffine3)]) -> AnimatedTransform {
        AnimatedTransform::new(DAffine3::IDENTITY, keys.iter().map(|&(time, pose)| (time, pose, pose))).unwrap()
    }

    #[test]
    fn a_turning_disk_does_not_shrink() {
        let turned = |angle: f64| DAffine3::from_quat(DQuat::from_rotation_y(angle));
        let motion = motion(&[(0.0, turned(0.0)), (1.0, turned(2.0))]);
        for i in 0..=20 {
            let fraction = f64::from(i) / 20.0;
            let rim = motion.at(fraction).transform_point3(DVec3::X);
            assert!((rim.length() - 1.0).abs() < 1e-14);
            assert!((rim - turned(2.0 * fraction).transform_point3(DVec3::X)).length() < 1e-12, "uniform rotation");
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
        assert!(!motion.moves(2.0, 2.0), "a shutter of zero duration");
    }

    #[test]
    fn keyframes_follow_the_own_transform() {
        let own = DAffine3::from_quat(DQuat::from_rotation_z(FRAC_PI_2));
        let by = |x: f64| DAffine3::from_translation(DVec3::X * x);
        let keys = [(0.0, by(0.0), own), (1.0, by(2.0), by(2.0) * own)];
        let motion = AnimatedTransform::new(own, keys.into_iter()).unwrap();
        let place = motion.at(0.5).transform_point3(DVec3::X);
        assert!((place - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-12, "{place}");
        let place = motion.scaled(10.0).at(0.5).transform_point3(DVec3::ZERO);
        assert!((place - DVec3::new(10.0, 0.0, 0.0)).length() < 1e-12, "{place}");
    }

    #[test]
    fn a_mirror_image_rotates_without_becoming_flat() {
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
    fn degenerate_camera_poses_between_keyframes_are_found() {
        let towards = |at: DVec3| LookAt { from: DVec3::ZERO, at, up: DVec3::Y };
        let over = AnimatedLookAt::new(
            [(0.0, towards(DVec3::new(1.0, 2.0, 0.0))), (1.0, towards(DVec3::new(-1.0, 2.0, 0.0)))].into_iter(),
        );
        assert!((over.unwrap().degenerate_time_s().unwrap() - 0.5).abs() < 0.01);
        let beside = AnimatedLookAt::new(
            [(0.0, towards(DVec3::new(1.0, 0.0, 1.0))), (1.0, towards(DVec3::new(-1.0, 0.0, 1.0)))].into_iter(),
        );
        assert_eq!(beside.unwrap().degenerate_time_s(), None);
        let through = AnimatedLookAt::new([(0.0, towards(DVec3::X)), (3.0, towards(-2.0 * DVec3::X))].into_iter());
        assert!((through.unwrap().degenerate_time_s().unwrap() - 1.0).abs() < 0.01);
    }
}
