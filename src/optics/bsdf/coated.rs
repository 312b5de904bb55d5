//! Polished dielectrics under thin films, and free-standing films.

use glam::DVec3;

use super::dielectric::radiance_scale;
use super::hemisphere::{flip_z, z_sign};
use super::power::PowerFractions;
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent, TransportMode};
use crate::math::complex::Complex;
use crate::optics::fresnel;
use crate::optics::thin_film::{FilmStack, StackResponse};
use crate::spectrum::BAND_NM;

/// A polished interface between two dielectrics under thin films.
///
/// The films interfere coherently, and light is refracted as at the bare interface. The first film
/// is on the outside of the body. [`InterfaceIors`] contains the two refractive indices.
#[derive(Debug, Clone, PartialEq)]
pub struct CoatedDielectric {
    pub(super) films: FilmStack,
}

impl CoatedDielectric {
    /// Creates an interface under these films. The list starts at the outside of the body.
    pub fn new(films: FilmStack) -> Self {
        Self { films }
    }

    /// Returns R and T at the wavelength `nm`. `thickness_nm` is the thickness of the film that
    /// varies over the surface.
    pub fn powers(&self, wo: DVec3, iors: InterfaceIors<'_>, thickness_nm: f32, nm: f64) -> PowerFractions {
        let (here, there) = (iors.here.n(nm), Complex::from(iors.there.n(nm)));
        powers_of(&oriented(&self.films, wo, here, there, thickness_nm, nm), self.films.absorbs())
    }

    pub(super) fn sample(
        &self,
        wo: DVec3,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        nm: f64,
        u: [f64; 3],
    ) -> BsdfSample {
        let sign = z_sign(wo);
        let up = flip_z(wo, sign);
        let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
        let Some(refracted) = fresnel::refract(up, DVec3::Z, iors.here.n(nm), iors.there.n(nm)) else {
            return BsdfSample::delta(mirrored, ScatterEvent::Reflection, 1.0);
        };
        let probability = self.powers(wo, iors, thickness_nm, nm).reflection_probability();
        if u[2] < probability {
            return BsdfSample::delta(mirrored, ScatterEvent::Reflection, probability);
        }
        let disperses = iors.here.is_dispersive() || iors.there.is_dispersive();
        let sample = BsdfSample::delta(flip_z(refracted, sign), ScatterEvent::Transmission, 1.0 - probability);
        BsdfSample { disperses, ..sample }
    }

    pub(super) fn coefficient(
        &self,
        wo: DVec3,
        event: ScatterEvent,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        (mode, nm): (TransportMode, f64),
    ) -> f64 {
        let fraction = self.powers(wo, iors, thickness_nm, nm).of_event(event);
        match event {
            ScatterEvent::Reflection => fraction,
            ScatterEvent::Transmission => fraction * radiance_scale(iors, mode, nm),
        }
    }
}

/// A free-standing film, such as a soap bubble: a surface without thickness, with the same medium
/// on both sides. Transmitted light continues straight on.
#[derive(Debug, Clone, PartialEq)]
pub struct ThinFilm {
    pub(super) films: FilmStack,
}

impl ThinFilm {
    /// Creates a film from its layers. The first layer is on the outside of the surface.
    pub fn new(films: FilmStack) -> Self {
        Self { films }
    }

    /// Returns R and T at the wavelength `nm`; see [`CoatedDielectric::powers`].
    pub fn powers(&self, wo: DVec3, iors: InterfaceIors<'_>, thickness_nm: f32, nm: f64) -> PowerFractions {
        let outside = iors.here.n(nm);
        let response = oriented(&self.films, wo, outside, outside.into(), thickness_nm, nm);
        powers_of(&response, self.films.absorbs())
    }

    pub(super) fn sample(
        &self,
        wo: DVec3,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        nm: f64,
        u: [f64; 3],
    ) -> BsdfSample {
        let probability = self.powers(wo, iors, thickness_nm, nm).reflection_probability();
        PowerFractions::sample_straight(wo, probability, u[2])
    }
}

/// Returns the powers of a stack. If the stack is clear, R + T is exactly 1.
fn powers_of(response: &StackResponse, absorbs: bool) -> PowerFractions {
    let (reflected, transmitted) = (response.reflectance(), response.transmittance());
    if absorbs {
        return PowerFractions { reflected, transmitted: transmitted.min(1.0 - reflected) };
    }
    // Under total reflection, the transmittance is exactly 0.
    let reflected = if transmitted == 0.0 { 1.0 } else { reflected };
    PowerFractions { reflected, transmitted: 1.0 - reflected }
}

