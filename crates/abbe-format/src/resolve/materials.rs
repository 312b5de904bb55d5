//! Translates the materials of the scene file to surfaces and bodies.

use super::index::{index_file, index_of};
use super::{context::Resolver, spectra::Role};
use crate::{
    ConductorFile, CrystalFile, DielectricFile, GratingFile, GratingProfileFile, GroovesFile, IndexFile, JsonPath,
    MaterialFile, OrderEfficiencyFile, PaneTransmittanceFile, ScalarFile, SpectrumFile, ThinDielectricFile,
};
use abbe_optics::bsdf::{
    Bsdf, Conductor, CosinePolynomial, DiffractionGrating, Fluorescent, Glossy, Grooves, ThinDielectric,
};
use abbe_optics::donaldson::DonaldsonMatrix;
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::grating::{EfficiencyTable, Grating, GratingProfile};
use abbe_optics::texture::SurfaceScalar;
use abbe_optics::thin_film::OpticalIndex;
use abbe_polarisation::crystal::Crystal;
use abbe_scene::{Body, Material};
use abbe_spectra::error::{Error, Result, both};
use abbe_spectra::spectrum::{Spectrum, library};
use glam::DVec3;

/// Mixed materials that are nested more deeply are reported as circular.
const MAX_DEPTH: usize = 16;

/// Returns the microfacet parameter α of a roughness. As in glTF, α is the square of the roughness,
/// so that equal steps of the roughness look equally large.
pub(super) fn alpha(roughness: f64) -> f64 {
    roughness * roughness
}

