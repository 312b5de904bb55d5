//! Tests of parts, variables, groups and notes.

use crate::{JsonSource, SceneFile, parse};
use abbe_spectra::error::Error;
use std::path::Path;

/// A scene without objects and materials, to which `sections` are added.
fn scene(sections: &str) -> String {
    format!(
        r#"{{"camera": {{"from": [0, 0, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
 "film": {{"width": 8, "height": 8}},
 "lights": [{{"environment": {{"spectrum": "D65", "illuminance": 1000}}}}],
 {sections}}}"#
    )
}

fn read(sections: &str) -> (SceneFile, JsonSource) {
    parse(scene(sections), Path::new("scene.json"), &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn error(sections: &str) -> String {
    parse(scene(sections), Path::new("scene.json"), &[]).unwrap_err().to_string()
}

const MATERIALS: &str = r#""materials": {"red": {"diffuse": {"reflectance": 0.5}}}"#;

#[test]
fn a_group_adds_its_transform_and_motion_to_its_objects() {
    let grouped = read(&format!(
        r#"{MATERIALS}, "objects": [
  {{"shape": {{"sphere": {{"radius": 9}}}}, "material": "red"}},
  {{"name": "table", "note": "moved", "transform": [{{"translate": [0, 0, 2]}}],
    "motion": [{{"time": 0, "transform": []}}, {{"time": 1, "transform": [{{"translate": [1, 0, 0]}}]}}],
    "group": [
      {{"name": "top", "shape": {{"sphere": {{"radius": 1}}}}, "material": "red", "transform": [{{"scale": 2}}]}},
      {{"group": [{{"name": "leg", "shape": {{"sphere": {{"radius": 2}}}}, "material": "red"}}],
        "transform": [{{"rotate": {{"axis": [0, 1, 0], "degrees": 30}}}}]}},
      {{"shape": {{"sphere": {{"radius": 3}}}}, "material": "red", "transform": []}}]}}]"#
    ));
    let motion = r#""motion": [{"time": 0, "transform": []}, {"time": 1, "transform": [{"translate": [1, 0, 0]}]}]"#;
    let plain = read(&format!(
        r#"{MATERIALS}, "objects": [
  {{"shape": {{"sphere": {{"radius": 9}}}}, "material": "red"}},
  {{"name": "top", "shape": {{"sphere": {{"radius": 1}}}}, "material": "red",
    "transform": [{{"scale": 2}}, {{"translate": [0, 0, 2]}}], {motion}}},
  {{"name": "leg", "shape": {{"sphere": {{"radius": 2}}}}, "material": "red",
    "transform": [{{"rotate": {{"axis": [0, 1, 0], "degrees": 30}}}}, {{"translate": [0, 0, 2]}}], {motion}}},
  {{"shape": {{"sphere": {{"radius": 3}}}}, "material": "red", "transform": [{{"translate": [0, 0, 2]}}], {motion}}}]"#
    ));
    assert_eq!(grouped.0, plain.0);
    assert_eq!(grouped.1.compact(|_, _| true), plain.1.compact(|_, _| true), "the hash of the scene is the same");
    assert!(grouped.1.written().contains("\"group\"") && !grouped.1.text().contains("\"group\""));
}

