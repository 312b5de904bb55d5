//! Errors that serde reports when it deserialises a value, and their messages for the user.

use super::describe::{found, one_of, shorten};
use super::path::quoted;
use super::positions::{SpannedValue, ValueKind};
use abbe_spectra::error::{Error, nearest_name};
use serde::de;
use std::fmt;

/// An error in a value. The innermost of the nested deserialisers sets its position.
#[derive(Debug)]
pub(super) struct DeserializeError {
    /// Node number of the wrong value or key; `None` until the number is known.
    node: Option<u32>,
    kind: DeserializeErrorKind,
}

#[derive(Debug)]
pub(super) enum DeserializeErrorKind {
    /// The value has a wrong type or a wrong length, or the value is out of range.
    Mismatch { expected: String },
    /// A key or name is not one of the known names.
    Unknown { name: String, known: &'static [&'static str] },
    /// An object lacks this key.
    Missing(&'static str),
    /// An object has two of the listed keys instead of one. The position is the second key.
    SecondKey(&'static [&'static str]),
    /// The value was replaced by a stand-in, and the type of the value has no stand-in.
    NoStandIn,
    /// Any other error, with its message.
    Other(String),
}

pub(super) type ReadResult<T> = Result<T, DeserializeError>;

impl DeserializeError {
    pub(super) fn new(kind: DeserializeErrorKind) -> Self {
        Self { node: None, kind }
    }

    pub(super) fn mismatch(expected: impl Into<String>) -> Self {
        Self::new(DeserializeErrorKind::Mismatch { expected: expected.into() })
    }

    pub(super) fn no_stand_in() -> Self {
        Self::new(DeserializeErrorKind::NoStandIn)
    }

    /// Sets the position of the error to a value or key, unless the error already has a position.
    pub(super) fn at(mut self, value: SpannedValue) -> Self {
        self.node.get_or_insert(value.id());
        self
    }

    pub(super) fn kind(&self) -> &DeserializeErrorKind {
        &self.kind
    }

    /// Returns the value or key at the position of the error. `root` is the outermost value.
    pub(super) fn place<'t>(&self, root: SpannedValue<'t>) -> SpannedValue<'t> {
        self.node.map_or(root, |node| root.with_id(node))
    }

    /// Converts this error to an error for the user with its JSON path, and returns it after its
    /// byte offset. `root` is the outermost value of the text.
    pub(super) fn explain(self, root: SpannedValue) -> (usize, Error) {
        let mut value = self.place(root);
        if matches!(self.kind, DeserializeErrorKind::Unknown { .. })
            && value.kind() == ValueKind::Object
            && let Some((key, _)) = value.entries().next()
        {
            // `forms` reads the key of the variant, so an unknown one has the object's position.
            value = key;
        }
        let path = root.path_to(value.id());
        let is_key = root.is_key(value.id());
        (value.start(), self.kind.explain(value, is_key).on_path(path))
    }
}

impl DeserializeErrorKind {
    /// Returns the error for the user, without a position.
    fn explain(self, value: SpannedValue, is_key: bool) -> Error {
        match self {
            Self::Mismatch { expected } => Error::input(format!("found {}", found(value))).expected(expected),
            Self::Unknown { name, known } => {
                let kind = if is_key { "unknown key" } else { "found" };
                let error = Error::input(format!("{kind} {}", quoted(&shorten(&name))));
                let error = if known.is_empty() { error.expected("no keys") } else { error.expected(one_of(known)) };
                Error { suggestion: nearest_name(&name, known.iter().copied()), ..error }
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
            Self::NoStandIn => Error::input(format!("found {}", found(value))),
            Self::Other(message) => Error::input(message),
        }
    }
}

/// Translates serde's expected value into the terms of JSON: "a map" becomes "an object".
fn expected_in_json_terms(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> String {
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

impl fmt::Display for DeserializeError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:?}", self.kind)
    }
}

impl std::error::Error for DeserializeError {}

impl de::Error for DeserializeError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(DeserializeErrorKind::Other(message.to_string()))
    }

    fn invalid_type(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        Self::mismatch(expected_in_json_terms(found, expected))
    }

    fn invalid_value(found: de::Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        Self::mismatch(expected_in_json_terms(found, expected))
    }

    fn invalid_length(_: usize, expected: &dyn de::Expected) -> Self {
        Self::mismatch(expected_in_json_terms(de::Unexpected::Seq, expected))
    }

    fn unknown_variant(name: &str, known: &'static [&'static str]) -> Self {
        Self::new(DeserializeErrorKind::Unknown { name: name.to_string(), known })
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        Self::unknown_variant(name, known)
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new(DeserializeErrorKind::Missing(key))
    }

    fn duplicate_field(key: &'static str) -> Self {
        Self::new(DeserializeErrorKind::Other(format!("found the key \"{key}\" a second time")))
    }
}
