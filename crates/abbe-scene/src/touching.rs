//! Finds transparent bodies whose faces coincide. A ray leaves the first body before it enters the
//! second, so a film of air remains between them, which reflects light.

use super::Scene;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::{Hit, Ray};
use abbe_spectra::math::sobol::Sobol;

impl Scene {
    /// Returns a note for each pair of touching bodies, at most a few. Very small areas of contact
    /// are not found, and scenes of very many bodies are not searched.
    pub(super) fn notes_of_touching_bodies(&self) -> Vec<String> {
        /// The largest number of notes, and of pairs whose faces are compared.
        const MOST_NOTES: usize = 3;
        const MOST_PAIRS: usize = 100;
        const MOST_BODIES: usize = 1000;
        let refracts = |object: u32| self.body_of(object).is_some_and(|body| body.index.is_some());
        let bodies = self.geometry.object_bounds().into_iter().filter(|(object, _)| refracts(*object));
        let (objects, boxes): (Vec<u32>, Vec<_>) = bodies.map(|(object, around)| (object, (around, 0.0))).unzip();
        if !(2..=MOST_BODIES).contains(&objects.len()) {
            return Vec::new();
        }
        let (tree, mut notes, mut pairs) = (BoxTree::new(&boxes), Vec::new(), 0);
        for (&object, &((low, high), _)) in objects.iter().zip(&boxes) {
            let margin = ROUNDING * (high - low).max_element();
            tree.any_touching((low - margin, high + margin), |other| {
                let other = objects[other as usize];
                if other > object {
                    pairs += 1;
                    let touches = self.touches(object, other) || self.touches(other, object);
                    notes.extend(touches.then(|| self.note_of_contact(object, other)));
                }
                pairs >= MOST_PAIRS || notes.len() >= MOST_NOTES
            });
            if pairs >= MOST_PAIRS || notes.len() >= MOST_NOTES {
                break;
            }
        }
        notes
    }

    fn note_of_contact(&self, object: u32, other: u32) -> String {
        let [one, other] = [object, other].map(|number| &self.objects[number as usize].name);
        format!(
            "\"{one}\" and \"{other}\" touch, and a film of air between them reflects light; for contact without air, \
             let one reach into the other, and give the one that fills the common space the higher `priority`"
        )
    }

    /// Returns true if a ray that leaves `object` at one of some points enters `other` at the same
    /// place.
    fn touches(&self, object: u32, other: u32) -> bool {
        /// The number of points on the surface. They find contacts of more than a few percent of
        /// it.
        const POINTS: u32 = 64;
        let sobol = Sobol::new(7);
        (0..POINTS).any(|i| {
            let sample = self.geometry.sample_area(object, [0, 1, 2].map(|dimension| sobol.at(i, dimension)));
            let size = sample.position.abs().max_element().max(self.radius_m * ROUNDING);
            let ray = Ray { origin: sample.position - size * 1e3 * ROUNDING * sample.normal, direction: sample.normal };
            let left = |hit: &Hit| hit.object == object && hit.normal.dot(ray.direction) > 0.0;
            let entered = |hit: &Hit| hit.object == other && hit.normal.dot(ray.direction) < 0.0;
            let Some(first) = self.geometry.intersect(&ray, None, f64::INFINITY).filter(left) else { return false };
            let next = Ray { origin: first.position, direction: ray.direction };
            let second = self.geometry.intersect(&next, Some(first.surface), size * ROUNDING);
            second.as_ref().is_some_and(entered)
        })
    }
}

/// The distance of coincident faces, as a fraction of their coordinates.
const ROUNDING: f64 = 1e-12;
