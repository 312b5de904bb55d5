//! Translates stacks of thin films.

use super::context::Resolver;
use super::index::{index_file, index_of};
use super::spectra::{Role, Spectra};
use crate::{
    CoatingFile, CoatingIndexFile, CoatingLayerFile, ComplexIndexFile, IndexFile, JsonPath, JsonSource, ScalarFile,
};
use abbe_optics::glass::{RefractiveIndex, catalogue};
use abbe_optics::lens::Lens;
use abbe_optics::texture::SurfaceScalar;
use abbe_optics::thin_film::{FilmLayer, FilmStack, OpticalIndex};
use abbe_spectra::error::{Error, Result, both, every};
use abbe_spectra::spectrum::library;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A stack of films between two media.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmSystem {
    pub incident: RefractiveIndex,
    pub films: FilmStack,
    pub substrate: OpticalIndex,
}

/// The name of the medium with an index of 1. All other indices are relative to it.
const AIR: &str = "air";

/// Resolves a stack of films that is not part of a scene, in which both media are air by default.
/// The first medium must not absorb, and no thickness may be a texture.
pub fn lone_coating(file: &CoatingFile, source: &JsonSource) -> Result<FilmSystem> {
    let notes = RefCell::default();
    let spectra = Spectra { named: &BTreeMap::new(), source, notes: &notes };
    let (root, air) = (JsonPath::Root, OpticalIndex::Transparent(RefractiveIndex::constant(1.0)?));
    let medium = |key: &str, file: &Option<CoatingIndexFile>| {
        file.as_ref().map_or(Ok(air.clone()), |file| spectra.film_index(&root.key(key), file))
    };
    let (media, films) = both(
        both(medium("incident", &file.incident), medium("substrate", &file.substrate)),
        spectra.films(&root, file, &|at, file| spectra.number(at, file)),
    )?;
    let (incident, substrate) = media;
    let OpticalIndex::Transparent(incident) = incident else {
        let at = root.key("incident");
        return Err(source.fault(&at, "found a medium that absorbs light", "a transparent medium"));
    };
    Ok(FilmSystem { incident, films, substrate })
}

fn is_air(index: &RefractiveIndex) -> bool {
    [400.0, 550.0, 700.0].iter().all(|&nm| index.n(nm) == 1.0)
}

impl Spectra<'_> {
    /// Resolves the coating of a surface of a lens. The indices are those on the side of the scene
    /// and on the side of the sensor. In the result, the first film is on the side of the scene.
    pub(super) fn lens_coating(
        &self,
        at: &JsonPath,
        file: &CoatingFile,
        [front, behind]: [&RefractiveIndex; 2],
    ) -> Result<FilmStack> {
        let reversed = is_air(behind) && !is_air(front);
        let media = if reversed { [behind, front] } else { [front, behind] };
        let media = media.map(|index| OpticalIndex::Transparent(index.clone()));
        let films = self.films_between(at, file, &media, &|at, file| self.number(at, file))?;
        Ok(if reversed { films.reversed() } else { films })
    }

    /// Resolves the coating of all surfaces of a lens between air and glass that have none.
    pub(super) fn lens_coatings(&self, at: &JsonPath, file: Option<&CoatingFile>, lens: Lens) -> Result<Lens> {
        let Some(file) = file else { return Ok(lens) };
        let air = RefractiveIndex::constant(1.0)?;
        lens.with_coatings(|lens, i| {
            let surface = &lens.surfaces()[i];
            let front = if i == 0 { &air } else { &lens.surfaces()[i - 1].index };
            if surface.coating.is_some() || is_air(front) == is_air(&surface.index) {
                return Ok(surface.coating.clone());
            }
            self.lens_coating(at, file, [front, &surface.index]).map(Some)
        })
    }

    /// Resolves the thickness of a film that must not vary.
    fn number(&self, at: &JsonPath, file: &ScalarFile) -> Result<SurfaceScalar> {
        let ScalarFile::Number(number) = file else {
            let what = "found a texture, but there is no surface of an object";
            return Err(self.source.fault(at, what, "a number"));
        };
        Ok(SurfaceScalar::Uniform(*number))
    }

    /// Resolves the films between two media. If the file states a medium, it must be the given one.
    fn films_between(
        &self,
        at: &JsonPath,
        file: &CoatingFile,
        [incident, substrate]: &[OpticalIndex; 2],
        thickness: &dyn Fn(&JsonPath, &ScalarFile) -> Result<SurfaceScalar>,
    ) -> Result<FilmStack> {
        let same = |key: &str, file: &Option<CoatingIndexFile>, wanted: &OpticalIndex, expected: &str| {
            let Some(file) = file else { return Ok(()) };
            let at = at.key(key);
            let found = self.film_index(&at, file)?;
            if [400.0, 550.0, 700.0].iter().all(|&nm| found.at(nm) == wanted.at(nm)) {
                return Ok(());
            }
            Err(self.source.fault(&at, "found another medium than that of the scene", expected))
        };
        let beside = both(
            same("incident", &file.incident, incident, "air, or no `incident`"),
            same("substrate", &file.substrate, substrate, "the coated material, or no `substrate`"),
        );
        both(beside, self.films(at, file, thickness)).map(|(_, films)| films)
    }

    /// Resolves the index of a film or of a medium.
    fn film_index(&self, at: &JsonPath, file: &CoatingIndexFile) -> Result<OpticalIndex> {
        match file {
            CoatingIndexFile::Index(IndexFile::Name(name)) => self.at(at, named_index(name)),
            CoatingIndexFile::Index(IndexFile::File(path)) => {
                let data = self.at(&at.key("file"), index_file(path, self.source))?;
                let index = if data.is_complex() {
                    data.n_and_k().and_then(|(n, k)| OpticalIndex::absorbing(n, k))
                } else {
                    data.index().map(OpticalIndex::Transparent)
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

    fn films(
        &self,
        at: &JsonPath,
        file: &CoatingFile,
        thickness: &dyn Fn(&JsonPath, &ScalarFile) -> Result<SurfaceScalar>,
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
    /// Resolves a coating of a material of the index `substrate`, or a film in air.
    pub(super) fn coating(&self, at: &JsonPath, file: &CoatingFile, substrate: &OpticalIndex) -> Result<FilmStack> {
        let media = [OpticalIndex::Transparent(RefractiveIndex::constant(1.0)?), substrate.clone()];
        self.spectra().films_between(at, file, &media, &|at, file| self.scalar(at, file))
    }
}
