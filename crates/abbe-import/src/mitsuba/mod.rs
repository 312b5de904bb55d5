//! Reads scenes of Mitsuba 3 (XML).
//!
//! The photometric quantities of the scene file have the values of Mitsuba's spectral pictures: a
//! light of the colour (1, 1, 1) has the luminance 1 cd/m².

mod bsdf;
mod emitter;
mod index;
mod medium;
mod primitives;
mod principled;
mod properties;
mod reader;
mod sensor;
mod shape;
mod spectrum;
mod texture;
mod transform;
mod volume;
mod xml;

#[cfg(test)]
mod note_tests;
#[cfg(test)]
mod picture_tests;
#[cfg(test)]
mod tests;

use crate::ImportedScene;
use abbe_format::FileAccess;
use abbe_spectra::error::Result;
use glam::DMat4;
use properties::Properties;
use reader::MitsubaReader;
use std::path::Path;
use std::rc::Rc;
use xml::{MitsubaDocument, XmlElement};

pub(super) fn import(path: &Path, folder: &str, file_access: FileAccess) -> Result<ImportedScene> {
    let document = MitsubaDocument::read(path, file_access)?;
    let mut reader = MitsubaReader::new(document, folder);
    reader.read()?;
    let mut scene = reader.scene;
    if !scene.has_light() {
        scene.add_sky();
    }
    Ok(scene.finish(&path.file_name().unwrap_or_default().to_string_lossy()))
}

impl MitsubaReader<'_> {
    /// Converts all elements of the scene.
    fn read(&mut self) -> Result<()> {
        let root = Rc::clone(&self.document.root);
        let children: Vec<Rc<XmlElement>> = root.children.iter().map(|child| self.document.resolve(child)).collect();
        let tagged = |tag: &str| children.iter().filter(|child| child.tag == tag).cloned().collect::<Vec<_>>();
        self.sensor(&tagged("sensor"))?;
        for child in &children {
            match child.tag.as_str() {
                "shape" => self.shape(child, DMat4::IDENTITY)?,
                // Shapes refer to this element.
                "emitter" if child.plugin() == "area" && child.attribute("id").is_some() => {}
                "emitter" => self.emitter(child)?,
                "integrator" => self.integrator(child)?,
                // Shapes and sensors refer to these elements.
                "sensor" | "bsdf" | "texture" | "spectrum" | "medium" | "volume" | "phase" | "film" | "sampler" => {}
                other => {
                    self.note(child, format!("<{other}> is not supported and is left out"));
                }
            }
        }
        Ok(())
    }

    /// Notes settings of the integrator that change the picture.
    fn integrator(&mut self, integrator: &XmlElement) -> Result<()> {
        let properties = Properties::new(integrator);
        // These follow light over any number of interactions.
        let complete = ["path", "volpath", "volpathmip", "ptracer", "aov", "moment", "stokes", "prb", "prbvolpath"];
        if !complete.contains(&integrator.plugin()) {
            let what = format!("the integrator \"{}\" is replaced: Abbe renders all light", integrator.plugin());
            self.note(integrator, what);
        }
        if properties.number("max_depth", -1.0)? > 0.0 {
            self.note(integrator, "`max_depth` is left out: Abbe follows light over any number of interactions");
        }
        if properties.boolean("hide_emitters", false)? {
            self.note(integrator, "`hide_emitters` is left out: all lights are visible");
        }
        Ok(())
    }
}
