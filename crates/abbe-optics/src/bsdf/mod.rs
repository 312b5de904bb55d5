//! Scattering functions of surfaces (BSDFs): reflection, transmission and absorption.
//!
//! Directions are unit vectors in the local frame of the surface, with z along the outward normal.
//! `wo` and `wi` both point away from the surface. Both photon paths and camera paths arrive along
//! −`wo` and continue along `wi`. If `wo.z` is negative, the path arrives from behind the surface.
//!
//! A [`Bsdf`] belongs to a material. A [`LocalBsdf`] is a BSDF at one point of a surface: the
//! component of a mixture and the texels of textures are selected.
//!
//! A path scatters in three steps. [`Bsdf::at`] or [`Bsdf::at_point`] returns the local BSDF.
//! [`LocalBsdf::sample`] samples `wi` at the hero wavelength of the path. The third step computes a
//! weight and an absorbed fraction for each wavelength of the path. The weight is
//! [`LocalBsdf::eval_sample`] divided by [`BsdfSample::probability`]. The absorbed fraction of the
//! arriving power is [`LocalBsdf::absorbed_fraction`]. For photons, the expected weight and the
//! expected absorbed fraction sum to 1. The energy ledger relies on this balance, and the contract
//! tests check it for every BSDF.
//!
//! Each variant has its own file. Each variant is documented at its type. Every variant must pass
//! the tests in `contract`.

mod albedo;
mod angle_grid;
mod check;
mod coated;
mod compensation;
mod conductor;
#[cfg(test)]
mod contract;
mod dielectric;
mod diffuse;
mod facet_quadrature;
mod film_moments;
mod fluorescent;
mod glossy;
mod grating;
mod hemisphere;
mod local;
mod mirror;
mod missing_energy;
mod mix;
mod power;
mod rough_interface;
mod sample;
mod thin;
mod translucent;

use super::fluorophore::Fluorophore;
use super::glass::RefractiveIndex;
use super::thin_film::FilmStack;
use crate::texture::{LookupRandom, ScalarTexture, SurfaceScalar, SurfaceSpectrum, TexturePoint};
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::Spectrum;

