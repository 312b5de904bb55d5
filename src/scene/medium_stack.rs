//! The medium stack: the bodies that contain a point of a path. One of these bodies dominates.
//!
//! Bodies may overlap (ice in water in a glass). At every point, the body of the highest priority
//! dominates. If priorities are equal, the body that the path entered last dominates (nested
//! dielectrics, Schmidt & Budge 2002). A body without a surface (a cloud of smoke) determines the
//! medium at a point, but not the refractive index.

/// The largest number of bodies that may overlap at a point. If more bodies overlap, the stack
/// drops the outermost body.
pub const MAX_NESTING: usize = 8;

/// The bodies that contain a point, from the outermost to the innermost.
///
/// Each entry is an object number plus 1. Unused entries at the end are 0. A stack is stored for
/// every segment of every path, so the stack must be small. It does not contain the priorities,
/// because the bodies store them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MediumStack([u32; MAX_NESTING]);

/// The properties of a body that decide whether it dominates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BodyPriority {
    /// Of two bodies, the body with the higher priority dominates.
    pub priority: i32,
    /// True if the body has its own refractive index.
    pub refracts: bool,
}

impl MediumStack {
    /// The empty stack: the point is in air.
    pub const AIR: Self = Self([0; MAX_NESTING]);

    /// The object that determines the refractive index at the point. `None` for air. The function
    /// `priority` returns the priority of an object's body.
    pub fn dominant_dielectric(&self, priority: impl Fn(u32) -> BodyPriority) -> Option<u32> {
        self.highest(priority, |body| body.refracts)
    }

    /// The object whose body determines the medium at the point. The body need not have a surface.
    /// `None` for air. The function `priority` returns the priority of an object's body.
    pub fn dominant_body(&self, priority: impl Fn(u32) -> BodyPriority) -> Option<u32> {
        self.highest(priority, |_| true)
    }

    fn highest(&self, priority: impl Fn(u32) -> BodyPriority, counts: impl Fn(BodyPriority) -> bool) -> Option<u32> {
        let ranked = self.bodies().map(|object| (priority(object), object)).filter(|&(body, _)| counts(body));
        // `max_by_key` returns the last of equal elements, which is the innermost body.
        ranked.max_by_key(|(body, _)| body.priority).map(|(_, object)| object)
    }

    fn bodies(&self) -> impl Iterator<Item = u32> {
        self.0.iter().take_while(|&&entry| entry > 0).map(|entry| entry - 1)
    }

    /// The stack after a path enters `object`. If the stack already contains `object`, the stack is
    /// unchanged. This case occurs if a mesh has coincident faces.
    #[must_use]
    pub fn entered(mut self, object: u32) -> Self {
        if self.contains(object) {
            return self;
        }
        let depth = self.bodies().count();
        if depth == MAX_NESTING {
            self.0.copy_within(1.., 0);
        }
        self.0[depth.min(MAX_NESTING - 1)] = object + 1;
        self
    }

    /// The stack after a path leaves `object`. If the stack does not contain `object`, the stack is
    /// unchanged.
    #[must_use]
    pub fn left(mut self, object: u32) -> Self {
        let level = self.bodies().position(|body| body == object);
        if let Some(level) = level {
            self.0.copy_within(level + 1.., level);
            self.0[MAX_NESTING - 1] = 0;
        }
        self
    }

    /// Returns true if the stack contains `object`.
    pub fn contains(&self, object: u32) -> bool {
        self.bodies().any(|body| body == object)
    }

    /// Returns true if the stack is empty.
    #[inline]
    pub fn is_air(&self) -> bool {
        self.0[0] == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a function that maps each object number to a refracting body. `priorities` contains
    /// the priority of each object, in the order of the object numbers.
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

    #[test]
    fn nesting_beyond_the_limit_forgets_the_outermost() {
        let deep = (0..20).fold(MediumStack::AIR, MediumStack::entered);
        assert_eq!(deep.dominant_dielectric(glass(&[0; 20])), Some(19));
        assert!(!deep.contains(0) && deep.contains(12));
    }
}
