//! A BSDF at one point of a surface.

use glam::DVec3;

use super::sample::{BsdfClass, BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
use super::texels::Texels;
use super::{Bsdf, Dielectric, MixBsdf};
use super::{coated, dielectric, diffuse};
use crate::texture::{LookupRandom, SurfaceSpectrum, TexturePoint};
use abbe_spectra::spectrum::{LANES, Lanes, REFERENCE_NM};

/// A BSDF at one point of a surface, with a selected component of a mixture and texels. The methods
/// still treat a mixture without textures as a whole.
#[derive(Debug, Clone, Copy)]
pub struct LocalBsdf<'a> {
    /// The BSDF of the material, or the selected component of a mixture.
    pub model: &'a Bsdf,
    /// The selected texels.
    pub texels: Texels,
}

const SMOOTH: Dielectric = Dielectric { facets: None };
static PLAIN_INTERFACE: Bsdf = Bsdf::Dielectric(SMOOTH);

impl LocalBsdf<'_> {
    /// A smooth interface without films. Between equal indices, light passes straight on.
    pub const PLAIN_INTERFACE: Self = Self { model: &PLAIN_INTERFACE, texels: Texels::NONE };
}

impl Bsdf {
    /// Returns the BSDF at any point of a surface without textures. The random number `u` in \[0,
    /// 1) selects the component of a mixture by its normalised weight.
    #[inline(always)]
    pub fn at(&self, u: f64) -> LocalBsdf<'_> {
        LocalBsdf {
            model: if let Bsdf::Mix(mix) = self { mix.sample_component(u) } else { self },
            texels: Texels::NONE,
        }
    }

    /// Returns the BSDF at a point of a surface with textures. The random number `u` in \[0, 1)
    /// selects the component of a mixture and the texels.
    pub fn at_point(&self, point: &TexturePoint, u: f64) -> LocalBsdf<'_> {
        let mut random = LookupRandom::new(u);
        let model = if let Bsdf::Mix(mix) = self { mix.component_at(point, &mut random) } else { self };
        if let Some(films) = model.films()
            && films.is_textured()
        {
            return LocalBsdf { model, texels: Texels::of_thickness(films.thickness_at(point, &mut random)) };
        }
        if let Bsdf::ThinDielectric(pane) = model
            && let Some(filter) = pane.filter()
        {
            return LocalBsdf { model, texels: Texels::of_retarder(filter.retardance_at(point, &mut random)) };
        }
        let mut texel = |spectrum: &SurfaceSpectrum| spectrum.texel(point, &mut random);
        let texels = match model {
            Bsdf::Diffuse(diffuse) => Texels::of_reflectance(texel(&diffuse.reflectance)),
            Bsdf::Translucent(sheet) => Texels {
                reflectance: texel(&sheet.reflectance),
                transmittance: texel(&sheet.transmittance),
                ..Texels::NONE
            },
            Bsdf::Mirror(mirror) => Texels::of_reflectance(texel(&mirror.reflectance)),
            Bsdf::Conductor(metal) => Texels::of_reflectance(metal.reflectance().map_or(0, &mut texel)),
            Bsdf::Glossy(glossy) => Texels::of_reflectance(texel(&glossy.reflectance)),
            Bsdf::Absorber | Bsdf::Fluorescent(_) | Bsdf::Dielectric(_) | Bsdf::CoatedDielectric(_) => Texels::NONE,
            Bsdf::ThinDielectric(_) | Bsdf::ThinFilm(_) | Bsdf::Grating(_) | Bsdf::Mix(_) => Texels::NONE,
            Bsdf::Crystal(_) => Texels::NONE,
        };
        LocalBsdf { model, texels }
    }
}

impl<'a> LocalBsdf<'a> {
    /// Returns the width class; see [`Bsdf::class`].
    #[inline(always)]
    pub fn class(self) -> BsdfClass {
        self.model.class()
    }

    /// Returns true if the BSDF transmits light.
    #[inline]
    pub fn is_transmissive(self) -> bool {
        self.model.is_transmissive()
    }

    fn component(self, mix: &'a MixBsdf, number: usize) -> Self {
        Self { model: &mix.components()[number], ..self }
    }

