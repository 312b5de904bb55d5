//! Parts: the division of a picture's passes among several renders.

use abbe_spectra::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt;

/// All passes whose index is congruent to `index` modulo `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PassPart {
    index: u32,
    of: u32,
}

impl PassPart {
    pub const WHOLE: Self = Self { index: 0, of: 1 };

    /// Counts the part from 0. Returns an input error if `index` is not less than `of`.
    pub fn new(index: u32, of: u32) -> Result<Self> {
        if index < of {
            return Ok(Self { index, of });
        }
        let error = Error::input(format!("there is no part {index}/{of}"));
        Err(match of {
            0 => error.expected("at least one part, such as 0/1"),
            1.. => error.expected(format!("0/{of} to {}/{of}, since parts count from 0", of - 1)),
        })
    }

    /// Returns the index of the `nth` pass of this part. Both numbers count from 0.
    pub fn pass(self, nth: u64) -> u64 {
        u64::from(self.index).saturating_add(nth.saturating_mul(u64::from(self.of)))
    }

    /// Returns the position of pass number `pass` of the picture within this part, from 0.
    pub fn nth(self, pass: u64) -> Option<u64> {
        let of = u64::from(self.of);
        (pass.checked_rem(of)? == u64::from(self.index)).then(|| pass / of)
    }

    /// Returns the first pass contained in both parts, or `None` if the parts share no pass.
    pub fn shared_with(self, other: Self) -> Option<u64> {
        let [(i, n), (j, m)] = [self, other].map(|part| (i64::from(part.index), i64::from(part.of)));
        // The first shared pass is i + kn = j + lm. With g = gcd(n, m), k is (j − i)/g times the
        // inverse of n/g, modulo m/g (Bézout).
        let (g, inverse) = bezout(n, m)?;
        if (j - i) % g != 0 {
            return None;
        }
        let k = (i128::from((j - i) / g) * i128::from(inverse)).rem_euclid(i128::from(m / g));
        u64::try_from(i128::from(i) + k * i128::from(n)).ok()
    }

    /// Counts the passes of this part among the first `passes` passes of the picture.
    pub fn count_of(self, passes: u64) -> u64 {
        passes.saturating_sub(u64::from(self.index)).div_ceil(u64::from(self.of))
    }
}

/// Returns the greatest common divisor g of two positive numbers, and x with nx ≡ g modulo m.
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

impl fmt::Display for PassPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_divide_the_passes_of_a_picture() {
        for (of, passes) in [(1, 5), (3, 0), (3, 7), (4, 64), (5, 2)] {
            let parts = (0..of).map(|index| PassPart::new(index, of).unwrap());
            let mut all: Vec<u64> =
                parts.flat_map(|part| (0..part.count_of(passes)).map(move |nth| part.pass(nth))).collect();
            all.sort_unstable();
            assert_eq!(all, (0..passes).collect::<Vec<_>>(), "{of} parts of {passes} passes");
        }
    }

    #[test]
    fn the_first_shared_pass_is_found() {
        for (i, n, j, m) in [(0, 2, 1, 2), (1, 2, 1, 4), (3, 4, 1, 6), (2, 7, 4, 5), (0, 1, 6, 9), (2, 4, 3, 6)] {
            let (one, other) = (PassPart::new(i, n).unwrap(), PassPart::new(j, m).unwrap());
            let counted = (0..200).find(|&pass| one.nth(pass).is_some() && other.nth(pass).is_some());
            assert_eq!((one.shared_with(other), other.shared_with(one)), (counted, counted), "{one} and {other}");
        }
        let (large, larger) = (PassPart { index: u32::MAX - 2, of: u32::MAX }, PassPart { index: 5, of: u32::MAX - 1 });
        let pass = large.shared_with(larger).unwrap();
        assert!(large.nth(pass).is_some() && larger.nth(pass).is_some());
        assert_eq!(PassPart { index: 0, of: 0 }.shared_with(large), None, "a record may contain any numbers");
    }

    #[test]
    fn missing_parts_are_refused() {
        let message = |index, of| PassPart::new(index, of).unwrap_err().to_string();
        assert_eq!(message(3, 2), "there is no part 3/2; expected 0/2 to 1/2, since parts count from 0");
        assert!(message(0, 0).contains("at least one"));
    }
}
