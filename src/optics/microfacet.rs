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
