//! Dielectrics under thin films, and free-standing films.

use glam::DVec3;

use super::check::check_alpha;
use super::compensation::FilmMean;
use super::dielectric::Dielectric;
use super::facet::FacetResponse;
use super::hemisphere::{flip_z, z_sign};
use super::power::PowerFractions;
use super::rough_interface::{FacetScattering, RoughInterface};
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent, TransportMode, radiance_scale};
use crate::fresnel;
use crate::glass::RefractiveIndex;
use crate::microfacet::MIN_ALPHA;
use crate::thin_film::FilmStack;
use abbe_spectra::error::Result;
use abbe_spectra::math::complex::Complex;
use abbe_spectra::spectrum::BAND_NM;

/// An interface between two dielectrics under thin films.
///
/// The films interfere coherently, the first being on the outside of the body, and light is
/// refracted as at the bare interface between the indices of [`InterfaceIors`]. If the interface is
/// rough, each microfacet has the films; see [`Dielectric`].
#[derive(Debug, Clone, PartialEq)]
pub struct CoatedDielectric {
    pub(super) films: FilmStack,
    /// `None` if the interface is smooth.
    facets: Option<CoatedFacets>,
}

#[derive(Debug, Clone, PartialEq)]
struct CoatedFacets {
    interface: RoughInterface,
    index: RefractiveIndex,
    /// The mean properties of the facets of the body in air at the whole nanometres of the band, or
    /// none if a thickness varies over the surface.
    in_air: Box<[FilmMean]>,
}

