//! The positions of all values and keys of a JSON text.
//!
//! One list holds a node for each value and each key, in the order of the text. A container
//! precedes its contents, and a key precedes its value. A node takes 12 bytes. The kind of the
//! value follows from its first byte in the text.

use super::path::{PathStep, push_key};
use std::borrow::Cow;

/// The byte offsets of a value or key in the text, and the number of the first node after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct JsonNode {
    pub(super) start: u32,
    pub(super) end: u32,
    pub(super) next: u32,
}

/// The spans of all values and keys of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Positions(Vec<JsonNode>);

impl Positions {
    /// Takes the nodes of a text, which must be in the order of the text.
    pub(super) fn new(mut nodes: Vec<JsonNode>) -> Self {
        nodes.shrink_to_fit();
        Self(nodes)
    }

    /// Returns the number of each value and key, in the order of the text.
    pub(super) fn ids(&self) -> std::ops::Range<u32> {
        0..self.0.len() as u32
    }

    pub(super) fn root<'t>(&'t self, text: &'t str) -> SpannedValue<'t> {
        SpannedValue::in_list(text, &self.0, 0)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ValueKind {
    Null,
    Bool,
    Number,
    String,
    Array,
    Object,
}

/// A value or key of a scanned text.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpannedValue<'t> {
    text: &'t str,
    nodes: &'t [JsonNode],
    id: u32,
}

impl<'t> SpannedValue<'t> {
    /// Returns the value whose node is `nodes[id]`.
    pub(super) fn in_list(text: &'t str, nodes: &'t [JsonNode], id: u32) -> Self {
        Self { text, nodes, id }
    }

    pub(super) fn id(self) -> u32 {
        self.id
    }

    pub(super) fn with_id(self, id: u32) -> Self {
        Self { id, ..self }
    }

    fn node(self) -> JsonNode {
        self.nodes[self.id as usize]
    }

    pub(super) fn start(self) -> usize {
        self.node().start as usize
    }

    pub(super) fn end(self) -> usize {
        self.node().end as usize
    }

    pub(super) fn written(self) -> &'t str {
        &self.text[self.start()..self.end()]
    }

    pub(super) fn kind(self) -> ValueKind {
        match self.text.as_bytes()[self.start()] {
            b'n' => ValueKind::Null,
            b't' | b'f' => ValueKind::Bool,
            b'"' => ValueKind::String,
            b'[' => ValueKind::Array,
            b'{' => ValueKind::Object,
            _ => ValueKind::Number,
        }
    }