#[test]
fn errors_in_a_group_have_the_position_in_the_file() {
    let group = |parts: &str| error(&format!("{MATERIALS}, \"objects\": [\n{{\"name\": \"a\",\n {parts}}}]"));
    let ball = r#"{"shape": {"sphere": {"radius": 1}}, "material": "red"}"#;
    for (parts, message) in [
        (r#""group": 3"#, "scene.json:6:11: objects[0].group: found 3; expected an array of objects"),
        (r#""group": []"#, "scene.json:6:11: objects[0].group: found an empty array; expected at least one object"),
        (
            r#""group": [], "tranform": []"#,
            "scene.json:6:15: objects[0].tranform: unknown key \"tranform\"; expected one of name, group, transform, \
             motion, note; did you mean \"transform\"?",
        ),
        (
            &format!("\"transform\": [{{\"scale\": 0}}],\n \"group\": [{ball}]"),
            "scene.json:6:26: objects[0].transform[0].scale: found 0; expected a number other than 0",
        ),
        (
            &format!("\"group\": [{ball},\n{}]", ball.replace("radius", "radus")),
            "scene.json:7:23: objects[1].shape.sphere.radus: unknown key \"radus\"; expected one of center, radius; did you \
             mean \"radius\"?",
        ),
        (
            &format!("\"motion\": [],\n\"group\": [{}]", ball.replace("}, \"m", "}, \"motion\": [], \"m")),
            "scene.json:7:58: objects[0].group[0].motion: found the motion of a part of a moving group; expected one \
             motion, of the group or of its parts",
        ),
    ] {
        assert_eq!(group(parts), message);
    }
}

#[test]
fn a_variable_stands_for_its_value() {
    let ball = |radius: &str, material: &str| {
        format!(r#""objects": [{{"shape": {{"sphere": {{"radius": {radius}}}}}, "material": {material}}}]"#)
    };
    let variables = r#""variables": {"size": 1.50, "paint": "red", "grey": {"diffuse": {"reflectance": 0.5}}}"#;
    let short = read(&format!(r#"{variables}, "materials": {{"red": "$grey"}}, {}"#, ball("\"$size\"", "\"$paint\"")));
    let long = read(&format!("{MATERIALS}, {}", ball("1.50", "\"red\"")));
    assert_eq!(SceneFile { variables: std::collections::BTreeMap::new(), ..short.0 }, long.0);
    let set = ["variables.size=2".to_string()];
    let text = scene(&format!("{variables}, {MATERIALS}, {}", ball("\"$size\"", "\"$paint\"")));
    let changed = parse(text, Path::new("scene.json"), &set).unwrap().1;
    assert!(changed.text().contains(r#""radius": 2}"#), "{}", changed.text());
    let (scene, _) = read(&format!(r#""title": "$5", {MATERIALS}, {}"#, ball("1", "\"red\"")));
    assert_eq!(scene.title.as_deref(), Some("$5"), "a scene without variables keeps its texts");

    let wrong = |variables: &str, radius: &str| {
        error(&format!("\"variables\": {variables},\n{MATERIALS},\n{}", ball(radius, "\"red\"")))
    };
    assert_eq!(
        wrong(r#"{"size": 1}"#, "\"$siz\""),
        "scene.json:6:45: objects[0].shape.sphere.radius: unknown variable \"siz\"; expected size; did you mean \"size\"?"
    );
    assert_eq!(
        wrong(r#"{"size": -1}"#, "\"$size\""),
        "scene.json:6:45: objects[0].shape.sphere.radius: found -1; expected a number above 0"
    );
    let nested = wrong(r#"{"a": "$b", "b": 1}"#, "\"$a\"");
    assert!(nested.contains("scene.json:4:21: variables.a: found \"$b\"; expected a value"), "{nested}");
    assert!(wrong("[]", "1").contains("expected an object of names and values"));
}

#[test]
fn a_scene_includes_parts() {
    let folder = tempfile::tempdir().unwrap();
    let part = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let path = folder.path().join("scene.json");
    let parsed = |sections: &str, sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
        parse(scene(sections), &path, &sets)
    };
    let failed = |sections: &str| {
        let message = parsed(sections, &[]).unwrap_err().to_string();
        message.replace(&format!("{}/", folder.path().display()), "")
    };
    part("paints.json", "{\"note\": \"paints\",\n\"materials\": {\"red\": {\"diffuse\": {\"reflectance\": 0.5}}}}");
    part(
        "balls.json",
        "{\"objects\": [\n{\"name\": \"b\", \"shape\": {\"sphere\": {\"radius\": 2}}, \"material\": \"red\"}]}",
    );
    let own = r#""objects": [{"shape": {"sphere": {"radius": 1}}, "material": "red"}]"#;
    let (scene, source) = parsed(&format!("\"include\": [\"paints.json\", \"balls.json\"], {own}"), &[]).unwrap();
    assert_eq!((scene.objects.len(), scene.materials.len(), scene.include.len()), (2, 1, 0));
    assert_eq!(scene.objects[1].name.as_deref(), Some("b"));
    let again = parse(source.compact(|_, _| true), Path::new("again.json"), &[]).unwrap().0;
    assert_eq!(again, scene, "the scene in a picture needs no parts");
    let (scene, _) =
        parsed("\"include\": [\"balls.json\", \"paints.json\"], \"objects\": []", &["objects.b.name=\"c\""]).unwrap();
    assert_eq!(scene.objects[0].name.as_deref(), Some("c"), "a patch may change a part");

    part("wrong.json", "{\"objects\": [\n{\"shape\": {\"sphere\": {\"radius\": -2}}, \"material\": \"red\"}]}");
    let message = failed(&format!("\"include\": [\"paints.json\", \"wrong.json\"], {own}"));
    assert_eq!(message, "wrong.json:2:33: objects[1].shape.sphere.radius: found -2; expected a number above 0");
    let message = failed(&format!("\"include\": [\"paints.json\"], {MATERIALS}, {own}"));
    assert!(message.starts_with("paints.json:2:15: ") && message.contains("second time"), "{message}");
    part("film.json", "{\"film\": {}}");
    part("key.json", "{\"material\": {}}");
    part("list.json", "{\"objects\": {}}");
    part("text.json", "{\"objects\": [}");
    for (include, words) in [
        ("\"paints.json\"", "scene.json:4:13: include: found \"paints.json\"; expected an array of names of files"),
        ("[3]", "scene.json:4:14: include[0]: found 3; expected the name of a file"),
        ("[\"../a.json\"]", "scene.json:4:14: include[0]: the path \"../a.json\" leads out of the folder"),
        ("[\"none.json\"]", "scene.json:4:14: include[0]: \"none.json\" cannot be read"),
        ("[\"film.json\"]", "film.json:1:2: unknown key \"film\"; expected one of variables, spectra"),
        ("[\"key.json\"]", "did you mean \"materials\"?"),
        ("[\"list.json\"]", "list.json:1:13: objects: found an empty object; expected an array"),
        ("[\"text.json\"]", "text.json:1:14: "),
    ] {
        let message = failed(&format!("\"include\": {include}, {own}"));
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn every_object_with_fixed_keys_may_have_a_note() {
    let noted = r#""materials": {"note": {"diffuse": {"reflectance": 0.5, "note": "a"}, "note": "b"}},
 "objects": [{"shape": {"sphere": {"radius": 1, "note": "c"}}, "material": "note", "note": "d",
   "transform": [{"note": "e", "translate": [0, 0, 1]}]}], "note": "f"#;
    let plain = r#""materials": {"note": {"diffuse": {"reflectance": 0.5}}},
 "objects": [{"shape": {"sphere": {"radius": 1}}, "material": "note", "transform": [{"translate": [0, 0, 1]}]}]"#;
    assert_eq!(read(&format!("{noted}\"")).0, read(plain).0);
    let message = error(&plain.replace("\"radius\": 1", "\"radius\": 1, \"note\": 2"));
    assert!(message.contains("unknown key \"note\""), "{message}");
    // A name may be `note`.
    let (scene, source) = read(&format!("\"spectra\": {{\"note\": \"D65\"}}, {plain}"));
    assert_eq!(scene.spectra.len(), 1);
    assert!(source.error_at("spectra.note", Error::input("x")).to_string().contains("scene.json:4:22"));
}