impl CoatedDielectric {
    /// Creates an interface of GGX roughness `alpha`, smooth below [`MIN_ALPHA`], under films that
    /// are listed from the outside of the body of this `index`. Returns an error for an `alpha`
    /// outside \[0, 1\].
    pub fn new(films: FilmStack, index: &RefractiveIndex, alpha: f64) -> Result<Self> {
        check_alpha(alpha)?;
        let mut coated = Self { films, facets: None };
        if alpha >= MIN_ALPHA {
            let interface = RoughInterface::new(alpha);
            let whole_nm = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from);
            let in_air = |nm: f64| coated.film_mean(&interface, true, [1.0, index.n(nm)], 0.0, nm);
            let in_air = if coated.films.is_textured() { Box::default() } else { whole_nm.map(in_air).collect() };
            coated.facets = Some(CoatedFacets { interface, index: index.clone(), in_air });
        }
        Ok(coated)
    }

    /// Returns true if the interface is rough, so that its lobes have a finite width.
    pub fn is_rough(&self) -> bool {
        self.facets.is_some()
    }

    /// Returns the roughness α, or `None` if the surface is smooth.
    pub(super) fn alpha(&self) -> Option<f64> {
        self.facets.as_ref().map(|facets| facets.interface.ggx.alpha())
    }

    pub(super) fn without_films(self) -> Dielectric {
        Dielectric { facets: self.facets.map(|facets| facets.interface) }
    }

    pub(super) fn without_textures(self) -> Self {
        Self { films: self.films.without_textures(), ..self }
    }

    /// Returns R and T of the smooth interface at `nm`, with this thickness of the varying film.
    pub fn powers(&self, wo: DVec3, iors: InterfaceIors<'_>, thickness_nm: f32, nm: f64) -> PowerFractions {
        let indices = [iors.here.n(nm), iors.there.n(nm)];
        powers_of(&self.films, wo.z >= 0.0, wo.z, indices, thickness_nm, nm)
    }

    pub(super) fn sample(
        &self,
        wo: DVec3,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        nm: f64,
        u: [f64; 3],
    ) -> Option<BsdfSample> {
        let sign = z_sign(wo);
        let up = flip_z(wo, sign);
        if let Some(facets) = self.facets_at(wo, iors, thickness_nm, nm) {
            let m = facets.ggx.sample_visible(up, u[0], u[1]);
            let (cos_microfacet, shadowed) = (up.dot(m), facets.shadowed(up, m));
            return Some(BsdfSample { cos_microfacet, shadowed, ..facets.sample(wo, iors, u)? });
        }
        let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
        let Some(refracted) = fresnel::refract(up, DVec3::Z, iors.here.n(nm), iors.there.n(nm)) else {
            return Some(BsdfSample::delta(mirrored, ScatterEvent::Reflection, 1.0));
        };
        let probability = self.powers(wo, iors, thickness_nm, nm).reflection_probability();
        if u[2] < probability {
            return Some(BsdfSample::delta(mirrored, ScatterEvent::Reflection, probability));
        }
        let sample = BsdfSample::delta(flip_z(refracted, sign), ScatterEvent::Transmission, 1.0 - probability);
        let disperses = iors.is_dispersive();
        Some(BsdfSample { disperses, ..sample })
    }

    pub(super) fn eval(
        &self,
        wo: DVec3,
        wi: DVec3,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        let facets = self.facets_at(wo, iors, thickness_nm, nm);
        facets.map_or(0.0, |facets| facets.eval(wo, wi, iors, mode, nm))
    }

    /// Evaluates the light that hits one facet of a rough interface.
    pub(super) fn eval_facet(
        &self,
        wo: DVec3,
        wi: DVec3,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        let facets = self.facets_at(wo, iors, thickness_nm, nm);
        facets.map_or(0.0, |facets| facets.eval_facet(wo, wi, iors, mode, nm))
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, thickness_nm: f32, nm: f64) -> f64 {
        self.facets_at(wo, iors, thickness_nm, nm).map_or(0.0, |facets| facets.pdf(wo, wi))
    }

    pub(super) fn coefficient(
        &self,
        wo: DVec3,
        event: ScatterEvent,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        mode: TransportMode,
        nm: f64,
    ) -> f64 {
        let fraction = self.powers(wo, iors, thickness_nm, nm).of_event(event);
        match event {
            ScatterEvent::Reflection => fraction,
            ScatterEvent::Transmission => fraction * radiance_scale(iors, mode, nm),
        }
    }

    pub(super) fn absorbed_fraction(
        &self,
        wo: DVec3,
        sample: &BsdfSample,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        nm: f64,
    ) -> f64 {
        let Some(facets) = self.facets_at(wo, iors, thickness_nm, nm) else {
            return self.powers(wo, iors, thickness_nm, nm).absorbed();
        };
        if !self.films.absorbs() {
            return 0.0;
        }
        let powers = facets.facet.powers(sample.cos_microfacet);
        let [reflected, refracted] = sample.shadowed;
        let shadowed = (powers.reflected * reflected + powers.transmitted * refracted)
            / (powers.reflected + powers.transmitted).max(f64::MIN_POSITIVE);
        powers.absorbed() * (1.0 - shadowed) + shadowed * (1.0 - facets.multiple.kept())
    }

    /// Returns the facets at one wavelength, or `None` if the interface is smooth.
    fn facets_at<'a>(
        &'a self,
        wo: DVec3,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        nm: f64,
    ) -> Option<FacetScattering<'a, CoatedFacet<'a>>> {
        let CoatedFacets { interface, index, in_air } = self.facets.as_ref()?;
        let outside = wo.z >= 0.0;
        let indices = [iors.here.n(nm), iors.there.n(nm)];
        let [front, behind] = if outside { indices } else { [indices[1], indices[0]] };
        let place = nm - BAND_NM.0;
        let neighbours = in_air.get(place as usize).zip(in_air.get(place as usize + 1));
        let mean = match neighbours.filter(|_| place >= 0.0 && front == 1.0 && behind == index.n(nm)) {
            Some((low, high)) => low.mixed(high, place.fract()),
            None => self.film_mean(interface, outside, indices, thickness_nm, nm),
        };
        let distinct = distinct(indices, outside);
        Some(FacetScattering {
            ggx: &interface.ggx,
            facet: CoatedFacet { films: &self.films, outside, indices, thickness_nm, nm },
            multiple: interface.compensation.between_films(distinct, &mean),
            indices: distinct,
        })
    }

    /// Computes the mean properties of the facets at one wavelength, by indices from the light on.
    fn film_mean(
        &self,
        interface: &RoughInterface,
        outside: bool,
        indices: [f64; 2],
        thickness_nm: f32,
        nm: f64,
    ) -> FilmMean {
        let facet =
            |outside: bool, indices: [f64; 2]| CoatedFacet { films: &self.films, outside, indices, thickness_nm, nm };
        let (facet, other) = (facet(outside, indices), facet(!outside, [indices[1], indices[0]]));
        interface.compensation.film_mean(distinct(indices, outside), [&facet, &other], self.films.absorbs())
    }
}

