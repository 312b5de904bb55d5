//! The example scenes in the program, for a view without a scene file.

use abbe_format::{FileAccess, JsonSource, SceneFile, parse_with_access};
use abbe_spectra::error::Result;
use std::path::Path;

/// An example scene, which reads no files.
#[derive(Debug, PartialEq, Eq)]
pub struct Example {
    pub name: &'static str,
    text: &'static str,
    /// A WebP file of 320 × 180 pixels.
    pub(super) thumbnail: &'static [u8],
}

/// The examples in the order of the pages. `web/examples` reads their names here.
pub(super) static EXAMPLES: &[Example] = &[
    Example {
        name: "prism",
        text: include_str!("../../scenes/prism.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/prism.webp"),
    },
    Example {
        name: "two_prisms",
        text: include_str!("../../scenes/two_prisms.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/two_prisms.webp"),
    },
    Example {
        name: "rainbow",
        text: include_str!("../../scenes/rainbow.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/rainbow.webp"),
    },
    Example {
        name: "glass_ball",
        text: include_str!("../../scenes/glass_ball.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/glass_ball.webp"),
    },
    Example {
        name: "singlet",
        text: include_str!("../../scenes/singlet.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/singlet.webp"),
    },
    Example {
        name: "chromatic_aberration",
        text: include_str!("../../scenes/chromatic_aberration.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/chromatic_aberration.webp"),
    },
    Example {
        name: "grating",
        text: include_str!("../../scenes/grating.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/grating.webp"),
    },
    Example {
        name: "soap_film",
        text: include_str!("../../scenes/soap_film.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/soap_film.webp"),
    },
    Example {
        name: "sodium",
        text: include_str!("../../scenes/sodium.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/sodium.webp"),
    },
    Example {
        name: "sodium_rgb",
        text: include_str!("../../scenes/sodium_rgb.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/sodium_rgb.webp"),
    },
    Example {
        name: "prism_in_fog",
        text: include_str!("../../scenes/prism_in_fog.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/prism_in_fog.webp"),
    },
    Example {
        name: "newton_rings",
        text: include_str!("../../scenes/newton_rings.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/newton_rings.webp"),
    },
    Example {
        name: "optical_disc",
        text: include_str!("../../scenes/optical_disc.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/optical_disc.webp"),
    },
    Example {
        name: "quinine",
        text: include_str!("../../scenes/quinine.json"),
        thumbnail: include_bytes!("../../docs/pictures/scenes/small/quinine.webp"),
    },
];

impl Example {
    pub(super) fn named(name: &str) -> Option<&'static Self> {
        EXAMPLES.iter().find(|example| example.name == name)
    }

    /// Reads the scene with changes in the form `PATH=JSON`. Returns an input error if a change is
    /// wrong, or if it names a file.
    pub fn read(&self, changes: &[String]) -> Result<(SceneFile, JsonSource)> {
        let name = format!("{}.json", self.name);
        parse_with_access(self.text, Path::new(&name), changes, FileAccess::Nowhere)
    }

    /// Returns the title of the scene as a heading, and what it says after a colon, or an empty
    /// text.
    pub(super) fn title(&self) -> (String, String) {
        let scene: serde_json::Value = serde_json::from_str(self.text).unwrap_or_default();
        let title = scene["title"].as_str().unwrap_or(self.name);
        let (heading, rest) = title.split_once(": ").unwrap_or((title, ""));
        let mut letters = rest.chars();
        let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
        (heading.to_string(), first + letters.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_example_is_a_small_scene_with_a_title() {
        for example in EXAMPLES {
            let (name, (heading, _)) = (example.name, example.title());
            assert!(example.read(&[]).is_ok(), "{name}");
            assert_eq!(Example::named(name), Some(example));
            assert!(heading != name && heading.len() <= 90, "{name}: {heading}");
            assert!(example.thumbnail.starts_with(b"RIFF") && example.thumbnail.len() <= 10_000, "{name}");
        }
        let size = EXAMPLES.iter().map(|example| example.text.len() + example.thumbnail.len()).sum::<usize>();
        assert!(size < 150_000, "{size} bytes");
    }

    #[test]
    fn an_example_reads_no_files() {
        let change = r#"objects[0].shape={"mesh": {"path": "here.obj"}}"#.to_string();
        let error =
            EXAMPLES[0].read(&[change]).and_then(|(scene, source)| crate::page::LoadedScene::new(&scene, source));
        assert!(error.unwrap_err().to_string().contains("here.obj"));
    }
}
