//! `--set PATH=JSON`: changes the text of a scene before it is read.
//!
//! A patch replaces the value at its path. A last key that is missing is added to its object, and so are the objects on
//! the way to it. `[-]` adds an element to an array.

use std::path::Path;

use super::fault::found;
use super::path::{self, Step, quoted};
use super::positions::{Kind, Positions, Value};
use super::scan::{Malformed, scan};
use super::source::{MAX_BYTES, Origin, Piece, Source, line_column, too_large};
use crate::error::{Error, Result, nearest_name};

/// One patch as given on the command line.
struct Patch<'s> {
    /// Where.
    steps: Vec<Step>,
    /// The new value.
    json: &'s str,
    /// The name of its place in errors.
    label: String,
}

/// A change of the text: the span `from..to` becomes `text`.
struct Edit {
    from: usize,
    to: usize,
    text: String,
}

/// The source of a text with all patches applied.
pub(super) fn patched(text: &str, file: &Path, sets: &[String]) -> Result<Source> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.len() as u64 > MAX_BYTES {
        return Err(too_large().in_file(file));
    }
    let at_place = |Malformed { offset, error }: Malformed| {
        let (line, column) = line_column(text, offset);
        error.in_file(file).at(line, column)
    };
    let mut positions = scan(text).map_err(at_place)?;
    let mut current = text.to_string();
    let mut pieces = vec![Piece { start: 0, origin: Origin::File(0) }];
    for set in sets {
        let patch = read_patch(set)?;
        let edit = patch.edit(positions.root(&current)).map_err(|error| error.in_file(Path::new(&patch.label)))?;
        pieces = split(&pieces, &edit, &patch.label, current.len());
        current.replace_range(edit.from..edit.to, &edit.text);
        positions = rescan(&current, &patch.label)?;
    }
    let unpatched = (!sets.is_empty()).then(|| text.to_string());
    Ok(Source::new(file, current, unpatched, pieces, positions))
}

/// Scans a text that was patched; text and patch are sound, but together they can still be too large or too deep.
fn rescan(text: &str, label: &str) -> Result<Positions> {
    if text.len() as u64 > MAX_BYTES {
        return Err(too_large().in_file(Path::new(label)));
    }
    scan(text).map_err(|malformed| malformed.error.in_file(Path::new(label)))
}

/// Reads `PATH=JSON`.
fn read_patch(set: &str) -> Result<Patch<'_>> {
    let label = |path: &str| format!("--set {}", path.trim());
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
        return Err(place(Error::input("found no value behind `=`").expected("a JSON value")));
    }
    if is_bare_word(json) {
        let expected = format!("JSON; a string needs its quotes, and those a shell's: --set '{path}={}'", quoted(json));
        return Err(place(Error::input(format!("found the bare word {json}")).expected(expected)));
    }
    scan(json).map_err(|Malformed { offset: _, mut error }| {
        error.place.path = None;
        place(error)
    })?;
    Ok(Patch { steps, json, label })
}

/// Splits at the first `=` that is not inside brackets.
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

/// Whether a text looks like a string whose quotes the shell took; words that the scanner explains better do not count.
fn is_bare_word(json: &str) -> bool {
    let starts = json.starts_with(|c: char| c.is_alphabetic() || matches!(c, '_' | '/' | '.' | '~'));
    let explained = ["true", "false", "null", "none", "nan", "inf", "infinity"];
    starts && !json.contains(['"', '{', '[', '\n']) && !explained.contains(&json.to_ascii_lowercase().as_str())
}

