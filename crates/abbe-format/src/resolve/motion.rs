//! Translates the shutter and the keyframes of the scene file. The results are the shutter of the
//! scene, and the motions while the shutter is open.

use super::context::Resolver;
use crate::{CameraFile, KeyframeFile, LightFile, MediumFile, TransformFile};
use abbe_scene::camera::Shutter;
use abbe_scene::motion::{AnimatedLookAt, AnimatedTransform, LookAt};
use glam::{DAffine3, DVec3};

/// The motion of an object, a light or a medium, and its transform when the shutter opens.
pub(super) struct ResolvedMotion {
    /// The transform from the object's frame to the world at that moment, in the scene's unit.
    pub(super) start: DAffine3,
    /// The motion, with lengths in m. `None` if the object does not move while the shutter is open.
    pub(super) motion: Option<AnimatedTransform>,
}

/// The motion through all keyframes in the scene's unit, or `None` if there are none.
fn motion(transform: &TransformFile, keys: &[KeyframeFile]) -> Option<AnimatedTransform> {
    let own = transform.to_affine();
    AnimatedTransform::new(own, keys.iter().map(|key| (key.time, key.transform.to_affine(), key.transform.after(own))))
}

impl Resolver<'_> {
    pub(super) fn motion(&self, transform: &TransformFile, keys: &[KeyframeFile]) -> ResolvedMotion {
        let Some(motion) = motion(transform, keys) else {
            return ResolvedMotion { start: transform.to_affine(), motion: None };
        };
        let Shutter { open_s, close_s, .. } = self.shutter;
        let moves = motion.moves(open_s, close_s);
        ResolvedMotion { start: motion.at(open_s), motion: moves.then(|| motion.scaled(self.metres)) }
    }

    /// The camera's pose when the shutter opens, and the camera's motion. The pose is in the
    /// scene's unit. The motion is in m, relative to the scene's centre.
    pub(super) fn camera_motion(&self, file: &CameraFile, centre: DVec3) -> (LookAt, Option<AnimatedLookAt>) {
        let Some(motion) = file.camera_motion() else {
            let [from, at, up] = [file.from, file.at, file.up].map(DVec3::from);
            return (LookAt { from, at, up }, None);
        };
        let Shutter { open_s, close_s, .. } = self.shutter;
        let in_m = |LookAt { from, at, up }: LookAt| LookAt {
            from: from * self.metres - centre,
            at: at * self.metres - centre,
            up,
        };
        (motion.at(open_s), motion.moves(open_s, close_s).then(|| motion.map(in_m)))
    }

    /// Returns a remark if the scene has keyframes, but nothing moves while the shutter is open.
    pub(super) fn note_without_motion(&self) -> Option<String> {
        let Shutter { open_s, close_s, .. } = self.shutter;
        let objects = self.scene.objects.iter().map(|object| (&object.transform, object.motion.as_slice()));
        let lights = self.scene.lights.iter().map(LightFile::pose_and_group).map(|(place, keys, _)| (place, keys));
        let media = self.scene.media.values().map(MediumFile::transform_and_motion);
        let motions: Vec<AnimatedTransform> =
            objects.chain(lights).chain(media).filter_map(|(transform, keys)| motion(transform, keys)).collect();
        let camera = self.scene.camera.as_ref().and_then(CameraFile::camera_motion);
        let any = !motions.is_empty() || camera.is_some();
        let moves = motions.iter().any(|motion| motion.moves(open_s, close_s))
            || camera.is_some_and(|camera| camera.moves(open_s, close_s));
        let when = match self.scene.camera.as_ref().and_then(|camera| camera.shutter.as_ref()) {
            None => "there is no `camera.shutter`, so the picture shows the time 0 s".to_owned(),
            Some(_) if open_s == close_s => format!("the shutter opens and closes at {open_s} s"),
            Some(_) => format!("the shutter is open from {open_s} s to {close_s} s"),
        };
        (any && !moves).then(|| format!("the scene has keyframes, but nothing moves: {when}"))
    }
}
