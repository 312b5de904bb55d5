//! An overlay is a small JSON file that replaces or changes parts of a converted scene by name.

use abbe_format::json::{JsonPath, JsonSource, pretty, read_text};
use abbe_spectra::error::{Error, Result};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

/// The names of a converted scene that are not in the text of the scene file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ImportedNames {
    pub(super) lights: Vec<Vec<String>>,
    /// The name of a material in a mesh file, and the position of an object with this material.
    pub(super) mesh_materials: Vec<(String, usize)>,
    /// The lights that were added because the file has none.
    pub(super) added_lights: Option<AddedLights>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct AddedLights {
    /// The positions in the scene's list of lights.
    pub(super) positions: Range<usize>,
    pub(super) note: String,
}

pub(super) struct OverlaidScene {
    pub(super) text: String,
    /// True if lights of the overlay replace the lights that the importer added.
    pub(super) replaces_lights: bool,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct OverlayFile {
    camera: Option<Map<String, Value>>,
    film: Option<Map<String, Value>>,
    render: Option<Map<String, Value>>,
    atmosphere: Option<String>,
    spectra: Map<String, Value>,
    media: Map<String, Value>,
    materials: Map<String, Value>,
    lights: Map<String, Value>,
    objects: Map<String, Value>,
    add: AddedParts,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct AddedParts {
    lights: Vec<Value>,
    objects: Vec<Value>,
}

/// The keys that state how much light there is. At most one of them is present.
const QUANTITIES: [&str; 8] =
    ["power", "luminous_flux", "intensity", "luminous_intensity", "radiance", "luminance", "irradiance", "illuminance"];

const LIGHT_KINDS: [&str; 6] = ["point", "spot", "beam", "directional", "environment", "ies"];

/// Applies the overlay in the file `path` to the text of a scene file.
pub(super) fn apply(text: &str, names: &ImportedNames, path: &Path) -> Result<OverlaidScene> {
    let source = JsonSource::patched(read_text(path)?, path, &[])?;
    let overlay: OverlayFile = source.deserialize()?;
    let parsed = serde_json::from_str(text);
    let mut scene: Value = parsed.map_err(|error| Error::input(format!("the converted scene is not JSON: {error}")))?;
    let replaces_lights = names.added_lights.is_some() && !overlay.add.lights.is_empty();
    overlay.apply(&mut scene, names).map_err(|error| source.with_position(error))?;
    Ok(OverlaidScene { text: pretty(&scene), replaces_lights })
}

impl OverlayFile {
    fn apply(self, scene: &mut Value, names: &ImportedNames) -> Result<()> {
        let mut faults = Vec::new();
        self.materials(scene, names, &mut faults);
        self.objects(scene, &mut faults);
        self.lights(scene, names, &mut faults);
        for (key, changes) in [("camera", &self.camera), ("film", &self.film), ("render", &self.render)] {
            if let Some(changes) = changes {
                merge(&mut scene[key], changes);
            }
        }
        for (key, definitions) in [("spectra", &self.spectra), ("media", &self.media)] {
            for (name, definition) in definitions {
                scene[key][name] = definition.clone();
            }
        }
        if let Some(medium) = &self.atmosphere {
            scene["atmosphere"] = json!(medium);
        }
        extend(scene, "objects", &self.add.objects);
        extend(scene, "lights", &self.add.lights);
        Error::all(faults).map_or(Ok(()), Err)
    }

    /// Replaces materials. A material of a mesh file becomes a material of the scene.
    fn materials(&self, scene: &mut Value, names: &ImportedNames, faults: &mut Vec<Error>) {
        let used = self.used_materials();
        for (name, material) in &self.materials {
            let users: Vec<usize> =
                names.mesh_materials.iter().filter(|(known, _)| known == name).map(|(_, object)| *object).collect();
            if users.is_empty() && scene["materials"].get(name).is_none() && !used.contains(name.as_str()) {
                let in_scene = scene["materials"].as_object().into_iter().flat_map(Map::keys).map(String::as_str);
                let known = in_scene.chain(names.mesh_materials.iter().map(|(name, _)| name.as_str()));
                faults.push(unknown("materials", "material", name, known));
                continue;
            }
            scene["materials"][name] = material.clone();
            for object in users {
                scene["objects"][object]["material"] = json!(name);
            }
        }
    }

    fn used_materials(&self) -> BTreeSet<&str> {
        fn find<'v>(value: &'v Value, found: &mut BTreeSet<&'v str>) {
            match value {
                Value::Object(map) => {
                    found.extend(map.get("material").and_then(Value::as_str));
                    map.values().for_each(|value| find(value, found));
                }
                Value::Array(list) => list.iter().for_each(|value| find(value, found)),
                Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
            }
        }
        let mut found = BTreeSet::new();
        let parts = self.materials.values().chain(self.objects.values()).chain(&self.add.objects);
        parts.for_each(|value| find(value, &mut found));
        found
    }

    fn objects(&self, scene: &mut Value, faults: &mut Vec<Error>) {
        let mut none = Vec::new();
        let objects = scene["objects"].as_array_mut().unwrap_or(&mut none);
        for (name, changes) in &self.objects {
            let Some(changes) = changes.as_object() else {
                faults.push(not_an_object("objects", name));
                continue;
            };
            let mut is_known = false;
            for object in objects.iter_mut().filter(|object| object["name"] == json!(name)) {
                is_known = true;
                merge(object, changes);
            }
            if !is_known {
                let known = objects.iter().filter_map(|object| object["name"].as_str());
                faults.push(unknown("objects", "object", name, known));
            }
        }
    }

    /// Changes the lights with the stated names. Lights of the overlay replace the added sky.
    fn lights(&self, scene: &mut Value, names: &ImportedNames, faults: &mut Vec<Error>) {
        let mut none = Vec::new();
        let lights = scene["lights"].as_array_mut().unwrap_or(&mut none);
        for (name, changes) in &self.lights {
            let Some(changes) = changes.as_object() else {
                faults.push(not_an_object("lights", name));
                continue;
            };
            let named = |own: &Vec<String>| own.contains(name);
            let mut is_known = false;
            for (light, _) in lights.iter_mut().zip(&names.lights).filter(|(_, own)| named(own)) {
                is_known = true;
                change_light(light, changes);
            }
            if !is_known {
                let known = names.lights.iter().flatten().map(String::as_str);
                faults.push(unknown("lights", "light", name, known));
            }
        }
        if let Some(AddedLights { positions, .. }) = names.added_lights.as_ref().filter(|_| !self.add.lights.is_empty())
        {
            lights.drain(positions.start.min(lights.len())..positions.end.min(lights.len()));
        }
    }
}

/// Changes a light. If its only key is a kind of light, the kind changes, and not place and motion.
fn change_light(light: &mut Value, changes: &Map<String, Value>) {
    let Some((old_kind, old)) = light.as_object().and_then(|map| map.iter().next()) else { return };
    let (old_kind, mut form) = (old_kind.clone(), old.clone());
    let kind = changes.iter().next().filter(|(kind, _)| changes.len() == 1 && LIGHT_KINDS.contains(&kind.as_str()));
    let (kind, changes) = match kind {
        Some((kind, Value::Object(form))) => (kind.clone(), form),
        Some(_) | None => (old_kind.clone(), changes),
    };
    if kind != old_kind {
        form = placement(&form, &kind);
    }
    merge(&mut form, changes);
    *light = json!({ kind: form });
}

/// Returns the place of a light as that of a light of another kind.
fn placement(form: &Value, kind: &str) -> Value {
    let vector = |key: &str| {
        let numbers: Vec<f64> = form[key].as_array()?.iter().filter_map(Value::as_f64).collect();
        <[f64; 3]>::try_from(numbers).ok().map(glam::DVec3::from)
    };
    let at = vector("at").or_else(|| vector("from"));
    let toward = vector("toward").or_else(|| Some(vector("to")? - at?));
    let mut placed = json!({});
    let mut keep = |key: &str, value: Option<glam::DVec3>| {
        if let Some(value) = value {
            placed[key] = json!(value.to_array());
        }
    };
    match kind {
        "point" => keep("at", at),
        "spot" => {
            keep("at", at);
            keep("to", at.zip(toward).map(|(at, toward)| at + toward));
        }
        "beam" => {
            keep("from", at);
            keep("to", at.zip(toward).map(|(at, toward)| at + toward));
        }
        "ies" => {
            keep("at", at);
            keep("toward", toward);
        }
        "directional" => keep("toward", toward),
        _ => {}
    }
    for key in ["spectrum", "transform", "motion", "group"] {
        if let Some(value) = form.get(key) {
            placed[key] = value.clone();
        }
    }
    placed
}

/// Merges changes into a value, as in RFC 7396: `null` removes a key, and objects are merged. A
/// quantity of light replaces another quantity. A picture replaces a spectrum, and the other way
/// round. An object with one key, which selects a kind, replaces an object with another kind.
fn merge(value: &mut Value, changes: &Map<String, Value>) {
    if !value.is_object() {
        *value = json!({});
    }
    let Some(map) = value.as_object_mut() else { return };
    for group in [&QUANTITIES[..], &["spectrum", "image"]] {
        if changes.keys().any(|key| group.contains(&key.as_str())) {
            map.retain(|key, _| !group.contains(&key.as_str()));
        }
    }
    for (key, change) in changes {
        match (change, map.get_mut(key)) {
            (Value::Null, _) => {
                map.remove(key);
            }
            (Value::Object(change), Some(known)) if !is_other_kind(known, change) => merge(known, change),
            (Value::Object(_) | Value::Bool(_) | Value::Number(_) | Value::String(_) | Value::Array(_), _) => {
                map.insert(key.clone(), change.clone());
            }
        }
    }
}

fn is_other_kind(known: &Value, change: &Map<String, Value>) -> bool {
    let only = |map: &Map<String, Value>| map.keys().next().filter(|_| map.len() == 1).cloned();
    let known = known.as_object().and_then(only);
    known.is_some() && only(change).is_some() && known != only(change)
}

fn extend(scene: &mut Value, key: &str, values: &[Value]) {
    if values.is_empty() {
        return;
    }
    if !scene[key].is_array() {
        scene[key] = json!([]);
    }
    if let Some(list) = scene[key].as_array_mut() {
        list.extend(values.iter().cloned());
    }
}

fn unknown<'a>(key: &str, kind: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Error {
    let names: BTreeSet<&str> = known.into_iter().collect();
    let expected = match names.len() {
        0 => format!("no name, because the scene has no {key} with names"),
        1..=20 => format!("one of {}", names.iter().copied().collect::<Vec<_>>().join(", ")),
        count => format!("one of the {count} names of the scene; `abbe import` shows them"),
    };
    let root = JsonPath::Root;
    Error::unknown_name(kind, name, names).expected(expected).on_path(root.key(key).key(name).to_string())
}

