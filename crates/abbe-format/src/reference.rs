//! The scene reference: a Markdown page that describes every key of the scene file. The page is
//! generated from the JSON Schema of the scene file.

use crate::json::one_line;
use serde_json::{Map, Value};
use std::fmt::Write as _;

/// The chapters of the page: their titles, and the names of their definitions, of which the empty
/// one is the scene. Definitions without a title have no section; their text appears where they are
/// used.
pub(super) const CHAPTERS: [(&str, &str); 19] = [
    ("The scene", " UnitFile"),
    ("The camera", "CameraFile CameraKeyframeFile ShutterFile"),
    ("Camera lenses", "LensFile PrescriptionFile LensSurfaceFile LensTransmissionFile"),
    (
        "The film",
        "FilmFile ObserverFile LayerFile GamutFile ToneFile WhiteBalanceFile OutputSpaceFile ExposureFile BloomFile",
    ),
    ("Spectra", "SpectrumFile SpectrumPathFile LineFile WeightedSpectrumFile"),
    (
        "Reflectances and textures",
        "ReflectanceFile ScalarFile ColourImageFile BandImageFile ScalarImageFile UvFile EncodingFile WrapFile \
         FilterFile ChannelFile ImageFile",
    ),
    ("Indices of refraction", "IndexFile FormulaFile"),
    ("Materials", "MaterialFile PaneTransmittanceFile WeightedMaterialFile GreenFile"),
    ("Thin films", "CoatingFile CoatingLayerFile CoatingIndexFile ComplexIndexFile"),
    (
        "Polarising filters",
        "PolarisingFilterFile PolariserFile RetarderFile LiquidCrystalFile StressFile DiscFile BeamFile CircularPolariserFile HandednessFile",
    ),
    ("Gratings", "GratingProfileFile OrderEfficiencyFile GroovesFile"),
    (
        "Media",
        "MediumFile DyeFile TransmittanceFile PhaseFile IcePopulationFile IceOrientationFile MediumEmissionFile MediumBlackbodyFile",
    ),
    ("Density and temperature fields", "FieldFile ExponentialFieldFile PlanetFile SphereFieldFile NoiseFieldFile"),
    ("Objects", "ObjectFile GroupFile EmissionFile"),
    ("Shapes", "ShapeFile"),
    ("Transforms and motion", "TransformFile TransformStepFile ScaleFile KeyframeFile"),
    ("Lights", "LightFile SpotFalloffFile ProjectionFile PlaceFile SunFile"),
    (
        "Meters",
        "MeterFile MeterGridFile MeterSphereFile MeterCylinderFile MeterSpotFile QuantityKindFile SideFile RequirementFile",
    ),
    ("Rendering", "RenderFile LightMapFile"),
];

const INTRODUCTION: &str = "\
# Scene reference

This page describes every key of the scene file. `abbe schema --markdown` generates it from the JSON
Schema, which `abbe schema` prints.

- A scene file is strict JSON: no comments, no trailing commas, no unknown keys, no duplicate keys.
- Every object except those whose keys are names may contain a comment: the key `note` with a string.
- A length without a unit in its key is in the scene's `unit`. In the tables, its unit is *scene
  unit*.
- Powers, intensities and radiances without a photometric unit are integrals over 360–830 nm.
- The default *required* marks a key that must be present. The default — means that the key has no
  default value: without the key, the feature is absent, or another key of the section takes its
  place.
- Paths of files are relative to the folder of the scene file.
- A range such as 0 … 1 applies to every value of a spectrum, and to each element of an array.
";

const TEXT_WIDTH: usize = 100;
const EXAMPLE_WIDTH: usize = 92;

/// Returns the scene reference as Markdown.
pub fn scene_reference() -> String {
    let schema = super::schema();
    let page = Page { schema: &schema };
    let mut text = format!("{INTRODUCTION}\n## Contents\n\n");
    for (chapter, names) in CHAPTERS {
        let _ = write!(text, "- {}:", link(chapter, chapter));
        let entries: Vec<String> = names.split(' ').flat_map(|name| page.contents(name)).collect();
        let _ = writeln!(text, " {}", entries.join(", "));
    }
    for (chapter, names) in CHAPTERS {
        let _ = write!(text, "\n## {chapter}\n");
        names.split(' ').for_each(|name| page.section(name, &mut text));
    }
    filled(&text)
}

