//! Access to the elements of an XML document, with errors at their places.

use crate::luminaire::number::PlacedValue;
use abbe_spectra::error::{Error, Result};
use roxmltree::Node;

/// Returns the first child element with a name.
pub(super) fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| child.tag_name().name() == name)
}

/// Returns the child elements with a name.
pub(super) fn children<'a, 'b>(node: Node<'a, 'b>, name: &'static str) -> impl Iterator<Item = Node<'a, 'b>> {
    node.children().filter(move |child| child.tag_name().name() == name)
}

/// The largest number of emitters, spectra, areas and the like.
const FEW: usize = 256;

/// Returns the child elements with a name, or an error if there are more than [`FEW`].
pub(super) fn few<'a, 'b>(node: Node<'a, 'b>, name: &'static str) -> Result<Vec<Node<'a, 'b>>> {
    let found: Vec<Node<'a, 'b>> = children(node, name).take(FEW + 1).collect();
    match found.get(FEW) {
        Some(last) => Err(at(*last, Error::input(format!("too many <{name}>")).expected(format!("at most {FEW}")))),
        None => Ok(found),
    }
}

/// Returns the line and the column of an element, both from 1.
///
/// The document searches for the line from its start, so long lists use [`Places`].
pub(super) fn place(node: Node<'_, '_>) -> (usize, usize) {
    let place = node.document().text_pos_at(node.range().start);
    (place.row as usize, place.col as usize)
}

/// Adds the place of an element to an error.
pub(super) fn at(node: Node<'_, '_>, error: Error) -> Error {
    let (line, column) = place(node);
    error.at(line, column)
}

/// The places of elements in the order of the document, found in one walk over its text.
pub(super) struct Places<'a> {
    text: &'a str,
    offset: usize,
    line: usize,
    column: usize,
}

impl<'a> Places<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, offset: 0, line: 1, column: 1 }
    }

    /// Returns the line and the column of an element, which does not precede the one before.
    pub(super) fn of(&mut self, node: Node<'_, '_>) -> (usize, usize) {
        let start = node.range().start;
        for sign in self.text[self.offset..start].chars() {
            (self.line, self.column) = if sign == '\n' { (self.line + 1, 1) } else { (self.line, self.column + 1) };
        }
        self.offset = start;
        (self.line, self.column)
    }
}

/// Returns the number that an element contains.
pub(super) fn number(node: Node<'_, '_>) -> Result<PlacedValue> {
    let (line, column) = place(node);
    PlacedValue::parse(node.text().unwrap_or("").trim(), &format!("<{}>", node.tag_name().name()), line, column)
}

/// Returns the number in a child element, or `None` if it is missing.
pub(super) fn number_in(node: Node<'_, '_>, name: &str) -> Result<Option<PlacedValue>> {
    child(node, name).map(number).transpose()
}

/// Returns the factor of at least 0 in a child element, or 1 if it is missing.
pub(super) fn factor_in(node: Node<'_, '_>, name: &str) -> Result<f64> {
    number_in(node, name)?.map_or(Ok(1.0), |factor| factor.not_negative(&format!("<{name}>")))
}

/// Returns the text of an element without blanks, because some writers separate its parts by them.
pub(super) fn compact(node: Node<'_, '_>) -> String {
    node.text().unwrap_or("").split_whitespace().collect()
}

/// Returns the truth value in a child element, or `None` if it is missing.
pub(super) fn truth_in(node: Node<'_, '_>, name: &str) -> Result<Option<bool>> {
    let Some(found) = child(node, name) else { return Ok(None) };
    match compact(found).to_ascii_lowercase().as_str() {
        "true" | "1" => Ok(Some(true)),
        "false" | "0" => Ok(Some(false)),
        text => Err(at(found, Error::input(format!("<{name}>: \"{text}\"")).expected("true or false"))),
    }
}
