//! Rays of light through a hexagonal prism of ice, by geometrical optics.
//!
//! Each interface reflects and refracts by Fresnel's equations for natural light. A ray follows the
//! reflected light inside, and reports the light that leaves at each face (Macke, Mueller & Raschke
//! 1996, "Single scattering properties of atmospheric ice crystals").

use crate::fresnel::{dielectric, reflect, refract};
use abbe_spectra::math::elementary::{powf, sin_cos};
use glam::DVec3;
use std::f64::consts::FRAC_PI_3;

/// Light inside a crystal is followed until less than this fraction of it is left. Less than a
/// thousandth of it is dropped.
const LEAST_POWER: f64 = 1e-3;

/// Reflections after which the light in a crystal is dropped. Light that total reflection traps in
/// a perfect prism never leaves it.
const MOST_REFLECTIONS: u32 = 100;

/// A hexagonal prism with edges of length 1 around its axis z.
#[derive(Debug, Clone)]
pub(super) struct Crystal {
    half_length: f64,
    /// The outward normals of the six side faces, of the upper and of the lower base. The normal of
    /// face 0 is x.
    pub(super) normals: [DVec3; 8],
    /// The distances of the faces from the centre.
    distances: [f64; 8],
    areas: [f64; 8],
}

impl Crystal {
    /// Takes the length divided by the width from corner to corner.
    pub(super) fn new(length_to_width: f64) -> Self {
        let half_length = length_to_width;
        let normals = std::array::from_fn(|i| match i {
            6 => DVec3::Z,
            7 => DVec3::NEG_Z,
            _ => hexagon(i as f64),
        });
        let of_sides_and_bases = |side: f64, base: f64| std::array::from_fn(|i| if i < 6 { side } else { base });
        let root = 0.75_f64.sqrt();
        Self {
            half_length,
            normals,
            distances: of_sides_and_bases(root, half_length),
            areas: of_sides_and_bases(2.0 * half_length, 3.0 * root),
        }
    }

    /// Returns the mean over all directions of the area that light meets, a quarter of the surface
    /// of a convex body (Cauchy 1841).
    pub(super) fn mean_area(&self) -> f64 {
        0.25 * self.areas.iter().sum::<f64>()
    }

    /// Selects a point on the faces that light from the direction `travel` meets, in proportion to
    /// its power there. Returns the point, the face, and the area of the crystal as the light sees
    /// it.
    pub(super) fn point(&self, travel: DVec3, [u, v, w]: [f64; 3]) -> (DVec3, usize, f64) {
        let powers: [f64; 8] = std::array::from_fn(|i| self.areas[i] * (-travel.dot(self.normals[i])).max(0.0));
        let area: f64 = powers.iter().sum();
        let mut rest = u * area;
        let lit = |i: &usize| powers[*i] > 0.0;
        let last = (0..8).rev().find(lit).expect("a face that light meets");
        let face = (0..last).find(|&i| {
            rest -= powers[i];
            rest < 0.0
        });
        let face = face.unwrap_or(last);
        let middle = self.normals[face] * self.distances[face];
        let point = if face < 6 {
            let across = self.normals[face].cross(DVec3::Z);
            middle + across * (v - 0.5) + DVec3::Z * self.half_length * (2.0 * w - 1.0)
        } else {
            // A triangle of the hexagon, then a point in it.
            let (sector, v) = ((6.0 * v).floor(), (6.0 * v).fract());
            middle + (hexagon(sector + 0.5) * (1.0 - v) + hexagon(sector + 1.5) * v) * w.sqrt()
        };
        (point, face, area)
    }

    /// Calls `leaves` with each direction in which light leaves the crystal and its fraction, and
    /// for light without a reflection with the faces through which it entered and left.
    pub(super) fn trace(
        &self,
        n: f64,
        travel: DVec3,
        (mut point, entered): (DVec3, usize),
        mut leaves: impl FnMut(DVec3, f64, Option<[usize; 2]>),
    ) {
        let normal = self.normals[entered];
        let Some((reflectance, mut inside)) = interface(travel, normal, [1.0, n]) else { return };
        leaves(reflect(-travel, normal), reflectance, None);
        let mut power = 1.0 - reflectance;
        for reflections in 0..MOST_REFLECTIONS {
            let (mut left, mut nearest) = (0, f64::INFINITY);
            for i in 0..8 {
                let cos = inside.dot(self.normals[i]);
                let distance = (self.distances[i] - point.dot(self.normals[i])) / cos;
                if cos > 1e-12 && distance < nearest {
                    (left, nearest) = (i, distance);
                }
            }
            point += inside * nearest;
            let normal = self.normals[left];
            if let Some((reflectance, outside)) = interface(inside, normal, [n, 1.0]) {
                leaves(outside, power * (1.0 - reflectance), (reflections == 0).then_some([entered, left]));
                power *= reflectance;
            }
            if power < LEAST_POWER {
                break;
            }
            inside = reflect(-inside, normal);
        }
    }
}

/// Calls `visit` with points that fill the unit cube of `D` dimensions evenly (Roberts 2018, "The
/// unreasonable effectiveness of quasirandom sequences").
pub(super) fn evenly_spread<const D: usize>(count: u32, mut visit: impl FnMut([f64; D])) {
    // The positive root of x^(D + 1) = x + 1.
    let root = (0..64).fold(1.0_f64, |x, _| powf(1.0 + x, 1.0 / (D as f64 + 1.0)));
    let mut power = 1.0;
    let steps: [f64; D] = std::array::from_fn(|_| {
        power /= root;
        power
    });
    for i in 0..count {
        visit(steps.map(|step| (0.5 + f64::from(i) * step).fract()));
    }
}

/// The direction at `sixths` of a turn from x.
fn hexagon(sixths: f64) -> DVec3 {
    let (sin, cos) = sin_cos(FRAC_PI_3 * sixths);
    DVec3::new(cos, sin, 0.0)
}

/// Returns the reflectance for natural light and the refracted direction, or `None` for total
/// reflection, between the indices before and behind a face.
fn interface(travel: DVec3, normal: DVec3, [before, behind]: [f64; 2]) -> Option<(f64, DVec3)> {
    let refracted = refract(-travel, normal, before, behind)?;
    Some((dielectric(travel.dot(normal), before, behind), refracted))
}
