//! Patches of the form `PATH=JSON`, which change a JSON text before it is read.
//!
//! A patch replaces the value at its path, or adds the last key and the objects on the path that
//! are missing. The step `[-]` appends an element to an array. In an array, a key selects the
//! element with this name, or the only element with this key.

use super::describe::{found, one_of};
use super::origin::{OriginalFile, PieceOrigin, TextPieces};
use super::path;
use super::path::{PathStep, quoted};
use super::positions::{Positions, SpannedValue, ValueKind};
use super::scan::{SyntaxError, scan};
use super::text::too_large;
use crate::MAX_BYTES;
use abbe_spectra::error::{Error, Result, nearest_name};
use std::path::Path;

/// In errors of a patch, this text and the path of the patch replace the file name, as in `patch
/// render.passes`. A program can replace the text with the name of its command-line option.
pub const PATCH_LABEL: &str = "patch ";

/// A text with edits, and the origin of all its parts.
#[derive(Debug, Clone)]
pub(super) struct PatchedText {
    pub(super) text: String,
    /// The text before all edits, or `None` if there are none.
    pub(super) unpatched: Option<String>,
    /// The files that the text includes.
    pub(super) parts: Vec<OriginalFile>,
    pub(super) pieces: TextPieces,
    pub(super) positions: Positions,
}

impl PatchedText {
    /// Reads a text. Errors use `file` as its name.
    pub(super) fn new(text: String, file: &Path) -> Result<Self> {
        if text.len() as u64 > MAX_BYTES {
            return Err(too_large().in_file(file));
        }
        let positions =
            scan(&text).map_err(|SyntaxError { offset, error }| OriginalFile::place(file, &text, offset, error))?;
        Ok(Self { text, unpatched: None, parts: Vec::new(), pieces: TextPieces::of_file(), positions })
    }

    /// Applies patches of the form `PATH=JSON`.
    pub(super) fn patch(&mut self, sets: &[String]) -> Result<()> {
        for set in sets {
            let patch = read_patch(set)?;
            let root = self.positions.root(&self.text);
            let edit = patch.edit(root).map_err(|error| error.in_file(Path::new(&patch.label)))?;
            self.apply(vec![edit], Path::new(&patch.label)).map_err(|mut error| {
                error.location.line_column = None;
                error
            })?;
        }
        Ok(())
    }

    /// Applies edits that do not overlap. Several insertions at one place keep their order. Errors
    /// use `file` as the name of the text.
    pub(super) fn apply(&mut self, mut edits: Vec<TextEdit>, file: &Path) -> Result<()> {
        self.unpatched.get_or_insert_with(|| self.text.clone());
        edits.sort_by_key(|edit| edit.from);
        for TextEdit { from, to, text, origin } in edits.into_iter().rev() {
            self.pieces = self.pieces.after((from, to), text.len(), origin, self.text.len());
            self.text.replace_range(from..to, &text);
        }
        if self.text.len() as u64 > MAX_BYTES {
            return Err(too_large().in_file(file));
        }
        self.positions = scan(&self.text).map_err(|SyntaxError { offset, error }| self.place(file, offset, error))?;
        Ok(())
    }

    pub(super) fn origin(&self, offset: usize) -> PieceOrigin {
        self.pieces.origin(offset)
    }

    /// Returns the origin of a copy of the text between two offsets.
    pub(super) fn origin_of(&self, from: usize, to: usize) -> PieceOrigin {
        self.pieces.origin_of(from, to)
    }

    /// Adds file, line and column to an error at a byte offset of the edited text. `file` is the
    /// name of the text.
    pub(super) fn place(&self, file: &Path, offset: usize, error: Error) -> Error {
        match self.origin(offset) {
            PieceOrigin::Patch(label) => error.in_file(Path::new(&label)),
            PieceOrigin::Part(part, offset) => {
                let OriginalFile { path, text } = &self.parts[part];
                OriginalFile::place(path, text, offset, error)
            }
            PieceOrigin::File(offset) => {
                OriginalFile::place(file, self.unpatched.as_ref().unwrap_or(&self.text), offset, error)
            }
            PieceOrigin::At(_) => error.in_file(file),
        }
    }
}

struct PathPatch<'s> {
    steps: Vec<PathStep>,
    json: &'s str,
    label: String,
}

/// A replacement of a part of a text.
pub(super) struct TextEdit {
    from: usize,
    to: usize,
    text: String,
    origin: PieceOrigin,
}

impl TextEdit {
    pub(super) fn replacing(value: SpannedValue, text: impl Into<String>, origin: PieceOrigin) -> Self {
        Self { from: value.start(), to: value.end(), text: text.into(), origin }
    }

