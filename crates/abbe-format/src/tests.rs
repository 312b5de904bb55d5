//! Tests of reading scene files, also with random and systematic damage.

use super::*;
use crate::json::tests::TextDamage;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Returns the path and the text of each valid scene in the package.
pub(super) fn good_scenes() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folders = ["tests/good_scenes", "benches/scenes"].map(|folder| root.join(folder));
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|it| it == "json"));
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

/// Random damage gives an error with a position, or a valid scene, but never a panic.
#[test]
fn damaged_texts_give_errors_with_a_position() {
    let scenes = good_scenes();
    let mut random = TextDamage(1);
    let (mut refused, mut read) = (0, 0);
    for _ in 0..20_000 {
        let which = random.below(scenes.len());
        let text = random.damage(&scenes[which].1);
        match parse(&text, Path::new("scene.json"), &[]).map_err(|error| error.to_string()) {
            Err(error) => {
                refused += 1;
                assert!(error.starts_with("scene.json:"), "{error}");
                assert!(error.split(':').nth(1).is_some_and(|line| line.parse::<usize>().is_ok()), "{error}");
            }
            Ok(_) => read += 1,
        }
    }
    assert!(refused > 10_000 && read > 500, "the damage is too light or too heavy: {refused}, {read}");
}

/// Returns the paths of all values inside a value.
fn paths_of_values(value: &serde_json::Value, path: &JsonPath, paths: &mut Vec<String>) {
    let mut below = |value: &serde_json::Value, path: &JsonPath| {
        paths.push(path.to_string());
        paths_of_values(value, path, paths);
    };
    value.as_object().into_iter().flatten().for_each(|(key, value)| below(value, &path.key(key)));
    value.as_array().into_iter().flatten().enumerate().for_each(|(i, value)| below(value, &path.index(i)));
}

/// Returns the path and the text of each good scene, and the paths of its values. Paths that differ
/// from an earlier one only by the numbers of entries, in whichever scene, are left out.
pub(super) fn places_of_good_scenes() -> Vec<(PathBuf, String, Vec<String>)> {
    let mut known = HashSet::new();
    let mut is_new = |place: &String| known.insert(place.replace(|c: char| c.is_ascii_digit(), ""));
    let with_places = |(path, text): (PathBuf, String)| {
        let mut places = Vec::new();
        paths_of_values(&serde_json::from_str(&text).unwrap(), &JsonPath::Root, &mut places);
        places.retain(&mut is_new);
        (path, text, places)
    };
    good_scenes().into_iter().map(with_places).collect()
}

/// Values of all kinds in place of each value give a scene or an error with a position.
#[test]
fn any_value_in_any_place_gives_a_scene_or_an_error() {
    let anything = ["null", "true", "0", "-1", "1e300", "3.5", "\"x\"", "[]", "[1, 2, 3]", "{}", "{\"x\": 1}"];
    let (mut refused, mut read) = (0, 0);
    for (path, text, places) in places_of_good_scenes() {
        for place in places {
            for value in anything {
                match parse(&text, &path, &[format!("{place}={value}")]) {
                    Ok(_) => read += 1,
                    Err(error) => {
                        refused += 1;
                        // The error is in the patch, or in a value that the patch made invalid.
                        let in_patch = error.location.file == Some(format!("patch {place}").into());
                        let location = &error.location;
                        let in_file = location.file.as_ref() == Some(&path) && location.line_column.is_some();
                        assert!(in_patch || in_file, "{place}={value}: {error}");
                        assert!(!error.what.is_empty() && !error.to_string().contains("struct"), "{error}");
                    }
                }
            }
        }
    }
    assert!(refused > 5_000 && read > 1_000, "{refused}, {read}");
}

/// The good scenes contain every key and every name of the schema.
#[test]
fn the_good_scenes_cover_the_schema() {
    /// Collects the property names and the string constants that occur in a schema.
    fn collect(schema: &serde_json::Value, names: &mut Vec<String>) {
        if let Some(object) = schema.as_object() {
            for (key, value) in object {
                match (key.as_str(), value) {
                    ("properties", serde_json::Value::Object(properties)) => {
                        names.extend(properties.keys().cloned());
                        properties.values().for_each(|property| collect(property, names));
                    }
                    ("const", serde_json::Value::String(name)) => names.push(name.clone()),
                    _ => collect(value, names),
                }
            }
        }
        schema.as_array().into_iter().flatten().for_each(|schema| collect(schema, names));
    }
    let mut names = Vec::new();
    collect(&schema(), &mut names);
    let texts: String = good_scenes().into_iter().map(|(_, text)| text).collect();
    assert!(names.len() > 200, "{}", names.len());
    for name in names {
        assert!(texts.contains(&format!("\"{name}\"")), "no good scene has \"{name}\"");
    }
}

#[test]
fn a_file_that_cannot_be_read_is_an_input_error() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.json");
    let error = read(&missing, &[]).unwrap_err();
    assert_eq!(error.exit_status(), 2);
    assert!(error.to_string().starts_with(&format!("{}: cannot be read: ", missing.display())), "{error}");
    assert!(read(folder.path(), &[]).is_err());
    let large = folder.path().join("large.json");
    std::fs::File::create(&large).unwrap().set_len(MAX_BYTES + 1).unwrap();
    let expected = format!(
        "{}: found a file above 256 MiB; expected at most 256 MiB (put large data in separate files)",
        large.display()
    );
    assert_eq!(read(&large, &[]).unwrap_err().to_string(), expected);
}

#[test]
fn a_byte_order_mark_is_ignored() {
    let text = "\u{feff}{\"camera\": 1}";
    let error = parse(text, Path::new("scene.json"), &[]).unwrap_err().to_string();
    assert!(error.contains("scene.json:1:12: camera: found 1; expected an object with the keys from, at, "), "{error}");
}

#[test]
fn a_spectrum_can_be_read_without_a_scene() {
    let name = Path::new("the argument");
    let read = |text: &str| parse_spectrum(text, name).map(|(spectrum, _)| spectrum).map_err(|error| error.to_string());
    assert_eq!(read(r#"{"blackbody": {"temperature": 2856}}"#), Ok(SpectrumFile::Blackbody { temperature: 2856.0 }));
    assert_eq!(read("\"D65\""), Ok(SpectrumFile::Name("D65".into())));
    assert_eq!(
        read(r#"{"blackbody": {"temperature": -1}}"#).unwrap_err(),
        "the argument:1:31: blackbody.temperature: found -1; expected a number above 0"
    );
}

/// Whole numbers up to 2⁵³ may be written as floats, such as 1e6.
#[test]
fn whole_numbers_may_be_written_as_exact_floats() {
    let text = good_scenes().remove(0).1;
    let passes = |value: &str| {
        let sets = [format!("render={{\"passes\": {value}}}")];
        parse(&text, Path::new("scene.json"), &sets).map(|(scene, _)| scene.render.passes)
    };
    assert_eq!(passes("1e6").unwrap(), Some(1_000_000));
    assert_eq!(passes("64.0").unwrap(), Some(64));
    assert_eq!(passes("18446744073709551615").unwrap(), Some(u64::MAX));
    assert_eq!(passes("null").unwrap(), None);
    for refused in ["1.5", "1e30", "-1", "18446744073709551616"] {
        assert!(passes(refused).is_err(), "{refused}");
    }
}

#[test]
fn units_are_metres_by_default() {
    let metres =
        [UnitFile::default(), UnitFile::Centimetre, UnitFile::Millimetre, UnitFile::Micrometre].map(UnitFile::metres);
    assert_eq!(metres, [1.0, 0.01, 0.001, 1e-6]);
}