/// Returns the probability with which a path of the wavelength `nm` is reflected. `None` stands for
/// a path that carries the whole band: the probability is then 1 under total reflection, and
/// otherwise from 0.1 to 0.9. `powers` returns R and T at a wavelength in nm.
pub(super) fn reflection_probability(nm: Option<f64>, powers: impl Fn(f64) -> PowerFractions) -> f64 {
    /// Wavelengths (nm) at the ends of the band, where the critical angles are extreme, and
    /// wavelengths over its visible part.
    const PROBES_NM: [f64; 6] = [BAND_NM.0, 440.0, 500.0, 560.0, 630.0, BAND_NM.1];
    if let Some(nm) = nm {
        let PowerFractions { reflected, transmitted } = powers(nm);
        return reflected / (reflected + transmitted).max(f64::MIN_POSITIVE);
    }
    let powers = PROBES_NM.map(powers);
    if powers.iter().all(|powers| powers.transmitted == 0.0) {
        return 1.0;
    }
    let sum = |of: fn(&PowerFractions) -> f64| powers.iter().map(of).sum::<f64>();
    let (reflected, transmitted) = (sum(|powers| powers.reflected), sum(|powers| powers.transmitted));
    PowerFractions { reflected, transmitted }.reflection_probability()
}

/// Returns the response of films to light that arrives from the side of `wo`. If `wo` points to the
/// outside of the surface, the light meets the first film first.
fn oriented(films: &FilmStack, wo: DVec3, here: f64, there: Complex, thickness_nm: f32, nm: f64) -> StackResponse {
    let thickness = f64::from(thickness_nm);
    if wo.z >= 0.0 {
        films.response(wo.z, here, there, nm, thickness)
    } else {
        films.response_reversed(wo.z, here, there, nm, thickness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::glass::RefractiveIndex;
    use crate::optics::thin_film::{FilmLayer, OpticalIndex};
    use crate::spectrum::Spectrum;
    use crate::texture::SurfaceScalar;

    fn layer(n: f64, thickness_nm: f64) -> FilmLayer {
        let index = OpticalIndex::Transparent(RefractiveIndex::constant(n).unwrap());
        FilmLayer { index, thickness_nm: SurfaceScalar::Uniform(thickness_nm) }
    }

    /// A quarter-wave layer of index √n makes the surface of glass black at its wavelength, from
    /// both sides.
    #[test]
    fn an_ideal_quarter_wave_layer_reflects_nothing() {
        let n = 1.5_f64;
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(n).unwrap());
        let films = FilmStack::new(vec![layer(n.sqrt(), 550.0 / (4.0 * n.sqrt()))]).unwrap();
        let coated = CoatedDielectric::new(films);
        let from_air = InterfaceIors { here: &air, there: &glass };
        let from_glass = InterfaceIors { here: &glass, there: &air };
        assert!(coated.powers(DVec3::Z, from_air, 0.0, 550.0).reflected < 1e-15);
        assert!(coated.powers(-DVec3::Z, from_glass, 0.0, 550.0).reflected < 1e-15);
        assert!(coated.powers(DVec3::Z, from_air, 0.0, 400.0).reflected > 0.005);
    }

    /// Without films, the interface is a bare one, also beyond the critical angle.
    #[test]
    fn no_films_are_a_bare_interface() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(1.5).unwrap());
        let coated = CoatedDielectric::new(FilmStack::new(Vec::new()).unwrap());
        for i in 1..100 {
            let cos = f64::from(i) / 100.0;
            let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
            let iors = InterfaceIors { here: &glass, there: &air };
            let (found, known) = (coated.powers(wo, iors, 0.0, 500.0), fresnel::dielectric(cos, 1.5, 1.0));
            assert!((found.reflected - known).abs() < 1e-12 && found.absorbed() < 1e-15);
            let sample = coated.sample(wo, iors, 0.0, 500.0, [0.5, 0.5, 0.999]);
            assert_eq!(sample.event == ScatterEvent::Reflection, known == 1.0, "{cos}");
        }
    }

    /// A silver film absorbs more if light meets it from the glass; the transmittance is the same.
    #[test]
    fn absorbing_films_depend_on_the_side() {
        let air = RefractiveIndex::constant(1.0).unwrap();
        let silver = OpticalIndex::absorbing(Spectrum::constant(0.2), Spectrum::constant(3.4)).unwrap();
        let silver = FilmLayer { index: silver, thickness_nm: SurfaceScalar::Uniform(30.0) };
        let film = ThinFilm::new(FilmStack::new(vec![layer(1.5, 120.0), silver]).unwrap());
        let (iors, wo) = (InterfaceIors { here: &air, there: &air }, DVec3::new(0.6, 0.0, 0.8));
        let (front, back) = (film.powers(wo, iors, 0.0, 550.0), film.powers(-wo, iors, 0.0, 550.0));
        assert!((front.transmitted - back.transmitted).abs() < 1e-12, "{front:?} {back:?}");
        assert!((front.reflected - back.reflected).abs() > 1e-3, "{front:?} {back:?}");
        assert!(front.absorbed() > 0.01 && back.absorbed() > 0.01);
    }
}
