//! Tests of the schema and of the reference that is generated from it.

use crate::{JsonPath, parse, reference::CHAPTERS, scene_reference, schema};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const MINIMAL_SCENE: &str = r#"{
    "camera": {"from": [0, 1, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 35}}},
    "film": {"width": 64, "height": 64}, "materials": {"white": {"diffuse": {"reflectance": 0.5}}}, "objects": [],
    "meters": [{"name": "desk", "points": [[0, 1, 0]]}, {"name": "glare", "points": [[0, 1, 0]]}, {"name": "eye", "points": [[0, 1, 0]]}]
}"#;

/// For each definition with examples, the patch that puts one (`%`) into the minimal scene.
const PLACES: &str = r#"
CameraFile camera=%
CameraKeyframeFile camera.motion=[%]
ShutterFile camera.shutter=%
LensFile camera.lens=%
PrescriptionFile camera.lens={"system": {"prescription": %, "focus_distance": 4, "sensor_height_mm": 24}}
LensSurfaceFile camera.lens={"system": {"prescription": {"surfaces": [%]}, "focus_distance": 4, "sensor_height_mm": 24}}
FilmFile film=%
WhiteBalanceFile film.white_balance=%
BloomFile film.bloom=%
ExposureFile film.exposure=%
SpectrumFile spectra.x=%
SpectrumPathFile spectra.x={"file": %}
LineFile spectra.x={"lines": [%]}
WeightedSpectrumFile spectra.x={"mix": [%]}
ReflectanceFile materials.x.diffuse.reflectance=%
ScalarFile materials.x={"dielectric": {"ior": 1.5, "roughness": %}}
ColourImageFile materials.x={"diffuse": {"reflectance": {"image": %}}}
BandImageFile materials.x={"diffuse": {"reflectance": {"bands": %}}}
ScalarImageFile materials.x={"dielectric": {"ior": 1.5, "roughness": {"image": %}}}
UvFile materials.x={"diffuse": {"reflectance": {"image": {"path": "a.png", "uv": %}}}}
ImageFile lights=[{"environment": {"image": %, "irradiance": 1}}]
IndexFile materials.x.thin_dielectric.ior=%
MaterialFile materials.x=%
CoatingFile materials.x.thin_film=%
PaneTransmittanceFile materials.x.thin_dielectric.transmittance=%
MeterFile meters=[%]
MeterGridFile meters=[{"name": "m", "grid": %}]
MeterSphereFile meters=[{"name": "m", "sphere": %}]
MeterCylinderFile meters=[{"name": "m", "cylinder": %}]
MeterSpotFile meters=[{"name": "m", "spot": %}]
RequirementFile requirements=[%]
CoatingLayerFile materials.x={"thin_film": {"layers": [%]}}
CoatingIndexFile materials.x={"thin_film": {"layers": [{"ior": %, "thickness_nm": 10}]}}
ComplexIndexFile materials.x={"thin_film": {"layers": [{"ior": %, "thickness_nm": 10}]}}
PolarisingFilterFile camera.filter=%
PolariserFile materials.x.polariser=%
RetarderFile materials.x.retarder=%
StressFile materials.x.stress=%
LiquidCrystalFile materials.x={"filters": [{"liquid_crystal": %}]}
DiscFile materials.x.stress={"coefficient": 1e-11, "disc": %}
BeamFile materials.x.stress={"coefficient": 1e-11, "beam": %}
CircularPolariserFile materials.x.circular_polariser=%
GratingProfileFile materials.x={"grating": {"lines_per_mm": 600, "profile": %}}
OrderEfficiencyFile materials.x={"grating": {"lines_per_mm": 600, "profile": {"table": [%]}}}
WeightedMaterialFile materials.x={"mix": [%]}
MediumFile media.x=%
PhaseFile media.x.homogeneous={"absorption": 0, "scattering": 1, "phase": %}
IcePopulationFile media.x.homogeneous={"absorption": 0, "scattering": 1, "phase": {"ice_crystals": [%]}}
DyeFile media.x.homogeneous={"absorption": 0, "scattering": 1, "phase": "isotropic", "dye": %}
MediumEmissionFile media.x.homogeneous={"absorption": 0, "scattering": 1, "phase": "isotropic", "emission": %}
MediumBlackbodyFile media.x.homogeneous={"absorption": 0, "scattering": 1, "phase": "isotropic", "emission": {"blackbody": %}}
FieldFile media.x.grid={"density": %,
ExponentialFieldFile media.x.grid={"density": {"exponential": %},
PlanetFile media.x.grid={"density": {"exponential": {"value": 1, "scale_height": 1, "planet": %}},
SphereFieldFile media.x.grid={"density": {"sphere": %},
NoiseFieldFile media.x.grid={"density": {"noise": %},
ObjectFile objects=[%]
GroupFile objects=[%]
EmissionFile objects=[{"shape": {"disk": {"radius": 1}}, "material": "white", "emission": %}]
ShapeFile objects=[{"shape": %, "material": "white"}]
TransformFile objects=[{"shape": {"disk": {"radius": 1}}, "material": "white", "transform": %}]
TransformStepFile objects=[{"shape": {"disk": {"radius": 1}}, "material": "white", "transform": [%]}]
ScaleFile objects=[{"shape": {"disk": {"radius": 1}}, "material": "white", "transform": [{"scale": %}]}]
KeyframeFile objects=[{"shape": {"disk": {"radius": 1}}, "material": "white", "motion": [%]}]
LightFile lights=[%]
PlaceFile lights=[{"sky": {"type": 12, "illuminance": 1, "time": "2026-06-21T12:00:00+02:00", "place": %}}]
SunFile lights=[{"sky": {"type": 12, "illuminance": 1, "sun_elevation": 30, "sun": %}}]
RenderFile render=%
LightMapFile render.light_map=%"#;

/// Some patches in [`PLACES`] add a grid medium. These patches end with this text.
const GRID_END: &str = r#" "bounds": [[0, 0, 0], [1, 1, 1]], "absorption": 0, "scattering": 1, "phase": "isotropic"}"#;

/// Returns the name and the patch of each entry in [`PLACES`].
fn places() -> impl Iterator<Item = (&'static str, &'static str)> {
    PLACES.trim().lines().map(|line| line.split_once(' ').unwrap())
}

/// Returns all examples of a definition and of its variants.
fn examples(definition: &Value) -> Vec<&Value> {
    let forms = ["oneOf", "anyOf"].into_iter().filter_map(|key| definition[key].as_array()).flatten();
    let schemas = std::iter::once(definition).chain(forms);
    schemas.filter_map(|schema| schema["examples"].as_array()).flatten().collect()
}

/// Returns the text of a scene for each example of the schema.
fn example_scenes() -> Vec<String> {
    let schema = schema();
    let mut scenes: Vec<String> = examples(&schema).into_iter().map(Value::to_string).collect();
    for (name, place) in places() {
        let examples = examples(&schema["$defs"][name]);
        assert!(!examples.is_empty(), "{name} has no example");
        for example in examples {
            let end = if place.ends_with(',') { GRID_END } else { "" };
            let patch = place.replace('%', &example.to_string()) + end;
            match parse(MINIMAL_SCENE, Path::new("example"), std::slice::from_ref(&patch)) {
                Ok((_, source)) => scenes.push(source.text().to_string()),
                Err(error) => panic!("the example of {name} is wrong: {error}\n{patch}"),
            }
        }
    }
    scenes
}

#[test]
fn every_example_of_the_schema_is_valid() {
    let scenes = example_scenes();
    assert!(scenes.len() > 80, "{}", scenes.len());
    let schema = schema();
    let definitions = schema["$defs"].as_object().unwrap();
    let placed: BTreeSet<&str> = places().map(|(name, _)| name).collect();
    for (name, definition) in definitions {
        assert!(examples(definition).is_empty() || placed.contains(name.as_str()), "{name} has no place");
    }
    for scene in scenes {
        if let Err(error) = parse(&scene, Path::new("example"), &[]) {
            panic!("{error} in\n{scene}");
        }
    }
}

/// Each key has a description, and an example in the section of the key contains the key.
#[test]
fn every_key_has_a_description_and_an_example() {
    let page = scene_reference();
    let mut keys = 0;
    let sections = page.split("\n### ").skip(1).flat_map(|section| section.split("\n#### "));
    for section in sections {
        let section = section.split("\n## ").next().unwrap();
        let title = section.lines().next().unwrap();
        let example: String = section.split("```json").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
        for row in section.lines().filter(|line| line.starts_with("| `")) {
            let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
            if let [key, kind, _, default, _, meaning] = cells.as_slice() {
                keys += 1;
                assert!(example.contains(&format!("\"{}\"", key.trim_matches('`'))), "{title}: no example of {key}");
                assert!(!kind.is_empty() && !default.is_empty() && meaning.len() > 5, "{title}: {row}");
            }
        }
    }
    assert!(keys > 200, "{keys} keys");
}

/// Each definition has a section, and each link of the page leads to exactly one heading.
#[test]
fn the_reference_has_all_definitions_and_sound_links() {
    let schema = schema();
    let titled = schema["$defs"].as_object().unwrap().iter().filter(|(_, it)| it["title"].is_string());
    let titled: BTreeSet<&str> = titled.map(|(name, _)| name.as_str()).chain([""]).collect();
    let described: Vec<&str> = CHAPTERS.iter().flat_map(|(_, names)| names.split(' ')).collect();
    assert_eq!(described.len(), titled.len());
    assert_eq!(described.into_iter().collect::<BTreeSet<_>>(), titled);
    let page = scene_reference();
    let headings = page.lines().filter(|line| line.starts_with('#'));
    let anchors: Vec<String> = headings
        .map(|line| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-").replace('`', ""))
        .collect();
    for anchor in &anchors {
        assert_eq!(anchors.iter().filter(|other| *other == anchor).count(), 1, "{anchor}");
    }
    for target in page.split("](#").skip(1).map(|rest| rest.split(')').next().unwrap()) {
        assert!(anchors.iter().any(|anchor| anchor == target), "no heading for the link #{target}");
    }
}

/// Each row of a table is on one line, and no line of prose is longer than 100 columns.
#[test]
fn the_reference_has_whole_table_rows_and_short_lines() {
    let page = scene_reference();
    let lines: Vec<&str> = page.lines().collect();
    for pair in lines.windows(2) {
        assert!(!pair[0].starts_with('|') || pair[0].ends_with('|'), "{}", pair[0]);
        assert!(!pair[0].starts_with('|') || pair[1].is_empty() || pair[1].starts_with('|'), "{}", pair[1]);
        assert!(pair[0].starts_with('|') || pair[0].chars().count() <= 100, "{}", pair[0]);
    }
}

/// A number in a scene. The schema of the number has bounds.
struct BoundedNumber {
    scene: String,
    path: String,
}

/// Collects the numbers of a value whose schema has bounds, by the location of the schema.
struct BoundsWalk<'s> {
    schema: &'s Value,
    scene: String,
    found: BTreeMap<String, (Value, Vec<BoundedNumber>)>,
}

const BOUNDS: [&str; 4] = ["minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum"];

impl BoundsWalk<'_> {
    fn walk(&mut self, location: &str, schema: &Value, value: &Value, path: &JsonPath) {
        if value.is_number() && BOUNDS.iter().any(|key| schema[*key].is_number()) {
            let entry = self.found.entry(location.to_string()).or_insert_with(|| (schema.clone(), Vec::new()));
            entry.1.push(BoundedNumber { scene: self.scene.clone(), path: path.to_string() });
        }
        if let Some(pointer) = schema["$ref"].as_str().and_then(|reference| reference.strip_prefix('#')) {
            let definition = self.schema.pointer(pointer).unwrap().clone();
            self.walk(pointer, &definition, value, path);
        }
        for choices in ["anyOf", "oneOf"] {
            for (i, choice) in schema[choices].as_array().into_iter().flatten().enumerate() {
                let properties = choice["properties"].as_object();
                let fits = properties.is_none_or(|properties| {
                    value.as_object().is_some_and(|object| object.keys().all(|key| properties.contains_key(key)))
                });
                if fits {
                    self.walk(&format!("{location}/{choices}/{i}"), choice, value, path);
                }
            }
        }
        for (key, below) in value.as_object().into_iter().flatten() {
            if let Some(property) = schema["properties"].get(key) {
                self.walk(&format!("{location}/properties/{key}"), property, below, &path.key(key));
            } else if schema["additionalProperties"].is_object() {
                let location = format!("{location}/additionalProperties");
                self.walk(&location, &schema["additionalProperties"], below, &path.key(key));
            }
        }
        for (i, below) in value.as_array().into_iter().flatten().enumerate() {
            if schema["items"].is_object() {
                self.walk(&format!("{location}/items"), &schema["items"], below, &path.index(i));
            }
        }
    }
}

/// Counts the schemas with bounds.
fn count_bounded(schema: &Value) -> usize {
    let here = usize::from(BOUNDS.iter().any(|key| schema[*key].is_number()));
    let below: Vec<&Value> = match schema {
        Value::Object(entries) => {
            entries.iter().filter(|(key, _)| *key != "examples" && *key != "default").map(|(_, it)| it).collect()
        }
        Value::Array(elements) => elements.iter().collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => Vec::new(),
    };
    here + below.into_iter().map(count_bounded).sum::<usize>()
}

/// Returns whether no error at the number's path refuses the scene with `value` in its place.
fn accepts(number: &BoundedNumber, value: f64) -> bool {
    let patch = format!("{}={value}", number.path);
    let error = parse(&number.scene, Path::new("scene"), &[patch]).err();
    error.is_none_or(|error| error.location.path.as_deref() != Some(number.path.as_str()))
}

/// The bounds of numbers in the schema equal the bounds that the checks of the scene file enforce.
#[test]
fn the_ranges_of_the_schema_are_enforced() {
    let schema = schema();
    let mut walk = BoundsWalk { schema: &schema, scene: String::new(), found: BTreeMap::new() };
    let good = super::tests::good_scenes().into_iter().map(|(_, text)| text);
    for scene in good.chain(example_scenes()) {
        let value: Value = serde_json::from_str(&scene).unwrap();
        walk.scene = scene;
        walk.walk("", &schema, &value, &JsonPath::Root);
    }
    assert_eq!(walk.found.len(), count_bounded(&schema), "no scene has a number for each range of the schema");
    let mut wrong = Vec::new();
    for (location, (schema, numbers)) in walk.found {
        let any_accepts = |value: f64| numbers.iter().take(8).any(|number| accepts(number, value));
        let step = if schema["type"].to_string().contains("integer") { 1.0 } else { 1e-6 };
        let sides = [("minimum", "exclusiveMinimum", step), ("maximum", "exclusiveMaximum", -step)];
        for (inclusive, exclusive, step) in sides {
            let bounds = [(inclusive, 0.0, -step), (exclusive, step, 0.0)];
            for (key, inside, outside) in bounds {
                let Some(bound) = schema[key].as_f64() else { continue };
                if !any_accepts(bound + inside) {
                    wrong.push(format!("{location}: {key} {bound}, but {} is refused", bound + inside));
                }
                if any_accepts(bound + outside) {
                    wrong.push(format!("{location}: {key} {bound}, but {} is accepted", bound + outside));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The numeric defaults in the schema equal the constants of the program.
#[test]
fn the_schema_states_the_defaults_of_the_program() {
    let schema = schema();
    let render = &schema["$defs"]["RenderFile"]["properties"];
    let default = |key: &str| render[key]["default"].as_u64().unwrap();
    assert_eq!(default("nearest"), u64::from(abbe_transport::plan::budget::DEFAULT_NEAREST));
    assert_eq!(default("march_steps"), u64::from(super::resolve::DEFAULT_MARCH_STEPS));
    for (key, value) in [
        ("passes", abbe_transport::plan::budget::DEFAULT_PASSES),
        ("photons", abbe_transport::plan::budget::DEFAULT_PHOTONS),
    ] {
        let words: String = render[key]["x-default"].as_str().unwrap().chars().filter(|c| *c != ' ').collect();
        assert!(words.starts_with(&value.to_string()), "{key}: {words}");
    }
}
