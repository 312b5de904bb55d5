//! The profile of a rotationally symmetric surface: a conic with even aspheric terms.

use glam::{DVec2, DVec3};

/// The direction in which light passes the lens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TraceDirection {
    /// Towards +z.
    ToSensor,
    /// Towards −z.
    ToScene,
}

impl TraceDirection {
    /// Returns +1 for light towards the sensor, and −1 for light towards the scene.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::ToSensor => 1.0,
            Self::ToScene => -1.0,
        }
    }

    pub(super) fn reversed(self) -> Self {
        match self {
            Self::ToSensor => Self::ToScene,
            Self::ToScene => Self::ToSensor,
        }
    }

    /// Orders two values, `front` on the scene's side: first that from which the light comes.
    pub(super) fn order(self, front: f64, behind: f64) -> (f64, f64) {
        match self {
            Self::ToSensor => (front, behind),
            Self::ToScene => (behind, front),
        }
    }
}

/// A surface of revolution about the z axis, with the vertex at the origin.
///
/// At the height h, the sag is z(h) = c·h²/(1 + √(1 − (1 + k)c²h²)) + Σ aᵢ h²ⁱ with i ≥ 1. Source:
/// Welford, *Aberrations of Optical Systems*, §2.3.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SurfaceProfile {
    /// Curvature c in 1/mm: positive if the centre of curvature lies towards +z, and 0 for a plane.
    pub curvature_per_mm: f64,
    /// Conic constant k: 0 for a sphere, −1 for a paraboloid.
    pub conic: f64,
    /// Coefficients a₁, a₂, … of h², h⁴, …, where the unit of aᵢ is mm^(1 − 2i). Empty for a conic.
    pub even_terms: Box<[f64]>,
}

/// Maximum number of Newton steps for an aspheric surface. About four steps are usual.
const MAX_ASPHERE_STEPS: usize = 32;

impl SurfaceProfile {
    /// Creates a sphere from its radius in mm: positive towards +z, 0 for a plane, as in files.
    pub fn sphere(radius_mm: f64) -> Self {
        let curvature_per_mm = if radius_mm == 0.0 { 0.0 } else { 1.0 / radius_mm };
        Self { curvature_per_mm, ..Self::default() }
    }

    /// Returns the sag z in mm at a squared height in mm², or NaN where the conic does not extend.
    pub fn sag_mm(&self, height2_mm2: f64) -> f64 {
        let conic = self.curvature_per_mm * height2_mm2 / (1.0 + self.root(height2_mm2));
        conic + height2_mm2 * self.even_terms.iter().rev().fold(0.0, |sum, term| sum * height2_mm2 + term)
    }

    /// Returns the curvature at the vertex in 1/mm, which determines the paraxial power.
    pub fn vertex_curvature_per_mm(&self) -> f64 {
        self.curvature_per_mm + 2.0 * self.even_terms.first().copied().unwrap_or(0.0)
    }

    /// Returns √(1 − (1 + k)c²h²), or 0 if the value under the root differs from 0 by less than
    /// 1e-14: otherwise, rounding could make the root undefined at the equator of a ball.
    fn root(&self, height2_mm2: f64) -> f64 {
        let square = 1.0 - (1.0 + self.conic) * self.curvature_per_mm * self.curvature_per_mm * height2_mm2;
        if square.abs() < 1e-14 { 0.0 } else { square.sqrt() }
    }

    /// Returns dz/d(h²) in 1/mm.
    fn slope(&self, height2_mm2: f64) -> f64 {
        let conic = 0.5 * self.curvature_per_mm / self.root(height2_mm2);
        let terms = self.even_terms.iter().enumerate().rev();
        conic + terms.fold(0.0, |sum, (i, term)| sum * height2_mm2 + (i + 1) as f64 * term)
    }

    /// Returns the unit normal towards +z at a point of the surface.
    pub fn normal(&self, point: DVec3) -> DVec3 {
        self.gradient(point).normalize()
    }

