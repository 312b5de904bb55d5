//! The thin dielectric pane: both faces of a slab as one interface.

use glam::DVec3;

use super::check::check_within;
use super::filter::PolarisingFilter;
use super::polarisation::FacetResponses;
use super::power::PowerFractions;
use super::sample::{BsdfSample, InterfaceIors};
use crate::fresnel;
use crate::glass::RefractiveIndex;
use crate::thin_film::{CoatedPlate, FilmStack};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::exp;
use abbe_spectra::spectrum::Spectrum;

/// A dielectric slab of index n(λ) whose thickness is negligible compared with the scene.
///
/// Light that enters the slab is reflected between the two faces and leaves in two directions. With
/// the reflectance R of a face and the transmittance τ of a passage, the incoherent sums are T′ =
/// τ(1 − R)²/(1 − R²τ²) and R′ = R(1 + τT′) (Stokes 1862). Repeated reflections keep the
/// polarisation, so the sums are computed for s and for p, and averaged for unpolarised light.
/// Transmitted light continues straight on, in the medium of the side of `wo`.
#[derive(Debug, Clone, PartialEq)]
pub struct ThinDielectric {
    pub(super) index: RefractiveIndex,
    /// Along the normal: absorption coefficient times thickness.
    pub(super) optical_depth: Option<Spectrum>,
    /// Measured over the cosine of the angle of incidence; replaces the computed one.
    pub(super) transmittance: Option<CosinePolynomial>,
    /// On both faces, from the outside to the slab.
    pub(super) coating: Option<FilmStack>,
    /// A sheet that changes the polarisation of light and reflects nothing.
    pub(super) filter: Option<Box<PolarisingFilter>>,
}

/// A polynomial in the cosine of the angle of incidence, limited to values from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct CosinePolynomial(Vec<f64>);

impl CosinePolynomial {
    /// Creates a polynomial from its coefficients, beginning with the constant term.
    pub fn new(coefficients: Vec<f64>) -> Self {
        Self(coefficients)
    }

    fn at(&self, cosine: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, coefficient| sum * cosine + coefficient).clamp(0.0, 1.0)
    }
}

impl ThinDielectric {
    /// Creates a pane from its index and, if it absorbs, its optical depth: the absorption
    /// coefficient times the thickness. Returns an error if the optical depth is negative.
    pub fn new(index: RefractiveIndex, optical_depth: Option<Spectrum>) -> Result<Self> {
        optical_depth.iter().try_for_each(|depth| check_within("optical depth", depth, f64::INFINITY))?;
        Ok(Self { index, optical_depth, transmittance: None, coating: None, filter: None })
    }

    /// Creates a sheet that reflects nothing and changes the polarisation of light. Its powers are
    /// those of a hole: what it absorbs is decided by the polarisation of the light.
    pub fn polarising(filter: PolarisingFilter) -> Result<Self> {
        Ok(Self { filter: Some(Box::new(filter)), ..Self::new(RefractiveIndex::constant(1.0)?, None)? })
    }

    /// Returns the filter of a polarising sheet.
    #[inline]
    pub fn filter(&self) -> Option<&PolarisingFilter> {
        self.filter.as_deref()
    }

