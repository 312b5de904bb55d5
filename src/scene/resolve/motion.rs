//! Shutter and keyframes as written → when the camera is open, and the ways of what moves meanwhile.

use super::Resolver;
use crate::scene::camera::Shutter;
use crate::scene::file::{CameraFile, KeyframeFile, LightFile, MediumFile, ShutterFile, TransformFile};
use crate::scene::motion::{CameraMotion, Motion, MovingShape, Stand};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Where a thing stands when the shutter opens, and its way from there.
pub(super) struct Way {
    /// The thing's frame → the world, in the scene's unit.
    pub(super) placing: DAffine3,
    /// Its way in m, if it moves while the shutter is open.
    pub(super) motion: Option<Motion>,
}

/// When a camera is open; one without a shutter takes the moment 0.
pub(super) fn shutter(camera: &CameraFile) -> Shutter {
    match &camera.shutter {
        None => Shutter::new(0.0, 0.0, None),
        Some(ShutterFile { open, close, curve }) => Shutter::new(*open, *close, curve.as_deref()),
    }
}

/// The shapes of a scene in which any of them moves; none otherwise.
pub(super) fn shapes(shapes: Vec<MovingShape>) -> Arc<[MovingShape]> {
    if shapes.iter().any(|shape| shape.motion.is_some()) { shapes.into() } else { Arc::default() }
}

/// A thing's way through all its keyframes, in the scene's unit; `None` if it has none.
fn motion(transform: &TransformFile, keys: &[KeyframeFile]) -> Option<Motion> {
    let own = transform.to_affine();
    Motion::new(own, keys.iter().map(|key| (key.time, key.transform.to_affine(), key.transform.after(own))))
}

impl Resolver<'_> {
    /// The way of a thing with a transform and keyframes.
    pub(super) fn way(&self, transform: &TransformFile, keys: &[KeyframeFile]) -> Way {
        let Some(motion) = motion(transform, keys) else {
            return Way { placing: transform.to_affine(), motion: None };
        };
        let Shutter { open_s, close_s, .. } = self.shutter;
        let moves = motion.moves(open_s, close_s);
        Way { placing: motion.at(open_s), motion: moves.then(|| motion.scaled(self.metres)) }
    }

    /// How the camera stands when the shutter opens, in the scene's unit; and its way, relative to the scene's centre, in m.
    pub(super) fn camera_way(&self, file: &CameraFile, centre: DVec3) -> (Stand, Option<CameraMotion>) {
        let Some(motion) = file.way() else {
            return ([file.from, file.at, file.up].map(DVec3::from), None);
        };
        let Shutter { open_s, close_s, .. } = self.shutter;
        let placed = |[from, at, up]: Stand| [from * self.metres - centre, at * self.metres - centre, up];
        (motion.at(open_s), motion.moves(open_s, close_s).then(|| motion.map(placed)))
    }

    /// A remark if things have keyframes and none of them moves while the shutter is open.
    pub(super) fn standing_still(&self) -> Option<String> {
        let Shutter { open_s, close_s, .. } = self.shutter;
        let objects = self.scene.objects.iter().map(|object| (&object.transform, object.motion.as_slice()));
        let lights = self.scene.lights.iter().map(LightFile::way);
        let media = self.scene.media.values().map(MediumFile::way);
        let ways: Vec<Motion> =
            objects.chain(lights).chain(media).filter_map(|(transform, keys)| motion(transform, keys)).collect();
        let camera = self.scene.camera.way();
        let any = !ways.is_empty() || camera.is_some();
        let moves = ways.iter().any(|way| way.moves(open_s, close_s))
            || camera.is_some_and(|camera| camera.moves(open_s, close_s));
        let when = match &self.scene.camera.shutter {
            None => "there is no `camera.shutter`: the picture is of the moment 0 s".to_owned(),
            Some(_) if open_s == close_s => format!("the shutter opens and closes at {open_s} s"),
            Some(_) => format!("the shutter is open from {open_s} s to {close_s} s"),
        };
        (any && !moves).then(|| format!("things have keyframes, but nothing moves: {when}"))
    }
}
