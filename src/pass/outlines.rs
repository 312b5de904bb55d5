//! The outlines of surfaces around directly visible points.

use super::context::PassContext;
use super::survey::MAX_SURFACE_RADIUS_PX;
use crate::gather::{Outline, OutlineSurvey, Outlines, VisiblePoint};
use crate::map::PixelRadii;
use crate::plan::WavelengthPlan;
use crate::plan::partition::PhotonSet;
use crate::scene::Scene;
use crate::scene::sweep::Bounds;
use glam::DVec3;
use rayon::prelude::*;

/// If a kernel's radius is below this number of pixels, its outline varies within a pixel.
const PIXELS_PER_OUTLINE: f64 = 3.0;

/// The test for edges looks at pixels at these fractions of the kernel radius.
const EDGE_DISTANCES: [f64; 3] = [0.25, 0.5, 1.0];

/// Returns the outlines around visible points. A visible point has an outline if its kernel for
/// indirect light may extend over an edge of the surface.
///
/// `visible` and `radii` contain one entry per pixel. `swept` contains the bounding boxes of moving
/// objects. A point near such a box gets no outline, because the edges near this point may move.
pub(super) fn outlines(
    context: &PassContext<'_>,
    scene: &Scene,
    visible: &[Option<VisiblePoint>],
    swept: &[Bounds],
    radii: &[PixelRadii],
) -> Outlines {
    let set = PhotonSet::of_path(context.plan.wavelengths == WavelengthPlan::Shared);
    let width = scene.camera.width();
    let outline = |pixel: usize| {
        let radius_m = f64::from(radii[pixel].surface[set].indirect);
        let crossing = visible[pixel].as_ref().filter(|_| may_cross_edge(visible, pixel, radius_m, width));
        let Some(point) = crossing else { return OutlineSurvey::Absent };
        let moves = |bounds: &Bounds| distance_to_box(point.position, bounds) <= 2.0 * radius_m;
        if swept.iter().any(moves) {
            OutlineSurvey::Absent
        } else if radius_m < PIXELS_PER_OUTLINE * point.footprint_m {
            OutlineSurvey::Varies
        } else {
            Outline::around(&scene.geometry, point, radius_m).map_or(OutlineSurvey::Absent, OutlineSurvey::Measured)
        }
    };
    let of_pixels: Vec<OutlineSurvey> = (0..visible.len()).into_par_iter().map(outline).collect();
    Outlines::new(width, of_pixels.into_iter())
}

/// Returns the distance of a point from a box, or 0 inside the box.
fn distance_to_box(point: DVec3, (low, high): &Bounds) -> f64 {
    point.distance(point.clamp(*low, *high))
}

/// Returns true if the kernel of a pixel's visible point may cross an edge of the visible surface.
///
/// The function tests pixels in eight directions around this pixel, at several distances up to the
/// kernel radius. The kernel may cross an edge if one of these pixels is outside the picture, sees no
/// surface, or sees a surface that does not continue the surface of this pixel.
fn may_cross_edge(visible: &[Option<VisiblePoint>], pixel: usize, radius_m: f64, width: usize) -> bool {
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
        let distance_px = (fraction * radius_m / here.footprint_m).ceil().clamp(1.0, MAX_SURFACE_RADIUS_PX.indirect);
        steps.into_iter().any(|step| ends_at(step, distance_px as isize))
    })
}
