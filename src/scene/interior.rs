//! Which bodies of glass or liquid a ray is inside of, and which of them rules.
//!
//! Bodies may overlap (ice in water in a glass): at every place the body of the highest priority rules, and among
//! equals the one that was entered last, the innermost (nested dielectrics, Schmidt & Budge 2002).

/// How many bodies may overlap at one place; deeper nesting ignores the outermost.
pub const MAX_NESTING: usize = 8;

/// The bodies around a point, by object, outermost first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Interior {
    objects: [u32; MAX_NESTING],
    priorities: [i32; MAX_NESTING],
    depth: usize,
}

impl Interior {
    /// Outside of everything: in the air.
    pub const AIR: Self = Self { objects: [0; MAX_NESTING], priorities: [0; MAX_NESTING], depth: 0 };

    /// The object whose body rules here; `None` is the air.
    pub fn ruler(&self) -> Option<u32> {
        let mut best = None;
        for level in 0..self.depth {
            if best.is_none_or(|b: usize| self.priorities[level] >= self.priorities[b]) {
                best = Some(level);
            }
        }
        best.map(|level| self.objects[level])
    }

    /// The bodies after going into `object`. Going in twice counts once (coincident faces of one mesh).
    #[must_use]
    pub fn entered(mut self, object: u32, priority: i32) -> Self {
        if self.objects[..self.depth].contains(&object) {
            return self;
        }
        if self.depth == MAX_NESTING {
            self.objects.copy_within(1.., 0);
            self.priorities.copy_within(1.., 0);
            self.depth -= 1;
        }
        self.objects[self.depth] = object;
        self.priorities[self.depth] = priority;
        self.depth += 1;
        self
    }

    /// The bodies after coming out of `object`; leaving what was never entered changes nothing.
    #[must_use]
    pub fn left(mut self, object: u32) -> Self {
        if let Some(level) = self.objects[..self.depth].iter().position(|&o| o == object) {
            self.objects.copy_within(level + 1..self.depth, level);
            self.priorities.copy_within(level + 1..self.depth, level);
            self.depth -= 1;
            // What is beyond the depth stays 0, so that equal nestings compare equal.
            self.objects[self.depth] = 0;
            self.priorities[self.depth] = 0;
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

    #[test]
    fn the_highest_priority_rules_and_ties_go_to_the_innermost() {
        let glass = Interior::AIR.entered(1, 0);
        assert_eq!(glass.ruler(), Some(1));
        assert_eq!(glass.entered(2, 0).ruler(), Some(2), "ties go to the innermost");
        assert_eq!(glass.entered(3, -1).ruler(), Some(1), "a lower priority does not show inside");
        let ice = glass.entered(2, 0).entered(4, 5).entered(5, 1);
        assert_eq!(ice.ruler(), Some(4));
        assert_eq!(ice.left(4).ruler(), Some(5));
        assert_eq!(ice.left(4).left(5).left(2), glass);
        assert_eq!(glass.left(7), glass);
    }

    #[test]
    fn nesting_beyond_the_limit_forgets_the_outermost() {
        let deep = (0..20).fold(Interior::AIR, |inside, object| inside.entered(object, 0));
        assert_eq!(deep.ruler(), Some(19));
        assert!(!deep.contains(0) && deep.contains(12));
    }
}
