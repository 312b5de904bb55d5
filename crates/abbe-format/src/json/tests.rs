//! Tests of the scanner with randomly damaged texts.

use super::scan::scan;

/// A source of random damage to texts (SplitMix64, Steele, Lea & Flood 2014).
pub(crate) struct TextDamage(pub(crate) u64);

impl TextDamage {
    /// Returns a random whole number below `end`.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % end as u64) as usize
    }

    /// Returns the text with one to three random changes: a part is removed, doubled or replaced.
    pub(crate) fn damage(&mut self, text: &str) -> String {
        const PARTS: &str = "{ } [ ] , : \" \\ null true - 0 1e999 . NaN // \u{0} \n λ \\u \\ud83c \\udf08 e [[[[ \
                             {\"a\": \"radius\":1, -1 \u{feff} \t é\"";
        let parts: Vec<&str> = PARTS.split(' ').collect();
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..=self.below(3) {
            let (from, length) = (self.below(bytes.len() + 1), self.below(12));
            let to = (from + length).min(bytes.len());
            let kind = self.below(4);
            match kind {
                0 => drop(bytes.drain(from..to)),
                1 => drop(bytes.splice(from..from, bytes[from..to].to_vec())),
                _ => {
                    let part = parts[self.below(parts.len())];
                    drop(bytes.splice(from..if kind == 2 { from } else { to }, part.bytes()));
                }
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

/// The scanner accepts the same texts as `serde_json`, except those with duplicate keys.
#[test]
fn the_scanner_refuses_what_serde_json_refuses() {
    let whole =
        r#"{"a": [1, -2.5e3, {"name": "prism", "é": "\u00e9\ud83c\udf08"}], "c d": null, "e": [true, false, []]}"#;
    let mut random = TextDamage(1);
    let mut accepted = 0;
    for _ in 0..20_000 {
        let text = random.damage(whole);
        let (scanned, strict) = (scan(&text), serde_json::from_str::<serde_json::Value>(&text));
        let duplicate = matches!(&scanned, Err(syntax) if syntax.error.what.contains("a second time"));
        assert!(duplicate || scanned.is_ok() == strict.is_ok(), "{strict:?} in:\n{text}");
        accepted += u32::from(scanned.is_ok());
    }
    assert!((1_000..19_000).contains(&accepted), "the damage is too heavy or too light: {accepted} accepted");
}
