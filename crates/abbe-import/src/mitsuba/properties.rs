//! Access to the properties of an element. Properties that nobody reads are found afterwards.

use super::transform;
use super::xml::{XmlElement, number};
use abbe_spectra::error::Result;
use glam::{DMat4, DVec3};
use std::cell::Cell;
use std::rc::Rc;

pub(super) struct Properties<'a> {
    pub(super) element: &'a XmlElement,
    read: Vec<Cell<bool>>,
}

impl<'a> Properties<'a> {
    pub(super) fn new(element: &'a XmlElement) -> Self {
        Self { element, read: element.children.iter().map(|_| Cell::new(false)).collect() }
    }

    /// Returns a property and marks it as read.
    pub(super) fn find(&self, name: &str) -> Option<&'a Rc<XmlElement>> {
        self.take(|child| child.name() == name).into_iter().last()
    }

    /// Returns the children that meet a condition and marks them as read.
    pub(super) fn take(&self, condition: impl Fn(&Rc<XmlElement>) -> bool) -> Vec<&'a Rc<XmlElement>> {
        let children = self.element.children.iter().zip(&self.read);
        let found = children.filter(|(child, _)| condition(child));
        found.map(|(child, read)| (read.set(true), child).1).collect()
    }

    /// Marks properties as read that have no meaning for the scene file.
    pub(super) fn ignore(&self, names: &[&str]) {
        self.take(|child| names.contains(&child.name()));
    }

    pub(super) fn unread(&self) -> impl Iterator<Item = &'a Rc<XmlElement>> {
        self.element.children.iter().zip(&self.read).filter(|(_, read)| !read.get()).map(|(child, _)| child)
    }

    pub(super) fn optional_number(&self, name: &str) -> Result<Option<f64>> {
        self.find(name).map(|child| number(child)).transpose()
    }

    pub(super) fn number(&self, name: &str, default: f64) -> Result<f64> {
        Ok(self.optional_number(name)?.unwrap_or(default))
    }

    pub(super) fn boolean(&self, name: &str, default: bool) -> Result<bool> {
        let Some(child) = self.find(name) else { return Ok(default) };
        let value = child.required("value")?.trim();
        if value.eq_ignore_ascii_case("true") {
            Ok(true)
        } else if value.eq_ignore_ascii_case("false") {
            Ok(false)
        } else {
            Err(child.error(format!("found \"{value}\" for \"{name}\"")).expected("true or false"))
        }
    }

    pub(super) fn text(&self, name: &str) -> Result<Option<&'a str>> {
        self.find(name).map(|child| child.required("value")).transpose()
    }

    pub(super) fn required_text(&self, name: &str) -> Result<&'a str> {
        self.text(name)?.ok_or_else(|| {
            let what = format!("<{}> of the type \"{}\"", self.element.tag, self.element.plugin());
            self.element.error(format!("{what} without the property \"{name}\""))
        })
    }

    pub(super) fn vector(&self, name: &str) -> Result<Option<DVec3>> {
        self.find(name).map(|child| transform::vector(child, 0.0)).transpose()
    }

    pub(super) fn is_vector(&self, name: &str) -> bool {
        self.find(name).is_some_and(|child| child.tag == "vector")
    }

    /// Returns a transform. It is the identity if the property is absent.
    pub(super) fn transform(&self, name: &str) -> Result<DMat4> {
        self.find(name).map_or(Ok(DMat4::IDENTITY), |child| transform::transform(child))
    }
}
