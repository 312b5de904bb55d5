use super::*;
use crate::test_support::read_converted;
use abbe_format::resolve::resolve;
use abbe_scene::geometry::Ray;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::f64::consts::PI;
use tempfile::TempDir;

/// A pbrt file with a camera at (0, 0, −5) that looks at the origin, and a point light.
fn scene(world: &str) -> String {
    format!(
        "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n\
         Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\nWorldBegin\n\
         LightSource \"point\" \"point3 from\" [0 3 -3]\n{world}\n"
    )
}

/// Converts a file. Its folder contains two empty pictures, which the importer does not read.
fn imported(text: &str) -> (TempDir, ImportedScene) {
    let folder = TempDir::new().unwrap();
    for name in ["leaf.png", "n.png"] {
        std::fs::write(folder.path().join(name), "").unwrap();
    }
    let path = folder.path().join("a.pbrt");
    std::fs::write(&path, text).unwrap();
    let imported = import(&path, "", FileAccess::WithinFolder);
    (folder, imported.unwrap())
}

fn value(text: &str) -> Value {
    let (folder, imported) = imported(text);
    // The text is a valid scene.
    read_converted(&folder.path().join("a.pbrt")).unwrap();
    serde_json::from_str(&imported.text).unwrap()
}

fn fault(text: &str) -> String {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.pbrt");
    std::fs::write(&path, text).unwrap();
    import(&path, "", FileAccess::WithinFolder).unwrap_err().to_string()
}

fn near(value: &Value, expected: f64) {
    let found = value.as_f64().unwrap_or(f64::NAN);
    assert!((found - expected).abs() < 1e-4 * (1.0 + expected.abs()), "{found} instead of {expected}");
}

/// A missing file is named with the place of the statement.
#[test]
fn missing_files_are_errors_with_a_place() {
    for statement in [
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"lost.png\"",
        "Shape \"plymesh\" \"string filename\" \"lost.ply\"",
        "LightSource \"infinite\" \"string filename\" \"lost.exr\"",
        "Material \"diffuse\" \"string normalmap\" \"lost.png\"",
    ] {
        let found = fault(&scene(statement));
        assert!(found.contains("a.pbrt: line 6: the file \"lost.") && found.contains("does not exist"), "{found}");
    }
}

/// The window is 4 high along the picture's shorter side, and the camera's scale scales it.
#[test]
fn orthographic_cameras_are_read() {
    let text = scene("Shape \"sphere\"").replace("\"perspective\" \"float fov\" 40", "\"orthographic\"");
    near(&value(&text)["camera"]["lens"]["orthographic"]["height"], 2.0);
    let window = text.replace("\"orthographic\"", "\"orthographic\" \"float screenwindow\" [-4 4 -2 2]");
    near(&value(&window)["camera"]["lens"]["orthographic"]["height"], 4.0);
    let scaled = window.replace("LookAt", "Scale 0.5 0.5 0.5 LookAt");
    near(&value(&scaled)["camera"]["lens"]["orthographic"]["height"], 8.0);
}

/// In pbrt, +x is to the right of a camera that looks along +z.
#[test]
fn the_picture_is_not_mirrored() {
    let text = scene("Translate 1 0 0 Shape \"sphere\" \"float radius\" .5");
    let (folder, _) = imported(&text);
    let (file, source) = read_converted(&folder.path().join("a.pbrt")).unwrap();
    let scene = resolve(&file, &source).unwrap();
    let hits = |x: f64| {
        let ray = scene.camera.ray(DVec2::new(x, 50.0), [0.5; 2]);
        scene.geometry.intersect(&ray, None, f64::INFINITY).is_some()
    };
    // tan 20° is half the height of the picture, so the sphere is 27 pixels to the right.
    assert!(hits(127.0) && !hits(73.0));
}

#[test]
fn the_field_of_view_belongs_to_the_shorter_side() {
    near(&value(&scene("Shape \"sphere\""))["camera"]["lens"]["pinhole"]["fov"], 40.0);
    let tall = scene("Shape \"sphere\"").replace("resolution\" 200", "resolution\" 50");
    let expected = 2.0 * (2.0 * 20_f64.to_radians().tan()).atan().to_degrees();
    near(&value(&tall)["camera"]["lens"]["pinhole"]["fov"], expected);
}

