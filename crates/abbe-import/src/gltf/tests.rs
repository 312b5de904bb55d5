//! Tests of the glTF importer on small files in text form.

use super::*;
use crate::test_support::{read_converted, small_png};
use abbe_format::resolve::resolve;
use abbe_scene::light::Emitter;
use abbe_spectra::spectrum::Observer;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use tempfile::TempDir;

/// Returns a glTF file with one textured triangle, further `nodes`, and further parts `rest`.
fn gltf(nodes: &str, rest: &str) -> String {
    let floats = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0];
    let buffer = STANDARD.encode(floats.map(f32::to_le_bytes).as_flattened());
    let picture = STANDARD.encode(small_png([[0, 0, 50], [200, 0, 50], [0, 200, 50], [200, 200, 50]]));
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0,
          "nodes": [{{"mesh": 0, "translation": [0, 0, -3]}}{nodes}],
          "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "material": 0}}]}}],
          "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "metallicFactor": 0.5}}}}],
          "textures": [{{"source": 0}}], "images": [{{"uri": "data:image/png;base64,{picture}"}}],
          "buffers": [{{"uri": "data:application/octet-stream;base64,{buffer}", "byteLength": 60}}],
          "bufferViews": [{{"buffer": 0, "byteLength": 36}}, {{"buffer": 0, "byteOffset": 36, "byteLength": 24}}],
          "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
            {{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}}
          ]{rest}}}"#
    )
}

fn imported(text: &str) -> (TempDir, std::path::PathBuf, ImportedScene) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let imported = import(&path, "", FileAccess::WithinFolder).unwrap();
    (folder, path, imported)
}

/// The camera and the lights of a file are those of the scene, and the material is textured.
#[test]
fn a_gltf_scene_keeps_its_camera_its_lights_and_its_texture() {
    let turned = "[0, 0.707106781, 0, 0.707106781]";
    let nodes = format!(
        r#", {{"camera": 0, "translation": [1, 2, 3], "rotation": {turned}}},
          {{"translation": [0, 5, 0], "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}},
          {{"rotation": {turned}, "extensions": {{"KHR_lights_punctual": {{"light": 1}}}}}}"#
    );
    let rest = r#", "scenes": [{"nodes": [0, 1, 2, 3]}], "extensionsUsed": ["KHR_lights_punctual"],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 2, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "spot", "intensity": 100, "color": [1, 0, 0], "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.3}},
            {"type": "directional", "intensity": 7}]}}"#;
    let (_folder, path, imported) = imported(&gltf(&nodes, rest));
    assert!(imported.added.is_empty() && imported.left_out.is_empty(), "{imported:?}");
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    let close = |value: &Value, expected: [f64; 3]| {
        let numbers = value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap());
        assert!(numbers.zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{value} instead of {expected:?}");
    };
    // A turn of 90° about +y maps −z to −x.
    close(&value["camera"]["from"], [1.0, 2.0, 3.0]);
    close(&value["camera"]["at"], [0.0, 2.0, 3.0]);
    assert!((value["camera"]["lens"]["pinhole"]["fov"].as_f64().unwrap() - 0.5_f64.to_degrees()).abs() < 1e-5);
    assert_eq!((&value["film"]["width"], &value["film"]["height"]), (&json!(960), &json!(480)));
    let spot = &value["lights"][0]["spot"];
    assert!((spot["luminous_intensity"].as_f64().unwrap() - 21.26).abs() < 1e-4, "{spot}");
    assert!((spot["penumbra"].as_f64().unwrap() - 0.2_f64.to_degrees()).abs() < 1e-4, "{spot}");
    close(&spot["to"], [0.0, 5.0, -1.0]);
    close(&value["lights"][1]["directional"]["toward"], [-1.0, 0.0, 0.0]);

    let (file, source) = read_converted(&path).unwrap();
    let scene = resolve(&file, &source).unwrap();
    let surface = &scene.materials[scene.objects[0].material].surface;
    assert!(surface.is_textured() && surface.components().count() == 2, "half metal, half matt");
}