    pub(super) fn insertion(at: usize, text: impl Into<String>, origin: PieceOrigin) -> Self {
        Self { from: at, to: at, text: text.into(), origin }
    }

    pub(super) fn removal(from: usize, to: usize, origin: PieceOrigin) -> Self {
        Self { from, to, text: String::new(), origin }
    }
}

/// Parses a patch of the form `PATH=JSON`.
fn read_patch(set: &str) -> Result<PathPatch<'_>> {
    let label = |path: &str| format!("{PATCH_LABEL}{}", path.trim());
    let Some((path, json)) = split_at_equals(set) else {
        let error = Error::input("found no `=`").expected("PATH=JSON, such as render.passes=4");
        return Err(error.in_file(Path::new(&label(set))));
    };
    let (path, json, label) = (path.trim(), json.trim(), label(path));
    let place = |error: Error| error.in_file(Path::new(&label));
    let steps = path::parse(path).map_err(place)?;
    if steps.is_empty() {
        return Err(place(Error::input("found no path before `=`").expected("PATH=JSON, such as render.passes=4")));
    }
    if json.is_empty() {
        return Err(place(Error::input("found no value after `=`").expected("a JSON value")));
    }
    if is_bare_word(json) {
        let expected =
            format!("JSON; a string needs double quotes, and in a shell also single quotes: '{path}={}'", quoted(json));
        return Err(place(Error::input(format!("found the bare word {json}")).expected(expected)));
    }
    scan(json).map_err(|SyntaxError { offset: _, mut error }| {
        error.location.path = None;
        place(error)
    })?;
    Ok(PathPatch { steps, json, label })
}

/// Splits a patch at the first `=` outside brackets.
fn split_at_equals(set: &str) -> Option<(&str, &str)> {
    let (mut inside, mut in_string, mut escaped) = (false, false, false);
    for (i, byte) in set.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' if inside => in_string = !in_string,
            b'[' if !in_string => inside = true,
            b']' if !in_string => inside = false,
            b'=' if !inside => return Some((&set[..i], &set[i + 1..])),
            _ => {}
        }
    }
    None
}

/// Returns whether a text looks like a string whose quotes were removed by the shell. The result is
/// `false` for words, such as `None`, for which the scanner has a better error message.
fn is_bare_word(json: &str) -> bool {
    let starts = json.starts_with(|c: char| c.is_alphabetic() || matches!(c, '_' | '/' | '.' | '~'));
    let explained = ["true", "false", "null", "none", "nan", "inf", "infinity"];
    starts && !json.contains(['"', '{', '[', '\n']) && !explained.contains(&json.to_ascii_lowercase().as_str())
}

impl PathPatch<'_> {
    /// Returns the edit that applies the patch to a text. `root` is the outermost value.
    fn edit(&self, root: SpannedValue) -> Result<TextEdit> {
        let mut value = root;
        for (i, step) in self.steps.iter().enumerate() {
            match value.step(step) {
                Some(below) => value = below,
                None => return self.addition(value, i),
            }
        }
        Ok(TextEdit::replacing(value, self.json, self.origin()))
    }

    /// Returns the edit that adds the missing part of the path to `value`, which is the last
    /// existing value on the path. The steps from number `i` on are missing.
    fn addition(&self, value: SpannedValue, i: usize) -> Result<TextEdit> {
        let (before, step, rest) = (&self.steps[..i], &self.steps[i], &self.steps[i + 1..]);
        let mut text = self.json.to_string();
        for step in rest.iter().rev() {
            let PathStep::Key(key) = step else { return Err(no_such_value(&self.steps[..=i])) };
            text = format!("{{{}: {text}}}", quoted(key));
        }
        match (step, value.kind()) {
            (PathStep::Key(key), ValueKind::Object) => text = format!("{}: {text}", quoted(key)),
            (PathStep::Append, ValueKind::Array) => {}
            (PathStep::Index(index), ValueKind::Array) => return Err(out_of_range(before, *index, value)),
            (PathStep::Named(name) | PathStep::Key(name), ValueKind::Array) => {
                return Err(no_such_name(before, name, value));
            }
            (PathStep::Key(_), _) => return Err(wrong_kind(before, value, "an object")),
            (PathStep::Index(_) | PathStep::Append | PathStep::Named(_), _) => {
                return Err(wrong_kind(before, value, "an array"));
            }
        }
        // The new text follows the last element, or the opening bracket of an empty container.
        let last = value.children().last();
        let at = last.map_or(value.start() + 1, SpannedValue::end);
        let text = if last.is_some() { format!(", {text}") } else { text };
        Ok(TextEdit::insertion(at, text, self.origin()))
    }

    fn origin(&self) -> PieceOrigin {
        PieceOrigin::Patch(self.label.clone())
    }
}

