//! What of a kernel lies on the surface. Beside an edge a part of it hangs over the void, or lies behind a wall, where no photon can come down:
//! dividing by the share that lies on the surface takes the darkness away that edges would have (boundary correction: Jensen,
//! "Realistic Image Synthesis Using Photon Mapping", 2001, section 7.2.4).

use super::landing::Landing;
use crate::map::kernel::Shares;
use crate::scene::geometry::{Geometry, Ray};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Directions in which an outline is known.
const DIRECTIONS: usize = 16;

/// How high over the surface its end is looked for, as a share of the reach.
const LIFT: f64 = 0.25;

/// Cosine of the largest turn of a surface that still goes on.
const COSINE: f64 = 0.7;

/// No kernel is taken to lie on the surface by less than this share: a sliver's few photons would be blown up.
const LEAST_SHARE: f64 = 0.1;

/// How far the surface goes on around a place; in single precision and steps, as there is one for each pixel near an edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    position: Vec3,
    facing: Vec3,
    /// How far was looked, in m.
    reach: f32,
    /// Distances along the surface in equally spaced directions, in 255ths of the reach.
    steps: [u8; DIRECTIONS],
}

impl Outline {
    /// Looks around a place as far as `reach` (m); `None` if the surface goes on everywhere.
    pub fn around(geometry: &Geometry, landing: &Landing, reach: f64) -> Option<Self> {
        let (right, ahead) = landing.facing.any_orthonormal_pair();
        let outline = Self::new(landing, reach, |angle| {
            let direction = right * angle.cos() + ahead * angle.sin();
            end(geometry, (landing.position, landing.facing), direction, reach)
        });
        outline.steps.iter().any(|&step| step < u8::MAX).then_some(outline)
    }

    fn new(landing: &Landing, reach: f64, distance: impl Fn(f64) -> f64) -> Self {
        let step = |i: usize| {
            let distance = distance(i as f64 / DIRECTIONS as f64 * TAU);
            (distance / reach * f64::from(u8::MAX)).round() as u8
        };
        let (position, facing) = (landing.position.as_vec3(), landing.facing.as_vec3());
        Self { position, facing, reach: reach as f32, steps: std::array::from_fn(step) }
    }

    /// What of kernels no wider than was looked lies on the surface.
    pub fn shares(&self, radius: f64) -> Shares {
        let per_step = f64::from(self.reach) / f64::from(u8::MAX) / radius;
        let (mut estimate, mut uniform) = (0.0, 0.0);
        for &step in &self.steps {
            let within = Shares::within(f64::from(step) * per_step);
            estimate += within.estimate;
            uniform += within.uniform;
        }
        let share = |sum: f64| (sum / DIRECTIONS as f64).max(LEAST_SHARE);
        Shares { estimate: share(estimate), uniform: share(uniform) }
    }
}

/// How far the surface goes on in one direction from a place, seen from the side that `up` points to; at most `reach`.
fn end(geometry: &Geometry, (place, up): (DVec3, DVec3), direction: DVec3, reach: f64) -> f64 {
    const HALVINGS: usize = 6;
    let lift = LIFT * reach;
    let start = place + up * lift;
    let wall = geometry.intersect(&Ray::new(start, direction), None, reach).map(|hit| hit.t);
    let goes_on = |distance: f64| {
        let down = Ray::new(start + direction * distance, -up);
        let below = geometry.intersect(&down, None, 2.0 * lift);
        below.is_some_and(|hit| hit.normal.dot(up).abs() > COSINE)
    };
    let farthest = wall.unwrap_or(reach);
    if goes_on(farthest * (1.0 - 1e-6)) {
        return farthest;
    }
    let (mut on, mut off) = (0.0, farthest);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (on + off);
        if goes_on(middle) { on = middle } else { off = middle }
    }
    0.5 * (on + off)
}

/// The outlines around what pixels see directly, of those whose kernels reach over an edge.
#[derive(Debug, Default)]
pub struct Outlines {
    width: usize,
    /// Each pixel's place in the list, from 1; 0 for none.
    places: Vec<u32>,
    list: Vec<Outline>,
}

