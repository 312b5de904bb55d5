//! `abbe import`, and files of other programs in the place of scene files.

use crate::abbe_command::abbe;
use abbe_session::output::exr::read;
use serde_json::Value;

/// A glTF file with one triangle, whose positions are 0 0 0, 1 0 0 and 0 1 0. `nodes` are further
/// nodes, and `rest` contains further parts of the file.
fn gltf(nodes: &str, rest: &str) -> String {
    let positions = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0{}]}}], "nodes": [{{"mesh": 0}}{nodes}],
          "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
          "buffers": [{{"uri": "data:application/octet-stream;base64,{positions}", "byteLength": 36}}],
          "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
          "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}]{rest}}}"#,
        if nodes.is_empty() { "" } else { ", 1" }
    )
}

/// A bare file is rendered with an added camera and an added sky with a sun, and the notes say so.
/// `--strict` refuses it.
#[test]
fn a_gltf_file_is_rendered_by_one_command() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bare.gltf"), gltf("", "")).unwrap();
    let said = abbe(folder.path(), &["render", "bare.gltf", "--size", "24x16", "--passes", "1", "--photons", "1000"]);
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(
        said.err.contains("note: added a camera") && said.err.contains("note: added an overcast sky"),
        "{}",
        said.err
    );
    assert!(folder.path().join("bare.png").is_file());
    abbe(folder.path(), &["import", "bare.gltf", "--strict"])
        .is_error(2, &["bare.gltf", "an overcast sky of 500 lx and a soft sun of 750 lx"]);
    abbe(folder.path(), &["import", "bare.obj"]).is_error(2, &["bare.obj", ".gltf, .glb"]);
}

/// The loss of a texture is a warning, which names the file. `--quiet` prints warnings but no
/// notes.
#[test]
fn quiet_commands_print_the_loss_of_a_texture() {
    let folder = tempfile::tempdir().unwrap();
    let rest = r#", "materials": [{"name": "Pane", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}], "textures": [{"source": 0}],
        "images": [{"uri": "Textures/Dark%20Wood.png"}], "extensionsUsed": ["KHR_materials_transmission"]"#;
    let text = gltf("", rest).replace(r#""POSITION": 0}"#, r#""POSITION": 0}, "material": 0"#);
    std::fs::write(folder.path().join("a.gltf"), &text).unwrap();
    let render = ["render", "a.gltf", "--size", "4x4", "--passes", "1", "--photons", "100"];
    let loud = abbe(folder.path(), &render).err;
    let quiet = abbe(folder.path(), &[&render[..], &["--quiet"]].concat()).err;
    let lost = "warning: mesh \"a.gltf\": the image 0, \"Textures/Dark Wood.png\", cannot be used";
    let pane = "glass of an open mesh is a pane (3 open edges): material \"Pane\"";
    assert!(loud.contains(lost) && loud.contains(pane) && loud.contains("note: added a camera"), "{loud}");
    assert!(quiet.contains(lost) && !quiet.contains("note: "), "{quiet}");
    for command in ["check", "import"] {
        let said = abbe(folder.path(), &[command, "a.gltf"]).err;
        assert!(said.contains(pane) && said.contains("Textures/Dark Wood.png"), "{said}");
    }
    let no_data = text.replace("data:application/octet-stream;base64,", "mesh%20data.bin?");
    std::fs::write(folder.path().join("b.gltf"), no_data).unwrap();
    let said = abbe(folder.path(), &["check", "b.gltf"]);
    assert_eq!(said.status, 2);
    assert!(said.err.contains("the data file \"mesh data.bin"), "{}", said.err);
}

/// An imported scene file names the glTF file relative to its own folder, and can be checked.
#[test]
fn an_imported_scene_is_a_scene_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("models")).unwrap();
    let camera = r#", "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}]"#;
    let whole = gltf(r#", {"camera": 0, "translation": [0, 0, 5]}"#, camera);
    std::fs::write(folder.path().join("models/room.gltf"), whole).unwrap();
    let said = abbe(folder.path(), &["import", "models/room.gltf", "-o", "room.json"]);
    assert_eq!(said.status, 0, "{}", said.err);
    let text = std::fs::read_to_string(folder.path().join("room.json")).unwrap();
    let scene: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(scene["objects"][0]["shape"]["mesh"]["path"], "models/room.gltf");
    assert_eq!(scene["camera"]["from"], serde_json::json!([0.0, 0.0, 5.0]));
    assert_eq!(abbe(folder.path(), &["check", "room.json"]).status, 0);
    let below = ["import", "models/room.gltf", "-o", "models/below/room.json"];
    std::fs::create_dir(folder.path().join("models/below")).unwrap();
    abbe(folder.path(), &below).is_error(2, &["an output in the folder of the imported file", "--allow-outside"]);
    // With this option, the scene names the file by a path that leads out of its folder.
    assert_eq!(abbe(folder.path(), &[&below[..], &["--allow-outside"]].concat()).status, 0);
    let text = std::fs::read_to_string(folder.path().join("models/below/room.json")).unwrap();
    assert!(text.contains("\"../room.gltf\""), "{text}");
    assert_eq!(abbe(folder.path(), &["check", "models/below/room.json", "--allow-outside"]).status, 0);
}

/// A Mitsuba scene is rendered. The notes name the file and the line of what is left out.
#[test]
fn a_mitsuba_scene_is_rendered_by_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"<scene version="3.0.0">
        <sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/></film></sensor>
        <emitter type="constant"><rgb name="radiance" value="2"/></emitter>
        <shape type="sphere"><bsdf type="plastic"><float name="gloss" value="1"/></bsdf></shape>
    </scene>"#;
    std::fs::write(folder.path().join("ball.xml"), scene).unwrap();
    let said = abbe(folder.path(), &["render", "ball.xml", "--passes", "1", "--photons", "1000"]);
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.err.contains("note: ball.xml:5: `gloss` of <bsdf type=\"plastic\"> is left out"), "{}", said.err);
    assert!(folder.path().join("ball.png").is_file());
    std::fs::write(folder.path().join("drawing.xml"), "<svg/>").unwrap();
    abbe(folder.path(), &["render", "drawing.xml"]).is_error(2, &["drawing.xml:1:1", "<svg>", "<scene>"]);
}

/// Mitsuba 3.9.1 (`scalar_spectral`, 512 samples per pixel) gives these mean luminances for
/// `cornell.xml` and `prism.xml`. The pbrt files are translations of these scenes by hand. The mean
/// of a few passes agrees within 2 %.
#[test]
fn pbrt_scenes_have_the_luminance_of_their_mitsuba_originals() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/import/pbrt");
    for (name, expected) in [("cornell", 0.0708), ("prism", 1.1610)] {
        let file = format!("{name}.pbrt");
        std::fs::copy(scenes.join(&file), folder.path().join(&file)).unwrap();
        let said = abbe(folder.path(), &["render", &file, "--passes", "4"]);
        assert_eq!(said.status, 0, "{}", said.err);
        let mean = read(&folder.path().join(format!("{name}.exr"))).unwrap().picture.mean_y();
        assert!((mean / expected - 1.0).abs() < 0.02, "{name}: {mean} instead of {expected}");
    }
}
