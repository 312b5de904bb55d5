//! The selection of the lights that a point samples.
//!
//! With at most eight lights, each point samples all of them. With more, it samples one emitter of
//! a light tree, or one of the emitters that light the surfaces around it, as the pilot learned.
//! Distant lights and parallel beams are not in the tree, because their irradiance does not fall
//! with the distance; each point also samples one of them, in proportion to their powers.
//!
//! A luminous mesh counts as many lights. In a scene with at most eight lights, a mesh of more than
//! eight triangles has a tree of its own, which selects the triangle.

use super::learned_lights::{LearnedLights, LearnedWeights, LightTrial};
use super::light_tree::{Emitters, Receiver, ReceivingPoint};
use abbe_scene::Scene;
use abbe_scene::geometry::Hit;
use abbe_spectra::math::distribution::DiscreteDistribution;
use std::ops::Range;

/// If a scene has at most this number of lights, each point samples all lights.
const SAMPLE_ALL_LIGHTS: usize = 8;

#[derive(Debug, Clone)]
pub struct LightSelector {
    light_count: usize,
    /// Those of each point. Empty if each point samples all lights, and no light has a tree.
    samples: Vec<Sampled>,
    /// For each light, how it is sampled. Empty if `samples` is empty.
    lights: Vec<SampledBy>,
    emitters: Emitters,
    /// Selects one of the lights that are not in the tree. `None` if there are none.
    outside: Option<DiscreteDistribution>,
    /// The learned weights of the emitters in the tree over all local lights.
    learned: LearnedLights,
}

#[derive(Debug, Clone, Copy)]
enum Sampled {
    Light(usize),
    Outside,
    /// One emitter of the tree with this root, selected by the random number `by`.
    Tree {
        root: usize,
        by: usize,
    },
}

#[derive(Debug, Clone, Copy)]
enum SampledBy {
    EveryPoint,
    /// The light is one of the lights outside the tree.
    Outside,
    /// The light is in the tree with this root. `emitter` is the first emitter of the light.
    Tree {
        root: usize,
        emitter: usize,
    },
}

#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct SelectedLight {
    pub(in crate::gather) number: usize,
    /// The random numbers that sample a point of the light.
    pub(in crate::gather) u: [f64; 3],
    /// The factor on the density of the samples of the light: the probability of a whole light, or
    /// that of the tree divided by that of the sampling of the whole mesh for a triangle.
    pub(in crate::gather) probability: f64,
}

impl LightSelector {
    /// Serves a posed scene. `powers` is the distribution of photons over the lights.
    pub fn new(scene: &Scene, powers: &DiscreteDistribution) -> Self {
        let light_count = scene.lights.len();
        let selector = Self {
            light_count,
            samples: Vec::new(),
            lights: Vec::new(),
            emitters: Emitters::default(),
            outside: None,
            learned: LearnedLights::default(),
        };
        if light_count > SAMPLE_ALL_LIGHTS {
            selector.with_tree(scene, powers)
        } else {
            selector.with_meshes(scene, powers)
        }
    }

    fn with_tree(mut self, scene: &Scene, powers: &DiscreteDistribution) -> Self {
        let bounds: Vec<_> = scene.lights.iter().map(|light| light.intensity_bounds(scene.extent())).collect();
        let inside = bounds.iter().enumerate().filter_map(|(number, bounds)| Some((number, (*bounds)?)));
        let root = self.emitters.add_tree(scene, powers, inside);
        let weights =
            bounds.iter().enumerate().map(|(i, known)| if known.is_some() { 0.0 } else { powers.probability(i) });
        self.outside = DiscreteDistribution::new(weights);
        self.lights = vec![SampledBy::Outside; self.light_count];
        if let Some(root) = root {
            for (emitter, known) in self.emitters.list.iter().enumerate().rev() {
                self.lights[known.light as usize] = SampledBy::Tree { root, emitter };
            }
        }
        self.samples.extend(self.outside.as_ref().map(|_| Sampled::Outside));
        self.samples.extend(root.map(|root| Sampled::Tree { root, by: 2 }));
        self
    }

