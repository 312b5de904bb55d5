//! The shape of a surface of revolution: a conic with even aspheric terms.

use glam::DVec3;

use super::trace::Travel;

/// A surface about the z axis with its vertex at the origin:
/// z(h) = c·h²/(1 + √(1 − (1 + k)c²h²)) + Σ aᵢ h²ⁱ, i from 1 (Welford, *Aberrations of Optical Systems*, §2.3).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// c in 1/mm, above 0 where the centre lies towards +z; 0 is a plane.
    pub curvature_per_mm: f64,
    /// k: 0 is a sphere, −1 a paraboloid.
    pub conic: f64,
    /// a₁, a₂, … in mm^(1 − 2i), the coefficients of h², h⁴, …; empty for a conic.
    pub even_terms: Box<[f64]>,
}

/// Steps of Newton's method on an aspheric surface; it takes about four.
const MAX_STEPS: usize = 32;

impl Profile {
    /// A sphere by its radius in mm, above 0 where its centre lies towards +z; 0 is a plane.
    pub fn sphere(radius_mm: f64) -> Self {
        let curvature_per_mm = if radius_mm == 0.0 { 0.0 } else { 1.0 / radius_mm };
        Self { curvature_per_mm, ..Self::default() }
    }

    /// z in mm at a squared distance from the axis in mm²; NaN beyond the conic's reach.
    pub fn sag_mm(&self, height2_mm2: f64) -> f64 {
        let conic = self.curvature_per_mm * height2_mm2 / (1.0 + self.root(height2_mm2));
        conic + height2_mm2 * self.even_terms.iter().rev().fold(0.0, |sum, term| sum * height2_mm2 + term)
    }

    /// The curvature in 1/mm at the vertex, which paraxial rays see.
    pub fn vertex_curvature_per_mm(&self) -> f64 {
        self.curvature_per_mm + 2.0 * self.even_terms.first().copied().unwrap_or(0.0)
    }

    /// √(1 − (1 + k)c²h²); rounding at the equator of a ball does not count.
    fn root(&self, height2_mm2: f64) -> f64 {
        let square = 1.0 - (1.0 + self.conic) * self.curvature_per_mm * self.curvature_per_mm * height2_mm2;
        if square.abs() < 1e-14 { 0.0 } else { square.sqrt() }
    }

    /// dz/d(h²) in 1/mm.
    fn slope(&self, height2_mm2: f64) -> f64 {
        let conic = 0.5 * self.curvature_per_mm / self.root(height2_mm2);
        let terms = self.even_terms.iter().enumerate().rev();
        conic + terms.fold(0.0, |sum, (i, term)| sum * height2_mm2 + (i + 1) as f64 * term)
    }

    /// The unit normal, towards +z, at a point of the surface.
    pub fn normal(&self, point: DVec3) -> DVec3 {
        self.gradient(point).normalize()
    }

    /// Along the gradient of z − z(h): for a conic from its quadratic, which is finite at the equator too.
    fn gradient(&self, point: DVec3) -> DVec3 {
        if self.even_terms.is_empty() {
            let c = self.curvature_per_mm;
            return DVec3::new(-c * point.x, -c * point.y, 1.0 - (1.0 + self.conic) * c * point.z);
        }
        let slope = -2.0 * self.slope(point.x * point.x + point.y * point.y);
        DVec3::new(slope * point.x, slope * point.y, 1.0)
    }

    /// Where the line through `origin` along the unit vector `direction` crosses the sheet of the vertex in the sense of `travel`, on
    /// either side of `origin`; `None` if it does not.
    pub fn meet(&self, origin: DVec3, direction: DVec3, travel: Travel) -> Option<DVec3> {
        let conic = self.meet_conic(origin, direction, travel);
        if self.even_terms.is_empty() {
            return conic;
        }
        let start = conic.unwrap_or_else(|| origin - direction * (origin.z / direction.z));
        self.meet_asphere(start, direction, travel)
    }

