//! Sampling of points on objects: by area, and by solid angle from a reference point.

use std::f64::consts::TAU;

use glam::DVec3;

use super::hit::{Hit, SurfaceId, SurfaceSample};
use super::object::{ObjectSurface, ShapeSampling};
use super::primitive::Primitive;
use super::shape::TriangleRay;
use super::world::Geometry;
use abbe_spectra::math::elementary::sin_cos;

impl Geometry {
    /// Returns an object's area in m² (one side of flat shapes and open meshes), 0 if unknown.
    pub fn area(&self, object: u32) -> f64 {
        self.objects.get(object).map_or(0.0, |object| object.area)
    }

    /// Samples a point on the surface of an object, with `u` in [0, 1). The distribution is uniform
    /// by area, except on curved shapes with unequal scaling; `pdf_area` is the actual density.
    /// Panics if the object does not exist: the lights of a scene refer to placed objects only.
    pub fn sample_area(&self, object: u32, u: [f64; 3]) -> SurfaceSample {
        let known = self.objects.get(object).and_then(|object| Some((object, object.face_at(u[0])?)));
        let (object, surface) = known.expect("the objects of lights are placed");
        self.sample_face(object, surface, [u[1], u[2]])
    }

    fn sample_face(&self, object: &ObjectSurface, surface: SurfaceId, u: [f64; 2]) -> SurfaceSample {
        match &self.primitives.list[surface.primitive as usize] {
            Primitive::Analytic(index) => {
                let analytic = &self.primitives.analytic[*index as usize];
                let local = analytic.solid.sample(surface.face, u);
                let found = analytic.placed_surface(local, surface.face);
                let pdf_area = analytic.relative_pdf(surface.face, found.area_scale) / object.area;
                SurfaceSample { position: found.position, normal: found.normal, surface, pdf_area }
            }
            Primitive::Triangle(_) | Primitive::Instance(_) => {
                let [a, b, c] = self.primitives.triangle_corners(surface.primitive);
                let root = u[0].sqrt();
                let (to_b, to_c) = (root * (1.0 - u[1]), root * u[1]);
                let position = a + to_b * (b - a) + to_c * (c - a);
                let normal = self.primitives.normal(surface, position);
                SurfaceSample { position, normal, surface, pdf_area: 1.0 / object.area }
            }
        }
    }

    /// Samples a point on a luminous object for the illumination of the point `from`. Returns the
    /// point and its density per solid angle at `from`.
    ///
    /// The sampling is uniform by solid angle on a sphere and on a rectangle with right angles, and
    /// uniform by area on other shapes. The sampled point may face away from `from` or be occluded.
    /// Returns `None` if the point is seen edge-on or the object does not exist.
    pub fn sample_solid_angle(&self, object: u32, from: DVec3, u: [f64; 3]) -> Option<(SurfaceSample, f64)> {
        let entry = self.objects.get(object)?;
        let surface = entry.face_at(u[0])?;
        match &entry.sampling {
            ShapeSampling::Sphere { centre, radius } => {
                if let Some(cone) = SubtendedCone::new(*centre, *radius, from) {
                    let position = cone.sample(u[1], u[2]);
                    return Some((self.sample_at(entry, surface, position), cone.pdf()));
                }
            }
            ShapeSampling::Rectangle(rectangle) => {
                if let Some(seen) = rectangle.seen_from(from) {
                    let position = seen.sample(u[1], u[2]);
                    return Some((self.sample_at(entry, surface, position), seen.pdf()));
                }
            }
            ShapeSampling::Area => {}
        }
        let sample = self.sample_face(entry, surface, [u[1], u[2]]);
        let pdf = per_solid_angle(sample.pdf_area, from, sample.position, sample.normal);
        (pdf.is_finite() && pdf > 0.0).then_some((sample, pdf))
    }

    fn sample_at(&self, object: &ObjectSurface, surface: SurfaceId, point: DVec3) -> SurfaceSample {
        match &self.primitives.list[surface.primitive as usize] {
            Primitive::Analytic(index) => {
                let analytic = &self.primitives.analytic[*index as usize];
                let found = analytic.surface(point, surface.face);
                let pdf_area = analytic.relative_pdf(surface.face, found.area_scale) / object.area;
                SurfaceSample { position: found.position, normal: found.normal, surface, pdf_area }
            }
            Primitive::Triangle(_) | Primitive::Instance(_) => {
                let normal = self.primitives.normal(surface, point);
                SurfaceSample { position: point, normal, surface, pdf_area: 1.0 / object.area }
            }
        }
    }