/// Returns two different indices, because the lobe of refraction between equal indices has no
/// width. The direction changes by at most 10⁻⁵ rad.
fn distinct([here, there]: [f64; 2], outside: bool) -> [f64; 2] {
    const LEAST_RATIO: f64 = 1.0 + 1e-5;
    match (here == there, outside) {
        (false, _) => [here, there],
        (true, true) => [here, there * LEAST_RATIO],
        (true, false) => [here * LEAST_RATIO, there],
    }
}

/// A facet under films, at one wavelength and for light from one side.
struct CoatedFacet<'a> {
    films: &'a FilmStack,
    /// True for light that meets the first film first.
    outside: bool,
    /// Of the medium of the light and of the other medium.
    indices: [f64; 2],
    thickness_nm: f32,
    nm: f64,
}

impl FacetResponse for CoatedFacet<'_> {
    fn powers(&self, cos: f64) -> PowerFractions {
        let Self { films, outside, indices, thickness_nm, nm } = *self;
        powers_of(films, outside, cos, indices, thickness_nm, nm)
    }

    /// Beyond the critical angle, the probability is 1.
    fn reflection_probability(&self, powers: PowerFractions) -> f64 {
        if powers.transmitted == 0.0 { 1.0 } else { powers.reflection_probability() }
    }
}

/// A free-standing film, such as a soap bubble, which light crosses straight on.
#[derive(Debug, Clone, PartialEq)]
pub struct ThinFilm {
    pub(super) films: FilmStack,
}

impl ThinFilm {
    /// Creates a film from its layers, listed from the outside of the surface.
    pub fn new(films: FilmStack) -> Self {
        Self { films }
    }