pub use coated::{CoatedDielectric, ThinFilm};
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use fluorescent::Fluorescent;
pub use glossy::Glossy;
pub use grating::{DiffractionGrating, Grooves};
pub use local::{LocalBsdf, Texels};
pub use mirror::Mirror;
pub use mix::MixBsdf;
pub use power::PowerFractions;
pub use sample::{BsdfClass, BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
pub use thin::{CosinePolynomial, ThinDielectric};
pub use translucent::Translucent;

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

impl Bsdf {
    /// Creates a [`Diffuse`] BSDF; see [`Diffuse::new`].
    pub fn diffuse(reflectance: impl Into<SurfaceSpectrum>) -> Result<Self> {
        Diffuse::new(reflectance).map(Self::Diffuse)
    }

    /// Creates a [`Translucent`] BSDF; see [`Translucent::new`].
    pub fn translucent(
        reflectance: impl Into<SurfaceSpectrum>,
        transmittance: impl Into<SurfaceSpectrum>,
    ) -> Result<Self> {
        Translucent::new(reflectance, transmittance).map(Self::Translucent)
    }

    /// Creates a [`Mirror`] BSDF; see [`Mirror::new`].
    pub fn mirror(reflectance: impl Into<SurfaceSpectrum>) -> Result<Self> {
        Mirror::new(reflectance).map(Self::Mirror)
    }

    /// Creates a [`Conductor`] BSDF; see [`Conductor::new`].
    pub fn conductor(n: Spectrum, k: Spectrum, alpha: f64) -> Result<Self> {
        Conductor::new(n, k, alpha).map(Self::Conductor)
    }

    /// Creates a [`Conductor`] BSDF of a given reflectance; see [`Conductor::of_reflectance`].
    pub fn metal(reflectance: impl Into<SurfaceSpectrum>, alpha: f64) -> Result<Self> {
        Conductor::of_reflectance(reflectance, alpha).map(Self::Conductor)
    }

    /// Creates a [`Dielectric`] BSDF; see [`Dielectric::new`].
    pub fn dielectric(alpha: f64) -> Result<Self> {
        Dielectric::new(alpha).map(Self::Dielectric)
    }

    /// Creates a [`ThinDielectric`] BSDF; see [`ThinDielectric::new`].
    pub fn thin_dielectric(index: RefractiveIndex, optical_depth: Option<Spectrum>) -> Result<Self> {
        ThinDielectric::new(index, optical_depth).map(Self::ThinDielectric)
    }

    /// Creates a [`CoatedDielectric`] BSDF; see [`CoatedDielectric::new`].
    pub fn coated_dielectric(films: FilmStack, index: &RefractiveIndex, alpha: f64) -> Result<Self> {
        CoatedDielectric::new(films, index, alpha).map(Self::CoatedDielectric)
    }

    /// Creates a [`ThinFilm`] BSDF; see [`ThinFilm::new`].
    pub fn thin_film(films: FilmStack) -> Self {
        Self::ThinFilm(ThinFilm::new(films))
    }

    /// Creates a [`Glossy`] BSDF; see [`Glossy::new`].
    pub fn glossy(reflectance: impl Into<SurfaceSpectrum>, index: RefractiveIndex, alpha: f64) -> Result<Self> {
        Glossy::new(reflectance, index, alpha).map(Self::Glossy)
    }

    /// Creates a [`MixBsdf`] BSDF; see [`MixBsdf::new`].
    pub fn mix(parts: Vec<(f64, Self)>) -> Result<Self> {
        MixBsdf::new(parts).map(Self::Mix)
    }

    /// Creates a mixture whose weights may vary over the surface; see [`MixBsdf::textured`].
    pub fn textured_mix(parts: Vec<(SurfaceScalar, Self)>) -> Result<Self> {
        MixBsdf::textured(parts).map(Self::Mix)
    }

    /// Creates a BSDF whose roughness varies over the surface; see [`MixBsdf::of_roughness`].
    pub fn textured_roughness(roughness: ScalarTexture, of_roughness: impl Fn(f64) -> Result<Self>) -> Result<Self> {
        MixBsdf::of_roughness(roughness, of_roughness).map(Self::Mix)
    }

    /// Returns the width class of the BSDF. The class of a mixture is the widest class among its
    /// components.
    #[inline(always)]
    pub fn class(&self) -> BsdfClass {
        match self {
            Self::Absorber => BsdfClass::Absorbing,
            Self::Mirror(_) | Self::ThinDielectric(_) | Self::ThinFilm(_) | Self::Grating(_) => BsdfClass::Specular,
            Self::Conductor(conductor) => rough_class(conductor.is_rough()),
            Self::CoatedDielectric(coated) => rough_class(coated.is_rough()),
            Self::Dielectric(dielectric) => rough_class(dielectric.is_rough()),
            Self::Glossy(_) => BsdfClass::Glossy,
            Self::Diffuse(_) | Self::Fluorescent(_) | Self::Translucent(_) => BsdfClass::Diffuse,
            Self::Mix(mix) => mix.class(),
        }
    }

    /// Returns whether the BSDF transmits light.
    #[inline]
    pub fn is_transmissive(&self) -> bool {
        match self {
            Self::Translucent(_)
            | Self::Dielectric(_)
            | Self::CoatedDielectric(_)
            | Self::ThinDielectric(_)
            | Self::ThinFilm(_) => true,
            Self::Mix(mix) => mix.components().iter().any(Self::is_transmissive),
            Self::Grating(grating) => grating.transmits(),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Fluorescent(_)
            | Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Glossy(_) => false,
        }
    }

    /// Returns the thin films of the BSDF. A mixture and an empty stack return `None`.
    #[inline]
    pub fn films(&self) -> Option<&FilmStack> {
        let films = match self {
            Self::CoatedDielectric(coated) => Some(&coated.films),
            Self::ThinFilm(film) => Some(&film.films),
            Self::ThinDielectric(pane) => pane.coating.as_ref(),
            Self::Conductor(metal) => metal.films(),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Fluorescent(_)
            | Self::Translucent(_)
            | Self::Mirror(_)
            | Self::Dielectric(_)
            | Self::Grating(_)
            | Self::Glossy(_)
            | Self::Mix(_) => None,
        };
        films.filter(|films| !films.layers().is_empty())
    }

    /// Returns the BSDF without its thin films. A free-standing film lets all light pass.
    pub fn without_films(self) -> Result<Self> {
        Ok(match self {
            Self::CoatedDielectric(coated) => Self::Dielectric(coated.without_films()),
            Self::ThinFilm(_) => Self::thin_film(FilmStack::new(Vec::new())?),
            Self::ThinDielectric(pane) => Self::ThinDielectric(ThinDielectric { coating: None, ..pane }),
            Self::Conductor(metal) => Self::Conductor(metal.without_films()),
            Self::Mix(mix) => Self::Mix(mix.with_components(Self::without_films)?),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Fluorescent(_)
            | Self::Translucent(_)
            | Self::Mirror(_)
            | Self::Dielectric(_)
            | Self::Grating(_)
            | Self::Glossy(_) => self,
        })
    }

    /// Returns the BSDF without fluorescence. A fluorescent surface keeps its reflection ρ(λ).
    pub fn without_fluorescence(self) -> Result<Self> {
        if let Self::Mix(mix) = self {
            return Ok(Self::Mix(mix.with_components(Self::without_fluorescence)?));
        }
        self.as_fluorescent().map_or_else(|| Ok(self.clone()), |surface| surface.without_emission().map(Self::Diffuse))
    }

    /// Returns the fluorescent surface. A mixture returns `None`.
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

    /// Returns the grating of the BSDF. A mixture returns `None`.
    #[inline]
    pub fn grating(&self) -> Option<&DiffractionGrating> {
        if let Self::Grating(grating) = self { Some(grating) } else { None }
    }

    /// Returns the BSDF with each grating replaced by one that diffracts all light like light of
    /// the wavelength `nm`.
    pub fn without_dispersion(self, nm: f64) -> Result<Self> {
        Ok(match self {
            Self::Grating(grating) => Self::Grating(grating.without_dispersion(nm)),
            Self::Mix(mix) => Self::Mix(mix.with_components(|part| part.without_dispersion(nm))?),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Fluorescent(_)
            | Self::Translucent(_)
            | Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::CoatedDielectric(_)
            | Self::ThinDielectric(_)
            | Self::ThinFilm(_)
            | Self::Glossy(_) => self,
        })
    }

    /// Returns the spectra of the BSDF that may vary over the surface: reflectances and
    /// transmittances.
    pub fn surface_spectra(&self) -> Vec<&SurfaceSpectrum> {
        match self {
            Self::Absorber
            | Self::Fluorescent(_)
            | Self::Dielectric(_)
            | Self::CoatedDielectric(_)
            | Self::ThinDielectric(_)
            | Self::ThinFilm(_)
            | Self::Grating(_) => Vec::new(),
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
            | Self::ThinFilm(_)
            | Self::Glossy(_) => self.surface_spectra().into_iter().any(SurfaceSpectrum::is_upsampled),
        }
    }

    /// Returns true if a property of the BSDF varies over the surface.
    #[inline]
    pub fn is_textured(&self) -> bool {
        match self {
            Self::Absorber | Self::Fluorescent(_) | Self::Dielectric(_) | Self::Grating(_) => false,
            Self::CoatedDielectric(coated) => coated.films.is_textured(),
            Self::ThinDielectric(pane) => pane.coating.as_ref().is_some_and(FilmStack::is_textured),
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
                Self::ThinDielectric(ThinDielectric { coating, ..pane })
            }
            Self::ThinFilm(film) => Self::thin_film(film.films.without_textures()),
            Self::Absorber | Self::Fluorescent(_) | Self::Dielectric(_) | Self::Grating(_) => self,
        }
    }

    /// Returns the BSDF at any point of a surface without textures. The random number `u` in
    /// \[0, 1) selects the component of a mixture. The probability of a component is its normalised
    /// weight.
    #[inline(always)]
    pub fn at(&self, u: f64) -> LocalBsdf<'_> {
        LocalBsdf {
            model: if let Self::Mix(mix) = self { mix.sample_component(u) } else { self },
            texels: Texels::NONE,
        }
    }

    /// Returns the BSDF at a point of a surface with textures. The random number `u` in \[0, 1)
    /// selects the component of a mixture and the texels.
    pub fn at_point(&self, point: &TexturePoint, u: f64) -> LocalBsdf<'_> {
        let mut random = LookupRandom::new(u);
        let model = if let Self::Mix(mix) = self { mix.component_at(point, &mut random) } else { self };
        if let Some(films) = model.films()
            && films.is_textured()
        {
            return LocalBsdf { model, texels: Texels::of_thickness(films.thickness_at(point, &mut random)) };
        }
        let mut texel = |spectrum: &SurfaceSpectrum| spectrum.texel(point, &mut random);
        let texels = match model {
            Self::Diffuse(diffuse) => Texels::of_reflectance(texel(&diffuse.reflectance)),
            Self::Translucent(sheet) => Texels {
                reflectance: texel(&sheet.reflectance),
                transmittance: texel(&sheet.transmittance),
                ..Texels::NONE
            },
            Self::Mirror(mirror) => Texels::of_reflectance(texel(&mirror.reflectance)),
            Self::Conductor(metal) => Texels::of_reflectance(metal.reflectance().map_or(0, &mut texel)),
            Self::Glossy(glossy) => Texels::of_reflectance(texel(&glossy.reflectance)),
            Self::Absorber
            | Self::Fluorescent(_)
            | Self::Dielectric(_)
            | Self::CoatedDielectric(_)
            | Self::ThinDielectric(_)
            | Self::ThinFilm(_)
            | Self::Grating(_)
            | Self::Mix(_) => Texels::NONE,
        };
        LocalBsdf { model, texels }
    }

    /// Returns the pane that covers the whole surface and is the same everywhere, so that shadow
    /// rays can pass through it. Returns `None` for all other surfaces, also for mixtures with
    /// panes.
    pub fn uniform_pane(&self) -> Option<&ThinDielectric> {
        if let Self::ThinDielectric(pane) = self { Some(pane).filter(|pane| pane.coating.is_none()) } else { None }
    }

    /// Iterates over the components of a mixture, which are never mixtures themselves. Any other
    /// BSDF yields itself.
    pub fn components(&self) -> impl Iterator<Item = &Self> {
        let components = match self {
            Self::Mix(mix) => mix.components(),
            Self::Absorber
            | Self::Diffuse(_)
            | Self::Fluorescent(_)
            | Self::Translucent(_)
            | Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::CoatedDielectric(_)
            | Self::ThinDielectric(_)
            | Self::ThinFilm(_)
            | Self::Grating(_)
            | Self::Glossy(_) => std::slice::from_ref(self),
        };
        components.iter()
    }
}

