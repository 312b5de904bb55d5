//! The tree of nodes of a glTF file, with the motion of each node.

use super::animation::{Animations, NodeTracks};
use ::gltf::Node;
use ::gltf::scene::Transform;
use abbe_format::mesh::affine;
use abbe_scene::motion::DecomposedTransform;
use abbe_spectra::math::rotation::{angle_between, slerp};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::{Value, json};

/// The number of parts into which an interval between keyframes is divided if the motion of the
/// node in this interval has no exact form in the scene file.
const SUBDIVISIONS: u32 = 8;

/// The largest rotation in radians between two keyframes. At π, its direction is ambiguous.
const MAX_ROTATION: f64 = 0.8 * std::f64::consts::PI;

/// The smallest magnitude of an animated scale. A scale of 0 has no inverse.
const MIN_SCALE: f64 = 1e-6;

/// The largest number of keyframes of a node.
const MAX_KEYFRAMES: usize = 100_000;

/// The nodes that were visited so far.
pub(super) struct NodeTree {
    animations: Animations,
    /// The parent and the local transform of each node, by the number of the node.
    nodes: Vec<Option<(Option<usize>, LocalTransform)>>,
}

/// The local transform of a node at rest.
#[derive(Clone, Copy)]
struct LocalTransform {
    whole: DAffine3,
    parts: DecomposedTransform,
}

/// The place of a node: `own` is applied first, and then the keyframes of `motion`.
pub(super) struct PlacedNode {
    pub(super) own: DAffine3,
    /// Pairs of a time in s and a transform. Empty if the node does not move.
    pub(super) motion: Vec<(f64, DAffine3)>,
    /// True if the motion was left out, because it has a shear.
    pub(super) is_sheared: bool,
}

impl PlacedNode {
    pub(super) fn at_start(&self) -> DAffine3 {
        let after = self.motion.iter().rev().find(|(time, _)| *time <= 0.0).or(self.motion.first());
        after.map_or(self.own, |(_, motion)| *motion * self.own)
    }

    /// Returns false if a scale of the node is 0.
    pub(super) fn is_invertible(&self) -> bool {
        let linear = self.own.matrix3;
        let unit = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::try_normalize);
        matches!(unit, [Some(x), Some(y), Some(z)] if x.cross(y).dot(z).abs() > 1e-9)
    }
}

/// Returns a transform with a small thickness in the direction that another one makes flat, or
/// `None` if the other one leaves no area.
pub(super) fn thickened(flat: &DAffine3) -> Option<DAffine3> {
    let linear = flat.matrix3;
    let size = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length).into_iter().fold(0.0, f64::max);
    // The direction across the columns, and that across the rows, which becomes 0.
    let across = |matrix: DMat3| {
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        let crosses = [x.cross(y), y.cross(z), z.cross(x)];
        let longest = crosses.into_iter().reduce(|a, b| if a.length() >= b.length() { a } else { b })?;
        if longest.length() > 1e-12 * size * size { longest.try_normalize() } else { None }
    };
    let (normal, lost) = (across(linear)?, across(linear.transpose())?);
    let thin = (MIN_SCALE * size) * normal;
    let thickness = DMat3::from_cols(thin * lost.x, thin * lost.y, thin * lost.z);
    let [one, other] = [linear + thickness, linear - thickness];
    let matrix3 = if one.determinant() > 0.0 { one } else { other };
    Some(DAffine3 { matrix3, translation: flat.translation })
}

impl NodeTree {
    pub(super) fn new(animations: Animations) -> Self {
        Self { animations, nodes: Vec::new() }
    }

    /// Adds a node. Its parent was added before.
    pub(super) fn add(&mut self, node: &Node, parent: Option<usize>) {
        if self.nodes.len() <= node.index() {
            self.nodes.resize(node.index() + 1, None);
        }
        let whole = affine(&node.transform());
        let parts = match node.transform() {
            Transform::Matrix { .. } => DecomposedTransform::of(&whole),
            Transform::Decomposed { translation, rotation, scale } => DecomposedTransform {
                translation: DVec3::from(translation.map(f64::from)),
                rotation: unit(DQuat::from_array(rotation.map(f64::from))),
                scale: DVec3::from(scale.map(f64::from)),
            },
        };
        let local = LocalTransform { whole, parts };
        self.nodes[node.index()] = Some((parent, local));
    }

    /// Returns the place of a node. `to_world` is its transform at rest.
    pub(super) fn place(&self, node: usize, to_world: &DAffine3) -> PlacedNode {
        let still = PlacedNode { own: *to_world, motion: Vec::new(), is_sheared: false };
        // From the node to the root.
        let chain: Vec<usize> =
            std::iter::successors(Some(node), |&node| self.nodes[node].and_then(|(parent, _)| parent)).collect();
        let Some(deepest) = chain.iter().position(|node| self.animations.tracks(*node).is_some()) else { return still };
        let own = chain[..deepest].iter().rev().fold(DAffine3::IDENTITY, |all, &node| all * self.local(node, None));
        let moving = &chain[deepest..];
        let at = |time: f64| {
            moving.iter().rev().fold(DAffine3::IDENTITY, |before, &node| before * self.local(node, Some(time)))
        };
        let motion: Vec<(f64, DAffine3)> = self.times(moving).into_iter().map(|time| (time, at(time))).collect();
        if motion.iter().any(|(_, at)| DecomposedTransform::is_sheared(at)) {
            return PlacedNode { own: at(0.0) * own, is_sheared: true, ..still };
        }
        if motion.iter().all(|(_, at)| at.abs_diff_eq(motion[0].1, 1e-12)) {
            return PlacedNode { own: motion.first().map_or(DAffine3::IDENTITY, |(_, at)| *at) * own, ..still };
        }
        PlacedNode { own, motion: with_small_rotations(motion), is_sheared: false }
    }