    /// Samples a direction at the hero wavelength `nm`, by a distribution that does not depend on
    /// the [`TransportMode`]. Returns `None` if the event absorbs the light of all wavelengths, as
    /// when a facet of a rough metal reflects the path below the surface.
    ///
    /// Of `u` in \[0, 1), `u[0]` and `u[1]` choose the direction, and `u[2]` between reflection and
    /// transmission or lobes, after a component of a mixture without textures. The probability in
    /// the sample is then that of the component alone, without its weight.
    #[inline]
    pub fn sample(self, wo: DVec3, iors: InterfaceIors<'_>, nm: f64, u: [f64; 3]) -> Option<BsdfSample> {
        let reflectance = self.texels.reflectance;
        match self.model {
            Bsdf::Absorber => None,
            Bsdf::Diffuse(diffuse) => Some(diffuse.sample(wo, u)),
            Bsdf::Fluorescent(surface) => Some(surface.sample(wo, u)),
            Bsdf::Translucent(translucent) => translucent.sample(wo, self.texels, nm, u),
            Bsdf::Mirror(mirror) => Some(mirror.sample(wo)),
            Bsdf::Conductor(conductor) => Some(conductor.sample(wo, u)),
            Bsdf::Dielectric(dielectric) => dielectric.sample(wo, iors, nm, u),
            Bsdf::Crystal(_) => SMOOTH.sample(wo, iors, nm, u),
            Bsdf::CoatedDielectric(coated) => coated.sample(wo, iors, self.texels.thickness_nm, nm, u),
            Bsdf::ThinDielectric(thin) => Some(thin.sample(wo, iors, self.texels.thickness_nm, nm, u)),
            Bsdf::ThinFilm(film) => Some(film.sample(wo, iors, self.texels.thickness_nm, nm, u)),
            Bsdf::Grating(grating) => grating.sample(wo, iors, self.texels.axis_angle, nm, u),
            Bsdf::Glossy(glossy) => Some(glossy.sample(wo, reflectance, nm, u)),
            Bsdf::Mix(mix) => {
                let mut choice = u[2];
                let component = mix.sample_index(&mut choice);
                let sample = self.component(mix, component).sample(wo, iors, nm, [u[0], u[1], choice])?;
                Some(BsdfSample { component, ..sample })
            }
        }
    }

