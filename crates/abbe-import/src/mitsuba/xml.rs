//! Reads the XML elements of a Mitsuba scene, with parameters, included files and identifiers.

use abbe_format::{FileAccess, read_text};
use abbe_spectra::error::{Error, Result};
use roxmltree::Node;
use std::collections::BTreeMap;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The largest depth of elements, counting references to other elements.
const MAX_NESTING: usize = 64;

/// The largest depth of included files. Mitsuba has the same limit.
const MAX_INCLUDE_DEPTH: usize = 15;

/// The largest number of elements in all files.
const MAX_ELEMENTS: usize = 1_000_000;

/// The largest number of files that are included, counting repetitions.
const MAX_INCLUDES: usize = 1000;

/// The largest number of bytes that parameters insert into all files.
const MAX_INSERTED: usize = 1 << 24;

/// An element of a Mitsuba scene. Parameters are replaced by their values.
#[derive(Debug)]
pub(super) struct XmlElement {
    /// The tag, such as "bsdf".
    pub(super) tag: String,
    attributes: Vec<(String, String)>,
    /// The elements inside, with the content of included files.
    pub(super) children: Vec<Rc<XmlElement>>,
    /// The path of the file as the user named it.
    file: Rc<Path>,
    /// The folder of the file relative to the folder of the scene. It is empty or ends with "/".
    folder: Rc<str>,
    line: usize,
}

impl XmlElement {
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Returns the value of an attribute, or an error that names the attribute.
    pub(super) fn required(&self, name: &str) -> Result<&str> {
        self.attribute(name).ok_or_else(|| self.error(format!("<{}> without the attribute \"{name}\"", self.tag)))
    }

    /// Returns the plugin, such as "diffuse". It is empty for properties.
    pub(super) fn plugin(&self) -> &str {
        self.attribute("type").unwrap_or_default()
    }

    pub(super) fn name(&self) -> &str {
        self.attribute("name").unwrap_or_default()
    }

    pub(super) fn title(&self) -> &str {
        self.attribute("id").unwrap_or_else(|| self.plugin())
    }

    /// Returns the file and the line, for remarks.
    pub(super) fn place(&self) -> String {
        format!("{}:{}", self.file.file_name().unwrap_or_default().to_string_lossy(), self.line)
    }

    pub(super) fn error(&self, what: impl Into<String>) -> Error {
        Error::input(what).in_file(&self.file).at(self.line, 1)
    }

    pub(super) fn locate(&self, error: Error) -> Error {
        let at = error.location.file.clone().map_or_else(String::new, |file| format!("{}: ", file.display()));
        let located = Error { expected: error.expected, ..self.error(format!("{at}{}", error.what)) };
        Error { suggestion: error.suggestion, ..located }
    }
}

/// The height of the tree below each element.
type Heights = HashMap<*const XmlElement, usize>;

/// The elements of a scene, with all included files.
#[derive(Debug)]
pub(super) struct MitsubaDocument {
    /// The element `<scene>`.
    pub(super) root: Rc<XmlElement>,
    by_id: BTreeMap<String, Rc<XmlElement>>,
    folder: PathBuf,
    pub(super) file_access: FileAccess,
    /// Folders of `<path>` elements, relative to the folder of the scene. Each ends with "/".
    search: Vec<String>,
}

impl MitsubaDocument {
    /// Reads a scene, and checks the references and the nesting of its elements.
    pub(super) fn read(path: &Path, file_access: FileAccess) -> Result<Self> {
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let mut loader = XmlLoader { folder, file_access, ..XmlLoader::default() };
        let root = Rc::new(loader.file(path, "", 0)?);
        if root.tag != "scene" {
            let error = root.error(format!("found the XML root <{}>", root.tag));
            return Err(error.expected("<scene>, the root of a Mitsuba scene"));
        }
        let XmlLoader { by_id, folder, file_access, search, .. } = loader;
        let document = Self { root, by_id, folder, file_access, search };
        document.height(&document.root, 0, &mut Heights::new())?;
        Ok(document)
    }

    /// Returns the element that a `<ref>` names. Returns other elements unchanged.
    pub(super) fn resolve(&self, element: &Rc<XmlElement>) -> Rc<XmlElement> {
        let mut found = element;
        // Chains of references do not occur in valid scenes, and the checks in `read` limit them.
        while found.tag == "ref" {
            let Some(next) = found.attribute("id").and_then(|id| self.by_id.get(id)) else { break };
            found = next;
        }
        Rc::clone(found)
    }

