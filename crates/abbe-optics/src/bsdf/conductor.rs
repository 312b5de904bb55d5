//! Metals with smooth and rough surfaces.

use glam::DVec3;

use super::check::{check_alpha, check_fraction, check_within};
use super::compensation::ConductorCompensation;
use super::hemisphere::{flip_z, same_side, z_sign};
use super::sample::{BsdfSample, InterfaceIors, ScatterEvent};
use super::texels::Texels;
use crate::fresnel;
use crate::glass::RefractiveIndex;
use crate::microfacet::{Ggx, MIN_ALPHA};
use crate::texture::SurfaceSpectrum;
use crate::thin_film::{self, FilmStack, StackResponse};
use abbe_spectra::error::Result;
use abbe_spectra::math::complex::Complex;
use abbe_spectra::math::quadrature::gauss4;
use abbe_spectra::spectrum::{BAND_NM, Spectrum};

/// A metal. The reflectance follows from the complex index n + ik by Fresnel's equations, or, if
/// only the reflectance F₀ at normal incidence is known, is F₀ + (1 − F₀)(1 − cos θ)⁵ (Schlick
/// 1994).
///
/// A smooth metal reflects light into the mirror direction. A rough metal uses the GGX model of
/// Walter et al. 2007 for light that hits one facet, and a wide lobe for light that hits several
/// (`compensation.rs`), of which it absorbs a part in each event. Both sides behave alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Conductor {
    fresnel: MetalFresnel,
    /// `None` if the surface is smooth.
    facets: Option<RoughMetal>,
}

#[derive(Debug, Clone, PartialEq)]
struct RoughMetal {
    ggx: Ggx,
    compensation: ConductorCompensation,
    /// In air at whole nanometres; empty if it varies over the surface or has a closed form.
    mean_in_air: Box<[f64]>,
}

impl RoughMetal {
    /// Returns the mean reflectance in air, if the table contains the wavelength.
    #[inline]
    fn mean_in_air(&self, nm: f64) -> Option<f64> {
        let place = nm - BAND_NM.0;
        let [low, high] = [0, 1].map(|next| self.mean_in_air.get(place as usize + next));
        let fraction = place - place.floor();
        (place >= 0.0).then_some(low? + fraction * (high? - low?))
    }
}

#[derive(Debug, Clone, PartialEq)]
enum MetalFresnel {
    /// The complex index n + ik.
    Index { n: Spectrum, k: Spectrum },
    /// At normal incidence.
    Reflectance(SurfaceSpectrum),
    /// Under thin films.
    Coated { n: Spectrum, k: Spectrum, films: FilmStack },
}

/// Returns the reflectance of a metal of reflectance `normal` at normal incidence.
fn schlick(normal: f64, cos: f64) -> f64 {
    let rest = 1.0 - cos.abs().min(1.0);
    normal + (1.0 - normal) * rest * (rest * rest) * (rest * rest)
}

impl Conductor {
    /// Creates a metal of index `n` + i`k` and GGX roughness `alpha`, smooth if it is below
    /// [`MIN_ALPHA`]. Returns an error if `n` or `k` is negative, or `alpha` lies outside \[0, 1\].
    pub fn new(n: Spectrum, k: Spectrum, alpha: f64) -> Result<Self> {
        check_within("refractive index", &n, f64::INFINITY)?;
        check_within("extinction coefficient", &k, f64::INFINITY)?;
        Self::with_fresnel(MetalFresnel::Index { n, k }, alpha)
    }

    /// Creates a metal of this reflectance at normal incidence in air and of GGX roughness `alpha`,
    /// smooth if it is below [`MIN_ALPHA`]. Returns an error if either lies outside \[0, 1\].
    pub fn of_reflectance(reflectance: impl Into<SurfaceSpectrum>, alpha: f64) -> Result<Self> {
        let reflectance = reflectance.into();
        check_fraction("reflectance", &reflectance)?;
        Self::with_fresnel(MetalFresnel::Reflectance(reflectance), alpha)
    }

    /// Creates a metal, see [`Self::new`], under thin films that are listed from the outside. Each
    /// microfacet of a rough metal has these films.
    pub fn coated(n: Spectrum, k: Spectrum, films: FilmStack, alpha: f64) -> Result<Self> {
        check_within("refractive index", &n, f64::INFINITY)?;
        check_within("extinction coefficient", &k, f64::INFINITY)?;
        Self::with_fresnel(MetalFresnel::Coated { n, k, films }, alpha)
    }

