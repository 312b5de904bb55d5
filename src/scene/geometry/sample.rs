//! Points drawn on objects: by area, and as seen from a point.

use std::f64::consts::TAU;

use glam::DVec3;

use super::object::{Aim, Object};
use super::primitive::Primitive;
use super::{Geometry, Hit, SurfaceId, SurfaceSample};
use crate::scene::shape::TriangleRay;

impl Geometry {
    /// Area of an object's surface in m² (one side of rectangles, disks and open meshes); 0 for an unknown object.
    pub fn area(&self, object: u32) -> f64 {
        self.objects.get(object).map_or(0.0, |object| object.area)
    }

    /// A point on an object's surface, uniform by area (only on unequally scaled curved shapes it is not uniform;
    /// `pdf_area` is the density there). `u` is in [0, 1)³.
    ///
    /// # Panics
    /// If there is no such object: the scene's lights name objects that were placed.
    pub fn sample_area(&self, object: u32, u: [f64; 3]) -> SurfaceSample {
        let known = self.objects.get(object).and_then(|object| Some((object, object.piece_at(u[0])?)));
        let (object, surface) = known.expect("a light's object has been placed");
        self.sample_piece(object, surface, [u[1], u[2]])
    }

    fn sample_piece(&self, object: &Object, surface: SurfaceId, u: [f64; 2]) -> SurfaceSample {
        match &self.primitives.list[surface.primitive as usize] {
            Primitive::Analytic(index) => {
                let analytic = &self.primitives.analytic[*index as usize];
                let local = analytic.solid.sample(surface.face, u);
                let found = analytic.placed_surface(local, surface.face);
                let density = analytic.density(surface.face, found.area_scale);
                let pdf_area = density / object.area;
                SurfaceSample { position: found.position, normal: found.normal, surface, pdf_area }
            }
            Primitive::Triangle(triangle) => {
                let [a, b, c] = self.primitives.corners(triangle);
                let root = u[0].sqrt();
                let (to_b, to_c) = (root * (1.0 - u[1]), root * u[1]);
                let position = a + to_b * (b - a) + to_c * (c - a);
                let normal = self.primitives.normal(surface, position);
                SurfaceSample { position, normal, surface, pdf_area: 1.0 / object.area }
            }
        }
    }

    /// A point on an object as a light for the point `from`, with its density per solid angle at `from`; `None`
    /// where the point drawn is seen edge-on, or the object is unknown.
    ///
    /// Spheres are drawn by the cone they fill, right-angled rectangles by their solid angle, others by area. The
    /// point drawn may face away (then it sends nothing) or be hidden.
    pub fn sample_towards(&self, object: u32, from: DVec3, u: [f64; 3]) -> Option<(SurfaceSample, f64)> {
        let entry = self.objects.get(object)?;
        let surface = entry.piece_at(u[0])?;
        match &entry.aim {
            Aim::Sphere { centre, radius } => {
                if let Some(cone) = Cone::new(*centre, *radius, from) {
                    let position = cone.sample(u[1], u[2]);
                    return Some((self.sample_at(entry, surface, position), cone.pdf()));
                }
            }
            Aim::Rectangle(rectangle) => {
                if let Some(seen) = rectangle.seen_from(from) {
                    let position = seen.sample(u[1], u[2]);
                    return Some((self.sample_at(entry, surface, position), seen.pdf()));
                }
            }
            Aim::Area => {}
        }
        let sample = self.sample_piece(entry, surface, [u[1], u[2]]);
        let pdf = per_solid_angle(sample.pdf_area, from, sample.position, sample.normal);
        (pdf.is_finite() && pdf > 0.0).then_some((sample, pdf))
    }