    /// Returns the content of a string. The result is borrowed unless the string has escapes.
    pub(super) fn content(self) -> Cow<'t, str> {
        decode(self.written())
    }

    pub(super) fn children(self) -> ChildValues<'t> {
        let next = self.node().next;
        ChildValues { end: next, at: self.with_id(self.id + 1) }
    }

    pub(super) fn entries(self) -> impl Iterator<Item = (SpannedValue<'t>, SpannedValue<'t>)> {
        let mut all = self.children();
        std::iter::from_fn(move || Some((all.next()?, all.next()?)))
    }

    /// Returns the value of a key. Returns `None` if this value is not an object or lacks the key.
    pub(super) fn get(self, key: &str) -> Option<SpannedValue<'t>> {
        if self.kind() != ValueKind::Object {
            return None;
        }
        self.entries().find(|(name, _)| name.content() == key).map(|(_, value)| value)
    }

    /// Follows one step of a path. Returns `None` if the step does not lead to a value.
    pub(super) fn step(self, step: &PathStep) -> Option<SpannedValue<'t>> {
        match (step, self.kind()) {
            (PathStep::Key(key), ValueKind::Object) => self.get(key).or_else(|| self.in_group(key)),
            (PathStep::Index(index), ValueKind::Array) => self.children().nth(*index),
            (PathStep::Named(name), ValueKind::Array) => self.children().find(|element| element.is_named(name)),
            (PathStep::Key(key), ValueKind::Array) => self.element(key),
            (PathStep::Key(_) | PathStep::Index(_) | PathStep::Named(_) | PathStep::Append, _) => None,
        }
    }

    /// Returns whether this value is an object whose key `name` contains the text of the argument.
    fn is_named(self, name: &str) -> bool {
        self.get("name").is_some_and(|value| value.kind() == ValueKind::String && value.content() == name)
    }

    /// Returns the object of a group with this name.
    fn in_group(self, name: &str) -> Option<SpannedValue<'t>> {
        self.get("group").filter(|group| group.kind() == ValueKind::Array).and_then(|group| group.named(name))
    }

    /// Returns the first element of an array with this name, also in groups.
    fn named(self, name: &str) -> Option<SpannedValue<'t>> {
        let own = self.children().find(|element| element.is_named(name));
        own.or_else(|| self.children().find_map(|element| element.in_group(name)))
    }

    /// Returns the element of an array with this name, or the value of the only element with this
    /// key, such as the step `rotate` of a transform.
    fn element(self, key: &str) -> Option<SpannedValue<'t>> {
        self.named(key).or_else(|| {
            let mut values =
                self.children().filter(|element| !element.has_name()).filter_map(|element| element.get(key));
            values.next().filter(|_| values.next().is_none())
        })
    }

    fn has_name(self) -> bool {
        self.get("name").is_some_and(|value| value.kind() == ValueKind::String)
    }

    /// Returns the keys by which the elements of an array are found, or their numbers.
    pub(super) fn targets(self) -> Vec<String> {
        let mut targets = Vec::new();
        for (i, element) in self.children().enumerate() {
            let name = element.get("name").filter(|_| element.has_name()).map(Self::content);
            let only_key = element.entries_of_object().next().filter(|_| element.entries_of_object().count() == 1);
            let key = only_key.map(|(key, _)| key.content());
            let mut target = String::new();
            if let Some(name) = name.as_ref().or(key.as_ref().filter(|key| self.element(key).is_some())) {
                push_key(&mut target, name);
            } else {
                target = format!("[{i}]");
                key.iter().for_each(|key| push_key(&mut target, key));
            }
            let group = element.get("group").filter(|group| group.kind() == ValueKind::Array);
            let inside = group.map_or_else(Vec::new, Self::targets);
            targets
                .extend(std::iter::once(target.clone()).chain(inside.iter().map(|inner| format!("{target}.{inner}"))));
        }
        targets
    }

    /// Returns the entries of an object, and none for other values.
    fn entries_of_object(self) -> impl Iterator<Item = (SpannedValue<'t>, SpannedValue<'t>)> {
        self.entries().filter(move |_| self.kind() == ValueKind::Object)
    }

    /// Returns the value at a path, or the deepest existing value on the path.
    pub(super) fn nearest(self, steps: &[PathStep]) -> SpannedValue<'t> {
        let mut value = self;
        for step in steps {
            match value.step(step) {
                Some(below) => value = below,
                None => break,
            }
        }
        value
    }

    /// Returns whether node number `id`, which must be inside this value, is a key.
    pub(super) fn is_key(self, id: u32) -> bool {
        let end = self.with_id(id).end();
        let rest = self.text.as_bytes()[end..].iter();
        rest.copied().find(|byte| !byte.is_ascii_whitespace()) == Some(b':')
    }

    /// Returns whether node number `id` is this value or inside this value.
    pub(super) fn contains(self, id: u32) -> bool {
        (self.id..self.node().next).contains(&id)
    }

    /// Returns the JSON path from this value to node number `id`. A key has the path of its value.
    pub(super) fn path_to(self, id: u32) -> String {
        let mut path = String::new();
        let mut value = self;
        while value.id != id {
            let below = match value.kind() {
                ValueKind::Object => value.entries().find(|(_, below)| id < below.node().next),
                ValueKind::Array => None,
                ValueKind::Null | ValueKind::Bool | ValueKind::Number | ValueKind::String => break,
            };
            if let Some((key, below)) = below {
                push_key(&mut path, &key.content());
                if key.id == id {
                    break;
                }
                value = below;
            } else if let Some((i, below)) = value.children().enumerate().find(|(_, below)| id < below.node().next) {
                path += &format!("[{i}]");
                value = below;
            } else {
                break;
            }
        }
        path
    }
}

/// The values directly inside a container. In an object, keys and values alternate.
#[derive(Debug, Clone)]
pub(super) struct ChildValues<'t> {
    at: SpannedValue<'t>,
    end: u32,
}

impl ChildValues<'_> {
    pub(super) fn left(&self) -> usize {
        self.clone().count()
    }
}

impl<'t> Iterator for ChildValues<'t> {
    type Item = SpannedValue<'t>;

    fn next(&mut self) -> Option<SpannedValue<'t>> {
        (self.at.id < self.end).then(|| {
            let value = self.at;
            self.at = value.with_id(value.node().next);
            value
        })
    }
}

/// Returns the content of a JSON string. The scanner has checked the string.
pub(super) fn decode(written: &str) -> Cow<'_, str> {
    if written.contains('\\') {
        Cow::Owned(serde_json::from_str(written).unwrap_or_default())
    } else {
        Cow::Borrowed(written.get(1..written.len().saturating_sub(1)).unwrap_or_default())
    }
}
