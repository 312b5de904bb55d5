//! Scattering functions of surfaces (BSDFs): reflection, transmission and absorption.
//!
//! Directions are unit vectors in the local frame of the surface, with z along the outward normal.
//! `wo` and `wi` both point away from the surface: photon paths and camera paths arrive along −`wo`
//! and continue along `wi`. If `wo.z` is negative, the path arrives from behind the surface.
//!
//! A [`Bsdf`] belongs to a material, and a [`LocalBsdf`] to one point of a surface, where the
//! component of a mixture and the texels of textures are selected.
//!
//! A path scatters in three steps. [`Bsdf::at`] or [`Bsdf::at_point`] returns the local BSDF, and
//! [`LocalBsdf::sample`] samples `wi` at the hero wavelength of the path. For each wavelength, the
//! weight is then [`LocalBsdf::eval_sample`] divided by [`BsdfSample::probability`], and the
//! absorbed fraction of the arriving power is [`LocalBsdf::absorbed_fraction`]. For photons, the
//! expectations of both sum to 1. The energy ledger relies on this balance, and the contract tests
//! check it for every BSDF.

mod albedo;
mod angle_grid;
mod check;
mod coated;
mod compensation;
mod conductor;
mod constructors;
#[cfg(test)]
mod contract;
mod crystal;
mod dielectric;
mod diffuse;
mod facet;
mod facet_quadrature;
mod film_moments;
mod filter;
mod fluorescent;
mod glossy;
mod grating;
mod hemisphere;
mod local;
mod mirror;
mod missing_energy;
#[cfg(test)]
mod model_tests;
mod polarisation;
mod power;
mod rough_interface;
mod sample;
mod selection;
mod texels;
mod thin;
mod translucent;

