//! Media as written → media as meant.

use super::spectra::Role;
use super::{Resolver, unsupported};
use crate::error::{Error, Result};
use crate::optics::phase::Phase;
use crate::scene::file::{HomogeneousFile, JsonPath, MediumFile, PhaseFile};
use crate::scene::medium::{Density, Medium};
use glam::DVec3;

impl Resolver<'_> {
    /// The number of the medium of this name, which is its place among the scene's media; `at` is where it is named.
    pub(super) fn medium_number(&self, at: &JsonPath<'_>, name: &str) -> Result<usize> {
        let mut names = self.scene.media.keys();
        names.position(|known| known == name).map_or_else(
            || {
                let known = self.scene.media.keys().map(String::as_str);
                let allowed = if self.scene.media.is_empty() {
                    "a name of the scene's `media`, which is empty".into()
                } else {
                    format!("one of {}", known.clone().collect::<Vec<_>>().join(", "))
                };
                self.at(at, Err(Error::unknown_name("medium", name, known).expected(allowed)))
            },
            Ok,
        )
    }

    /// Resolves all media, those too that nothing uses; `centre` is the scene's centre in m.
    pub(super) fn media(&self, centre: DVec3) -> Result<Vec<Medium>> {
        self.scene.media.iter().map(|(name, file)| self.medium(name, file, centre)).collect()
    }

    fn medium(&self, name: &str, file: &MediumFile, centre: DVec3) -> Result<Medium> {
        let root = JsonPath::Root;
        let media = root.key("media");
        let at = media.key(name);
        let _ = centre;
        match file {
            MediumFile::Homogeneous(file) => self.homogeneous(&at.key("homogeneous"), file, name),
            MediumFile::Grid(_) => self.at(&at.key("grid"), Err(unsupported("grids are"))),
        }
    }

    fn homogeneous(&self, at: &JsonPath<'_>, file: &HomogeneousFile, name: &str) -> Result<Medium> {
        let HomogeneousFile { absorption, scattering, phase, emission, priority: _, transform: _, motion } = file;
        if emission.is_some() {
            return self.at(&at.key("emission"), Err(unsupported("emission of media is")));
        }
        if !motion.is_empty() {
            return self.at(&at.key("motion"), Err(unsupported("motion of media is")));
        }
        let coefficient = |key: &str, file| {
            self.spectrum(&at.key(key), file, Role::Coefficient).map(|per_unit| per_unit.scaled(1.0 / self.metres))
        };
        let coefficients = (coefficient("absorption", absorption)?, coefficient("scattering", scattering)?);
        let phase = match phase {
            PhaseFile::Isotropic => Phase::Isotropic,
            PhaseFile::Rayleigh
            | PhaseFile::HenyeyGreenstein { .. }
            | PhaseFile::Table { .. }
            | PhaseFile::Mie { .. }
            | PhaseFile::Rainbow => return self.at(&at.key("phase"), Err(unsupported("this phase function is"))),
        };
        Ok(Medium::new(name.to_owned(), coefficients, phase, Density::Uniform))
    }
}
