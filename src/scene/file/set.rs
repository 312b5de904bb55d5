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

/// Whether a text looks like a string whose quotes the shell took.
fn is_bare_word(json: &str) -> bool {
    let starts = json.starts_with(|c: char| c.is_alphabetic() || matches!(c, '_' | '/' | '.' | '~'));
    starts && !json.contains(['"', '{', '[', '\n']) && !matches!(json, "true" | "false" | "null")
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
