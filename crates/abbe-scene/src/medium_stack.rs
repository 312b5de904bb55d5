//! The medium stack: the bodies that contain a point of a path.
//!
//! Bodies may overlap (ice in water in a glass). At every point, the body of the highest priority
//! dominates, and of equal ones the body that the path entered last (nested dielectrics, Schmidt &
//! Budge 2002). A body without a surface (a cloud of smoke) determines the medium, but not the
//! refractive index.

/// The largest number of bodies in a stack. If more bodies overlap at a point, the stack is full
/// and lacks those that matter least. When a path leaves a body with a full stack,
/// [`Scene::across`](super::Scene::across) finds the bodies anew from the geometry.
pub const MAX_NESTING: usize = 8;

/// The bodies that contain a point, from the outermost to the innermost: object numbers plus 1, and
/// unused entries of 0 at the end. A crystal's entry also tells which of its two waves the path is.
///
/// Every segment of every path stores a stack, so it is small and leaves the priorities to the
/// bodies. Any number of bodies may overlap: a full stack always contains the dominant body and the
/// dominant dielectric.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MediumStack([u32; MAX_NESTING]);

/// Marks the entry of a crystal in which the path is the extraordinary wave.
const EXTRAORDINARY: u32 = 1 << 31;

/// The properties of a body that decide whether it dominates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BodyPriority {
    pub priority: i32,
    pub refracts: bool,
}

impl MediumStack {
    pub const AIR: Self = Self([0; MAX_NESTING]);

    /// The object that determines the refractive index at the point, or `None` for air, by the
    /// priorities of the objects' bodies.
    pub fn dominant_dielectric(&self, priority: impl Fn(u32) -> BodyPriority) -> Option<u32> {
        self.highest(priority, |body| body.refracts)
    }

    /// The object, with or without a surface, whose body determines the medium at the point, or
    /// `None` for air.
    pub fn dominant_body(&self, priority: impl Fn(u32) -> BodyPriority) -> Option<u32> {
        self.highest(priority, |_| true)
    }

    fn highest(&self, priority: impl Fn(u32) -> BodyPriority, counts: impl Fn(BodyPriority) -> bool) -> Option<u32> {
        highest_of(self.bodies(), priority, counts)
    }

    /// The objects, from the outermost to the innermost.
    pub fn bodies(&self) -> impl Iterator<Item = u32> {
        self.0.iter().take_while(|&&entry| entry > 0).map(|entry| (entry & !EXTRAORDINARY) - 1)
    }

    /// Marks the path as the extraordinary wave in a crystal, or as the ordinary one.
    #[must_use]
    pub fn with_wave(mut self, crystal: u32, is_extraordinary: bool) -> Self {
        if let Some(level) = self.level(crystal) {
            self.0[level] = if is_extraordinary { (crystal + 1) | EXTRAORDINARY } else { crystal + 1 };
        }
        self
    }

    /// Returns true if the path is the extraordinary wave in a crystal.
    pub fn is_extraordinary(&self, crystal: u32) -> bool {
        self.level(crystal).is_some_and(|level| self.0[level] & EXTRAORDINARY != 0)
    }

    /// Returns the last entry of an object.
    fn level(&self, object: u32) -> Option<usize> {
        self.0.iter().rposition(|&entry| entry & !EXTRAORDINARY == object + 1)
    }

    /// The stack after a path enters `object`. A stack that already contains it, as for a mesh with
    /// coincident faces, does not change. The stack must not be full.
    #[must_use]
    pub fn entered(self, object: u32) -> Self {
        if self.contains(object) { self } else { self.entered_again(object) }
    }

    /// The stack after a path enters a shell of `object`, whose shells may overlap: the stack
    /// contains the object once for each of them. The stack must not be full.
    #[must_use]
    pub fn entered_again(mut self, object: u32) -> Self {
        let depth = self.bodies().count();
        debug_assert!(depth < MAX_NESTING, "`entered_full` must be called for a full stack");
        self.0[depth.min(MAX_NESTING - 1)] = object + 1;
        self
    }

    /// Does the same as [`Self::entered`] for a full stack. Drops the body of the lowest priority,
    /// and the outermost of equal ones, that is neither the dominant body nor the dominant
    /// dielectric. The waves in crystals become ordinary.
    #[must_use]
    #[cold]
    pub fn entered_full(self, object: u32, priority: impl Fn(u32) -> BodyPriority) -> Self {
        if self.contains(object) {
            return self;
        }
        let all = || self.bodies().chain([object]);
        let dominant = [highest_of(all(), &priority, |_| true), highest_of(all(), &priority, |body| body.refracts)];
        let spare = all().filter(|body| !dominant.contains(&Some(*body)));
        let dropped = spare.min_by_key(|&body| priority(body).priority);
        let mut stack = Self::AIR;
        let kept = all().filter(|body| Some(*body) != dropped);
        stack.0.iter_mut().zip(kept).for_each(|(entry, body)| *entry = body + 1);
        stack
    }

