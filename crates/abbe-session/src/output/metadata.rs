//! Metadata of a picture: named texts in its file.

use serde::Serialize;

/// An ordered list of named ASCII texts in the header of an EXR. Structured values are JSON.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Metadata {
    entries: Vec<(String, String)>,
}

/// The names of the texts written by a render.
pub mod names {
    /// The effective scene: the text of the scene file after all changes, as JSON.
    pub const SCENE: &str = "abbe.scene";
    /// A BLAKE3 hash of the effective scene and its files, as 64 hexadecimal digits.
    pub const SCENE_HASH: &str = "abbe.sceneHash";
    /// The plan, as the JSON that `abbe explain --json` prints.
    pub const PLAN: &str = "abbe.plan";
    /// The settings of the PNG as JSON: exposure, white, colour space, tone curve, gamut mapping.
    pub const DISPLAY: &str = "abbe.display";
    /// The seed of all random streams.
    pub const SEED: &str = "abbe.seed";
    /// The number of completed passes.
    pub const PASSES: &str = "abbe.passes";
    pub const PHOTONS: &str = "abbe.photons";
    /// The integrator: `photon` or `path`.
    pub const INTEGRATOR: &str = "abbe.integrator";
    /// The energy balance in W, as JSON.
    pub const LEDGER: &str = "abbe.ledger";
    /// Wall-clock time in seconds.
    pub const SECONDS: &str = "abbe.seconds";
    pub const VERSION: &str = "abbe.version";
    /// Present in the preview of a running render.
    pub const PREVIEW: &str = "abbe.preview";
    /// The gains of the light groups as JSON, in a picture that `abbe relight` wrote.
    pub const RELIGHT: &str = "abbe.relight";
    /// Notes for the user as JSON: residuals of matched spectra, clamped indices and so on.
    pub const NOTES: &str = "abbe.notes";
}

impl Metadata {
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds or replaces a text. Characters beyond ASCII are escaped as in a JSON string.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Self {
        self.entries.retain(|(known, _)| known != name);
        self.entries.push((name.to_string(), escape_non_ascii(value)));
        self
    }

    #[must_use]
    pub fn without(mut self, name: &str) -> Self {
        self.entries.retain(|(known, _)| known != name);
        self
    }

    #[must_use]
    pub fn with_json<T: Serialize + ?Sized>(self, name: &str, value: &T) -> Self {
        let text = serde_json::to_string(value).expect("reports have text keys and no fallible values");
        self.with(name, &text)
    }

    pub fn get(&self, name: &str) -> Option<&str> {
        self.entries.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }
}

/// Replaces the characters of a JSON text that are not ASCII, which occur only inside strings, by
/// escape sequences that begin with `\u`.
pub fn escape_non_ascii(json: &str) -> String {
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
    fn ascii_json_parses_to_the_original_text() {
        let text = "Prisma für λ = 550 nm, 𝄞";
        let metadata = Metadata::new().with_json("title", text);
        let stored = metadata.get("title").unwrap();
        assert!(stored.is_ascii());
        assert_eq!(serde_json::from_str::<String>(stored).unwrap(), text);
        assert_eq!(metadata.get("other"), None);
    }
}
