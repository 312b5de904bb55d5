//! Collects the parts of a scene file while a scene of another program is read.

use crate::ImportedScene;
use crate::overlay::{AddedLights, ImportedNames};
use abbe_format::json::pretty;
use glam::DVec3;
use serde_json::{Map, Value, json};

/// The illuminance (lx) of the uniform sky if the file has no light.
const SKY_ILLUMINANCE: f64 = 1000.0;

/// The angular diameter (degrees) of the sun of a studio light. Its shadows have soft edges.
const STUDIO_SUN_DIAMETER: f64 = 20.0;

/// The traditional overcast sky, whose luminance is (1 + 2 sin γ)/3 of that of the zenith.
const TRADITIONAL_OVERCAST: u32 = 16;

/// The reflectance of the ground below a studio sky. It has the luminance of the overcast horizon,
/// 3/7 of that of a white ground, so that the horizon is not visible.
const STUDIO_GROUND: f64 = 3.0 / 7.0;

/// The parts of a scene file. All values have the form that the scene file has.
#[derive(Debug, Default)]
pub(super) struct SceneWriter {
    pub(super) camera: Value,
    pub(super) film: Value,
    /// The name of the medium outside all objects.
    pub(super) atmosphere: Option<String>,
    media: Map<String, Value>,
    materials: Map<String, Value>,
    shapes: Map<String, Value>,
    objects: Vec<Value>,
    lights: Vec<Value>,
    names: ImportedNames,
    /// What was left out: a sentence, its first place, and the number of occurrences.
    left_out: Vec<(String, String, usize)>,
    added: Vec<String>,
    /// True if a light was left out.
    pub(super) left_out_lights: bool,
    /// Sentences about what the mesh reader ignores.
    pub(super) ignored_by_meshes: Vec<String>,
}

impl SceneWriter {
    /// Adds a material, and returns its name: `wanted`, unless another material has it.
    pub(super) fn add_material(&mut self, wanted: &str, material: Value) -> String {
        add(&mut self.materials, wanted, material)
    }

    pub(super) fn material(&self, name: &str) -> Option<&Value> {
        self.materials.get(name)
    }

    /// Adds a material that covers the part `covered` of a surface, and returns its name. Light
    /// passes straight through the part `open`, which is a pane with the index of refraction 1.
    /// Returns `None` if the material encloses a space, or is a mix.
    pub(super) fn with_holes(&mut self, material: &str, covered: &Value, open: &Value) -> Option<String> {
        if covered.as_f64() == Some(1.0) {
            return Some(material.to_string());
        }
        if let Some(map) = self.materials.get(material).and_then(|form| form.get("normal_map")).cloned() {
            let inner = self.without_normal_map(material);
            let with_holes = self.with_holes(&inner, covered, open)?;
            return self.with_normal_map(&with_holes, map);
        }
        let encloses = |form: &Value| ["dielectric", "boundary", "mix"].iter().any(|key| form.get(key).is_some());
        if self.materials.get(material).is_some_and(encloses) {
            return None;
        }
        let hole = self.add_material("hole", json!({"thin_dielectric": {"ior": 1}}));
        if covered.as_f64() == Some(0.0) {
            return Some(hole);
        }
        let mix = json!({"mix": [{"material": material, "weight": covered}, {"material": hole, "weight": open}]});
        Some(self.add_material(&format!("{material} with holes"), mix))
    }

    /// Adds a material with a normal map, and returns its name. `map` holds the keys of the normal
    /// map besides `material`. Returns `None` if the material bounds a medium or has a normal map.
    pub(super) fn with_normal_map(&mut self, material: &str, mut map: Value) -> Option<String> {
        let has = |key: &str| self.materials.get(material).is_some_and(|form| form.get(key).is_some());
        if has("boundary") || has("normal_map") {
            return None;
        }
        map["material"] = json!(material);
        Some(self.add_material(&format!("{material} with normals"), json!({"normal_map": map})))
    }

    pub(super) fn without_normal_map(&self, material: &str) -> String {
        let inner = self.materials.get(material).and_then(|form| form["normal_map"]["material"].as_str());
        inner.unwrap_or(material).to_string()
    }

    pub(super) fn add_medium(&mut self, wanted: &str, medium: Value) -> String {
        add(&mut self.media, wanted, medium)
    }

    /// Adds a shape that several objects share, and returns its name.
    pub(super) fn add_shape(&mut self, wanted: &str, shape: Value) -> String {
        add(&mut self.shapes, wanted, shape)
    }

    pub(super) fn add_object(&mut self, object: Value) {
        self.objects.push(object);
    }

    /// Notes that the object that was added last has a material of a mesh file, with this name.
    pub(super) fn name_mesh_material(&mut self, name: &str) {
        if let Some(object) = self.objects.len().checked_sub(1) {
            self.names.mesh_materials.push((name.to_owned(), object));
        }
    }

    pub(super) fn add_light(&mut self, light: Value) {
        self.add_named_light([], light);
    }