    /// The quadratic of the conic c(x² + y² + (1 + k)z²) = 2z along the line, its root by the quotient that keeps its digits on nearly
    /// flat surfaces. Of the two crossings the one in the sense of travel has the gradient's sign along the ray.
    fn meet_conic(&self, origin: DVec3, direction: DVec3, travel: Travel) -> Option<DVec3> {
        let (c, k) = (self.curvature_per_mm, self.conic);
        // From the vertex plane's neighbourhood, so that far origins do not cancel.
        let near = origin - direction * origin.dot(direction);
        let a = c * (1.0 + k * direction.z * direction.z);
        let b = direction.z - c * k * near.z * direction.z;
        let e = c * (near.length_squared() + k * near.z * near.z) - 2.0 * near.z;
        let discriminant = b * b - a * e;
        if discriminant < 0.0 {
            return None;
        }
        let point = near + direction * (e / (b + travel.sign() * discriminant.sqrt()));
        let on_sheet = 1.0 - (1.0 + k) * c * point.z > 0.0;
        (on_sheet && point.is_finite()).then_some(point)
    }

    /// Newton's method along the line.
    fn meet_asphere(&self, start: DVec3, direction: DVec3, travel: Travel) -> Option<DVec3> {
        let mut point = start;
        for _ in 0..MAX_STEPS {
            let gradient = self.gradient(point).dot(direction);
            let step = (point.z - self.sag_mm(point.x * point.x + point.y * point.y)) / gradient;
            point -= direction * step;
            if !point.is_finite() {
                return None;
            }
            if step.abs() <= 1e-14 * (1.0 + point.length()) {
                return (travel.sign() * gradient > 0.0).then_some(point);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profiles() -> Vec<Profile> {
        let conic = |curvature_per_mm, conic| Profile { curvature_per_mm, conic, even_terms: [].into() };
        let asphere = |even_terms: &[f64]| Profile { even_terms: even_terms.into(), ..conic(0.02, -0.5) };
        vec![
            Profile::sphere(0.0),
            Profile::sphere(50.0),
            Profile::sphere(-30.0),
            conic(0.02, -1.0),
            conic(-0.03, -2.5),
            conic(0.01, 3.0),
            asphere(&[0.0, 1e-6, -2e-9]),
            asphere(&[1e-3, -1e-6]),
        ]
    }

    #[test]
    fn a_line_meets_the_surface_where_its_sag_says_from_either_side() {
        for profile in profiles() {
            for (y, slope) in [(0.0, 0.0), (7.0, -0.3), (-12.0, 0.2)] {
                for (travel, sign) in [(Travel::ToSensor, 1.0), (Travel::ToScene, -1.0)] {
                    let direction = sign * DVec3::new(0.1, slope, 1.0).normalize();
                    let origin = DVec3::new(1.0, y, 0.0) - 500.0 * direction;
                    let point = profile.meet(origin, direction, travel).unwrap();
                    let sag = profile.sag_mm(point.x * point.x + point.y * point.y);
                    assert!((point.z - sag).abs() < 1e-12, "{profile:?}: {point} {sag}");
                    assert!((point - origin).cross(direction).length() < 1e-11);
                    let h = 1e-5;
                    let tilt = (profile.sag_mm((point.y + h).powi(2) + point.x * point.x)
                        - profile.sag_mm((point.y - h).powi(2) + point.x * point.x))
                        / (2.0 * h);
                    let normal = profile.normal(point);
                    assert!((normal.y / normal.z + tilt).abs() < 1e-8, "{profile:?}");
                }
            }
        }
    }

    #[test]
    fn a_line_beside_a_ball_misses_it_and_one_in_its_tangent_plane_too() {
        let ball = Profile::sphere(5.0);
        assert_eq!(ball.meet(DVec3::new(0.0, 5.1, -9.0), DVec3::Z, Travel::ToSensor), None);
        assert_eq!(Profile::sphere(0.0).meet(DVec3::new(0.0, 1.0, -1.0), DVec3::Y, Travel::ToSensor), None);
        let asphere = Profile { even_terms: [0.0, 1e-5].into(), ..ball };
        assert_eq!(asphere.meet(DVec3::new(0.0, 5.1, -9.0), DVec3::Z, Travel::ToSensor), None);
    }
}
