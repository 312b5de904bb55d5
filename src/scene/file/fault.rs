//! What serde finds wrong with a value, and how that is told to a person.

use std::fmt;

use serde::de;

use super::path::quoted;
use super::positions::{Kind, Value};
use super::source::Source;
use crate::error::{Error, nearest_name};

/// The longest list of allowed names that is written out in full.
const LISTED: usize = 12;

/// The longest value that is repeated in an error, in characters.
const SHOWN: usize = 40;

/// A fault in a value. It gains its place on the way out of the value it was found in.
#[derive(Debug)]
pub(super) struct Fault {
    /// Number of the value's or key's node.
    node: Option<u32>,
    what: What,
}

/// What is wrong.
#[derive(Debug)]
pub(super) enum What {
    /// The value is of another type, length or range than allowed.
    Mismatch {
        /// What is allowed.
        expected: String,
    },
    /// A key or name that is not in a list.
    Unknown {
        /// It.
        name: String,
        /// The list.
        known: &'static [&'static str],
    },
    /// A key is missing in an object.
    Missing(&'static str),
    /// An object that must have exactly one key has more; the place is the second key.
    SecondKey(&'static [&'static str]),
    /// Anything else, in words.
    Other(String),
}

impl Fault {
    /// A fault without a place.
    pub(super) fn new(what: What) -> Self {
        Self { node: None, what }
    }

    /// A value that is not what it should be.
    pub(super) fn mismatch(expected: impl Into<String>) -> Self {
        Self::new(What::Mismatch { expected: expected.into() })
    }

    /// The fault at a value or key, unless its place is known already.
    pub(super) fn at(mut self, value: Value) -> Self {
        self.node.get_or_insert(value.id());
        self
    }

    /// The error for people, at its place in the source.
    pub(super) fn explain(self, source: &Source) -> Error {
        let root = source.positions().root(&source.text);
        let mut value = self.node.map_or(root, |node| root.with_id(node));
        if matches!(self.what, What::Unknown { .. })
            && value.kind() == Kind::Object
            && let Some((key, _)) = value.entries().next()
        {
            // The key that says which form an object has was read before the form was known: blame the key.
            value = key;
        }
        let path = root.path_to(value.id());
        let is_key = root.is_key(value.id());
        let error = self.what.explain(value, is_key).on_path(path);
        source.error_in_text(value.start(), error)
    }
}

impl What {
    /// The error for people, without its place.
    fn explain(self, value: Value, is_key: bool) -> Error {
        match self {
            Self::Mismatch { expected } => Error::input(format!("found {}", found(value))).expected(expected),
            Self::Unknown { name, known } => {
                let kind = if is_key { "unknown key" } else { "found" };
                let error = Error::input(format!("{kind} {}", quoted(&shorten(&name))));
                let error = if known.is_empty() { error.expected("no keys") } else { error.expected(one_of(known)) };
                Error { near: nearest_name(&name, known.iter().copied()), ..error }
            }
            Self::Missing(key) => Error::input(format!("missing key \"{key}\"")),
            Self::SecondKey(known) => {
                let error = Error::input(format!("found a second key {}", shorten(value.written())));
                if known.is_empty() {
                    error.expected("exactly one key")
                } else {
                    error.expected(format!("exactly {}", one_of(known)))
                }
            }
            Self::Other(what) => Error::input(what),
        }
    }
}

/// Names that are allowed, as a list, or where to find it if it is long.
pub(super) fn one_of(names: &[&str]) -> String {
    match names {
        [only] => (*only).to_string(),
        _ if names.len() <= LISTED => format!("one of {}", names.join(", ")),
        _ => format!("one of {}, … (see `abbe schema`)", names[..LISTED].join(", ")),
    }
}

/// A value in words: plain ones as they are written, containers by their size.
pub(super) fn found(value: Value) -> String {
    match value.kind() {
        Kind::Null | Kind::Bool | Kind::Number | Kind::String => shorten(value.written()),
        Kind::Object if value.elements().next().is_none() => "an empty object".into(),
        Kind::Object => "an object".into(),
        Kind::Array => match value.elements().count() {
            0 => "an empty array".into(),
            count => format!("an array of {count}"),
        },
    }
}

/// A text, cut where it is long.
fn shorten(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}

/// What serde expects, in the words of this program.
fn in_words(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> String {
    let expected = expected.to_string();
    match expected.as_str() {
        "f64" => "a number".into(),
        "i32" => "a whole number".into(),
        "u32" if matches!(found, de::Unexpected::Unsigned(_)) => format!("a whole number of at most {}", u32::MAX),
        "u32" | "u64" => "a whole number of at least 0".into(),
        "a boolean" => "true or false".into(),
        "a sequence" => "an array".into(),
        "a map" => "an object".into(),
        text => match text.strip_prefix("an array of length ") {
            Some(length) => format!("an array of {length}"),
            None => expected,
        },
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.what)
    }
}

impl std::error::Error for Fault {}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(what: T) -> Self {
        Self::new(What::Other(what.to_string()))
    }

    fn invalid_type(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        Self::mismatch(in_words(found, expected))
    }

    fn invalid_value(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        Self::mismatch(in_words(found, expected))
    }

    fn invalid_length(_: usize, expected: &dyn de::Expected) -> Self {
        Self::mismatch(in_words(de::Unexpected::Seq, expected))
    }

    fn unknown_variant(name: &str, known: &'static [&'static str]) -> Self {
        Self::new(What::Unknown { name: name.to_string(), known })
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        Self::unknown_variant(name, known)
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new(What::Missing(key))
    }

    fn duplicate_field(key: &'static str) -> Self {
        Self::new(What::Other(format!("found the key \"{key}\" a second time")))
    }
}
