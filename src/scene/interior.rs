//! Which bodies a ray is inside of, and which of them rules.
//!
//! Bodies may overlap (ice in water in a glass): at every place the body of the highest priority rules, and among
//! equals the one that was entered last, the innermost (nested dielectrics, Schmidt & Budge 2002). Bodies without a surface of their
//! own (a cloud of smoke) rule over what fills the place, but not over its refractive index.

/// How many bodies may overlap at one place; deeper nesting ignores the outermost.
pub const MAX_NESTING: usize = 8;

/// The bodies around a point, by object, outermost first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Interior {
    objects: [u32; MAX_NESTING],
    ranks: [Rank; MAX_NESTING],
    depth: usize,
}

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
    pub const AIR: Self =
        Self { objects: [0; MAX_NESTING], ranks: [Rank { priority: 0, refracts: false }; MAX_NESTING], depth: 0 };

    /// The object whose refractive index rules here; `None` is the air.
    pub fn ruler(&self) -> Option<u32> {
        self.highest(|rank| rank.refracts)
    }

    /// The object whose body fills the place, with a surface of its own or without; `None` is the air.
    pub fn filler(&self) -> Option<u32> {
        self.highest(|_| true)
    }

    fn highest(&self, counts: impl Fn(Rank) -> bool) -> Option<u32> {
        let mut best = None;
        for level in (0..self.depth).filter(|&level| counts(self.ranks[level])) {
            if best.is_none_or(|b: usize| self.ranks[level].priority >= self.ranks[b].priority) {
                best = Some(level);
            }
        }
        best.map(|level| self.objects[level])
    }

    /// The bodies after going into `object`. Going in twice counts once (coincident faces of one mesh).
    #[must_use]
    pub fn entered(mut self, object: u32, rank: Rank) -> Self {
        if self.objects[..self.depth].contains(&object) {
            return self;
        }
        if self.depth == MAX_NESTING {
            self.objects.copy_within(1.., 0);
            self.ranks.copy_within(1.., 0);
            self.depth -= 1;
        }
        self.objects[self.depth] = object;
        self.ranks[self.depth] = rank;
        self.depth += 1;
        self
    }

    /// The bodies after coming out of `object`; leaving what was never entered changes nothing.
    #[must_use]
    pub fn left(mut self, object: u32) -> Self {
        if let Some(level) = self.objects[..self.depth].iter().position(|&o| o == object) {
            self.objects.copy_within(level + 1..self.depth, level);
            self.ranks.copy_within(level + 1..self.depth, level);
            self.depth -= 1;
            // What is beyond the depth stays 0, so that equal nestings compare equal.
            self.objects[self.depth] = 0;
            self.ranks[self.depth] = Rank::default();
        }
        self
    }

    /// Whether `object` is among the bodies.
    pub fn contains(&self, object: u32) -> bool {
        self.objects[..self.depth].contains(&object)
    }

    /// Whether no body is around: the air.
    pub fn is_air(&self) -> bool {
        self.depth == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass_of(priority: i32) -> Rank {
        Rank { priority, refracts: true }
    }

    #[test]
    fn the_highest_priority_rules_and_ties_go_to_the_innermost() {
        let glass = Interior::AIR.entered(1, glass_of(0));
        assert_eq!(glass.ruler(), Some(1));
        assert_eq!(glass.entered(2, glass_of(0)).ruler(), Some(2), "ties go to the innermost");
        assert_eq!(glass.entered(3, glass_of(-1)).ruler(), Some(1), "a lower priority does not show inside");
        let ice = glass.entered(2, glass_of(0)).entered(4, glass_of(5)).entered(5, glass_of(1));
        assert_eq!(ice.ruler(), Some(4));
        assert_eq!(ice.left(4).ruler(), Some(5));
        assert_eq!(ice.left(4).left(5).left(2), glass);
        assert_eq!(glass.left(7), glass);
    }

    #[test]
    fn smoke_fills_a_place_and_leaves_its_index_alone() {
        let smoke = Rank { priority: 0, refracts: false };
        let water = Interior::AIR.entered(1, glass_of(0));
        let smoky = water.entered(2, smoke);
        assert_eq!((smoky.ruler(), smoky.filler()), (Some(1), Some(2)));
        let around = Interior::AIR.entered(2, smoke);
        assert_eq!((around.ruler(), around.filler()), (None, Some(2)));
        assert_eq!(around.entered(1, glass_of(0)).filler(), Some(1), "glass in smoke is clear");
    }

    #[test]
    fn nesting_beyond_the_limit_forgets_the_outermost() {
        let deep = (0..20).fold(Interior::AIR, |inside, object| inside.entered(object, glass_of(0)));
        assert_eq!(deep.ruler(), Some(19));
        assert!(!deep.contains(0) && deep.contains(12));
    }
}
