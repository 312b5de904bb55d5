//! Recognises files that a user passes in the place of a scene or of a picture, and says what they
//! are good for.

use abbe_spectra::error::{Error, Result};
use std::io::Read;
use std::path::Path;

/// What a file is good for that is no scene.
enum Way {
    Mesh,
    Luminaire,
    /// The file is a scene of a modelling program, which exports scenes.
    Export,
    /// A picture that a scene can use.
    Picture,
    /// A picture that a scene can use after its conversion.
    OtherPicture,
    /// A sentence about the file.
    Other(&'static str),
}

/// First bytes of files, each with its place in the file.
type FirstBytes = &'static [(usize, &'static [u8])];

/// Files of other programs: the name of the format, the extensions of their names, their first
/// bytes, and their use.
const KINDS: [(&str, &str, FirstBytes, Way); 51] = [
    ("a Wavefront OBJ mesh", "obj", &[], Way::Mesh),
    ("a PLY mesh", "ply", &[(0, b"ply\n"), (0, b"ply\r")], Way::Mesh),
    ("an STL mesh", "stl", &[], Way::Mesh),
    ("a mesh of Mitsuba", "serialized", &[], Way::Mesh),
    ("a gem design of GemCad", "asc gem", &[(0, b"GemCad ")], Way::Mesh),
    ("a gem design of Gem Cut Studio", "gcs", &[(0, b"<GemCutStudio")], Way::Mesh),
    ("an IES luminaire", "ies", &[], Way::Luminaire),
    ("an EULUMDAT luminaire", "ldt", &[], Way::Luminaire),
    ("a TM-33 luminaire", "tm33", &[], Way::Luminaire),
    ("a ray file", "tm25ray dat", &[(0, b"TM25")], Way::Other(RAYS)),
    ("a Blender file", "blend", &[(0, b"BLENDER")], Way::Export),
    ("an FBX file", "fbx", &[(0, b"Kaydara FBX Binary")], Way::Export),
    ("a COLLADA file", "dae", &[], Way::Export),
    ("a USD file", "usd usda usdc usdz", &[(0, b"PXR-USDC")], Way::Export),
    ("a 3ds Max file", "max 3ds", &[], Way::Export),
    ("a Maya file", "ma mb", &[], Way::Export),
    ("a Cinema 4D file", "c4d", &[], Way::Export),
    ("a SketchUp file", "skp", &[], Way::Export),
    ("a Rhino file", "3dm", &[], Way::Export),
    ("a CAD file", "step stp iges igs", &[], Way::Export),
    ("an Alembic file", "abc", &[], Way::Export),
    ("a V-Ray scene", "vrscene", &[], Way::Export),
    ("a POV-Ray scene", "pov inc", &[], Way::Other(BY_HAND)),
    ("a Radiance scene", "rad oct", &[], Way::Other(BY_HAND)),
    ("an appleseed scene", "appleseed", &[], Way::Other(BY_HAND)),
    ("a LuxCore scene", "lxs scn cfg", &[], Way::Other(BY_HAND)),
    ("a binary glTF file", "", &[(0, b"glTF")], Way::Other("give it a name that ends in .glb")),
    ("a lens of Zemax", "zmx zmf zar", &[], Way::Other(LENS)),
    ("a lens of CODE V", "seq", &[], Way::Other(LENS)),
    ("a lens of OSLO", "len", &[], Way::Other(LENS)),
    ("a glass catalogue of Zemax", "agf", &[], Way::Other(GLASSES)),
    (
        "a table",
        "csv spdx cgats ti3 sp ccss",
        &[],
        Way::Other("a scene names the file of a spectrum: {\"file\": \"lamp.csv\"}"),
    ),
    (
        "a YAML file",
        "yml yaml",
        &[],
        Way::Other("a scene names the file of an index: {\"ior\": {\"file\": \"glass.yml\"}}"),
    ),
    ("a PNG picture", "png", &[(0, b"\x89PNG\r\n\x1a\n")], Way::Picture),
    ("a JPEG picture", "jpg jpeg", &[(0, b"\xff\xd8\xff")], Way::Picture),
    ("a WebP picture", "webp", &[(8, b"WEBP")], Way::Picture),
    ("a Radiance picture", "hdr", &[(0, b"#?RADIANCE"), (0, b"#?RGBE")], Way::Picture),
    ("an OpenEXR picture", "exr", &[(0, b"\x76\x2f\x31\x01")], Way::Other(EXR)),
    ("a TIFF picture", "tif tiff", &[(0, b"II*\0"), (0, b"MM\0*")], Way::OtherPicture),
    ("a BMP picture", "bmp", &[(0, b"BM")], Way::OtherPicture),
    ("a GIF picture", "gif", &[(0, b"GIF8")], Way::OtherPicture),
    ("a DDS picture", "dds", &[(0, b"DDS ")], Way::OtherPicture),
    ("a KTX picture", "ktx ktx2", &[(0, b"\xabKTX")], Way::OtherPicture),
    ("an AVIF picture", "avif", &[(4, b"ftypavif")], Way::OtherPicture),
    ("a HEIF picture", "heif heic", &[(4, b"ftyphei")], Way::OtherPicture),
    ("a JPEG XL picture", "jxl", &[(0, b"\xff\x0a"), (0, b"\0\0\0\x0cJXL ")], Way::OtherPicture),
    ("a Photoshop picture", "psd", &[(0, b"8BPS")], Way::OtherPicture),
    ("a PDF document", "pdf", &[(0, b"%PDF")], Way::Other("a scene is a text in JSON")),
    (
        "a compressed file",
        "zip gz zst",
        &[(0, b"PK\x03\x04"), (0, b"\x1f\x8b"), (0, b"\x28\xb5\x2f\xfd")],
        Way::Other(UNPACK),
    ),
    ("a pointer of Git LFS", "", &[(0, b"version https://git-lfs")], Way::Other("fetch the file with `git lfs pull`")),
    ("a program", "", &[(0, b"\x7fELF")], Way::Other("a scene is a text in JSON")),
];