    fn with_meshes(mut self, scene: &Scene, powers: &DiscreteDistribution) -> Self {
        let is_large = |number: usize| {
            let object = scene.lights[number].object();
            object.is_some_and(|object| scene.geometry.triangle_count(object) > SAMPLE_ALL_LIGHTS)
        };
        if !Emitters::splits_meshes(scene) || !(0..self.light_count).any(is_large) {
            return self;
        }
        for number in 0..self.light_count {
            let (emitter, bounds) = (self.emitters.list.len(), scene.lights[number].intensity_bounds(scene.extent()));
            let light = bounds.filter(|_| is_large(number)).map(|bounds| (number, bounds));
            let root = self.emitters.add_tree(scene, powers, light.into_iter());
            self.samples.push(root.map_or(Sampled::Light(number), |root| Sampled::Tree { root, by: 0 }));
            self.lights.push(root.map_or(SampledBy::EveryPoint, |root| SampledBy::Tree { root, emitter }));
        }
        self
    }

    /// Returns true if trials can teach the selector: there is a tree over all local lights.
    pub fn learns(&self) -> bool {
        self.light_count > SAMPLE_ALL_LIGHTS && !self.emitters.list.is_empty()
    }

    #[must_use]
    pub fn learned_from(&self, trials: &[LightTrial]) -> Self {
        let importance = |emitter: u32, trial: &LightTrial| {
            let receiver = ReceivingPoint { position: trial.position, normal: trial.normal };
            receiver.importance(self.emitters.tree.cluster_of(emitter as usize))
        };
        Self { learned: LearnedLights::new(trials, &importance), ..self.clone() }
    }

    /// Takes the learned weights of the selector of the same scene at another time.
    #[must_use]
    pub fn with_learned_of(self, other: &Self) -> Self {
        Self { learned: other.learned.clone(), ..self }
    }

    /// Returns true if each point samples all lights, and no light has a tree.
    #[inline]
    fn samples_all(&self) -> bool {
        self.samples.is_empty()
    }

