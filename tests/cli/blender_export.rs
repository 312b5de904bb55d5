//! A glTF file like the exports of Blender: a glass ball with dispersion and a tinted volume, a
//! textured floor, a glowing panel, copies of one mesh, a camera and three lights, below a node
//! that turns the scene.

use std::f64::consts::{PI, TAU};

use crate::abbe_command::abbe;
use serde_json::{Value, json};

/// The binary file while it is built.
#[derive(Default)]
struct GlbBuilder {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
}

impl GlbBuilder {
    /// Adds bytes, and returns the number of their view.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        self.views.push(json!({"buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len()}));
        self.buffer.extend(bytes);
        self.views.len() - 1
    }

    /// Adds an accessor of floats with `size` components.
    fn floats(&mut self, kind: &str, size: usize, values: &[f64]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
        let view = self.view(&bytes);
        let bound = |pick: fn(f64, f64) -> f64| -> Vec<f64> {
            let component = |i: usize| values.iter().skip(i).step_by(size).map(|&x| f64::from(x as f32)).reduce(pick);
            (0..size).filter_map(component).collect()
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": values.len() / size, "type": kind,
            "min": bound(f64::min), "max": bound(f64::max)
        }));
        self.accessors.len() - 1
    }

    /// Adds a mesh over a grid of texture coordinates. `surface` returns a position and a normal.
    fn mesh(&mut self, material: usize, cells: u32, surface: impl Fn(f64, f64) -> ([f64; 3], [f64; 3])) {
        let (mut positions, mut normals, mut uv, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for row in 0..=cells {
            for column in 0..=cells {
                let (u, v) = (f64::from(column) / f64::from(cells), f64::from(row) / f64::from(cells));
                let (position, normal) = surface(u, v);
                positions.extend(position);
                normals.extend(normal);
                uv.extend([u, v]);
                if row < cells && column < cells {
                    let [a, b] = [row, row + 1].map(|row| row * (cells + 1) + column);
                    indices.extend([a, b, a + 1, a + 1, b, b + 1]);
                }
            }
        }
        let bytes: Vec<u8> = indices.iter().flat_map(|index: &u32| index.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let attributes = json!({
            "POSITION": self.floats("VEC3", 3, &positions), "NORMAL": self.floats("VEC3", 3, &normals),
            "TEXCOORD_0": self.floats("VEC2", 2, &uv)
        });
        self.accessors
            .push(json!({"bufferView": view, "componentType": 5125, "count": indices.len(), "type": "SCALAR"}));
        let primitive = json!({"attributes": attributes, "indices": self.accessors.len() - 1, "material": material});
        self.meshes.push(json!({"primitives": [primitive]}));
    }
}

/// A sphere whose seam and poles are closed without rounding.
fn sphere(u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
    let u = u.fract();
    let (sin, cos) = if v <= 0.0 || v >= 1.0 { (0.0, 1.0 - 2.0 * v) } else { (PI * v).sin_cos() };
    let normal = [sin * (TAU * u).sin(), cos, sin * (TAU * u).cos()];
    (normal, normal)
}

fn square(u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
    ([2.0 * u - 1.0, 0.0, 2.0 * v - 1.0], [0.0, 1.0, 0.0])
}

/// Returns the bytes of the file.
pub(crate) fn blender_export() -> Vec<u8> {
    let mut file = GlbBuilder::default();
    file.mesh(0, 64, sphere);
    file.mesh(1, 1, square);
    file.mesh(2, 1, square);
    file.mesh(3, 24, sphere);
    let mut png = std::io::Cursor::new(Vec::new());
    let tile = |x: u32, y: u32| if (x / 8 + y / 8).is_multiple_of(2) { [205, 200, 190] } else { [60, 75, 95] };
    let picture = image::RgbImage::from_fn(64, 64, |x, y| image::Rgb(tile(x, y)));
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let picture = file.view(png.get_ref());
    let times = file.floats("SCALAR", 1, &[0.0, 1.0]);
    let places = file.floats("VEC3", 3, &[-1.6, 0.4, 0.2, -1.6, 1.4, 0.2]);
    // From +z to −y, as Blender turns its lights.
    let down = [-0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt()];
    let document = json!({
        "asset": {"version": "2.0", "generator": "Abbe's test of an export"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_ior",
            "KHR_materials_dispersion", "KHR_materials_emissive_strength", "KHR_materials_clearcoat", "KHR_materials_sheen"],
        "scene": 0, "scenes": [{"name": "Scene", "nodes": [0]}],
        "nodes": [
            {"name": "Root", "children": [1, 2, 3, 4, 5, 6, 7, 8, 9]},
            {"name": "Ball", "mesh": 0, "translation": [0, 0.8, 0], "scale": [0.8, 0.8, 0.8]},
            {"name": "Floor", "mesh": 1, "scale": [5, 1, 5]},
            {"name": "Panel", "mesh": 2, "translation": [0, 2.2, -3], "rotation": [0.5_f64.sqrt(), 0, 0, 0.5_f64.sqrt()], "scale": [1.2, 1, 0.4]},
            {"name": "Paint.001", "mesh": 3, "translation": [-1.6, 0.4, 0.2], "scale": [0.4, 0.4, 0.4]},
            {"name": "Paint.002", "mesh": 3, "translation": [1.6, 0.4, 0.2], "scale": [0.4, 0.4, 0.4]},
            {"name": "Camera", "camera": 0, "translation": [0, 1.6, 6.2], "rotation": [-0.0784591, 0, 0, 0.9969173]},
            {"name": "Sun", "rotation": [-0.5, 0.3, 0, 0.8], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"name": "Spot", "translation": [1.2, 4, 1.5], "rotation": down, "extensions": {"KHR_lights_punctual": {"light": 1}}},
            {"name": "Point", "translation": [-3, 3, 3], "extensions": {"KHR_lights_punctual": {"light": 2}}}
        ],
        "cameras": [{"name": "Camera", "type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 1.5, "znear": 0.1, "zfar": 100}}],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"name": "Sun", "type": "directional", "intensity": 300},
            {"name": "Spot", "type": "spot", "intensity": 5000, "color": [1, 0.8, 0.6], "spot": {"innerConeAngle": 0.3, "outerConeAngle": 0.5}},
            // Blender converts 100 W to candela: 100 × 683 / 4π.
            {"name": "Point", "type": "point", "intensity": 5435.14}
        ]}},
        "materials": [
            {"name": "Glass", "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0}, "extensions": {
                "KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.6},
                "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.6, 0.9, 0.8]},
                "KHR_materials_dispersion": {"dispersion": 0.6}}},
            {"name": "Floor", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.8}},
            {"name": "Panel", "emissiveFactor": [1, 1, 0.9], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2000}}},
            {"name": "Paint", "pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.05, 0.03, 1], "metallicFactor": 0, "roughnessFactor": 0.6},
                "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.05}, "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1]}}}
        ],
        "textures": [{"source": 0}], "images": [{"bufferView": picture, "mimeType": "image/png"}],
        "animations": [{"name": "Jump", "channels": [{"sampler": 0, "target": {"node": 4, "path": "translation"}}],
            "samplers": [{"input": times, "output": places, "interpolation": "LINEAR"}]}],
        "meshes": file.meshes, "accessors": file.accessors, "bufferViews": file.views, "buffers": [{"byteLength": file.buffer.len()}]
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    file.buffer.resize(file.buffer.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((28 + text.len() as u32 + file.buffer.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &file.buffer)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// The export is rendered by one command. The notes name what is left out.
#[test]
fn an_export_of_blender_is_rendered_by_one_command() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("room.glb"), blender_export()).unwrap();
    if let Some(kept) = std::env::var_os("ABBE_KEEP_EXPORT") {
        std::fs::write(kept, blender_export()).unwrap();
    }
    let said = abbe(folder.path(), &["render", "room.glb", "--size", "24x16", "--passes", "1", "--photons", "2000"]);
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.err.contains("KHR_materials_sheen (cloth has no bright rim)"), "{}", said.err);
    assert!(!said.err.contains("added"), "{}", said.err);

    let said = abbe(folder.path(), &["import", "room.glb"]);
    let scene: Value = serde_json::from_str(&said.out).unwrap();
    let names: Vec<&str> = scene["objects"].as_array().unwrap().iter().filter_map(|it| it["name"].as_str()).collect();
    assert_eq!(names, ["Ball", "Floor", "Panel", "Paint.001", "Paint.002"]);
    assert_eq!(scene["objects"][3]["shape"], scene["objects"][4]["shape"]);
    assert_eq!(scene["objects"][3]["motion"].as_array().unwrap().len(), 2);
    let candela = scene["lights"][2]["point"]["luminous_intensity"].as_f64().unwrap();
    assert!((candela - 5435.14).abs() < 0.01, "{candela}");
}

