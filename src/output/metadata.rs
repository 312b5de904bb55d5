//! What a picture's file says about how the picture came to be.

use serde::Serialize;

/// Named texts in an EXR's header, in their order. Values are ASCII; those that hold structure are JSON.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Metadata {
    entries: Vec<(String, String)>,
}

/// The names that [`Metadata`] of a render uses.
pub mod names {
    /// The effective scene: the file's text with all patches, JSON.
    pub const SCENE: &str = "abbe.scene";
    /// A hash of the effective scene and the files that it refers to, 32 hexadecimal digits.
    pub const SCENE_HASH: &str = "abbe.sceneHash";
    /// The plan, JSON as `abbe explain --json` prints it.
    pub const PLAN: &str = "abbe.plan";
    /// The seed of all random streams.
    pub const SEED: &str = "abbe.seed";
    /// Passes done.
    pub const PASSES: &str = "abbe.passes";
    /// Photon paths in a pass.
    pub const PHOTONS: &str = "abbe.photons";
    /// `photon` or `path`.
    pub const INTEGRATOR: &str = "abbe.integrator";
    /// Where the light went, in W, JSON.
    pub const LEDGER: &str = "abbe.ledger";
    /// Wall-clock seconds.
    pub const SECONDS: &str = "abbe.seconds";
    /// The program's version.
    pub const VERSION: &str = "abbe.version";
    /// What a reader should know: residuals of matched lamps, clamped indices, forbidden effects, JSON.
    pub const NOTES: &str = "abbe.notes";
}

impl Metadata {
    /// Nothing said.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a text; what is not ASCII is escaped as in a JSON string.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Self {
        self.entries.push((name.to_string(), escaped(value)));
        self
    }

    /// Adds a value as JSON.
    #[must_use]
    pub fn with_json<T: Serialize + ?Sized>(self, name: &str, value: &T) -> Self {
        let text = serde_json::to_string(value).expect("reports have text keys and no fallible values");
        self.with(name, &text)
    }

    /// A text by its name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.entries.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// All names and texts.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }
}

/// JSON text with everything beyond ASCII as `\u` escapes. Such characters can only stand inside its strings.
pub fn escaped(json: &str) -> String {
    let mut ascii = String::with_capacity(json.len());
    for character in json.chars() {
        if character.is_ascii() {
            ascii.push(character);
        } else {
            let mut units = [0; 2];
            for unit in character.encode_utf16(&mut units) {
                ascii.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    ascii
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_comes_back_from_its_ascii_form() {
        let text = "Prisma für λ = 550 nm, 𝄞";
        let metadata = Metadata::new().with_json("title", text);
        let stored = metadata.get("title").unwrap();
        assert!(stored.is_ascii());
        assert_eq!(serde_json::from_str::<String>(stored).unwrap(), text);
        assert_eq!(metadata.get("other"), None);
    }
}