/// Returns the error for a path through a missing array, as a patch creates only missing objects.
fn no_such_value(steps: &[PathStep]) -> Error {
    Error::input(format!("found nothing at {}", path::display(steps))).expected("a path through existing values")
}

fn out_of_range(array: &[PathStep], index: usize, value: SpannedValue) -> Error {
    let array = path::display(array);
    let error = Error::input(format!("found no element {index}"));
    match value.children().count() {
        0 => error.expected(format!("no index, as {array} is empty; {array}[-] adds an element")),
        1 => error.expected(format!("index 0, the only one of {array}; {array}[-] adds an element")),
        count => error.expected(format!("an index of {array} from 0 to {}; {array}[-] adds an element", count - 1)),
    }
}

fn no_such_name(array: &[PathStep], name: &str, value: SpannedValue) -> Error {
    let targets = value.targets();
    let near = nearest_name(name, targets.iter().map(String::as_str));
    let what = format!("found no element with the name {} in {}", quoted(name), path::display(array));
    let error = Error { suggestion: near, ..Error::input(what) };
    if targets.is_empty() {
        return error.expected("no name, as it is empty");
    }
    error.expected(one_of(&targets.iter().map(String::as_str).collect::<Vec<_>>()))
}

fn wrong_kind(steps: &[PathStep], value: SpannedValue, wanted: &str) -> Error {
    let place = if steps.is_empty() { "the top level".to_string() } else { path::display(steps) };
    Error::input(format!("found {} at {place}", found(value))).expected(wanted)
}

#[cfg(test)]
mod tests {
    use super::super::JsonSource;
    use super::*;

    /// Applies patches to a text. Returns the patched text, or the error message.
    fn after(text: &str, sets: &[&str]) -> String {
        let sets: Vec<_> = sets.iter().map(|set| set.to_string()).collect();
        let file = Path::new("scene.json");
        let patched = PatchedText::new(text.to_string(), file)
            .and_then(|mut patched| patched.patch(&sets).map(|()| patched.text));
        patched.unwrap_or_else(|error| error.to_string())
    }

