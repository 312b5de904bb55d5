//! Expands the text of a scene: parts in other files, variables and groups of objects.
//!
//! Each step edits the text and keeps the origin of all its parts, so that later errors have the
//! position in the file that contains the wrong value.

use super::describe::{found, one_of};
use super::file_access::FileAccess;
use super::origin::{OriginalFile, PieceOrigin};
use super::patch::{PatchedText, TextEdit};
use super::path::quoted;
use super::positions::{SpannedValue, ValueKind};
use super::scan::{SyntaxError, scan};
use super::text::read_text;
use abbe_spectra::error::{Error, Result, nearest_name};
use std::path::Path;

/// The sections that a part of a scene may contain, and whether each is a list.
const PART_SECTIONS: [(&str, bool); 8] = [
    ("variables", false),
    ("spectra", false),
    ("media", false),
    ("materials", false),
    ("shapes", false),
    ("objects", true),
    ("lights", true),
    ("meters", true),
];

/// The keys of a group.
const GROUP_KEYS: [&str; 5] = ["name", "group", "transform", "motion", "note"];

/// Returns an error at a value, with an offset in the text.
type Fault = (usize, Error);

fn fault(at: SpannedValue, what: impl Into<String>, expected: impl Into<String>) -> Fault {
    (at.start(), Error::input(what).expected(expected))
}

fn unknown(at: SpannedValue, kind: &str, name: &str, known: &[&str]) -> Fault {
    let error = Error::input(format!("unknown {kind} {}", quoted(name)));
    let error = error.expected(if known.is_empty() { "no name".to_string() } else { one_of(known) });
    (at.start(), Error { suggestion: nearest_name(name, known.iter().copied()), ..error })
}

/// Returns the text between the brackets of a container, with the offset of its first value.
fn contents(container: SpannedValue<'_>) -> Option<(usize, &str)> {
    let last = container.children().last()?;
    let first = container.children().next()?;
    let from = first.start() - container.start();
    Some((first.start(), &container.written()[from..last.end() - container.start()]))
}

/// Returns the place after the last value of a container, and the separator of a further value.
fn end_of(container: SpannedValue) -> (usize, &'static str) {
    container.children().last().map_or((container.start() + 1, ""), |last| (last.end(), ", "))
}

impl PatchedText {
    /// Returns whether the text contains variables or groups.
    pub(super) fn has_shorthands(&self) -> bool {
        let root = self.positions.root(&self.text);
        let in_group = |objects: SpannedValue| objects.children().any(|object| object.get("group").is_some());
        root.get("variables").is_some() || root.get("objects").is_some_and(in_group)
    }

    /// Adds the sections of the files in `include` to those of the scene. `file` is the name of
    /// the scene, to whose folder the names are relative.
    pub(super) fn include(&mut self, file: &Path, access: FileAccess) -> Result<()> {
        let root = self.positions.root(&self.text);
        let Some(list) = root.get("include") else { return Ok(()) };
        let at = |(offset, error): Fault| self.place(file, offset, error);
        let expected = "an array of names of files, such as [\"materials.json\"]";
        if list.kind() != ValueKind::Array {
            return Err(at(fault(list, format!("found {}", found(list)), expected)).on_path("include"));
        }
        if list.children().next().is_none() {
            return Ok(());
        }
        let (mut parts, mut edits) =
            (self.parts.clone(), vec![TextEdit::replacing(list, "[]", self.origin(list.start()))]);
        let mut found_sections: Vec<(usize, PartSection)> = Vec::new();
        for (i, name) in list.children().enumerate() {
            let path_of_name = format!("include[{i}]");
            if name.kind() != ValueKind::String {
                return Err(
                    at(fault(name, format!("found {}", found(name)), "the name of a file")).on_path(path_of_name)
                );
            }
            let folder = file.parent().unwrap_or(Path::new(""));
            let path = access.file(folder, Path::new(&*name.content()));
            let path = path.map_err(|error| at((name.start(), error)).on_path(&path_of_name))?;
            let unreadable = |error: Error| match error.location.line_column {
                Some(_) => error,
                None => at((name.start(), Error::input(format!("{} {}", name.written(), error.what)))),
            };
            let text = read_text(&path).map_err(|error| unreadable(error).on_path(&path_of_name))?;
            let part = parts.len();
            found_sections.extend(sections(&text, &path)?.into_iter().map(|section| (part, section)));
            parts.push(OriginalFile { path: path.into(), text });
        }
        let here = PieceOrigin::At(Box::new(self.origin(list.start())));
        for (key, is_list) in PART_SECTIONS {
            let mut added = found_sections.iter().filter(|(_, section)| section.key == key).peekable();
            let own = root.get(key);
            let [open, close] = if is_list { ["[", "]"] } else { ["{", "}"] };
            let (place, mut separator) = match own {
                // A section of another kind is refused later.
                Some(own) if (own.kind() == ValueKind::Array) != is_list => continue,
                _ if added.peek().is_none() => continue,
                Some(own) => end_of(own),
                None => (end_of(root).0, ""),
            };
            if own.is_none() {
                edits.push(TextEdit::insertion(place, format!(", {}: {open}", quoted(key)), here.clone()));
            }
            for (part, PartSection { start, contents, .. }) in added {
                edits.push(TextEdit::insertion(place, separator, here.clone()));
                edits.push(TextEdit::insertion(place, contents.as_str(), PieceOrigin::Part(*part, *start)));
                separator = ", ";
            }
            if own.is_none() {
                edits.push(TextEdit::insertion(place, close, here.clone()));
            }
        }
        self.parts = parts;
        self.apply(edits, file)
    }

