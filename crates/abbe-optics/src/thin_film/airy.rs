//! Amplitudes and powers of a stack by the Airy summation.

use std::f64::consts::TAU;

use abbe_spectra::math::complex::Complex;

/// The least modulus of n·cos θ in a layer. At 0, the critical angle of the layer, the amplitudes
/// of both faces are ±1 and their sum is 0/0. The results are even in n·cos θ, so this bound
/// changes them by less than 10⁻¹¹.
pub(super) const LEAST_NORMAL_INDEX: f64 = 1e-6;

/// At smaller cosines, all light is reflected, before transmitted power underflows.
pub(super) const LEAST_COSINE: f64 = 1e-100;

/// The response of a stack to s or p polarised light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarisedResponse {
    /// The reflected field divided by the incident field.
    pub reflected: Complex,
    /// The transmitted field divided by the incident field.
    pub transmitted: Complex,
    /// The reflected fraction R of the power, from 0 to 1.
    pub reflectance: f64,
    /// The fraction T of the power that enters the substrate, from 0 to 1 − R.
    pub transmittance: f64,
}

impl PolarisedResponse {
    /// Returns the fraction 1 − R − T of the power that the layers absorb.
    pub fn absorptance(&self) -> f64 {
        (1.0 - self.reflectance - self.transmittance).max(0.0)
    }
}

/// The response of a stack to both polarisations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StackResponse {
    /// For an electric field perpendicular to the plane of incidence.
    pub s: PolarisedResponse,
    /// For an electric field in the plane of incidence.
    pub p: PolarisedResponse,
}

impl StackResponse {
    /// Returns the reflectance for unpolarised light.
    pub fn reflectance(&self) -> f64 {
        0.5 * (self.s.reflectance + self.p.reflectance)
    }

    /// Returns the transmittance for unpolarised light.
    pub fn transmittance(&self) -> f64 {
        0.5 * (self.s.transmittance + self.p.transmittance)
    }

    /// Returns the absorptance for unpolarised light.
    pub fn absorptance(&self) -> f64 {
        0.5 * (self.s.absorptance() + self.p.absorptance())
    }
}

/// A medium or a layer at one wavelength and one angle.
#[derive(Debug, Clone, Copy)]
struct FilmLevel {
    squared: Complex,
    index: Complex,
    /// n·cos θ. Its real and imaginary parts are not negative.
    normal: Complex,
}

impl FilmLevel {
    /// `transverse` is n₀·sin θ₀, which is the same in all layers.
    fn new(index: Complex, transverse: f64) -> Self {
        let squared = index * index;
        // The product has no cancellation near the critical angle.
        let normal = (index - Complex::from(transverse)) * (index + Complex::from(transverse));
        Self { squared, index, normal: normal.sqrt() }
    }

    fn of_layer(index: Complex, transverse: f64) -> Self {
        let level = Self::new(index, transverse);
        let tiny = level.normal.norm_squared() < LEAST_NORMAL_INDEX * LEAST_NORMAL_INDEX;
        Self { normal: if tiny { Complex::from(LEAST_NORMAL_INDEX) } else { level.normal }, ..level }
    }
}

/// The amplitudes of the part of a stack below an interface.
#[derive(Debug, Clone, Copy)]
struct Amplitudes {
    reflected: Complex,
    transmitted: Complex,
}

impl Amplitudes {
    const NOTHING: Self = Self { reflected: Complex::new(0.0, 0.0), transmitted: Complex::new(1.0, 0.0) };

    /// Adds the interface that lies above the part.
    fn below(self, reflected: Complex, transmitted: Complex) -> Self {
        let repeated = Complex::from(1.0) + reflected * self.reflected;
        Self {
            reflected: (reflected + self.reflected) / repeated,
            transmitted: transmitted * self.transmitted / repeated,
        }
    }

    /// Adds one passage through the layer above the part.
    fn through(self, passage: Complex) -> Self {
        Self { reflected: self.reflected * (passage * passage), transmitted: self.transmitted * passage }
    }
}

/// Returns Fresnel's reflected and transmitted amplitudes from `a` to `b`, for s and then for p.
fn interface(a: &FilmLevel, b: &FilmLevel) -> [(Complex, Complex); 2] {
    let pair = |from: Complex, to: Complex, product: Complex| {
        let sum = from + to;
        if sum == Complex::default() {
            return (Complex::default(), Complex::from(1.0));
        }
        ((from - to) / sum, product * 2.0 / sum)
    };
    let s = pair(a.normal, b.normal, a.normal);
    let p = pair(b.squared * a.normal, a.squared * b.normal, a.index * b.index * a.normal);
    [s, p]
}

