//! Tests of what the reader of Mitsuba scenes states and keeps at the edges of its tables.

use super::tests::Imported;
use serde_json::{Value, json};

const BALL: &str = r#"<shape type="sphere"/><emitter type="constant"/>"#;

/// A reflectance is 0 beyond its table. An index stays constant, because 0 has no meaning.
#[test]
fn tables_of_reflectances_are_dark_outside() {
    let body = r#"<shape type="sphere"><bsdf type="diffuse"><spectrum name="reflectance" value="500:0.2, 600:0.8"/>
        </bsdf></shape><shape type="sphere"><bsdf type="conductor"><spectrum name="eta" value="500:0.2, 600:0.8"/>
        <float name="k" value="3"/></bsdf></shape>"#;
    let scene = Imported::with_files(body, &[]).scene();
    let table = &scene["materials"]["diffuse"]["diffuse"]["reflectance"]["table"];
    assert_eq!(*table, json!({"nm": [499.99, 500.0, 600.0, 600.01], "values": [0.0, 0.2, 0.8, 0.0]}));
    let eta = &scene["materials"]["conductor"]["conductor"]["eta"]["table"];
    assert_eq!(eta["values"], json!([0.2, 0.8]));
}

/// Clip planes that may cut the scene, and integrators without indirect light, are named.
#[test]
fn settings_that_change_the_picture_are_named() {
    for (head, expected) in [
        (r#"<integrator type="direct"/>"#, "\"direct\""),
        (r#"<sensor type="perspective"><float name="near_clip" value="2"/></sensor>"#, "nearer than 2 "),
        (r#"<sensor type="perspective"><float name="far_clip" value="5"/></sensor>"#, "farther than 5 "),
    ] {
        let notes =
            Imported::whole(&format!("<scene version=\"3.0.0\">\n\n{head}{BALL}{SENSOR}</scene>"), &[]).left_out();
        assert!(notes.contains(expected) && notes.contains("a.xml:3"), "{notes}");
    }
    let usual = r#"<integrator type="path"/><sensor type="perspective"><float name="near_clip" value="0.1"/>
        <float name="far_clip" value="1000"/></sensor>"#;
    let notes = Imported::whole(&format!("<scene version=\"3.0.0\">{usual}{BALL}</scene>"), &[]).left_out();
    assert_eq!(notes, "");
}

/// A sensor for scenes whose first part has none.
const SENSOR: &str = r#"<sensor type="perspective"/>"#;

/// The vertex normals of a mesh decide to which side a light shines.
#[test]
fn a_light_shines_to_the_side_of_its_normals() {
    let mesh = |body: &str, normal: &str| {
        let quad = format!("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn 0 0 {normal}\nf 1//1 2//1 3//1 4//1\n");
        let shape = format!("<shape type=\"obj\"><string name=\"filename\" value=\"q.obj\"/>{body}</shape>");
        let imported = Imported::with_files(&shape, &[("q.obj", quad.as_bytes())]);
        (imported.scene()["objects"][0]["shape"]["mesh"].clone(), imported.left_out())
    };
    let light = "<emitter type=\"area\"><rgb name=\"radiance\" value=\"1,1,1\"/></emitter>";
    let (turned, notes) = mesh(light, "-1");
    assert_eq!((&turned["reverse"], &turned["flat"]), (&json!(true), &json!(true)), "{turned}");
    assert!(notes.contains("turned to the side of its vertex normals"), "{notes}");
    let flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    assert_eq!(mesh(&format!("{light}{flip}"), "-1").0["reverse"], Value::Null);
    for (body, normal) in [(light, "1"), ("", "-1")] {
        let (mesh, notes) = mesh(body, normal);
        assert_eq!((&mesh["reverse"], notes.contains("normals")), (&Value::Null, false), "{mesh}: {notes}");
    }
}
