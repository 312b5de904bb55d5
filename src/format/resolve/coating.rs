//! Translates stacks of thin films.

use super::context::Resolver;
use super::index::{index_file, index_of};
use super::spectra::{Role, Spectra};
use crate::error::{Error, Result, both, every};
use crate::format::{
    CoatingFile, CoatingIndexFile, CoatingLayerFile, ComplexIndexFile, IndexFile, JsonPath, JsonSource, ScalarFile,
};
use crate::optics::glass::{RefractiveIndex, catalogue};
use crate::optics::thin_film::{FilmLayer, FilmStack, OpticalIndex};
use crate::spectrum::library;
use crate::texture::SurfaceScalar;
use std::collections::BTreeMap;

/// A stack of films between two media.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmSystem {
    /// The medium in which light arrives.
    pub incident: RefractiveIndex,
    /// The films.
    pub films: FilmStack,
    /// The medium below the films.
    pub substrate: OpticalIndex,
}

/// The name of the medium with an index of 1. All other indices are relative to it.
const AIR: &str = "air";

/// Resolves a stack of films that is not part of a scene. The default of both media is air.
///
/// # Errors
/// Returns an error if a name is unknown, if a file cannot be read, if the first medium absorbs, or
/// if a thickness is a texture. The error states the place in `source`.
pub fn lone_coating(file: &CoatingFile, source: &JsonSource) -> Result<FilmSystem> {
    let spectra = Spectra { named: &BTreeMap::new(), source };
    let (root, air) = (JsonPath::Root, OpticalIndex::Transparent(RefractiveIndex::constant(1.0)?));
    let medium = |key: &str, file: &Option<CoatingIndexFile>| {
        file.as_ref().map_or(Ok(air.clone()), |file| spectra.film_index(&root.key(key), file))
    };
    let number = |at: &JsonPath<'_>, file: &ScalarFile| match file {
        ScalarFile::Number(number) => Ok(SurfaceScalar::Uniform(*number)),
        ScalarFile::Image(_)
        | ScalarFile::Checker(_)
        | ScalarFile::Stripes(_)
        | ScalarFile::Noise(_)
        | ScalarFile::Gradient(_) => {
            let error = Error::input("found a texture, but there is no surface").expected("a number");
            spectra.at(at, Err(error))
        }
    };
    let (media, films) = both(
        both(medium("incident", &file.incident), medium("substrate", &file.substrate)),
        spectra.films(&root, file, number),
    )?;
    let (incident, substrate) = media;
    match incident {
        OpticalIndex::Transparent(incident) => Ok(FilmSystem { incident, films, substrate }),
        OpticalIndex::Absorbing { .. } => {
            let error = Error::input("found a medium that absorbs light").expected("a transparent medium");
            spectra.at(&root.key("incident"), Err(error))
        }
    }
}

impl Spectra<'_> {
    /// Resolves the index of a film or of a medium.
    fn film_index(&self, at: &JsonPath<'_>, file: &CoatingIndexFile) -> Result<OpticalIndex> {
        match file {
            CoatingIndexFile::Index(IndexFile::Name(name)) => self.at(at, named_index(name)),
            CoatingIndexFile::Index(IndexFile::File(path)) => {
                let data = self.at(&at.key("file"), index_file(path, self.source))?;
                let index = match data.n_and_k() {
                    Ok((n, k)) => OpticalIndex::absorbing(n, k),
                    Err(_) => data.index().map(OpticalIndex::Transparent),
                };
                self.at(&at.key("file"), index)
            }
            CoatingIndexFile::Index(index) => self.at(at, index_of(index, self.source)).map(OpticalIndex::Transparent),
            CoatingIndexFile::Complex(ComplexIndexFile { n, k }) => {
                let n = self.checked(&at.key("n"), n, Role::Coefficient);
                let (n, k) = both(n, self.checked(&at.key("k"), k, Role::Coefficient))?;
                self.at(at, OpticalIndex::absorbing(n, k))
            }
        }
    }

    /// Resolves the films of a stack. `thickness` resolves a thickness.
    fn films(
        &self,
        at: &JsonPath<'_>,
        file: &CoatingFile,
        thickness: impl Fn(&JsonPath<'_>, &ScalarFile) -> Result<SurfaceScalar>,
    ) -> Result<FilmStack> {
        let at_layers = at.key("layers");
        let layers = file.layers.iter().enumerate().map(|(i, CoatingLayerFile { ior, thickness_nm })| {
            let at = at_layers.index(i);
            let index = self.film_index(&at.key("ior"), ior);
            let (index, thickness_nm) = both(index, thickness(&at.key("thickness_nm"), thickness_nm))?;
            Ok(FilmLayer { index, thickness_nm })
        });
        self.at(&at_layers, FilmStack::new(every(layers)?))
    }
}

/// Returns the index of air, of a metal, or of a material of the catalogue.
fn named_index(name: &str) -> Result<OpticalIndex> {
    if name.eq_ignore_ascii_case(AIR) {
        return RefractiveIndex::constant(1.0).map(OpticalIndex::Transparent);
    }
    if let Ok(metal) = library::metal(name) {
        let (n, k) = metal.index();
        return OpticalIndex::absorbing(n, k);
    }
    match catalogue::find(name) {
        Ok(glass) => Ok(OpticalIndex::Transparent(glass.index.clone())),
        Err(_) => {
            let metals = library::metals().flat_map(|metal| [metal.symbol, metal.name]);
            let short = catalogue::names().filter_map(|name| name.split_once(" (")).map(|(name, _)| name);
            let known = catalogue::names().chain(short).chain(metals).chain([AIR]);
            Err(Error::unknown_name("material", name, known)
                .expected(format!("{}, a metal, or \"{AIR}\"", catalogue::EXPECTED_NAME)))
        }
    }
}

impl Resolver<'_> {
    /// Resolves the films of a coating. `substrate` is the index of the coated material. The films
    /// of a free-standing film lie in air.
    pub(super) fn coating(&self, at: &JsonPath<'_>, file: &CoatingFile, substrate: &OpticalIndex) -> Result<FilmStack> {
        let spectra = self.spectra();
        let air = OpticalIndex::Transparent(RefractiveIndex::constant(1.0)?);
        let same = |key: &str, file: &Option<CoatingIndexFile>, wanted: &OpticalIndex, expected: &str| {
            let Some(file) = file else { return Ok(()) };
            let at = at.key(key);
            let found = spectra.film_index(&at, file)?;
            if [400.0, 550.0, 700.0].iter().all(|&nm| found.at(nm) == wanted.at(nm)) {
                return Ok(());
            }
            let error = Error::input("found another medium than that of the scene").expected(expected);
            self.at(&at, Err(error))
        };
        let beside = both(
            same("incident", &file.incident, &air, "air, or no `incident`"),
            same("substrate", &file.substrate, substrate, "the coated material, or no `substrate`"),
        );
        let films = spectra.films(at, file, |at, file| self.scalar(at, file));
        both(beside, films).map(|(_, films)| films)
    }
}
