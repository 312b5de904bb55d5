//! The ranks of bodies, which decide which body fills the space where bodies overlap.

use super::Scene;
use glam::DVec3;

impl Scene {
    /// Ranks the bodies by their priority, bodies of equal priority by the volume of their bounding
    /// boxes (a smaller box ranks higher), and equal volumes by the object number (the last ranks
    /// highest).
    ///
    /// The inner of two nested bodies therefore ranks higher, and where bodies overlap in part,
    /// paths from all directions find the same body. Only bodies in the same box have equal ranks,
    /// because the boxes do not show which of them is the inner one.
    pub(super) fn rank_bodies(&mut self) {
        let boxes = [&self.geometry, &self.boundaries].map(|geometry| geometry.object_bounds());
        let bodies = boxes.into_iter().flatten().filter_map(|(object, (low, high))| {
            let volume_m3 = (high - low).element_product();
            Some(RankedBody { priority: self.body_of(object)?.priority, volume_m3, object, corners: [low, high] })
        });
        let mut bodies: Vec<RankedBody> = bodies.collect();
        bodies.sort_by(|a, b| {
            let by_size = a.priority.cmp(&b.priority).then(b.volume_m3.total_cmp(&a.volume_m3));
            by_size.then(a.object.cmp(&b.object))
        });
        self.body_ranks = vec![0; self.objects.len()];
        let mut rank = 0;
        for (i, body) in bodies.iter().enumerate() {
            rank += i32::from(i > 0 && !body.has_rank_of(&bodies[i - 1]));
            self.body_ranks[body.object as usize] = rank;
        }
    }
}

/// The properties of a body that fix its rank.
struct RankedBody {
    priority: i32,
    volume_m3: f64,
    object: u32,
    corners: [DVec3; 2],
}

impl RankedBody {
    /// Returns true if both bodies have the same priority and the same bounding box.
    fn has_rank_of(&self, other: &Self) -> bool {
        /// Two corners are equal if their distance is at most this fraction of the box's diagonal.
        const ROUNDING: f64 = 1e-9;
        let limit_m = ROUNDING * self.corners[0].distance(self.corners[1]);
        let same_box = self.corners.iter().zip(&other.corners).all(|(a, b)| a.distance(*b) <= limit_m);
        self.priority == other.priority && same_box
    }
}