#[test]
fn attributes_and_transforms_are_nested() {
    let text = scene(
        "AttributeBegin Translate 0 1 0 ReverseOrientation Material \"conductor\" \
         Shape \"disk\" AttributeEnd Shape \"disk\"",
    );
    let value = value(&text);
    let objects = value["objects"].as_array().unwrap();
    let [a, b] = [0, 1].map(|i| &objects[i]);
    assert_eq!((&a["material"], &b["material"]), (&json!("conductor"), &json!("default")));
    near(&a["transform"][0]["matrix"][1][3], 1.0);
    near(&b["transform"][0]["matrix"][1][3], 0.0);
    // The disks face in opposite directions.
    near(&a["transform"][0]["matrix"][2][1], -b["transform"][0]["matrix"][2][1].as_f64().unwrap());
}

/// Returns whether the front of a shape is seen from +z, and whether it is seen from −z.
fn fronts(world: &str) -> [bool; 2] {
    let (folder, _) = imported(&scene(world));
    let (file, source) = read_converted(&folder.path().join("a.pbrt")).unwrap();
    let scene = resolve(&file, &source).unwrap();
    [DVec3::Z, DVec3::NEG_Z].map(|from| {
        let ray = Ray::new(3.0 * from + DVec3::new(0.2, 0.1, 0.0), -from);
        let hit = scene.geometry.intersect(&ray, None, f64::INFINITY).expect("the ray hits the shape");
        hit.normal.dot(from) > 0.0
    })
}