    /// Returns the path of an existing file, relative to the scene's folder and for reading.
    pub(super) fn file(&self, element: &XmlElement, name: &str) -> Result<(String, PathBuf)> {
        find_file(&self.folder, self.file_access, &self.search, &element.folder, name)
            .map_err(|error| element.locate(error))
    }

    /// Returns the height of the tree below an element, and refuses missing or circular references.
    fn height(&self, element: &Rc<XmlElement>, level: usize, known: &mut Heights) -> Result<usize> {
        if let Some(&height) = known.get(&Rc::as_ptr(element))
            && level + height <= MAX_NESTING
        {
            return Ok(height);
        }
        if level >= MAX_NESTING {
            return Err(element.error("the elements refer to each other in a circle, or are nested too deeply"));
        }
        let mut height = 0;
        if element.tag == "ref" {
            let id = element.required("id")?;
            let next = self.by_id.get(id).ok_or_else(|| {
                let unknown = Error::unknown_name("identifier", id, self.by_id.keys().map(String::as_str));
                element.locate(unknown)
            })?;
            height = 1 + self.height(next, level + 1, known)?;
        }
        for child in &element.children {
            height = height.max(1 + self.height(child, level + 1, known)?);
        }
        known.insert(Rc::as_ptr(element), height);
        Ok(height)
    }
}

/// Returns the path of a file relative to the folder of the scene, and the path for reading.
/// `near` is the folder of the file that names it.
fn find_file(root: &Path, access: FileAccess, search: &[String], near: &str, name: &str) -> Result<(String, PathBuf)> {
    if name.is_empty() {
        return Err(Error::input("the file name is empty"));
    }
    let candidates = search.iter().map(String::as_str).chain([near, ""]);
    let mut refused = None;
    for start in candidates {
        let relative = if Path::new(name).is_absolute() { name.to_string() } else { format!("{start}{name}") };
        match access.file(root, Path::new(&relative)) {
            Ok(path) if path.is_file() => return Ok((relative, path.into())),
            Ok(_) => {}
            Err(error) => refused = Some(error),
        }
    }
    Err(refused.unwrap_or_else(|| Error::input(format!("the file \"{name}\" does not exist"))))
}

#[derive(Default)]
struct XmlLoader {
    folder: PathBuf,
    file_access: FileAccess,
    /// The values of `<default>` elements, the longest names first, as a name may start another.
    parameters: Vec<(String, String)>,
    by_id: BTreeMap<String, Rc<XmlElement>>,
    search: Vec<String>,
    elements: usize,
    includes: usize,
    inserted: usize,
}

/// The properties of one file that its elements share.
struct FileContext {
    file: Rc<Path>,
    folder: Rc<str>,
    include_depth: usize,
    /// True for version 0.x and 1.x, in which names have the form `toWorld`.
    camel_case: bool,
}

impl XmlLoader {
    /// Reads a file, and returns its root. `folder` is relative to the folder of the scene.
    fn file(&mut self, path: &Path, folder: &str, include_depth: usize) -> Result<XmlElement> {
        let text = read_text(path)?;
        let document = roxmltree::Document::parse(&text).map_err(|error| {
            let place = error.pos();
            Error::input(format!("invalid XML: {error}")).in_file(path).at(place.row as usize, place.col as usize)
        })?;
        let root = document.root_element();
        let version = root.attribute("version").and_then(|it| it.split('.').next()?.trim().parse::<u32>().ok());
        let camel_case = version.is_some_and(|major| major < 2);
        let context = FileContext { file: path.into(), folder: folder.into(), include_depth, camel_case };
        self.element(root, &context, 0)
    }

    fn element(&mut self, node: Node<'_, '_>, context: &FileContext, level: usize) -> Result<XmlElement> {
        let line = node.document().text_pos_at(node.range().start).row as usize;
        let (file, folder) = (Rc::clone(&context.file), Rc::clone(&context.folder));
        let tag = node.tag_name().name().to_string();
        let mut element = XmlElement { tag, attributes: Vec::new(), children: Vec::new(), file, folder, line };
        self.elements += 1;
        if level >= MAX_NESTING || self.elements > MAX_ELEMENTS {
            return Err(element.error("the elements are nested too deeply, or there are too many"));
        }
        for attribute in node.attributes() {
            let mut value = self.substituted(attribute.value()).map_err(|error| element.locate(error))?;
            if context.camel_case && attribute.name() == "name" {
                value = snake_case(&value);
            }
            element.attributes.push((attribute.name().to_string(), value));
        }
        for child in node.children().filter(Node::is_element) {
            let child = self.element(child, context, level + 1)?;
            self.add_child(&mut element, child, context)?;
        }
        Ok(element)
    }