fn not_an_object(key: &str, name: &str) -> Error {
    let root = JsonPath::Root;
    Error::input("found another value than an object")
        .expected("an object with the keys to change")
        .on_path(root.key(key).key(name).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> (String, ImportedNames) {
        let scene = json!({
            "camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 30}}},
            "film": {"width": 9, "height": 6},
            "materials": {"paint": {"diffuse": {"reflectance": 0.5}}},
            "objects": [{"name": "ball", "shape": {"mesh": {"path": "a.glb", "part": 0}}}, {"name": "wall", "material": "paint"}],
            "lights": [
                {"directional": {"toward": [0, -1, 0], "spectrum": {"rgb": [1, 1, 1]}, "irradiance": 3}},
                {"spot": {"at": [0, 2, 0], "to": [0, 1, 0], "half_angle": 30, "spectrum": "D65", "luminous_intensity": 5}}
            ]
        });
        let lights = vec![vec!["Sun".to_owned()], vec!["Node".to_owned(), "Lamp".to_owned()]];
        let mesh_materials = vec![("Glass".to_owned(), 0)];
        (scene.to_string(), ImportedNames { lights, mesh_materials, added_lights: None })
    }

    fn applied(overlay: &str) -> Result<Value> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("overlay.json");
        std::fs::write(&path, overlay).unwrap();
        let (text, names) = scene();
        apply(&text, &names, &path).map(|scene| serde_json::from_str(&scene.text).unwrap())
    }

    #[test]
    fn a_material_of_a_mesh_becomes_one_of_the_scene() {
        let scene = applied(
            r#"{"materials": {"Glass": {"dielectric": {"ior": "N-SF10"}}, "paint": {"mirror": {"reflectance": 1}}}}"#,
        );
        let scene = scene.unwrap();
        assert_eq!(scene["objects"][0]["material"], "Glass");
        assert_eq!(scene["materials"]["Glass"], json!({"dielectric": {"ior": "N-SF10"}}));
        assert_eq!(scene["materials"]["paint"], json!({"mirror": {"reflectance": 1}}));
    }

    #[test]
    fn a_light_keeps_its_place() {
        let overlay = r#"{"lights": {
            "Sun": {"spectrum": "D65", "illuminance": 100000},
            "Lamp": {"ies": {"path": "a.ies", "spectrum": "LED-B3"}}
        }}"#;
        let scene = applied(overlay).unwrap();
        let sun = json!({"directional": {"toward": [0, -1, 0], "spectrum": "D65", "illuminance": 100_000}});
        assert_eq!(scene["lights"][0], sun);
        let lamp = json!({"ies": {
            "at": [0.0, 2.0, 0.0], "toward": [0.0, -1.0, 0.0], "path": "a.ies", "spectrum": "LED-B3"
        }});
        assert_eq!(scene["lights"][1], lamp);
    }

    #[test]
    fn camera_film_and_objects_are_merged() {
        let overlay = r#"{
            "camera": {"lens": {"thin": {"fov": 30, "focus_distance": 5, "defocus_angle": 1}}, "at": [0, 1, 0]},
            "film": {"width": 90}, "objects": {"ball": {"emission": {"spectrum": "A", "power": 2}, "name": null}},
            "add": {"lights": [{"environment": {"spectrum": 1, "illuminance": 10}}]}
        }"#;
        let scene = applied(overlay).unwrap();
        assert_eq!(scene["camera"]["from"], json!([0, 0, 5]));
        assert!(scene["camera"]["lens"].get("pinhole").is_none(), "{scene}");
        assert_eq!(scene["film"], json!({"width": 90, "height": 6}));
        assert_eq!(scene["objects"][0]["emission"]["power"], 2);
        assert!(scene["objects"][0].get("name").is_none());
        assert_eq!(scene["lights"].as_array().unwrap().len(), 3);
    }

    /// An error names the position in the overlay and a similar name. All faults are reported.
    #[test]
    fn unknown_names_are_errors_with_suggestions() {
        let error = applied("{\"materials\": {\"Glas\": \"absorber\"},\n \"lights\": {\"Sunn\": {\"spectrum\": 1}}}");
        let error = error.unwrap_err();
        let text = error.to_string();
        assert!(text.contains("overlay.json:1:24") && text.contains("did you mean \"Glass\"?"), "{text}");
        assert!(error.others.iter().any(|fault| fault.to_string().contains("did you mean \"Sun\"?")), "{error:?}");
        assert!(applied(r#"{"material": {}}"#).unwrap_err().to_string().contains("material"));
        let used = r#"{"materials": {"new": "absorber"}, "objects": {"ball": {"material": "new"}}}"#;
        assert_eq!(applied(used).unwrap()["materials"]["new"], "absorber");
    }
}
