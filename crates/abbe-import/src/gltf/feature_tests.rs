//! Tests of glTF features on small files: surroundings, cameras, colours, skins, morphs and films.

use super::*;
use crate::test_support::read_converted;
use abbe_format::resolve::resolve;
use abbe_optics::bsdf::Bsdf;
use abbe_scene::Scene;
use abbe_spectra::spectrum::Spectrum;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use tempfile::TempDir;

/// Builds a file with one mesh of one triangle, whose corners are 0 0 0, 1 0 0 and 0 1 0.
struct SmallGltf {
    bytes: Vec<u8>,
    views: Vec<Value>,
    root: Value,
}

impl SmallGltf {
    fn new() -> Self {
        let root = json!({
            "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "materials": [{}], "accessors": []
        });
        let mut builder = Self { bytes: Vec::new(), views: Vec::new(), root };
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        builder.accessor("VEC3", corners.as_flattened(), 3);
        builder.root["accessors"][0]["min"] = json!([0, 0, 0]);
        builder.root["accessors"][0]["max"] = json!([1, 1, 0]);
        builder
    }

    /// Adds data, and returns the number of its view.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// Adds an accessor of 32-bit numbers, and returns its number.
    fn accessor(&mut self, kind: &str, values: &[f32], count: usize) -> usize {
        let view = self.view(values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>().as_slice());
        self.push_accessor(json!({"bufferView": view, "componentType": 5126, "count": count, "type": kind}))
    }

    fn push_accessor(&mut self, accessor: Value) -> usize {
        let accessors = self.root["accessors"].as_array_mut().unwrap();
        accessors.push(accessor);
        accessors.len() - 1
    }

    /// Returns the imported scene, and the scene that Abbe resolves from it.
    fn import(mut self) -> (ImportedScene, Scene) {
        self.root["bufferViews"] = json!(self.views);
        let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.bytes));
        self.root["buffers"] = json!([{"uri": uri, "byteLength": self.bytes.len()}]);
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("a.gltf");
        std::fs::write(&path, self.root.to_string()).unwrap();
        let imported = import(&path, "", FileAccess::WithinFolder).unwrap();
        let (file, source) = read_converted(&path).unwrap();
        let scene = resolve(&file, &source).unwrap();
        (imported, scene)
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.root["meshes"][0]["primitives"][0]
    }
}

fn lights(imported: &ImportedScene) -> Vec<Value> {
    let scene: Value = serde_json::from_str(&imported.text).unwrap();
    scene["lights"].as_array().cloned().unwrap_or_default()
}

fn bounds(scene: &Scene) -> (DVec3, DVec3) {
    let (low, high) = scene.geometry.bounds();
    (low + scene.centre, high + scene.centre)
}

/// Without lights, a sky and a sun are added. If surfaces emit at most 1 cd/m², the added lights
/// are as weak. Brighter surfaces are lamps, and nothing is added.
#[test]
fn weak_emission_does_not_replace_lights() {
    let illuminance = |emission: Option<Value>| {
        let mut file = SmallGltf::new();
        if let Some(emission) = emission {
            file.root["materials"][0] = emission;
        }
        let (imported, _) = file.import();
        let of_sun = |light: &Value| light["directional"]["illuminance"].as_f64();
        (lights(&imported).iter().find_map(of_sun), imported.added)
    };
    let (sun, added) = illuminance(None);
    assert_eq!(sun, Some(750.0));
    assert!(
        added.contains(&"an overcast sky of 500 lx and a soft sun of 750 lx, because the file has no light".into())
    );
    let (sun, added) = illuminance(Some(json!({"emissiveFactor": [1, 0.5, 0]})));
    assert!((sun.unwrap() - 1.5).abs() < 1e-9, "{sun:?}");
    assert!(added.iter().any(|what| what.contains("its surfaces emit at most 1 cd/m²")), "{added:?}");
    let lamp = json!({"emissiveFactor": [1, 0.5, 0], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}});
    assert_eq!(illuminance(Some(lamp)).0, None);
}