/// Wraps the paragraphs and list entries of a page. Headings, tables and code stay unchanged.
fn filled(page: &str) -> String {
    let (mut text, mut column, mut indent, mut in_code) = (String::new(), 0, "", false);
    for line in page.lines() {
        let is_fence = line.starts_with("```");
        let is_prose = !in_code && !is_fence && !line.is_empty() && !line.starts_with(['|', '#']);
        in_code ^= is_fence;
        let continues = is_prose && column > 0 && !line.starts_with("- ");
        if !continues && !text.is_empty() {
            text.push('\n');
            column = 0;
        }
        if !is_prose {
            text.push_str(line);
            continue;
        }
        if !continues {
            indent = if line.starts_with("- ") { "\n  " } else { "\n" };
        }
        for word in line.split_whitespace() {
            let width = word.chars().count();
            let gap = if column + 1 + width > TEXT_WIDTH { indent } else { " " };
            if column > 0 {
                text.push_str(gap);
            }
            column = if gap == indent { gap.len() - 1 + width } else { column + usize::from(column > 0) + width };
            text.push_str(word);
        }
    }
    text + "\n"
}

enum SchemaVariant<'s> {
    Constant(&'s str),
    /// An object with one key: the key and the schema of its value.
    Keyed(&'s str, &'s Value),
    Plain,
}

impl<'s> SchemaVariant<'s> {
    fn of(schema: &'s Value) -> Self {
        if let Some(constant) = schema["const"].as_str() {
            return Self::Constant(constant);
        }
        let properties = schema["properties"].as_object();
        let first = properties.and_then(|properties| properties.iter().next());
        first.map_or(Self::Plain, |(key, value)| Self::Keyed(key, value))
    }
}

struct Page<'s> {
    schema: &'s Value,
}

