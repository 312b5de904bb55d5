//! The hash that identifies scenes, saved runs and study steps.

/// A BLAKE3 hash. The same data has the same hash on every machine and in every version of the
/// program.
#[derive(Debug, Clone, Default)]
pub struct IdentityHash(blake3::Hasher);

impl IdentityHash {
    /// Adds bytes.
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
    fn parts_are_separated() {
        let of = |parts: [&str; 2]| {
            let mut hash = IdentityHash::default();
            parts.iter().for_each(|part| hash.add_part(part.as_bytes()));
            hash.hex()
        };
        assert_ne!(of(["ab", "c"]), of(["a", "bc"]));
    }
}