    /// Returns R and T at the wavelength `nm`; see [`CoatedDielectric::powers`].
    pub fn powers(&self, wo: DVec3, iors: InterfaceIors<'_>, thickness_nm: f32, nm: f64) -> PowerFractions {
        powers_of(&self.films, wo.z >= 0.0, wo.z, [iors.here.n(nm); 2], thickness_nm, nm)
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

/// Returns the powers of a stack, for light that meets the first film first if `outside`. The
/// indices are those of the medium of the light and of the other one. If the stack is clear, R + T
/// is exactly 1.
fn powers_of(
    films: &FilmStack,
    outside: bool,
    cos: f64,
    indices: [f64; 2],
    thickness_nm: f32,
    nm: f64,
) -> PowerFractions {
    let thickness = f64::from(thickness_nm);
    if let Some(reflected) = films.clear_reflectance(outside, cos, indices, nm, thickness) {
        return PowerFractions { reflected, transmitted: 1.0 - reflected };
    }
    let (here, there) = (indices[0], Complex::from(indices[1]));
    let response = if outside {
        films.response(cos, here, there, nm, thickness)
    } else {
        films.response_reversed(cos, here, there, nm, thickness)
    };
    let (reflected, transmitted) = (response.reflectance(), response.transmittance());
    if films.absorbs() {
        return PowerFractions { reflected, transmitted: transmitted.min(1.0 - reflected) };
    }
    // Under total reflection, the transmittance is exactly 0.
    let reflected = if transmitted == 0.0 { 1.0 } else { reflected };
    PowerFractions { reflected, transmitted: 1.0 - reflected }
}

/// Returns the probability of reflection for a path of the wavelength `nm`, or of the whole band
/// (`None`): then 1 under total reflection, and else from 0.1 to 0.9.
pub(super) fn reflection_probability(nm: Option<f64>, powers: impl Fn(f64) -> PowerFractions) -> f64 {
    /// Wavelengths (nm) at the ends of the band, with extreme critical angles, and in between.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::SurfaceScalar;
    use crate::thin_film::{FilmLayer, OpticalIndex};
    use abbe_spectra::spectrum::Spectrum;

    fn layer(n: f64, thickness_nm: f64) -> FilmLayer {
        let index = OpticalIndex::Transparent(RefractiveIndex::constant(n).unwrap());
        FilmLayer { index, thickness_nm: SurfaceScalar::Uniform(thickness_nm) }
    }

    /// A quarter-wave layer of index √n makes glass black at its wavelength, from both sides.
    #[test]
    fn an_ideal_quarter_wave_layer_reflects_nothing() {
        let n = 1.5_f64;
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(n).unwrap());
        let films = FilmStack::new(vec![layer(n.sqrt(), 550.0 / (4.0 * n.sqrt()))]).unwrap();
        let coated = CoatedDielectric::new(films, &glass, 0.0).unwrap();
        let from_air = InterfaceIors { here: &air, there: &glass };
        let from_glass = InterfaceIors { here: &glass, there: &air };
        assert!(coated.powers(DVec3::Z, from_air, 0.0, 550.0).reflected < 1e-15);
        assert!(coated.powers(-DVec3::Z, from_glass, 0.0, 550.0).reflected < 1e-15);
        assert!(coated.powers(DVec3::Z, from_air, 0.0, 400.0).reflected > 0.005);
    }

    #[test]
    fn no_films_are_a_bare_interface() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(1.5).unwrap());
        let coated = CoatedDielectric::new(FilmStack::new(Vec::new()).unwrap(), &glass, 0.0).unwrap();
        for i in 1..100 {
            let cos = f64::from(i) / 100.0;
            let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
            let iors = InterfaceIors { here: &glass, there: &air };
            let (found, known) = (coated.powers(wo, iors, 0.0, 500.0), fresnel::dielectric(cos, 1.5, 1.0));
            assert!((found.reflected - known).abs() < 1e-12 && found.absorbed() < 1e-15);
            let sample = coated.sample(wo, iors, 0.0, 500.0, [0.5, 0.5, 0.999]).unwrap();
            assert_eq!(sample.event == ScatterEvent::Reflection, known == 1.0, "{cos}");
        }
    }

    /// The reflected and transmitted power of a coated rough interface, by even samples.
    fn scattered(coated: &CoatedDielectric, wo: DVec3, iors: InterfaceIors<'_>, nm: f64) -> [f64; 2] {
        const SAMPLES: u32 = 1 << 16;
        let spread = [0.819_172_513_396, 0.671_043_606_703, 0.549_700_477_901];
        let mut sums = [0.0; 2];
        for i in 0..SAMPLES {
            let u = spread.map(|step: f64| (0.5 + f64::from(i) * step).fract());
            let Some(sample) = coated.sample(wo, iors, 0.0, nm, u).filter(|sample| sample.on_event_side(wo)) else {
                continue;
            };
            let weight = coated.eval(wo, sample.wi, iors, 0.0, TransportMode::Importance, nm) * sample.wi.z.abs();
            sums[usize::from(sample.event == ScatterEvent::Transmission)] +=
                weight / sample.probability / f64::from(SAMPLES);
        }
        sums
    }

    fn direction(cos: f64) -> DVec3 {
        DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos)
    }

    /// The table of a body in air agrees with the values at wavelengths between its nodes.
    #[test]
    fn tabulated_means_are_those_of_the_wavelength() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::catalogue("N-SF10").unwrap());
        let films = FilmStack::new(vec![layer(2.35, 400.0)]).unwrap();
        let coated = CoatedDielectric::new(films, &glass, 0.3).unwrap();
        let mut direct = coated.clone();
        direct.facets.as_mut().unwrap().in_air = Box::default();
        for nm in [360.0, 412.6, 829.5, 830.0] {
            for (here, there, sign) in [(&air, &glass, 1.0), (&glass, &air, -1.0)] {
                let iors = InterfaceIors { here, there };
                let (wo, wi) = (DVec3::new(0.6, 0.0, 0.8 * sign), DVec3::new(0.0, 0.6, 0.8 * sign));
                let value = |coated: &CoatedDielectric| coated.eval(wo, wi, iors, 0.0, TransportMode::Radiance, nm);
                let (found, known) = (value(&coated), value(&direct));
                assert!((found / known - 1.0).abs() < 1e-4, "{nm} nm: {found} for {known}");
            }
        }
    }

    #[test]
    fn slightly_rough_films_are_like_polished_ones() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(1.52).unwrap());
        let silver = OpticalIndex::absorbing(Spectrum::constant(0.2), Spectrum::constant(3.4)).unwrap();
        let silver = FilmLayer { index: silver, thickness_nm: SurfaceScalar::Uniform(20.0) };
        for films in [vec![layer(2.35, 60.0), layer(1.46, 95.0)], vec![layer(1.46, 95.0), silver]] {
            let films = FilmStack::new(films).unwrap();
            let coated = |alpha| CoatedDielectric::new(films.clone(), &glass, alpha).unwrap();
            for (here, there, sign) in [(&air, &glass, 1.0), (&glass, &air, -1.0)] {
                for cos in [0.85, 1.0] {
                    let (wo, iors) = (flip_z(direction(cos), sign), InterfaceIors { here, there });
                    let PowerFractions { reflected, transmitted } = coated(0.0).powers(wo, iors, 0.0, 550.0);
                    let [rough_reflected, rough_transmitted] = scattered(&coated(0.02), wo, iors, 550.0);
                    let case = format!("cosine {cos}, side {sign}: {rough_reflected} for {reflected}");
                    assert!((rough_reflected - reflected).abs() < 4e-3, "{case}");
                    let case = format!("cosine {cos}, side {sign}: {rough_transmitted} for {transmitted}");
                    assert!((rough_transmitted - transmitted).abs() < 4e-3, "{case}");
                }
            }
        }
    }

    #[test]
    fn films_between_equal_media_reflect_and_do_not_refract() {
        let water = RefractiveIndex::constant(1.33).unwrap();
        let films = FilmStack::new(vec![layer(2.35, 60.0)]).unwrap();
        let coated = CoatedDielectric::new(films, &water, 0.04).unwrap();
        let (iors, wo) = (InterfaceIors { here: &water, there: &water }, DVec3::new(0.28, 0.0, 0.96));
        for i in 0..1000 {
            let u = [0.754, 0.569, 0.43].map(|step: f64| (f64::from(i) * step).fract());
            let sample = coated.sample(wo, iors, 0.0, 550.0, u).unwrap();
            let multiple = sample.wi.z.abs() < 0.8;
            assert!(multiple || sample.event == ScatterEvent::Reflection || (sample.wi + wo).length() < 1e-3);
        }
        let [reflected, transmitted] = scattered(&coated, wo, iors, 550.0);
        let polished = CoatedDielectric { facets: None, ..coated }.powers(wo, iors, 0.0, 550.0);
        assert!((reflected - polished.reflected).abs() < 5e-3, "{reflected} for {polished:?}");
        assert!((reflected + transmitted - 1.0).abs() < 2e-3, "{transmitted}");
    }

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
