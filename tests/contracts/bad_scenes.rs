//! Bad scenes: each file in `tests/bad_scenes` has one fault and gives one error. The file
//! `messages.txt` has the expected messages, sorted by file name. A scene whose fault
//! has two sides gives two lines. `tests/bless` writes the file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::common::generated::is_up_to_date;
use abbe_format as format;

/// Returns the error message of a scene, without the folder in the file name.
fn message(path: &Path) -> String {
    let error = match format::read(path, &[]) {
        Ok(_) => panic!("{} has no fault", path.display()),
        Err(error) => error,
    };
    assert_eq!(error.exit_status(), 2, "{error}");
    let name = path.file_name().and_then(|name| name.to_str()).expect("the names are UTF-8");
    error.to_string().replace(&path.display().to_string(), name)
}

#[test]
fn each_bad_scene_gives_its_message() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let paths = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|it| it == "json")).collect();
    paths.sort();
    let mut found = String::new();
    paths.iter().for_each(|path| writeln!(found, "{}", message(path)).unwrap());
    is_up_to_date("tests/bad_scenes/messages.txt", &found);
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(found.lines().any(|line| line.starts_with(&name)), "{name}");
    }
}
