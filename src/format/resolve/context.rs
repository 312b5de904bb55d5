//! The data that all parts of `Resolver` share: the scene file, its source, and its unit of length.

use crate::error::{Error, Result};
use crate::format::SceneFile;
use crate::json::{JsonPath, JsonSource};
use crate::scene::camera::Shutter;
use glam::DVec3;

/// Translates the scene file to the scene. Contains the parsed file and the data that every step of
/// the translation needs.
pub(super) struct Resolver<'a> {
    pub(super) scene: &'a SceneFile,
    pub(super) source: &'a JsonSource,
    /// The length of one scene unit in metres.
    pub(super) metres: f64,
    /// The shutter. The scene is resolved at the moment when the shutter opens.
    pub(super) shutter: Shutter,
    /// The scene's centre in m, or `None` for the middle of the objects.
    pub(super) centre: Option<DVec3>,
}

impl Resolver<'_> {
    /// Adds the place in the file to an error.
    pub(super) fn at<T>(&self, path: &JsonPath<'_>, result: Result<T>) -> Result<T> {
        result.map_err(|error| self.source.error_at(&path.to_string(), error))
    }

    /// Converts a point of the file to m. The result is relative to the scene's centre.
    pub(super) fn point(&self, point: [f64; 3], centre: DVec3) -> DVec3 {
        DVec3::from(point) * self.metres - centre
    }
}

/// The end of every message about an unsupported part of a scene file. This version cannot simulate
/// such a part.
pub(super) const UNSUPPORTED: &str = "not supported yet";

/// The error for an unsupported part of a scene file. The text `what` names the part and must end
/// with "is" or "are".
pub(super) fn unsupported(what: &str) -> Error {
    Error::input(format!("{what} {UNSUPPORTED}"))
}
