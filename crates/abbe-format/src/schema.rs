//! Parts of the JSON Schema: the rules that the attributes `#[schemars(…)]` of the types name.

use schemars::{Schema, SchemaGenerator, json_schema};
use serde_json::Value;

/// Changes the schema of an object form so that the schema also allows plain forms.
pub(crate) fn allow_also(schema: &mut Schema, plain: &[Value]) {
    let object = schema.ensure_object();
    // The examples of a struct stay with its object form.
    let has_forms = object.contains_key("oneOf") || object.contains_key("anyOf");
    let keys: &[&str] = if has_forms { &["title", "description", "examples"] } else { &["title", "description"] };
    let kept: Vec<_> = keys.iter().filter_map(|key| object.remove_entry(*key)).collect();
    let mut choices = plain.to_vec();
    match object.remove("oneOf").or_else(|| object.remove("anyOf")) {
        Some(Value::Array(forms)) => choices.extend(forms),
        Some(other) => choices.push(other),
        None => choices.push(Value::Object(std::mem::take(object))),
    }
    for (key, value) in kept {
        object.insert(key, value);
    }
    object.insert("anyOf".into(), choices.into());
}

pub(crate) fn or_name(schema: &mut Schema) {
    allow_also(schema, &[serde_json::json!({"type": "string"})]);
}

pub(crate) fn or_number(schema: &mut Schema) {
    allow_also(schema, &[serde_json::json!({"type": "number"})]);
}

pub(crate) fn or_number_or_name(schema: &mut Schema) {
    allow_also(schema, &[serde_json::json!({"type": "number"}), serde_json::json!({"type": "string"})]);
}

/// Allows a comment in each object whose keys are fixed: the key `note` with a string.
pub(crate) fn with_notes(mut schema: Value) -> Value {
    match &mut schema {
        Value::Object(object) => {
            object.values_mut().for_each(|value| *value = with_notes(value.take()));
            if object.get("additionalProperties") == Some(&Value::Bool(false)) {
                object.insert("patternProperties".into(), serde_json::json!({"^note$": {"type": "string"}}));
            }
        }
        Value::Array(elements) => elements.iter_mut().for_each(|element| *element = with_notes(element.take())),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
    schema
}

/// Returns the schema for the required radius of a lens surface. 0 and null are a plane.
pub(crate) fn radius_or_plane(_: &mut SchemaGenerator) -> Schema {
    json_schema!({"type": ["number", "null"]})
}

/// Adds a rule to the schema of an array: each element must be above 0.
pub(crate) fn positive_items(schema: &mut Schema) {
    if let Some(items) = schema.get_mut("items").and_then(Value::as_object_mut) {
        items.insert("exclusiveMinimum".into(), 0.into());
    }
}

/// Returns false. As the `skip_serializing_if` of schemars, it puts the default of a key into the
/// schema, although serde leaves out a key with the default value.
pub(crate) fn never<T>(_: &T) -> bool {
    false
}
