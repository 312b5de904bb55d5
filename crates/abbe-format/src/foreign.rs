//! Recognises files of other programs that a user passes in the place of a scene.

use abbe_spectra::error::{Error, Result};
use std::path::Path;

/// How to bring a foreign file into a scene.
enum Import {
    Mesh,
    Luminaire,
    /// The file is a scene of another program. Its meshes can be exported.
    Scene,
}

/// File name extensions of other programs, the names of the formats, and the way to import them.
const FOREIGN: [(&str, &str, Import); 9] = [
    ("obj", "a Wavefront OBJ mesh", Import::Mesh),
    ("ply", "a PLY mesh", Import::Mesh),
    ("stl", "an STL mesh", Import::Mesh),
    ("ies", "an IES luminaire", Import::Luminaire),
    ("ldt", "an EULUMDAT luminaire", Import::Luminaire),
    ("blend", "a Blender file", Import::Scene),
    ("fbx", "an FBX file", Import::Scene),
    ("dae", "a COLLADA file", Import::Scene),
    ("usd usda usdc usdz", "a USD file", Import::Scene),
];

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
        Import::Scene => "to use its geometry, export the meshes as glTF, OBJ, PLY or STL, name them in a scene, and \
                          write camera, lights and materials by hand"
            .to_string(),
    };
    let expected = format!("a scene file in JSON; {way} (docs/guide/import.md)");
    Err(Error::input(format!("found {kind}")).expected(expected).in_file(path))
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
            ("a.blend", "export"),
        ] {
            let path = folder.path().join(name);
            assert!(refuse_foreign(&path).is_ok(), "{name} does not exist yet");
            std::fs::write(&path, "x").unwrap();
            let error = refuse_foreign(&path).unwrap_err().to_string();
            assert!(error.contains(way) && error.contains("docs/guide/import.md"), "{error}");
        }
        let scene = folder.path().join("a.json");
        std::fs::write(&scene, "{}").unwrap();
        assert!(refuse_foreign(&scene).is_ok());
    }
}
