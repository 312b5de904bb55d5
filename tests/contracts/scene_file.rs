//! The scene file: all scenes of the package are valid, and the generated schema and reference are
//! up to date.

use std::path::{Path, PathBuf};

use crate::common::generated::is_up_to_date;
use abbe_format::{self as format, SceneFile};

/// Returns the paths of all scenes in a folder of the package, sorted.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(&folder).expect("the folder is in the package");
    let entries = entries.map(|entry| entry.expect("the folder can be listed").path());
    let mut scenes: Vec<_> = entries.filter(|path| path.extension().is_some_and(|it| it == "json")).collect();
    scenes.retain(|path| !path.ends_with("scene.schema.json"));
    scenes.sort();
    scenes
}

/// Reading, writing and reading again gives the same scene.
#[test]
fn all_scenes_survive_a_round_trip() {
    let all: Vec<_> = ["benches/scenes", "scenes", "tests/good_scenes"].into_iter().flat_map(scenes).collect();
    assert!(all.len() >= 5, "{all:?}");
    for path in all {
        let (scene, source) = format::read(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(source.folder(), path.parent().unwrap());
        let written = serde_json::to_string_pretty(&scene).unwrap();
        let (again, _): (SceneFile, _) = format::parse(&written, &path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene, again, "{}", path.display());
        let by_serde_json: SceneFile = serde_json::from_str(&written).unwrap();
        assert_eq!(scene, by_serde_json, "{}", path.display());
    }
}

#[test]
fn the_schema_in_scenes_is_up_to_date() {
    is_up_to_date("scenes/scene.schema.json", &format!("{:#}\n", format::generated_schema()));
}

#[test]
fn the_scene_reference_in_docs_is_up_to_date() {
    is_up_to_date("docs/reference/scene.md", &format::scene_reference());
}