/// The way for scenes of programs that export no format that Abbe reads.
const BY_HAND: &str = "Abbe does not read scenes of this program; if another program can convert it to glTF, render that \
                       file, or name its meshes (OBJ, PLY, STL) in a scene, and write the rest by hand";

const RAYS: &str = "to use this light, add it to the lights of a scene: {\"rays\": {\"at\": [0, 1, 0], \"toward\": [0, -1, 0], \
                    \"path\": \"led.TM25RAY\"}}";

const LENS: &str = "`abbe lens` prints the figures of a .zmx, .seq or .len file, and `camera.lens.system` in a scene takes \
                    pictures through it";

const GLASSES: &str = "a scene names its glasses: {\"glass\": {\"path\": \"own.agf\", \"name\": \"N-SF10\"}}";

const EXR: &str = "`abbe probe`, `abbe develop`, `abbe compare` and `abbe view` read pictures; the header of a picture \
                   of Abbe contains its scene; a scene uses a picture as a texture or as its surroundings";

const UNPACK: &str = "unpack the file first; a compressed Blender file has to be exported as glTF";

/// Refuses a file of another program in the place of a scene, by the extension of its name or by
/// its first bytes. The error says how to bring the file into a scene.
pub(super) fn refuse_as_scene(path: &Path) -> Result<()> {
    if !path.is_file() {
        // A missing file has its own error later, and a pipe would lose the bytes.
        return Ok(());
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let named = KINDS.iter().find(|(_, known, ..)| known.split(' ').any(|it| extension.eq_ignore_ascii_case(it)));
    let known = named.filter(|_| !extension.is_empty()).or_else(|| of_bytes(&first_bytes(path)));
    let Some((kind, _, _, way)) = known else { return Ok(()) };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let way = match way {
        Way::Mesh => {
            format!("to use this mesh, name it in a scene: {{\"shape\": {{\"mesh\": {{\"path\": \"{name}\"}}}}}}")
        }
        Way::Luminaire => format!(
            "to use this luminaire, add it to the lights of a scene: {{\"ies\": {{\"at\": [0, 3, 0], \"toward\": [0, -1, 0], \
             \"path\": \"{name}\", \"spectrum\": \"LED-B3\"}}}}"
        ),
        Way::Export => "export the scene as glTF and render that file: `abbe render FILE.glb`; its camera, lights \
                        and materials come along"
            .to_owned(),
        Way::Picture => "a scene uses a picture as a texture or as its surroundings".to_owned(),
        Way::OtherPicture => {
            "convert it to PNG or OpenEXR, which a scene uses as a texture or as its surroundings".to_owned()
        }
        Way::Other(way) => (*way).to_owned(),
    };
    let expected = format!("a scene file in JSON; {way} (docs/guide/import.md)");
    Err(Error::input(format!("found {kind}")).expected(expected).in_file(path))
}

/// Returns the first bytes of a file, and none if it cannot be read, which is an error later.
fn first_bytes(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(32).read_to_end(&mut bytes));
    if read.is_ok() { bytes } else { Vec::new() }
}

/// Returns the kind of a file with these first bytes.
fn of_bytes(start: &[u8]) -> Option<&'static (&'static str, &'static str, FirstBytes, Way)> {
    let begins = |(at, bytes): &(usize, &[u8])| start.get(*at..).is_some_and(|start| start.starts_with(bytes));
    KINDS.iter().find(|(_, _, first, _)| first.iter().any(begins))
}