impl<'s> Page<'s> {
    /// Returns the definition with this name. The empty name stands for the scene.
    fn definition(&self, name: &str) -> &'s Value {
        if name.is_empty() { self.schema } else { &self.schema["$defs"][name] }
    }

    fn referred(&self, schema: &Value) -> Option<&'s Value> {
        schema["$ref"].as_str()?.strip_prefix("#/$defs/").map(|name| self.definition(name))
    }

    /// Returns links to a section and to the sections of its variants.
    fn contents(&self, name: &str) -> Vec<String> {
        let definition = self.definition(name);
        let title = text_of(definition, "title");
        let keyed = variants(definition).iter().filter_map(|schema| match SchemaVariant::of(schema) {
            SchemaVariant::Keyed(key, _) => Some(link(&format!("`{key}`"), &format!("{title} {key}"))),
            SchemaVariant::Constant(_) | SchemaVariant::Plain => None,
        });
        std::iter::once(link(&title, &title)).chain(keyed).collect()
    }

    fn section(&self, name: &str, text: &mut String) {
        let definition = self.definition(name);
        let title = text_of(definition, "title");
        let _ = write!(text, "\n### {title}\n\n{}\n", text_of(definition, "description"));
        let variants = variants(definition);
        if !variants.is_empty() {
            self.forms(&title, variants, text);
        } else if let Some(properties) = definition["properties"].as_object() {
            self.keys(properties, definition, text);
        } else {
            let _ = write!(text, "\nType: {}.\n", self.type_of(definition, 1));
        }
        examples(definition, text);
        for schema in variants {
            if let SchemaVariant::Keyed(key, value) = SchemaVariant::of(schema) {
                self.variant(&title, key, schema, value, text);
            }
        }
    }

    fn forms(&self, title: &str, variants: &[Value], text: &mut String) {
        let _ = write!(text, "\n| Form | Meaning |\n| --- | --- |\n");
        for schema in variants {
            let form = match SchemaVariant::of(schema) {
                SchemaVariant::Constant(constant) => format!("`\"{constant}\"`"),
                SchemaVariant::Keyed(key, _) => link(&format!("`{{\"{key}\": …}}`"), &format!("{title} {key}")),
                SchemaVariant::Plain => self.type_of(schema, 1),
            };
            let _ = writeln!(text, "| {form} | {} |", text_of(schema, "description"));
        }
    }

    /// Writes the section of a variant that is an object with one key.
    fn variant(&self, title: &str, key: &str, schema: &Value, value: &'s Value, text: &mut String) {
        let _ = write!(text, "\n#### {title} `{key}`\n\n{}", text_of(schema, "description"));
        let contents = self.referred(value).filter(|definition| definition["title"].is_null());
        let more = contents.map(|definition| text_of(definition, "description")).unwrap_or_default();
        let _ = writeln!(text, "{}", more.split_once(". ").map(|(_, more)| format!(" {more}")).unwrap_or_default());
        let contents = contents.unwrap_or(value);
        match contents["properties"].as_object() {
            Some(properties) => self.keys(properties, contents, text),
            None => self.keys(schema["properties"].as_object().unwrap_or(&Map::new()), schema, text),
        }
        examples(schema, text);
    }

    fn keys(&self, properties: &Map<String, Value>, object: &Value, text: &mut String) {
        let _ = write!(text, "\n| Key | Type | Unit | Default | Range | Meaning |\n");
        let _ = writeln!(text, "| --- | --- | --- | --- | --- | --- |");
        for (key, schema) in properties {
            let required = object["required"].as_array().is_some_and(|keys| keys.iter().any(|it| it == key));
            let default = match (&schema["default"], schema["x-default"].as_str()) {
                _ if required => "*required*".to_string(),
                (_, Some(words)) => words.to_string(),
                (Value::Null, None) => "—".to_string(),
                (value, None) => format!("`{}`", one_line(value)),
            };
            let nullable = if required { self.type_of(schema, 1) } else { self.type_of(&without_null(schema), 1) };
            let unit = schema["x-unit"].as_str().unwrap_or("");
            let described = if schema["description"].is_null() { object } else { schema };
            let meaning = text_of(described, "description");
            let _ = writeln!(text, "| `{key}` | {nullable} | {unit} | {default} | {} | {meaning} |", range(schema));
        }
    }

    /// Describes the type of a schema in words. The words are in the plural if `count` is not 1.
    fn type_of(&self, schema: &Value, count: u64) -> String {
        let plural = |word: &str| if count == 1 { word.to_string() } else { format!("{word}s") };
        if schema.is_boolean() {
            return plural("value");
        }
        if let Some(definition) = self.referred(schema) {
            // A definition without a title has no section.
            let title = text_of(definition, "title");
            return if title.is_empty() { self.type_of(definition, count) } else { link(&title, &title) };
        }
        if let Some(choices) = schema["anyOf"].as_array() {
            let choices: Vec<String> = choices.iter().map(|choice| self.type_of(choice, count)).collect();
            return choices.join(" or ");
        }
        match &schema["type"] {
            Value::Array(types) => {
                let of = |name: &Value| self.type_of(&serde_json::json!({"type": name}), count);
                types.iter().map(of).collect::<Vec<_>>().join(" or ")
            }
            Value::String(name) => match name.as_str() {
                "integer" => plural("whole number"),
                "boolean" => "true or false".into(),
                "object" => format!("object of names and {}", self.type_of(&schema["additionalProperties"], 2)),
                "array" => match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
                    (Some(least), Some(most)) if least == most => {
                        format!("{} of {least} {}", plural("array"), self.type_of(&schema["items"], least))
                    }
                    _ => format!("{} of {}", plural("array"), self.type_of(&schema["items"], 2)),
                },
                name => plural(name),
            },
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => String::new(),
        }
    }
}

/// Returns a text from a schema as a single line, for example the title. The text may be empty.
fn text_of(schema: &Value, key: &str) -> String {
    schema[key].as_str().unwrap_or_default().replace('\n', " ")
}

/// Returns the forms of a definition. If the definition has only one form, the result is empty.
fn variants(definition: &Value) -> &[Value] {
    let forms = definition["oneOf"].as_array().or_else(|| definition["anyOf"].as_array());
    forms.map_or(&[], Vec::as_slice)
}