    /// Returns the density, per solid angle at `from`, with which `sample_solid_angle` samples the
    /// point of a hit. It is 0 if the point cannot be sampled.
    pub fn pdf_solid_angle(&self, object: u32, from: DVec3, hit: &Hit) -> f64 {
        let Some(entry) = self.objects.get(object).filter(|_| hit.object == object) else { return 0.0 };
        match &entry.sampling {
            ShapeSampling::Sphere { centre, radius } => {
                if let Some(cone) = SubtendedCone::new(*centre, *radius, from) {
                    return cone.pdf();
                }
            }
            ShapeSampling::Rectangle(rectangle) => {
                if let Some(seen) = rectangle.seen_from(from) {
                    return seen.pdf();
                }
            }
            ShapeSampling::Area => {}
        }
        let sample = self.sample_at(entry, hit.surface, hit.position);
        let pdf = per_solid_angle(sample.pdf_area, from, hit.position, hit.normal);
        if pdf.is_finite() { pdf } else { 0.0 }
    }
}

/// Converts a density per area into a density per solid angle at `from`.
fn per_solid_angle(pdf_area: f64, from: DVec3, position: DVec3, normal: DVec3) -> f64 {
    let offset = position - from;
    let squared = offset.length_squared();
    pdf_area * squared * squared.sqrt() / offset.dot(normal).abs()
}

/// The cone of directions that a sphere subtends at an outside point.
struct SubtendedCone {
    centre: DVec3,
    radius: f64,
    /// From the sphere's centre to the reference point.
    axis: DVec3,
    sin_max: f64,
    cos_max: f64,
    /// 1 − cos of the cone's half-angle, computed without cancellation.
    one_minus_cos_max: f64,
}

impl SubtendedCone {
    /// Largest distance from the sphere, relative to the coordinates, of a point on it, from which
    /// the sphere must not be visible.
    const ON_SPHERE: f64 = 1e-12;

    /// Creates the cone, or returns `None` if `from` lies inside the sphere or on it.
    fn new(centre: DVec3, radius: f64, from: DVec3) -> Option<Self> {
        let offset = from - centre;
        let distance = offset.length();
        let largest = radius.max(centre.abs().max_element());
        if distance <= radius + Self::ON_SPHERE * largest {
            return None;
        }
        let sin_max = radius / distance;
        let cos_max = (1.0 - radius / distance).sqrt() * (1.0 + sin_max).sqrt();
        let one_minus_cos_max = sin_max * sin_max / (1.0 + cos_max);
        Some(Self { centre, radius, axis: offset / distance, sin_max, cos_max, one_minus_cos_max })
    }

    /// The uniform density per solid angle in the cone.
    fn pdf(&self) -> f64 {
        1.0 / (TAU * self.one_minus_cos_max)
    }

    /// Samples a direction uniformly in the cone. Returns the point of the sphere in this
    /// direction.
    ///
    /// At `from`, θ is the angle between the direction and the line to the sphere's centre. At the
    /// centre, α is the angle between `axis` and the direction to the sampled point. If s = (sin θ
    /// / sin θ_max)², these angles satisfy cos α = sin θ √s + cos θ √(1−s) and sin α = cos θ √s −
    /// sin θ √(1−s). The number s is computed from `u` without cancellation, so distant and tiny
    /// spheres are sampled as accurately as near ones.
    fn sample(&self, u: f64, turn: f64) -> DVec3 {
        let one_minus_cos = u * self.one_minus_cos_max;
        let s = (u * (2.0 - one_minus_cos) / (1.0 + self.cos_max)).min(1.0);
        let (root, other) = (s.sqrt(), (1.0 - s).sqrt());
        let (sin, cos) = (self.sin_max * root, 1.0 - one_minus_cos);
        let (cos_alpha, sin_alpha) = (sin * root + cos * other, cos * root - sin * other);
        let (across_x, across_y) = TriangleRay::new(DVec3::ZERO, self.axis).across();
        let (turn_sin, turn_cos) = sin_cos(TAU * turn);
        let across = turn_cos * across_x + turn_sin * across_y;
        self.centre + self.radius * (cos_alpha * self.axis + sin_alpha * across)
    }
}