/// The front of a triangle is on the side of (b − a) × (c − a), also if the transform mirrors.
#[test]
fn triangles_and_disks_face_as_in_pbrt() {
    let triangle = r#"Shape "trianglemesh" "point3 P" [-2 -1 0  2 -1 0  0 2 0]"#;
    for (world, front) in [
        (triangle.to_string(), [true, false]),
        (format!("ReverseOrientation {triangle}"), [false, true]),
        (format!("Scale -1 1 1 {triangle}"), [true, false]),
        (format!(r#"{triangle} "normal N" [0 0 -1 0 0 -1 0 0 -1]"#), [false, true]),
        (r#"Shape "disk" "float radius" 2"#.into(), [true, false]),
        (r#"ReverseOrientation Shape "disk" "float radius" 2"#.into(), [false, true]),
        (r#"Shape "bilinearmesh" "point3 P" [-1 -1 0 1 -1 0 -1 1 0 1 1 0]"#.into(), [true, false]),
    ] {
        assert_eq!(fronts(&world), front, "{world}");
    }
}

/// RGB (1, 1, 1) is 1 cd/m², 1 cd or 1 lx, and a power is in lm.
#[test]
fn lights_have_the_photometric_units_of_pbrt() {
    let world = r#"
        LightSource "point" "rgb I" [2 2 2] "float scale" 3
        LightSource "point" "blackbody I" 3000 "float power" 100
        LightSource "distant" "point3 from" [0 1 0] "point3 to" [0 0 0] "float illuminance" 50
        LightSource "infinite" "rgb L" [0 1 0]
        LightSource "spot" "float coneangle" 40 "float conedeltaangle" 10
        AreaLightSource "diffuse" "float power" 10 "rgb L" [1 1 1]
        Scale 2 2 2 Shape "disk" "float radius" 0.5"#;
    let value = value(&scene(world));
    let lights = value["lights"].as_array().unwrap();
    near(&lights[0]["point"]["luminous_intensity"], 1.0);
    near(&lights[1]["point"]["luminous_intensity"], 6.0);
    near(&lights[2]["point"]["luminous_intensity"], 100.0 / (4.0 * PI));
    near(&lights[2]["point"]["spectrum"]["blackbody"]["temperature"], 3000.0);
    near(&lights[3]["directional"]["illuminance"], 50.0);
    near(&lights[4]["environment"]["luminance"], 0.7152);
    assert_eq!((&lights[5]["spot"]["half_angle"], &lights[5]["spot"]["penumbra"]), (&json!(40.0), &json!(10.0)));
    // A disk of radius 1 m with 10 lm.
    near(&value["objects"][0]["emission"]["luminance"], 10.0 / (PI * PI));
}

#[test]
fn materials_become_those_of_abbe() {
    let world = r#"
        Texture "t" "spectrum" "checkerboard" "rgb tex1" [1 0 0] "float uscale" 4
        MakeNamedMaterial "wood" "string type" "coateddiffuse" "texture reflectance" "t" "float roughness" .0625
        MakeNamedMaterial "gold" "string type" "conductor" "spectrum eta" "metal-Au-eta"
            "spectrum k" "metal-Au-k" "float roughness" .09 "bool remaproughness" false
        MakeNamedMaterial "both" "string type" "mix" "string materials" ["wood" "gold"] "float amount" .25
        NamedMaterial "both" Shape "sphere"
        Material "dielectric" "spectrum eta" "glass-F11" Shape "sphere" "float radius" .2
        Material "diffuse" "spectrum reflectance" [400 .2 700 .8] Shape "sphere" "float radius" .1"#;
    let materials = value(&scene(world))["materials"].clone();
    assert_eq!(materials["wood"]["glossy"]["interreflection"], true);
    near(&materials["wood"]["glossy"]["roughness"], 0.5);
    assert_eq!(materials["wood"]["glossy"]["reflectance"]["checker"]["uv"]["scale"], json!([4.0, -1.0]));
    assert_eq!(materials["gold"]["conductor"]["metal"], "gold");
    near(&materials["gold"]["conductor"]["roughness"], 0.3);
    near(&materials["both"]["mix"][0]["weight"], 0.75);
    assert_eq!(materials["dielectric"]["dielectric"]["ior"], "SF11");
    assert_eq!(materials["diffuse"]["diffuse"]["reflectance"]["table"]["values"], json!([0.0, 0.2, 0.8, 0.0]));
}

/// As in pbrt-v4, a file may use a named material before it defines it.
#[test]
fn a_material_may_be_defined_after_its_use() {
    let world = r#"
        AttributeBegin NamedMaterial "wood" Shape "sphere" AttributeEnd
        NamedMaterial "both" Shape "sphere" "float radius" .2
        MakeNamedMaterial "both" "string type" "mix" "string materials" ["wood" "wood"]
        MakeNamedMaterial "wood" "string type" "diffuse" "spectrum reflectance" [400 .2 700 .8]"#;
    let value = value(&scene(world));
    assert_eq!(value["materials"]["wood"]["diffuse"]["reflectance"]["table"]["values"], json!([0.0, 0.2, 0.8, 0.0]));
    assert_eq!((&value["objects"][0]["material"], &value["objects"][1]["material"]), (&json!("wood"), &json!("both")));
}

/// Opacity becomes a mix with a pane of index 1.
#[test]
fn opacity_becomes_holes() {
    let world = r#"
        Texture "leaf" "float" "imagemap" "string filename" "leaf.png"
        Material "diffuse" Shape "sphere" "texture alpha" "leaf" "float radius" .1
        Shape "sphere" "float alpha" 0
        Material "dielectric" Shape "sphere" "float alpha" .5"#;
    let (_, imported) = imported(&scene(world));
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    let mix = &value["materials"]["diffuse with holes"]["mix"];
    assert_eq!(mix[0]["weight"]["image"]["range"], json!([0.0, 1.0]));
    assert_eq!((&mix[1]["material"], &mix[1]["weight"]["image"]["range"]), (&json!("hole"), &json!([1.0, 0.0])));
    assert_eq!(value["objects"][1]["material"], "hole");
    assert_eq!((&value["objects"][2]["material"], imported.left_out.len()), (&json!("dielectric"), 1));
}

#[test]
fn normal_maps_keep_their_material() {
    let world = r#"
        MakeNamedMaterial "wall" "string type" "diffuse" "string normalmap" "n.png"
        MakeNamedMaterial "both" "string type" "mix" "string materials" ["wall" "wall"]
        NamedMaterial "wall" Shape "sphere" NamedMaterial "both" Shape "sphere" "float radius" .2"#;
    let (_, imported) = imported(&scene(world));
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    assert_eq!(value["materials"]["wall with normals"]["normal_map"], json!({"path": "n.png", "material": "wall"}));
    assert_eq!(value["objects"][0]["material"], "wall with normals");
    assert_eq!(value["materials"]["both"]["mix"][0]["material"], "wall");
    assert!(imported.left_out[0].contains("the normal map of the part \"wall\" of a mix is left out"));
}

#[test]
fn media_and_their_boundaries_are_read() {
    let world = r#"
        MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [0 0 0]
            "rgb sigma_s" [2 2 2] "float g" .5 "float scale" .1
        AttributeBegin Material "interface" MediumInterface "fog" "" Shape "sphere" AttributeEnd
        AttributeBegin Material "interface" Shape "sphere" AttributeEnd"#;
    let value = value(&scene(world));
    near(&value["media"]["fog"]["homogeneous"]["scattering"], 0.2);
    near(&value["media"]["fog"]["homogeneous"]["phase"]["henyey_greenstein"]["g"], 0.5);
    assert_eq!(value["objects"].as_array().unwrap().len(), 1, "a sphere of nothing is no object");
    assert_eq!(value["materials"]["boundary of fog"]["boundary"]["medium"], "fog");
}

#[test]
fn instances_are_placed_by_their_transform() {
    let world = r#"
        ObjectBegin "ball" Translate 1 0 0 Shape "sphere" ObjectEnd
        AttributeBegin Translate 0 2 0 ObjectInstance "ball" AttributeEnd
        AttributeBegin Scale 3 3 3 ObjectInstance "ball" AttributeEnd"#;
    let value = value(&scene(world));
    let column = |i: usize| {
        let matrix = &value["objects"][i]["transform"][0]["matrix"];
        [0, 1, 2].map(|row| matrix[row][3].as_f64().unwrap())
    };
    // The scene is mirrored in x.
    assert_eq!((column(0), column(1)), ([-1.0, 2.0, 0.0], [-3.0, 0.0, 0.0]));
}

#[test]
fn included_files_and_their_limits() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.pbrt");
    std::fs::write(&path, scene(r#"Include "b.pbrt""#)).unwrap();
    let read = || import(&path, "", FileAccess::WithinFolder);
    let error = read().unwrap_err().to_string();
    assert!(error.contains("line 6"), "{error}");
    std::fs::write(folder.path().join("b.pbrt"), r#"Shape "sphere""#).unwrap();
    assert!(read().is_ok());
    std::fs::write(folder.path().join("b.pbrt"), r#"Include "b.pbrt""#).unwrap();
    assert!(read().unwrap_err().to_string().contains("nested"));
    std::fs::write(&path, r#"Include "../b.pbrt""#).unwrap();
    assert!(read().unwrap_err().to_string().contains("folder"));
}

#[test]
fn what_is_left_out_is_listed_with_its_line() {
    let world = r#"Shape "curve" "point3 P" [0 0 0 1 0 0 1 1 0 1 1 1]
        Shape "curve" "point3 P" [0 0 0]
        Shape "sphere" "float radius" 1 "float colour" 2"#;
    let (_, imported) = imported(&scene(world));
    let expected = [
        r#"a.pbrt:6: shape "curve" is left out (2 times)"#,
        r#"a.pbrt:8: "float colour" of Shape "sphere" is left out"#,
    ];
    assert_eq!(imported.left_out, expected);
}

#[test]
fn errors_name_the_line() {
    for (text, expected) in [
        ("Camera", "line 1"),
        ("\nShape \"sphere\" \"float radius\" [1", "line 2"),
        (r#"Shape "sphere" "radius" 1"#, "type and the name"),
        (r#"Shape "sphere" "float radius" ["a"]"#, "numbers"),
        (r#"Shape "trianglemesh" "point3 P" [1 2]"#, "groups of 3"),
        ("Translate 1 2", "3 numbers"),
        ("AttributeEnd", "without a begin"),
        ("Sphere 1", "unknown directive"),
        (r#"NamedMaterial "x""#, "no material"),
        (r#"ObjectInstance "x""#, "no object"),
        (r#"Material "diffuse" "texture reflectance" "x""#, "no texture"),
        ("WorldBegin", "no shapes"),
        ("LookAt 0 0 0 0 0 0 0 1 0", "parallel"),
    ] {
        let error = fault(text);
        assert!(error.contains(expected), "{text}: {error}");
    }
}

/// A disk with a hole or with a texture has pbrt's texture coordinates: u is the angle, and v is 1
/// at the inner edge. Abbe's v points down.
#[test]
fn disks_keep_their_hole_and_their_coordinates() {
    let checker = "Texture \"c\" \"spectrum\" \"checkerboard\"\nMaterial \"diffuse\" \"texture reflectance\" \"c\"\n";
    let ring = value(&scene("Shape \"disk\" \"float radius\" 2 \"float innerradius\" 1 \"float phimax\" 180"));
    let triangles = &ring["objects"][0]["shape"]["triangles"];
    let rim = triangles["positions"].as_array().unwrap().len() - 1;
    near(&triangles["positions"][0][0], 1.0);
    near(&triangles["positions"][rim][0], -2.0);
    assert_eq!((&triangles["uv"][0], &triangles["uv"][rim]), (&json!([0.0, 0.0]), &json!([1.0, 1.0])));
    let whole = value(&scene(&format!("{checker}Shape \"disk\"")));
    assert!(whole["objects"][0]["shape"]["triangles"]["uv"].is_array(), "{whole}");
}

/// The attributes of textures hold for `Texture`. Each target has a known name.
#[test]
fn attributes_of_textures_are_applied() {
    let text = scene(
        "Attribute \"texture\" \"float uscale\" 4\nTexture \"c\" \"spectrum\" \"checkerboard\"\n\
         Material \"diffuse\" \"texture reflectance\" \"c\"\nShape \"sphere\"",
    );
    near(&value(&text)["materials"]["diffuse"]["diffuse"]["reflectance"]["checker"]["uv"]["scale"][0], 4.0);
    assert!(fault(&scene("Attribute \"shapes\" \"float radius\" 2")).contains("shape, light"));
}

/// The power of a two-sided light is halved, and the film's exposure multiplies all values.
#[test]
fn two_sided_power_and_exposure_are_known() {
    let light = |flag: &str| {
        let text = format!("AreaLightSource \"diffuse\" \"float power\" 100 {flag}\nShape \"disk\"");
        value(&scene(&text))["objects"][0]["emission"]["luminance"].as_f64().unwrap()
    };
    assert!((light("") / light("\"bool twosided\" true") - 2.0).abs() < 1e-12);
    let exposed = scene("Shape \"sphere\"").replace("\"rgb\"", "\"rgb\" \"float iso\" 200 \"float exposuretime\" 3");
    let left_out = imported(&exposed).1.left_out.join("\n");
    assert!(left_out.contains("6 times as large"), "{left_out}");
    let (_, forced) = imported(&format!("Option \"bool forcediffuse\" true\n{}", scene("Shape \"sphere\"")));
    assert!(forced.left_out.join("\n").contains("a.pbrt:1: the option"), "{:?}", forced.left_out);
}

/// The vertex normals of a PLY mesh decide to which side a light shines.
#[test]
fn a_mesh_light_shines_to_the_side_of_its_normals() {
    let folder = TempDir::new().unwrap();
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  property float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    let path = folder.path().join("a.pbrt");
    let world = "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\nShape \"plymesh\" \"string filename\" \"a.ply\"";
    std::fs::write(&path, scene(world)).unwrap();
    for (normal, turned) in [("0 0 1", Value::Null), ("0 0 -1", json!(true))] {
        let ply = format!("{header}0 0 0 {normal}\n1 0 0 {normal}\n0 1 0 {normal}\n3 0 1 2\n");
        std::fs::write(folder.path().join("a.ply"), ply).unwrap();
        let imported = import(&path, "", FileAccess::WithinFolder).unwrap();
        let value: Value = serde_json::from_str(&imported.text).unwrap();
        let mesh = &value["objects"][0]["shape"]["mesh"];
        assert_eq!((&mesh["reverse"], &mesh["flat"]), (&turned, &turned), "{mesh}");
        assert_eq!(imported.left_out.iter().any(|what| what.contains("vertex normals")), turned == json!(true));
    }
}

/// Windows editors begin files with a byte order mark.
#[test]
fn a_byte_order_mark_is_no_directive() {
    value(&format!("\u{feff}{}", scene("Shape \"sphere\"")));
}