    /// Replaces each string `"$name"` by the value of this name in `variables`.
    pub(super) fn substitute(&mut self, file: &Path) -> Result<()> {
        let root = self.positions.root(&self.text);
        let Some(variables) = root.get("variables") else { return Ok(()) };
        let at = |(offset, error): Fault, id: u32| self.place(file, offset, error).on_path(root.path_to(id));
        if variables.kind() != ValueKind::Object {
            let what = format!("found {}", found(variables));
            return Err(at(fault(variables, what, "an object of names and values"), variables.id()));
        }
        let known: Vec<_> = variables.entries().map(|(name, value)| (name.content(), value)).collect();
        let names: Vec<&str> = known.iter().map(|(name, _)| name.as_ref()).collect();
        let mut edits = Vec::new();
        let mut faults = Vec::new();
        for id in self.positions.ids() {
            let value = root.with_id(id);
            if !value.written().starts_with("\"$") || root.is_key(id) {
                continue;
            }
            let content = value.content();
            let name = content.trim_start_matches('$');
            if variables.contains(id) {
                let expected = "a value; a variable cannot contain another one";
                faults.push(at(fault(value, format!("found {}", value.written()), expected), id));
            } else if let Some((_, replacement)) = known.iter().find(|(known, _)| known == name) {
                let origin = PieceOrigin::At(Box::new(self.origin(value.start())));
                edits.push(TextEdit::replacing(value, replacement.written(), origin));
            } else {
                faults.push(at(unknown(value, "variable", name, &names), id));
            }
        }
        if let Some(error) = Error::all(faults) {
            return Err(error);
        }
        edits.push(TextEdit::replacing(variables, "{}", self.origin(variables.start())));
        self.apply(edits, file)
    }

    /// Replaces each group in `objects` by its objects, to which it adds its transform and motion.
    pub(super) fn ungroup(&mut self, file: &Path) -> Result<()> {
        let root = self.positions.root(&self.text);
        let objects = root.get("objects").filter(|objects| objects.kind() == ValueKind::Array);
        let groups =
            objects.iter().flat_map(|objects| objects.children()).filter(|object| object.get("group").is_some());
        let mut edits = Vec::new();
        let faults: Vec<Error> = groups
            .filter_map(|group| self.replace_group(group, &Inherited::default(), &mut edits).err())
            .map(|(offset, error)| {
                let inside = self.positions.ids().rev().find(|id| root.with_id(*id).start() == offset);
                self.place(file, offset, error).on_path(inside.map_or_else(String::new, |id| root.path_to(id)))
            })
            .collect();
        match Error::all(faults) {
            Some(error) => Err(error),
            None if edits.is_empty() => Ok(()),
            None => self.apply(edits, file),
        }
    }

    fn replace_group(
        &self,
        group: SpannedValue,
        outer: &Inherited<'_>,
        edits: &mut Vec<TextEdit>,
    ) -> std::result::Result<(), Fault> {
        let objects = group.get("group").expect("the caller has found a group");
        if let Some((key, _)) = group.entries().find(|(key, _)| !GROUP_KEYS.contains(&key.content().as_ref())) {
            return Err(unknown(key, "key", &key.content(), &GROUP_KEYS));
        }
        if objects.kind() != ValueKind::Array {
            return Err(fault(objects, format!("found {}", found(objects)), "an array of objects"));
        }
        let (Some(first), Some(last)) = (objects.children().next(), objects.children().last()) else {
            return Err(fault(objects, "found an empty array", "at least one object"));
        };
        let array = |key: &str| match group.get(key) {
            Some(list) if list.kind() != ValueKind::Array => {
                Err(fault(list, format!("found {}", found(list)), "an array"))
            }
            list => Ok(list),
        };
        let mut inherited = Inherited { transforms: array("transform")?.into_iter().collect(), motion: outer.motion };
        inherited.transforms.extend(&outer.transforms);
        if let Some(motion) = array("motion")? {
            inherited.add_motion(motion)?;
        }
        edits.push(TextEdit::removal(group.start(), first.start(), self.origin(group.start())));
        for object in objects.children() {
            if object.get("group").is_some() {
                self.replace_group(object, &inherited, edits)?;
            } else if object.kind() == ValueKind::Object {
                self.place_object(object, &inherited, edits)?;
            }
        }
        edits.push(TextEdit::removal(last.end(), group.end(), self.origin(last.end())));
        Ok(())
    }