    /// Selects the lights that a receiver samples. `u` holds the random numbers of all samples.
    #[inline]
    pub(in crate::gather) fn select<R: Receiver>(&self, receiver: R, u: [f64; 3]) -> LightSelection<'_, R> {
        let count = if self.samples_all() { self.light_count } else { self.samples.len() };
        LightSelection { selector: self, receiver, u, samples: 0..count }
    }

    /// Selects an emitter of the tree over all local lights for a trial. Returns the light (with
    /// the probability 1 for a whole light), the number of the emitter and its importance, or
    /// `None` if the tree has no light for the receiver, or if that is not a side of a surface.
    pub(super) fn select_for_trial(
        &self,
        receiver: ReceivingPoint,
        mut u: [f64; 3],
    ) -> Option<(SelectedLight, u32, f64)> {
        receiver.surface()?;
        let in_tree = |sample: &Sampled| if let Sampled::Tree { root, by } = *sample { Some((root, by)) } else { None };
        let (root, by) = self.samples.iter().find_map(in_tree)?;
        let emitter = self.emitters.tree.sample_for_trial(root, &receiver, &mut u[by])?;
        let importance = receiver.importance(self.emitters.tree.cluster_of(emitter));
        Some((self.selected(emitter, 1.0, u), emitter as u32, importance))
    }

    fn selected(&self, emitter: usize, probability: f64, u: [f64; 3]) -> SelectedLight {
        let emitter = self.emitters.list[emitter];
        let mut selected = SelectedLight { number: emitter.light as usize, u, probability };
        if let Some(triangle) = emitter.triangle {
            selected.u[0] = triangle.selecting;
            selected.probability /= triangle.probability;
        }
        selected
    }

    /// Takes one sample. Returns `None` if the receiver gets no light from the tree.
    #[inline(never)]
    fn take(&self, sample: usize, receiver: &impl Receiver, mut u: [f64; 3]) -> Option<SelectedLight> {
        match self.samples[sample] {
            Sampled::Light(number) => Some(SelectedLight { number, u, probability: 1.0 }),
            Sampled::Outside => {
                let number = self.outside.as_ref()?.sample(&mut u[2]);
                Some(SelectedLight { number, u, probability: self.outside_probability(number) })
            }
            Sampled::Tree { root, by } => {
                let (emitter, probability) = self.sample_emitter(root, receiver, &mut u[by])?;
                Some(self.selected(emitter, probability, u))
            }
        }
    }

    /// Samples an emitter from the learned weights or the tree. Returns its number and probability,
    /// and replaces `u` by a new uniform number.
    fn sample_emitter(&self, root: usize, receiver: &impl Receiver, u: &mut f64) -> Option<(usize, f64)> {
        let tree = &self.emitters.tree;
        let Some(learned) = self.learned_weights(receiver) else { return tree.sample(root, receiver, u) };
        let (emitter, in_tree);
        if *u < learned.fraction {
            *u /= learned.fraction;
            emitter = learned.sample(u);
            in_tree = tree.probability(root, emitter, receiver);
        } else {
            *u = (*u - learned.fraction) / (1.0 - learned.fraction);
            (emitter, in_tree) = tree.sample(root, receiver, u)?;
        }
        Some((emitter, learned.mixed(emitter, in_tree)))
    }

    /// Returns the probability with which a receiver samples an emitter of a tree.
    fn emitter_probability(&self, root: usize, emitter: usize, receiver: &impl Receiver) -> f64 {
        let in_tree = self.emitters.tree.probability(root, emitter, receiver);
        self.learned_weights(receiver).map_or(in_tree, |learned| learned.mixed(emitter, in_tree))
    }

    /// Returns the learned weights of the emitters in the cell of a receiver.
    fn learned_weights(&self, receiver: &impl Receiver) -> Option<LearnedWeights<'_>> {
        let importance = |emitter| receiver.importance(self.emitters.tree.cluster_of(emitter));
        self.learned.weights(receiver.surface()?, importance)
    }

    fn outside_probability(&self, number: usize) -> f64 {
        self.outside.as_ref().map_or(0.0, |outside| outside.probability(number))
    }

    /// Returns [`SelectedLight::probability`] of a light that a ray from `receiver` hit. `hit` is
    /// `None` for lights at infinity.
    #[inline]
    pub(in crate::gather) fn probability(
        &self,
        scene: &Scene,
        number: usize,
        hit: Option<&Hit>,
        receiver: &ReceivingPoint,
    ) -> f64 {
        if self.samples_all() { 1.0 } else { self.probability_in_trees(scene, number, hit, receiver) }
    }

    #[inline(never)]
    fn probability_in_trees(&self, scene: &Scene, number: usize, hit: Option<&Hit>, receiver: &ReceivingPoint) -> f64 {
        let (root, first) = match self.lights[number] {
            SampledBy::EveryPoint => return 1.0,
            SampledBy::Outside => return self.outside_probability(number),
            SampledBy::Tree { root, emitter } => (root, emitter),
        };
        if self.emitters.list[first].triangle.is_none() {
            return self.emitter_probability(root, first, receiver);
        }
        let face = hit.and_then(|hit| scene.geometry.number_of_face(hit.object, hit.surface));
        let Some(emitter) = face.map(|face| first + face) else { return 0.0 };
        let in_mesh = self.emitters.list[emitter].triangle.map_or(1.0, |triangle| triangle.probability);
        self.emitter_probability(root, emitter, receiver) / in_mesh
    }
}

