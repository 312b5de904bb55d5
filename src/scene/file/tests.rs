//! Tests of the whole way from text to [`SceneFile`], with texts that were damaged at random or by rule.

use std::path::{Path, PathBuf};

use super::*;

/// The good scenes of the package: name and text.
fn good_scenes() -> Vec<(PathBuf, String)> {
    let folders = ["tests/good_scenes", "benches/scenes"].map(|it| Path::new(env!("CARGO_MANIFEST_DIR")).join(it));
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|it| it == "json"));
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

/// A random number generator (SplitMix64, Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    /// A whole number below `end`.
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % end as u64) as usize
    }

    /// One of several.
    fn one_of<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[self.below(choices.len())]
    }

    /// The text with one to three random changes: a piece left out, doubled, or replaced.
    fn damage(&mut self, text: &str) -> String {
        const PIECES: [&str; 30] = [
            "{",
            "}",
            "[",
            "]",
            ",",
            ":",
            "\"",
            "\\",
            "null",
            "true",
            "-",
            "0",
            "1e999",
            ".",
            "NaN",
            "//",
            "\u{0}",
            "\n",
            "λ",
            "\\u",
            "\\ud83c",
            "\\udf08",
            "e",
            "[[[[",
            "{\"a\":",
            "\"radius\":1,",
            "-1",
            "\u{feff}",
            "\t",
            "é\"",
        ];
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..=self.below(3) {
            let (from, length) = (self.below(bytes.len() + 1), self.below(12));
            let to = (from + length).min(bytes.len());
            match self.below(4) {
                0 => drop(bytes.drain(from..to)),
                1 => drop(bytes.splice(from..from, bytes[from..to].to_vec())),
                2 => drop(bytes.splice(from..from, self.one_of(&PIECES).bytes())),
                _ => drop(bytes.splice(from..to, self.one_of(&PIECES).bytes())),
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

#[test]
fn damaged_texts_never_panic_and_are_refused_where_serde_json_refuses_them() {
    let scenes = good_scenes();
    let mut random = Random(1);
    let (mut refused, mut read) = (0, 0);
    for _ in 0..20_000 {
        let which = random.below(scenes.len());
        let text = random.damage(&scenes[which].1);
        let error = parse(&text, Path::new("scene.json"), &[]).err().map(|error| error.to_string());
        let (scanned, strict) = (scan::scan(&text), serde_json::from_str::<serde_json::Value>(&text));
        let twice = matches!(&scanned, Err(malformed) if malformed.error.what.contains("a second time"));
        assert!(twice || scanned.is_ok() == strict.is_ok(), "{strict:?}, {error:?} in:\n{text}");
        match error {
            Some(error) => {
                refused += 1;
                assert!(error.starts_with("scene.json:"), "{error}");
                assert!(error.split(':').nth(1).is_some_and(|line| line.parse::<usize>().is_ok()), "{error}");
            }
            None => read += 1,
        }
    }
    assert!(refused > 10_000 && read > 1_000, "the damage is neither too light nor too heavy: {refused}, {read}");
}

#[test]
fn every_value_of_every_scene_can_be_replaced_by_anything_without_a_panic() {
    let anything = ["null", "true", "0", "-1", "1e300", "3.5", "\"x\"", "[]", "[1, 2, 3]", "{}", "{\"x\": 1}"];
    let (mut refused, mut read) = (0, 0);
    for (path, text) in good_scenes() {
        let positions = scan::scan(&text).unwrap();
        let root = positions.root(&text);
        let places = (1..positions.0.len() as u32).filter(|id| !root.is_key(*id)).map(|id| root.path_to(id));
        for place in places {
            for value in anything {
                match parse(&text, &path, &[format!("{place}={value}")]) {
                    Ok(_) => read += 1,
                    Err(error) => {
                        refused += 1;
                        // The error is in the patch, or names a value of the file that it made wrong.
                        let in_patch = error.place.file == Some(format!("--set {place}").into());
                        let in_file = error.place.file.as_ref() == Some(&path) && error.place.line_column.is_some();
                        assert!(in_patch || in_file, "{place}={value}: {error}");
                        assert!(!error.what.is_empty() && !error.to_string().contains("struct"), "{error}");
                    }
                }
            }
        }
    }
    assert!(refused > 5_000 && read > 1_000, "{refused}, {read}");
}

#[test]
fn every_key_and_every_name_of_the_schema_stands_in_a_good_scene() {
    /// Collects the keys of properties and the constants.
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
fn a_file_that_cannot_be_read_is_the_input_s_fault() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.json");
    let error = read(&missing, &[]).unwrap_err();
    assert_eq!(error.exit_status(), 2);
    assert!(error.to_string().starts_with(&format!("{}: cannot be read: ", missing.display())), "{error}");
    assert!(read(folder.path(), &[]).is_err());
    let large = folder.path().join("large.json");
    std::fs::File::create(&large).unwrap().set_len(MAX_BYTES + 1).unwrap();
    let expected = format!(
        "{}: found a file above 256 MiB; expected at most 256 MiB (put large data in files of their own)",
        large.display()
    );
    assert_eq!(read(&large, &[]).unwrap_err().to_string(), expected);
}

#[test]
fn a_byte_order_mark_is_left_out() {
    let text = "\u{feff}{\"camera\": 1}";
    let error = parse(text, Path::new("scene.json"), &[]).unwrap_err().to_string();
    assert!(
        error.starts_with("scene.json:1:12: camera: found 1; expected an object with the keys from, at, "),
        "{error}"
    );
}

#[test]
fn a_spectrum_reads_by_itself() {
    let name = Path::new("the argument");
    let read = |text: &str| parse_spectrum(text, name).map(|(spectrum, _)| spectrum).map_err(|error| error.to_string());
    assert_eq!(read(r#"{"blackbody": {"temperature": 2856}}"#), Ok(SpectrumFile::Blackbody { temperature: 2856.0 }));
    assert_eq!(read("\"D65\""), Ok(SpectrumFile::Name("D65".into())));
    assert_eq!(
        read(r#"{"blackbody": {"temperature": -1}}"#).unwrap_err(),
        "the argument:1:31: blackbody.temperature: found -1; expected a number above 0"
    );
}

#[test]
fn whole_numbers_may_be_written_as_floats_where_they_are_exact() {
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
