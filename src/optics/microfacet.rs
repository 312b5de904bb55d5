//! The GGX distribution of microfacets (Trowbridge & Reitz 1975; Walter, Marschner, Li & Torrance 2007), isotropic, with
//! Smith's height-correlated masking and shadowing (Heitz 2014, Understanding the masking-shadowing function).
//!
//! Directions are unit vectors in the surface's frame, z along the normal on the side that is looked at; cosines are ≥ 0.
//! Masking functions are given divided by the cosines that they are used with: the quotients stay finite at grazing, where
//! both go to 0.

use std::f64::consts::PI;

use glam::DVec3;

/// A rough interface below this counts as smooth; materials that cannot be smooth are held at it. The lobe is then 0.06° wide,
/// far below what a light or a pixel resolves.
pub const MIN_ALPHA: f64 = 1e-3;

/// The GGX distribution of one roughness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    alpha: f64,
}

impl Ggx {
    /// A distribution of roughness `alpha`, held within \[[`MIN_ALPHA`], 1\].
    pub fn new(alpha: f64) -> Self {
        Self { alpha: alpha.clamp(MIN_ALPHA, 1.0) }
    }

    /// The roughness: the root mean square slope is of this order.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Density D(m) of microfacet normals, in 1/sr per unit of macroscopic area: ∫ D·cosθ_m dω = 1.
    pub fn density(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let a2 = self.alpha * self.alpha;
        let t = m.z * m.z * a2 + (m.x * m.x + m.y * m.y);
        a2 / (PI * t * t)
    }

    /// √(α² sin²θ + cos²θ): with it, Smith's G₁ = 2cosθ/(cosθ + s).
    fn slant(&self, cos: f64) -> f64 {
        let a2 = self.alpha * self.alpha;
        (a2 + (1.0 - a2) * cos * cos).sqrt()
    }

    /// G₁(w)/cosθ: the visible fraction of the facets, over the cosine.
    pub fn g1_per_cos(&self, cos: f64) -> f64 {
        2.0 / (cos + self.slant(cos))
    }

    /// G₂(o, i)/(cosθ_o·cosθ_i): the fraction of the facets seen from both, over the cosines.
    pub fn g2_per_cos(&self, cos_o: f64, cos_i: f64) -> f64 {
        2.0 / (cos_o * self.slant(cos_i) + cos_i * self.slant(cos_o))
    }

    /// What mirroring facets of normal `m` (the half vector) scatter, in 1/sr and still without Fresnel's factor:
    /// D·G₂/(4·cosθ_o·cosθ_i).
    pub fn reflected_density(&self, m: DVec3, cos_o: f64, cos_i: f64) -> f64 {
        0.25 * self.density(m) * self.g2_per_cos(cos_o, cos_i)
    }

    /// G₂(o, i)/G₁(o): of the light that left visible facets, the fraction that gets away without meeting another.
    pub fn escaping(&self, cos_o: f64, cos_i: f64) -> f64 {
        let (o, i) = (self.slant(cos_o), self.slant(cos_i));
        cos_i * (cos_o + o) / (cos_o * i + cos_i * o)
    }

    /// 1 − G₂(o, i)/G₁(o), without the subtraction: the fraction that meets another facet, and that this model of single
    /// scattering loses.
    pub fn shadowed(&self, cos_o: f64, cos_i: f64) -> f64 {
        let (o, i) = (self.slant(cos_o), self.slant(cos_i));
        let sin2 = (1.0 - cos_i) * (1.0 + cos_i);
        cos_o * self.alpha * self.alpha * sin2 / ((i + cos_i) * (cos_o * i + cos_i * o))
    }

    /// Density, in 1/sr, of the normals that [`Self::sample_visible`] draws: D(m)·G₁(w)·(w·m)/cosθ_w.
    pub fn visible_density(&self, w: DVec3, m: DVec3) -> f64 {
        self.g1_per_cos(w.z) * self.density(m) * w.dot(m).max(0.0)
    }

