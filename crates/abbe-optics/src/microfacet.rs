//! The isotropic GGX distribution of microfacet normals, with Smith's height-correlated masking and
//! shadowing.
//!
//! Sources: Trowbridge & Reitz 1975; Walter, Marschner, Li & Torrance, "Microfacet models for
//! refraction through rough surfaces", 2007; Heitz, "Understanding the masking-shadowing function
//! in microfacet-based BRDFs", 2014.
//!
//! Directions are unit vectors in the local frame of the surface, with z along the normal on the
//! side of the viewer, so all cosines are ≥ 0. The functions return masking functions divided by
//! the cosines in the denominator of the BSDF, because the quotients stay finite at grazing angles.

use abbe_spectra::math::elementary::sin_cos;
use std::f64::consts::PI;

use glam::DVec3;

/// Smallest roughness α of a rough interface, whose lobe of 0.06° is too narrow for lights and
/// pixels. Below, a material is smooth, or is raised to it if it has no smooth form.
pub const MIN_ALPHA: f64 = 1e-3;

/// The GGX distribution for one roughness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    alpha: f64,
}

impl Ggx {
    /// Creates a distribution of roughness `alpha`, clamped to \[[`MIN_ALPHA`], 1\].
    pub fn new(alpha: f64) -> Self {
        Self { alpha: alpha.clamp(MIN_ALPHA, 1.0) }
    }

    /// Returns the roughness α, which is of the order of the root mean square slope of the surface.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Returns the density D(m) of normals in 1/sr, normalised to ∫ D(m)·cosθ_m dω_m = 1.
    pub fn eval(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let a2 = self.alpha * self.alpha;
        let t = m.z * m.z * a2 + (m.x * m.x + m.y * m.y);
        a2 / (PI * t * t)
    }

    /// Returns s = √(α² sin²θ + cos²θ). Smith's masking function is G₁ = 2cosθ/(cosθ + s).
    fn smith_root(&self, cos: f64) -> f64 {
        let a2 = self.alpha * self.alpha;
        (a2 + (1.0 - a2) * cos * cos).sqrt()
    }

    /// Returns G₁(w)/cosθ, where G₁ is Smith's masking function.
    pub(crate) fn g1_per_cos(&self, cos: f64) -> f64 {
        2.0 / (cos + self.smith_root(cos))
    }

    /// Returns the height-correlated masking-shadowing G₂(o, i)/(cosθ_o·cosθ_i).
    pub(crate) fn g2_per_cos(&self, cos_o: f64, cos_i: f64) -> f64 {
        2.0 / (cos_o * self.smith_root(cos_i) + cos_i * self.smith_root(cos_o))
    }

    /// Returns D·G₂/(4·cosθ_o·cosθ_i) in 1/sr for the half vector `m`: the reflection lobe without
    /// the Fresnel factor (Walter et al. 2007, equation 20).
    pub(crate) fn reflection_lobe(&self, m: DVec3, cos_o: f64, cos_i: f64) -> f64 {
        0.25 * self.eval(m) * self.g2_per_cos(cos_o, cos_i)
    }

    /// Returns G₂(o, i)/G₁(o): the fraction of the light that the visible facets reflect which
    /// leaves the surface without hitting another facet.
    pub fn g2_over_g1(&self, cos_o: f64, cos_i: f64) -> f64 {
        let (o, i) = (self.smith_root(cos_o), self.smith_root(cos_i));
        cos_i * (cos_o + o) / (cos_o * i + cos_i * o)
    }

    /// Returns 1 − G₂(o, i)/G₁(o), which a model of single scattering loses, without cancellation.
    pub(crate) fn shadowed_fraction(&self, cos_o: f64, cos_i: f64) -> f64 {
        let (o, i) = (self.smith_root(cos_o), self.smith_root(cos_i));
        let sin2 = (1.0 - cos_i) * (1.0 + cos_i);
        cos_o * self.alpha * self.alpha * sin2 / ((i + cos_i) * (cos_o * i + cos_i * o))
    }

    /// Returns the pdf per solid angle of [`Self::sample_visible`]: D(m)·G₁(w)·(w·m)/cosθ_w.
    pub fn visible_pdf(&self, w: DVec3, m: DVec3) -> f64 {
        self.g1_per_cos(w.z) * self.eval(m) * w.dot(m).max(0.0)
    }