    /// The sample at a given point of an analytic surface.
    fn sample_at(&self, object: &Object, surface: SurfaceId, point: DVec3) -> SurfaceSample {
        match &self.primitives.list[surface.primitive as usize] {
            Primitive::Analytic(index) => {
                let analytic = &self.primitives.analytic[*index as usize];
                let found = analytic.surface(point, surface.face);
                let pdf_area = analytic.density(surface.face, found.area_scale) / object.area;
                SurfaceSample { position: found.position, normal: found.normal, surface, pdf_area }
            }
            Primitive::Triangle(_) => {
                let normal = self.primitives.normal(surface, point);
                SurfaceSample { position: point, normal, surface, pdf_area: 1.0 / object.area }
            }
        }
    }

    /// Density per solid angle at `from` with which `sample_towards` draws the point where a ray from there hit
    /// the object; 0 if it cannot.
    pub fn pdf_towards(&self, object: u32, from: DVec3, hit: &Hit) -> f64 {
        let Some(entry) = self.objects.get(object).filter(|_| hit.object == object) else { return 0.0 };
        match &entry.aim {
            Aim::Sphere { centre, radius } => {
                if let Some(cone) = Cone::new(*centre, *radius, from) {
                    return cone.pdf();
                }
            }
            Aim::Rectangle(rectangle) => {
                if let Some(seen) = rectangle.seen_from(from) {
                    return seen.pdf();
                }
            }
            Aim::Area => {}
        }
        let sample = self.sample_at(entry, hit.surface, hit.position);
        let pdf = per_solid_angle(sample.pdf_area, from, hit.position, hit.normal);
        if pdf.is_finite() { pdf } else { 0.0 }
    }
}

/// A density per area seen from a point, per solid angle.
fn per_solid_angle(pdf_area: f64, from: DVec3, position: DVec3, normal: DVec3) -> f64 {
    let offset = position - from;
    let squared = offset.length_squared();
    pdf_area * squared * squared.sqrt() / offset.dot(normal).abs()
}

/// The cone of directions in which a sphere is seen from outside.
struct Cone {
    centre: DVec3,
    radius: f64,
    /// Unit vector from the sphere's centre to the point that looks at it.
    axis: DVec3,
    sin_max: f64,
    cos_max: f64,
    /// 1 − cos of the cone's half-angle, without cancellation.
    one_minus_cos_max: f64,
}

impl Cone {
    /// `None` inside the sphere.
    fn new(centre: DVec3, radius: f64, from: DVec3) -> Option<Self> {
        let offset = from - centre;
        let distance = offset.length();
        if distance <= radius {
            return None;
        }
        let sin_max = radius / distance;
        let cos_max = (1.0 - radius / distance).sqrt() * (1.0 + sin_max).sqrt();
        let one_minus_cos_max = sin_max * sin_max / (1.0 + cos_max);
        Some(Self { centre, radius, axis: offset / distance, sin_max, cos_max, one_minus_cos_max })
    }

    /// Per solid angle, uniform over the cone.
    fn pdf(&self) -> f64 {
        1.0 / (TAU * self.one_minus_cos_max)
    }

    /// The sphere's point in a direction uniform over the cone.
    ///
    /// With θ the angle off the axis and s = (sin θ / sin θ_max)², the point lies α off the axis as seen from the
    /// centre, where cos α = sin θ √s + cos θ √(1−s) and sin α = cos θ √s − sin θ √(1−s); s follows from u
    /// without cancellation, so that far and tiny spheres are sampled as well as near ones.
    fn sample(&self, u: f64, turn: f64) -> DVec3 {
        let one_minus_cos = u * self.one_minus_cos_max;
        let s = (u * (2.0 - one_minus_cos) / (1.0 + self.cos_max)).min(1.0);
        let (root, other) = (s.sqrt(), (1.0 - s).sqrt());
        let (sin, cos) = (self.sin_max * root, 1.0 - one_minus_cos);
        let (cos_alpha, sin_alpha) = (sin * root + cos * other, cos * root - sin * other);
        let (across_x, across_y) = TriangleRay::new(DVec3::ZERO, self.axis).across();
        let (turn_sin, turn_cos) = (TAU * turn).sin_cos();
        let across = turn_cos * across_x + turn_sin * across_y;
        self.centre + self.radius * (cos_alpha * self.axis + sin_alpha * across)
    }
}
