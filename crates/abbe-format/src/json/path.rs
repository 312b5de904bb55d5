//! JSON paths such as `objects[3].shape.sphere.radius`: building, printing and parsing them.
//!
//! Some keys are written in brackets and quotes: `["such a key"]`. These are the empty key, and
//! keys that contain white space, a control character or one of `.[]"=\`.

use abbe_spectra::error::{Error, Result};
use std::fmt;

/// A JSON path. Each level borrows the level above it, so building a path allocates no memory.
#[derive(Debug, Clone, Copy)]
pub enum JsonPath<'a> {
    /// The outermost value.
    Root,
    /// A key of an object.
    Key(&'a JsonPath<'a>, &'a str),
    /// An element of an array, counted from 0.
    Index(&'a JsonPath<'a>, usize),
}

impl<'a> JsonPath<'a> {
    #[must_use]
    pub fn key(&'a self, key: &'a str) -> JsonPath<'a> {
        JsonPath::Key(self, key)
    }

    #[must_use]
    pub fn index(&'a self, index: usize) -> JsonPath<'a> {
        JsonPath::Index(self, index)
    }
}

impl fmt::Display for JsonPath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            JsonPath::Root => Ok(()),
            JsonPath::Key(parent, key) => {
                parent.fmt(f)?;
                write_key(f, key, matches!(parent, JsonPath::Root))
            }
            JsonPath::Index(parent, index) => {
                parent.fmt(f)?;
                write!(f, "[{index}]")
            }
        }
    }
}

/// Writes one key. Every key except the first is preceded by a dot.
fn write_key(f: &mut impl fmt::Write, key: &str, first: bool) -> fmt::Result {
    if key.is_empty() || key.chars().any(needs_quotes) {
        write!(f, "[{}]", quoted(key))
    } else if first {
        f.write_str(key)
    } else {
        write!(f, ".{key}")
    }
}

/// Appends one key to a path. Every key except the first is preceded by a dot.
pub(super) fn push_key(path: &mut String, key: &str) {
    let first = path.is_empty();
    write_key(path, key, first).expect("writing to a string cannot fail");
}

fn needs_quotes(c: char) -> bool {
    matches!(c, '.' | '[' | ']' | '"' | '=' | '\\') || c.is_whitespace() || c.is_control()
}

pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum PathStep {
    /// A key of an object.
    Key(String),
    /// An element of an array, counted from 0.
    Index(usize),
    /// A new element after the last one: `[-]`.
    Append,
    /// The first element that is an object with this `name`: `[name=prism]`.
    Named(String),
}

/// Prints steps in the syntax that [`parse`] reads.
pub(super) fn display(steps: &[PathStep]) -> String {
    let mut text = String::new();
    for step in steps {
        match step {
            PathStep::Key(key) => push_key(&mut text, key),
            PathStep::Index(index) => text += &format!("[{index}]"),
            PathStep::Append => text += "[-]",
            PathStep::Named(name) => text += &format!("[name={name}]"),
        }
    }
    text
}

/// Parses a path. A dot separates a key from the step before it. The steps in brackets are `[3]`,
/// `["any key"]`, `[-]` and `[name=…]`. The empty path leads to the outermost value.
pub(super) fn parse(path: &str) -> Result<Vec<PathStep>> {
    let mut steps = Vec::new();
    let mut rest = path;
    while !rest.is_empty() {
        if let Some(inner) = rest.strip_prefix('[') {
            let (step, after) = bracket(inner).ok_or_else(|| bad_path(path))?;
            steps.push(step);
            rest = after;
            if !(rest.is_empty() || rest.starts_with(['.', '['])) {
                return Err(bad_path(path));
            }
        } else {
            let bare = match rest.strip_prefix('.') {
                Some(bare) if !steps.is_empty() => bare,
                None if steps.is_empty() => rest,
                Some(_) | None => return Err(bad_path(path)),
            };
            let end = bare.find(['.', '[']).unwrap_or(bare.len());
            if end == 0 {
                return Err(bad_path(path));
            }
            steps.push(PathStep::Key(bare[..end].to_string()));
            rest = &bare[end..];
        }
    }
    Ok(steps)
}

/// Parses the step that follows an opening bracket. Also returns the text after the closing one.
fn bracket(inner: &str) -> Option<(PathStep, &str)> {
    if inner.starts_with('"') {
        let mut strings = serde_json::Deserializer::from_str(inner).into_iter::<String>();
        let key = strings.next()?.ok()?;
        let after = inner.get(strings.byte_offset()..)?.strip_prefix(']')?;
        return Some((PathStep::Key(key), after));
    }
    let (text, after) = inner.split_once(']')?;
    let step = if text == "-" {
        PathStep::Append
    } else if let Some(name) = text.strip_prefix("name=") {
        PathStep::Named(name.trim_matches('"').to_string())
    } else {
        PathStep::Index(text.parse().ok()?)
    };
    Some((step, after))
}

fn bad_path(path: &str) -> Error {
    Error::input(format!("cannot read the path \"{path}\"")).expected("one like objects[0].shape.sphere.radius")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_printed_path_parses_to_the_same_path() {
        let objects = JsonPath::Root.key("objects");
        let third = objects.index(3);
        let name = third.key("a.b c");
        assert_eq!(name.key("x").to_string(), "objects[3][\"a.b c\"].x");
        for path in ["", "a", "a.b-c.d_e", "a[0][1].b", "[\"x y\"].z", "objects[name=prism].material", "lights[-]"] {
            assert_eq!(display(&parse(path).unwrap()), path);
        }
    }

    #[test]
    fn a_malformed_path_is_an_error() {
        for path in [".a", "a.", "a..b", "a[", "a[]", "a[x]", "a[1]b", "a[\"x]", "a[-1]", "a[\"x\"b]"] {
            let error = parse(path).unwrap_err().to_string();
            let expected = "expected one like objects[0].shape.sphere.radius";
            assert_eq!(error, format!("cannot read the path \"{path}\"; {expected}"));
        }
    }
}
