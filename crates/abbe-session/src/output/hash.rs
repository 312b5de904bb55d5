//! The hash that identifies scenes, saved runs and study steps.

/// BLAKE3: the same for the same data on every machine and in every version of the program.
#[derive(Debug, Clone, Default)]
pub struct IdentityHash(blake3::Hasher);

impl IdentityHash {
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Adds a part together with its length. The length separates the part from the next part.
    pub fn add_part(&mut self, bytes: &[u8]) {
        self.add(&(bytes.len() as u64).to_le_bytes());
        self.add(bytes);
    }

    /// Returns the hash as 64 hexadecimal digits.
    pub fn hex(&self) -> String {
        self.0.finalize().to_hex().to_string()
    }
}

/// The sum of the hashes of all rows of all planes of a film, in any order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SumsHash(u128);

impl SumsHash {
    pub fn add_row(&mut self, plane: &str, row: usize, words: &[u8]) {
        let mut hash = IdentityHash::default();
        hash.add_part(plane.as_bytes());
        hash.add(&(row as u64).to_le_bytes());
        hash.add(words);
        let half = hash.0.finalize().as_bytes().first_chunk().map_or(0, |half| u128::from_le_bytes(*half));
        self.0 = self.0.wrapping_add(half);
    }

    pub fn bytes(self) -> [u8; 16] {
        self.0.to_le_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_blake3() {
        // The published hash of the empty input.
        let known = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";
        assert_eq!(IdentityHash::default().hex(), known);
    }

    #[test]
    fn the_hash_of_sums_depends_on_the_place_of_a_row_but_not_on_the_order() {
        let of = |rows: &[(&str, usize, u8)]| {
            let mut hash = SumsHash::default();
            rows.iter().for_each(|&(plane, row, byte)| hash.add_row(plane, row, &[byte]));
            hash.bytes()
        };
        let known = of(&[("X", 0, 1), ("X", 1, 2), ("Z", 0, 3)]);
        assert_eq!(of(&[("Z", 0, 3), ("X", 1, 2), ("X", 0, 1)]), known);
        assert_ne!(of(&[("X", 0, 2), ("X", 1, 1), ("Z", 0, 3)]), known);
        assert_ne!(of(&[("X", 0, 3), ("X", 1, 2), ("Z", 0, 1)]), known);
    }

    #[test]
    fn parts_are_separated() {
        let of = |parts: [&str; 2]| {
            let mut hash = IdentityHash::default();
            parts.iter().for_each(|part| hash.add_part(part.as_bytes()));
            hash.hex()
        };
        assert_ne!(of(["ab", "c"]), of(["a", "bc"]));
    }
}
