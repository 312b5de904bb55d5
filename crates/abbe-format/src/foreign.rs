//! Recognises files of other programs that a user passes in the place of a scene.

use abbe_spectra::error::{Error, Result};
use std::path::Path;

/// How to bring a foreign file into a scene.
enum Import {
    Mesh,
    Luminaire,
    /// The file is a scene of a modelling program, which exports scenes.
    Export,
    Picture,
    /// A sentence about the file.
    Other(&'static str),
}

/// File name extensions of other programs, the names of the formats, and the way to import them.
const FOREIGN: [(&str, &str, Import); 27] = [
    ("obj", "a Wavefront OBJ mesh", Import::Mesh),
    ("ply", "a PLY mesh", Import::Mesh),
    ("stl", "an STL mesh", Import::Mesh),
    ("serialized", "a mesh of Mitsuba", Import::Mesh),
    ("ies", "an IES luminaire", Import::Luminaire),
    ("ldt", "an EULUMDAT luminaire", Import::Luminaire),
    ("blend", "a Blender file", Import::Export),
    ("fbx", "an FBX file", Import::Export),
    ("dae", "a COLLADA file", Import::Export),
    ("usd usda usdc usdz", "a USD file", Import::Export),
    ("max 3ds", "a 3ds Max file", Import::Export),
    ("ma mb", "a Maya file", Import::Export),
    ("c4d", "a Cinema 4D file", Import::Export),
    ("skp", "a SketchUp file", Import::Export),
    ("3dm", "a Rhino file", Import::Export),
    ("step stp iges igs", "a CAD file", Import::Export),
    ("abc", "an Alembic file", Import::Export),
    ("vrscene", "a V-Ray scene", Import::Export),
    ("pov inc", "a POV-Ray scene", Import::Other(BY_HAND)),
    ("rad oct", "a Radiance scene", Import::Other(BY_HAND)),
    ("appleseed", "an appleseed scene", Import::Other(BY_HAND)),
    ("lxs scn cfg", "a LuxCore scene", Import::Other(BY_HAND)),
    (
        "zmx zmf zar",
        "a lens of Zemax",
        Import::Other(
            "`abbe lens` prints the figures of a .zmx file, and `camera.lens.system` in a scene takes pictures through it",
        ),
    ),
    (
        "agf",
        "a glass catalogue of Zemax",
        Import::Other("a scene names its glasses: {\"glass\": {\"path\": \"own.agf\", \"name\": \"N-SF10\"}}"),
    ),
    ("exr hdr png jpg jpeg webp", "a picture", Import::Picture),
    ("csv spdx", "a table", Import::Other("a scene names the file of a spectrum: {\"file\": \"lamp.csv\"}")),
    (
        "yml yaml",
        "a YAML file",
        Import::Other("a scene names the file of an index: {\"ior\": {\"file\": \"glass.yml\"}}"),
    ),
];

/// The way for scenes of programs that export no format that Abbe reads.
const BY_HAND: &str = "Abbe does not read scenes of this program; if another program can convert it to glTF, render that \
                       file, or name its meshes (OBJ, PLY, STL) in a scene, and write the rest by hand";

/// Refuses a file of another program by its extension. The error says how to bring it into a scene.
pub(super) fn refuse_foreign(path: &Path) -> Result<()> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let has = |(known, ..): &&(&str, &str, Import)| known.split(' ').any(|it| extension.eq_ignore_ascii_case(it));
    let known = FOREIGN.iter().find(has);
    let Some((_, kind, import)) = known.filter(|_| path.is_file()) else { return Ok(()) };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let way = match import {
        Import::Mesh => {
            format!("to use this mesh, name it in a scene: {{\"shape\": {{\"mesh\": {{\"path\": \"{name}\"}}}}}}")
        }
        Import::Luminaire => format!(
            "to use this luminaire, add it to the lights of a scene: {{\"ies\": {{\"at\": [0, 3, 0], \"toward\": [0, -1, 0], \
             \"path\": \"{name}\", \"spectrum\": \"LED-B3\"}}}}"
        ),
        Import::Export => "export the scene as glTF and render that file: `abbe render FILE.glb`; its camera, lights \
                           and materials come along"
            .to_string(),
        Import::Picture => {
            "`abbe develop` and `abbe probe` read EXR pictures; a scene uses a picture as a texture or as its surroundings"
                .to_string()
        }
        Import::Other(way) => (*way).to_string(),
    };
    let expected = format!("a scene file in JSON; {way} (docs/guide/import.md)");
    Err(Error::input(format!("found {kind}")).expected(expected).in_file(path))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_programs_are_refused_with_a_way() {
        let folder = tempfile::tempdir().unwrap();
        for (name, way) in [
            ("a.PLY", "\"path\": \"a.PLY\""),
            ("a.obj", "\"path\": \"a.obj\""),
            ("a.ldt", "add it to the lights"),
            ("a.blend", "export the scene as glTF and render that file"),
            ("a.usda", "export the scene as glTF and render that file"),
            ("a.FBX", "export the scene as glTF and render that file"),
            ("a.zmx", "`abbe lens`"),
            ("a.pov", "a POV-Ray scene"),
            ("a.rad", "a Radiance scene"),
            ("a.appleseed", "an appleseed scene"),
            ("a.exr", "`abbe probe`"),
        ] {
            let path = folder.path().join(name);
            assert!(refuse_foreign(&path).is_ok(), "{name} does not exist yet");
            std::fs::write(&path, "x").unwrap();
            let error = refuse_foreign(&path).unwrap_err().to_string();
            assert!(error.contains(way) && error.contains("docs/guide/import.md"), "{error}");
        }
        let tungsten = r#"{"media": [], "bsdfs": [], "primitives": [], "camera": {"type": "pinhole"}}"#;
        let error = crate::parse(tungsten, Path::new("a.json"), &[]).unwrap_err();
        assert!(error.to_string().starts_with("a.json: found a Tungsten scene"), "{error}");
        let scene = folder.path().join("a.json");
        std::fs::write(&scene, "{}").unwrap();
        assert!(refuse_foreign(&scene).is_ok());
    }
}
