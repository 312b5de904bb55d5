//! Boundary correction of kernels beside edges.
//!
//! Near an edge, a part of the kernel is beyond the surface or behind a wall. Photons there belong
//! to another surface, or to another room, so they are ignored. Without a correction, the estimate
//! near the edge would then be too dark. The estimate is therefore divided by the fraction of the
//! kernel on the surface (Jensen 2001, "Realistic Image Synthesis Using Photon Mapping", section
//! 7.2.4).

use crate::gather::camera::visible_point::VisiblePoint;
use crate::map::kernel::BoundaryCorrection;
use abbe_scene::geometry::{Geometry, Ray};
use abbe_spectra::math::elementary::{atan2_f32, cos};
use abbe_spectra::math::rotation::unit_vector;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::TAU;
use std::num::NonZeroU32;

/// The number of directions in which an outline stores the extent of the surface.
const DIRECTIONS: usize = 16;

/// The search rays find the end of the surface. This constant is their height above the surface, as
/// a fraction of the search distance.
const LIFT: f64 = 0.25;

/// The least cosine of the angle between the normal of a surface and the normal of its
/// continuation.
const CONTINUATION_COSINE: f64 = 0.7;

/// The lower limit of the fraction of a kernel on the surface. The estimate is divided by this
/// fraction. A smaller divisor would amplify the noise of a small number of photons.
const LEAST_FRACTION: f64 = 0.1;

/// Two points lie on the same plane if the second is at most this fraction of the search distance
/// above or below the plane of the first.
const COPLANAR: f64 = 1e-3;

/// The extent of the surface around a visible point. Each pixel near an edge has an outline. To
/// save memory, an outline stores positions in single precision and extents as 8-bit integers.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    position: Vec3,
    facing: Vec3,
    /// The direction in which the extent is measured first.
    right: Vec3,
    /// The direction that is measured a quarter turn later.
    ahead: Vec3,
    /// The largest distance of the search, in m.
    reach: f32,
    /// The extent of the surface in equally spaced directions. The unit is `reach` / 255.
    steps: [u8; DIRECTIONS],
}

impl Outline {
    /// Measures the surface around a visible point, up to the distance `reach` (m).
    pub fn around(geometry: &Geometry, visible_point: &VisiblePoint, reach: f64) -> Self {
        let (right, ahead) = visible_point.facing.any_orthonormal_pair();
        Self::new(visible_point, reach, |i| {
            let DVec2 { x, y } = direction(i);
            surface_extent(geometry, visible_point, right * x + ahead * y, reach)
        })
    }

    /// Returns the outline around another point of the same plane, computed from this outline.
    /// Returns `None` if the point is not on the plane, or if this outline does not contain
    /// everything within the distance `reach` (m) of the point.
    pub fn moved_to(&self, visible_point: &VisiblePoint, reach: f64) -> Option<Self> {
        let offset = visible_point.position - self.position.as_dvec3();
        let (up, own_reach) = (visible_point.facing, f64::from(self.reach));
        let is_coplanar = self.facing == up.as_vec3() && offset.dot(up).abs() <= COPLANAR * own_reach;
        let step = own_reach / f64::from(u8::MAX);
        if !is_coplanar || Self::reach_to_move(offset.length() + reach) > own_reach {
            return None;
        }
        let from = DVec2::new(offset.dot(self.right.as_dvec3()), offset.dot(self.ahead.as_dvec3()));
        let directions: [DVec2; DIRECTIONS] = std::array::from_fn(direction);
        let corners = std::array::from_fn(|i| directions[i] * (f64::from(self.steps[i]) * step) - from);
        Some(Self::new(visible_point, reach, |i| distance_to_polygon(&corners, directions[i]).min(reach)))
    }

    /// Returns the reach (m) that an outline needs to contain a circle of this radius (m). The
    /// corners of an unlimited outline lie on a circle, and its sides are chords.
    pub fn reach_to_move(radius_m: f64) -> f64 {
        radius_m * (1.0 + 1e-6) / cos(TAU / 2.0 / DIRECTIONS as f64)
    }

    /// Returns true if the surface ends within the reach.
    pub fn is_limited(&self) -> bool {
        self.steps.iter().any(|&step| step < u8::MAX)
    }

    fn new(visible_point: &VisiblePoint, reach: f64, extent: impl Fn(usize) -> f64) -> Self {
        let step = |i: usize| (extent(i) / reach * f64::from(u8::MAX)).round() as u8;
        let (position, facing) = (visible_point.position.as_vec3(), visible_point.facing.as_vec3());
        let (right, ahead) = visible_point.facing.any_orthonormal_pair();
        Self {
            position,
            facing,
            right: right.as_vec3(),
            ahead: ahead.as_vec3(),
            reach: reach as f32,
            steps: std::array::from_fn(step),
        }
    }

