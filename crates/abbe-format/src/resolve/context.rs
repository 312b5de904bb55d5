//! The data that all parts of `Resolver` share: the scene file, its source, and its unit of length.

use crate::{CameraFile, ColourImageFile, FilmFile, JsonPath, JsonSource, SceneFile, ShutterFile};
use abbe_optics::texture::SpectralTexture;
use abbe_scene::camera::Shutter;
use abbe_spectra::error::{Error, Result};
use glam::DVec3;
use std::cell::RefCell;

/// The purpose for which a scene is resolved.
#[derive(Debug, Clone, Copy)]
pub(super) enum ResolvedFor<'a> {
    Picture(&'a CameraFile, &'a FilmFile),
    Meters,
}

/// Translates the scene file to the scene, with the data that every step needs.
pub(super) struct Resolver<'a> {
    pub(super) scene: &'a SceneFile,
    pub(super) source: &'a JsonSource,
    /// The length of one scene unit in metres.
    pub(super) metres: f64,
    pub(super) view: ResolvedFor<'a>,
    /// The shutter. The scene is resolved at the moment when the shutter opens.
    pub(super) shutter: Shutter,
    /// The scene's centre in m, or `None` for the middle of the objects.
    pub(super) centre: Option<DVec3>,
    /// The faults so far. A part with a fault is left out, so that one run finds all faults.
    faults: RefCell<Vec<Error>>,
    /// The textures of pictures that were read before. Copies share their texels.
    pub(super) textures: RefCell<Vec<(ColourImageFile, SpectralTexture)>>,
    /// Remarks on what the readers of spectra decided from the values of their files.
    pub(super) spectrum_notes: RefCell<Vec<String>>,
}

impl<'a> Resolver<'a> {
    pub(super) fn new(
        scene: &'a SceneFile,
        source: &'a JsonSource,
        view: ResolvedFor<'a>,
        centre: Option<DVec3>,
    ) -> Self {
        // Meters read the scene while the shutter of its camera is open.
        let shutter = scene.camera.as_ref().map_or(Shutter::new(0.0, 0.0, None), shutter);
        Self {
            scene,
            source,
            metres: scene.unit.metres(),
            view,
            shutter,
            centre,
            faults: RefCell::default(),
            textures: RefCell::default(),
            spectrum_notes: RefCell::default(),
        }
    }

    /// Returns the value of a part of the scene, or keeps its fault and returns `None`.
    pub(super) fn keep<T>(&self, part: Result<T>) -> Option<T> {
        part.map_err(|fault| self.faults.borrow_mut().push(fault)).ok()
    }

    /// Returns an error with all faults that were kept. Returns `None` if there are none.
    pub(super) fn kept_faults(&self) -> Option<Error> {
        Error::all(self.faults.borrow().iter().cloned())
    }

    /// Adds the place in the file to an error.
    pub(super) fn at<T>(&self, path: &JsonPath, result: Result<T>) -> Result<T> {
        result.map_err(|error| self.source.error_at(&path.to_string(), error))
    }
    /// Returns the error for a name that a section of the scene lacks. `kind` is the kind of the
    /// entries and the key of the section, such as `["medium", "media"]`.
    pub(super) fn unknown_name(&self, at: &JsonPath, [kind, list]: [&str; 2], name: &str, known: Vec<&str>) -> Error {
        let expected = if known.is_empty() {
            format!("a name of the scene's `{list}`, which is empty")
        } else {
            format!("one of {}", known.join(", "))
        };
        self.source.error_at(&at.to_string(), Error::unknown_name(kind, name, known).expected(expected))
    }

    /// Converts a point of the file to m. The result is relative to the scene's centre.
    pub(super) fn point(&self, point: [f64; 3], centre: DVec3) -> DVec3 {
        DVec3::from(point) * self.metres - centre
    }
}

/// Returns the shutter of a camera. Without one in the file, the picture shows the time 0.
fn shutter(camera: &CameraFile) -> Shutter {
    let of = |ShutterFile { open, close, curve }: &ShutterFile| Shutter::new(*open, *close, curve.as_deref());
    camera.shutter.as_ref().map_or(Shutter::new(0.0, 0.0, None), of)
}
