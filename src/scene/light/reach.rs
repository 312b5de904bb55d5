//! Which part of a ray a light can shine on: where it pays to look for light that a medium scatters into the ray.

use super::{Emitter, Light, World};
use crate::scene::geometry::Ray;
use glam::DVec3;

/// A part of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Where it begins, in m.
    pub from: f64,
    /// Where it ends, in m.
    pub to: f64,
    /// The point around which the light gathers, falling off with the square of the distance.
    pub pivot: Option<DVec3>,
}

impl Light {
    /// The part of the ray between `from` and `to` (m) that the light can shine on; `u` draws the pivot of lights with extent.
    pub fn reach(&self, world: World<'_>, ray: &Ray, (from, to): (f64, f64), u: [f64; 3]) -> Option<Reach> {
        let whole = |pivot| Some(Reach { from, to, pivot });
        match &self.emitter {
            Emitter::Point(light) => whole(Some(light.at)),
            Emitter::Area(light) => whole(Some(world.geometry.sample_area(light.object, u).position)),
            Emitter::Volume(light) => whole(Some(light.draw(u).0)),
            Emitter::Directional(_) | Emitter::Environment(_) => whole(None),
            Emitter::Spot(light) => {
                let (from, to) = inside_cone(ray, (from, to), light.at(), light.axis(), light.one_minus_cos())?;
                Some(Reach { from, to, pivot: Some(light.at()) })
            }
            Emitter::Beam(light) => {
                let (from, to) = match light.cone() {
                    None => inside_cylinder(ray, (from, to), light.centre(), light.axis(), light.radius_m())?,
                    Some((apex, one_minus_cos)) => inside_cone(ray, (from, to), apex, light.axis(), one_minus_cos)?,
                };
                Some(Reach { from, to, pivot: None })
            }
        }
    }
}

/// The part of the ray inside a cone around `axis`, given by 1 − cos of its half-angle.
fn inside_cone(ray: &Ray, span: (f64, f64), apex: DVec3, axis: DVec3, one_minus_cos: f64) -> Option<(f64, f64)> {
    let cos2 = (1.0 - one_minus_cos).powi(2);
    let offset = ray.origin - apex;
    let (along, across) = (ray.direction.dot(axis), offset.dot(axis));
    let quadratic = [
        along * along - cos2,
        along * across - cos2 * ray.direction.dot(offset),
        across * across - cos2 * offset.length_squared(),
    ];
    let inside = |t: f64| {
        let place = offset + t * ray.direction;
        place.dot(axis) > 0.0 && place.dot(axis).powi(2) >= cos2 * place.length_squared()
    };
    between_roots(quadratic, span, inside)
}

/// The part of the ray inside the half of a cylinder around `axis` that lies in front of `centre`.
fn inside_cylinder(ray: &Ray, span: (f64, f64), centre: DVec3, axis: DVec3, radius: f64) -> Option<(f64, f64)> {
    let flat = |v: DVec3| v - v.dot(axis) * axis;
    let offset = ray.origin - centre;
    let (across, way) = (flat(offset), flat(ray.direction));
    let quadratic = [way.length_squared(), across.dot(way), across.length_squared() - radius * radius];
    let (mut from, mut to) =
        between_roots(quadratic, span, |t| (across + t * way).length_squared() <= radius * radius)?;
    // In front of the lamp.
    let (height, climb) = (offset.dot(axis), ray.direction.dot(axis));
    let level = -height / climb;
    if climb > 0.0 {
        from = from.max(level);
    } else if climb < 0.0 {
        to = to.min(level);
    } else if height <= 0.0 {
        return None;
    }
    (from < to).then_some((from, to))
}

/// The one part of the span, between the roots of a t² + 2 b t + c, whose inside is `inside`.
fn between_roots([a, b, c]: [f64; 3], (from, to): (f64, f64), inside: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let discriminant = b * b - a * c;
    let mut ends = [from, from, from, to];
    if discriminant > 0.0 {
        let q = -b - discriminant.sqrt().copysign(b);
        let roots = [q / a, c / q].map(|root| if root.is_finite() { root.clamp(from, to) } else { from });
        ends = [from, roots[0].min(roots[1]), roots[0].max(roots[1]), to];
    }
    let mut span: Option<(f64, f64)> = None;
    for pair in ends.windows(2).filter(|pair| pair[0] < pair[1]) {
        if inside(0.5 * (pair[0] + pair[1])) {
            span = Some((span.map_or(pair[0], |span| span.0), pair[1]));
        }
    }
    span
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_across_a_cone_and_a_cylinder_is_cut_where_it_enters_and_leaves() {
        let ray = Ray::new(DVec3::new(-5.0, 0.0, 2.0), DVec3::X);
        let half: f64 = 0.2;
        let (from, to) = inside_cone(&ray, (0.0, 20.0), DVec3::ZERO, DVec3::Z, 1.0 - half.cos()).unwrap();
        let width = 2.0 * half.tan();
        assert!((from - (5.0 - width)).abs() < 1e-12 && (to - (5.0 + width)).abs() < 1e-12);
        let (from, to) = inside_cylinder(&ray, (0.0, 5.1), DVec3::ZERO, DVec3::Z, 0.3).unwrap();
        assert!((from - 4.7).abs() < 1e-12 && (to - 5.1).abs() < 1e-12);
        assert_eq!(
            inside_cylinder(&ray, (0.0, 20.0), DVec3::new(0.0, 0.0, 3.0), DVec3::Z, 0.3),
            None,
            "behind the lamp"
        );
        let behind = Ray::new(DVec3::new(-5.0, 0.0, -2.0), DVec3::X);
        assert_eq!(inside_cone(&behind, (0.0, 20.0), DVec3::ZERO, DVec3::Z, 1.0 - half.cos()), None, "the other nappe");
    }

    #[test]
    fn a_ray_along_a_beam_is_inside_from_the_lamp_on() {
        let ray = Ray::new(DVec3::new(0.1, 0.0, -4.0), DVec3::Z);
        assert_eq!(inside_cylinder(&ray, (0.0, 10.0), DVec3::ZERO, DVec3::Z, 0.3), Some((4.0, 10.0)));
    }
}