    /// Returns the responses to both polarisations, at a cosine of the angle of incidence.
    pub fn responses(&self, cosine: f64, outside: f64, thickness_nm: f64, nm: f64) -> FacetResponses<'_> {
        if let Some(filter) = self.filter() {
            return FacetResponses::Filter(filter);
        }
        if self.transmittance.is_some() {
            // A measurement for natural light does not tell what happens to polarised light.
            return FacetResponses::Depolarising;
        }
        let inside = self.index.n(nm);
        let cos_inside = fresnel::cos_transmitted(cosine.abs(), outside, inside);
        let passage = self.optical_depth.as_ref().map_or(1.0, |depth| exp(-depth.at(nm) / cos_inside));
        let Some(films) = &self.coating else { return FacetResponses::Plate { indices: [outside, inside], passage } };
        FacetResponses::CoatedPlate {
            front: films.response(cosine, outside, inside.into(), nm, thickness_nm),
            inside: films.response_reversed(cos_inside, inside, outside.into(), nm, thickness_nm),
            passage,
        }
    }

    /// Returns the pane with thin films on both faces, listed from the outside.
    #[must_use]
    pub fn with_coating(self, films: FilmStack) -> Self {
        Self { coating: Some(films), ..self }
    }

    /// Sets a measured transmittance. R is that of a clear pane, but at most the rest.
    #[must_use]
    pub fn with_transmittance(self, transmittance: CosinePolynomial) -> Self {
        Self { transmittance: Some(transmittance), ..self }
    }

    /// Returns R and T of a pane without films; see [`Self::transmittance`].
    pub fn plain_powers(&self, cosine: f64, outside: &RefractiveIndex, nm: f64) -> PowerFractions {
        self.powers_at(cosine, outside.n(nm), 0.0, nm)
    }

    /// Returns true if the pane has the index `outside` and no films, so that it reflects nothing, and
    /// if it is no filter.
    pub fn matches(&self, outside: &RefractiveIndex) -> bool {
        self.index == *outside && self.coating.is_none() && self.filter.is_none()
    }

    fn absorbs(&self) -> bool {
        let in_films = self.coating.as_ref().is_some_and(FilmStack::absorbs);
        self.optical_depth.is_some() || self.transmittance.is_some() || in_films
    }

    /// Returns the transmittance of a pane without films for unpolarised light, at a cosine of the
    /// angle of incidence and with the refractive index `outside` on both sides.
    pub fn transmittance(&self, cosine: f64, outside: &RefractiveIndex, nm: f64) -> f64 {
        self.powers_at(cosine, outside.n(nm), 0.0, nm).transmitted
    }

    pub(super) fn sample(
        &self,
        wo: DVec3,
        iors: InterfaceIors<'_>,
        thickness_nm: f32,
        nm: f64,
        u: [f64; 3],
    ) -> BsdfSample {
        let powers = self.powers(wo, iors, thickness_nm, nm);
        let probability =
            if self.absorbs() || self.coating.is_some() { powers.reflection_probability() } else { powers.reflected };
        PowerFractions::sample_straight(wo, probability, u[2])
    }

    pub(super) fn absorbed_fraction(&self, wo: DVec3, iors: InterfaceIors<'_>, thickness_nm: f32, nm: f64) -> f64 {
        if !self.absorbs() {
            return 0.0;
        }
        self.powers(wo, iors, thickness_nm, nm).absorbed()
    }

    /// R′ and T′ of unpolarised light.
    pub(super) fn powers(&self, wo: DVec3, iors: InterfaceIors<'_>, thickness_nm: f32, nm: f64) -> PowerFractions {
        self.powers_at(wo.z, iors.here.n(nm), thickness_nm, nm)
    }

    /// Does the same for a cosine of the angle of incidence, and the refractive index `outside`.
    fn powers_at(&self, cosine: f64, outside: f64, thickness_nm: f32, nm: f64) -> PowerFractions {
        if self.filter.is_some() {
            return PowerFractions { reflected: 0.0, transmitted: 1.0 };
        }
        let inside = self.index.n(nm);
        if let Some(films) = &self.coating {
            return self.between_films(films, cosine, [outside, inside], thickness_nm, nm);
        }
        let (s, p) = fresnel::dielectric_sp(cosine, outside, inside);
        if let Some(polynomial) = &self.transmittance {
            let reflected = s / (1.0 + s) + p / (1.0 + p);
            let transmitted = polynomial.at(cosine.abs());
            return PowerFractions { reflected: reflected.min(1.0 - transmitted), transmitted };
        }
        let Some(depth) = &self.optical_depth else {
            let reflected = s / (1.0 + s) + p / (1.0 + p);
            return PowerFractions { reflected, transmitted: 1.0 - reflected };
        };
        let passage = exp(-depth.at(nm) / fresnel::cos_transmitted(cosine, outside, inside));
        let ((rs, ts), (rp, tp)) = (slab(s, passage), slab(p, passage));
        PowerFractions { reflected: 0.5 * (rs + rp), transmitted: 0.5 * (ts + tp) }
    }
    /// R′ and T′ of unpolarised light for a slab with films on both faces. Only the waves inside
    /// the films interfere. `indices` are those of the medium and of the slab.
    fn between_films(
        &self,
        films: &FilmStack,
        cos: f64,
        [outside, inside]: [f64; 2],
        thickness_nm: f32,
        nm: f64,
    ) -> PowerFractions {
        let (thickness, cos_inside) = (f64::from(thickness_nm), fresnel::cos_transmitted(cos, outside, inside));
        let face = films.response_reversed(cos_inside, inside, outside.into(), nm, thickness);
        let passage = self.optical_depth.as_ref().map_or(1.0, |depth| exp(-depth.at(nm) / cos_inside));
        let plate = CoatedPlate {
            front: films.response(cos, outside, inside.into(), nm, thickness),
            front_inside: face,
            back_inside: face,
            passage,
        };
        let [reflected, transmitted] = plate.response().mean();
        let clear = self.optical_depth.is_none() && !films.absorbs();
        let transmitted = if clear { 1.0 - reflected } else { transmitted.min(1.0 - reflected) };
        PowerFractions { reflected, transmitted }
    }
}