impl Resolver<'_> {
    /// Resolves the material of this name. `at` is the place of the name in the file.
    pub(super) fn material(&self, at: &JsonPath, name: &str, notes: &mut Vec<String>) -> Result<Material> {
        self.material_at_depth(at, name, notes, 0)
    }

    fn material_at_depth(&self, at: &JsonPath, name: &str, notes: &mut Vec<String>, depth: usize) -> Result<Material> {
        let Some(file) = self.scene.materials.get(name) else {
            let known = self.scene.materials.keys().map(String::as_str).collect();
            return Err(self.unknown_name(at, ["material", "materials"], name, known));
        };
        if depth > MAX_DEPTH {
            return self
                .at(at, Err(Error::input("this material contains itself, directly or through other materials")));
        }
        let root = JsonPath::Root;
        let materials = root.key("materials");
        let at = materials.key(name);
        let (surface, body) = match file {
            MaterialFile::Diffuse { reflectance } => {
                let at = at.key("diffuse");
                (Bsdf::diffuse(self.reflectance(&at.key("reflectance"), reflectance)?), None)
            }
            MaterialFile::Fluorescent { reflectance, absorptance, emission, quantum_yield } => {
                let at = at.key("fluorescent");
                let substrate = self.spectrum(&at.key("reflectance"), reflectance, Role::Reflectance);
                let absorptance = self.spectrum(&at.key("absorptance"), absorptance, Role::Absorptance);
                let emission = self.spectrum(&at.key("emission"), emission, Role::Light);
                let (substrate, (absorptance, emission)) = both(substrate, both(absorptance, emission))?;
                let fluorophore = self.at(&at, Fluorophore::new(absorptance, &emission, *quantum_yield))?;
                (Fluorescent::new(substrate, fluorophore).map(|surface| Bsdf::Fluorescent(Box::new(surface))), None)
            }
            MaterialFile::Bispectral { reflectance, matrix } => {
                let at = at.key("bispectral");
                let reflectance = self.spectrum(&at.key("reflectance"), reflectance, Role::Reflectance);
                let matrix = self.source.file(matrix).and_then(|path| {
                    let fluorophore = DonaldsonMatrix::read(&path).map(|matrix| Fluorophore::of_matrix(&matrix))?;
                    fluorophore.map_err(|error| error.in_file(&path))
                });
                let (reflectance, fluorophore) = both(reflectance, self.at(&at.key("matrix"), matrix))?;
                let surface = Fluorescent::measured(reflectance, fluorophore);
                (surface.map(|surface| Bsdf::Fluorescent(Box::new(surface))), None)
            }
            MaterialFile::Dielectric(file) => {
                let at = at.key("dielectric");
                let body = self.body(&at, file, name, notes)?;
                let surface = match (&file.coating, &body.index) {
                    (Some(coating), Some(index)) => {
                        let glass = OpticalIndex::Transparent(index.clone());
                        let films = self.coating(&at.key("coating"), coating, &glass)?;
                        self.rough(&at, &file.roughness, |alpha| Bsdf::coated_dielectric(films.clone(), index, alpha))
                    }
                    (None, _) | (_, None) => self.rough(&at, &file.roughness, Bsdf::dielectric),
                };
                (surface, Some(body))
            }
            MaterialFile::Crystal(file) => {
                let (surface, body) = self.crystal(&at.key("crystal"), file, name, notes)?;
                (Ok(surface), Some(body))
            }
            MaterialFile::ThinDielectric(file) => (self.pane(&at.key("thin_dielectric"), file, name, notes), None),
            MaterialFile::ThinFilm(file) => {
                let air = OpticalIndex::Transparent(self.at(&at, RefractiveIndex::constant(1.0))?);
                (Ok(Bsdf::thin_film(self.coating(&at.key("thin_film"), file, &air)?)), None)
            }
            MaterialFile::Polariser(_)
            | MaterialFile::Retarder(_)
            | MaterialFile::Stress(_)
            | MaterialFile::CircularPolariser(_)
            | MaterialFile::Filters(_) => {
                let filter = file.filter().map(|filter| self.filter(&at, &filter)).transpose()?;
                (filter.map_or(Ok(Bsdf::Absorber), Bsdf::polarising), None)
            }
            MaterialFile::Grating(file) => (self.grating(&at.key("grating"), file), None),
            MaterialFile::Conductor(file) => (self.conductor(&at.key("conductor"), file), None),
            MaterialFile::Mirror { reflectance } => {
                let at = at.key("mirror");
                (Bsdf::mirror(self.reflectance(&at.key("reflectance"), reflectance)?), None)
            }
            MaterialFile::Glossy { reflectance, ior, roughness, interreflection } => {
                let at = at.key("glossy");
                let reflectance = self.reflectance(&at.key("reflectance"), reflectance);
                let (reflectance, index) = both(reflectance, self.index(&at.key("ior"), ior, name, notes))?;
                let coated = |alpha| {
                    let glossy = Glossy::new(reflectance.clone(), index.clone(), alpha)?;
                    Ok(Bsdf::Glossy(if *interreflection { glossy.with_interreflection() } else { glossy }))
                };
                (self.rough(&at, roughness, coated), None)
            }
            MaterialFile::Translucent { reflectance, transmittance } => {
                let at = at.key("translucent");
                let reflectance = self.reflectance(&at.key("reflectance"), reflectance);
                let transmittance = self.reflectance(&at.key("transmittance"), transmittance);
                let (reflectance, transmittance) = both(reflectance, transmittance)?;
                (Bsdf::translucent(reflectance, transmittance), None)
            }
            MaterialFile::Mix(parts) => {
                let at = at.key("mix");
                let (mut surfaces, mut body) = (Vec::new(), None);
                for (i, part) in parts.iter().enumerate() {
                    let at = at.index(i);
                    let part_material =
                        self.material_at_depth(&at.key("material"), &part.material, notes, depth + 1)?;
                    if part_material.is_boundary() {
                        let what = "found a boundary, which has no surface";
                        return Err(self.source.fault(&at.key("material"), what, "a material with a surface"));
                    }
                    if part_material.normal_map.is_some() {
                        let what = "found a material with a normal map inside a mix";
                        return Err(self.source.fault(&at.key("material"), what, "a normal map of the whole mix"));
                    }
                    if part_material.surface.crystal().is_some() {
                        let what = "found a crystal inside a mix";
                        return Err(self.source.fault(&at.key("material"), what, "a crystal as the whole material"));
                    }
                    surfaces.push((self.scalar(&at.key("weight"), &part.weight)?, part_material.surface));
                    body = body.or(part_material.body);
                }
                (Bsdf::textured_mix(surfaces), body)
            }
            MaterialFile::NormalMap(file) => {
                let at = at.key("normal_map");
                let inner = self.material_at_depth(&at.key("material"), &file.material, notes, depth + 1)?;
                if inner.is_boundary() || inner.normal_map.is_some() {
                    let what = format!("found the material \"{}\"", file.material);
                    let expected = "a material with a surface and without a normal map";
                    return Err(self.source.fault(&at.key("material"), what, expected));
                }
                let map = self.at(&at, self.normal_map(file))?;
                return Ok(Material { name: name.to_string(), normal_map: Some(map), ..inner });
            }
            MaterialFile::Boundary { medium } => {
                let number = self.medium_number(&at.key("boundary").key("medium"), medium)?;
                return Ok(Material::boundary(name, number, self.scene.media[medium].priority()));
            }
            MaterialFile::Absorber => (Ok(Bsdf::Absorber), None),
        };
        Ok(Material { name: name.to_string(), surface: self.at(&at, surface)?, normal_map: None, body })
    }

    fn body(&self, at: &JsonPath, file: &DielectricFile, name: &str, notes: &mut Vec<String>) -> Result<Body> {
        let DielectricFile { ior, roughness: _, absorption, coating: _, medium, priority } = file;
        let medium = medium.as_ref().map(|name| self.medium_number(&at.key("medium"), name)).transpose();
        let index = self.index(&at.key("ior"), ior, name, notes);
        let absorption = self.absorption(at, absorption.as_ref());
        let ((medium, index), absorption) = both(both(medium, index), absorption)?;
        Ok(Body { index: Some(index), absorption, medium, priority: *priority })
    }

    fn crystal(&self, at: &JsonPath, file: &CrystalFile, name: &str, notes: &mut Vec<String>) -> Result<(Bsdf, Body)> {
        let CrystalFile { name: catalogue_name, ordinary, extraordinary, axis, absorption, priority } = file;
        let indices = match (catalogue_name, ordinary, extraordinary) {
            (None, Some(ordinary), Some(extraordinary)) => {
                let ordinary = self.index(&at.key("ordinary"), ordinary, name, notes);
                let extraordinary = self.index(&at.key("extraordinary"), extraordinary, name, notes);
                both(ordinary, extraordinary).map(|(ordinary, extraordinary)| [ordinary, extraordinary])
            }
            (Some(name), _, _) => self.at(&at.key("name"), Crystal::find(name).and_then(|crystal| crystal.indices())),
            // The check of the file has reported what is missing.
            (None, _, _) => RefractiveIndex::constant(1.0).map(|index| [index.clone(), index]),
        };
        let ([ordinary, extraordinary], absorption) = both(indices, self.absorption(at, absorption.as_ref()))?;
        let body = Body { index: Some(ordinary), absorption, medium: None, priority: *priority };
        Ok((Bsdf::crystal_surface(extraordinary, DVec3::from(*axis).normalize()), body))
    }

    /// Returns the absorption coefficient in 1/m, if it is not 0.
    fn absorption(&self, at: &JsonPath, file: Option<&SpectrumFile>) -> Result<Option<Spectrum>> {
        let resolve = |file| self.spectrum(&at.key("absorption"), file, Role::Coefficient);
        let absorption = file.map(resolve).transpose()?.filter(|per_unit| per_unit.max() > 0.0);
        Ok(absorption.map(|per_unit| per_unit.scaled(1.0 / self.metres)))
    }

    fn pane(&self, at: &JsonPath, file: &ThinDielectricFile, name: &str, notes: &mut Vec<String>) -> Result<Bsdf> {
        let ThinDielectricFile { ior, thickness, absorption, transmittance, coating } = file;
        let index = self.index(&at.key("ior"), ior, name, notes)?;
        let mut optical_depth = None;
        if let (Some(thickness), Some(absorption)) = (thickness, absorption) {
            let per_unit = self.spectrum(&at.key("absorption"), absorption, Role::Coefficient)?;
            optical_depth = (per_unit.max() > 0.0).then(|| per_unit.scaled(*thickness));
        }
        let mut pane = ThinDielectric::new(index.clone(), optical_depth)?;
        if let Some(PaneTransmittanceFile::CosinePolynomial(coefficients)) = transmittance {
            pane = pane.with_transmittance(CosinePolynomial::new(coefficients.clone()));
        }
        if let Some(coating) = coating {
            pane = pane.with_coating(self.coating(&at.key("coating"), coating, &OpticalIndex::Transparent(index))?);
        }
        Ok(Bsdf::ThinDielectric(pane))
    }

    fn grating(&self, at: &JsonPath, file: &GratingFile) -> Result<Bsdf> {
        let GratingFile { lines_per_mm, profile, reflectance, transmittance, grooves, angle } = file;
        let profile = match profile {
            GratingProfileFile::Table(orders) => {
                let efficiency = |(place, file): (usize, &OrderEfficiencyFile)| {
                    let (profile, role) = (at.key("profile"), Role::Reflectance);
                    let spectrum =
                        self.spectrum(&profile.key("table").index(place).key("efficiency"), &file.efficiency, role)?;
                    Ok((file.order, spectrum))
                };
                let orders: Vec<(i32, Spectrum)> = orders.iter().enumerate().map(efficiency).collect::<Result<_>>()?;
                GratingProfile::Table(EfficiencyTable::new(orders)?)
            }
            &GratingProfileFile::Blazed { order, nm } => GratingProfile::Blazed { order, blaze_nm: nm },
            &GratingProfileFile::Sinusoidal { amplitude, nm } => {
                GratingProfile::Sinusoidal { amplitude_rad: amplitude, at_nm: nm }
            }
            &GratingProfileFile::Lamellar { phase, nm, duty } => {
                GratingProfile::BinaryPhase { phase_rad: phase, at_nm: nm, duty }
            }
            &GratingProfileFile::Slits { duty } => GratingProfile::BinaryAmplitude { duty },
        };
        let fraction = |key: &str, file: &Option<SpectrumFile>, default: f64| match file {
            Some(file) => self.spectrum(&at.key(key), file, Role::Reflectance),
            None => Ok(Spectrum::constant(default)),
        };
        let reflected = fraction("reflectance", reflectance, if transmittance.is_some() { 0.0 } else { 1.0 });
        let (reflected, transmitted) = both(reflected, fraction("transmittance", transmittance, 0.0))?;
        let grooves = match grooves {
            GroovesFile::Parallel => Grooves::Parallel(angle.to_radians()),
            GroovesFile::Circular => Grooves::Circular,
        };
        let grating = Grating::new(*lines_per_mm, profile)?;
        DiffractionGrating::new(grating, reflected, transmitted, grooves).map(Bsdf::Grating)
    }

    fn conductor(&self, at: &JsonPath, file: &ConductorFile) -> Result<Bsdf> {
        let ConductorFile { metal, eta, k, file, reflectance, roughness, coating } = file;
        if let Some(reflectance) = reflectance {
            let reflectance = self.reflectance(&at.key("reflectance"), reflectance)?;
            return self.rough(at, roughness, |alpha| Bsdf::metal(reflectance.clone(), alpha));
        }
        let (n, k) = match (metal, eta, k) {
            (Some(name), _, _) => self.at(&at.key("metal"), library::metal(name))?.index(),
            (None, Some(eta), Some(k)) => {
                let eta = self.spectrum(&at.key("eta"), eta, Role::Coefficient);
                both(eta, self.spectrum(&at.key("k"), k, Role::Coefficient))?
            }
            (None, _, _) => {
                let expected = "`metal`, `eta` and `k`, `file` or `reflectance`";
                let missing = || Error::input("found no metal").expected(expected);
                let path = self.at(at, file.as_deref().ok_or_else(missing))?;
                self.at(&at.key("file"), index_file(path, self.source).and_then(|data| data.n_and_k()))?
            }
        };
        let bare = |alpha| Bsdf::conductor(n.clone(), k.clone(), alpha);
        let Some(coating) = coating else { return self.rough(at, roughness, bare) };
        let substrate = self.at(at, OpticalIndex::absorbing(n.clone(), k.clone()))?;
        let films = self.coating(&at.key("coating"), coating, &substrate)?;
        let coated = |alpha| Conductor::coated(n.clone(), k.clone(), films.clone(), alpha).map(Bsdf::Conductor);
        self.rough(at, roughness, coated)
    }

    /// Creates a BSDF whose roughness may vary. `of_alpha` creates that of a microfacet α.
    fn rough(&self, at: &JsonPath, file: &ScalarFile, of_alpha: impl Fn(f64) -> Result<Bsdf>) -> Result<Bsdf> {
        let of_roughness = |roughness| of_alpha(alpha(roughness));
        let at = at.key("roughness");
        match self.scalar(&at, file)? {
            SurfaceScalar::Uniform(roughness) => of_roughness(roughness),
            SurfaceScalar::Textured(texture) => self.at(&at, Bsdf::textured_roughness(texture, of_roughness)),
        }
    }

    /// Resolves a refractive index. If values were clamped or fitted, a remark is added to `notes`.
    fn index(&self, at: &JsonPath, file: &IndexFile, name: &str, notes: &mut Vec<String>) -> Result<RefractiveIndex> {
        let index = self.at(at, index_of(file, self.source))?;
        if let Some(warning) = index.warning() {
            let note = format!("material \"{name}\": {warning}");
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        Ok(index)
    }
}
