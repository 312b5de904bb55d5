//! Reads glTF scenes.
//!
//! A converted glTF scene names the glTF file as a mesh. The mesh reader reads the geometry, the
//! materials and the emission of surfaces. This module adds what a mesh lacks: the camera, the
//! lights and the film.

use std::f64::consts::PI;
use std::path::Path;

use ::gltf::camera::Projection;
use ::gltf::khr_lights_punctual::Kind;
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};

use super::{ImportedScene, SceneWriter};
use crate::error::Result;
use crate::format::FileAccess;
use crate::format::mesh::{self, MeshPart, gltf_nodes};

/// The width of the film in pixels.
const WIDTH: f64 = 960.0;

/// The ratio of width to height if the file states none.
const DEFAULT_ASPECT: f64 = 1.5;

/// The vertical field of view (degrees) of the camera if the file has none.
const DEFAULT_FOV: f64 = 35.0;

/// Reads a glTF file.
pub(super) fn import(path: &Path, folder: &str, file_access: FileAccess) -> Result<ImportedScene> {
    let file = mesh::load(path, file_access)?;
    let mut scene = SceneWriter::default();
    let mut camera = None;
    scene.ignored_by_meshes.extend(file.ignored);
    gltf_nodes(path, |node, to_world| {
        if let (None, Some(found)) = (&camera, node.camera()) {
            camera = perspective(&found.projection()).map(|lens| camera_file(lens, to_world));
            if camera.is_none() {
                scene.leave_out("", "an orthographic camera");
            }
        }
        if let Some(light) = node.light() {
            let place = to_world.translation.to_array();
            let direction = to_world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
            scene.add_light(light_file(&light, place, direction));
        }
    })?;
    let (camera, aspect) = camera.unwrap_or_else(|| {
        scene.note_added("a camera that sees the whole scene, because the file has none");
        (whole_view(&file.parts), DEFAULT_ASPECT)
    });
    let shines = |part: &MeshPart| part.material.as_ref().is_some_and(|own| own.emission.iter().any(|&c| c > 0.0));
    if !scene.has_light() && !file.parts.iter().any(shines) {
        scene.add_sky();
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    scene.camera = camera;
    scene.film = json!({"width": WIDTH as u32, "height": (WIDTH / aspect).round().clamp(1.0, 8.0 * WIDTH) as u32});
    scene.add_object(json!({"name": "mesh", "shape": {"mesh": {"path": format!("{folder}{name}")}}}));
    Ok(scene.finish(&name))
}

/// The vertical field of view in degrees and the ratio of width to height. `None` for an
/// orthographic camera.
fn perspective(projection: &Projection<'_>) -> Option<(f64, f64)> {
    match projection {
        Projection::Perspective(lens) => {
            let aspect = lens.aspect_ratio().map_or(DEFAULT_ASPECT, f64::from);
            Some((f64::from(lens.yfov()).to_degrees(), aspect.clamp(0.05, 20.0)))
        }
        Projection::Orthographic(_) => None,
    }
}

/// A glTF camera looks along −z of its node, and +y is up.
fn camera_file((fov, aspect): (f64, f64), to_world: &DAffine3) -> (Value, f64) {
    let from = to_world.translation;
    let direction = |local: DVec3| to_world.transform_vector3(local).normalize_or(local);
    let camera = json!({
        "from": from.to_array(), "at": (from + direction(DVec3::NEG_Z)).to_array(),
        "up": direction(DVec3::Y).to_array(), "lens": { "pinhole": { "fov": fov } }
    });
    (camera, aspect)
}

/// Returns a camera that sees all vertices of the file, from the front and slightly from above.
fn whole_view(parts: &[MeshPart]) -> Value {
    let points = || parts.iter().flat_map(|part| part.mesh.positions().iter().copied());
    let (low, high) =
        points().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| (low.min(point), high.max(point)));
    let (centre, radius) = (0.5 * (low + high), 0.5 * (high - low).length().max(f64::MIN_POSITIVE));
    let distance = 1.1 * radius / crate::math::elementary::sin(0.5 * DEFAULT_FOV.to_radians());
    let from = centre + distance * DVec3::new(0.4, 0.35, 1.0).normalize();
    json!({ "from": from.to_array(), "at": centre.to_array(), "lens": { "pinhole": { "fov": DEFAULT_FOV } } })
}

/// Converts a light. In glTF, intensities are in cd, and illuminances are in lx. The colour scales
/// them.
fn light_file(light: &::gltf::khr_lights_punctual::Light<'_>, at: [f64; 3], direction: DVec3) -> Value {
    let colour = light.color().map(|c| f64::from(c).max(0.0));
    let [r, g, b] = colour;
    let strength = f64::from(light.intensity()) * (0.2126 * r + 0.7152 * g + 0.0722 * b);
    let spectrum = if strength > 0.0 { json!({ "rgb": colour }) } else { json!("D65") };
    match light.kind() {
        Kind::Point => json!({ "point": { "at": at, "spectrum": spectrum, "luminous_intensity": strength } }),
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            let outer = f64::from(outer_cone_angle).clamp(1e-3, 0.5 * PI);
            let inner = f64::from(inner_cone_angle).clamp(0.0, outer);
            let to = (DVec3::from(at) + direction).to_array();
            json!({ "spot": {
                "at": at, "to": to, "half_angle": outer.to_degrees(), "penumbra": (outer - inner).to_degrees(),
                "spectrum": spectrum, "luminous_intensity": strength
            } })
        }
        Kind::Directional => {
            json!({ "directional": { "toward": direction.to_array(), "spectrum": spectrum, "illuminance": strength } })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{read, resolve::resolve};
    use base64::Engine as _;
    use base64::engine::general_purpose::STANDARD;
    use tempfile::TempDir;

    /// Returns a glTF file with one textured triangle. `nodes` are further nodes of the scene, and
    /// `rest` contains further parts of the file.
    fn gltf(nodes: &str, rest: &str) -> String {
        let floats = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0];
        let buffer = STANDARD.encode(floats.map(f32::to_le_bytes).as_flattened());
        let mut png = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([200 * x as u8, 200 * y as u8, 50]));
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let picture = STANDARD.encode(png.into_inner());
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

        let (file, source) = read(&path, &[]).unwrap();
        let scene = resolve(&file, &source).unwrap();
        let surface = &scene.materials[scene.objects[0].material].surface;
        assert!(surface.is_textured() && surface.components().count() == 2, "half metal, half matt");
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
        let [within, anywhere] =
            [FileAccess::WithinFolder, FileAccess::Anywhere].map(|access| import(&path, "", access));
        assert!(within.unwrap_err().to_string().contains("leads out of the folder") && anywhere.is_ok());
    }

    /// A file without a camera and without a light gets both.
    #[test]
    fn a_bare_gltf_scene_gets_a_camera_and_a_sky() {
        let (_folder, path, imported) = imported(&gltf("", r#", "scenes": [{"nodes": [0]}]"#));
        assert_eq!(imported.added.len(), 2);
        let (file, source) = read(&path, &[]).unwrap();
        let scene = resolve(&file, &source).unwrap();
        assert_eq!(scene.lights.len(), 1);
        // The ray through the middle of the film hits the triangle.
        let middle = glam::DVec2::new(480.0, 320.0);
        let ray = scene.camera.ray(middle, [0.5; 2]);
        assert!(scene.geometry.intersect(&ray, None, f64::INFINITY).is_some());
    }
}