    /// Returns true if a photon at `position` lies on the surface within its extent. Between the
    /// measured directions, the reciprocal of the extent is interpolated, because this is nearly
    /// exact for a straight edge.
    #[inline]
    pub fn contains(&self, position: [f32; 3]) -> bool {
        let offset = Vec3::from(position) - self.position;
        let along = Vec3::new(offset.dot(self.right), offset.dot(self.ahead), 0.0);
        let turns = atan2_f32(along.y, along.x) / (TAU as f32);
        let sector = (turns + 1.0).fract() * DIRECTIONS as f32;
        let (first, share) = (sector as usize % DIRECTIONS, sector.fract());
        let reciprocal = |i: usize| 1.0 / f32::from(self.steps[i % DIRECTIONS]).max(0.5);
        let per_extent = (1.0 - share) * reciprocal(first) + share * reciprocal(first + 1);
        along.length() * per_extent * f32::from(u8::MAX) <= self.reach
    }

    /// Returns the fraction of each kernel that lies on the surface. The kernel radius `radius` (m)
    /// must not exceed the largest distance of the search.
    pub fn correction(&self, radius: f64) -> BoundaryCorrection {
        let per_step = f64::from(self.reach) / f64::from(u8::MAX) / radius;
        let (mut estimate, mut uniform) = (0.0, 0.0);
        for &step in &self.steps {
            let within = BoundaryCorrection::within(f64::from(step) * per_step);
            estimate += within.estimate;
            uniform += within.uniform;
        }
        let fraction = |sum: f64| (sum / DIRECTIONS as f64).max(LEAST_FRACTION);
        BoundaryCorrection { estimate: fraction(estimate), uniform: fraction(uniform) }
    }
}

/// Returns one of the directions of an outline, in the coordinates `right` and `ahead`.
fn direction(i: usize) -> DVec2 {
    unit_vector(i as f64 / DIRECTIONS as f64 * TAU)
}

/// Returns the distance from the origin to the side of a polygon in a direction. The corners are
/// listed counterclockwise. Returns 0 if the origin is outside.
fn distance_to_polygon(corners: &[DVec2; DIRECTIONS], direction: DVec2) -> f64 {
    let left = corners.map(|corner| direction.perp_dot(corner));
    let sides = (0..DIRECTIONS).map(|i| (i, (i + 1) % DIRECTIONS));
    // The line along the direction crosses these sides from the right to the left.
    let crossed = sides.filter(|&(start, end)| left[start] <= 0.0 && left[end] > 0.0);
    let distance = |(start, end): (usize, usize)| corners[start].perp_dot(corners[end]) / (left[end] - left[start]);
    crossed.map(distance).filter(|&distance| distance >= 0.0).reduce(f64::min).unwrap_or(0.0)
}

/// Returns how far (m) the surface extends from a visible point in one direction. The result is at
/// most `reach`.
fn surface_extent(geometry: &Geometry, visible_point: &VisiblePoint, direction: DVec3, reach: f64) -> f64 {
    const BISECTIONS: usize = 6;
    let up = visible_point.facing;
    let lift = LIFT * reach;
    let start = visible_point.position + up * lift;
    let wall = geometry.intersect(&Ray::new(start, direction), None, reach).map(|hit| hit.t);
    let continues = |distance: f64| {
        let down = Ray::new(start + direction * distance, -up);
        let below = geometry.intersect(&down, None, 2.0 * lift);
        below.is_some_and(|hit| hit.normal.dot(up).abs() > CONTINUATION_COSINE)
    };
    let farthest = wall.unwrap_or(reach);
    if continues(farthest * (1.0 - 1e-6)) {
        return farthest;
    }
    let (mut on, mut off) = (0.0, farthest);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (on + off);
        if continues(middle) { on = middle } else { off = middle }
    }
    0.5 * (on + off)
}

/// The outline of the surface at a visible point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PixelOutline<'o> {
    /// The kernel does not reach over an edge.
    Absent,
    /// The pilot has measured the outline.
    Stored(&'o Outline),
    /// The outline varies within the pixel, so each gather point measures its own.
    Varies,
}