/// An overlay replaces a glass and a light by their names in the file, in every command that reads
/// scenes.
#[test]
fn an_overlay_changes_an_export_of_blender() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("room.glb"), blender_export()).unwrap();
    let write = |text: &str| std::fs::write(folder.path().join("overlay.json"), text).unwrap();
    write(
        r#"{"materials": {"Glass": {"dielectric": {"ior": "N-SF10"}}}, "lights": {"Sun": {"spectrum": "D65", "illuminance": 100000}}}"#,
    );
    let said = abbe(folder.path(), &["import", "room.glb", "--overlay", "overlay.json"]);
    let scene: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(scene["objects"][0]["material"], "Glass");
    assert_eq!(scene["lights"][0]["directional"]["illuminance"], 100_000);
    assert_eq!(abbe(folder.path(), &["check", "room.glb", "--overlay", "overlay.json"]).status, 0);
    write(r#"{"materials": {"Glas": "absorber"}}"#);
    let render = ["render", "room.glb", "--overlay", "overlay.json"];
    abbe(folder.path(), &render).is_error(2, &["overlay.json:1:24", "materials.Glas", "did you mean \"Glass\"?"]);
    std::fs::write(folder.path().join("scene.json"), &said.out).unwrap();
    abbe(folder.path(), &["check", "scene.json", "--overlay", "overlay.json"]).is_error(2, &["--set"]);
}
