//! The reader of a Mitsuba scene. The other modules convert the elements.

use super::properties::Properties;
use super::xml::{MitsubaDocument, XmlElement};
use crate::scene_writer::SceneWriter;
use std::rc::Rc;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum MitsubaSurface {
    /// A material of the scene file.
    Material {
        name: String,
        /// True if Mitsuba's surface is black from behind.
        one_sided: bool,
    },
    /// Nothing to see, because light passes unchanged.
    Invisible,
}

/// A BSDF, and the medium inside the shape that has the BSDF.
type SurfaceKey = (*const XmlElement, Option<String>);

pub(super) struct MitsubaReader<'a> {
    pub(super) document: MitsubaDocument,
    pub(super) scene: SceneWriter,
    /// The path from the folder of the scene file to the folder of the Mitsuba scene.
    pub(super) folder: &'a str,
    /// The surfaces of the BSDFs that are converted already.
    pub(super) surfaces: Vec<(SurfaceKey, MitsubaSurface)>,
    /// The names of the media that are converted already.
    pub(super) media: Vec<(*const XmlElement, Option<String>)>,
    /// The medium around the sensor.
    pub(super) outside: Option<Rc<XmlElement>>,
}

impl<'a> MitsubaReader<'a> {
    pub(super) fn new(document: MitsubaDocument, folder: &'a str) -> Self {
        Self { document, scene: SceneWriter::default(), folder, surfaces: Vec::new(), media: Vec::new(), outside: None }
    }

    /// Returns the elements with a tag inside an element, and marks them as read.
    pub(super) fn tagged(&self, properties: &Properties, tag: &str) -> Vec<Rc<XmlElement>> {
        let children = properties.take(|child| self.document.resolve(child).tag == tag);
        children.into_iter().map(|child| self.document.resolve(child)).collect()
    }

    /// Notes a difference of the converted scene, with the place of an element.
    pub(super) fn note(&mut self, element: &XmlElement, what: impl Into<String>) {
        self.scene.leave_out(element.place(), what);
    }

    pub(super) fn note_unread(&mut self, properties: &Properties) {
        let element = properties.element;
        for child in properties.unread() {
            let name = if child.name().is_empty() { format!("<{}>", child.tag) } else { format!("`{}`", child.name()) };
            self.note(child, format!("{name} of <{} type=\"{}\"> is left out", element.tag, element.plugin()));
        }
    }
}