/// An outline that the pilot measured, or the reason why it did not.
#[derive(Debug, Clone, PartialEq)]
pub enum OutlineSurvey {
    /// The kernel does not reach over an edge.
    Absent,
    /// The outline.
    Measured(Outline),
    /// The pixel is not small, compared with its kernel, so the outline varies within the pixel.
    Varies,
}

/// The outlines of directly visible surfaces. A pixel has an outline if its kernel reaches over an
/// edge.
#[derive(Debug, Default)]
pub struct Outlines {
    width: usize,
    /// For each pixel, the number of its outline in the list. The numbers start at 1, and
    /// [`VARIES`] stands for an outline that varies.
    numbers: Vec<Option<NonZeroU32>>,
    list: Vec<Outline>,
}

/// The number of an outline that varies within its pixel.
const VARIES: NonZeroU32 = NonZeroU32::MAX;

impl Outlines {
    /// Returns true if no kernel reaches over an edge.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Collects the outlines of pixels. The pixels are listed row by row, from the top of the
    /// image.
    pub fn new(width: usize, of_pixels: Vec<OutlineSurvey>) -> Self {
        let mut list = Vec::new();
        let number = |outline| match outline {
            OutlineSurvey::Absent => None,
            OutlineSurvey::Varies => Some(VARIES),
            OutlineSurvey::Measured(outline) => {
                list.push(outline);
                NonZeroU32::new(list.len() as u32)
            }
        };
        let numbers = of_pixels.into_iter().map(number).collect();
        Self { width, numbers, list }
    }

    /// Collects the outlines of all pixels from bands of rows. The bands are listed from the top of
    /// the image.
    pub fn of_bands(width: usize, bands: Vec<Self>) -> Self {
        let pixels = bands.iter().map(|band| band.numbers.len()).sum();
        let mut all = Self { width, numbers: Vec::with_capacity(pixels), list: Vec::new() };
        for band in bands {
            let before = all.list.len() as u32;
            let after_the_others =
                |number: NonZeroU32| if number == VARIES { VARIES } else { number.saturating_add(before) };
            all.numbers.extend(band.numbers.into_iter().map(|number| number.map(after_the_others)));
            all.list.extend(band.list);
        }
        if all.numbers.iter().all(Option::is_none) { Self::default() } else { all }
    }

