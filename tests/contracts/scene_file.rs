//! The scene file: all scenes of the package are valid, and the generated schema and reference are
//! up to date.

use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::{Path, PathBuf};

use abbe::format::{self, SceneFile};

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

/// Compares a generated file of the package with its new text.
fn is_up_to_date(path: &str, generated: &str, command: &str) {
    let kept = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap_or_default();
    assert!(kept == generated, "{path} is out of date; run: cargo run -- {command} > {path}");
}

#[test]
fn the_schema_in_scenes_is_up_to_date() {
    let generated = format!("{:#}\n", format::generated_schema());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/scene.schema.json");
    if std::env::var_os("ABBE_BLESS").is_some() {
        std::fs::write(&path, &generated).expect("the schema is written");
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(generated.as_bytes()).expect("memory does not fail");
        let packed = encoder.finish().expect("memory does not fail");
        std::fs::write(path.with_file_name("../data/scene.schema.json.gz"), packed).expect("the schema is written");
    }
    assert!(
        format!("{:#}\n", format::schema()) == generated,
        "the packed schema is out of date; run: ABBE_BLESS=1 tests/run --test contracts schema, and build again"
    );
    let kept = std::fs::read_to_string(&path).expect("the schema");
    assert!(
        kept == generated,
        "{} is out of date; run: ABBE_BLESS=1 tests/run --test contracts schema",
        path.display()
    );
}

#[test]
fn the_scene_reference_in_docs_is_up_to_date() {
    is_up_to_date("docs/reference/scene.md", &format::scene_reference(), "schema --markdown");
}
