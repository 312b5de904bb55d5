//! The boundary between two transparent media, polished and rough.

use glam::DVec3;

use super::hemisphere::{same_side, side, turned};
use super::{Event, Scatter, Sides, Transport, check_alpha};
use crate::error::Result;
use crate::optics::fresnel;
use crate::optics::microfacet::{Ggx, MIN_ALPHA};

/// Reflects by Fresnel's equations and refracts by Snell's law, at the surface itself or, rough, at GGX facets (Walter et al. 2007)
/// that scatter once; light that a facet would send into another one is lost, and booked as absorbed. The two indices come from
/// [`Sides`]; where they are equal, light passes straight on.
#[derive(Debug, Clone, PartialEq)]
pub struct Dielectric {
    /// `None` if smooth.
    facets: Option<Ggx>,
}

impl Dielectric {
    /// A boundary of GGX roughness `alpha` in \[0, 1\]; below [`MIN_ALPHA`] it is smooth. Fails outside.
    pub fn new(alpha: f64) -> Result<Self> {
        check_alpha(alpha)?;
        Ok(Self { facets: (alpha >= MIN_ALPHA).then(|| Ggx::new(alpha)) })
    }

    /// Whether it spreads light into lobes.
    pub fn is_rough(&self) -> bool {
        self.facets.is_some()
    }

    pub(super) fn sample(&self, wo: DVec3, sides: Sides<'_>, nm: f64, u: [f64; 3]) -> Option<Scatter> {
        let (n_here, n_there) = (sides.here.n(nm), sides.there.n(nm));
        if n_here == n_there {
            return Some(Scatter::delta(-wo, Event::Transmission, 1.0));
        }
        let side = side(wo);
        let up = turned(wo, side);
        let m = self.facets.as_ref().map_or(DVec3::Z, |facets| facets.sample_visible(up, u[0], u[1]));
        let reflected = fresnel::dielectric(up.dot(m), n_here, n_there);
        let mut scatter = if u[2] < reflected {
            let wi = if self.is_rough() { fresnel::reflect(up, m) } else { DVec3::new(-up.x, -up.y, up.z) };
            Scatter::delta(turned(wi, side), Event::Reflection, reflected)
        } else {
            let wi = fresnel::refract(up, m, n_here, n_there)?;
            let disperses = sides.here.is_dispersive() || sides.there.is_dispersive();
            Scatter { disperses, ..Scatter::delta(turned(wi, side), Event::Transmission, 1.0 - reflected) }
        };
        if self.is_rough() {
            let density = if scatter.gets_away(wo) { self.pdf(wo, scatter.wi, sides, nm) } else { 1.0 };
            scatter = Scatter { delta: false, probability: density, facet_cos: up.dot(m), ..scatter };
        }
        (scatter.probability > 0.0).then_some(scatter)
    }

    pub(super) fn absorbed(&self, wo: DVec3, scatter: &Scatter, sides: Sides<'_>, nm: f64) -> f64 {
        let Some(facets) = self.facets.as_ref().filter(|_| !scatter.delta) else {
            return 0.0;
        };
        let lost = if scatter.gets_away(wo) { facets.shadowed(wo.z.abs(), scatter.wi.z.abs()) } else { 1.0 };
        // The event was chosen by the hero's Fresnel factor; another wavelength is lost in proportion to its own.
        match scatter.event {
            Event::Reflection => {
                lost * fresnel::dielectric(scatter.facet_cos, sides.here.n(nm), sides.there.n(nm)) / scatter.choice
            }
            Event::Transmission => lost,
        }
    }

    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, sides: Sides<'_>, transport: Transport, nm: f64) -> f64 {
        let Some(facet) = self.facet(wo, wi, sides, nm) else {
            return 0.0;
        };
        let masking = facet.ggx.g2_per_cos(wo.z.abs(), wi.z.abs());
        let common = facet.fraction * facet.ggx.density(facet.m) * facet.spread * masking;
        match facet.event {
            Event::Reflection => common * facet.cos_o,
            Event::Transmission => common * facet.cos_o * squeeze(sides, transport, nm),
        }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3, sides: Sides<'_>, nm: f64) -> f64 {
        let Some(facet) = self.facet(wo, wi, sides, nm) else {
            return 0.0;
        };
        let visible = facet.ggx.g1_per_cos(wo.z.abs()) * facet.ggx.density(facet.m) * facet.cos_o;
        facet.fraction * visible * facet.spread
    }

    /// The facet that leads from `wo` to `wi`, if there is one.
    fn facet(&self, wo: DVec3, wi: DVec3, sides: Sides<'_>, nm: f64) -> Option<Facet<'_>> {
        let ggx = self.facets.as_ref()?;
        let (n_here, n_there) = (sides.here.n(nm), sides.there.n(nm));
        if n_here == n_there || wi.z == 0.0 {
            return None;
        }
        let side = side(wo);
        let (up, wi_up) = (turned(wo, side), turned(wi, side));
        if same_side(wo, wi) {
            let m = (up + wi_up).normalize_or_zero();
            let cos_o = up.dot(m);
            if cos_o <= 0.0 {
                return None;
            }
            let fraction = fresnel::dielectric(cos_o, n_here, n_there);
            // dω_m/dω_i = 1/(4·|o·m|) (Walter et al. 2007, equation 14).
            return Some(Facet { ggx, m, cos_o, fraction, spread: 0.25 / cos_o, event: Event::Reflection });
        }
        // Refraction leaves n_h·o + n_t·i along the facet's normal; its length is also the |n_h(o·m) + n_t(i·m)| of the
        // Jacobian n_t²·|i·m|/(…)² (equations 16 and 17).
        let along = up * n_here + wi_up * n_there;
        let m = along.normalize_or_zero() * along.z.signum();
        let (cos_o, cos_i) = (up.dot(m), -wi_up.dot(m));
        if !(cos_o > 0.0 && cos_i > 0.0) {
            return None;
        }
        let fraction = 1.0 - fresnel::dielectric(cos_o, n_here, n_there);
        let spread = n_there * n_there * cos_i / along.length_squared();
        Some(Facet { ggx, m, cos_o, fraction, spread, event: Event::Transmission })
    }
}

