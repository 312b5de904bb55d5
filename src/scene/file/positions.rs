//! Where every value of a JSON text stands.
//!
//! The values lie in one list in the order of the text (a container before its contents, a key before its value), each
//! with its span and the number of the value behind its last content. 12 bytes a value; what it is follows from its
//! first byte.

use std::borrow::Cow;

use super::path::{Step, push_key};

/// A value's or a key's span in the text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Node {
    /// Byte offset of its first byte.
    pub(super) start: u32,
    /// Byte offset behind its last byte.
    pub(super) end: u32,
    /// Number of the node behind its contents.
    pub(super) next: u32,
}

/// The spans of all values of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Positions(pub(super) Vec<Node>);

impl Positions {
    /// The outermost value.
    pub(super) fn root<'t>(&'t self, text: &'t str) -> Value<'t> {
        Value::in_list(text, &self.0, 0)
    }
}

/// What a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool,
    /// A number.
    Number,
    /// A string.
    String,
    /// An array.
    Array,
    /// An object.
    Object,
}

/// A value (or a key) of a text that was scanned.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value<'t> {
    text: &'t str,
    nodes: &'t [Node],
    id: u32,
}

impl<'t> Value<'t> {
    /// The value with this number in a list of nodes of a text.
    pub(super) fn in_list(text: &'t str, nodes: &'t [Node], id: u32) -> Self {
        Self { text, nodes, id }
    }

    /// Its number in the list.
    pub(super) fn id(self) -> u32 {
        self.id
    }

    /// The value with this number.
    pub(super) fn with_id(self, id: u32) -> Self {
        Self { id, ..self }
    }

    /// Its entry in the list.
    fn node(self) -> Node {
        self.nodes[self.id as usize]
    }

    /// Byte offset of its first byte.
    pub(super) fn start(self) -> usize {
        self.node().start as usize
    }

    /// Byte offset behind its last byte.
    pub(super) fn end(self) -> usize {
        self.node().end as usize
    }

    /// As it is written.
    pub(super) fn written(self) -> &'t str {
        &self.text[self.start()..self.end()]
    }

    /// What it is.
    pub(super) fn kind(self) -> Kind {
        match self.text.as_bytes()[self.start()] {
            b'n' => Kind::Null,
            b't' | b'f' => Kind::Bool,
            b'"' => Kind::String,
            b'[' => Kind::Array,
            b'{' => Kind::Object,
            _ => Kind::Number,
        }
    }

    /// A string's content; borrowed where it holds no escape.
    pub(super) fn content(self) -> Cow<'t, str> {
        decode(self.written())
    }

    /// The elements of an array.
    pub(super) fn elements(self) -> Elements<'t> {
        let next = self.node().next;
        Elements { end: next, at: self.with_id(self.id + 1) }
    }

    /// The entries of an object: key and value.
    pub(super) fn entries(self) -> impl Iterator<Item = (Value<'t>, Value<'t>)> {
        let mut all = self.elements();
        std::iter::from_fn(move || Some((all.next()?, all.next()?)))
    }

    /// The value under a key of an object.
    pub(super) fn get(self, key: &str) -> Option<Value<'t>> {
        if self.kind() != Kind::Object {
            return None;
        }
        self.entries().find(|(name, _)| name.content() == key).map(|(_, value)| value)
    }

    /// One step down, if there is such a value.
    pub(super) fn step(self, step: &Step) -> Option<Value<'t>> {
        match (step, self.kind()) {
            (Step::Key(key), Kind::Object) => self.get(key),
            (Step::Index(index), Kind::Array) => self.elements().nth(*index),
            (Step::Named(name), Kind::Array) => self.elements().find(|element| element.is_named(name)),
            (Step::Key(_) | Step::Index(_) | Step::Named(_) | Step::Append, _) => None,
        }
    }

    /// Whether it is an object whose `name` is this.
    fn is_named(self, name: &str) -> bool {
        self.get("name").is_some_and(|value| value.kind() == Kind::String && value.content() == name)
    }

    /// The value at a path, or else the last one on the way there.
    pub(super) fn nearest(self, steps: &[Step]) -> Value<'t> {
        let mut value = self;
        for step in steps {
            match value.step(step) {
                Some(below) => value = below,
                None => break,
            }
        }
        value
    }

    /// Whether the node `id`, somewhere inside this value, is a key.
    pub(super) fn is_key(self, id: u32) -> bool {
        let behind = self.with_id(id).end();
        let rest = self.text.as_bytes()[behind..].iter();
        rest.copied().find(|byte| !byte.is_ascii_whitespace()) == Some(b':')
    }

    /// The JSON path from this value down to the node `id`; for a key's node it is the path of its value.
    pub(super) fn path_to(self, id: u32) -> String {
        let mut path = String::new();
        let mut value = self;
        while value.id != id {
            let below = match value.kind() {
                Kind::Object => value.entries().find(|(_, below)| id < below.node().next),
                Kind::Array => None,
                Kind::Null | Kind::Bool | Kind::Number | Kind::String => break,
            };
            if let Some((key, below)) = below {
                push_key(&mut path, &key.content());
                if key.id == id {
                    break;
                }
                value = below;
            } else if let Some((i, below)) = value.elements().enumerate().find(|(_, below)| id < below.node().next) {
                path += &format!("[{i}]");
                value = below;
            } else {
                break;
            }
        }
        path
    }
}

/// The values directly inside a container (in an object keys and values alternate).
#[derive(Debug, Clone)]
pub(super) struct Elements<'t> {
    at: Value<'t>,
    end: u32,
}

impl<'t> Iterator for Elements<'t> {
    type Item = Value<'t>;

    fn next(&mut self) -> Option<Value<'t>> {
        (self.at.id < self.end).then(|| {
            let value = self.at;
            self.at = value.with_id(value.node().next);
            value
        })
    }
}

/// The content of a JSON string that was checked already.
pub(super) fn decode(written: &str) -> Cow<'_, str> {
    if written.contains('\\') {
        Cow::Owned(serde_json::from_str(written).unwrap_or_default())
    } else {
        Cow::Borrowed(written.get(1..written.len().saturating_sub(1)).unwrap_or_default())
    }
}
