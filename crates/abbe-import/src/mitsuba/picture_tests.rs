//! Tests of the pictures of Mitsuba scenes.

use super::tests::{Imported, close};
use crate::test_support::small_png;
use serde_json::{Value, json};

/// Returns a PNG file of one colour.
fn picture(colour: [u8; 3]) -> Vec<u8> {
    small_png([colour; 4])
}

#[test]
fn textures_keep_their_place() {
    let body = r#"<shape type="rectangle"><bsdf type="roughconductor"><string name="distribution" value="ggx"/>
        <texture name="alpha" type="checkerboard"><float name="color0" value="0.04"/><float name="color1" value="0.25"/>
        </texture><texture name="specular_reflectance" type="bitmap"><string name="filename" value="a.png"/>
        <boolean name="raw" value="true"/><string name="wrap_mode" value="clamp"/><string name="filter_type" value="nearest"/>
        <transform name="to_uv"><scale x="2" y="-3"/><rotate z="1" angle="90"/><translate x="0.5"/></transform>
        </texture></bsdf></shape>"#;
    let imported = Imported::with_files(body, &[("a.png", &picture([0, 0, 0]))]);
    let scene = imported.scene();
    let conductor = &scene["materials"]["roughconductor"]["conductor"];
    // For numbers, Mitsuba exchanges the two values.
    assert_eq!(conductor["roughness"], json!({"checker": {"a": 0.5, "b": 0.2, "scale": 2}}));
    let image = &conductor["reflectance"]["image"];
    let keys = ["encoding", "wrap", "filter"].map(|key| image[key].as_str().unwrap());
    assert_eq!(keys, ["linear", "clamp", "nearest"]);
    let uv = &image["uv"];
    close(&uv["scale"][0], 2.0);
    close(&uv["scale"][1], -3.0);
    close(&uv["rotate"], -90.0);
    close(&uv["offset"][0], 0.5);
    assert!(scene["objects"][0]["shape"]["triangles"]["uv"].is_array());
}

/// The normal map of a surface with holes is that of the mix, and that of a blend is left out.
#[test]
fn normal_maps_keep_their_material() {
    let normals = r#"<bsdf type="normalmap"><texture name="normalmap" type="bitmap"><boolean name="raw" value="true"/>
        <string name="filename" value="n.png"/></texture><bsdf type="plastic"/></bsdf>"#;
    let body = format!(
        r#"<shape type="rectangle">{normals}</shape>
        <shape type="rectangle"><bsdf type="mask"><float name="opacity" value="0.25"/>{normals}</bsdf></shape>
        <shape type="rectangle"><bsdf type="blendbsdf"><float name="weight" value="0.5"/>
        <bsdf type="diffuse"/>{normals}</bsdf></shape>"#
    );
    let imported = Imported::with_files(&body, &[("n.png", &picture([128, 128, 255]))]);
    let scene = imported.scene();
    let named = |name: &Value| &scene["materials"][name.as_str().unwrap()];
    let material = |object: usize| named(&scene["objects"][object]["material"]);
    assert_eq!(material(0)["normal_map"]["path"], "n.png");
    assert!(named(&material(0)["normal_map"]["material"])["glossy"].is_object());
    let mix = &named(&material(1)["normal_map"]["material"])["mix"];
    assert!(mix[0]["weight"] == 0.25 && named(&mix[0]["material"])["glossy"].is_object(), "{mix}");
    assert!(named(&material(2)["mix"][1]["material"])["glossy"].is_object(), "{}", material(2));
    assert!(imported.left_out().contains("the normal map of a part of a blend is left out"), "{}", imported.left_out());
}

