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

    /// Which of this part's passes, from 0, the picture's pass of this index is; `None` where it is another part's.
    pub fn nth(self, pass: u64) -> Option<u64> {
        let of = u64::from(self.of);
        (pass.checked_rem(of)? == u64::from(self.index)).then(|| pass / of)
    }

    /// The first pass that belongs to another part too; `None` if none does.
    pub fn shared_with(self, other: Self) -> Option<u64> {
        let [(i, n), (j, m)] = [self, other].map(|part| (i64::from(part.index), i64::from(part.of)));
        // i + kn = j + lm: k is the inverse of n/g modulo m/g, times (j − i)/g (Bézout).
        let (g, inverse) = bezout(n, m)?;
        if (j - i) % g != 0 {
            return None;
        }
        let k = (i128::from((j - i) / g) * i128::from(inverse)).rem_euclid(i128::from(m / g));
        u64::try_from(i128::from(i) + k * i128::from(n)).ok()
    }

    /// How many of a picture's first `passes` are this part's.
    pub fn count_of(self, passes: u64) -> u64 {
        passes.saturating_sub(u64::from(self.index)).div_ceil(u64::from(self.of))
    }
}

/// The greatest common divisor g of two positive numbers, and a number x with nx ≡ g modulo m; `None` where one is 0.
fn bezout(n: i64, m: i64) -> Option<(i64, i64)> {
    if n == 0 || m == 0 {
        return None;
    }
    let ((mut a, mut x), (mut b, mut y)) = ((n, 1), (m, 0));
    while b != 0 {
        let quotient = a / b;
        ((a, x), (b, y)) = ((b, y), (a - quotient * b, x - quotient * y));
    }
    Some((a, x))
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
    fn a_pass_of_two_parts_is_found_without_counting() {
        for (i, n, j, m) in [(0, 2, 1, 2), (1, 2, 1, 4), (3, 4, 1, 6), (2, 7, 4, 5), (0, 1, 6, 9), (2, 4, 3, 6)] {
            let (one, other) = (Part::new(i, n).unwrap(), Part::new(j, m).unwrap());
            let counted = (0..200).find(|&pass| one.nth(pass).is_some() && other.nth(pass).is_some());
            assert_eq!((one.shared_with(other), other.shared_with(one)), (counted, counted), "{one} and {other}");
        }
        let (large, larger) = (Part { index: u32::MAX - 2, of: u32::MAX }, Part { index: 5, of: u32::MAX - 1 });
        let pass = large.shared_with(larger).unwrap();
        assert!(large.nth(pass).is_some() && larger.nth(pass).is_some());
        assert_eq!(Part { index: 0, of: 0 }.shared_with(large), None, "a record may claim anything");
    }

    #[test]
    fn parts_that_do_not_exist_are_refused_with_those_that_do() {
        let said = |index, of| Part::new(index, of).unwrap_err().to_string();
        assert_eq!(said(3, 2), "there is no part 3/2; expected 0/2 to 1/2: parts count from 0");
        assert!(said(0, 0).contains("at least one"));
    }
}
