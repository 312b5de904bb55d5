//! Refuses very many copies of an object at one place.

use super::Scene;
use super::builder::{SceneError, ScenePart};
use abbe_spectra::error::Error;
use std::collections::BTreeMap;

/// The largest number of objects with the same bounding box. A ray that meets one of them is
/// intersected with all of them, and in glass a ray crosses each of them.
const MOST_COPIES: usize = 1000;

impl Scene {
    /// Returns an error if too many objects have the same bounding box, as copies of one object at
    /// one place have. In a scene with motion, they may part, so none is refused.
    pub(super) fn check_copies(&self) -> Result<(), SceneError> {
        if self.moves() {
            return Ok(());
        }
        let mut copies: BTreeMap<[u64; 6], Vec<u32>> = BTreeMap::new();
        for (object, (low, high)) in self.geometry.object_bounds() {
            let [[a, b, c], [d, e, f]] = [low, high].map(|corner| corner.to_array().map(f64::to_bits));
            copies.entry([a, b, c, d, e, f]).or_default().push(object);
        }
        let crowd = copies.values().find(|objects| objects.len() > MOST_COPIES);
        let Some([first, others @ ..]) = crowd.map(Vec::as_slice) else { return Ok(()) };
        let name = &self.objects[*first as usize].name;
        let what = format!("\"{name}\" and {} other objects have the same place and the same size", others.len());
        let expected =
            format!("at most {MOST_COPIES} objects in one box, because each ray through it meets all of them");
        Err(ScenePart::Objects.error(Error::input(what).expected(expected)))
    }
}