/// A picture of radiance becomes a slide. The luminance belongs to its brightest component.
#[test]
fn pictures_of_radiance_become_slides() {
    let body = r#"<shape type="rectangle"><emitter type="area"><texture name="radiance" type="bitmap">
        <string name="filename" value="a.png"/></texture></emitter></shape>"#;
    let imported = Imported::with_files(body, &[("a.png", &picture([188, 0, 0]))]);
    let emission: Value = imported.scene()["objects"][0]["emission"].clone();
    // The linear value of 188 / 255 in sRGB is 0.5029.
    let peak = 0.502_886;
    assert!((emission["luminance"].as_f64().unwrap() - peak).abs() < 1e-5, "{emission}");
    assert!((emission["slide"]["image"]["factor"][0].as_f64().unwrap() - 1.0 / peak).abs() < 1e-4, "{emission}");
    // The light of a white texel has the same value at each wavelength, unless it filters D65.
    assert_eq!(emission["spectrum"], 1);
    assert_eq!(imported.left_out(), "");
    let filter = body.replace("<texture", r#"<texture name="radiance" type="d65"><texture"#);
    let filter = filter
        .replace("</texture>", "</texture></texture>")
        .replace(r#"<texture name="radiance" type="bitmap""#, r#"<texture type="bitmap""#);
    let imported = Imported::with_files(&filter, &[("a.png", &picture([188, 0, 0]))]);
    let spectrum = &imported.scene()["objects"][0]["emission"]["spectrum"];
    assert_eq!((spectrum, imported.left_out().as_str()), (&json!("D65"), ""));
}

/// A picture of radiance and a normal map need Mitsuba's texture coordinates as much as a picture
/// of reflectances. On a rectangle, the lower edge has v = 0. On a disk, u is the radius.
#[test]
fn every_kind_of_picture_has_mitsubas_coordinates() {
    let file = r#"type="bitmap"><string name="filename" value="a.png"/><boolean name="raw" value="true"/></texture>"#;
    let light = format!(r#"<emitter type="area"><texture name="radiance" {file}</emitter>"#);
    let normals = format!(r#"<bsdf type="normalmap"><texture name="normalmap" {file}<bsdf type="diffuse"/></bsdf>"#);
    let mask = format!(r#"<bsdf type="mask"><texture name="opacity" {file}<bsdf type="diffuse"/></bsdf>"#);
    for inside in [&light, &normals, &mask] {
        let body = format!(r#"<shape type="rectangle">{inside}</shape><shape type="disk">{inside}</shape>"#);
        let scene = Imported::with_files(&body, &[("a.png", &picture([128, 128, 255]))]).scene();
        let triangles = |object: usize| scene["objects"][object]["shape"]["triangles"].clone();
        assert_eq!((&triangles(0)["positions"][0], &triangles(0)["uv"][0]), (&json!([-1, -1, 0]), &json!([0, 0])));
        let disk = triangles(1);
        // A quarter turn from +x is +y.
        let quarter = 2 * (disk["uv"].as_array().unwrap().len() / 2 / 4) + 1;
        assert!((disk["positions"][quarter][1].as_f64().unwrap() - 1.0).abs() < 1e-9, "{}", disk["positions"][quarter]);
        assert_eq!(disk["uv"][quarter], json!([1.0, 0.25]));
    }
}

/// A principled base is brighter than its colour, unless it would reflect more than it receives.
#[test]
fn pictures_of_principled_surfaces_are_limited_to_1() {
    let factor = |colour: u8| {
        let body = r#"<shape type="rectangle"><bsdf type="principled"><texture name="base_color" type="bitmap">
            <string name="filename" value="a.png"/><boolean name="raw" value="true"/></texture></bsdf></shape>"#;
        let imported = Imported::with_files(body, &[("a.png", &picture([colour; 3]))]);
        let factor = &imported.scene()["materials"]["principled"]["glossy"]["reflectance"]["image"]["factor"][0];
        factor.as_f64().unwrap()
    };
    assert!((1.05..1.1).contains(&factor(102)), "{}", factor(102));
    assert!((factor(250) - 255.0 / 250.0).abs() < 1e-6, "{}", factor(250));
}