    #[test]
    fn a_value_is_replaced() {
        let text = r#"{"a": [1, {"name": "x", "b": 2}], "c d": 3}"#;
        assert_eq!(after(text, &["a[0]=7"]), r#"{"a": [7, {"name": "x", "b": 2}], "c d": 3}"#);
        assert_eq!(after(text, &["a[1].b = {\"y\": 1}"]), r#"{"a": [1, {"name": "x", "b": {"y": 1}}], "c d": 3}"#);
        assert_eq!(after(text, &["a[name=x].b=null"]), r#"{"a": [1, {"name": "x", "b": null}], "c d": 3}"#);
        assert_eq!(after(text, &[r#"["c d"]="=""#]), r#"{"a": [1, {"name": "x", "b": 2}], "c d": "="}"#);
        assert_eq!(after(text, &["c d=4"]), r#"{"a": [1, {"name": "x", "b": 2}], "c d": 4}"#);
    }

    #[test]
    fn elements_are_found_by_name_and_by_key() {
        let text = r#"{"o": [{"name": "p", "t": [{"move": 1}, {"turn": 2}]}, {"name": "g", "group": [{"name": "q", "r": 3}]}],
            "l": [{"sun": {"x": 4}}, {"spot": {"x": 5}}, {"spot": {"x": 6}}]}"#;
        let replaced = |from: &str, to: &str| text.replacen(from, to, 1);
        assert_eq!(after(text, &["o.p.t.turn=7"]), replaced("\"turn\": 2", "\"turn\": 7"));
        assert_eq!(after(text, &["o.g.q.r=7"]), replaced("\"r\": 3", "\"r\": 7"));
        assert_eq!(after(text, &["o.g.new=7"]), replaced("\"r\": 3}]", "\"r\": 3}], \"new\": 7"));
        assert_eq!(after(text, &["l.sun.x=7"]), replaced("\"x\": 4", "\"x\": 7"));
        let message = "patch l.spot.x: found no element with the name \"spot\" in l; expected one of sun, [1].spot, [2].spot; \
                       did you mean \"[2].spot\"?";
        assert_eq!(after(text, &["l.spot.x=7"]), message, "two elements have this key");
        let message = "patch o.t.x: found no element with the name \"t\" in o; expected one of p, g, g.q";
        assert_eq!(after(text, &["o.t.x=7"]), message);
    }

    #[test]
    fn missing_keys_and_elements_are_added() {
        assert_eq!(after(r#"{"a": 1}"#, &["b=2"]), r#"{"a": 1, "b": 2}"#);
        assert_eq!(after(r#"{"a": {} }"#, &["a.b.c=2"]), r#"{"a": {"b": {"c": 2}} }"#);
        assert_eq!(after(r#"{"a": []}"#, &["a[-]=1", "a[-]=2", "a[-].b=3"]), r#"{"a": [1, 2, {"b": 3}]}"#);
        assert_eq!(after("{ }", &["a.b=1", "a.c=2", "a.b=3"]), r#"{"a": {"b": 3, "c": 2} }"#);
    }

    #[test]
    fn errors_of_patches_say_what_is_wrong() {
        let text = r#"{"a": [1, {"name": "prism"}], "e": [], "f": [1]}"#;
        for (set, message) in [
            ("a", "patch a: found no `=`; expected PATH=JSON, such as render.passes=4"),
            ("=1", "patch : found no path before `=`; expected PATH=JSON, such as render.passes=4"),
            ("a=", "patch a: found no value after `=`; expected a JSON value"),
            ("a..b=1", "patch a..b: cannot read the path \"a..b\"; expected one like objects[0].shape.sphere.radius"),
            (
                "a[0]=crown",
                "patch a[0]: found the bare word crown; expected JSON; a string needs double quotes, and in a shell also \
                 single quotes: 'a[0]=\"crown\"'",
            ),
            ("a={\"b\": 1,}", "patch a: malformed JSON: found a trailing comma; expected no comma before `}`"),
            ("a=1 2", "patch a: malformed JSON: found 2 after the end; expected nothing more"),
            ("a=NaN", "patch a: malformed JSON: found NaN; expected a finite number"),
            ("a[2]=1", "patch a[2]: found no element 2; expected an index of a from 0 to 1; a[-] adds an element"),
            ("e[0]=1", "patch e[0]: found no element 0; expected no index, as e is empty; e[-] adds an element"),
            ("f[1]=1", "patch f[1]: found no element 1; expected index 0, the only one of f; f[-] adds an element"),
            (
                "a.prisn=1",
                "patch a.prisn: found no element with the name \"prisn\" in a; expected one of [0], prism; did you mean \"prism\"?",
            ),
            ("e.b=1", "patch e.b: found no element with the name \"b\" in e; expected no name, as it is empty"),
            ("a[0].b=1", "patch a[0].b: found 1 at a[0]; expected an object"),
            ("[0]=1", "patch [0]: found an object at the top level; expected an array"),
            ("x[0]=1", "patch x[0]: found nothing at x; expected a path through existing values"),
            ("x.y[0]=1", "patch x.y[0]: found nothing at x; expected a path through existing values"),
            (
                "a[name=prisn].b=1",
                "patch a[name=prisn].b: found no element with the name \"prisn\" in a; expected one of [0], prism; \
                 did you mean \"prism\"?",
            ),
        ] {
            assert_eq!(after(text, &[set]), message, "{set}");
        }
    }

    #[test]
    fn a_patch_that_nests_too_deeply_is_refused() {
        let deep = "[".repeat(128) + &"]".repeat(128);
        let message = "patch a: found arrays and objects nested more than 128 deep; expected at most 128 levels";
        assert_eq!(after("{}", &[&format!("a={deep}")]), message);
    }

    #[test]
    fn errors_have_the_position_in_the_file_or_the_patch() {
        let text = "{\"a\": 1,\n \"b\": [1, 2],\n \"c\": 3}";
        let sets = ["b[0]={\"long\": [1,\n2, 3]}", "b[0].long[1]=\"x\"", "d=4", "a=\n\n5"].map(str::to_string);
        let source = JsonSource::patched(text, Path::new("scene.json"), &sets).unwrap();
        let place = |path: &str| source.error_at(path, Error::input("wrong")).to_string();
        for (path, expected) in [
            ("", "scene.json:1:1: wrong"),
            ("a", "patch a: a: wrong"),
            ("b", "scene.json:2:7: b: wrong"),
            ("b[0]", "patch b[0]: b[0]: wrong"),
            ("b[0].long[0]", "patch b[0]: b[0].long[0]: wrong"),
            ("b[0].long[1]", "patch b[0].long[1]: b[0].long[1]: wrong"),
            ("b[0].long[2]", "patch b[0]: b[0].long[2]: wrong"),
            ("b[1]", "scene.json:2:11: b[1]: wrong"),
            ("b[1].no.such", "scene.json:2:11: b[1].no.such: wrong"),
            ("c", "scene.json:3:7: c: wrong"),
            ("d", "patch d: d: wrong"),
            ("no path [", "scene.json:1:1: no path [: wrong"),
        ] {
            assert_eq!(place(path), expected);
        }
        let elsewhere = Error::input("wrong").in_file(Path::new("lamp.csv")).at(3, 1);
        assert_eq!(source.error_at("c", elsewhere).to_string(), "lamp.csv:3:1: c: wrong");
    }
}