    /// Returns a vector parallel to the gradient of z − z(h): for a conic, that of the quadratic
    /// equation, which is also finite at the equator.
    fn gradient(&self, point: DVec3) -> DVec3 {
        if self.even_terms.is_empty() {
            let c = self.curvature_per_mm;
            return DVec3::new(-c * point.x, -c * point.y, 1.0 - (1.0 + self.conic) * c * point.z);
        }
        let slope = -2.0 * self.slope(point.x * point.x + point.y * point.y);
        DVec3::new(slope * point.x, slope * point.y, 1.0)
    }

    /// Intersects the sheet of the surface that contains the vertex with a line through `origin`
    /// along the unit vector `direction`. Returns the point, in front of `origin` or behind it,
    /// where the light crosses the surface from the scene side to the sensor side (`ToSensor`) or
    /// back (`ToScene`), if there is one.
    pub fn intersect(&self, origin: DVec3, direction: DVec3, travel: TraceDirection) -> Option<DVec3> {
        let conic = self.intersect_conic(origin, direction, travel);
        if self.even_terms.is_empty() {
            return conic;
        }
        let start = conic.unwrap_or_else(|| origin - direction * (origin.z / direction.z));
        newton(start, direction, travel, |place| {
            let (sag_mm, slope) = self.sag_and_slope(place.length_squared());
            (sag_mm, 2.0 * slope * place)
        })
    }

    /// Intersects the line with the conic c(x² + y² + (1 + k)z²) = 2z, by a form of the quadratic
    /// formula that is accurate for nearly flat surfaces. Of up to two points, the function returns
    /// the one where the component of the gradient along the ray has the same sign as `travel`.
    fn intersect_conic(&self, origin: DVec3, direction: DVec3, travel: TraceDirection) -> Option<DVec3> {
        let (c, k) = (self.curvature_per_mm, self.conic);
        // From the point of the line nearest to the vertex, distant origins cause no cancellation.
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

    /// Returns the sag in mm at a squared height in mm², and its derivative dz/d(h²) in 1/mm.
    pub(super) fn sag_and_slope(&self, height2_mm2: f64) -> (f64, f64) {
        (self.sag_mm(height2_mm2), self.slope(height2_mm2))
    }
}

/// Intersects a line with the surface that has this sag in mm and this slope at (x, y), by Newton's
/// method from a point of the line. The light crosses the surface in the direction `travel`.
pub(super) fn newton(
    start: DVec3,
    direction: DVec3,
    travel: TraceDirection,
    sag_and_slope: impl Fn(DVec2) -> (f64, DVec2),
) -> Option<DVec3> {
    let mut point = start;
    for _ in 0..MAX_ASPHERE_STEPS {
        let (sag_mm, slope) = sag_and_slope(point.truncate());
        let gradient = (-slope).extend(1.0).dot(direction);
        let step = (point.z - sag_mm) / gradient;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn profiles() -> Vec<SurfaceProfile> {
        let conic = |curvature_per_mm, conic| SurfaceProfile { curvature_per_mm, conic, even_terms: [].into() };
        let asphere = |even_terms: &[f64]| SurfaceProfile { even_terms: even_terms.into(), ..conic(0.02, -0.5) };
        vec![
            SurfaceProfile::sphere(0.0),
            SurfaceProfile::sphere(50.0),
            SurfaceProfile::sphere(-30.0),
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
                for (travel, sign) in [(TraceDirection::ToSensor, 1.0), (TraceDirection::ToScene, -1.0)] {
                    let direction = sign * DVec3::new(0.1, slope, 1.0).normalize();
                    let origin = DVec3::new(1.0, y, 0.0) - 500.0 * direction;
                    let point = profile.intersect(origin, direction, travel).unwrap();
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
    fn lines_beside_a_ball_and_within_a_plane_miss() {
        let ball = SurfaceProfile::sphere(5.0);
        assert_eq!(ball.intersect(DVec3::new(0.0, 5.1, -9.0), DVec3::Z, TraceDirection::ToSensor), None);
        assert_eq!(
            SurfaceProfile::sphere(0.0).intersect(DVec3::new(0.0, 1.0, -1.0), DVec3::Y, TraceDirection::ToSensor),
            None
        );
        let asphere = SurfaceProfile { even_terms: [0.0, 1e-5].into(), ..ball };
        assert_eq!(asphere.intersect(DVec3::new(0.0, 5.1, -9.0), DVec3::Z, TraceDirection::ToSensor), None);
    }
}