/// The emission's picture is a slide, and its brightest factor the luminance. Normals keep a map.
#[test]
fn pictures_of_normals_and_of_emission_are_read() {
    let base = r#""pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.5}"#;
    let maps = r#""emissiveTexture": {"index": 0}, "emissiveFactor": [0.5, 0.25, 0.125], "normalTexture": {"index": 0,
        "scale": 0.5, "extensions": {"KHR_texture_transform": {"scale": [4, 4]}}}"#;
    let text = gltf("", r#", "scenes": [{"nodes": [0]}]"#).replace(base, &format!("{base}, {maps}"));
    let (_folder, path, imported) = imported(&text);
    assert!(imported.left_out.is_empty(), "{imported:?}");
    let scene = resolved(&path);
    let map = scene.materials[scene.objects[0].material].normal_map.as_ref().unwrap();
    assert_eq!(map.memory_bytes(), 4 * 12, "four texels of three numbers");
    let light = scene.lights.iter().find(|light| light.object().is_some()).unwrap();
    let Emitter::Area(emitter) = &light.emitter else { panic!("{light:?}") };
    let luminance = 683.002 * Observer::cie1931().xyz(&light.spectrum)[1] * emitter.radiance;
    assert!((luminance - 0.5).abs() < 1e-4, "{luminance}");
    // Under the factor (1, ½, ¼), the blue of the upper left texel is 50 / 255 · ¼ in linear sRGB.
    let blue = light.slide().unwrap().at(0, 450.0);
    assert!(blue > 0.003 && blue < 0.02, "{blue}");
}