    /// Adds the transform and the motion of its groups to an object.
    fn place_object(
        &self,
        object: SpannedValue,
        inherited: &Inherited<'_>,
        edits: &mut Vec<TextEdit>,
    ) -> std::result::Result<(), Fault> {
        let here = PieceOrigin::At(Box::new(self.origin(object.start())));
        let (end, mut entry_separator) = end_of(object);
        let own = object.get("transform");
        let steps: Vec<(usize, &str)> = inherited.transforms.iter().filter_map(|list| contents(*list)).collect();
        if !steps.is_empty() && own.is_none_or(|own| own.kind() == ValueKind::Array) {
            let (place, mut separator) = own.map_or((end, ""), end_of);
            if own.is_none() {
                edits.push(TextEdit::insertion(place, format!("{entry_separator}\"transform\": ["), here.clone()));
                entry_separator = ", ";
            }
            for (start, text) in steps {
                edits.push(TextEdit::insertion(place, separator, here.clone()));
                edits.push(TextEdit::insertion(place, text, self.origin_of(start, start + text.len())));
                separator = ", ";
            }
            if own.is_none() {
                edits.push(TextEdit::insertion(place, "]", here.clone()));
            }
        }
        if let Some(motion) = inherited.motion {
            if let Some(own) = object.get("motion") {
                return Err(second_motion(own));
            }
            let origin = self.origin_of(motion.start(), motion.end());
            edits.push(TextEdit::insertion(end, format!("{entry_separator}\"motion\": "), here));
            edits.push(TextEdit::insertion(end, motion.written(), origin));
        }
        Ok(())
    }
}

/// What a group gives to its objects.
#[derive(Debug, Clone, Default)]
struct Inherited<'t> {
    /// The lists of transform steps, of the innermost group first.
    transforms: Vec<SpannedValue<'t>>,
    motion: Option<SpannedValue<'t>>,
}

impl<'t> Inherited<'t> {
    fn add_motion(&mut self, motion: SpannedValue<'t>) -> std::result::Result<(), Fault> {
        if self.motion.replace(motion).is_some() { Err(second_motion(motion)) } else { Ok(()) }
    }
}

fn second_motion(motion: SpannedValue) -> Fault {
    fault(motion, "found the motion of a part of a moving group", "one motion, of the group or of its parts")
}

/// The contents of a section of a part.
struct PartSection {
    key: &'static str,
    /// The byte offset of the contents in the part.
    start: usize,
    contents: String,
}

/// Returns the sections of a part of a scene that are not empty.
fn sections(text: &str, path: &Path) -> Result<Vec<PartSection>> {
    let at = |(offset, error): Fault| OriginalFile::place(path, text, offset, error);
    let positions = scan(text).map_err(|SyntaxError { offset, error }| at((offset, error)))?;
    let root = positions.root(text);
    if root.kind() != ValueKind::Object {
        return Err(at(fault(root, format!("found {}", found(root)), "an object with sections of a scene")));
    }
    let mut found_sections = Vec::new();
    for (key, section) in root.entries() {
        let name = key.content();
        let known = PART_SECTIONS.iter().find(|(known, _)| *known == name);
        let Some(&(known, is_list)) = known else {
            if name == "note" && section.kind() == ValueKind::String {
                continue;
            }
            let names = PART_SECTIONS.map(|(name, _)| name);
            return Err(at(unknown(key, "key", &name, &names)));
        };
        let wanted = if is_list { (ValueKind::Array, "an array") } else { (ValueKind::Object, "an object") };
        if section.kind() != wanted.0 {
            return Err(at(fault(section, format!("found {}", found(section)), wanted.1)).on_path(known));
        }
        if let Some((start, contents)) = contents(section) {
            found_sections.push(PartSection { key: known, start, contents: contents.to_string() });
        }
    }
    Ok(found_sections)
}
