//! The data that all parts of `Resolver` share: the scene file, its source, and its unit of length.

use crate::json::{JsonPath, JsonSource};
use crate::{CameraFile, ColourImageFile, FilmFile, SceneFile, ShutterFile};
use abbe_optics::texture::SpectralTexture;
use abbe_scene::camera::Shutter;
use abbe_spectra::error::{Error, Result};
use glam::DVec3;
use std::cell::RefCell;

/// The purpose for which a scene is resolved.
#[derive(Debug, Clone, Copy)]
pub(super) enum ResolvedFor<'a> {
    /// A picture with this camera and this film.
    Picture(&'a CameraFile, &'a FilmFile),
    /// The readings of the scene's meters.
    Meters,
}

/// Translates the scene file to the scene. Contains the parsed file and the data that every step of
/// the translation needs.
pub(super) struct Resolver<'a> {
    pub(super) scene: &'a SceneFile,
    pub(super) source: &'a JsonSource,
    /// The length of one scene unit in metres.
    pub(super) metres: f64,
    /// The camera and the film, or meters in their place.
    pub(super) view: ResolvedFor<'a>,
    /// The shutter. The scene is resolved at the moment when the shutter opens.
    pub(super) shutter: Shutter,
    /// The scene's centre in m, or `None` for the middle of the objects.
    pub(super) centre: Option<DVec3>,
    /// The faults so far. A part of the scene with a fault is left out, so that one run finds the
    /// faults of all parts.
    faults: RefCell<Vec<Error>>,
    /// The textures of pictures that were read before. Copies share their texels.
    pub(super) textures: RefCell<Vec<(ColourImageFile, SpectralTexture)>>,
}

impl<'a> Resolver<'a> {
    /// Creates a resolver. `centre` is the scene's centre in m, or `None` for the middle of the
    /// objects.
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
        }
    }

    /// Returns the value of a part of the scene. If the part has a fault, keeps the fault and
    /// returns `None`.
    pub(super) fn keep<T>(&self, part: Result<T>) -> Option<T> {
        part.map_err(|fault| self.faults.borrow_mut().push(fault)).ok()
    }

    /// Returns an error with all faults that were kept. Returns `None` if there are none.
    pub(super) fn kept_faults(&self) -> Option<Error> {
        Error::all(self.faults.borrow().iter().cloned())
    }

    /// Adds the place in the file to an error.
    pub(super) fn at<T>(&self, path: &JsonPath<'_>, result: Result<T>) -> Result<T> {
        result.map_err(|error| self.source.error_at(&path.to_string(), error))
    }

    /// Converts a point of the file to m. The result is relative to the scene's centre.
    pub(super) fn point(&self, point: [f64; 3], centre: DVec3) -> DVec3 {
        DVec3::from(point) * self.metres - centre
    }
}

/// Returns the shutter of a camera. If the file has no shutter, the picture shows the scene at the
/// time 0.
fn shutter(camera: &CameraFile) -> Shutter {
    match &camera.shutter {
        None => Shutter::new(0.0, 0.0, None),
        Some(ShutterFile { open, close, curve }) => Shutter::new(*open, *close, curve.as_deref()),
    }
}

/// The end of every message about an unsupported part of a scene file. This version cannot simulate
/// such a part.
const UNSUPPORTED: &str = "not supported yet";

/// The error for an unsupported part of a scene file. The text `what` names the part and must end
/// with "is" or "are".
pub(super) fn unsupported(what: &str) -> Error {
    Error::input(format!("{what} {UNSUPPORTED}"))
}