    /// Returns the transform of a node to its parent, at rest or at a time.
    fn local(&self, node: usize, time: Option<f64>) -> DAffine3 {
        let Some((_, rest)) = &self.nodes[node] else { return DAffine3::IDENTITY };
        let (Some(time), Some(tracks)) = (time, self.animations.tracks(node)) else {
            return rest.whole;
        };
        let NodeTracks { translation, rotation, scale } = tracks;
        let vector = |values: [f64; 4]| DVec3::new(values[0], values[1], values[2]);
        let moved = DecomposedTransform {
            translation: translation.as_ref().map_or(rest.parts.translation, |track| vector(track.at(time))),
            rotation: rotation.as_ref().map_or(rest.parts.rotation, |track| unit(DQuat::from_array(track.at(time)))),
            scale: scale
                .as_ref()
                .map_or(rest.parts.scale, |track| vector(track.at(time)))
                .map(|s| if s.abs() < MIN_SCALE { MIN_SCALE } else { s }),
        };
        DAffine3::from_scale_rotation_translation(moved.scale, moved.rotation, moved.translation)
    }

    fn times(&self, chain: &[usize]) -> Vec<f64> {
        let animated: Vec<&NodeTracks> = chain.iter().filter_map(|&node| self.animations.tracks(node)).collect();
        let mut times: Vec<f64> = animated.iter().flat_map(|tracks| tracks.times()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        if animated.len() > 1 || animated.iter().any(|tracks| tracks.is_curved()) {
            let between = |pair: &[f64]| {
                let (from, to) = (pair[0], pair[1]);
                (1..SUBDIVISIONS).map(move |i| from + (to - from) * f64::from(i) / f64::from(SUBDIVISIONS))
            };
            let further: Vec<f64> = times.windows(2).flat_map(between).collect();
            times.extend(further);
            times.sort_by(f64::total_cmp);
            times.dedup();
        }
        times.truncate(MAX_KEYFRAMES);
        times
    }
}

pub(super) fn unit(rotation: DQuat) -> DQuat {
    if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY }
}

/// Inserts keyframes, so that the rotation between two keyframes stays below 180°.
fn with_small_rotations(keys: Vec<(f64, DAffine3)>) -> Vec<(f64, DAffine3)> {
    let mut all: Vec<(f64, DAffine3)> = Vec::with_capacity(keys.len());
    for (time, at) in keys {
        if let Some((before_time, before)) = all.last() {
            let [from, to] = [before, &at].map(DecomposedTransform::of);
            let middle = 0.5 * (before_time + time);
            if angle_between(from.rotation, to.rotation) > MAX_ROTATION && *before_time < middle && middle < time {
                let halfway = between(&from, &to, 0.5);
                all.push((middle, halfway));
            }
        }
        all.push((time, at));
    }
    all
}

/// Returns the transform between `from` (`fraction` = 0) and `to` (`fraction` = 1).
fn between(from: &DecomposedTransform, to: &DecomposedTransform, fraction: f64) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        from.scale.lerp(to.scale, fraction),
        slerp(from.rotation, to.rotation, fraction),
        from.translation.lerp(to.translation, fraction),
    )
}

/// Divides each interval between keyframes, for motions that are straight between keyframes.
pub(super) fn subdivided(keys: &[(f64, DAffine3)]) -> Vec<(f64, DAffine3)> {
    let inside = |pair: &[(f64, DAffine3)]| {
        let times = (pair[0].0, pair[1].0);
        let [from, to] = [pair[0].1, pair[1].1].map(|at| DecomposedTransform::of(&at));
        let at = move |i: u32| {
            let fraction = f64::from(i) / f64::from(SUBDIVISIONS);
            (times.0 + fraction * (times.1 - times.0), between(&from, &to, fraction))
        };
        let first = pair[0];
        std::iter::once(first).chain((1..SUBDIVISIONS).map(at)).filter(move |key| key.0 < times.1)
    };
    let mut all: Vec<(f64, DAffine3)> = keys.windows(2).flat_map(inside).collect();
    all.extend(keys.last());
    all.dedup_by(|later, earlier| later.0 <= earlier.0);
    all
}

/// Returns the steps of a transform of the scene file.
pub(super) fn steps(transform: &DAffine3) -> Value {
    let DAffine3 { matrix3, translation } = transform;
    if matrix3.abs_diff_eq(glam::DMat3::IDENTITY, 0.0) {
        return if *translation == DVec3::ZERO { json!([]) } else { json!([{"translate": translation.to_array()}]) };
    }
    let row = |i: usize| [matrix3.x_axis[i], matrix3.y_axis[i], matrix3.z_axis[i], translation[i]];
    json!([{"matrix": [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]}])
}