/// R′ and T′ for one polarisation, from a face's reflectance and a passage's τ.
fn slab(face: f64, passage: f64) -> (f64, f64) {
    if face >= 1.0 {
        return (1.0, 0.0);
    }
    let transmitted = passage * (1.0 - face) * (1.0 - face) / ((1.0 - face * passage) * (1.0 + face * passage));
    (face * (1.0 + passage * transmitted), transmitted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transmittance(pane: &ThinDielectric, degrees: f64) -> f64 {
        let air = RefractiveIndex::constant(1.0).unwrap();
        let (sin, cos) = degrees.to_radians().sin_cos();
        let iors = InterfaceIors { here: &air, there: &air };
        pane.powers(DVec3::new(sin, 0.0, cos), iors, 0.0, 500.0).transmitted
    }

    #[test]
    fn a_window_pane_reflects_both_its_faces() {
        let (air, glass) = (RefractiveIndex::constant(1.0).unwrap(), RefractiveIndex::constant(1.5).unwrap());
        let pane = ThinDielectric::new(glass, None).unwrap();
        let iors = InterfaceIors { here: &air, there: &air };
        // One face reflects 0.04. The sum over all internal reflections is 2·0.04/1.04.
        assert!((pane.powers(DVec3::Z, iors, 0.0, 500.0).reflected - 0.08 / 1.04).abs() < 1e-15);
        assert!((pane.powers(DVec3::Z, iors, 0.0, 500.0).transmitted - 0.96 / 1.04).abs() < 1e-15);
    }

    /// Case 5.5 of CIE 171:2006, with values from an independent evaluation of the sums for s and
    /// p: a clear pane and an absorbing slab of 6 mm and 7.3 per m, both of index 1.52.
    #[test]
    fn panes_transmit_the_mean_over_both_polarisations() {
        let glass = || RefractiveIndex::constant(1.52).unwrap();
        let clear = ThinDielectric::new(glass(), None).unwrap();
        let grey = ThinDielectric::new(glass(), Some(Spectrum::constant(7.3 * 0.006))).unwrap();
        let known = [
            (0.0, 0.918_318, 0.878_83),
            (30.0, 0.915_957_3, 0.874_274_2),
            (50.0, 0.891_162_2, 0.846_591_2),
            (60.0, 0.843_470_7, 0.798_545_8),
            (70.0, 0.724_712_8, 0.682_619_9),
            (80.0, 0.456_043_4, 0.422_589_2),
            (85.0, 0.245_645_5, 0.218_139_3),
        ];
        for (degrees, of_clear, of_grey) in known {
            assert!((transmittance(&clear, degrees) - of_clear).abs() < 1e-6, "{degrees}°, clear");
            assert!((transmittance(&grey, degrees) - of_grey).abs() < 1e-6, "{degrees}°, grey");
        }
    }

    #[test]
    fn a_slab_of_optical_depth_0_is_a_clear_pane() {
        let glass = || RefractiveIndex::constant(1.7).unwrap();
        let clear = ThinDielectric::new(glass(), None).unwrap();
        let slab = ThinDielectric::new(glass(), Some(Spectrum::constant(0.0))).unwrap();
        for degrees in [0.0, 45.0, 75.0, 89.9, 90.0] {
            let (one, other) = (transmittance(&clear, degrees), transmittance(&slab, degrees));
            assert!((one - other).abs() < 1e-14, "{degrees}°: {one} and {other}");
        }
    }
}