pub use coated::{CoatedDielectric, ThinFilm};
pub use conductor::Conductor;
pub use crystal::CrystalInterface;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use filter::{FilterElement, FilterLayer, LocalRetardance, PolarisingFilter, RetardanceField};
pub use fluorescent::Fluorescent;
pub use glossy::Glossy;
pub use grating::{DiffractionGrating, Grooves};
pub use local::LocalBsdf;
pub use mirror::Mirror;
pub use polarisation::FacetResponses;
pub use power::PowerFractions;
pub use sample::{BsdfClass, BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
pub use texels::Texels;
pub use thin::{CosinePolynomial, ThinDielectric};
pub use translucent::Translucent;

use crate::fluorophore::Fluorophore;
use crate::texture::{LookupRandom, ScalarTexture, SurfaceScalar, SurfaceSpectrum, TexturePoint};
use crate::thin_film::FilmStack;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Spectrum;
use selection::{Choice, ComponentSelection};

/// A BSDF.
#[derive(Debug, Clone, PartialEq)]
pub enum Bsdf {
    /// Absorbs all light.
    Absorber,
    /// See [`Diffuse`].
    Diffuse(Diffuse),
    /// See [`Fluorescent`].
    Fluorescent(Box<Fluorescent>),
    /// See [`Translucent`].
    Translucent(Translucent),
    /// See [`Mirror`].
    Mirror(Mirror),
    /// See [`Conductor`].
    Conductor(Conductor),
    /// See [`Dielectric`].
    Dielectric(Dielectric),
    /// See [`CoatedDielectric`].
    CoatedDielectric(CoatedDielectric),
    /// See [`CrystalInterface`].
    Crystal(Box<CrystalInterface>),
    /// See [`ThinDielectric`].
    ThinDielectric(ThinDielectric),
    /// See [`ThinFilm`].
    ThinFilm(ThinFilm),
    /// See [`DiffractionGrating`].
    Grating(DiffractionGrating),
    /// See [`Glossy`].
    Glossy(Glossy),
    /// See [`MixBsdf`].
    Mix(MixBsdf),
}

/// A mixture of BSDFs, of which each path scatters at one, chosen by normalised weight.
#[derive(Debug, Clone, PartialEq)]
pub struct MixBsdf {
    components: Vec<Bsdf>,
    selection: ComponentSelection,
    textured: bool,
    class: BsdfClass,
}

/// The number of steps into which the range of roughness from 0 to 1 is divided.
const ROUGHNESS_LEVELS: f64 = 32.0;

impl Bsdf {
    /// Returns the width class of the BSDF: the widest among the components of a mixture.
    #[inline(always)]
    pub fn class(&self) -> BsdfClass {
        match self {
            Self::Absorber => BsdfClass::Absorbing,
            Self::Mirror(_) | Self::ThinDielectric(_) | Self::ThinFilm(_) | Self::Grating(_) => BsdfClass::Specular,
            Self::Crystal(_) => BsdfClass::Specular,
            Self::Conductor(conductor) => rough_class(conductor.is_rough()),
            Self::CoatedDielectric(coated) => rough_class(coated.is_rough()),
            Self::Dielectric(dielectric) => rough_class(dielectric.is_rough()),
            Self::Glossy(_) => BsdfClass::Glossy,
            Self::Diffuse(_) | Self::Fluorescent(_) | Self::Translucent(_) => BsdfClass::Diffuse,
            Self::Mix(mix) => mix.class,
        }
    }

    /// Returns true if the BSDF transmits light.
    #[inline]
    pub fn is_transmissive(&self) -> bool {
        match self {
            Self::Translucent(_) | Self::Dielectric(_) | Self::CoatedDielectric(_) => true,
            Self::ThinDielectric(_) | Self::ThinFilm(_) | Self::Crystal(_) => true,
            Self::Mix(mix) => mix.components().iter().any(Self::is_transmissive),
            Self::Grating(grating) => grating.transmits(),
            Self::Absorber | Self::Diffuse(_) | Self::Fluorescent(_) => false,
            Self::Mirror(_) | Self::Conductor(_) | Self::Glossy(_) => false,
        }
    }

    /// Returns the GGX roughness α of a rough metal or of rough glass, or `None` for a mixture and
    /// for any other surface.
    pub fn alpha(&self) -> Option<f64> {
        match self {
            Self::Conductor(conductor) => conductor.alpha(),
            Self::Dielectric(dielectric) => dielectric.alpha(),
            Self::CoatedDielectric(coated) => coated.alpha(),
            Self::Absorber | Self::Diffuse(_) | Self::Fluorescent(_) | Self::Translucent(_) | Self::Mirror(_) => None,
            Self::Crystal(_) => None,
            Self::ThinDielectric(_) | Self::ThinFilm(_) | Self::Grating(_) | Self::Glossy(_) | Self::Mix(_) => None,
        }
    }

    /// Returns the thin films of the BSDF, or `None` for a mixture and for an empty stack.
    #[inline]
    pub fn films(&self) -> Option<&FilmStack> {
        let films = match self {
            Self::CoatedDielectric(coated) => Some(&coated.films),
            Self::ThinFilm(film) => Some(&film.films),
            Self::ThinDielectric(pane) => pane.coating.as_ref(),
            Self::Conductor(metal) => metal.films(),
            Self::Absorber | Self::Diffuse(_) | Self::Fluorescent(_) | Self::Translucent(_) | Self::Mirror(_) => None,
            Self::Dielectric(_) | Self::Crystal(_) | Self::Grating(_) | Self::Glossy(_) | Self::Mix(_) => None,
        };
        films.filter(|films| !films.layers().is_empty())
    }

    /// Returns the BSDF without its thin films, so that a free-standing film lets all light pass.
    pub fn without_films(self) -> Result<Self> {
        Ok(match self {
            Self::CoatedDielectric(coated) => Self::Dielectric(coated.without_films()),
            Self::ThinFilm(_) => Self::thin_film(FilmStack::new(Vec::new())?),
            Self::ThinDielectric(pane) => Self::ThinDielectric(ThinDielectric { coating: None, ..pane }),
            Self::Conductor(metal) => Self::Conductor(metal.without_films()),
            Self::Mix(mix) => Self::Mix(mix.with_components(Self::without_films)?),
            Self::Absorber | Self::Diffuse(_) | Self::Fluorescent(_) | Self::Translucent(_) => self,
            Self::Mirror(_) | Self::Dielectric(_) | Self::Crystal(_) | Self::Grating(_) | Self::Glossy(_) => self,
        })
    }

    /// Returns the BSDF without fluorescence; a fluorescent surface keeps its reflection.
    pub fn without_fluorescence(self) -> Result<Self> {
        if let Self::Mix(mix) = self {
            return Ok(Self::Mix(mix.with_components(Self::without_fluorescence)?));
        }
        self.as_fluorescent().map_or_else(|| Ok(self.clone()), |surface| surface.without_emission().map(Self::Diffuse))
    }

    /// Returns the fluorescent surface, or `None` for a mixture.
    #[inline]
    pub fn as_fluorescent(&self) -> Option<&Fluorescent> {
        if let Self::Fluorescent(surface) = self { Some(surface) } else { None }
    }

    /// Returns the fluorescent surfaces among the components.
    pub fn fluorescent(&self) -> impl Iterator<Item = &Fluorescent> {
        self.components().filter_map(Self::as_fluorescent)
    }

    /// Calls `change` for the fluorophore of each component.
    pub fn for_each_fluorophore(&mut self, change: &mut impl FnMut(&mut Fluorophore)) {
        if let Self::Fluorescent(surface) = self {
            change(&mut surface.fluorophore);
        } else if let Self::Mix(mix) = self {
            mix.components_mut().for_each(|part| part.for_each_fluorophore(change));
        }
    }

    /// Returns the grating of the BSDF, or `None` for a mixture.
    #[inline]
    pub fn grating(&self) -> Option<&DiffractionGrating> {
        if let Self::Grating(grating) = self { Some(grating) } else { None }
    }

    /// Returns the BSDF without polarising filters, which become holes, and without double
    /// refraction.
    pub fn without_filters(self) -> Result<Self> {
        Ok(match self {
            Self::Mix(mix) => Self::Mix(mix.with_components(Self::without_filters)?),
            Self::ThinDielectric(pane) => Self::ThinDielectric(ThinDielectric { filter: None, ..pane }),
            Self::Absorber | Self::Diffuse(_) | Self::Fluorescent(_) | Self::Translucent(_) | Self::Mirror(_) => self,
            Self::Conductor(_) | Self::Dielectric(_) | Self::CoatedDielectric(_) | Self::ThinFilm(_) => self,
            Self::Grating(_) | Self::Glossy(_) => self,
            Self::Crystal(_) => Self::dielectric(0.0)?,
        })
    }

    /// Returns the surface of a crystal, or `None` for a mixture.
    #[inline]
    pub fn crystal(&self) -> Option<&CrystalInterface> {
        if let Self::Crystal(crystal) = self { Some(crystal) } else { None }
    }

    /// Returns the polarising filter of a sheet, or `None` for a mixture.
    #[inline]
    pub fn filter(&self) -> Option<&PolarisingFilter> {
        if let Self::ThinDielectric(pane) = self { pane.filter() } else { None }
    }

    /// Returns the polarising filters among the components.
    pub fn filters(&self) -> impl Iterator<Item = &PolarisingFilter> {
        self.components().filter_map(Self::filter)
    }

    /// Returns the BSDF with gratings that diffract all light like light of the wavelength `nm`,
    /// and with the extraordinary index of this wavelength.
    pub fn without_dispersion(self, nm: f64) -> Result<Self> {
        if let Self::Mix(mix) = self {
            return Ok(Self::Mix(mix.with_components(|part| part.without_dispersion(nm))?));
        }
        if let Self::Crystal(crystal) = self {
            return Ok(Self::Crystal(Box::new(crystal.without_dispersion(nm)?)));
        }
        Ok(if let Self::Grating(grating) = self { Self::Grating(grating.without_dispersion(nm)) } else { self })
    }

    /// Returns the reflectances and transmittances that may vary over the surface.
    pub fn surface_spectra(&self) -> Vec<&SurfaceSpectrum> {
        match self {
            Self::Absorber | Self::Fluorescent(_) | Self::Dielectric(_) | Self::CoatedDielectric(_) => Vec::new(),
            Self::ThinDielectric(_) | Self::ThinFilm(_) | Self::Grating(_) | Self::Crystal(_) => Vec::new(),
            Self::Diffuse(diffuse) => vec![&diffuse.reflectance],
            Self::Translucent(sheet) => vec![&sheet.reflectance, &sheet.transmittance],
            Self::Mirror(mirror) => vec![&mirror.reflectance],
            Self::Conductor(metal) => metal.reflectance().into_iter().collect(),
            Self::Glossy(glossy) => vec![&glossy.reflectance],
            Self::Mix(mix) => mix.components().iter().flat_map(Self::surface_spectra).collect(),
        }
    }

    /// Returns true if a spectrum of the BSDF was made from an RGB colour.
    pub fn is_upsampled(&self) -> bool {
        match self {
            Self::ThinDielectric(thin) => thin.optical_depth.iter().any(Spectrum::is_upsampled),
            Self::Conductor(metal) => metal.is_upsampled(),
            Self::Grating(grating) => grating.is_upsampled(),
            Self::Fluorescent(surface) => surface.is_upsampled(),
            Self::Mix(mix) => mix.components().iter().any(Self::is_upsampled),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Translucent(_)
            | Self::Mirror(_)
            | Self::Dielectric(_)
            | Self::CoatedDielectric(_)
            | Self::Crystal(_)
            | Self::ThinFilm(_)
            | Self::Glossy(_) => self.surface_spectra().into_iter().any(SurfaceSpectrum::is_upsampled),
        }
    }

    /// Returns true if a property of the BSDF varies over the surface.
    #[inline]
    pub fn is_textured(&self) -> bool {
        match self {
            Self::Absorber | Self::Fluorescent(_) | Self::Dielectric(_) | Self::Crystal(_) | Self::Grating(_) => false,
            Self::CoatedDielectric(coated) => coated.films.is_textured(),
            Self::ThinDielectric(pane) => {
                let varies = pane.filter().is_some_and(|filter| filter.varying().is_some());
                varies || pane.coating.as_ref().is_some_and(FilmStack::is_textured)
            }
            Self::ThinFilm(film) => film.films.is_textured(),
            Self::Diffuse(diffuse) => diffuse.reflectance.is_textured(),
            Self::Translucent(sheet) => sheet.reflectance.is_textured() || sheet.transmittance.is_textured(),
            Self::Mirror(mirror) => mirror.reflectance.is_textured(),
            Self::Conductor(metal) => metal.is_textured(),
            Self::Glossy(glossy) => glossy.reflectance.is_textured(),
            Self::Mix(mix) => mix.is_textured(),
        }
    }

    /// Returns the BSDF with each texture replaced by a uniform value that stands for it.
    #[must_use]
    pub fn without_textures(self) -> Self {
        match self {
            Self::Diffuse(diffuse) => Self::Diffuse(Diffuse { reflectance: diffuse.reflectance.without_texture() }),
            Self::Translucent(sheet) => Self::Translucent(sheet.without_textures()),
            Self::Mirror(mirror) => Self::Mirror(Mirror { reflectance: mirror.reflectance.without_texture() }),
            Self::Conductor(metal) => Self::Conductor(metal.without_textures()),
            Self::Glossy(glossy) => Self::Glossy(glossy.without_textures()),
            Self::Mix(mix) => Self::Mix(mix.without_textures()),
            Self::CoatedDielectric(coated) => Self::CoatedDielectric(coated.without_textures()),
            Self::ThinDielectric(pane) => {
                let coating = pane.coating.map(FilmStack::without_textures);
                let filter = pane.filter.map(|filter| Box::new(filter.without_textures()));
                Self::ThinDielectric(ThinDielectric { coating, filter, ..pane })
            }
            Self::ThinFilm(film) => Self::thin_film(film.films.without_textures()),
            Self::Absorber | Self::Fluorescent(_) | Self::Dielectric(_) | Self::Crystal(_) | Self::Grating(_) => self,
        }
    }

    /// Returns the pane that covers the whole surface uniformly, so that shadow rays can pass, or
    /// `None` for all other surfaces, also for mixtures with panes.
    pub fn uniform_pane(&self) -> Option<&ThinDielectric> {
        if let Self::ThinDielectric(pane) = self { Some(pane).filter(|pane| pane.coating.is_none()) } else { None }
    }

    /// Returns true for a uniform pane, or a mixture with one, such as a mask with holes.
    pub fn has_uniform_pane(&self) -> bool {
        self.components().any(|component| component.uniform_pane().is_some())
    }

    /// Iterates over the (unmixed) components of a mixture, or over the BSDF itself.
    pub fn components(&self) -> impl Iterator<Item = &Self> {
        let components = if let Self::Mix(mix) = self { mix.components() } else { std::slice::from_ref(self) };
        components.iter()
    }
}

fn rough_class(rough: bool) -> BsdfClass {
    if rough { BsdfClass::Glossy } else { BsdfClass::Specular }
}

impl MixBsdf {
    /// Creates a mixture of parts, each with a weight ≥ 0. The weights are normalised, nested
    /// mixtures are flattened, and parts of weight 0 are dropped. Returns an error if a weight is
    /// negative or not finite, or no weight is positive.
    pub fn new(parts: Vec<(f64, Bsdf)>) -> Result<Self> {
        Self::textured(parts.into_iter().map(|(weight, bsdf)| (SurfaceScalar::Uniform(weight), bsdf)).collect())
    }

    /// Creates a mixture of weights that may vary over the surface and are normalised at each
    /// point; where all are 0, the first part is chosen. Errors are those of [`Self::new`].
    pub fn textured(parts: Vec<(SurfaceScalar, Bsdf)>) -> Result<Self> {
        let bad = parts.iter().map(|(weight, _)| weight.range()).find(|(low, high)| !(*low >= 0.0 && high.is_finite()));
        if let Some((low, high)) = bad {
            let bad = if low >= 0.0 { high } else { low };
            return Err(Error::input(format!("a mixture weight of {bad}")).expected("a number from 0 up"));
        }
        let parts: Vec<(SurfaceScalar, Bsdf)> =
            parts.into_iter().filter(|(weight, _)| weight.range().1 > 0.0).collect();
        let total: f64 = parts.iter().map(|(weight, _)| weight.mean()).sum();
        if !(total > 0.0 && total.is_finite()) {
            return Err(Error::input("a mixture without a positive weight").expected("at least one positive weight"));
        }
        let varies = parts
            .iter()
            .any(|(weight, bsdf)| weight.is_textured() || matches!(bsdf, Bsdf::Mix(mix) if mix.selection.varies()));
        let (mut components, mut weights, mut choices) = (Vec::new(), Vec::new(), Vec::new());
        for (weight, bsdf) in parts {
            let mean = weight.mean() / total;
            choices.push((weight, add_part(bsdf, mean, &mut components, &mut weights)));
        }
        Ok(Self::of_components(
            components,
            ComponentSelection::new(&weights, varies.then_some(Choice::Weighted(choices))),
        ))
    }

    /// Creates a BSDF whose roughness varies over the surface, as a mixture of BSDFs, which
    /// `of_roughness` creates, at 33 levels of roughness from 0 to 1. Only the two levels next to
    /// the local roughness are chosen. Returns an error if the roughness lies outside \[0, 1\] at
    /// any point, or an error of `of_roughness`.
    pub fn of_roughness(roughness: ScalarTexture, of_roughness: impl Fn(f64) -> Result<Bsdf>) -> Result<Self> {
        let (low, high) = roughness.range();
        if !(low >= 0.0 && high <= 1.0) {
            let bad = if low >= 0.0 { high } else { low };
            return Err(Error::input(format!("a roughness of {bad}")).expected("numbers from 0 to 1"));
        }
        let first = (low * ROUGHNESS_LEVELS).floor();
        let count = (high * ROUGHNESS_LEVELS).ceil() - first + 1.0;
        let step = ROUGHNESS_LEVELS.recip();
        let (mut components, mut weights, mut levels) = (Vec::new(), Vec::new(), Vec::new());
        for level in 0..count as u32 {
            let bsdf = of_roughness((first + f64::from(level)) * step)?;
            levels.push(add_part(bsdf, count.recip(), &mut components, &mut weights));
        }
        let choice = Choice::Levels { roughness, first: first * step, step, levels };
        Ok(Self::of_components(components, ComponentSelection::new(&weights, Some(choice))))
    }

    fn of_components(components: Vec<Bsdf>, selection: ComponentSelection) -> Self {
        let class = components.iter().map(Bsdf::class).max().unwrap_or(BsdfClass::Absorbing);
        let textured = selection.varies() || components.iter().any(Bsdf::is_textured);
        Self { components, selection, textured, class }
    }

    /// Returns the components, none of which is itself a mixture.
    pub(super) fn components(&self) -> &[Bsdf] {
        &self.components
    }

    pub(super) fn is_textured(&self) -> bool {
        self.textured
    }

    pub(super) fn without_textures(self) -> Self {
        let weights: Vec<f64> = self.selection.weights().collect();
        let components = self.components.into_iter().map(Bsdf::without_textures).collect();
        Self::of_components(components, ComponentSelection::new(&weights, None))
    }

    pub(super) fn with_components(self, replace: impl Fn(Bsdf) -> Result<Bsdf>) -> Result<Self> {
        let components = self.components.into_iter().map(replace).collect::<Result<_>>()?;
        Ok(Self { components, ..self })
    }

    /// Iterates over the components, which the caller must not replace by mixtures.
    pub(super) fn components_mut(&mut self) -> impl Iterator<Item = &mut Bsdf> {
        self.components.iter_mut()
    }

    pub(super) fn weighted_components(&self) -> impl Iterator<Item = (f64, &Bsdf)> {
        self.selection.weights().zip(&self.components)
    }

    /// Selects a component, and returns its index. Rescales `u` to \[0, 1) for further use.
    pub(super) fn sample_index(&self, u: &mut f64) -> usize {
        self.selection.sample_index(u)
    }

    pub(super) fn sample_component(&self, mut u: f64) -> &Bsdf {
        &self.components[self.sample_index(&mut u)]
    }

    pub(super) fn component_at(&self, point: &TexturePoint, random: &mut LookupRandom) -> &Bsdf {
        &self.components[self.selection.at(point, random)]
    }
}

/// Adds a part's components, weighted, to a mixture, and returns the choice among them.
fn add_part(bsdf: Bsdf, weight: f64, components: &mut Vec<Bsdf>, weights: &mut Vec<f64>) -> Choice {
    let first = components.len();
    let Bsdf::Mix(inner) = bsdf else {
        weights.push(weight);
        components.push(bsdf);
        return Choice::Component(first);
    };
    weights.extend(inner.selection.weights().map(|inner_weight| weight * inner_weight));
    components.extend(inner.components);
    inner.selection.into_choice().shifted(first)
}