    fn with_fresnel(fresnel: MetalFresnel, alpha: f64) -> Result<Self> {
        check_alpha(alpha)?;
        let mut metal = Self { fresnel, facets: None };
        if alpha >= MIN_ALPHA {
            let (ggx, mean_in_air) = (Ggx::new(alpha), metal.means_in_air()?);
            metal.facets = Some(RoughMetal { ggx, compensation: ConductorCompensation::new(&ggx), mean_in_air });
        }
        Ok(metal)
    }

    fn means_in_air(&self) -> Result<Box<[f64]>> {
        if self.is_textured() || self.reflectance().is_some() {
            return Ok(Box::default());
        }
        let air = RefractiveIndex::constant(1.0)?;
        let iors = InterfaceIors { here: &air, there: &air };
        let whole_nm = BAND_NM.0 as u32..=BAND_NM.1 as u32;
        Ok(whole_nm.map(|nm| self.integrated_reflectance(iors, Texels::NONE, f64::from(nm))).collect())
    }

    /// Returns the reflectance at normal incidence, if it was given.
    pub(super) fn reflectance(&self) -> Option<&SurfaceSpectrum> {
        if let MetalFresnel::Reflectance(reflectance) = &self.fresnel { Some(reflectance) } else { None }
    }

    pub(super) fn films(&self) -> Option<&FilmStack> {
        if let MetalFresnel::Coated { films, .. } = &self.fresnel { Some(films) } else { None }
    }

    pub(super) fn without_films(self) -> Self {
        let fresnel = match self.fresnel {
            MetalFresnel::Coated { n, k, films: _ } => MetalFresnel::Index { n, k },
            other @ (MetalFresnel::Index { .. } | MetalFresnel::Reflectance(_)) => other,
        };
        Self { fresnel, ..self }
    }

    pub(super) fn is_textured(&self) -> bool {
        match &self.fresnel {
            MetalFresnel::Index { .. } => false,
            MetalFresnel::Reflectance(reflectance) => reflectance.is_textured(),
            MetalFresnel::Coated { films, .. } => films.is_textured(),
        }
    }

    pub(super) fn is_upsampled(&self) -> bool {
        match &self.fresnel {
            MetalFresnel::Index { n, k } | MetalFresnel::Coated { n, k, films: _ } => {
                n.is_upsampled() || k.is_upsampled()
            }
            MetalFresnel::Reflectance(reflectance) => reflectance.is_upsampled(),
        }
    }

    pub(super) fn without_textures(self) -> Self {
        let fresnel = match self.fresnel {
            MetalFresnel::Reflectance(reflectance) => MetalFresnel::Reflectance(reflectance.without_texture()),
            MetalFresnel::Coated { n, k, films } => MetalFresnel::Coated { n, k, films: films.without_textures() },
            index @ MetalFresnel::Index { .. } => index,
        };
        Self { fresnel, ..self }
    }

    /// Returns true if the surface is rough, so that its lobe has a finite width.
    pub fn is_rough(&self) -> bool {
        self.facets.is_some()
    }

    /// Returns the roughness α, or `None` if the surface is smooth.
    pub(super) fn alpha(&self) -> Option<f64> {
        self.facets.as_ref().map(|facets| facets.ggx.alpha())
    }

    pub(super) fn fresnel(&self, cos: f64, iors: InterfaceIors<'_>, texels: Texels, nm: f64) -> f64 {
        match &self.fresnel {
            MetalFresnel::Index { n, k } => fresnel::conductor(cos, n.at(nm), k.at(nm), iors.here.n(nm)),
            MetalFresnel::Reflectance(reflectance) => schlick(reflectance.at(texels.reflectance, nm), cos),
            MetalFresnel::Coated { n, k, films } => {
                let metal = Complex::new(n.at(nm), k.at(nm));
                films.response(cos, iors.here.n(nm), metal, nm, f64::from(texels.thickness_nm)).reflectance()
            }
        }
    }