impl Patch<'_> {
    /// The change of the text whose outermost value is `root`.
    fn edit(&self, root: Value) -> Result<Edit> {
        let mut value = root;
        for (i, step) in self.steps.iter().enumerate() {
            match value.step(step) {
                Some(below) => value = below,
                None => return self.addition(value, i),
            }
        }
        Ok(Edit { from: value.start(), to: value.end(), text: self.json.to_string() })
    }

    /// The change that adds what is missing from step `i` on to the value before it.
    fn addition(&self, value: Value, i: usize) -> Result<Edit> {
        let (before, step, rest) = (&self.steps[..i], &self.steps[i], &self.steps[i + 1..]);
        let mut text = self.json.to_string();
        for step in rest.iter().rev() {
            let Step::Key(key) = step else { return Err(nothing_there(&self.steps[..=i])) };
            text = format!("{{{}: {text}}}", quoted(key));
        }
        match (step, value.kind()) {
            (Step::Key(key), Kind::Object) => text = format!("{}: {text}", quoted(key)),
            (Step::Append, Kind::Array) => {}
            (Step::Index(index), Kind::Array) => return Err(out_of_range(before, *index, value)),
            (Step::Named(name), Kind::Array) => return Err(no_such_name(before, name, value)),
            (Step::Key(_), _) => return Err(not_a(before, value, "an object")),
            (Step::Index(_) | Step::Append | Step::Named(_), _) => return Err(not_a(before, value, "an array")),
        }
        // Behind the last content, or right behind the opening bracket of an empty container.
        let last = value.elements().last();
        let at = last.map_or(value.start() + 1, Value::end);
        let text = if last.is_some() { format!(", {text}") } else { text };
        Ok(Edit { from: at, to: at, text })
    }
}

/// The error for a path that goes through a value which is missing and cannot be added.
fn nothing_there(steps: &[Step]) -> Error {
    Error::input(format!("found nothing at {}", path::display(steps))).expected("a path through values of the scene")
}

/// The error for an element that is not there.
fn out_of_range(array: &[Step], index: usize, value: Value) -> Error {
    let array = path::display(array);
    let error = Error::input(format!("found no element {index}"));
    match value.elements().count() {
        0 => error.expected(format!("no index, as {array} is empty; {array}[-] adds an element")),
        1 => error.expected(format!("index 0, the only one of {array}; {array}[-] adds an element")),
        count => error.expected(format!("an index of {array} from 0 to {}; {array}[-] adds an element", count - 1)),
    }
}

/// The error for a name that no element of an array has.
fn no_such_name(array: &[Step], name: &str, value: Value) -> Error {
    let names: Vec<_> = value.elements().filter_map(|element| element.get("name")).collect();
    let names: Vec<_> = names.into_iter().filter(|name| name.kind() == Kind::String).map(Value::content).collect();
    let near = nearest_name(name, names.iter().map(AsRef::as_ref));
    let what = format!("found no element with the name {} in {}", quoted(name), path::display(array));
    Error { near, ..Error::input(what) }
}

/// The error for a step into a value that is neither object nor array, or the other of the two.
fn not_a(steps: &[Step], value: Value, wanted: &str) -> Error {
    let place = if steps.is_empty() { "the scene".to_string() } else { path::display(steps) };
    Error::input(format!("found {} at {place}", found(value))).expected(wanted)
}