#[derive(Debug)]
pub(in crate::gather) struct LightSelection<'s, R> {
    selector: &'s LightSelector,
    receiver: R,
    u: [f64; 3],
    samples: Range<usize>,
}

impl<R: Receiver> Iterator for LightSelection<'_, R> {
    type Item = SelectedLight;

    #[inline]
    fn next(&mut self) -> Option<SelectedLight> {
        loop {
            let sample = self.samples.next()?;
            if self.selector.samples_all() {
                return Some(SelectedLight { number: sample, u: self.u, probability: 1.0 });
            }
            if let Some(selected) = self.selector.take(sample, &self.receiver, self.u) {
                return Some(selected);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::LightSampler;
    use abbe_format as format;
    use abbe_format::resolve::resolve;
    use glam::DVec3;

    /// Returns a scene with so many points, a sphere that emits, and two distant lights.
    fn scene(points: usize) -> Scene {
        let point = |i| format!(r#"{{"point": {{"at": [{i}, 3, 3], "spectrum": "E", "power": 1}}}}"#);
        let lights: Vec<String> = (0..points).map(point).collect();
        let text = format!(
            r#"{{
  "camera": {{"from": [0, 0, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
  "film": {{"width": 8, "height": 8}},
  "materials": {{"grey": {{"diffuse": {{"reflectance": 0.5}}}}}},
  "objects": [{{"shape": {{"sphere": {{"radius": 0.5}}}}, "material": "grey", "emission": {{"spectrum": "E", "power": 3}}}},
              {{"shape": {{"rectangle": {{"width": 9, "height": 9}}}}, "material": "grey"}}],
  "lights": [{{"environment": {{"spectrum": "E", "illuminance": 9}}}},
             {{"directional": {{"toward": [0, -1, 0], "spectrum": "E", "illuminance": 9}}}}, {}]
}}"#,
            lights.join(", ")
        );
        let (written, source) = format::parse(&text, "lights.json".as_ref(), &[]).unwrap();
        resolve(&written, &source).unwrap()
    }

    fn selector(scene: &Scene) -> LightSelector {
        LightSelector::new(scene, &LightSampler::new(scene).unwrap().lights)
    }

    #[test]
    fn up_to_eight_lights_are_all_sampled() {
        let scene = scene(5);
        let (selector, u) = (selector(&scene), [0.1, 0.5, 0.9]);
        assert_eq!(scene.lights.len(), 8);
        let selected: Vec<_> = selector.select(ReceivingPoint::in_medium(DVec3::Y), u).collect();
        assert_eq!(selected.iter().map(|light| light.number).collect::<Vec<_>>(), (0..8).collect::<Vec<_>>());
        assert!(selected.iter().all(|light| light.probability == 1.0 && light.u == u));
    }

    /// A point samples one local and one distant light. The probabilities of each group sum to 1,
    /// and agree with those of lights that a ray hits.
    #[test]
    fn many_lights_are_sampled_with_their_probabilities() {
        let scene = scene(30);
        let selector = selector(&scene);
        for position in [DVec3::new(4.0, 1.0, 0.0), DVec3::new(29.0, 2.9, 3.0)] {
            let receiver = ReceivingPoint::in_medium(position);
            let probability = |number: usize| selector.probability(&scene, number, None, &receiver);
            let sum = |distant: bool| {
                let of_kind = (0..scene.lights.len()).filter(|&i| scene.lights[i].is_distant() == distant);
                of_kind.map(probability).sum::<f64>()
            };
            assert!((sum(true) - 1.0).abs() < 1e-12 && (sum(false) - 1.0).abs() < 1e-12);
            for u in [0.0, 0.3, 0.99] {
                let selected: Vec<_> = selector.select(receiver, [0.1, 0.2, u]).collect();
                assert_eq!(selected.len(), 2);
                for light in selected {
                    assert!((light.probability / probability(light.number) - 1.0).abs() < 1e-12);
                }
            }
        }
    }
}
