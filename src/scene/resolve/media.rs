//! Media as written → media as meant.

use super::spectra::Role;
use super::{Resolver, unsupported};
use crate::error::{Error, Result};
use crate::optics::phase::{self, Phase, PhaseTable};
use crate::scene::file::{HomogeneousFile, JsonPath, MediumFile, PhaseFile};
use crate::scene::medium::{Density, Medium};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

impl Resolver<'_> {
    /// Resolves the medium of this name; `at` is where it is named, `centre` the scene's centre in m.
    pub(super) fn medium(&self, at: &JsonPath<'_>, name: &str, centre: DVec3) -> Result<Medium> {
        let Some(file) = self.scene.media.get(name) else {
            let known = self.scene.media.keys().map(String::as_str);
            let names: Vec<&str> = known.clone().collect();
            let allowed = if names.is_empty() {
                "a name of the scene's `media`, which is empty".into()
            } else {
                format!("one of {}", names.join(", "))
            };
            return self.at(at, Err(Error::unknown_name("medium", name, known).expected(allowed)));
        };
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
        let HomogeneousFile { absorption, scattering, phase, emission, priority, transform: _, motion } = file;
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
        let phase = self.phase(&at.key("phase"), phase)?;
        Ok(Medium { priority: *priority, ..Medium::new(name.to_owned(), coefficients, phase, Density::Uniform) })
    }

    fn phase(&self, at: &JsonPath<'_>, file: &PhaseFile) -> Result<Phase> {
        match file {
            PhaseFile::Isotropic => Ok(Phase::Isotropic),
            PhaseFile::Rayleigh => Ok(Phase::Rayleigh),
            PhaseFile::HenyeyGreenstein { g } => {
                let g = self.spectrum(&at.key("henyey_greenstein").key("g"), g, Role::MeanCosine)?;
                Ok(Phase::HenyeyGreenstein { g })
            }
            PhaseFile::Table { path } => {
                let table = read_phase_table(&self.source.folder().join(path));
                Ok(Phase::Table(Arc::new(self.at(&at.key("table").key("path"), table)?)))
            }
            PhaseFile::Mie { .. } | PhaseFile::Rainbow => self.at(at, Err(unsupported("this phase function is"))),
        }
    }
}

/// Reads a phase function's table from a file.
fn read_phase_table(path: &Path) -> Result<PhaseTable> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Error::input(format!("cannot read the phase function: {error}")).in_file(path))?;
    phase::parse_table(&text).map_err(|error| error.in_file(path))
}