    /// Adds a light. An overlay finds the light by any of its names. A light without a name is
    /// found by the word "light" and its position in the scene.
    pub(super) fn add_named_light<'a>(&mut self, names: impl IntoIterator<Item = &'a str>, light: Value) {
        let mut names: Vec<String> = names.into_iter().filter(|name| !name.is_empty()).map(str::to_owned).collect();
        if names.is_empty() {
            names.push(format!("light {}", self.lights.len()));
        }
        self.names.lights.push(names);
        self.lights.push(light);
    }

    pub(super) fn has_objects(&self) -> bool {
        !self.objects.is_empty()
    }

    /// Returns true if the scene has a light, or an object with emission.
    pub(super) fn has_light(&self) -> bool {
        !self.lights.is_empty() || self.objects.iter().any(|object| object.get("emission").is_some())
    }

    /// Adds a uniform sky, because the file has no light, or because all its lights were left out.
    pub(super) fn add_sky(&mut self) {
        let sky = json!({"environment": {"spectrum": "D65", "illuminance": SKY_ILLUMINANCE}});
        let reason = if self.left_out_lights { "all lights of the file are left out" } else { "the file has no light" };
        let note = format!("a uniform sky of {SKY_ILLUMINANCE} lx, because {reason}");
        self.add_surroundings(note, [("sky", sky)]);
    }

    /// Adds an overcast sky and a soft sun. `toward` is the direction of the sunlight. A surface
    /// that faces the sun has about the illuminance `lux`.
    pub(super) fn add_studio_light(&mut self, toward: DVec3, lux: f64, reason: &str) {
        let (sky_lux, sun_lux) = (0.5 * lux, 0.75 * lux);
        let sky =
            json!({"sky": {"type": TRADITIONAL_OVERCAST, "illuminance": sky_lux, "ground_reflectance": STUDIO_GROUND}});
        let sun = json!({"directional": {
            "toward": toward.to_array(), "angular_diameter": STUDIO_SUN_DIAMETER, "spectrum": "D65",
            "illuminance": sun_lux
        }});
        let note = format!("an overcast sky of {sky_lux} lx and a soft sun of {sun_lux} lx, because {reason}");
        self.add_surroundings(note, [("sky", sky), ("sun", sun)]);
    }

    /// Adds lights that the file lacks. Lights of an overlay replace them.
    fn add_surroundings<const N: usize>(&mut self, note: String, lights: [(&str, Value); N]) {
        let first = self.lights.len();
        self.names.added_lights = Some(AddedLights { positions: first..first + N, note: note.clone() });
        self.note_added(note);
        for (name, light) in lights {
            self.add_named_light([name], light);
        }
    }

    pub(super) fn note_added(&mut self, what: impl Into<String>) {
        self.added.push(what.into());
    }

    /// Notes what was left out or replaced at `place`, a file and a line. Equal notes are counted.
    pub(super) fn leave_out(&mut self, place: impl Into<String>, what: impl Into<String>) {
        let what = what.into();
        match self.left_out.iter_mut().find(|(known, ..)| *known == what) {
            Some((_, _, count)) => *count += 1,
            None => self.left_out.push((what, place.into(), 1)),
        }
    }

    /// Returns the converted scene. Entries without a value are absent.
    pub(super) fn finish(self, title: &str) -> ImportedScene {
        let Self { camera, film, atmosphere, media, materials, shapes, objects, lights, names, .. } = self;
        let mut scene = json!({"title": title, "unit": "m", "camera": camera, "film": film});
        if !media.is_empty() {
            scene["media"] = media.into();
        }
        scene["materials"] = materials.into();
        if !shapes.is_empty() {
            scene["shapes"] = shapes.into();
        }
        scene["objects"] = objects.into();
        if !lights.is_empty() {
            scene["lights"] = lights.into();
        }
        if let Some(name) = atmosphere {
            scene["atmosphere"] = name.into();
        }
        let sentence = |(what, place, count): (String, String, usize)| {
            let place = if place.is_empty() { String::new() } else { format!("{place}: ") };
            let times = if count > 1 { format!(" ({count} times)") } else { String::new() };
            format!("{place}{what}{times}")
        };
        ImportedScene {
            text: pretty(&scene),
            added: self.added,
            left_out: self.left_out.into_iter().map(sentence).collect(),
            ignored_by_meshes: self.ignored_by_meshes,
            names,
        }
    }
}

/// Adds an entry under `wanted`, or under `wanted` and a number if another entry has this name.
fn add(entries: &mut Map<String, Value>, wanted: &str, value: Value) -> String {
    let wanted = if wanted.is_empty() { "unnamed" } else { wanted };
    let numbered = (2..).map(|number| format!("{wanted} {number}"));
    let mut names = std::iter::once(wanted.to_string()).chain(numbered);
    let fits = |name: &String| entries.get(name).is_none_or(|known| *known == value);
    let name = names.find(fits).unwrap_or_else(|| wanted.to_string());
    entries.insert(name.clone(), value);
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_names_of_different_materials_are_numbered() {
        let mut scene = SceneWriter::default();
        let [white, black] = [1.0, 0.0].map(|r| json!({"diffuse": {"reflectance": r}}));
        let names = [&white, &black, &white, &black].map(|m| scene.add_material("paint", m.clone()));
        assert_eq!(names, ["paint", "paint 2", "paint", "paint 2"]);
        assert_eq!(scene.materials["paint 2"], black);
    }

    #[test]
    fn equal_remarks_are_counted_and_keep_their_first_place() {
        let mut scene = SceneWriter::default();
        for line in [3, 5, 9] {
            scene.leave_out(format!("a.pbrt:{line}"), "hair is left out");
        }
        scene.add_sky();
        assert!(scene.has_light());
        let imported = scene.finish("a");
        assert_eq!(imported.left_out, ["a.pbrt:3: hair is left out (3 times)"]);
        assert_eq!(imported.added.len(), 1);
    }
}
