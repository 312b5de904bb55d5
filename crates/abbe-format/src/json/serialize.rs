//! Serialises the values of a scanned text. No tree of the values is built.

use super::positions::{SpannedValue, ValueKind};
use serde::ser::{Error, SerializeMap};
use serde::{Serialize, Serializer};
use serde_json::Number;

impl Serialize for SpannedValue<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.kind() {
            ValueKind::Null => serializer.serialize_unit(),
            ValueKind::Bool => serializer.serialize_bool(self.written() == "true"),
            ValueKind::Number => {
                let number: Number = self.written().parse().map_err(S::Error::custom)?;
                number.serialize(serializer)
            }
            ValueKind::String => serializer.serialize_str(&self.content()),
            ValueKind::Array => serializer.collect_seq(self.children()),
            ValueKind::Object => serializer.collect_map(self.entries().map(|(key, value)| (key.content(), value))),
        }
    }
}

/// An object of objects, such as a scene with its sections, without some of the inner entries.
pub(super) struct Sections<'t, F> {
    pub(super) root: SpannedValue<'t>,
    /// Returns whether an entry stays. The arguments are the key of the section and of the entry.
    pub(super) keeps: F,
}

impl<F: Fn(&str, &str) -> bool> Serialize for Sections<'_, F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut sections = serializer.serialize_map(None)?;
        for (key, section) in self.root.entries() {
            let name = key.content();
            if section.kind() == ValueKind::Object {
                sections.serialize_entry(&name, &Section { section, keeps: |key: &str| (self.keeps)(&name, key) })?;
            } else {
                sections.serialize_entry(&name, &section)?;
            }
        }
        sections.end()
    }
}

/// An object without some of its entries.
struct Section<'t, F> {
    section: SpannedValue<'t>,
    keeps: F,
}

impl<F: Fn(&str) -> bool> Serialize for Section<'_, F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let entries = self.section.entries().map(|(key, value)| (key.content(), value));
        serializer.collect_map(entries.filter(|(key, _)| (self.keeps)(key)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::json::scan::scan;

    #[test]
    fn a_scanned_text_serialises_like_the_tree_of_its_values() {
        let text = r#" { "b" : [1, -2.50, 1e3, -0, 18446744073709551615, null, true, false, [], {}],
            "a": {"\u00e9\n": "λ \"quoted\"", "c": {"d": 0.1}}, "e": 1e-400 } "#;
        let positions = scan(text).unwrap();
        let tree: serde_json::Value = serde_json::from_str(text).unwrap();
        let root = positions.root(text);
        assert_eq!(serde_json::to_string(&root).unwrap(), tree.to_string());
        let all = serde_json::to_string(&Sections { root, keeps: |_: &str, _: &str| true }).unwrap();
        assert_eq!(all, tree.to_string());
        let keeps = |section: &str, key: &str| (section, key) != ("a", "c");
        let part = serde_json::to_string(&Sections { root, keeps }).unwrap();
        assert_eq!(part, tree.to_string().replace(r#","c":{"d":0.1}"#, ""));
    }
}