    /// Draws a facet normal as seen from `w` (w.z ≥ 0), by stretching the facets into a hemisphere and choosing a point of its
    /// projection (Heitz 2018, Sampling the GGX distribution of visible normals). `u` and `v` lie in \[0, 1).
    pub fn sample_visible(&self, w: DVec3, u: f64, v: f64) -> DVec3 {
        let stretched = DVec3::new(self.alpha * w.x, self.alpha * w.y, w.z).normalize();
        let across = stretched.x * stretched.x + stretched.y * stretched.y;
        let t1 = if across > 0.0 { DVec3::new(-stretched.y, stretched.x, 0.0) / across.sqrt() } else { DVec3::X };
        let t2 = stretched.cross(t1);
        let radius = u.sqrt();
        let (sin, cos) = (2.0 * PI * v).sin_cos();
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

    /// ∫ f(m) dω over the upper hemisphere, by the midpoint rule in φ and y, where x = 1 − y² = tan²θ/(α² + tan²θ) follows
    /// the distribution and y spreads its far end.
    fn over_facets(alpha: f64, f: impl Fn(DVec3) -> f64) -> f64 {
        const STEPS: usize = 400;
        let mut sum = 0.0;
        for i in 0..STEPS {
            let y = (i as f64 + 0.5) / STEPS as f64;
            let x = 1.0 - y * y;
            let tan2 = alpha * alpha * x / (y * y);
            let cos2 = 1.0 / (1.0 + tan2);
            // dω = sinθ dθ dφ = ½cos³θ d(tan²θ) dφ.
            let measure = 2.0 * y * 0.5 * cos2 * cos2.sqrt() * alpha * alpha / (y * y * y * y);
            for j in 0..STEPS {
                let (sin_phi, cos_phi) = (2.0 * PI * (j as f64 + 0.5) / STEPS as f64).sin_cos();
                let sin = (1.0 - cos2).sqrt();
                let m = DVec3::new(sin * cos_phi, sin * sin_phi, cos2.sqrt());
                sum += measure * 2.0 * PI / (STEPS * STEPS) as f64 * f(m);
            }
        }
        sum
    }

    #[test]
    fn facets_cover_the_surface_exactly_once() {
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            let area = over_facets(alpha, |m| ggx.density(m) * m.z);
            assert!((area - 1.0).abs() < 1e-6, "alpha {alpha}: {area}");
        }
    }

    #[test]
    fn visible_facets_cover_what_is_seen_exactly_once() {
        // The definition of G₁: ∫ G₁·max(0, w·m)·D dω_m = cosθ_w.
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            for cos in [1.0, 0.7, 0.3, 0.1_f64] {
                let w = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let mass = over_facets(alpha, |m| ggx.visible_density(w, m));
                assert!((mass - 1.0).abs() < 1e-5, "alpha {alpha}, cosine {cos}: {mass}");
            }
        }
    }

    #[test]
    fn what_escapes_and_what_is_shadowed_add_up() {
        for alpha in ALPHAS {
            let ggx = Ggx::new(alpha);
            for cos_o in [1.0, 0.5, 0.01, 1e-9] {
                for cos_i in [1.0, 0.6, 0.02, 1e-7] {
                    let sum = ggx.escaping(cos_o, cos_i) + ggx.shadowed(cos_o, cos_i);
                    assert!((sum - 1.0).abs() < 1e-14, "alpha {alpha}: {sum}");
                    let quotient = ggx.g2_per_cos(cos_o, cos_i) * cos_i / ggx.g1_per_cos(cos_o);
                    assert!((quotient - ggx.escaping(cos_o, cos_i)).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn light_along_the_normal_is_never_shadowed() {
        assert_eq!(Ggx::new(0.5).shadowed(0.3, 1.0), 0.0);
        assert_eq!(Ggx::new(0.5).escaping(1.0, 1.0), 1.0);
    }

    #[test]
    fn drawn_facets_face_the_viewer_and_the_sky() {
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