/// A facet that leads from one direction to another, in the frame where `wo` is above.
struct Facet<'a> {
    ggx: &'a Ggx,
    m: DVec3,
    /// |o·m|, > 0.
    cos_o: f64,
    /// The fraction of light that goes this way: F or 1 − F.
    fraction: f64,
    /// dω_m/dω_i.
    spread: f64,
    event: Event,
}

/// The strength of a smooth boundary's two deltas.
pub(super) fn coefficient(wo: DVec3, event: Event, sides: Sides<'_>, transport: Transport, nm: f64) -> f64 {
    let reflected = fresnel::dielectric(wo.z, sides.here.n(nm), sides.there.n(nm));
    match event {
        Event::Reflection => reflected,
        Event::Transmission => (1.0 - reflected) * squeeze(sides, transport, nm),
    }
}

/// (n_here/n_there)² for radiance, 1 for power.
fn squeeze(sides: Sides<'_>, transport: Transport, nm: f64) -> f64 {
    match transport {
        Transport::Radiance => {
            let ratio = sides.here.n(nm) / sides.there.n(nm);
            ratio * ratio
        }
        Transport::Importance => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::glass::Index;

    #[test]
    fn radiance_is_squeezed_by_the_squared_index_and_power_is_not() {
        let (air, glass) = (Index::constant(1.0).unwrap(), Index::constant(1.5).unwrap());
        let from_air = Sides { here: &air, there: &glass };
        let through = |sides, transport| coefficient(DVec3::Z, Event::Transmission, sides, transport, 500.0);
        assert!((through(from_air, Transport::Importance) - 0.96).abs() < 1e-15);
        // A camera in air that looks into glass sees its radiance thinned by 1/1.5², and the reverse.
        assert!((through(from_air, Transport::Radiance) - 0.96 / 2.25).abs() < 1e-15);
        let from_glass = Sides { here: &glass, there: &air };
        assert!((through(from_glass, Transport::Radiance) - 0.96 * 2.25).abs() < 1e-15);
    }

    #[test]
    fn between_equal_indices_light_goes_straight_on_even_where_the_surface_is_rough() {
        let water = Index::catalogue("water 20C").unwrap();
        let sides = Sides { here: &water, there: &water };
        let wo = DVec3::new(0.6, 0.0, -0.8);
        for alpha in [0.0, 0.5] {
            let scatter = Dielectric::new(alpha).unwrap().sample(wo, sides, 500.0, [0.3, 0.6, 0.0]).unwrap();
            assert_eq!((scatter.wi, scatter.delta, scatter.disperses), (-wo, true, false));
            assert_eq!(scatter.probability, 1.0);
        }
    }

    #[test]
    fn roughness_must_lie_between_0_and_1() {
        for alpha in [-0.1, 1.1, f64::NAN] {
            assert!(Dielectric::new(alpha).unwrap_err().to_string().contains("from 0 to 1"));
        }
    }
}
