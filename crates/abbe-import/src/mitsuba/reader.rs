//! The reader of a Mitsuba scene. The other modules convert the elements.

use std::rc::Rc;

use serde_json::Value;

use super::properties::Properties;
use super::surface::MitsubaSurface;
use super::xml::{MitsubaDocument, XmlElement};
use crate::scene_writer::SceneWriter;

/// A BSDF, and the medium inside the shape that has the BSDF.
type SurfaceKey = (*const XmlElement, Option<String>);

/// Converts the elements of a scene.
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

    /// Adds a material, and returns its name.
    pub(super) fn add_material(&mut self, wanted: &str, material: Value) -> String {
        self.scene.add_material(wanted, material)
    }

    /// Notes properties that were not read.
    pub(super) fn note_unread(&mut self, properties: &Properties<'_>) {
        let element = properties.element;
        for child in properties.unread() {
            let name = if child.name().is_empty() { format!("<{}>", child.tag) } else { format!("`{}`", child.name()) };
            let what = format!("{name} of <{} type=\"{}\"> is left out", element.tag, element.plugin());
            self.scene.leave_out(child.place(), what);
        }
    }
}