/// A buffer outside the folder of the file is not read.
#[test]
fn a_gltf_scene_names_no_files_outside_its_folder() {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir(folder.path().join("below")).unwrap();
    let path = folder.path().join("below/a.gltf");
    let whole = gltf("", r#", "scenes": [{"nodes": [0]}]"#);
    let (start, rest) = whole.split_once("data:application/octet-stream;base64,").unwrap();
    let (data, end) = rest.split_once('"').unwrap();
    std::fs::write(folder.path().join("a.bin"), STANDARD.decode(data).unwrap()).unwrap();
    std::fs::write(&path, format!("{start}../a.bin\"{end}")).unwrap();
    let [within, anywhere] = [FileAccess::WithinFolder, FileAccess::Anywhere].map(|access| import(&path, "", access));
    assert!(within.unwrap_err().to_string().contains("leads out of the folder") && anywhere.is_ok());
}

/// A file without a camera and without a light gets a camera, a sky and a sun.
#[test]
fn a_bare_gltf_scene_gets_a_camera_and_lights() {
    let (_folder, path, imported) = imported(&gltf("", r#", "scenes": [{"nodes": [0]}]"#));
    assert_eq!(imported.added.len(), 2);
    let (file, source) = read_converted(&path).unwrap();
    let scene = resolve(&file, &source).unwrap();
    assert_eq!(scene.lights.len(), 2);
    // The ray through the middle of the film hits the triangle.
    let middle = glam::DVec2::new(480.0, 320.0);
    let ray = scene.camera.ray(middle, [0.5; 2]);
    assert!(scene.geometry.intersect(&ray, None, f64::INFINITY).is_some());
}

/// Adds an animation with the times 0, 1 and 2 s and three positions. Its first accessor is 2.
fn with_animation(text: &str, channels: &str, samplers: &str) -> String {
    let half = 0.5_f32.sqrt();
    let floats = [
        &[0.0_f32, 1.0, 2.0][..],
        &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 4.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half, 0.0, 1.0, 0.0, 0.0],
    ]
    .concat();
    let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    let buffer = STANDARD.encode(&bytes);
    let text = text.replace(
        r#""byteLength": 60}]"#,
        &format!(
            r#""byteLength": 60}}, {{"uri": "data:application/octet-stream;base64,{buffer}", "byteLength": 96}}]"#
        ),
    );
    let text = text.replace(
        r#""byteLength": 24}]"#,
        r#""byteLength": 24}, {"buffer": 1, "byteLength": 12}, {"buffer": 1, "byteOffset": 12, "byteLength": 36},
           {"buffer": 1, "byteOffset": 48, "byteLength": 48}]"#,
    );
    let accessors = r#""count": 3, "type": "VEC2"},
        {"bufferView": 2, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [2]},
        {"bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 4, "componentType": 5126, "count": 3, "type": "VEC4"}"#;
    let text = text.replace(r#""count": 3, "type": "VEC2"}"#, accessors);
    let end = text.rfind('}').unwrap();
    format!("{}, \"animations\": [{{\"channels\": [{channels}], \"samplers\": [{samplers}]}}]}}", &text[..end])
}

/// A channel of the sampler `sampler`, which moves the property `path` of a node.
fn channel(sampler: usize, node: usize, path: &str) -> String {
    format!(r#"{{"sampler": {sampler}, "target": {{"node": {node}, "path": "{path}"}}}}"#)
}

fn sampler(output: usize, interpolation: &str) -> String {
    format!(r#"{{"input": 2, "output": {output}, "interpolation": "{interpolation}"}}"#)
}

/// Resolves an imported file.
fn resolved(path: &Path) -> abbe_scene::Scene {
    let (file, source) = read_converted(path).unwrap();
    resolve(&file, &source).unwrap()
}

/// Nodes with the same mesh name the same part, so that they share its triangles and its material.
#[test]
fn nodes_with_one_mesh_name_the_same_part() {
    let nodes =
        r#", {"name": "Copy", "mesh": 0, "scale": [2, 2, 2], "children": [2]}, {"mesh": 0, "translation": [1, 0, 0]}"#;
    let (_folder, path, imported) = imported(&gltf(nodes, r#", "scenes": [{"nodes": [0, 1]}]"#));
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    let shapes: Vec<&Value> = value["objects"].as_array().unwrap().iter().map(|object| &object["shape"]).collect();
    assert_eq!(shapes, [&json!({"mesh": {"path": "a.gltf", "part": 0}}); 3]);
    assert_eq!(value["objects"][1]["name"], "Copy");
    assert_eq!(value["objects"][2]["transform"][0]["matrix"][0], json!([2.0, 0.0, 0.0, 2.0]));
    let scene = resolved(&path);
    assert_eq!(scene.objects.len(), 3);
    assert!(scene.objects.iter().all(|object| object.material == scene.objects[0].material));
}

/// A linear translation is exact, and its keyframes are those of the file.
#[test]
fn the_motion_of_a_node_has_the_keyframes_of_the_file() {
    let text = gltf("", r#", "scenes": [{"nodes": [0]}]"#);
    let text = with_animation(&text, &channel(0, 0, "translation"), &sampler(3, "LINEAR"));
    let (_folder, path, imported) = imported(&text);
    assert!(imported.left_out.is_empty(), "{imported:?}");
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    let motion = json!([
        {"time": 0.0, "transform": []},
        {"time": 1.0, "transform": [{"translate": [2.0, 0.0, 0.0]}]},
        {"time": 2.0, "transform": [{"translate": [2.0, 4.0, 0.0]}]}
    ]);
    assert_eq!(value["objects"][0]["motion"], motion);
    resolved(&path);
}

/// A step has two keyframes, and a rotation of 180° has one in the middle.
#[test]
fn steps_and_half_turns_are_unambiguous() {
    let text = gltf("", r#", "scenes": [{"nodes": [0]}]"#);
    let times = |interpolation: &str, path: &str, output: usize| {
        let text = with_animation(&text, &channel(0, 0, path), &sampler(output, interpolation));
        let (_folder, path, imported) = imported(&text);
        resolved(&path);
        let value: Value = serde_json::from_str(&imported.text).unwrap();
        let motion = value["objects"][0]["motion"].as_array().unwrap();
        motion.iter().map(|key| key["time"].as_f64().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(times("STEP", "translation", 3), [0.0, 1.0 - 1e-6, 1.0, 2.0 - 1e-6, 2.0]);
    assert_eq!(times("LINEAR", "rotation", 4), [0.0, 1.0, 2.0]);
}

/// The camera and the lights below an animated node move with it.
#[test]
fn cameras_and_lights_move_with_their_parents() {
    let nodes = r#", {"children": [2, 3]}, {"camera": 0, "translation": [0, 0, 5]},
        {"name": "Lamp", "translation": [0, 3, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}}"#;
    let rest = r#", "scenes": [{"nodes": [0, 1]}], "extensionsUsed": ["KHR_lights_punctual"],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 100}]}}"#;
    let text = with_animation(&gltf(nodes, rest), &channel(0, 1, "rotation"), &sampler(4, "LINEAR"));
    let (_folder, path, imported) = imported(&text);
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    // After a turn of 90° about +y, the camera is on +x and looks along −x.
    let key = &value["camera"]["motion"][8];
    assert!((number(&key["from"][0]) - 5.0).abs() < 1e-6 && (number(&key["at"][0]) - 4.0).abs() < 1e-6, "{key}");
    // On the way, the camera stays at the same distance from the axis.
    let between = &value["camera"]["motion"][4];
    let (x, z) = (number(&between["from"][0]), number(&between["from"][2]));
    assert!((x * x + z * z - 25.0).abs() < 1e-6, "{between}");
    let light = &value["lights"][0]["point"];
    assert_eq!((&light["at"], light["motion"].as_array().unwrap().len()), (&json!([0.0, 3.0, 0.0]), 3));
    resolved(&path);
}

/// A curve of third order is sampled, and passes through its keyframes.
#[test]
fn a_cubic_spline_is_sampled() {
    let text = gltf("", r#", "scenes": [{"nodes": [0]}]"#);
    // Three values make one keyframe of a spline: tangent, value, tangent.
    let text = with_animation(
        &text,
        &channel(0, 0, "translation"),
        r#"{"input": 5, "output": 3, "interpolation": "CUBICSPLINE"}"#,
    );
    let accessor = r#""type": "VEC4"}, {"bufferView": 2, "componentType": 5126, "count": 1, "type": "SCALAR", "min": [0], "max": [0]}"#;
    let (_folder, _path, imported) = imported(&text.replace(r#""type": "VEC4"}"#, accessor));
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    // One keyframe is no motion, but it replaces the translation at rest, (0, 0, -3).
    assert_eq!(value["objects"][0]["transform"], json!([{"translate": [2.0, 0.0, 0.0]}]));
}

/// A remark names each part without a counterpart, with its node and the consequence.
#[test]
fn what_is_left_out_is_listed() {
    let nodes = r#", {"name": "Ortho", "camera": 0}, {"name": "Flat", "mesh": 0, "scale": [0, 1, 1]},
        {"name": "Down", "extensions": {"EXT_lights_ies": {"light": 0}}},
        {"name": "Dim", "extensions": {"EXT_lights_ies": {"light": 0, "multiplier": 0.5}}}"#;
    let rest = r#", "scenes": [{"nodes": [0, 1, 2, 3, 4]}], "extensionsUsed": ["EXT_lights_ies"],
        "extensionsRequired": ["EXT_lights_ies"], "extensions": {"EXT_lights_ies": {"lights": [{"uri": "a%20b.ies"}]}},
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 1, "zfar": 9, "znear": 0.1}}]"#;
    let (_folder, _path, imported) = imported(&gltf(nodes, rest));
    let listed = |part: &str| imported.left_out.iter().any(|what| what.contains(part));
    assert!(listed("node \"Ortho\": an orthographic camera whose picture has no extent"), "{imported:?}");
    assert!(listed("node \"Flat\": a node with a scale of 0") && listed("node \"Dim\": the IES light"), "{imported:?}");
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    let expected = json!({"at": [0.0, 0.0, 0.0], "toward": [0.0, 0.0, -1.0], "path": "a b.ies", "spectrum": {"rgb": [1.0, 1.0, 1.0]}});
    assert_eq!(value["lights"], json!([{ "ies": expected }]));
}

/// An overlay finds the names of materials, nodes and lights.
#[test]
fn an_overlay_replaces_parts_of_a_gltf_scene() {
    let text = gltf("", r#", "scenes": [{"nodes": [0]}]"#)
        .replace(r#"[{"pbrMetallicRoughness""#, r#"[{"name": "Glass", "pbrMetallicRoughness""#);
    let (folder, path, imported) = imported(&text);
    let overlay = folder.path().join("overlay.json");
    std::fs::write(
        &overlay,
        r#"{"materials": {"Glass": {"dielectric": {"ior": "N-SF10"}}},
        "add": {"lights": [{"environment": {"spectrum": "D65", "illuminance": 5}}]}}"#,
    )
    .unwrap();
    let imported = imported.with_overlay(&overlay).unwrap();
    assert_eq!(imported.added.len(), 1, "the sky is replaced: {:?}", imported.added);
    let (file, source) = abbe_format::parse(&imported.text, &path, &[]).unwrap();
    let scene = resolve(&file, &source).unwrap();
    assert_eq!(scene.materials[scene.objects[0].material].name, "Glass");
    assert_eq!(scene.lights.len(), 1);
}

/// Files leave out optional keys, animate other properties, and require cosmetic extensions.
#[test]
fn optional_keys_and_harmless_extensions_are_accepted() {
    let rest = r#", "scenes": [{"nodes": [0]}, {"name": "empty"}],
        "extensionsUsed": ["KHR_materials_unlit", "KHR_materials_variants"],
        "extensionsRequired": ["KHR_materials_unlit", "KHR_materials_variants", "KHR_mesh_quantization"],
        "animations": [{"samplers": [{"input": 0, "output": 0}], "channels": [{"sampler": 0, "target": {"path": "pointer",
            "extensions": {"KHR_animation_pointer": {"pointer": "/materials/0"}}}}]}]"#;
    let unlit = r#"[{"extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness""#;
    let text = gltf("", rest).replace(r#"[{"pbrMetallicRoughness""#, unlit);
    let (_folder, path, imported) = imported(&text);
    assert_eq!(imported.left_out, ["animations of other properties than those of nodes are left out"]);
    assert!(imported.ignored_by_meshes.iter().any(|what| what.contains("KHR_materials_unlit")), "{imported:?}");
    resolved(&path);
}

/// Compressed geometry is refused with the name of the compression.
#[test]
fn compressed_geometry_is_refused() {
    for (rest, name) in [
        (
            r#", "extensionsRequired": ["EXT_meshopt_compression"], "scenes": [{"nodes": [0]}]"#,
            "EXT_meshopt_compression",
        ),
        (r#", "scenes": [{"nodes": [0]}]"#, "KHR_draco_mesh_compression"),
    ] {
        let mut text = gltf("", rest);
        if name.contains("draco") {
            let packed = r#""material": 0, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0}}"#;
            text = text.replace(r#""material": 0"#, packed);
        }
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("a.gltf");
        std::fs::write(&path, text).unwrap();
        let error = import(&path, "", FileAccess::WithinFolder).unwrap_err().to_string();
        assert!(error.contains(&format!("compressed by {name}")), "{error}");
    }
}

/// Each instance is an object. The transform of an instance is applied before that of the node.
#[test]
fn instances_of_a_node_become_objects() {
    let node = r#"{"mesh": 0, "translation": [0, 0, -3]"#;
    let instances = r#"{"mesh": 0, "translation": [0, 0, -3], "scale": [2, 2, 2],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}"#;
    let text = gltf("", r#", "scenes": [{"nodes": [0]}], "extensionsUsed": ["EXT_mesh_gpu_instancing"]"#);
    let (_folder, path, imported) = imported(&text.replace(node, instances));
    assert!(imported.left_out.is_empty(), "{imported:?}");
    let scene = resolved(&path);
    assert_eq!(scene.objects.len(), 3);
    // The accessor of the translations holds the corners (0, 0, 0), (1, 0, 0) and (0, 1, 0).
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    let second = &value["objects"][1]["transform"][0]["matrix"];
    assert_eq!((&second[0], &second[2]), (&json!([2.0, 0.0, 0.0, 2.0]), &json!([0.0, 0.0, 2.0, -3.0])));
    // An attribute that does not exist leaves one instance, and a note says so.
    let missing = instances.replace("TRANSLATION\": 0", "TRANSLATION\": 9");
    let (_folder, _path, imported) = self::imported(&text.replace(node, &missing));
    assert!(imported.left_out[0].contains("all instances but one are left out"), "{imported:?}");
}

/// Positions in normalized integers of 16 bits are the numbers divided by 32767.
#[test]
fn quantized_positions_are_read() {
    let words = [0_i16, 0, 0, 0, 32767, 0, 0, 0, 0, 16384, 0, 0];
    let buffer = STANDARD.encode(words.map(i16::to_le_bytes).as_flattened());
    let text = gltf("", r#", "scenes": [{"nodes": [0]}], "extensionsRequired": ["KHR_mesh_quantization"]"#);
    let (start, rest) = text.split_once("data:application/octet-stream;base64,").unwrap();
    let (_, rest) = rest.split_once('"').unwrap();
    let text = format!("{start}data:application/octet-stream;base64,{buffer}\"{rest}")
        .replace(r#""byteLength": 60"#, r#""byteLength": 24"#)
        .replace(
            r#""byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}"#,
            r#""byteLength": 24, "byteStride": 8}"#,
        )
        .replace(r#", "TEXCOORD_0": 1"#, "")
        .replace(
            r#""componentType": 5126, "count": 3, "type": "VEC3""#,
            r#""componentType": 5122, "normalized": true, "count": 3, "type": "VEC3""#,
        )
        .replace(
            r#",
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}"#,
            "",
        );
    let (_folder, path, _) = imported(&text);
    let scene = resolved(&path);
    let area = scene.geometry.area(0);
    assert!((area - 0.5 * 16384.0 / 32767.0).abs() < 1e-9, "{area}");
}

/// The diffuse colour of the specular-glossiness model is kept.
#[test]
fn specular_glossiness_is_converted() {
    let old = r#"[{"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.2, 0.4, 0.6, 1],
        "specularFactor": [0.04, 0.04, 0.04], "glossinessFactor": 0, "diffuseTexture": {"index": 0}}}, "pbrMetallicRoughness""#;
    let rest = r#", "scenes": [{"nodes": [0]}], "extensionsRequired": ["KHR_materials_pbrSpecularGlossiness"]"#;
    let (_folder, path, imported) = imported(&gltf("", rest).replace(r#"[{"pbrMetallicRoughness""#, old));
    assert!(imported.ignored_by_meshes.is_empty(), "{imported:?}");
    let scene = resolved(&path);
    let surface = &scene.materials[scene.objects[0].material].surface;
    assert!(surface.is_textured() && surface.components().count() == 1, "matt, and not half metal: {surface:?}");
}
