//! Bad scenes: each file in `tests/bad_scenes` has one fault and gives one error. The file
//! `messages.txt` has the expected messages, sorted by file name. A scene whose fault
//! has two sides gives two lines.
//! `ABBE_BLESS=1` rewrites it.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use abbe::format;

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
    let list = folder.join("messages.txt");
    if std::env::var_os("ABBE_BLESS").is_some() {
        std::fs::write(&list, &found).unwrap();
    }
    let wanted = std::fs::read_to_string(&list).unwrap();
    for (found, wanted) in found.lines().zip(wanted.lines()) {
        assert_eq!(found, wanted);
    }
    assert_eq!(found.lines().count(), wanted.lines().count());
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(found.lines().any(|line| line.starts_with(&name)), "{name}");
    }
}
