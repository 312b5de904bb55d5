//! The constructors of all BSDFs.

use super::coated::{CoatedDielectric, ThinFilm};
use super::conductor::Conductor;
use super::crystal::CrystalInterface;
use super::dielectric::Dielectric;
use super::diffuse::Diffuse;
use super::filter::PolarisingFilter;
use super::glossy::Glossy;
use super::mirror::Mirror;
use super::thin::ThinDielectric;
use super::translucent::Translucent;
use super::{Bsdf, MixBsdf};
use crate::glass::RefractiveIndex;
use crate::texture::{ScalarTexture, SurfaceScalar, SurfaceSpectrum};
use crate::thin_film::FilmStack;
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::Spectrum;
use glam::DVec3;

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

    /// Creates the surface of a crystal with this optic axis, a unit vector in world space.
    pub fn crystal_surface(extraordinary: RefractiveIndex, axis: DVec3) -> Self {
        Self::Crystal(Box::new(CrystalInterface { extraordinary, axis }))
    }

    /// Creates a [`ThinDielectric`] BSDF; see [`ThinDielectric::new`].
    pub fn thin_dielectric(index: RefractiveIndex, optical_depth: Option<Spectrum>) -> Result<Self> {
        ThinDielectric::new(index, optical_depth).map(Self::ThinDielectric)
    }

    /// Creates a sheet with a polarising filter; see [`ThinDielectric::polarising`].
    pub fn polarising(filter: PolarisingFilter) -> Result<Self> {
        ThinDielectric::polarising(filter).map(Self::ThinDielectric)
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
}