    /// Evaluates a sample at the wavelength `nm`: divided by `sample.probability`, the weight of
    /// the path. For a delta sample, it is the reflectance, or the transmittance with the n² factor
    /// of [`TransportMode::Radiance`], without the probability of the event, and otherwise
    /// f·|cosθ_i| in 1/sr.
    pub fn eval_sample(
        self,
        wo: DVec3,
        sample: &BsdfSample,
        iors: InterfaceIors<'_>,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        if let Bsdf::Mix(mix) = self.model {
            return self.component(mix, sample.component).eval_sample(wo, sample, iors, mode, nm);
        }
        if let Bsdf::Grating(grating) = self.model {
            return grating.coefficient(wo, sample, iors, self.texels.axis_angle, mode, nm);
        }
        if sample.delta {
            return self.coefficient(wo, sample.event, iors, mode, nm);
        }
        if !sample.on_event_side(wo) {
            return 0.0;
        }
        self.eval(wo, sample.wi, iors, mode, nm) * sample.wi.z.abs()
    }

    /// Returns the fraction of the arriving power, in \[0, 1\], that this event absorbs at `nm`. It
    /// is computed from albedos and losses, not as 1 minus the weight. For
    /// [`TransportMode::Importance`] and a sample at `nm`, the expected weight and the expected
    /// absorbed fraction sum to 1. If [`LocalBsdf::sample`] returns `None`, all power is absorbed.
    pub fn absorbed_fraction(self, wo: DVec3, sample: &BsdfSample, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let reflectance = self.texels.reflectance;
        match self.model {
            Bsdf::Absorber => 1.0,
            Bsdf::Diffuse(diffuse) => diffuse.absorbed_fraction(reflectance, nm),
            Bsdf::Fluorescent(surface) => 1.0 - surface.reflected_fraction(nm),
            Bsdf::Translucent(translucent) => translucent.absorbed_fraction(self.texels, nm),
            Bsdf::Mirror(mirror) => mirror.absorbed_fraction(reflectance, nm),
            Bsdf::Conductor(conductor) => conductor.absorbed_fraction(wo, sample, iors, self.texels, nm),
            Bsdf::Dielectric(_) | Bsdf::Crystal(_) => 0.0,
            Bsdf::CoatedDielectric(coated) => coated.absorbed_fraction(wo, sample, iors, self.texels.thickness_nm, nm),
            Bsdf::ThinDielectric(thin) => thin.absorbed_fraction(wo, iors, self.texels.thickness_nm, nm),
            Bsdf::ThinFilm(film) => film.powers(wo, iors, self.texels.thickness_nm, nm).absorbed(),
            Bsdf::Grating(grating) => grating.absorbed_fraction(wo, iors, self.texels.axis_angle, nm),
            Bsdf::Glossy(glossy) => glossy.absorbed_fraction(wo, reflectance, nm),
            Bsdf::Mix(mix) => self.component(mix, sample.component).absorbed_fraction(wo, sample, iors, nm),
        }
    }

    /// Returns, for each of the wavelengths `nm`, the weight of a path after a sample
    /// ([`Self::eval_sample`] divided by the probability), and its [`Self::absorbed_fraction`].
    #[inline(always)]
    pub fn weights(
        self,
        wo: DVec3,
        sample: &BsdfSample,
        iors: InterfaceIors<'_>,
        mode: TransportMode,
        nm: &[f64],
    ) -> (Lanes, Lanes) {
        let (mut weight, mut absorbed) = ([0.0; LANES], [0.0; LANES]);
        if let Bsdf::Diffuse(diffuse) = self.model
            && sample.on_event_side(wo)
        {
            // Most events are of this kind, and one value of the reflectance gives both results.
            for (k, &nm) in nm.iter().enumerate() {
                let reflectance = diffuse.reflectance().at(self.texels.reflectance, nm);
                weight[k] = diffuse::eval(reflectance) * sample.wi.z.abs() / sample.probability;
                absorbed[k] = diffuse::absorbed_fraction(reflectance);
            }
        } else {
            for (k, &nm) in nm.iter().enumerate() {
                weight[k] = self.eval_sample(wo, sample, iors, mode, nm) / sample.probability;
                absorbed[k] = self.absorbed_fraction(wo, sample, iors, nm);
            }
        }
        (weight, absorbed)
    }

    /// Evaluates f(wo, wi) in 1/sr at the wavelength `nm`, without the cosine and delta
    /// distributions. A mixture has the weighted sum of its components.
    pub fn eval(self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        let reflectance = self.texels.reflectance;
        match self.model {
            Bsdf::Absorber | Bsdf::Mirror(_) | Bsdf::ThinDielectric(_) | Bsdf::ThinFilm(_) | Bsdf::Grating(_) => 0.0,
            Bsdf::Crystal(_) => 0.0,
            Bsdf::Diffuse(diffuse) => diffuse.eval(wo, wi, reflectance, nm),
            Bsdf::Fluorescent(surface) => surface.eval(wo, wi, nm),
            Bsdf::Translucent(translucent) => translucent.eval(wo, wi, self.texels, nm),
            Bsdf::Conductor(conductor) => conductor.eval(wo, wi, iors, self.texels, nm),
            Bsdf::Dielectric(dielectric) => dielectric.eval(wo, wi, iors, mode, nm),
            Bsdf::CoatedDielectric(coated) => coated.eval(wo, wi, iors, self.texels.thickness_nm, mode, nm),
            Bsdf::Glossy(glossy) => glossy.eval(wo, wi, reflectance, nm),
            Bsdf::Mix(mix) => mix
                .weighted_components()
                .map(|(weight, model)| weight * Self { model, ..self }.eval(wo, wi, iors, mode, nm))
                .sum(),
        }
    }

    /// Returns the pdf of [`LocalBsdf::sample`] for `wi` per solid angle if the hero wavelength is
    /// `nm`, without delta distributions. A mixture has the weighted sum of its components.
    pub fn pdf(self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, nm: f64) -> f64 {
        let reflectance = self.texels.reflectance;
        match self.model {
            Bsdf::Absorber | Bsdf::Mirror(_) | Bsdf::ThinDielectric(_) | Bsdf::ThinFilm(_) | Bsdf::Grating(_) => 0.0,
            Bsdf::Crystal(_) => 0.0,
            Bsdf::Diffuse(diffuse) => diffuse.pdf(wo, wi),
            Bsdf::Fluorescent(surface) => surface.pdf(wo, wi),
            Bsdf::Translucent(translucent) => translucent.pdf(wo, wi, self.texels, nm),
            Bsdf::Conductor(conductor) => conductor.pdf(wo, wi),
            Bsdf::Dielectric(dielectric) => dielectric.pdf(wo, wi, iors, nm),
            Bsdf::CoatedDielectric(coated) => coated.pdf(wo, wi, iors, self.texels.thickness_nm, nm),
            Bsdf::Glossy(glossy) => glossy.pdf(wo, wi, reflectance, nm),
            Bsdf::Mix(mix) => mix
                .weighted_components()
                .map(|(weight, model)| weight * Self { model, ..self }.pdf(wo, wi, iors, nm))
                .sum(),
        }
    }

    /// Returns the probability with which a smooth interface or a film should reflect a path of the
    /// wavelength `nm`, or of all wavelengths of the band if `None`: 1 only under total reflection
    /// of all of them. It is 0 for a surface that is no interface.
    pub fn reflection_probability(self, wo: DVec3, iors: InterfaceIors<'_>, nm: Option<f64>) -> f64 {
        let thickness_nm = self.texels.thickness_nm;
        match self.model {
            Bsdf::ThinFilm(film) => coated::reflection_probability(nm, |nm| film.powers(wo, iors, thickness_nm, nm)),
            Bsdf::CoatedDielectric(coated) => {
                coated::reflection_probability(nm, |nm| coated.powers(wo, iors, thickness_nm, nm))
            }
            Bsdf::Dielectric(_) | Bsdf::Crystal(_) => match nm {
                None if iors.is_dispersive() => {
                    coated::reflection_probability(nm, |nm| dielectric::powers(wo, iors, nm))
                }
                _ => dielectric::powers(wo, iors, nm.unwrap_or(REFERENCE_NM)).reflected,
            },
            Bsdf::Absorber | Bsdf::Diffuse(_) | Bsdf::Fluorescent(_) | Bsdf::Translucent(_) | Bsdf::Mirror(_) => 0.0,
            Bsdf::Conductor(_) | Bsdf::ThinDielectric(_) | Bsdf::Grating(_) | Bsdf::Glossy(_) | Bsdf::Mix(_) => 0.0,
        }
    }

    /// Returns the coefficient of the delta distribution at `nm`, or 0 if the BSDF has none.
    fn coefficient(self, wo: DVec3, event: ScatterEvent, iors: InterfaceIors<'_>, mode: TransportMode, nm: f64) -> f64 {
        let reflectance = self.texels.reflectance;
        match self.model {
            Bsdf::Mirror(mirror) => mirror.coefficient(reflectance, nm),
            Bsdf::Conductor(conductor) => conductor.coefficient(wo, iors, self.texels, nm),
            Bsdf::Dielectric(_) | Bsdf::Crystal(_) => dielectric::coefficient(wo, event, iors, mode, nm),
            Bsdf::CoatedDielectric(coated) => coated.coefficient(wo, event, iors, self.texels.thickness_nm, mode, nm),
            Bsdf::ThinDielectric(thin) => thin.powers(wo, iors, self.texels.thickness_nm, nm).of_event(event),
            Bsdf::ThinFilm(film) => film.powers(wo, iors, self.texels.thickness_nm, nm).of_event(event),
            Bsdf::Absorber | Bsdf::Diffuse(_) | Bsdf::Fluorescent(_) | Bsdf::Translucent(_) => 0.0,
            Bsdf::Grating(_) | Bsdf::Glossy(_) | Bsdf::Mix(_) => 0.0,
        }
    }
}
