//! Tests of what the reader of Mitsuba scenes states and keeps at the edges of its tables.

use super::tests::Imported;
use serde_json::json;

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
