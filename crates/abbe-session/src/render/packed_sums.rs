//! Exact sums in few bytes. Most of the 128 bits of a sum are copies of its sign, or zeros below the
//! precision of its terms.
//!
//! A sum is a head and the bytes that follow from it. The lower 5 bits of the head are the number
//! of significant bytes, and its upper 3 bits the number of zero bytes below them. The other bytes
//! repeat the sign. The head 0 and a number of 16 bits are as many sums that are 0.

use abbe_spectra::math::sum::ExactSum;

const SUM_BYTES: usize = size_of::<i128>();

/// The largest number of zero bytes that a head can state.
const MOST_ZEROS: usize = 7;

/// Appends the sums of a plane.
pub(super) fn pack(sums: impl Iterator<Item = ExactSum>, bytes: &mut Vec<u8>) {
    let mut blanks = 0_u16;
    let end_blanks = |blanks: &mut u16, bytes: &mut Vec<u8>| {
        if *blanks > 0 {
            bytes.push(0);
            bytes.extend(blanks.to_le_bytes());
            *blanks = 0;
        }
    };
    for sum in sums {
        let bits = sum.bits();
        if bits == 0 {
            blanks += 1;
            if blanks == u16::MAX {
                end_blanks(&mut blanks, bytes);
            }
            continue;
        }
        end_blanks(&mut blanks, bytes);
        let zeros = (bits.trailing_zeros() as usize / 8).min(MOST_ZEROS);
        let rest = bits >> (8 * zeros);
        let equal_to_sign = if rest < 0 { rest.leading_ones() } else { rest.leading_zeros() };
        // One bit of the sign stays.
        let count = (128 - equal_to_sign as usize) / 8 + 1;
        bytes.push((zeros << 5 | count) as u8);
        bytes.extend(&rest.to_le_bytes()[..count]);
    }
    end_blanks(&mut blanks, bytes);
}

/// Returns the sums of a plane, or `None` if the bytes are not those of `count` sums.
pub(super) fn unpack(mut bytes: &[u8], count: usize) -> Option<Vec<ExactSum>> {
    let mut sums = Vec::with_capacity(count);
    while let Some((&head, rest)) = bytes.split_first() {
        if head == 0 {
            let (blanks, rest) = rest.split_first_chunk()?;
            let length = sums.len() + usize::from(u16::from_le_bytes(*blanks));
            if length > count {
                return None;
            }
            sums.resize(length, ExactSum::default());
            bytes = rest;
            continue;
        }
        let (zeros, significant) = (usize::from(head >> 5), usize::from(head & 31));
        let (own, rest) = rest.split_at_checked(significant)?;
        if significant == 0 || zeros + significant > SUM_BYTES || sums.len() == count {
            return None;
        }
        let mut word = [if own[significant - 1] >= 128 { 255 } else { 0 }; SUM_BYTES];
        word[..significant].copy_from_slice(own);
        sums.push(ExactSum::from_bits(i128::from_le_bytes(word) << (8 * zeros)));
        bytes = rest;
    }
    (sums.len() == count).then_some(sums)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(bits: &[i128]) -> Vec<u8> {
        let mut bytes = Vec::new();
        pack(bits.iter().map(|&bits| ExactSum::from_bits(bits)), &mut bytes);
        bytes
    }

    #[test]
    fn sums_return_from_their_bytes() {
        let mut bits = vec![0, 0, 1, -1, 127, 128, -128, -129, 255, 256, -256, 0, i128::MAX, i128::MIN, i128::MAX - 1];
        bits.extend((0..128).flat_map(|place| [1 << place, -1 << place, 3 << place, (1 << place) - 1, -5 << place]));
        bits.extend(std::iter::repeat_n(0, 70_000));
        let sums: Vec<i128> = unpack(&packed(&bits), bits.len()).unwrap().iter().map(|sum| sum.bits()).collect();
        assert_eq!(sums, bits);
    }

    #[test]
    fn few_digits_need_few_bytes() {
        assert_eq!(packed(&[0; 1000]).len(), 3);
        assert_eq!(packed(&[0x1234 << 40]).len(), 1 + 2);
        assert_eq!(packed(&[-(0x1234 << 40)]).len(), 1 + 2);
    }

    #[test]
    fn wrong_bytes_are_refused() {
        let bytes = packed(&[7, 0, 0, 1 << 100]);
        for (wrong, count) in [(&bytes[1..], 4), (&bytes[..3], 4), (&bytes, 3), (&bytes, 5), (&[0], 1), (&[0xff], 1)] {
            assert!(unpack(wrong, count).is_none(), "{wrong:?} {count}");
        }
    }
}
