//! Boundary correction of kernels beside edges.
//!
//! Near an edge, a part of the kernel is beyond the surface or behind a wall, where photons belong
//! to another surface or another room and are ignored. The estimate is therefore divided by the
//! fraction of the kernel on the surface, because it would be too dark otherwise (Jensen 2001,
//! "Realistic Image Synthesis Using Photon Mapping", section 7.2.4).

use crate::gather::camera::visible_point::VisiblePoint;
use crate::map::kernel::BoundaryCorrection;
use abbe_scene::geometry::{Geometry, Ray};
use abbe_spectra::math::elementary::{atan2_f32, cos};
use abbe_spectra::math::rotation::unit_vector;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::TAU;
use std::num::NonZeroU32;

/// The number of directions in which a surface extent is stored.
const DIRECTIONS: usize = 16;

/// The height of the rays that search for the end, as a fraction of the search distance.
const LIFT: f64 = 0.25;

/// The least cosine between the normals of a surface and its continuation.
const CONTINUATION_COSINE: f64 = 0.7;

/// The least fraction of a kernel on the surface by which the estimate is divided. Smaller divisors
/// would amplify the noise of few photons.
const LEAST_FRACTION: f64 = 0.1;

/// Points this near to a plane, as a fraction of the search distance, lie on it.
const COPLANAR: f64 = 1e-3;

/// The extent of the surface around a visible point. Each pixel near an edge has one, so it saves
/// memory by single precision and 8-bit integers.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceExtent {
    position: Vec3,
    facing: Vec3,
    /// The direction in which the extent is measured first.
    right: Vec3,
    /// The direction that is measured a quarter turn later.
    ahead: Vec3,
    /// The largest distance of the search, in m.
    search_m: f32,
    /// The extent of the surface in equally spaced directions. The unit is `search_m` / 255.
    steps: [u8; DIRECTIONS],
}

impl SurfaceExtent {
    /// Measures the surface around a visible point, up to the distance `search_m` (m).
    pub fn around(geometry: &Geometry, visible_point: &VisiblePoint, search_m: f64) -> Self {
        let (right, ahead) = visible_point.facing.any_orthonormal_pair();
        Self::new(visible_point, search_m, |i| {
            let DVec2 { x, y } = direction(i);
            extent_along(geometry, visible_point, right * x + ahead * y, search_m)
        })
    }

    /// Returns the extent around another point of the same plane, or `None` if the point is not on
    /// the plane, or if this extent does not contain everything within `search_m` (m) of it.
    pub fn moved_to(&self, visible_point: &VisiblePoint, search_m: f64) -> Option<Self> {
        let offset = visible_point.position - self.position.as_dvec3();
        let (up, own_search_m) = (visible_point.facing, f64::from(self.search_m));
        let is_coplanar = self.facing == up.as_vec3() && offset.dot(up).abs() <= COPLANAR * own_search_m;
        let step = own_search_m / f64::from(u8::MAX);
        if !is_coplanar || Self::search_to_move(offset.length() + search_m) > own_search_m {
            return None;
        }
        let from = DVec2::new(offset.dot(self.right.as_dvec3()), offset.dot(self.ahead.as_dvec3()));
        let directions: [DVec2; DIRECTIONS] = std::array::from_fn(direction);
        let corners = std::array::from_fn(|i| directions[i] * (f64::from(self.steps[i]) * step) - from);
        Some(Self::new(visible_point, search_m, |i| distance_to_polygon(&corners, directions[i]).min(search_m)))
    }

    /// Returns the reach (m) of an extent that contains a circle of this radius (m). The corners of
    /// an unlimited extent lie on a circle, and its sides are chords.
    pub fn search_to_move(radius_m: f64) -> f64 {
        radius_m * (1.0 + 1e-6) / cos(TAU / 2.0 / DIRECTIONS as f64)
    }

    /// Returns true if the surface ends within the reach.
    pub fn is_limited(&self) -> bool {
        self.steps.iter().any(|&step| step < u8::MAX)
    }

    fn new(visible_point: &VisiblePoint, search_m: f64, extent: impl Fn(usize) -> f64) -> Self {
        let step = |i: usize| (extent(i) / search_m * f64::from(u8::MAX)).round() as u8;
        let (position, facing) = (visible_point.position.as_vec3(), visible_point.facing.as_vec3());
        let (right, ahead) = visible_point.facing.any_orthonormal_pair();
        Self {
            position,
            facing,
            right: right.as_vec3(),
            ahead: ahead.as_vec3(),
            search_m: search_m as f32,
            steps: std::array::from_fn(step),
        }
    }

