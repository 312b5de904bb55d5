//! Recognises files that are no scenes by their first bytes.

use abbe_spectra::error::{Error, Result};
use std::io::Read;
use std::path::Path;

/// What a file is that a user passes in the place of a scene, and what it is good for.
struct Kind {
    name: &'static str,
    advice: &'static str,
}

const PICTURE: &str = "a scene uses a picture as a texture or as an environment";

const EXR: &str = "`abbe probe`, `abbe develop`, `abbe compare` and `abbe view` read pictures; the header of a picture \
                   of Abbe contains its scene";

const UNPACK: &str = "unpack the file first";

const MODEL: &str = "export the scene as glTF, and render that file";

/// The first bytes of files, which are no texts in JSON.
const KINDS: [(&[u8], Kind); 20] = [
    (b"\x89PNG\r\n\x1a\n", Kind { name: "a PNG picture", advice: PICTURE }),
    (b"\xff\xd8\xff", Kind { name: "a JPEG picture", advice: PICTURE }),
    (b"\x76\x2f\x31\x01", Kind { name: "an OpenEXR picture", advice: EXR }),
    (b"#?RADIANCE", Kind { name: "a Radiance picture", advice: PICTURE }),
    (b"#?RGBE", Kind { name: "a Radiance picture", advice: PICTURE }),
    (b"GIF8", Kind { name: "a GIF picture", advice: "convert it to PNG, which a scene uses as a texture" }),
    (b"II*\0", Kind { name: "a TIFF picture", advice: "convert it to PNG or OpenEXR" }),
    (b"MM\0*", Kind { name: "a TIFF picture", advice: "convert it to PNG or OpenEXR" }),
    (b"RIFF", Kind { name: "a RIFF file, such as a WebP picture", advice: PICTURE }),
    (b"glTF", Kind { name: "a binary glTF file", advice: "give it a name that ends in .glb" }),
    (b"BLENDER", Kind { name: "a Blender file", advice: MODEL }),
    (b"Kaydara FBX Binary", Kind { name: "an FBX file", advice: MODEL }),
    (b"PXR-USDC", Kind { name: "a USD file", advice: MODEL }),
    (b"ply\n", Kind { name: "a PLY mesh", advice: "a scene names it in `shape.mesh.path`" }),
    (b"ply\r", Kind { name: "a PLY mesh", advice: "a scene names it in `shape.mesh.path`" }),
    (b"%PDF", Kind { name: "a PDF document", advice: "a scene is a text in JSON" }),
    (b"PK\x03\x04", Kind { name: "a ZIP archive", advice: UNPACK }),
    (b"\x1f\x8b", Kind { name: "a file compressed by gzip", advice: UNPACK }),
    (b"\x28\xb5\x2f\xfd", Kind { name: "a file compressed by zstd, such as a Blender file", advice: MODEL }),
    (b"\x7fELF", Kind { name: "a program", advice: "a scene is a text in JSON" }),
];

/// Returns an error that says what the file is if its first bytes belong to no scene.
pub(super) fn refuse_contents(path: &Path) -> Result<()> {
    let mut start = Vec::new();
    // A file that cannot be read has its own error later. A pipe would lose the bytes.
    if path.is_file()
        && let Ok(file) = std::fs::File::open(path)
        && file.take(32).read_to_end(&mut start).is_err()
    {
        return Ok(());
    }
    let Some((_, kind)) = KINDS.iter().find(|(first, _)| start.starts_with(first)) else { return Ok(()) };
    let expected = format!("a scene file in JSON; {} (docs/guide/import.md)", kind.advice);
    Err(Error::input(format!("found {}", kind.name)).expected(expected).in_file(path))
}

/// Returns true if a text is a JSON Schema, such as that of the scene files, which may lie beside
/// them.
pub fn is_json_schema(text: &str) -> bool {
    #[derive(serde::Deserialize)]
    struct Start {
        #[serde(rename = "$schema")]
        schema: String,
    }
    let is_schema = |start: Start| start.schema.contains("//json-schema.org/");
    text.contains("json-schema.org") && serde_json::from_str(text).is_ok_and(is_schema)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_and_archives_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.json");
        for (bytes, words) in [
            (&b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"[..], "a PNG picture"),
            (b"\x76\x2f\x31\x01\x02", "abbe develop"),
            (b"PK\x03\x04", "unpack"),
        ] {
            std::fs::write(&path, bytes).unwrap();
            let error = refuse_contents(&path).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("a scene file in JSON"), "{error}");
        }
        for text in ["{}", "", "PLY", "\u{feff}{}"] {
            std::fs::write(&path, text).unwrap();
            assert!(refuse_contents(&path).is_ok(), "{text}");
        }
        assert!(refuse_contents(folder.path()).is_ok() && refuse_contents(&folder.path().join("none")).is_ok());
    }

    #[test]
    fn a_schema_is_no_scene() {
        assert!(is_json_schema(r#"{"$schema": "https://json-schema.org/draft/2020-12/schema", "type": "object"}"#));
        assert!(!is_json_schema(r#"{"$schema": "scene.schema.json", "title": "see json-schema.org"}"#));
        assert!(!is_json_schema(r#"{"$schema": "https://json-schema.org/", "#));
    }
}