/// Returns a link to a heading of the page.
fn link(text: &str, heading: &str) -> String {
    format!("[{text}](#{})", heading.to_lowercase().replace(' ', "-"))
}

fn without_null(schema: &Value) -> Value {
    let mut schema = schema.clone();
    if let Some(types) = schema["type"].as_array() {
        let types: Vec<Value> = types.iter().filter(|name| *name != "null").cloned().collect();
        schema["type"] = if let [only] = types.as_slice() { only.clone() } else { types.into() };
    }
    if let Some(choices) = schema.get_mut("anyOf").and_then(Value::as_array_mut) {
        choices.retain(|choice| choice["type"] != "null");
    }
    schema
}

/// Describes the range of a number, or the length of an array and the range of its elements.
fn range(schema: &Value) -> String {
    let mut parts: Vec<String> = schema["x-range"].as_str().map(str::to_string).into_iter().collect();
    let mut level = schema;
    loop {
        let bound = |key: &str| Some(&level[key]).filter(|bound| !bound.is_null());
        let low = bound("exclusiveMinimum").map(|low| (low, "<")).or(bound("minimum").map(|low| (low, "≤")));
        let high = bound("exclusiveMaximum").map(|high| (high, "<")).or(bound("maximum").map(|high| (high, "≤")));
        parts.extend(match (low, high) {
            (Some((low, "≤")), Some((high, "≤"))) => Some(format!("{low} … {high}")),
            (Some((low, below)), Some((high, above))) => Some(format!("{low} {below} x {above} {high}")),
            (Some((low, "<")), None) => Some(format!("> {low}")),
            (Some((low, _)), None) => Some(format!("≥ {low}")),
            (None, Some((high, above))) => Some(format!("{above} {high}")),
            (None, None) => None,
        });
        let (least, most) = (level["minItems"].as_u64(), level["maxItems"].as_u64());
        parts.extend(match (least, most) {
            (Some(least), Some(most)) if least == most => None,
            (Some(1), None) => Some("at least 1 entry".to_string()),
            (Some(least), None) => Some(format!("at least {least} entries")),
            (_, Some(most)) => Some(format!("at most {most} entries")),
            (None, None) => None,
        });
        level = &level["items"];
        if level.is_null() {
            return parts.join(", ");
        }
    }
}

fn examples(schema: &Value, text: &mut String) {
    let examples: Vec<String> = schema["examples"].as_array().into_iter().flatten().map(wrapped).collect();
    if !examples.is_empty() {
        let _ = write!(text, "\n```json\n{}\n```\n", examples.join("\n"));
    }
}

/// Prints JSON on one line if it fits. If it does not fit, the outer objects that have only one key
/// are opened on the first line and closed on the last line. The lines between contain the entries
/// of the object or array inside these outer objects.
fn wrapped(value: &Value) -> String {
    let line = one_line(value);
    if line.chars().count() <= EXAMPLE_WIDTH {
        return line;
    }
    let (mut open, mut close, mut inner) = (String::new(), String::new(), value);
    let parts: Vec<String> = loop {
        match inner {
            Value::Object(entries) if entries.len() == 1 => {
                let (key, only) = entries.iter().next().expect("there is one entry");
                open += &format!("{{\"{key}\": ");
                close.insert(0, '}');
                inner = only;
            }
            Value::Object(entries) => {
                open.push('{');
                close.insert(0, '}');
                break entries.iter().map(|(key, value)| format!("\"{key}\": {}", one_line(value))).collect();
            }
            Value::Array(elements) => {
                open.push('[');
                close.insert(0, ']');
                break elements.iter().map(one_line).collect();
            }
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => return line,
        }
    };
    let mut text = open;
    let mut column = EXAMPLE_WIDTH;
    for (i, part) in parts.iter().enumerate() {
        let length = part.chars().count() + 2;
        if column + length > EXAMPLE_WIDTH {
            text.push_str("\n  ");
            column = 2;
        } else {
            text.push(' ');
        }
        column += length;
        text += part;
        text += if i + 1 < parts.len() { "," } else { "" };
    }
    text + "\n" + &close
}