    /// Returns the response to both polarisations, or `None` if only a reflectance is known.
    pub(super) fn response(&self, cos: f64, outside: f64, thickness_nm: f64, nm: f64) -> Option<StackResponse> {
        match &self.fresnel {
            MetalFresnel::Reflectance(_) => None,
            MetalFresnel::Index { n, k } => {
                let metal = Complex::new(n.at(nm), k.at(nm));
                Some(thin_film::response(cos, outside, std::iter::empty(), metal, nm))
            }
            MetalFresnel::Coated { n, k, films } => {
                Some(films.response(cos, outside, Complex::new(n.at(nm), k.at(nm)), nm, thickness_nm))
            }
        }
    }

    /// Returns the cosine-weighted mean of the reflectance, F̄ = ∫ 2μ·F(μ) dμ, from a table for
    /// metals in air, because photons in a kernel ask for it at each of their wavelengths.
    #[inline]
    fn mean_reflectance(&self, iors: InterfaceIors<'_>, texels: Texels, nm: f64) -> f64 {
        let tabulated =
            self.facets.as_ref().filter(|_| iors.here.n(nm) == 1.0).and_then(|facets| facets.mean_in_air(nm));
        tabulated.unwrap_or_else(|| self.integrated_reflectance(iors, texels, nm))
    }

