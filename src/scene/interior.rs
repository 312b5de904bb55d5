//! Which bodies a ray is inside of, and which of them rules.
//!
//! Bodies may overlap (ice in water in a glass): at every place the body of the highest priority rules, and among
//! equals the one that was entered last, the innermost (nested dielectrics, Schmidt & Budge 2002). Bodies without a surface of their
//! own (a cloud of smoke) rule over what fills the place, but not over its refractive index.

/// How many bodies may overlap at one place; deeper nesting ignores the outermost.
pub const MAX_NESTING: usize = 8;

/// The bodies around a point, outermost first: their objects' numbers plus 1, then zeros. Every leg of every path carries one, so it is
/// kept small; what decides among the bodies stays with them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Interior([u32; MAX_NESTING]);

/// What decides whether a body rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rank {
    /// The higher rules.
    pub priority: i32,
    /// Whether it has a refractive index.
    pub refracts: bool,
}

impl Interior {
    /// Outside of everything: in the air.
    pub const AIR: Self = Self([0; MAX_NESTING]);

    /// The object whose refractive index rules here, where bodies rank so; `None` is the air.
    pub fn ruler(&self, rank: impl Fn(u32) -> Rank) -> Option<u32> {
        self.highest(rank, |rank| rank.refracts)
    }

    /// The object whose body fills the place, with a surface of its own or without, where bodies rank so; `None` is the air.
    pub fn filler(&self, rank: impl Fn(u32) -> Rank) -> Option<u32> {
        self.highest(rank, |_| true)
    }

    fn highest(&self, rank: impl Fn(u32) -> Rank, counts: impl Fn(Rank) -> bool) -> Option<u32> {
        let ranked = self.bodies().map(|object| (rank(object), object)).filter(|&(rank, _)| counts(rank));
        // The last of equals is the innermost.
        ranked.max_by_key(|(rank, _)| rank.priority).map(|(_, object)| object)
    }

    fn bodies(&self) -> impl Iterator<Item = u32> {
        self.0.iter().take_while(|&&entry| entry > 0).map(|entry| entry - 1)
    }

    /// The bodies after going into `object`. Going in twice counts once (coincident faces of one mesh).
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

    /// The bodies after coming out of `object`; leaving what was never entered changes nothing.
    #[must_use]
    pub fn left(mut self, object: u32) -> Self {
        let level = self.bodies().position(|body| body == object);
        if let Some(level) = level {
            self.0.copy_within(level + 1.., level);
            self.0[MAX_NESTING - 1] = 0;
        }
        self
    }

    /// Whether `object` is among the bodies.
    pub fn contains(&self, object: u32) -> bool {
        self.bodies().any(|body| body == object)
    }

    /// Whether no body is around: the air.
    #[inline]
    pub fn is_air(&self) -> bool {
        self.0[0] == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Glass whose bodies have these priorities.
    fn glass(priorities: &[i32]) -> impl Fn(u32) -> Rank {
        |object| Rank { priority: priorities[object as usize], refracts: true }
    }

    #[test]
    fn the_highest_priority_rules_and_ties_go_to_the_innermost() {
        let ruler = |interior: Interior| interior.ruler(glass(&[0, 0, 0, -1, 5, 1]));
        let within = Interior::AIR.entered(1);
        assert_eq!(ruler(within), Some(1));
        assert_eq!(ruler(within.entered(2)), Some(2), "ties go to the innermost");
        assert_eq!(ruler(within.entered(3)), Some(1), "a lower priority does not show inside");
        let ice = within.entered(2).entered(4).entered(5);
        assert_eq!(ruler(ice), Some(4));
        assert_eq!(ruler(ice.left(4)), Some(5));
        assert_eq!(ice.left(4).left(5).left(2), within);
        assert_eq!(within.left(7), within);
    }

    #[test]
    fn smoke_fills_a_place_and_leaves_its_index_alone() {
        let rank = |object| Rank { priority: 0, refracts: object == WATER };
        const WATER: u32 = 1;
        const SMOKE: u32 = 2;
        let smoky = Interior::AIR.entered(WATER).entered(SMOKE);
        assert_eq!((smoky.ruler(rank), smoky.filler(rank)), (Some(WATER), Some(SMOKE)));
        let around = Interior::AIR.entered(SMOKE);
        assert_eq!((around.ruler(rank), around.filler(rank)), (None, Some(SMOKE)));
        assert_eq!(around.entered(WATER).filler(rank), Some(WATER), "water in smoke is clear");
    }

    #[test]
    fn nesting_beyond_the_limit_forgets_the_outermost() {
        let deep = (0..20).fold(Interior::AIR, Interior::entered);
        assert_eq!(deep.ruler(glass(&[0; 20])), Some(19));
        assert!(!deep.contains(0) && deep.contains(12));
    }
}