/// Returns the response of a stack to light of the wavelength `nm` (nm, in air), all of which is
/// reflected at grazing incidence. The sign of the cosine of incidence `cos` is ignored. The light
/// arrives in a medium of the real index `incident`. `layers` contains the complex index and the
/// thickness in nm of each layer, from the incident side to the substrate.
pub fn response(
    cos: f64,
    incident: f64,
    layers: impl DoubleEndedIterator<Item = (Complex, f64)>,
    substrate: Complex,
    nm: f64,
) -> StackResponse {
    let cos = cos.abs().min(1.0);
    if cos < LEAST_COSINE {
        let mirror = |sign: f64| PolarisedResponse {
            reflected: Complex::from(sign),
            transmitted: Complex::default(),
            reflectance: 1.0,
            transmittance: 0.0,
        };
        return StackResponse { s: mirror(-1.0), p: mirror(-1.0) };
    }
    let transverse = incident * ((1.0 - cos) * (1.0 + cos)).sqrt();
    let last = FilmLevel::new(substrate, transverse);
    let (mut below, mut parts) = (last, [Amplitudes::NOTHING; 2]);
    let per_nm = TAU / nm;
    for (index, thickness_nm) in layers.rev() {
        let layer = FilmLevel::of_layer(index, transverse);
        let passage = (layer.normal * (per_nm * thickness_nm)).exp_i();
        for (part, (reflected, transmitted)) in parts.iter_mut().zip(interface(&layer, &below)) {
            *part = part.below(reflected, transmitted).through(passage);
        }
        below = layer;
    }
    let squared = Complex::from(incident * incident);
    let first = FilmLevel { squared, index: Complex::from(incident), normal: Complex::from(incident * cos) };
    for (part, (reflected, transmitted)) in parts.iter_mut().zip(interface(&first, &below)) {
        *part = part.below(reflected, transmitted);
    }
    // The normal component of the power flow in the substrate, relative to the incident one.
    let flow_s = last.normal.re / first.normal.re;
    let flow_p = (last.squared * last.normal.conjugate()).re / (last.squared.norm_squared().sqrt() * first.normal.re);
    let [s, p] = parts;
    StackResponse { s: powers(s, flow_s), p: powers(p, flow_p) }
}

fn powers(Amplitudes { reflected, transmitted }: Amplitudes, flow: f64) -> PolarisedResponse {
    let reflectance = reflected.norm_squared().min(1.0);
    let transmittance = (transmitted.norm_squared() * flow).clamp(0.0, 1.0 - reflectance);
    PolarisedResponse { reflected, transmitted, reflectance, transmittance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel;

    fn bare(cos: f64, incident: f64, substrate: Complex) -> StackResponse {
        response(cos, incident, std::iter::empty(), substrate, 550.0)
    }

    #[test]
    fn an_empty_stack_is_a_bare_interface() {
        for (n_i, n_t) in [(1.0, 1.5), (1.5, 1.0), (1.33, 2.4), (1.0, 1.0)] {
            for i in 0..=200 {
                let cos = f64::from(i) / 200.0;
                let (found, known) = (bare(cos, n_i, n_t.into()), fresnel::dielectric_sp(cos, n_i, n_t));
                if n_i == n_t && cos == 0.0 {
                    continue;
                }
                assert!((found.s.reflectance - known.0).abs() < 1e-12, "s at {cos} from {n_i} to {n_t}");
                assert!((found.p.reflectance - known.1).abs() < 1e-12, "p at {cos} from {n_i} to {n_t}");
                assert!(found.s.absorptance() < 1e-12 && found.p.absorptance() < 1e-12);
            }
        }
        for cos in [1.0, 0.7, 0.1] {
            let (found, known) = (bare(cos, 1.33, Complex::new(0.9, 6.2)), fresnel::conductor_sp(cos, 0.9, 6.2, 1.33));
            assert!((found.s.reflectance - known.0).abs() < 1e-12 && (found.p.reflectance - known.1).abs() < 1e-12);
        }
    }

    /// At the exact critical angle of a layer, the limit is that of neighbouring angles.
    #[test]
    fn the_critical_angle_of_a_layer_is_no_exception() {
        let transverse = 1.0_f64;
        let n = 1.5;
        let critical = (1.0 - (transverse / n) * (transverse / n)).sqrt();
        let gap = |cos: f64| response(cos, n, [(Complex::from(1.0), 300.0)].into_iter(), n.into(), 550.0);
        let (at, beside) = (gap(critical), gap(critical + 1e-9));
        assert!((at.s.transmittance - beside.s.transmittance).abs() < 1e-6, "{at:?} {beside:?}");
        assert!((at.p.transmittance - beside.p.transmittance).abs() < 1e-6, "{at:?} {beside:?}");
        for i in 0..2000 {
            let near = gap(critical + 1e-10 * f64::from(i - 1000));
            assert!(near.s.absorptance() < 1e-7 && near.p.absorptance() < 1e-7, "{i}: {near:?}");
        }
    }

    #[test]
    fn thick_absorbing_layers_do_not_overflow() {
        let silver = Complex::new(0.06, 3.6);
        for thickness in [1e3, 1e6, 1e12] {
            let thick = response(0.4, 1.0, [(silver, thickness)].into_iter(), 1.5.into(), 550.0);
            let half_space = bare(0.4, 1.0, silver);
            assert!((thick.s.reflectance - half_space.s.reflectance).abs() < 1e-12);
            assert!((thick.p.reflectance - half_space.p.reflectance).abs() < 1e-12);
            assert!(thick.s.transmittance < 1e-30 && thick.p.transmittance < 1e-30);
        }
    }

    #[test]
    fn the_transmittance_is_reciprocal() {
        let layers =
            [(Complex::new(1.38, 0.0), 120.0), (Complex::new(0.06, 3.6), 20.0), (Complex::new(2.3, 0.1), 60.0)];
        let cos = 0.6_f64;
        let cos_t = fresnel::cos_transmitted(cos, 1.0, 1.52);
        let there = response(cos, 1.0, layers.into_iter(), 1.52.into(), 480.0);
        let back = response(cos_t, 1.52, layers.into_iter().rev(), 1.0.into(), 480.0);
        assert!((there.s.transmittance - back.s.transmittance).abs() < 1e-12);
        assert!((there.p.transmittance - back.p.transmittance).abs() < 1e-12);
        assert!((there.s.reflectance - back.s.reflectance).abs() > 1e-3, "an absorbing stack reflects differently");
    }
}
