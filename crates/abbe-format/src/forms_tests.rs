//! The forms that error messages list.

use crate::{
    IndexFile, PrescriptionFile, ReflectanceFile, ScalarFile, SpectrumFile, forms::Forms, texture::REFLECTANCE_FORMS,
};
use schemars::JsonSchema;

/// Finds the object forms in the schema of a type, and returns their keys.
fn object_forms<T: JsonSchema>() -> Vec<String> {
    let schema = schemars::schema_for!(T);
    let choices = schema.get("anyOf").and_then(serde_json::Value::as_array).expect("a list of forms");
    let keys = choices.iter().filter_map(|choice| choice.get("required")?.get(0)?.as_str());
    keys.map(str::to_string).collect()
}

#[test]
fn errors_list_the_forms_that_the_types_have() {
    let ends_with = |expected: &str, forms: &[String]| expected.ends_with(&forms.join(", "));
    let spectrum = object_forms::<SpectrumFile>();
    assert_eq!(spectrum.len(), 11);
    assert!(ends_with(SpectrumFile::EXPECTED, &spectrum));
    let reflectance = [spectrum, object_forms::<ReflectanceFile>()].concat();
    assert_eq!(reflectance, REFLECTANCE_FORMS);
    assert!(ends_with(ReflectanceFile::EXPECTED, &reflectance));
    assert!(ends_with(ScalarFile::EXPECTED, &object_forms::<ScalarFile>()));
    assert!(ends_with(IndexFile::EXPECTED, &object_forms::<IndexFile>()));
    assert!(ends_with(PrescriptionFile::EXPECTED, &object_forms::<PrescriptionFile>()));
}