    /// Adds an element to its parent. Elements that are instructions to the reader are obeyed.
    fn add_child(&mut self, parent: &mut XmlElement, child: XmlElement, context: &FileContext) -> Result<()> {
        match child.tag.as_str() {
            "default" => self.add_parameter(child.required("name")?, child.required("value")?),
            "alias" => {
                let (id, alias) = (child.required("id")?, child.required("as")?);
                let unknown = || child.error(format!("the alias of the unknown identifier \"{id}\""));
                let target = self.by_id.get(id).cloned().ok_or_else(unknown)?;
                self.add_id(alias.to_string(), target)?;
            }
            "path" => {
                let folder = child.required("value")?.trim_end_matches('/');
                self.search.push(format!("{}{folder}/", child.folder));
            }
            "include" => {
                let included = self.include(&child, context)?;
                // The root of an included scene is omitted.
                if included.tag == "scene" {
                    parent.children.extend(included.children);
                } else {
                    self.push(parent, included)?;
                }
            }
            _ => self.push(parent, child)?,
        }
        Ok(())
    }

    fn push(&mut self, parent: &mut XmlElement, child: XmlElement) -> Result<()> {
        let child = Rc::new(child);
        if child.tag != "ref"
            && let Some(id) = child.attribute("id")
        {
            self.add_id(id.to_string(), Rc::clone(&child))?;
        }
        parent.children.push(child);
        Ok(())
    }

    fn add_id(&mut self, id: String, element: Rc<XmlElement>) -> Result<()> {
        if self.by_id.contains_key(&id) {
            return Err(element.error(format!("the identifier \"{id}\" occurs twice")));
        }
        self.by_id.insert(id, element);
        Ok(())
    }

    fn include(&mut self, element: &XmlElement, context: &FileContext) -> Result<XmlElement> {
        self.includes += 1;
        if context.include_depth >= MAX_INCLUDE_DEPTH {
            return Err(element.error(format!("more than {MAX_INCLUDE_DEPTH} files include each other")));
        }
        if self.includes > MAX_INCLUDES {
            return Err(element.error(format!("more than {MAX_INCLUDES} files are included")));
        }
        let name = element.required("filename")?;
        let (relative, path) = find_file(&self.folder, self.file_access, &self.search, &element.folder, name)
            .map_err(|error| element.locate(error))?;
        let folder = relative.rfind('/').map_or("", |end| &relative[..=end]);
        self.file(&path, folder, context.include_depth + 1)
    }

    /// Sets a parameter, unless it has a value already.
    fn add_parameter(&mut self, name: &str, value: &str) {
        if !self.parameters.iter().any(|(known, _)| known == name) {
            let place = self.parameters.partition_point(|(known, _)| known.len() >= name.len());
            self.parameters.insert(place, (name.to_string(), value.to_string()));
        }
    }

    fn substituted(&mut self, text: &str) -> Result<String> {
        let mut rest = text;
        let mut result = String::new();
        while let Some(start) = rest.find('$') {
            let after = &rest[start + 1..];
            let known = self.parameters.iter().find(|(name, _)| !name.is_empty() && after.starts_with(name.as_str()));
            let (name, value) = known.ok_or_else(|| {
                let name: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                Error::unknown_name("parameter", &name, self.parameters.iter().map(|(name, _)| name.as_str()))
                    .expected("a parameter that a <default> element sets before its use")
            })?;
            self.inserted += value.len();
            if self.inserted > MAX_INSERTED {
                return Err(Error::input(format!("the parameters insert more than {MAX_INSERTED} bytes")));
            }
            result.push_str(&rest[..start]);
            result.push_str(value);
            rest = &after[name.len()..];
        }
        result.push_str(rest);
        Ok(result)
    }
}

/// Converts a name of Mitsuba 0.x, such as `toWorld`, to the form `to_world`.
fn snake_case(name: &str) -> String {
    let mut result = String::new();
    let mut before = '_';
    for letter in name.chars() {
        if letter.is_uppercase() && (before.is_lowercase() || before.is_numeric()) {
            result.push('_');
        }
        result.extend(letter.to_lowercase());
        before = letter;
    }
    result
}

/// Returns the number of a property such as `<float name="radius" value="2"/>`.
pub(super) fn number(element: &XmlElement) -> Result<f64> {
    let text = element.required("value")?;
    parse(element, text)
}

pub(super) fn parse(element: &XmlElement, text: &str) -> Result<f64> {
    let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| element.error(format!("found \"{}\"", text.trim())).expected("a number"))
}

/// Parses numbers that are separated by commas or blanks.
pub(super) fn numbers(element: &XmlElement, text: &str) -> Result<Vec<f64>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    words.map(|word| parse(element, word)).collect()
}