    #[inline(never)]
    fn integrated_reflectance(&self, iors: InterfaceIors<'_>, texels: Texels, nm: f64) -> f64 {
        match &self.fresnel {
            MetalFresnel::Index { n, k } => {
                let (n, k, outside) = (n.at(nm), k.at(nm), iors.here.n(nm));
                gauss4((0.0, 1.0), |cos| 2.0 * cos * fresnel::conductor(cos, n, k, outside))
            }
            // 2∫ μ (1 − μ)⁵ dμ = 1/21.
            MetalFresnel::Reflectance(reflectance) => {
                let normal = reflectance.at(texels.reflectance, nm);
                normal + (1.0 - normal) / 21.0
            }
            MetalFresnel::Coated { .. } => gauss4((0.0, 1.0), |cos| 2.0 * cos * self.fresnel(cos, iors, texels, nm)),
        }
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 3]) -> BsdfSample {
        let Some(facets) = &self.facets else {
            return BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), ScatterEvent::Reflection, 1.0);
        };
        let sign = z_sign(wo);
        let up = flip_z(wo, sign);
        let m = facets.ggx.sample_visible(up, u[0], u[1]);
        let mirrored = fresnel::reflect(up, m);
        // Both lobes use the facet for the absorbed fraction: u[0] and u[1] are uniform in both.
        let shadowed = if mirrored.z > 0.0 { facets.ggx.shadowed_fraction(up.z, mirrored.z) } else { 1.0 };
        let multiple = u[2] < facets.compensation.albedo(up.z);
        let wi = flip_z(if multiple { facets.compensation.sample([u[0], u[1]]) } else { mirrored }, sign);
        let pdf = self.pdf(wo, wi);
        let sample = BsdfSample::lobe(wi, ScatterEvent::Reflection, if pdf > 0.0 { pdf } else { 1.0 });
        BsdfSample { cos_microfacet: up.dot(m), shadowed: [shadowed, 0.0], ..sample }
    }

    pub(super) fn coefficient(&self, wo: DVec3, iors: InterfaceIors<'_>, texels: Texels, nm: f64) -> f64 {
        self.fresnel(wo.z, iors, texels, nm)
    }

    pub(super) fn absorbed_fraction(
        &self,
        wo: DVec3,
        sample: &BsdfSample,
        iors: InterfaceIors<'_>,
        texels: Texels,
        nm: f64,
    ) -> f64 {
        let Some(facets) = &self.facets else {
            return 1.0 - self.fresnel(wo.z, iors, texels, nm);
        };
        let kept = facets.compensation.reflected(self.mean_reflectance(iors, texels, nm));
        let absorbed_once = 1.0 - self.fresnel(sample.cos_microfacet, iors, texels, nm);
        let [shadowed, _] = sample.shadowed;
        absorbed_once * (1.0 - shadowed) + shadowed * (1.0 - kept)
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, texels: Texels, nm: f64) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| same_side(wo, wi)) else {
            return 0.0;
        };
        let kept = facets.compensation.reflected(self.mean_reflectance(iors, texels, nm));
        self.eval_facet(wo, wi, iors, texels, nm) + kept * facets.compensation.eval(wo.z.abs(), wi.z.abs())
    }

    /// Evaluates the light that hits one facet of a rough metal.
    pub(super) fn eval_facet(&self, wo: DVec3, wi: DVec3, iors: InterfaceIors<'_>, texels: Texels, nm: f64) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| same_side(wo, wi)) else {
            return 0.0;
        };
        let m = (wo + wi).normalize_or_zero();
        let lobe = facets.ggx.reflection_lobe(flip_z(m, z_sign(wo)), wo.z.abs(), wi.z.abs());
        self.fresnel(wo.dot(m), iors, texels, nm) * lobe
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| same_side(wo, wi)) else {
            return 0.0;
        };
        let m = flip_z((wo + wi).normalize_or_zero(), z_sign(wo));
        let single = 0.25 * facets.ggx.g1_per_cos(wo.z.abs()) * facets.ggx.eval(m);
        let probability = facets.compensation.albedo(wo.z.abs());
        (1.0 - probability) * single + probability * facets.compensation.pdf(wi.z.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::Outside;

    /// The table agrees with the integral between its wavelengths, and it is not used in water.
    #[test]
    fn the_tabulated_mean_reflectance_is_the_integral() {
        let table = |values: [f64; 3]| Spectrum::table(&[360.0, 500.0, 830.0], &values, Outside::Hold).unwrap();
        let rough = Conductor::new(table([1.6, 0.9, 0.2]), table([1.9, 1.8, 5.4]), 0.3).unwrap();
        let mean = |outside: f64, nm: f64| {
            let index = RefractiveIndex::constant(outside).unwrap();
            let iors = InterfaceIors { here: &index, there: &index };
            [rough.mean_reflectance(iors, Texels::NONE, nm), rough.integrated_reflectance(iors, Texels::NONE, nm)]
        };
        for nm in [360.0, 499.7, 517.3, 829.9, 830.0] {
            let [tabulated, integral] = mean(1.0, nm);
            assert!((tabulated - integral).abs() < 2e-5, "{nm} nm: {tabulated} for {integral}");
            let [in_water, integral] = mean(1.33, nm);
            assert!(in_water == integral && in_water < tabulated, "{nm} nm: {in_water} for {integral}");
        }
    }

    /// Integrates F from Fresnel's amplitudes with a complex cosine of refraction.
    #[test]
    fn the_mean_reflectance_weights_directions_by_their_cosine() {
        let (n, k) = (2.9_f64, 3.3_f64);
        let reflectance = |cos: f64| {
            let sin2 = 1.0 - cos * cos;
            // (a + ib)² = (n + ik)² − sin² θ
            let (real, imaginary) = (n * n - k * k - sin2, 2.0 * n * k);
            let modulus = real.hypot(imaginary);
            let (a, b) = ((0.5 * (modulus + real)).sqrt(), (0.5 * (modulus - real)).sqrt());
            let s = ((a - cos).powi(2) + b * b) / ((a + cos).powi(2) + b * b);
            let tangent = sin2.sqrt() * sin2.sqrt() / cos;
            s * 0.5 * (1.0 + ((a - tangent).powi(2) + b * b) / ((a + tangent).powi(2) + b * b))
        };
        let steps = 10_000;
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
        let known = (0..steps).map(|i| 2.0 * at(i) * reflectance(at(i)) / f64::from(steps)).sum::<f64>();
        let rough = Conductor::new(Spectrum::constant(n), Spectrum::constant(k), 0.5).unwrap();
        let index = RefractiveIndex::constant(1.0).unwrap();
        let found = rough.mean_reflectance(InterfaceIors { here: &index, there: &index }, Texels::NONE, 550.0);
        assert!((found - known).abs() < 2e-3, "{found} for {known}");
    }

    /// At normal incidence in a liquid of index m, R = ((n − m)² + k²)/((n + m)² + k²).
    #[test]
    fn a_metal_in_water_reflects_less_than_in_air() {
        let (n, k) = (0.9, 2.4);
        let smooth = Conductor::new(Spectrum::constant(n), Spectrum::constant(k), 0.0).unwrap();
        for outside in [1.0, 1.333, 1.7] {
            let index = RefractiveIndex::constant(outside).unwrap();
            let iors = InterfaceIors { here: &index, there: &index };
            let known = ((n - outside).powi(2) + k * k) / ((n + outside).powi(2) + k * k);
            assert!(
                (smooth.coefficient(DVec3::Z, iors, Texels::NONE, 550.0) - known).abs() < 1e-12,
                "outside index {outside}"
            );
        }
    }
}
