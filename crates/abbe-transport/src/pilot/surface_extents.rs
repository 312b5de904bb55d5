//! The surface extents of surfaces around directly visible points.

use super::survey::MAX_SURFACE_RADIUS_PX;
use crate::gather::{SurfaceExtent, SurfaceExtentSurvey, SurfaceExtents, VisiblePoint};
use crate::map::FirstRadii;
use crate::pass::PassContext;
use crate::plan::WavelengthPlan;
use crate::plan::partition::PhotonSet;
use abbe_scene::Scene;
use abbe_scene::geometry::Geometry;
use abbe_scene::sweep::Bounds;
use glam::DVec3;
use rayon::prelude::*;

/// If a kernel's radius is below this number of pixels, its surface extent varies within a pixel.
const PIXELS_PER_EXTENT: f64 = 3.0;

/// The test for edges looks at pixels at these fractions of the kernel radius.
const EDGE_DISTANCES: [f64; 3] = [0.25, 0.5, 1.0];

/// The side in pixels of blocks of pixels, which share a measurement of the same plane.
const BLOCK: usize = 4;

/// A shared measurement reaches at most this many times as far as that of one pixel.
const WIDEST_SHARED: f64 = 1.5;

/// Returns the extents around visible points whose kernel may extend over an edge.
///
/// `visible` and `radii` have one entry per pixel, and `scale` is the factor on the radii. A point
/// near `swept`, the bounding boxes of moving objects, gets none, because the edges there may move.
pub(super) fn surface_extents(
    context: &PassContext<'_>,
    scene: &Scene,
    visible: &[Option<VisiblePoint>],
    swept: &[Bounds],
    (radii, scale): (&FirstRadii, f64),
) -> SurfaceExtents {
    let set = PhotonSet::of_path(context.plan.wavelengths == WavelengthPlan::Shared);
    let width = scene.camera.width();
    let farthest_px = scale.max(1.0) * MAX_SURFACE_RADIUS_PX.indirect;
    let survey = |pixel: usize| {
        let radius_m = scale * f64::from(radii.of(pixel).surface[set].indirect);
        let crossing =
            visible[pixel].as_ref().filter(|_| may_cross_edge(visible, pixel, (radius_m, farthest_px), width));
        let Some(point) = crossing else { return Need::Nothing };
        let moves = |bounds: &Bounds| distance_to_box(point.position, bounds) <= 2.0 * radius_m;
        if swept.iter().any(moves) {
            Need::Nothing
        } else if radius_m < PIXELS_PER_EXTENT * point.footprint_m {
            Need::PerSample
        } else {
            Need::SurfaceExtent(point, radius_m)
        }
    };
    let rows: Vec<usize> = (0..visible.len() / width).step_by(BLOCK).collect();
    let of_band = |row: usize| {
        let rows = row..(row + BLOCK).min(visible.len() / width);
        let mut of_pixels = vec![SurfaceExtentSurvey::Absent; rows.len() * width];
        for column in (0..width).step_by(BLOCK) {
            let columns = column..(column + BLOCK).min(width);
            let block = rows.clone().flat_map(|y| columns.clone().map(move |x| y * width + x));
            let needs: Vec<(usize, Need<'_>)> = block.map(|pixel| (pixel - row * width, survey(pixel))).collect();
            if context.stop.is_raised() {
                break;
            }
            measure_block(&scene.geometry, &needs, &mut of_pixels);
        }
        SurfaceExtents::new(width, of_pixels)
    };
    SurfaceExtents::of_bands(width, rows.into_par_iter().map(of_band).collect::<Vec<_>>())
}

/// The surface extent that a pixel needs for the correction of its kernel.
#[derive(Clone, Copy)]
enum Need<'v> {
    Nothing,
    PerSample,
    /// An surface extent around this point, with this reach in m.
    SurfaceExtent(&'v VisiblePoint, f64),
}

/// Measures a block of pixels, which share planes. `needs` tells their places.
fn measure_block(geometry: &Geometry, needs: &[(usize, Need<'_>)], of_pixels: &mut [SurfaceExtentSurvey]) {
    let mut measured: Vec<SurfaceExtent> = Vec::new();
    for (nth, &(place, need)) in needs.iter().enumerate() {
        let (point, radius_m) = match need {
            Need::Nothing => continue,
            Need::PerSample => {
                of_pixels[place] = SurfaceExtentSurvey::Varies;
                continue;
            }
            Need::SurfaceExtent(point, radius_m) => (point, radius_m),
        };
        let shared = measured.iter().find_map(|surface_extent| surface_extent.moved_to(point, radius_m));
        let surface_extent = shared.unwrap_or_else(|| {
            let search_m = shared_search_m(point, radius_m, &needs[nth + 1..]);
            let wide = SurfaceExtent::around(geometry, point, search_m);
            let own = wide.moved_to(point, radius_m);
            measured.push(wide.clone());
            own.unwrap_or(wide)
        });
        if surface_extent.is_limited() {
            of_pixels[place] = SurfaceExtentSurvey::Measured(surface_extent);
        }
    }
}

/// Returns the reach (m) that other pixels share, or of this pixel alone.
fn shared_search_m(point: &VisiblePoint, radius_m: f64, others: &[(usize, Need<'_>)]) -> f64 {
    let search_for = |&(_, need): &(usize, Need<'_>)| match need {
        Need::SurfaceExtent(other, radius_m) if other.facing == point.facing => {
            Some(SurfaceExtent::search_to_move(other.position.distance(point.position) + radius_m))
        }
        Need::Nothing | Need::PerSample | Need::SurfaceExtent(..) => None,
    };
    let near = others.iter().filter_map(search_for).filter(|&search_m| search_m <= WIDEST_SHARED * radius_m);
    near.reduce(f64::max).map_or(radius_m, |search_m| search_m.max(SurfaceExtent::search_to_move(radius_m)))
}

fn distance_to_box(point: DVec3, (low, high): &Bounds) -> f64 {
    point.distance(point.clamp(*low, *high))
}

/// Returns true if the kernel of a pixel's visible point may cross an edge of the visible surface:
/// if a pixel in one of eight directions, at several distances up to the kernel radius and at most
/// `farthest_px` away, is outside the picture, sees no surface, or sees one that does not continue
/// this one.
fn may_cross_edge(
    visible: &[Option<VisiblePoint>],
    pixel: usize,
    (radius_m, farthest_px): (f64, f64),
    width: usize,
) -> bool {
    let Some(here) = &visible[pixel] else { return false };
    let height = visible.len() / width;
    let (x, y) = ((pixel % width) as isize, (pixel / width) as isize);
    let steps = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
    let ends_at = |(dx, dy): (isize, isize), distance_px: isize| {
        let (i, j) = (x + dx * distance_px, y + dy * distance_px);
        if i < 0 || j < 0 || i >= width as isize || j >= height as isize {
            return true;
        }
        visible[j as usize * width + i as usize]
            .as_ref()
            .is_none_or(|there| !here.continues_to(there.position, there.facing))
    };
    EDGE_DISTANCES.iter().any(|fraction| {
        let distance_px = (fraction * radius_m / here.footprint_m).ceil().clamp(1.0, farthest_px);
        steps.into_iter().any(|step| ends_at(step, distance_px as isize))
    })
}
