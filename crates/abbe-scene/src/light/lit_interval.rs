//! The part of a ray that light can reach, the range of direct lighting in a medium.

use crate::geometry::Ray;
use glam::DVec3;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LitInterval {
    /// The distance along the ray at which the part begins, in m.
    pub from: f64,
    pub to: f64,
    /// The centre of equiangular sampling (Kulla & Fajardo 2012), if the irradiance is inversely
    /// proportional to the square of the distance from such a point.
    pub pivot: Option<DVec3>,
}

/// The part of a ray inside a cone around the unit vector `axis`. If the half-angle exceeds 90°,
/// the ray may leave the cone and enter it again; the part then contains the gap.
pub(super) fn inside_cone(
    ray: &Ray,
    span: (f64, f64),
    apex: DVec3,
    axis: DVec3,
    one_minus_cos: f64,
) -> Option<(f64, f64)> {
    let cos = 1.0 - one_minus_cos;
    let cos2 = cos * cos;
    let offset = ray.origin - apex;
    let (along, across) = (ray.direction.dot(axis), offset.dot(axis));
    let quadratic = [
        along * along - cos2,
        along * across - cos2 * ray.direction.dot(offset),
        across * across - cos2 * offset.length_squared(),
    ];
    let inside = |t: f64| {
        let place = offset + t * ray.direction;
        place.dot(axis) >= cos * place.length()
    };
    between_roots(quadratic, span, inside)
}

/// The part of a ray inside a half-infinite cylinder from `centre` along the unit vector `axis`.
pub(super) fn inside_cylinder(
    ray: &Ray,
    span: (f64, f64),
    centre: DVec3,
    axis: DVec3,
    radius: f64,
) -> Option<(f64, f64)> {
    let flat = |v: DVec3| v - v.dot(axis) * axis;
    let offset = ray.origin - centre;
    let (across, along) = (flat(offset), flat(ray.direction));
    let quadratic = [along.length_squared(), across.dot(along), across.length_squared() - radius * radius];
    let (mut from, mut to) =
        between_roots(quadratic, span, |t| (across + t * along).length_squared() <= radius * radius)?;
    // Only the half in front of `centre` is lit.
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

/// The part of an interval of t in which `inside`, which changes at the roots of a t² + 2 b t + c,
/// is true.
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
    fn crossing_rays_are_cut_at_entry_and_exit() {
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
            "behind the source"
        );
        let behind = Ray::new(DVec3::new(-5.0, 0.0, -2.0), DVec3::X);
        assert_eq!(
            inside_cone(&behind, (0.0, 20.0), DVec3::ZERO, DVec3::Z, 1.0 - half.cos()),
            None,
            "the other nappe of the cone"
        );
    }

    /// A spot with the half-angle 115° illuminates everything except a cone of 65° behind it.
    #[test]
    fn a_cone_wider_than_a_half_space_is_lit_on_both_sides() {
        let half = 115_f64.to_radians();
        let lit = |ray: &Ray| inside_cone(ray, (0.0, 20.0), DVec3::ZERO, DVec3::Z, 1.0 - half.cos());
        let in_front = Ray::new(DVec3::new(-5.0, 0.0, 2.0), DVec3::X);
        assert_eq!(lit(&in_front), Some((0.0, 20.0)));
        let past_the_dark_cone = Ray::new(DVec3::new(-5.0, 0.0, -2.0), DVec3::X);
        assert_eq!(lit(&past_the_dark_cone), Some((0.0, 20.0)), "lit before and after the dark cone");
        let out_of_the_dark = Ray::new(DVec3::new(0.0, 0.0, -2.0), DVec3::X);
        let (from, to) = lit(&out_of_the_dark).unwrap();
        assert!((from - 2.0 * 65_f64.to_radians().tan()).abs() < 1e-12 && to == 20.0, "{from} to {to}");
        let in_the_dark = Ray::new(DVec3::new(0.0, 0.0, -2.0), DVec3::NEG_Z);
        assert_eq!(lit(&in_the_dark), None);
    }

    #[test]
    fn a_ray_along_a_beam_is_lit_from_the_source_on() {
        let ray = Ray::new(DVec3::new(0.1, 0.0, -4.0), DVec3::Z);
        assert_eq!(inside_cylinder(&ray, (0.0, 10.0), DVec3::ZERO, DVec3::Z, 0.3), Some((4.0, 10.0)));
    }
}