impl Outlines {
    /// Whether no kernel reaches over an edge.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// From each pixel's outline, rows from the top.
    pub fn new(width: usize, of_pixels: impl Iterator<Item = Option<Outline>>) -> Self {
        let mut outlines = Self { width, ..Self::default() };
        for outline in of_pixels {
            let place = outline.map_or(0, |outline| {
                outlines.list.push(outline);
                outlines.list.len() as u32
            });
            outlines.places.push(place);
        }
        outlines
    }

    /// What of kernels lies on the surface where a path from this pixel landed. The pixel may see more than one surface:
    /// if its outline is another's, one of its neighbours' is taken.
    pub fn shares(&self, pixel: usize, landing: &Landing, radius: f64) -> Shares {
        let (x, y) = ((pixel % self.width.max(1)) as isize, (pixel / self.width.max(1)) as isize);
        let nearby = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)];
        let fits = nearby.iter().find_map(|(dx, dy)| {
            let outline = self.at(x + dx, y + dy)?;
            let fits = landing.goes_on_to(outline.position.as_dvec3(), outline.facing.as_dvec3());
            fits.then_some(outline)
        });
        fits.map_or(Shares::WHOLE, |outline| outline.shares(radius))
    }

    fn at(&self, x: isize, y: isize) -> Option<&Outline> {
        if x < 0 || y < 0 || x >= self.width as isize {
            return None;
        }
        let place = *self.places.get(y as usize * self.width + x as usize)?;
        self.list.get((place as usize).checked_sub(1)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::partition::View;

    fn landing() -> Landing {
        Landing { position: DVec3::ZERO, facing: DVec3::Z, footprint_m: 0.01, view: View::Seen, shared: false }
    }

    /// An outline by its distance (of at most 1) in each direction.
    fn outline(distance: impl Fn(f64) -> f64) -> Outline {
        Outline::new(&landing(), 1.0, distance)
    }

    #[test]
    fn of_a_kernel_beside_an_edge_or_in_a_corner_the_share_of_directions_that_go_on_lies_on_the_surface() {
        let half = outline(|angle| if angle.cos() > 1e-9 { 0.0 } else { 1.0 });
        assert!((half.shares(1.0).estimate - 9.0 / 16.0).abs() < 1e-9);
        let corner = outline(|angle| if angle.cos() > 1e-9 && angle.sin() > 1e-9 { 1.0 } else { 0.0 });
        assert!((corner.shares(1.0).estimate - 3.0 / 16.0).abs() < 1e-9);
    }

    #[test]
    fn a_kernel_cut_at_half_its_radius_keeps_the_mass_of_the_closed_form() {
        let cut = outline(|angle| if angle.cos() > 0.5 { 0.5 / angle.cos() } else { 1.0 });
        // What lies beyond x = 1/2: the integral over y of (2/π)(1 − x² − y²) is 8/(3π)·(1 − x²)^(3/2).
        let strip = |x: f64| 8.0 / (3.0 * std::f64::consts::PI) * (1.0 - x * x).powf(1.5);
        let n = 10_000;
        let beyond: f64 =
            (0..n).map(|i| strip(0.5 + 0.5 * (f64::from(i) + 0.5) / f64::from(n)) * 0.5 / f64::from(n)).sum();
        assert!((cut.shares(1.0).estimate - (1.0 - beyond)).abs() < 0.01, "{:?} and {}", cut.shares(1.0), 1.0 - beyond);
    }

    #[test]
    fn a_smaller_kernel_far_from_the_edge_lies_on_the_surface_as_a_whole() {
        assert_eq!(outline(|_| 0.51).shares(0.5), Shares::WHOLE);
    }

    #[test]
    fn a_pixel_that_sees_two_surfaces_takes_the_outline_that_fits() {
        let edge = outline(|angle| if angle.cos() > 0.0 { 0.0 } else { 1.0 });
        let outlines = Outlines::new(2, [None, Some(edge.clone())].into_iter());
        assert_eq!(outlines.shares(0, &landing(), 1.0), edge.shares(1.0), "the neighbour's");
        let wall = Landing { facing: DVec3::X, ..landing() };
        assert_eq!(outlines.shares(1, &wall, 1.0), Shares::WHOLE, "another surface");
    }
}
