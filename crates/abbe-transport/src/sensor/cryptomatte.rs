//! Cryptomatte: the fraction of each pixel that each named object covers (Friedman & Jones 2015,
//! "Fully Automatic ID Mattes with Support for Motion Blur and Transparency"; specification 1.2.0).
//! The hash of a name is written as a floating-point number with the same bits.

use abbe_spectra::math::sum::ExactSum;

/// Returns the hash of a name: MurmurHash3_x86_32 (A. Appleby) with the seed 0.
pub fn hash_name(name: &str) -> u32 {
    let mix = |block: u32| block.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let bytes = name.as_bytes();
    let mut hash = 0_u32;
    let blocks = bytes.chunks_exact(4);
    let rest = blocks.remainder();
    for block in blocks {
        let block = u32::from_le_bytes([block[0], block[1], block[2], block[3]]);
        hash = (hash ^ mix(block)).rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    if !rest.is_empty() {
        hash ^= mix(rest.iter().rev().fold(0, |block, &byte| block << 8 | u32::from(byte)));
    }
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

/// Makes the floating-point number normal: if its exponent has only zeros or only ones, one bit of
/// it is flipped, as the specification requires.
pub fn normal_hash(hash: u32) -> u32 {
    match hash >> 23 & 0xff {
        0 | 0xff => hash ^ 1 << 23,
        _ => hash,
    }
}

/// The hash of each name in a pixel and the number of its samples, ordered by hash.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct NameCounts(Vec<(u32, u32)>);

impl NameCounts {
    /// Counts `samples` samples that hit the name with this hash.
    pub(super) fn add(&mut self, hash: u32, samples: u32) {
        match self.0.binary_search_by_key(&hash, |&(known, _)| known) {
            Ok(place) => self.0[place].1 = self.0[place].1.saturating_add(samples),
            Err(place) => self.0.insert(place, (hash, samples)),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns an entry for a saved run, or 0: the hash in the lower word, the samples in the next.
    pub(super) fn to_sum(&self, place: usize) -> ExactSum {
        let bits = self.0.get(place).map_or(0, |&(hash, samples)| i128::from(samples) << 32 | i128::from(hash));
        ExactSum::from_bits(bits)
    }

    pub(super) fn add_sum(&mut self, sum: ExactSum) {
        let (hash, samples) = (sum.bits() as u32, (sum.bits() >> 32) as u32);
        if samples > 0 {
            self.add(hash, samples);
        }
    }

    /// Returns the hashes and their numbers of samples, the largest number first.
    pub(super) fn ranked(&self) -> Vec<(u32, u32)> {
        let mut ranked = self.0.clone();
        ranked.sort_by_key(|&(hash, samples)| (std::cmp::Reverse(samples), hash));
        ranked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of MurmurHash3_x86_32 with the seed 0, and the hash of the name "hello".
    #[test]
    fn hashes_have_their_published_values() {
        for (name, hash) in [
            ("", 0),
            ("a", 0x3c25_69b2),
            ("test", 0xba6b_d213),
            ("hello", 0x248b_fa47),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(hash_name(name), hash, "{name}");
        }
    }

    #[test]
    fn converted_hashes_are_normal_numbers() {
        for hash in [0, 0x007f_ffff, 0x7f80_0000, 0xffff_ffff, 0x3c25_69b2] {
            assert!(f32::from_bits(normal_hash(hash)).is_normal(), "{hash:x}");
        }
        assert_eq!(normal_hash(0x3c25_69b2), 0x3c25_69b2);
    }

    #[test]
    fn counts_do_not_depend_on_their_order() {
        let (mut forward, mut backward, mut saved) =
            (NameCounts::default(), NameCounts::default(), NameCounts::default());
        let entries = [(7, 1), (3, 2), (7, 4), (0xffff_ffff, 1)];
        entries.iter().for_each(|&(hash, samples)| forward.add(hash, samples));
        entries.iter().rev().for_each(|&(hash, samples)| backward.add(hash, samples));
        (0..forward.len()).for_each(|place| saved.add_sum(forward.to_sum(place)));
        assert_eq!((&forward, &forward), (&backward, &saved));
        assert_eq!(forward.ranked(), [(7, 5), (3, 2), (0xffff_ffff, 1)]);
    }
}
