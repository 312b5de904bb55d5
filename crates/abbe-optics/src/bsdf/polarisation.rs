//! What a surface does to the two polarisations of light.

use glam::DVec3;

use super::Bsdf;
use super::filter::PolarisingFilter;
use super::local::LocalBsdf;
use super::sample::{InterfaceIors, ScatterEvent, TransportMode};
use crate::thin_film::{FilmStack, StackResponse};

/// The response of a smooth surface or of one microfacet to s and p polarised light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FacetResponses<'a> {
    /// The surface depolarises light.
    Depolarising,
    /// An ideal mirror: it reflects s and p alike, with a phase difference of π.
    Mirror,
    /// Both polarisations pass alike.
    Straight,
    /// An interface between these indices; the first is that of the light.
    Interface([f64; 2]),
    /// A metal, or an interface under films.
    Films(StackResponse),
    /// A plate of the second index in a medium of the first, with the transmittance of a passage.
    Plate {
        /// Of the medium and of the plate.
        indices: [f64; 2],
        /// The internal transmittance of one passage.
        passage: f64,
    },
    /// A plate with films on both faces.
    CoatedPlate {
        /// A face, for light from outside.
        front: StackResponse,
        /// A face, for light from inside.
        inside: StackResponse,
        /// The internal transmittance of one passage.
        passage: f64,
    },
    /// A filter.
    Filter(&'a PolarisingFilter),
}

impl<'a> LocalBsdf<'a> {
    /// Returns the responses for light that arrives in or leaves towards `wo`, by a facet of which
    /// `wo` has the cosine `cos`, at the wavelength `nm`.
    pub fn facet_responses(
        self,
        wo: DVec3,
        cos: f64,
        event: ScatterEvent,
        iors: InterfaceIors<'_>,
        nm: f64,
    ) -> FacetResponses<'a> {
        let (here, there) = (iors.here.n(nm), iors.there.n(nm));
        let (thickness_nm, outside) = (f64::from(self.texels.thickness_nm), wo.z >= 0.0);
        let films = |films: &FilmStack, substrate: f64| {
            FacetResponses::Films(if outside {
                films.response(cos, here, substrate.into(), nm, thickness_nm)
            } else {
                films.response_reversed(cos, here, substrate.into(), nm, thickness_nm)
            })
        };
        match self.model {
            Bsdf::Absorber | Bsdf::Diffuse(_) | Bsdf::Fluorescent(_) | Bsdf::Translucent(_) | Bsdf::Mix(_) => {
                FacetResponses::Depolarising
            }
            Bsdf::Mirror(_) => FacetResponses::Mirror,
            Bsdf::Grating(_) if event == ScatterEvent::Reflection => FacetResponses::Mirror,
            Bsdf::Grating(_) => FacetResponses::Straight,
            Bsdf::Conductor(metal) => {
                let response = metal.response(cos, here, thickness_nm, nm);
                response.map_or(FacetResponses::Mirror, FacetResponses::Films)
            }
            Bsdf::Dielectric(_) | Bsdf::Crystal(_) => FacetResponses::Interface([here, there]),
            Bsdf::Glossy(glossy) => FacetResponses::Interface([1.0, glossy.coat_index(nm)]),
            Bsdf::CoatedDielectric(coated) => films(&coated.films, there),
            Bsdf::ThinFilm(film) => films(&film.films, here),
            Bsdf::ThinDielectric(pane) => pane.responses(cos, here, thickness_nm, nm),
        }
    }

    /// Returns the part of [`Self::eval`] that one microfacet scatters, from 0 to 1: the rest of the
    /// light is scattered several times, or by the base below a coat. It is 1 for smooth surfaces,
    /// and 0 for surfaces without microfacets.
    pub fn facet_fraction(self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        let single = match self.model {
            Bsdf::Conductor(metal) if metal.is_rough() => metal.eval_facet(wo, wi, iors, self.texels, nm),
            Bsdf::Dielectric(dielectric) if dielectric.is_rough() => dielectric.eval_facet(wo, wi, iors, mode, nm),
            Bsdf::CoatedDielectric(coated) if coated.is_rough() => {
                coated.eval_facet(wo, wi, iors, self.texels.thickness_nm, mode, nm)
            }
            Bsdf::Glossy(glossy) => glossy.eval_coat(wo, wi, nm),
            Bsdf::Conductor(_) | Bsdf::Dielectric(_) | Bsdf::CoatedDielectric(_) | Bsdf::ThinDielectric(_) => {
                return 1.0;
            }
            Bsdf::Absorber | Bsdf::Diffuse(_) | Bsdf::Fluorescent(_) | Bsdf::Translucent(_) => return 1.0,
            Bsdf::Mirror(_) | Bsdf::ThinFilm(_) | Bsdf::Grating(_) | Bsdf::Mix(_) | Bsdf::Crystal(_) => return 1.0,
        };
        let all = self.eval(wo, wi, iors, mode, nm);
        if all > 0.0 { (single / all).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Returns the cosine of `wo` to the facet that connects two directions: the surface itself if
    /// it is smooth.
    pub fn facet_cosine(self, wo: DVec3, wi: DVec3, event: ScatterEvent, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        if self.model.alpha().is_none() && !matches!(self.model, Bsdf::Glossy(_)) {
            return wo.z.abs();
        }
        let along = match event {
            ScatterEvent::Reflection => wo + wi,
            ScatterEvent::Transmission => wo * iors.here.n(nm) + wi * iors.there.n(nm),
        };
        wo.dot(along.normalize_or_zero()).abs().min(1.0)
    }
}
