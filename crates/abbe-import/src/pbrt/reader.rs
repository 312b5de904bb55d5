//! The state of the program that reads a pbrt file. The other modules execute the directives.

use super::camera::{DEFAULT_FILM, ReadCamera};
use super::{
    material, material::ReadMaterial, parameters::Parameters, shape::PbrtShape, spectrum::SpectrumContext,
    state::GraphicsState, texture::TextureReader, token::Place,
};
use crate::{ImportedScene, scene_writer::SceneWriter};
use abbe_format::FileAccess;
use abbe_spectra::error::{Error, Result};
use glam::DMat4;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

pub(super) struct PbrtReader<'a> {
    /// The folder of the main file.
    pub(super) base: &'a Path,
    /// The path from the folder of the scene file to the folder of the main file.
    pub(super) folder: &'a str,
    pub(super) file_access: FileAccess,
    pub(super) scene: SceneWriter,
    pub(super) state: GraphicsState,
    pub(super) saved: Vec<GraphicsState>,
    pub(super) camera: Option<ReadCamera>,
    pub(super) film: [f64; 2],
    /// Maps pbrt's world to Abbe's.
    pub(super) world: DMat4,
    pub(super) coordinate_systems: BTreeMap<String, DMat4>,
    pub(super) materials: NamedMaterials,
    /// The materials of the whole file, if some are used before they are defined.
    pub(super) later_materials: NamedMaterials,
    /// The first material that was used but is not known.
    pub(super) unknown_material: Option<String>,
    /// True if unknown materials are no errors.
    pub(super) allows_unknown_materials: bool,
    /// The textures by name. The flag is true for textures of numbers.
    pub(super) textures: BTreeMap<(String, bool), Value>,
    /// The name in the scene file for each named medium.
    pub(super) media: BTreeMap<String, String>,
    /// The shapes of each object that can be instanced.
    pub(super) objects: BTreeMap<String, Vec<PbrtShape>>,
    /// The name of the object that is being defined.
    pub(super) defining: Option<String>,
}

type NamedMaterials = BTreeMap<String, Rc<ReadMaterial>>;

impl<'a> PbrtReader<'a> {
    pub(super) fn new(base: &'a Path, folder: &'a str, file_access: FileAccess) -> Self {
        Self {
            base,
            folder,
            file_access,
            scene: SceneWriter::default(),
            state: GraphicsState::default(),
            saved: Vec::new(),
            camera: None,
            film: DEFAULT_FILM,
            world: DMat4::IDENTITY,
            coordinate_systems: BTreeMap::new(),
            materials: NamedMaterials::new(),
            later_materials: BTreeMap::new(),
            unknown_material: None,
            allows_unknown_materials: false,
            textures: BTreeMap::new(),
            media: BTreeMap::new(),
            objects: BTreeMap::new(),
            defining: None,
        }
    }

    pub(super) fn named_material(&self, name: &str) -> Option<&Rc<ReadMaterial>> {
        self.materials.get(name).or_else(|| self.later_materials.get(name))
    }

    /// Returns the converted scene, or an error if it has no objects.
    pub(super) fn finish(mut self, title: &str) -> Result<ImportedScene> {
        if !self.scene.has_objects() {
            return Err(Error::input("the scene has no shapes that can be read").expected("a pbrt-v4 scene"));
        }
        let camera = self.camera.take().unwrap_or_else(|| {
            self.scene.note_added("pbrt's default camera at the origin, because the file has none that can be read");
            ReadCamera::default()
        });
        let mut left_out = Vec::new();
        self.scene.camera = camera.finish(&self.world, self.film, &mut left_out);
        left_out.into_iter().for_each(|what| self.scene.leave_out("", what));
        self.scene.film = json!({"width": self.film[0] as u32, "height": self.film[1] as u32});
        if !self.scene.has_light() {
            self.scene.add_sky();
        }
        Ok(self.scene.finish(title))
    }

    pub(super) fn spectra(&self) -> SpectrumContext<'a> {
        SpectrumContext { folder: self.base, file_access: self.file_access, space: self.state.space }
    }

    /// Runs `read` with a reader of textures.
    pub(super) fn with_textures<T>(
        &self,
        left_out: &mut Vec<String>,
        read: impl FnOnce(&mut TextureReader) -> Result<T>,
    ) -> Result<T> {
        let named = |name: &str, is_scalar: bool| self.textures.get(&(name.to_string(), is_scalar)).cloned();
        let (spectra, folder) = (self.spectra(), self.folder);
        let mut reader = TextureReader { spectra, folder, named: &named, left_out: Vec::new() };
        let result = read(&mut reader);
        left_out.extend(reader.left_out);
        result
    }

    pub(super) fn material(
        &self,
        class: &str,
        parameters: &Parameters,
        left_out: &mut Vec<String>,
    ) -> Result<ReadMaterial> {
        self.with_textures(left_out, |textures| material::read(class, parameters, textures))
    }

    /// Returns the state before the last `AttributeBegin`.
    pub(super) fn restored(&mut self, place: &Place) -> Result<GraphicsState> {
        self.saved.pop().ok_or_else(|| place.error("an end without a begin"))
    }

    pub(super) fn set_ctm(&mut self, ctm: DMat4, place: &Place) {
        if self.state.changes_start {
            self.state.ctm = ctm;
        } else {
            self.scene.leave_out(place.text(), "motion is left out: the transform at the end of the shutter interval");
        }
    }
}