/// Says what a file is that is passed in the place of a picture and is none that Abbe reads.
pub(super) fn refuse_as_picture(bytes: &[u8]) -> Error {
    const PICTURES: &str = "a PNG, JPEG, WebP, OpenEXR or Radiance HDR file";
    let (kind, expected) = match of_bytes(bytes) {
        Some((kind, _, _, Way::OtherPicture)) => (*kind, format!("{PICTURES}, to which other programs convert it")),
        Some((kind, _, _, Way::Other(way))) => (*kind, format!("{PICTURES}; {way}")),
        Some((kind, _, _, Way::Mesh | Way::Luminaire | Way::Export | Way::Picture)) => (*kind, PICTURES.to_owned()),
        None => ("a file of another kind", PICTURES.to_owned()),
    };
    Error::input(format!("the image cannot be read: it is {kind}")).expected(expected)
}

/// Recognises a JSON text of another program by two keys that scenes of Abbe do not have.
pub(super) fn foreign_json(text: &str) -> Option<Error> {
    const KNOWN: [([&str; 2], &str, &str); 2] = [
        (["\"bsdfs\"", "\"primitives\""], "a Tungsten scene", BY_HAND),
        (["\"asset\"", "\"accessors\""], "a glTF file", "give it a name that ends with .gltf, and render it"),
    ];
    let (_, kind, way) = KNOWN.iter().find(|(keys, ..)| keys.iter().all(|key| text.contains(key)))?;
    Some(Error::input(format!("found {kind}")).expected(format!("a scene file; {way} (docs/guide/import.md)")))
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
    fn files_of_other_programs_are_refused_with_a_way() {
        let folder = tempfile::tempdir().unwrap();
        for (name, way) in [
            ("a.PLY", "\"path\": \"a.PLY\""),
            ("a.obj", "\"path\": \"a.obj\""),
            ("a.asc", "\"path\": \"a.asc\""),
            ("a.GEM", "a gem design of GemCad"),
            ("a.gcs", "a gem design of Gem Cut Studio"),
            ("a.ldt", "add it to the lights"),
            ("a.blend", "export the scene as glTF and render that file"),
            ("a.usda", "export the scene as glTF and render that file"),
            ("a.FBX", "export the scene as glTF and render that file"),
            ("a.zmx", "`abbe lens`"),
            ("a.len", "`abbe lens`"),
            ("a.pov", "a POV-Ray scene"),
            ("a.rad", "a Radiance scene"),
            ("a.appleseed", "an appleseed scene"),
            ("a.exr", "`abbe probe`"),
        ] {
            let path = folder.path().join(name);
            assert!(refuse_as_scene(&path).is_ok(), "{name} does not exist yet");
            std::fs::write(&path, "x").unwrap();
            let error = refuse_as_scene(&path).unwrap_err().to_string();
            assert!(error.contains(way) && error.contains("docs/guide/import.md"), "{error}");
        }
        let tungsten = r#"{"media": [], "bsdfs": [], "primitives": [], "camera": {"type": "pinhole"}}"#;
        let error = crate::parse(tungsten, Path::new("a.json"), &[]).unwrap_err();
        assert!(error.to_string().starts_with("a.json: found a Tungsten scene"), "{error}");
    }

    #[test]
    fn first_bytes_name_pictures_and_archives() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.json");
        for (bytes, words) in [
            (&b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"[..], "a PNG picture"),
            (b"\x76\x2f\x31\x01\x02", "abbe develop"),
            (b"RIFF\0\0\0\0WEBPVP8 ", "a WebP picture"),
            (b"PK\x03\x04", "unpack"),
        ] {
            std::fs::write(&path, bytes).unwrap();
            let error = refuse_as_scene(&path).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("a scene file in JSON"), "{error}");
        }
        for text in ["{}", "", "PLY", "\u{feff}{}"] {
            std::fs::write(&path, text).unwrap();
            assert!(refuse_as_scene(&path).is_ok(), "{text}");
            std::fs::write(folder.path().join("scene"), text).unwrap();
            assert!(refuse_as_scene(&folder.path().join("scene")).is_ok(), "{text}");
        }
        assert!(refuse_as_scene(folder.path()).is_ok());
    }

    #[test]
    fn files_that_are_no_readable_pictures_are_named() {
        let error = |bytes: &[u8]| refuse_as_picture(bytes).to_string();
        assert!(error(b"II*\0").contains("a TIFF picture"));
        assert!(error(b"\0\0\0\x1cftypavif").contains("an AVIF picture"));
        assert!(error(b"version https://git-lfs.github.com/spec/v1").contains("`git lfs pull`"));
        assert!(error(b"").contains("a file of another kind"));
    }

    #[test]
    fn a_schema_is_no_scene() {
        assert!(is_json_schema(r#"{"$schema": "https://json-schema.org/draft/2020-12/schema", "type": "object"}"#));
        assert!(!is_json_schema(r#"{"$schema": "scene.schema.json", "title": "see json-schema.org"}"#));
        assert!(!is_json_schema(r#"{"$schema": "https://json-schema.org/", "#));
    }
}