/// The sun stands behind the left shoulder of the camera.
#[test]
fn the_added_sun_lights_what_the_camera_sees() {
    for (from, left) in [([0.0, 0.0, 5.0], DVec3::NEG_X), ([5.0, 2.0, 0.0], DVec3::Z)] {
        let toward = light_from_behind(&json!({"from": from, "at": [0, 0, 0]}));
        let view = -DVec3::from(from).normalize();
        assert!(toward.dot(view) > 0.3 && toward.y < -0.5 && toward.dot(left) < -0.3, "{from:?}: {toward}");
    }
    let above = light_from_behind(&json!({"from": [0, 5, 0], "at": [0, 0, 0]}));
    assert!(above.is_finite() && above.y < -0.5);
}

/// The picture is 4 m wide and 3 m high.
#[test]
fn orthographic_cameras_are_read() {
    let mut file = SmallGltf::new();
    file.root["cameras"] =
        json!([{"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1.5, "zfar": 9, "znear": 0.1}}]);
    file.root["nodes"] = json!([{"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]}]);
    file.root["scenes"] = json!([{"nodes": [0, 1]}]);
    let (imported, scene) = file.import();
    assert!(imported.left_out.is_empty(), "{imported:?}");
    let value: Value = serde_json::from_str(&imported.text).unwrap();
    assert_eq!(value["camera"]["lens"], json!({"orthographic": {"height": 3.0}}));
    assert_eq!(value["film"], json!({"width": 960, "height": 720}));
    let [width, height] = scene.camera.orthographic_size_m().unwrap();
    assert!((width - 4.0).abs() < 1e-12 && (height - 3.0).abs() < 1e-12);
}

/// Colours that differ become a picture over the triangles. Equal colours multiply the base colour.
#[test]
fn vertex_colours_multiply_the_base_colour() {
    let surface_of = |colours: [f32; 9]| {
        let mut file = SmallGltf::new();
        let colours = file.accessor("VEC3", &colours, 3);
        file.primitive()["attributes"]["COLOR_0"] = json!(colours);
        let base = json!({"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 1});
        file.root["materials"][0] = json!({"pbrMetallicRoughness": base});
        let (imported, scene) = file.import();
        assert!(imported.ignored_by_meshes.is_empty(), "{imported:?}");
        scene.materials[scene.objects[0].material].surface.clone()
    };
    let varied = surface_of([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    assert!(varied.is_textured() && matches!(varied, Bsdf::Diffuse(_)), "{varied:?}");
    // The first texel is red, multiplied by 0.5.
    let texture = varied.surface_spectra()[0];
    let red = Spectrum::rgb_reflectance([0.5, 0.0, 0.0]).unwrap();
    for nm in [450.0, 550.0, 650.0] {
        assert!((texture.at(0, nm) - red.at(nm)).abs() < 1e-3, "{nm} nm: {}", texture.at(0, nm));
    }
    let equal = surface_of([0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4]);
    assert!(!equal.is_textured());
    let reflectance = equal.surface_spectra()[0].at(0, 550.0);
    assert!((reflectance - 0.2).abs() < 1e-3, "{reflectance}");
}

/// The vertices follow the joints of a skin, and the transform of the mesh's own node is ignored.
#[test]
fn a_skin_places_its_mesh() {
    let mut file = SmallGltf::new();
    let matrix = |z: f64| glam::DMat4::from_translation(DVec3::new(0.0, 0.0, z)).to_cols_array().map(|x| x as f32);
    let matrices = file.accessor("MAT4", [matrix(-3.0), matrix(0.0)].as_flattened(), 2);
    // The first corner follows the first joint, the second the second, and the third both.
    let weights = file.accessor("VEC4", &[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0], 3);
    let joints = file.view(&[0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0]);
    let joints = file.push_accessor(json!({"bufferView": joints, "componentType": 5121, "count": 3, "type": "VEC4"}));
    file.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    file.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    file.root["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
        {"translation": [0, 0, 3], "children": [2]},
        {"translation": [2, 0, 0]}
    ]);
    file.root["scenes"] = json!([{"nodes": [0, 1]}]);
    file.root["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": matrices}]);
    let (imported, scene) = file.import();
    assert!(imported.left_out.is_empty() && imported.ignored_by_meshes.is_empty(), "{imported:?}");
    // The corners are (0, 0, 0), (1, 0, 0) + (2, 0, 3) and (0, 1, 0) + (1, 0, 1.5).
    let (low, high) = bounds(&scene);
    assert!((low - DVec3::ZERO).length() < 1e-9 && (high - DVec3::new(3.0, 1.0, 3.0)).length() < 1e-9, "{low} {high}");
}

/// The mesh's weights apply to its morph targets. The sparse data moves only the second corner.
#[test]
fn morph_targets_have_the_weights_of_the_file() {
    let mut file = SmallGltf::new();
    let indices = file.view(&1_u16.to_le_bytes());
    let values = file.view([0.0_f32, 0.0, 4.0].map(f32::to_le_bytes).as_flattened());
    let target = file.push_accessor(json!({
        "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 4],
        "sparse": {"count": 1, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}}
    }));
    file.primitive()["targets"] = json!([{"POSITION": target}]);
    file.root["meshes"][0]["weights"] = json!([0.25]);
    let (imported, scene) = file.import();
    assert!(imported.ignored_by_meshes.is_empty(), "{imported:?}");
    let (low, high) = bounds(&scene);
    assert!((low - DVec3::ZERO).length() < 1e-9 && (high - DVec3::new(1.0, 1.0, 1.0)).length() < 1e-9, "{low} {high}");
}

/// Polished and frosted glass get a film. Paint does not, and a note says so.
#[test]
fn thin_films_cover_glass() {
    let of = |transmission: f64, roughness: f64| {
        let mut file = SmallGltf::new();
        file.root["materials"][0] = json!({
            "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": roughness},
            "extensions": {
                "KHR_materials_transmission": {"transmissionFactor": transmission},
                "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceIor": 1.4, "iridescenceThicknessMaximum": 550}
            }
        });
        let (imported, scene) = file.import();
        (scene.materials[scene.objects[0].material].surface.clone(), imported.ignored_by_meshes.join("; "))
    };
    let (frosted, ignored) = of(1.0, 0.5);
    assert!(frosted.films().is_some() && !ignored.contains("thin films"), "{ignored}");
    let (pane, ignored) = of(1.0, 0.0);
    let layer = &pane.films().unwrap().layers()[0];
    assert_eq!((layer.thickness_nm.range(), ignored.as_str()), ((550.0, 550.0), ""));
    let (paint, ignored) = of(0.0, 0.0);
    assert!(paint.films().is_none() && ignored.contains("thin films on opaque surfaces"), "{ignored}");
}

/// A note says what is different, and only if the file uses it.
#[test]
fn notes_name_used_features_only() {
    let ignored = |material: Value| {
        let mut file = SmallGltf::new();
        file.root["materials"][0] = material;
        file.import().0.ignored_by_meshes.join("; ")
    };
    let anisotropy = |strength: f64| {
        json!({"extensions": {
            "KHR_materials_anisotropy": {"anisotropyStrength": strength}, "KHR_materials_sheen": {"sheenColorFactor": [0, 0, 0]} }})
    };
    assert_eq!(ignored(anisotropy(0.0)), "");
    assert!(ignored(anisotropy(0.5)).contains("highlights are round"));
    let light = |double_sided: bool| json!({"emissiveFactor": [1, 1, 0], "doubleSided": double_sided});
    assert_eq!(ignored(light(false)), "");
    assert!(ignored(light(true)).contains("double-sided lights"));
    let sheet = json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 1, 1]},
                       "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}});
    assert!(ignored(sheet).starts_with("on closed meshes, base colours"));
}

/// A hidden node hides the nodes below it.
#[test]
fn hidden_nodes_are_left_out() {
    let mut file = SmallGltf::new();
    file.root["scenes"][0]["nodes"] = json!([0, 1]);
    file.root["nodes"] = json!([
        {"mesh": 0, "name": "seen", "extensions": {"KHR_node_visibility": {"visible": true}}},
        {"extensions": {"KHR_node_visibility": {"visible": false}}, "children": [2]},
        {"mesh": 0, "name": "below"}
    ]);
    file.root["extensionsUsed"] = json!(["KHR_node_visibility"]);
    let text = file.import().0.text;
    assert!(text.contains("seen") && !text.contains("below"), "{text}");
}
