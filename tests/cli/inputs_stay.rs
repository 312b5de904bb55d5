//! No command writes over a file that it reads.

use crate::abbe_command::abbe;
use std::path::{Path, PathBuf};

const SCENE: &str = r#"{
  "camera": {"from": [0, 1, 4], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 6},
  "materials": {"wood": {"diffuse": {"reflectance": {"image": "wood.png"}}}},
  "objects": [{"shape": {"rectangle": {"width": 2, "height": 2}}, "material": "wood"}],
  "lights": [{"environment": {"image": "sky.exr", "luminance": 100}}],
  "meters": [{"name": "floor", "quantity": "illuminance", "points": [[0, 0.1, 0]]}],
  "render": {"photons": 500, "passes": 1}
}"#;

/// Scenes with the names of their sky and of their texture.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let plain = r#"{"camera": {"from": [0, 1, 4], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
        "film": {"width": 8, "height": 4}, "objects": [], "lights": [{"environment": {"spectrum": "D65", "luminance": 1}}]}"#;
    std::fs::write(at.join("plain.json"), plain).unwrap();
    let said = abbe(at, &["render", "plain.json", "--passes", "1", "-o", "sky.exr", "--quiet"]);
    assert_eq!(said.status, 0, "{}", said.err);
    std::fs::rename(at.join("sky.png"), at.join("wood.png")).unwrap();
    for name in ["sky.json", "wood.json", "study.json"] {
        std::fs::write(at.join(name), SCENE).unwrap();
    }
    folder
}

fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.map(|path| (path.clone(), std::fs::read(path).unwrap())).collect();
    files.sort();
    files
}

/// Runs a command that must be refused, and checks that it neither changes nor adds a file.
#[track_caller]
fn is_refused(folder: &Path, arguments: &[&str]) {
    let before = files(folder);
    abbe(folder, arguments).is_error(2, &["would replace", "another name"]);
    assert!(before == files(folder), "{arguments:?} changed the folder");
}

#[test]
fn pictures_and_tables_of_a_scene_replace_no_file_of_the_scene() {
    let folder = folder();
    let at = folder.path();
    // By default, a picture has the name of its scene.
    is_refused(at, &["render", "sky.json"]);
    is_refused(at, &["render", "wood.json"]);
    is_refused(at, &["render", "wood.json", "-o", "a.exr", "--stats", "wood.json"]);
    is_refused(at, &["render", "wood.json", "-o", "a.exr", "--stats", "./sky.exr"]);
    is_refused(at, &["measure", "wood.json", "--csv", "wood.png"]);
    is_refused(at, &["measure", "wood.json", "--html", "wood.json"]);
    is_refused(at, &["study", "study.json", "-o", "."]);
    let said = abbe(at, &["render", "wood.json", "-o", "a.exr", "--quiet"]);
    assert_eq!(said.status, 0, "{}", said.err);
}

#[cfg(unix)]
#[test]
fn a_link_is_no_other_name() {
    let folder = folder();
    let at = folder.path();
    std::os::unix::fs::symlink("sky.exr", at.join("link.exr")).unwrap();
    is_refused(
        at,
        &[
            "render",
            "plain.json",
            "--set",
            r#"lights[0].environment={"image":"sky.exr","luminance":1}"#,
            "-o",
            "link.exr",
        ],
    );
    std::fs::hard_link(at.join("sky.exr"), at.join("hard.exr")).unwrap();
    is_refused(at, &["render", "sky.json", "-o", "hard.exr"]);
}

#[test]
fn other_commands_keep_what_they_read() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("lamp.csv"), "nm,value\n360,1\n830,1\n").unwrap();
    std::fs::write(at.join("lens.json"), r#"{"name": "none"}"#).unwrap();
    is_refused(at, &["lamps", "lamp.csv", "A", "--html", "lamp.csv"]);
    is_refused(at, &["spectrum", "lamp.csv", "--svg", "lamp.csv"]);
    is_refused(at, &["glass", "N-BK7", "--catalogue", "lamp.csv", "--svg", "lamp.csv"]);
    is_refused(at, &["lens", "lens.json", "--svg", "lens.json"]);
    is_refused(at, &["lens", "lens.json", "--html", "lens.json"]);
    is_refused(at, &["film", "lens.json", "--svg", "lens.json"]);
    is_refused(at, &["probe", "sky.exr", "1", "1", "--heat", "sky.exr"]);
    is_refused(at, &["relight", "sky.exr", "-o", "sky.exr"]);
    is_refused(at, &["develop", "wood.png", "-o", "wood.png"]);
    is_refused(at, &["compare", "sky.exr", "sky.exr", "--html", "sky.exr"]);
    is_refused(at, &["regress", "lamp.csv", "--junit", "lamp.csv"]);
    is_refused(at, &["import", "lamp.csv", "-o", "lamp.csv"]);
}

/// Mitsuba and pbrt scenes include other files, which the converted scene no longer names.
#[test]
fn the_included_files_of_foreign_scenes_stay() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("s.pbrt"), "WorldBegin\nInclude \"part.json\"\n").unwrap();
    std::fs::write(at.join("part.json"), "Shape \"sphere\"\n").unwrap();
    std::fs::write(
        at.join("s.xml"),
        r#"<scene version="3.0.0"><sensor type="perspective"/><include filename="part.exr"/></scene>"#,
    )
    .unwrap();
    std::fs::write(at.join("part.exr"), r#"<scene version="3.0.0"><shape type="sphere"/></scene>"#).unwrap();
    is_refused(at, &["import", "s.pbrt", "-o", "part.json"]);
    is_refused(at, &["import", "s.xml", "-o", "part.exr"]);
    let before = files(at);
    for arguments in [["s.pbrt", "-o", "a.exr", "--stats", "part.json"].as_slice(), &["s.xml", "-o", "part.exr"]] {
        let said = abbe(at, &[&["render"], arguments].concat());
        assert!(said.status == 2 && said.err.contains("would replace part."), "{}", said.err);
        assert!(before == files(at), "{arguments:?} changed the folder");
    }
    assert_eq!(abbe(at, &["import", "s.xml", "-o", "s.json"]).status, 0);
}

/// The last job writes the merged picture and its statistics into the folder of the scripts.
#[test]
fn the_jobs_of_a_cluster_keep_the_files_of_the_scene() {
    let folder = folder();
    let at = folder.path();
    for scene in ["sky.json", "wood.json"] {
        is_refused(at, &["slurm", scene, "--parts", "2", "--passes", "4", "-o", "."]);
    }
    assert_eq!(abbe(at, &["slurm", "sky.json", "--parts", "2", "--passes", "4", "-o", "jobs"]).status, 0);
}
