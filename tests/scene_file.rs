//! The scene file as written: good scenes read whole, the schema in `scenes/` is up to date.

use std::path::{Path, PathBuf};

use abbe::scene::file::{self, SceneFile};

/// All JSON files of a folder of the package, by name.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(&folder).expect("the folder is in the package");
    let entries = entries.map(|entry| entry.expect("the folder can be listed").path());
    let mut scenes: Vec<_> = entries.filter(|path| path.extension().is_some_and(|it| it == "json")).collect();
    scenes.retain(|path| !path.ends_with("scene.schema.json"));
    scenes.sort();
    scenes
}

#[test]
fn all_scenes_read_and_survive_a_round_trip() {
    let all: Vec<_> = ["benches/scenes", "scenes", "tests/good_scenes"].into_iter().flat_map(scenes).collect();
    assert!(all.len() >= 5, "{all:?}");
    for path in all {
        let (scene, source) = file::read(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(source.folder(), path.parent().unwrap());
        let written = serde_json::to_string_pretty(&scene).unwrap();
        let (again, _): (SceneFile, _) = file::parse(&written, &path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scene, again, "{}", path.display());
        let by_serde_json: SceneFile = serde_json::from_str(&written).unwrap();
        assert_eq!(scene, by_serde_json, "{}", path.display());
    }
}

#[test]
fn the_schema_in_scenes_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/scene.schema.json");
    let schema = format!("{:#}\n", file::schema());
    if std::env::var_os("ABBE_BLESS").is_some() {
        std::fs::write(&path, &schema).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == schema, "scenes/scene.schema.json is out of date: run this test with ABBE_BLESS=1");
}