    /// Returns true if a photon at `position` lies on the surface. Between the measured directions,
    /// the reciprocal of the extent is interpolated, which is nearly exact for a straight edge.
    #[inline]
    pub fn contains(&self, position: [f32; 3]) -> bool {
        let offset = Vec3::from(position) - self.position;
        let along = Vec3::new(offset.dot(self.right), offset.dot(self.ahead), 0.0);
        let turns = atan2_f32(along.y, along.x) / (TAU as f32);
        let sector = (turns + 1.0).fract() * DIRECTIONS as f32;
        let (first, fraction) = (sector as usize % DIRECTIONS, sector.fract());
        let reciprocal = |i: usize| 1.0 / f32::from(self.steps[i % DIRECTIONS]).max(0.5);
        let per_extent = (1.0 - fraction) * reciprocal(first) + fraction * reciprocal(first + 1);
        along.length() * per_extent * f32::from(u8::MAX) <= self.search_m
    }

    /// Returns the fraction of each kernel of this radius (m, at most the search) on the surface.
    pub fn correction(&self, radius: f64) -> BoundaryCorrection {
        let per_step = f64::from(self.search_m) / f64::from(u8::MAX) / radius;
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

/// Returns one of the directions of a surface extent, in the coordinates `right` and `ahead`.
fn direction(i: usize) -> DVec2 {
    unit_vector(i as f64 / DIRECTIONS as f64 * TAU)
}

/// Returns the distance from the origin along a direction to the side of a polygon with
/// counterclockwise corners, 0 from outside.
fn distance_to_polygon(corners: &[DVec2; DIRECTIONS], direction: DVec2) -> f64 {
    let left = corners.map(|corner| direction.perp_dot(corner));
    let sides = (0..DIRECTIONS).map(|i| (i, (i + 1) % DIRECTIONS));
    // The line along the direction crosses these sides from the right to the left.
    let crossed = sides.filter(|&(start, end)| left[start] <= 0.0 && left[end] > 0.0);
    let distance = |(start, end): (usize, usize)| corners[start].perp_dot(corners[end]) / (left[end] - left[start]);
    crossed.map(distance).filter(|&distance| distance >= 0.0).reduce(f64::min).unwrap_or(0.0)
}

/// Returns how far (m) the surface extends in one direction, at most `search_m`.
fn extent_along(geometry: &Geometry, visible_point: &VisiblePoint, direction: DVec3, search_m: f64) -> f64 {
    const BISECTIONS: usize = 6;
    let up = visible_point.facing;
    let lift = LIFT * search_m;
    let start = visible_point.position + up * lift;
    let wall = geometry.intersect(&Ray::new(start, direction), None, search_m).map(|hit| hit.t);
    let continues = |distance: f64| {
        let down = Ray::new(start + direction * distance, -up);
        let below = geometry.intersect(&down, None, 2.0 * lift);
        below.is_some_and(|hit| hit.normal.dot(up).abs() > CONTINUATION_COSINE)
    };
    let farthest = wall.unwrap_or(search_m);
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

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PixelSurfaceExtent<'o> {
    /// The kernel does not reach over an edge.
    Absent,
    Stored(&'o SurfaceExtent),
    /// The surface extent varies within the pixel, so each gather point measures its own.
    Varies,
}

/// A surface extent that the pilot measured, or the reason why it did not.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceExtentSurvey {
    /// The kernel does not reach over an edge.
    Absent,
    Measured(SurfaceExtent),
    /// The pixel is not small compared with its kernel, so the extent varies within it.
    Varies,
}

/// The extents of directly visible surfaces, for the pixels whose kernels reach over an edge.
#[derive(Debug, Default)]
pub struct SurfaceExtents {
    width: usize,
    /// For each pixel, the number of its extent in the list from 1, or [`VARIES`].
    numbers: Vec<Option<NonZeroU32>>,
    list: Vec<SurfaceExtent>,
}

const VARIES: NonZeroU32 = NonZeroU32::MAX;

impl SurfaceExtents {
    /// Returns true if no kernel reaches over an edge.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Takes the extents of pixels row by row, from the top of the image.
    pub fn new(width: usize, of_pixels: Vec<SurfaceExtentSurvey>) -> Self {
        let mut list = Vec::new();
        let number = |surface_extent| match surface_extent {
            SurfaceExtentSurvey::Absent => None,
            SurfaceExtentSurvey::Varies => Some(VARIES),
            SurfaceExtentSurvey::Measured(surface_extent) => {
                list.push(surface_extent);
                NonZeroU32::new(list.len() as u32)
            }
        };
        let numbers = of_pixels.into_iter().map(number).collect();
        Self { width, numbers, list }
    }

    /// Joins bands of rows, from the top of the image.
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

    /// Returns the extent at a visible point of this pixel. The pixel may see several surfaces, so
    /// a neighbour may have the extent of the right one.
    pub fn find(&self, pixel: usize, visible_point: &VisiblePoint) -> PixelSurfaceExtent<'_> {
        if self.numbers[pixel] == Some(VARIES) {
            return PixelSurfaceExtent::Varies;
        }
        let (x, y) = ((pixel % self.width) as isize, (pixel / self.width) as isize);
        let nearby = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1)];
        let fitting = nearby.iter().find_map(|(dx, dy)| {
            let surface_extent = self.at(x + dx, y + dy)?;
            let continues =
                visible_point.continues_to(surface_extent.position.as_dvec3(), surface_extent.facing.as_dvec3());
            (continues && surface_extent.contains(visible_point.position.as_vec3().to_array()))
                .then_some(surface_extent)
        });
        fitting.map_or(PixelSurfaceExtent::Absent, PixelSurfaceExtent::Stored)
    }

    fn at(&self, x: isize, y: isize) -> Option<&SurfaceExtent> {
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
    use crate::plan::partition::CameraView;

    fn visible_point() -> VisiblePoint {
        VisiblePoint {
            position: DVec3::ZERO,
            facing: DVec3::Z,
            footprint_m: 0.01,
            object: 0,
            view: CameraView::Direct,
            shared: false,
            is_diffuse: true,
            is_fluorescent: false,
        }
    }

    /// Takes the extent (at most 1) as a function of direction.
    fn surface_extent(extent: impl Fn(f64) -> f64) -> SurfaceExtent {
        SurfaceExtent::new(&visible_point(), 1.0, |i| extent(i as f64 / DIRECTIONS as f64 * TAU))
    }

    /// At an edge and in a corner, the fraction of the kernel on the surface equals the fraction of
    /// the directions in which the surface continues.
    #[test]
    fn edge_and_corner_corrections_count_directions() {
        let half = surface_extent(|angle| if angle.cos() > 1e-9 { 0.0 } else { 1.0 });
        assert!((half.correction(1.0).estimate - 9.0 / 16.0).abs() < 1e-9);
        let corner = surface_extent(|angle| if angle.cos() > 1e-9 && angle.sin() > 1e-9 { 1.0 } else { 0.0 });
        assert!((corner.correction(1.0).estimate - 3.0 / 16.0).abs() < 1e-9);
    }

    /// A straight edge cuts the kernel at half the radius, and leaves the mass of the formula.
    #[test]
    fn cut_kernel_has_the_mass_of_the_closed_form() {
        let cut = surface_extent(|angle| if angle.cos() > 0.5 { 0.5 / angle.cos() } else { 1.0 });
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

    #[test]
    fn kernel_far_from_the_edge_is_not_corrected() {
        assert_eq!(surface_extent(|_| 0.51).correction(0.5), BoundaryCorrection::WHOLE);
    }

    /// An extent that moves along the surface becomes that of the other point. The chord between
    /// the edge and the end of the search cuts off a few percent.
    #[test]
    fn extent_of_a_neighbour_is_moved_along_the_surface() {
        let edge = |distance: f64, search_m: f64| {
            move |angle: f64| if angle.cos() * search_m > distance { distance / angle.cos() } else { search_m }
        };
        let wide = surface_extent(edge(0.4, 1.0));
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

    #[test]
    fn pixel_with_two_surfaces_takes_the_fitting_extent() {
        let edge = surface_extent(|angle| if angle.cos() > 0.0 { 0.0 } else { 1.0 });
        let measured = vec![SurfaceExtentSurvey::Absent, SurfaceExtentSurvey::Measured(edge.clone())];
        let surface_extents = SurfaceExtents::of_bands(2, vec![SurfaceExtents::new(2, measured)]);
        assert_eq!(surface_extents.find(0, &visible_point()), PixelSurfaceExtent::Stored(&edge), "the neighbour's");
        let wall = VisiblePoint { facing: DVec3::X, ..visible_point() };
        assert_eq!(surface_extents.find(1, &wall), PixelSurfaceExtent::Absent, "another surface");
    }

    #[test]
    fn photons_behind_a_wall_are_outside_the_extent() {
        let wall = surface_extent(|angle| if angle.cos() > 0.4 { 0.4 / angle.cos() } else { 1.0 });
        let (right, ahead) = visible_point().facing.any_orthonormal_pair();
        for i in -60..=60 {
            let across = ahead * (0.01 * f64::from(i));
            let place = |x: f64| (right * x + across).as_vec3().to_array();
            assert!(wall.contains(place(0.38)) && !wall.contains(place(0.42)), "{i}");
        }
        assert!(wall.contains([0.0; 3]));
    }
}
