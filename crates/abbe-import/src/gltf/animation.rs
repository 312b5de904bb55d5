//! Reads the animations of glTF files: translation, rotation and scale of nodes.

use crate::scene_writer::SceneWriter;
use ::gltf::animation::{Channel, Interpolation, Property};
use abbe_format::mesh::{GltfAccessors, GltfFile};
use abbe_spectra::math::rotation::slerp;
use glam::{DQuat, DVec4};
use std::collections::BTreeMap;

/// The time in s between the two keyframes of a step.
const STEP_S: f64 = 1e-6;

/// The animations of a file, by the number of the node.
#[derive(Default)]
pub(super) struct Animations {
    tracks: BTreeMap<usize, NodeTracks>,
}

#[derive(Default)]
pub(super) struct NodeTracks {
    pub(super) translation: Option<Track>,
    pub(super) rotation: Option<Track>,
    pub(super) scale: Option<Track>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track {
    /// The times of the keyframes in s, in rising order.
    times: Vec<f64>,
    /// One value for each time, or three of a cubic spline: tangent before, value, tangent after.
    values: Vec<[f64; 4]>,
    interpolation: Interpolation,
    is_rotation: bool,
}

impl Animations {
    /// Reads the animations of a file. The first of those that move the same property counts.
    pub(super) fn read(file: &GltfFile, accessors: &GltfAccessors, scene: &mut SceneWriter) -> Self {
        let mut animations = Self::default();
        if file.has_property_animations {
            scene.leave_out("", "animations of other properties than those of nodes are left out");
        }
        for animation in file.document.animations() {
            let place = animation
                .name()
                .map_or_else(|| format!("animation {}", animation.index()), |name| format!("animation \"{name}\""));
            for channel in animation.channels() {
                let tracks = animations.tracks.entry(channel.target().node().index()).or_default();
                let slot = match channel.target().property() {
                    Property::Translation => &mut tracks.translation,
                    Property::Rotation => &mut tracks.rotation,
                    Property::Scale => &mut tracks.scale,
                    Property::MorphTargetWeights => {
                        scene.leave_out(&place, "morph targets are left out; the mesh keeps its shape");
                        continue;
                    }
                };
                if slot.is_some() {
                    let what = "a second animation of the same nodes is left out; the first one counts";
                    scene.leave_out(&place, what);
                    continue;
                }
                match Track::read(&channel, accessors) {
                    Ok(track) => *slot = Some(track),
                    Err(reason) => scene.leave_out(&place, format!("a channel is left out: {reason}")),
                }
            }
        }
        animations.tracks.retain(|_, tracks| tracks.all().next().is_some());
        animations
    }

    pub(super) fn tracks(&self, node: usize) -> Option<&NodeTracks> {
        self.tracks.get(&node)
    }
}

impl NodeTracks {
    fn all(&self) -> impl Iterator<Item = &Track> {
        [&self.translation, &self.rotation, &self.scale].into_iter().flatten()
    }

    /// Returns the times of the keyframes. Each step has a second keyframe just before it.
    pub(super) fn times(&self) -> Vec<f64> {
        let before = |track: &Track| {
            let gap = |pair: &[f64]| pair[1] - STEP_S.min(0.5 * (pair[1] - pair[0]));
            let is_step = track.interpolation == Interpolation::Step;
            track.times.windows(2).filter(|_| is_step).map(gap).collect::<Vec<_>>()
        };
        self.all().flat_map(|track| before(track).into_iter().chain(track.times.clone())).collect()
    }

    pub(super) fn is_curved(&self) -> bool {
        self.all().any(|track| track.interpolation == Interpolation::CubicSpline)
    }
}

impl Track {
    /// Reads a channel. Returns the reason if the channel cannot be used.
    fn read(channel: &Channel, accessors: &GltfAccessors) -> std::result::Result<Self, String> {
        let sampler = channel.sampler();
        let floats = |accessor| accessors.floats(&accessor).map_err(|error| error.what);
        let times: Vec<f64> = floats(sampler.input())?.into_iter().map(|item| item[0]).collect();
        let values = floats(sampler.output())?;
        let interpolation = sampler.interpolation();
        let each = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let is_finite = times.iter().chain(values.iter().flatten()).all(|x| x.is_finite());
        if times.is_empty() || values.len() != each * times.len() || !is_finite {
            return Err("its times and values do not fit together".to_owned());
        }
        if times.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err("its times do not rise".to_owned());
        }
        let is_rotation = channel.target().property() == Property::Rotation;
        Ok(Self { times, values, interpolation, is_rotation })
    }

    /// Returns the value at a time in s, which is constant beyond the keyframes.
    pub(super) fn at(&self, time: f64) -> [f64; 4] {
        let value = |key: usize| match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            Interpolation::Linear | Interpolation::Step => self.values[key],
        };
        let next = self.times.partition_point(|&key| key <= time);
        if next == 0 || next == self.times.len() {
            return value(next.saturating_sub(1));
        }
        let before = next - 1;
        let length = self.times[next] - self.times[before];
        let fraction = (time - self.times[before]) / length;
        let [from, to] = [before, next].map(|key| DVec4::from_array(value(key)));
        match self.interpolation {
            Interpolation::Step => value(before),
            Interpolation::Linear if self.is_rotation => {
                let [from, to] = [from, to].map(|q| DQuat::from_vec4(q.normalize_or(DVec4::W)));
                slerp(from, to, fraction).to_array()
            }
            Interpolation::Linear => from.lerp(to, fraction).to_array(),
            Interpolation::CubicSpline => {
                // Hermite's form, as in appendix C of the specification of glTF 2.0.
                let tangent = |i: usize| length * DVec4::from_array(self.values[i]);
                let [leaving, arriving] = [3 * before + 2, 3 * next].map(tangent);
                let (t2, t3) = (fraction * fraction, fraction * fraction * fraction);
                let spline = (2.0 * t3 - 3.0 * t2 + 1.0) * from
                    + (t3 - 2.0 * t2 + fraction) * leaving
                    + (3.0 * t2 - 2.0 * t3) * to
                    + (t3 - t2) * arriving;
                spline.to_array()
            }
        }
    }
}
