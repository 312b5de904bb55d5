//! Materials as written → surfaces and bodies.

use super::spectra::Role;
use super::{Resolver, unsupported};
use crate::error::{Error, Result};
use crate::optics::glass::Index;
use crate::optics::surface::Surface;
use crate::scene::file::{
    ConductorFile, DielectricFile, FormulaFile, IndexFile, JsonPath, MaterialFile, ReflectanceFile, Source,
};
use crate::scene::{Body, Material};
use crate::spectrum::{Spectrum, library};

/// How deep mixed materials may refer to each other; beyond it they can only go in a circle.
const MAX_DEPTH: usize = 16;

/// The microfacet α of a roughness as written: its square, as in glTF, which looks evenly spaced to the eye.
pub(super) fn alpha(roughness: f64) -> f64 {
    roughness * roughness
}

impl Resolver<'_> {
    /// Resolves the material of this name.
    pub(super) fn material(&self, at: &JsonPath<'_>, name: &str, notes: &mut Vec<String>) -> Result<Material> {
        self.material_at_depth(at, name, notes, 0)
    }

    fn material_at_depth(
        &self,
        at: &JsonPath<'_>,
        name: &str,
        notes: &mut Vec<String>,
        depth: usize,
    ) -> Result<Material> {
        let Some(file) = self.scene.materials.get(name) else {
            let known = self.scene.materials.keys().map(String::as_str);
            let names: Vec<&str> = known.clone().collect();
            let allowed = if names.is_empty() {
                "a name of the scene's `materials`, which is empty".into()
            } else {
                format!("one of {}", names.join(", "))
            };
            return self.at(at, Err(Error::unknown_name("material", name, known).expected(allowed)));
        };
        if depth > MAX_DEPTH {
            return self.at(at, Err(Error::input("this material contains itself, directly or through others")));
        }
        let root = JsonPath::Root;
        let materials = root.key("materials");
        let at = materials.key(name);
        let (surface, body) = match file {
            MaterialFile::Diffuse { reflectance } => {
                let at = at.key("diffuse");
                (Surface::diffuse(self.reflectance(&at.key("reflectance"), reflectance)?), None)
            }
            MaterialFile::Dielectric(file) => {
                let at = at.key("dielectric");
                let body = self.body(&at, file, name, notes)?;
                (Surface::dielectric(alpha(file.roughness)), Some(body))
            }
            MaterialFile::ThinDielectric { ior } => {
                let at = at.key("thin_dielectric");
                (Ok(Surface::thin_dielectric(self.index(&at.key("ior"), ior, name, notes)?)), None)
            }
            MaterialFile::Conductor(file) => (self.conductor(&at.key("conductor"), file), None),
            MaterialFile::Mirror { reflectance } => {
                let at = at.key("mirror");
                (Surface::mirror(self.reflectance(&at.key("reflectance"), reflectance)?), None)
            }
            MaterialFile::Glossy { reflectance, ior, roughness } => {
                let at = at.key("glossy");
                let reflectance = self.reflectance(&at.key("reflectance"), reflectance)?;
                let index = self.index(&at.key("ior"), ior, name, notes)?;
                (Surface::glossy(reflectance, index, alpha(*roughness)), None)
            }
            MaterialFile::Translucent { reflectance, transmittance } => {
                let at = at.key("translucent");
                let reflectance = self.reflectance(&at.key("reflectance"), reflectance)?;
                let transmittance = self.reflectance(&at.key("transmittance"), transmittance)?;
                (Surface::translucent(reflectance, transmittance), None)
            }
            MaterialFile::Mix(parts) => {
                let at = at.key("mix");
                let (mut surfaces, mut body) = (Vec::new(), None);
                for (i, part) in parts.iter().enumerate() {
                    let at = at.index(i);
                    let part_material =
                        self.material_at_depth(&at.key("material"), &part.material, notes, depth + 1)?;
                    if part_material.is_boundary() {
                        let error = Error::input("found a boundary, which is no surface").expected("other materials");
                        return self.at(&at.key("material"), Err(error));
                    }
                    surfaces.push((part.weight, part_material.surface));
                    body = body.or(part_material.body);
                }
                (Surface::mix(surfaces), body)
            }
            MaterialFile::Boundary { medium } => {
                let number = self.medium_number(&at.key("boundary").key("medium"), medium)?;
                return Ok(Material::boundary(name, number, self.scene.media[medium].priority()));
            }
            MaterialFile::Absorber => (Ok(Surface::Absorber), None),
        };
        Ok(Material { name: name.to_string(), surface: self.at(&at, surface)?, body })
    }

    fn body(&self, at: &JsonPath<'_>, file: &DielectricFile, name: &str, notes: &mut Vec<String>) -> Result<Body> {
        let DielectricFile { ior, roughness: _, absorption, medium, priority } = file;
        let medium = medium.as_ref().map(|name| self.medium_number(&at.key("medium"), name)).transpose()?;
        let index = self.index(&at.key("ior"), ior, name, notes)?;
        let absorption = match absorption {
            None => None,
            Some(file) => {
                let per_unit = self.spectrum(&at.key("absorption"), file, Role::Coefficient)?;
                (per_unit.max() > 0.0).then(|| per_unit.scaled(1.0 / self.metres))
            }
        };
        Ok(Body { index: Some(index), absorption, medium, priority: *priority })
    }

    fn conductor(&self, at: &JsonPath<'_>, file: &ConductorFile) -> Result<Surface> {
        let ConductorFile { metal, eta, k, roughness } = file;
        let (n, k) = match (metal, eta, k) {
            (Some(name), _, _) => self.at(&at.key("metal"), library::metal(name))?,
            (None, Some(eta), Some(k)) => {
                let eta = self.spectrum(&at.key("eta"), eta, Role::Coefficient)?;
                (eta, self.spectrum(&at.key("k"), k, Role::Coefficient)?)
            }
            (None, _, _) => {
                return self.at(at, Err(Error::input("found no metal").expected("`metal`, or `eta` and `k`")));
            }
        };
        Surface::conductor(n, k, alpha(*roughness))
    }

    /// Resolves a reflectance.
    pub(super) fn reflectance(&self, at: &JsonPath<'_>, file: &ReflectanceFile) -> Result<Spectrum> {
        match file {
            ReflectanceFile::Spectrum(spectrum) => self.spectrum(at, spectrum, Role::Reflectance),
            ReflectanceFile::Image(_) | ReflectanceFile::Checker { .. } => {
                self.at(at, Err(unsupported("textures are")))
            }
        }
    }

    /// Resolves an index of refraction; what is clamped or fitted goes to the notes.
    fn index(&self, at: &JsonPath<'_>, file: &IndexFile, material: &str, notes: &mut Vec<String>) -> Result<Index> {
        let index = self.at(at, index_of(file, self.source))?;
        if let Some(warning) = index.warning() {
            let note = format!("material \"{material}\": {warning}");
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        Ok(index)
    }
}

/// The index that is written in a source.
pub(super) fn index_of(file: &IndexFile, source: &Source) -> Result<Index> {
    match file {
        IndexFile::Number(n) => Index::constant(*n),
        IndexFile::Name(name) => Index::catalogue(name),
        IndexFile::Cauchy { a, b, c } => Index::cauchy(*a, *b, *c),
        IndexFile::Sellmeier { b, c } => Index::sellmeier(b, c),
        IndexFile::Abbe { nd, vd } => Index::abbe(*nd, *vd),
        IndexFile::Table { nm, values } => Index::table(nm, values),
        IndexFile::Glass { path: None, name, formula: FormulaFile::Sellmeier } => Index::catalogue(name),
        IndexFile::Glass { path: None, name, formula: FormulaFile::Cauchy } => Index::catalogue_cauchy(name),
        IndexFile::Glass { path: Some(path), name, formula } => {
            let glass = super::lens::glass_file(&source.file(path)?)?.find(name)?;
            match formula {
                FormulaFile::Sellmeier => Ok(glass.index),
                FormulaFile::Cauchy => glass.cauchy_index(),
            }
        }
    }
}