/// The pieces of a text of `length` bytes after an edit.
fn split(pieces: &[Piece], edit: &Edit, label: &str, length: usize) -> Vec<Piece> {
    let ends = pieces.iter().skip(1).map(|piece| piece.start).chain([length]);
    let (mut before, mut after) = (Vec::new(), Vec::new());
    for (piece, end) in pieces.iter().zip(ends) {
        if piece.start < edit.from {
            before.push(piece.clone());
        }
        if end > edit.to {
            let skipped = edit.to.saturating_sub(piece.start);
            let origin = match &piece.origin {
                Origin::File(offset) => Origin::File(offset + skipped),
                Origin::Set(label) => Origin::Set(label.clone()),
            };
            after.push(Piece { start: piece.start + skipped - edit.to + edit.from + edit.text.len(), origin });
        }
    }
    before.push(Piece { start: edit.from, origin: Origin::Set(label.to_string()) });
    before.extend(after);
    before
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text after patches.
    fn after(text: &str, sets: &[&str]) -> String {
        let sets: Vec<_> = sets.iter().map(|set| set.to_string()).collect();
        patched(text, Path::new("scene.json"), &sets).map_or_else(|error| error.to_string(), |source| source.text)
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
    fn missing_keys_and_elements_are_added() {
        assert_eq!(after(r#"{"a": 1}"#, &["b=2"]), r#"{"a": 1, "b": 2}"#);
        assert_eq!(after(r#"{"a": {} }"#, &["a.b.c=2"]), r#"{"a": {"b": {"c": 2}} }"#);
        assert_eq!(after(r#"{"a": []}"#, &["a[-]=1", "a[-]=2", "a[-].b=3"]), r#"{"a": [1, 2, {"b": 3}]}"#);
        assert_eq!(after("{ }", &["a.b=1", "a.c=2", "a.b=3"]), r#"{"a": {"b": 3, "c": 2} }"#);
    }

    #[test]
    fn what_cannot_be_patched_is_explained() {
        let text = r#"{"a": [1, {"name": "prism"}], "e": [], "f": [1]}"#;
        for (set, message) in [
            ("a", "--set a: found no `=`; expected PATH=JSON, such as render.passes=4"),
            ("=1", "--set : found no path before `=`; expected PATH=JSON, such as render.passes=4"),
            ("a=", "--set a: found no value behind `=`; expected a JSON value"),
            ("a..b=1", "--set a..b: cannot read the path \"a..b\"; expected one like objects[0].shape.sphere.radius"),
            (
                "a[0]=crown",
                "--set a[0]: found the bare word crown; expected JSON; a string needs its quotes, and those a shell's: \
                 --set 'a[0]=\"crown\"'",
            ),
            ("a={\"b\": 1,}", "--set a: malformed JSON: found a trailing comma; expected no comma before `}`"),
            ("a=1 2", "--set a: malformed JSON: found 2 after the end; expected nothing more"),
            ("a=NaN", "--set a: malformed JSON: found NaN; expected a finite number"),
            ("a[2]=1", "--set a[2]: found no element 2; expected an index of a from 0 to 1; a[-] adds an element"),
            ("e[0]=1", "--set e[0]: found no element 0; expected no index, as e is empty; e[-] adds an element"),
            ("f[1]=1", "--set f[1]: found no element 1; expected index 0, the only one of f; f[-] adds an element"),
            ("a.b=1", "--set a.b: found an array of 2 at a; expected an object"),
            ("a[0].b=1", "--set a[0].b: found 1 at a[0]; expected an object"),
            ("[0]=1", "--set [0]: found an object at the scene; expected an array"),
            ("x[0]=1", "--set x[0]: found nothing at x; expected a path through values of the scene"),
            ("x.y[0]=1", "--set x.y[0]: found nothing at x; expected a path through values of the scene"),
            (
                "a[name=prisn].b=1",
                "--set a[name=prisn].b: found no element with the name \"prisn\" in a; did you mean \"prism\"?",
            ),
        ] {
            assert_eq!(after(text, &[set]), message, "{set}");
        }
    }

    #[test]
    fn a_patch_can_go_too_deep() {
        let deep = "[".repeat(128) + &"]".repeat(128);
        let message = "--set a: found arrays and objects nested more than 128 deep; expected at most 128 levels";
        assert_eq!(after("{}", &[&format!("a={deep}")]), message);
    }

    #[test]
    fn places_are_those_of_the_file_or_of_the_patch() {
        let text = "{\"a\": 1,\n \"b\": [1, 2],\n \"c\": 3}";
        let sets = ["b[0]={\"long\": [1,\n2, 3]}", "b[0].long[1]=\"x\"", "d=4", "a=\n\n5"].map(str::to_string);
        let source = patched(text, Path::new("scene.json"), &sets).unwrap();
        let place = |path: &str| source.error_at(path, Error::input("wrong")).to_string();
        for (path, expected) in [
            ("", "scene.json:1:1: wrong"),
            ("a", "--set a: a: wrong"),
            ("b", "scene.json:2:7: b: wrong"),
            ("b[0]", "--set b[0]: b[0]: wrong"),
            ("b[0].long[0]", "--set b[0]: b[0].long[0]: wrong"),
            ("b[0].long[1]", "--set b[0].long[1]: b[0].long[1]: wrong"),
            ("b[0].long[2]", "--set b[0]: b[0].long[2]: wrong"),
            ("b[1]", "scene.json:2:11: b[1]: wrong"),
            ("b[1].no.such", "scene.json:2:11: b[1].no.such: wrong"),
            ("c", "scene.json:3:7: c: wrong"),
            ("d", "--set d: d: wrong"),
            ("no path [", "scene.json:1:1: no path [: wrong"),
        ] {
            assert_eq!(place(path), expected);
        }
        let elsewhere = Error::input("wrong").in_file(Path::new("lamp.csv")).at(3, 1);
        assert_eq!(source.error_at("c", elsewhere).to_string(), "lamp.csv:3:1: c: wrong");
    }
}