    /// Samples a microfacet normal that is visible from the direction `w` with w.z ≥ 0, by `u` and
    /// `v` in \[0, 1). The GGX ellipsoid is stretched into a hemisphere, whose projection along the
    /// view direction is sampled, and the normal is transformed back (Heitz, "Sampling the GGX
    /// distribution of visible normals", 2018).
    pub fn sample_visible(&self, w: DVec3, u: f64, v: f64) -> DVec3 {
        let stretched = DVec3::new(self.alpha * w.x, self.alpha * w.y, w.z).normalize();
        let across = stretched.x * stretched.x + stretched.y * stretched.y;
        let t1 = if across > 0.0 { DVec3::new(-stretched.y, stretched.x, 0.0) / across.sqrt() } else { DVec3::X };
        let t2 = stretched.cross(t1);
        let radius = u.sqrt();
        let (sin, cos) = sin_cos(2.0 * PI * v);
        let p1 = radius * cos;
        let blend = 0.5 * (1.0 + stretched.z);
        let p2 = (1.0 - blend) * (1.0 - p1 * p1).max(0.0).sqrt() + blend * radius * sin;
        let p3 = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
        let n = t1 * p1 + t2 * p2 + stretched * p3;
        DVec3::new(self.alpha * n.x, self.alpha * n.y, n.z.max(f64::MIN_POSITIVE)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALPHAS: [f64; 4] = [0.02, 0.1, 0.5, 1.0];

    /// Integrates f(m) over the hemisphere by the midpoint rule in φ and y, with tan²θ/(α² + tan²θ)
    /// = x = 1 − y². GGX is uniform in x, and steps in y resolve its tail.
    fn over_facets(alpha: f64, f: impl Fn(DVec3) -> f64) -> f64 {
        const QUADRATURE_STEPS: usize = 400;
        let mut sum = 0.0;
        for i in 0..QUADRATURE_STEPS {
            let y = (i as f64 + 0.5) / QUADRATURE_STEPS as f64;
            let x = 1.0 - y * y;
            let tan2 = alpha * alpha * x / (y * y);
            let cos2 = 1.0 / (1.0 + tan2);
            // dω = sinθ dθ dφ = ½cos³θ d(tan²θ) dφ.
            let measure = 2.0 * y * 0.5 * cos2 * cos2.sqrt() * alpha * alpha / (y * y * y * y);
            for j in 0..QUADRATURE_STEPS {
                let (sin_phi, cos_phi) = (2.0 * PI * (j as f64 + 0.5) / QUADRATURE_STEPS as f64).sin_cos();
                let sin = (1.0 - cos2).sqrt();
                let m = DVec3::new(sin * cos_phi, sin * sin_phi, cos2.sqrt());
                sum += measure * 2.0 * PI / (QUADRATURE_STEPS * QUADRATURE_STEPS) as f64 * f(m);
            }
        }
        sum
    }

    #[test]
    fn normals_integrate_to_the_macroscopic_area() {
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            let area = over_facets(alpha, |m| ggx.eval(m) * m.z);
            assert!((area - 1.0).abs() < 1e-6, "alpha {alpha}: {area}");
        }
    }

    /// Checks the definition of G₁: ∫ G₁·max(0, w·m)·D dω_m = cosθ_w.
    #[test]
    fn visible_normals_integrate_to_the_projected_area() {
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            for cos in [1.0, 0.7, 0.3, 0.1_f64] {
                let w = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let mass = over_facets(alpha, |m| ggx.visible_pdf(w, m));
                assert!((mass - 1.0).abs() < 1e-5, "alpha {alpha}, cosine {cos}: {mass}");
            }
        }
    }

    #[test]
    fn g2_over_g1_and_shadowed_fraction_sum_to_one() {
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            for cos_o in [1.0, 0.5, 0.01, 1e-9] {
                for cos_i in [1.0, 0.6, 0.02, 1e-7] {
                    let sum = ggx.g2_over_g1(cos_o, cos_i) + ggx.shadowed_fraction(cos_o, cos_i);
                    assert!((sum - 1.0).abs() < 1e-14, "alpha {alpha}: {sum}");
                    let quotient = ggx.g2_per_cos(cos_o, cos_i) * cos_i / ggx.g1_per_cos(cos_o);
                    assert!((quotient - ggx.g2_over_g1(cos_o, cos_i)).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn light_along_the_normal_is_never_shadowed() {
        assert_eq!(Ggx::new(0.5).shadowed_fraction(0.3, 1.0), 0.0);
        assert_eq!(Ggx::new(0.5).g2_over_g1(1.0, 1.0), 1.0);
    }

    #[test]
    fn sampled_normals_face_the_viewer_and_the_outside() {
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            for cos in [1.0, 0.5, 1e-6, 0.0_f64] {
                let w = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                for i in 0..100 {
                    let (u, v) = (f64::from(i) / 100.0, f64::from(i * 37 % 100) / 100.0);
                    let m = ggx.sample_visible(w, u, v);
                    assert!((m.length() - 1.0).abs() < 1e-14 && m.z >= 0.0 && w.dot(m) >= -1e-15, "{m}");
                }
            }
        }
    }
}
