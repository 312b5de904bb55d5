//! Tests that the schema and the reader agree about every value in every place.

use super::*;
use crate::tests::places_of_good_scenes;
use serde_json::Value;

/// Checks values against a schema. It knows the keywords that the schema of the scene file uses.
struct SchemaChecker<'s> {
    root: &'s Value,
}

impl SchemaChecker<'_> {
    fn allows(&self, schema: &Value, value: &Value) -> bool {
        if let Some(allowed) = schema.as_bool() {
            return allowed;
        }
        let object = schema.as_object().expect("a schema is an object or a boolean");
        object.iter().all(|(keyword, rule)| self.holds(keyword, rule, object, value))
    }

    fn holds(&self, keyword: &str, rule: &Value, schema: &serde_json::Map<String, Value>, value: &Value) -> bool {
        let choices = |rule: &Value| rule.as_array().unwrap().iter().filter(|it| self.allows(it, value)).count();
        let number = |holds: fn(f64, f64) -> bool| value.as_f64().is_none_or(|it| holds(it, rule.as_f64().unwrap()));
        let length = |holds: fn(usize, usize) -> bool| {
            value.as_array().is_none_or(|it| holds(it.len(), rule.as_u64().unwrap() as usize))
        };
        match keyword {
            "$ref" => self.allows(self.root.pointer(rule.as_str().unwrap().trim_start_matches('#')).unwrap(), value),
            "anyOf" => choices(rule) > 0,
            "oneOf" => choices(rule) == 1,
            "const" => value == rule,
            "enum" => rule.as_array().unwrap().contains(value),
            "type" => {
                let one = std::slice::from_ref(rule);
                rule.as_array().map_or(one, Vec::as_slice).iter().any(|kind| is_of_type(kind, value))
            }
            "minimum" => number(|value, bound| value >= bound),
            "maximum" => number(|value, bound| value <= bound),
            "exclusiveMinimum" => number(|value, bound| value > bound),
            "exclusiveMaximum" => number(|value, bound| value < bound),
            "minItems" => length(|length, bound| length >= bound),
            "maxItems" => length(|length, bound| length <= bound),
            "items" => value.as_array().is_none_or(|items| items.iter().all(|item| self.allows(rule, item))),
            "required" => value.as_object().is_none_or(|object| {
                rule.as_array().unwrap().iter().all(|key| object.contains_key(key.as_str().unwrap()))
            }),
            "properties" => value.as_object().is_none_or(|object| {
                object.iter().all(|(key, value)| rule.get(key).is_none_or(|schema| self.allows(schema, value)))
            }),
            "additionalProperties" => value.as_object().is_none_or(|object| {
                let known = schema.get("properties").and_then(Value::as_object);
                let is_note = |key: &str| key == "note" && schema.contains_key("patternProperties");
                let is_other = |key: &str| known.is_none_or(|known| !known.contains_key(key)) && !is_note(key);
                object.iter().filter(|(key, _)| is_other(key)).all(|(_, value)| self.allows(rule, value))
            }),
            // The only pattern of keys is that of a note.
            "patternProperties" => value.get("note").is_none_or(|note| self.allows(&rule["^note$"], note)),
            // The only pattern is that of a hexadecimal colour.
            "pattern" => value.as_str().is_none_or(|text| linear_of_hex(text).is_ok()),
            "$schema" | "$defs" | "title" | "description" | "examples" | "default" | "format" | "x-unit"
            | "x-default" | "x-range" => true,
            other => panic!("the checker does not know the keyword {other}"),
        }
    }
}

fn is_of_type(kind: &Value, value: &Value) -> bool {
    match kind.as_str().unwrap() {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("the checker does not know the type {other}"),
    }
}

/// Replaces each value of each scene by values of all kinds. The schema allows what the reader
/// accepts, and refuses what does not fit the types of the scene file. The ranges of numbers have
/// their own test. Rules that concern several values are beyond a JSON Schema.
#[test]
fn the_schema_and_the_reader_accept_the_same_scenes() {
    let anything =
        ["null", "true", "0", "-1", "3.5", "1e9", "\"x\"", "\"#ff8800\"", "[]", "[1, 2, 3]", "{}", "{\"x\": 1}"];
    let root = schema();
    let checker = SchemaChecker { root: &root };
    let (mut wrong, mut unsupported, mut accepted, mut refused) = (Vec::new(), Vec::new(), 0, 0);
    for (path, text, places) in places_of_good_scenes() {
        if !checker.allows(&root, &serde_json::from_str(&text).unwrap()) {
            unsupported.push(path);
            continue;
        }
        for place in places {
            for value in anything {
                let set = format!("{place}={value}");
                let source = JsonSource::of_scene(&text, &path, std::slice::from_ref(&set), FileAccess::Anywhere);
                let Ok(source) = source else {
                    refused += 1;
                    continue;
                };
                let is_offered = checker.allows(&root, &serde_json::from_str(source.text()).unwrap());
                match source.deserialize::<SceneFile>() {
                    Err(error) => {
                        refused += 1;
                        wrong.extend(is_offered.then(|| format!("offered by the schema: {set}: {error}")));
                    }
                    Ok(scene) if scene.validate(&source).is_ok() => {
                        accepted += 1;
                        wrong.extend((!is_offered).then(|| format!("refused by the schema: {set}")));
                    }
                    Ok(_) => {}
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(accepted > 1_000 && refused > 5_000, "{accepted} {refused}");
    assert!(unsupported.is_empty(), "the schema lacks parts of {unsupported:?}");
}