fn rough_class(rough: bool) -> BsdfClass {
    if rough { BsdfClass::Glossy } else { BsdfClass::Specular }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::Outside;

    #[test]
    fn fractions_outside_0_to_1_are_refused_and_named() {
        for bad in [-0.1, 1.5, f64::NAN] {
            let message = Bsdf::diffuse(Spectrum::constant(bad)).unwrap_err().to_string();
            assert!(message.contains("reflectance") && message.contains("from 0 to 1"), "{message}");
            assert!(Bsdf::mirror(Spectrum::constant(bad)).is_err());
            let index = RefractiveIndex::constant(1.5).unwrap();
            assert!(Bsdf::glossy(Spectrum::constant(bad), index, 0.1).is_err());
        }
        let spike = Spectrum::table(&[500.0, 500.5, 501.0], &[0.5, 1.2, 0.5], Outside::Hold).unwrap();
        assert!(Bsdf::diffuse(spike).unwrap_err().to_string().contains("a reflectance of 1.2"));
        assert!(Bsdf::conductor(Spectrum::constant(-1.0), Spectrum::constant(2.0), 0.0).is_err());
        assert!(Bsdf::conductor(Spectrum::constant(0.2), Spectrum::constant(3.0), 2.0).is_err());
    }

    #[test]
    fn a_simple_bsdf_is_its_own_only_component() {
        let bsdf = Bsdf::diffuse(Spectrum::constant(0.5)).unwrap();
        assert_eq!(bsdf.at(0.7).model, &bsdf);
        assert_eq!(bsdf.components().count(), 1);
    }
}