    /// The stack after a path leaves `object`, or one of its shells. A stack without this body does
    /// not change.
    #[must_use]
    pub fn left(mut self, object: u32) -> Self {
        if let Some(level) = self.level(object) {
            self.0.copy_within(level + 1.., level);
            self.0[MAX_NESTING - 1] = 0;
        }
        self
    }

    /// Returns true if bodies that the stack lacks may also contain the point.
    #[inline]
    pub fn is_full(&self) -> bool {
        self.0[MAX_NESTING - 1] != 0
    }

    pub fn contains(&self, object: u32) -> bool {
        self.bodies().any(|body| body == object)
    }

    #[inline]
    pub fn is_air(&self) -> bool {
        self.0[0] == 0
    }
}

/// Returns the body of the highest priority among those that count, and the innermost of equal
/// ones. The order of `bodies` is from the outermost to the innermost.
fn highest_of(
    bodies: impl Iterator<Item = u32>,
    priority: impl Fn(u32) -> BodyPriority,
    counts: impl Fn(BodyPriority) -> bool,
) -> Option<u32> {
    let ranked = bodies.map(|object| (priority(object), object)).filter(|&(body, _)| counts(body));
    // `max_by_key` returns the last of equal elements, which is the innermost body.
    ranked.max_by_key(|(body, _)| body.priority).map(|(_, object)| object)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Maps each object number to a refracting body with the priority in the list.
    fn glass(priorities: &[i32]) -> impl Fn(u32) -> BodyPriority {
        |object| BodyPriority { priority: priorities[object as usize], refracts: true }
    }

    #[test]
    fn the_highest_priority_and_then_the_innermost_dominates() {
        let dominant_dielectric =
            |medium_stack: MediumStack| medium_stack.dominant_dielectric(glass(&[0, 0, 0, -1, 5, 1]));
        let within = MediumStack::AIR.entered(1);
        assert_eq!(dominant_dielectric(within), Some(1));
        assert_eq!(dominant_dielectric(within.entered(2)), Some(2), "ties go to the innermost");
        assert_eq!(dominant_dielectric(within.entered(3)), Some(1), "a lower priority has no effect inside");
        let ice = within.entered(2).entered(4).entered(5);
        assert_eq!(dominant_dielectric(ice), Some(4));
        assert_eq!(dominant_dielectric(ice.left(4)), Some(5));
        assert_eq!(ice.left(4).left(5).left(2), within);
        assert_eq!(within.left(7), within);
    }

    #[test]
    fn a_path_leaves_overlapping_shells_one_by_one() {
        let twice = MediumStack::AIR.entered_again(3).entered(1).entered_again(3);
        assert_eq!(twice.left(3), MediumStack::AIR.entered(3).entered(1));
        assert_eq!(twice.left(3).left(3).left(1), MediumStack::AIR);
    }

    #[test]
    fn smoke_does_not_change_the_refractive_index() {
        let rank = |object| BodyPriority { priority: 0, refracts: object == WATER };
        const WATER: u32 = 1;
        const SMOKE: u32 = 2;
        let smoky = MediumStack::AIR.entered(WATER).entered(SMOKE);
        assert_eq!((smoky.dominant_dielectric(rank), smoky.dominant_body(rank)), (Some(WATER), Some(SMOKE)));
        let around = MediumStack::AIR.entered(SMOKE);
        assert_eq!((around.dominant_dielectric(rank), around.dominant_body(rank)), (None, Some(SMOKE)));
        assert_eq!(around.entered(WATER).dominant_body(rank), Some(WATER), "water in smoke is clear");
    }

    /// Enters bodies in the order of their numbers.
    fn nested(count: u32, priority: impl Fn(u32) -> BodyPriority) -> MediumStack {
        (0..count).fold(MediumStack::AIR, |stack, body| {
            if stack.is_full() { stack.entered_full(body, &priority) } else { stack.entered(body) }
        })
    }

    #[test]
    fn a_full_stack_keeps_the_innermost_of_equal_bodies() {
        let deep = nested(20, glass(&[0; 20]));
        assert_eq!(deep.dominant_dielectric(glass(&[0; 20])), Some(19));
        assert!(deep.is_full() && !deep.contains(0) && (12..20).all(|body| deep.contains(body)));
        assert_eq!(deep.entered_full(15, glass(&[0; 20])), deep);
    }

    #[test]
    fn a_full_stack_keeps_its_dominant_bodies() {
        // Body 0 dominates the refraction, and body 1 (smoke without a surface) dominates the
        // medium.
        let rank = |object| match object {
            0 => BodyPriority { priority: 5, refracts: true },
            1 => BodyPriority { priority: 9, refracts: false },
            other => BodyPriority { priority: other as i32 % 3, refracts: other % 2 == 0 },
        };
        let deep = nested(30, rank);
        assert_eq!((deep.dominant_dielectric(rank), deep.dominant_body(rank)), (Some(0), Some(1)));
        let low = deep.entered_full(40, |object| {
            if object == 40 { BodyPriority { priority: -1, refracts: true } } else { rank(object) }
        });
        assert_eq!(low, deep, "a body of the lowest priority is dropped at once");
    }
}
