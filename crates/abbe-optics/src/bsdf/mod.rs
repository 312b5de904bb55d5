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
mod dielectric;
mod diffuse;
mod facet;
mod facet_quadrature;
mod film_moments;
mod fluorescent;
mod glossy;
mod grating;
mod hemisphere;
mod local;
mod mirror;
mod missing_energy;
mod model;
#[cfg(test)]
mod model_tests;
mod power;
mod rough_interface;
mod sample;
mod selection;
mod texels;
mod thin;
mod translucent;

pub use coated::{CoatedDielectric, ThinFilm};
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use fluorescent::Fluorescent;
pub use glossy::Glossy;
pub use grating::{DiffractionGrating, Grooves};
pub use local::LocalBsdf;
pub use mirror::Mirror;
pub use model::{Bsdf, MixBsdf};
pub use power::PowerFractions;
pub use sample::{BsdfClass, BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
pub use texels::Texels;
pub use thin::{CosinePolynomial, ThinDielectric};
pub use translucent::Translucent;
