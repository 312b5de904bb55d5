//! Which passes of a picture a render is to do.

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The passes whose index leaves the remainder `index` when divided by `of`; part 0 of 1 is the whole picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    index: u32,
    of: u32,
}

impl Part {
    /// All passes.
    pub const WHOLE: Self = Self { index: 0, of: 1 };

    /// Part `index` (from 0) of as many as `of`.
    ///
    /// # Errors
    /// The input's: no such part.
    pub fn new(index: u32, of: u32) -> Result<Self> {
        if index < of {
            return Ok(Self { index, of });
        }
        let error = Error::input(format!("there is no part {index}/{of}"));
        Err(match of {
            0 => error.expected("at least one part, such as 0/1"),
            1.. => error.expected(format!("0/{of} to {}/{of}: parts count from 0", of - 1)),
        })
    }

    /// The index of this part's pass number `nth`, both from 0.
    pub fn pass(self, nth: u64) -> u64 {
        u64::from(self.index).saturating_add(nth.saturating_mul(u64::from(self.of)))
    }

    /// How many of a picture's first `passes` are this part's.
    pub fn count_of(self, passes: u64) -> u64 {
        passes.saturating_sub(u64::from(self.index)).div_ceil(u64::from(self.of))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_share_the_passes_of_a_picture() {
        for (of, passes) in [(1, 5), (3, 0), (3, 7), (4, 64), (5, 2)] {
            let parts = (0..of).map(|index| Part::new(index, of).unwrap());
            let mut all: Vec<u64> =
                parts.flat_map(|part| (0..part.count_of(passes)).map(move |nth| part.pass(nth))).collect();
            all.sort_unstable();
            assert_eq!(all, (0..passes).collect::<Vec<_>>(), "{of} parts of {passes} passes");
        }
    }

    #[test]
    fn parts_that_do_not_exist_are_refused_with_those_that_do() {
        let said = |index, of| Part::new(index, of).unwrap_err().to_string();
        assert_eq!(said(3, 2), "there is no part 3/2; expected 0/2 to 1/2: parts count from 0");
        assert!(said(0, 0).contains("at least one"));
    }
}