    /// Returns the outline of the surface at a visible point of this pixel. The pixel may see
    /// several surfaces. If the pixel's own outline belongs to a different surface, a neighbouring
    /// pixel may have an outline of the right surface.
    pub fn find(&self, pixel: usize, visible_point: &VisiblePoint) -> PixelOutline<'_> {
        if self.numbers[pixel] == Some(VARIES) {
            return PixelOutline::Varies;
        }
        let (x, y) = ((pixel % self.width) as isize, (pixel / self.width) as isize);
        let nearby = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)];
        let fitting = nearby.iter().find_map(|(dx, dy)| {
            let outline = self.at(x + dx, y + dy)?;
            let continues = visible_point.continues_to(outline.position.as_dvec3(), outline.facing.as_dvec3());
            (continues && outline.contains(visible_point.position.as_vec3().to_array())).then_some(outline)
        });
        fitting.map_or(PixelOutline::Absent, PixelOutline::Stored)
    }

    fn at(&self, x: isize, y: isize) -> Option<&Outline> {
        if x < 0 || y < 0 || x >= self.width as isize {
            return None;
        }
        let number = (*self.numbers.get(y as usize * self.width + x as usize)?)?;
        self.list.get(number.get() as usize - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::partition::View;

    fn visible_point() -> VisiblePoint {
        VisiblePoint {
            position: DVec3::ZERO,
            facing: DVec3::Z,
            footprint_m: 0.01,
            object: 0,
            view: View::Direct,
            shared: false,
            is_diffuse: true,
            is_fluorescent: false,
        }
    }

    /// Creates an outline. `extent` is the extent of the surface (at most 1) as a function of
    /// direction.
    fn outline(extent: impl Fn(f64) -> f64) -> Outline {
        Outline::new(&visible_point(), 1.0, |i| extent(i as f64 / DIRECTIONS as f64 * TAU))
    }

    /// Compares two fractions at an edge and in a corner: the fraction of the kernel on the
    /// surface, and the fraction of the directions in which the surface continues. The two
    /// fractions must be equal.
    #[test]
    fn edge_and_corner_corrections_count_directions() {
        let half = outline(|angle| if angle.cos() > 1e-9 { 0.0 } else { 1.0 });
        assert!((half.correction(1.0).estimate - 9.0 / 16.0).abs() < 1e-9);
        let corner = outline(|angle| if angle.cos() > 1e-9 && angle.sin() > 1e-9 { 1.0 } else { 0.0 });
        assert!((corner.correction(1.0).estimate - 3.0 / 16.0).abs() < 1e-9);
    }

    /// A straight edge cuts the kernel at half the radius. The computed mass of the remaining
    /// kernel agrees with the exact formula.
    #[test]
    fn cut_kernel_has_the_mass_of_the_closed_form() {
        let cut = outline(|angle| if angle.cos() > 0.5 { 0.5 / angle.cos() } else { 1.0 });
        // The integral of (2/π)(1 − x² − y²) over y, with x fixed, is 8/(3π)·(1 − x²)^(3/2).
        let strip = |x: f64| 8.0 / (3.0 * std::f64::consts::PI) * (1.0 - x * x).powf(1.5);
        let n = 10_000;
        let beyond: f64 =
            (0..n).map(|i| strip(0.5 + 0.5 * (f64::from(i) + 0.5) / f64::from(n)) * 0.5 / f64::from(n)).sum();
        assert!(
            (cut.correction(1.0).estimate - (1.0 - beyond)).abs() < 0.01,
            "{:?} and {}",
            cut.correction(1.0),
            1.0 - beyond
        );
    }

    /// A kernel that does not reach the edge needs no correction.
    #[test]
    fn kernel_far_from_the_edge_is_not_corrected() {
        assert_eq!(outline(|_| 0.51).correction(0.5), BoundaryCorrection::WHOLE);
    }

    /// An outline that moves along the surface becomes the outline of the other point. The chord
    /// between the edge and the end of the search cuts off a few percent.
    #[test]
    fn outline_of_a_neighbour_is_moved_along_the_surface() {
        let edge = |distance: f64, reach: f64| {
            move |angle: f64| if angle.cos() * reach > distance { distance / angle.cos() } else { reach }
        };
        let wide = outline(edge(0.4, 1.0));
        let (right, ahead) = visible_point().facing.any_orthonormal_pair();
        for (x, y) in [(0.0, 0.0), (0.1, 0.05), (-0.15, 0.1), (0.2, -0.2)] {
            let there = VisiblePoint { position: right * x + ahead * y, ..visible_point() };
            let moved = wide.moved_to(&there, 0.6).unwrap();
            for i in 0..DIRECTIONS {
                let (found, wanted) = (moved.steps[i], edge(0.4 - x, 0.6)(i as f64 / DIRECTIONS as f64 * TAU));
                let found = f64::from(found) / 255.0 * 0.6;
                assert!((found - wanted).abs() < 0.05 * 0.6, "{x} {y} {i}: {found} for {wanted}");
            }
        }
        let above = VisiblePoint { position: DVec3::Z * 0.01, ..visible_point() };
        assert_eq!(wide.moved_to(&above, 0.6), None);
        assert_eq!(wide.moved_to(&visible_point(), 0.99), None, "it may end beyond the chord");
        let tilted = VisiblePoint { facing: DVec3::new(0.0, 0.01, 1.0).normalize(), ..visible_point() };
        assert_eq!(wide.moved_to(&tilted, 0.6), None);
    }

    /// A pixel that sees two surfaces uses the outline of the matching surface.
    #[test]
    fn pixel_with_two_surfaces_takes_the_fitting_outline() {
        let edge = outline(|angle| if angle.cos() > 0.0 { 0.0 } else { 1.0 });
        let measured = vec![OutlineSurvey::Absent, OutlineSurvey::Measured(edge.clone())];
        let outlines = Outlines::of_bands(2, vec![Outlines::new(2, measured)]);
        assert_eq!(outlines.find(0, &visible_point()), PixelOutline::Stored(&edge), "the neighbour's");
        let wall = VisiblePoint { facing: DVec3::X, ..visible_point() };
        assert_eq!(outlines.find(1, &wall), PixelOutline::Absent, "another surface");
    }

    /// A photon behind a straight wall does not count, and a photon in front of the wall does.
    #[test]
    fn photons_behind_a_wall_are_outside_the_outline() {
        let wall = outline(|angle| if angle.cos() > 0.4 { 0.4 / angle.cos() } else { 1.0 });
        let (right, ahead) = visible_point().facing.any_orthonormal_pair();
        for i in -60..=60 {
            let across = ahead * (0.01 * f64::from(i));
            let place = |x: f64| (right * x + across).as_vec3().to_array();
            assert!(wall.contains(place(0.38)) && !wall.contains(place(0.42)), "{i}");
        }
        assert!(wall.contains([0.0; 3]));
    }
}
