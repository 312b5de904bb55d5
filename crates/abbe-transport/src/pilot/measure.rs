//! The measurements of the pilot: radii, probabilities of storing photons, and surface extents.

use super::surface_extents::surface_extents;
use super::survey::PixelSurvey;
use super::volume_radii::{VolumeKernelWidths, keep_probabilities};
use crate::gather::{SurfaceExtents, VisiblePoint};
use crate::map::FirstRadii;
use crate::map::radius::scales;
use crate::pass::{CameraSamples, PassContext, PassParameters};
use crate::plan::IndirectPlan;
use crate::plan::partition::PerSet;
use abbe_scene::Scene;
use std::borrow::Cow;

/// If both sets are in use, each set receives at least this fraction of the photons.
const MIN_SET_FRACTION: f64 = 0.08;

/// Measures the radii, the probabilities of storing photons in media, and the division of the
/// photons between the sets. Returns the visible point of each pixel. Surface extents follow in
/// [`measure_surface_extents`].
pub(super) fn measure(
    parameters: &mut PassParameters,
    context: &PassContext<'_>,
    scenes: &[Cow<'_, Scene>],
) -> Vec<Option<VisiblePoint>> {
    parameters.photons = even_division(context.plan.photon_sets(), context.budget.photons);
    parameters.camera_samples = CameraSamples::Same(1);
    parameters.surface_extents = SurfaceExtents::default();
    let mut survey = PixelSurvey::default();
    for (moment, scene) in (0..).zip(scenes) {
        let moment = (moment, scenes.len());
        survey.merge(PixelSurvey::of_moment(context, scene, moment, &parameters.strata, parameters.photons));
    }
    let PixelSurvey { mut radii, visible, volume, stored, readers } = survey;
    let widths = VolumeKernelWidths::of(context);
    parameters.keep = keep_probabilities(&volume, stored, &widths);
    for (radii, counts) in radii.iter_mut().zip(volume) {
        counts.set_radii(radii, parameters.keep, &widths);
    }
    // The paths of a sensor reach surfaces everywhere, so no radius suits the others.
    parameters.radii = FirstRadii::with_medians(&radii, context.scene.measures());
    if context.plan.photon_sets() == (PerSet { free: true, shared: true }) {
        parameters.photons = divided(context.budget.photons, readers);
    }
    visible
}

/// Measures the surface extents around the visible points, up to the kernel radii of pass 0.
pub(super) fn measure_surface_extents(
    parameters: &mut PassParameters,
    context: &PassContext<'_>,
    scene: &Scene,
    visible: &[Option<VisiblePoint>],
) {
    // A moving camera changes the visible point of a pixel from pass to pass, so nothing is stored.
    let in_place = context.plan.indirect != IndirectPlan::Absent && !parameters.final_gather;
    if in_place && context.scene.motions.camera.is_none() {
        let scale = scales(0, parameters.stored_photons).surface.indirect;
        let swept = context.scene.swept_boxes();
        parameters.surface_extents = surface_extents(context, scene, visible, &swept, (&parameters.radii, scale));
    }
}

/// Divides the photons evenly between the sets that are in use.
fn even_division(in_use: PerSet<bool>, photons: u64) -> PerSet<u64> {
    let fraction = if in_use.free && in_use.shared { (photons / 2).max(1) } else { photons };
    PerSet::from_fn(|set| if in_use[set] { fraction } else { 0 })
}

/// Divides the photons between the sets in proportion to the number of pixels that read each set.
fn divided(photons: u64, readers: PerSet<u64>) -> PerSet<u64> {
    let total = (readers.free + readers.shared).max(1) as f64;
    let fraction = (readers.shared as f64 / total).clamp(MIN_SET_FRACTION, 1.0 - MIN_SET_FRACTION);
    let shared = ((photons as f64 * fraction) as u64).max(1);
    PerSet { free: (photons - shared.min(photons)).max(1), shared }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photons_are_divided_by_the_pixels_that_read_them() {
        assert_eq!(divided(1000, PerSet { free: 75, shared: 25 }), PerSet { free: 750, shared: 250 });
        assert_eq!(divided(1000, PerSet { free: 75, shared: 0 }), PerSet { free: 920, shared: 80 });
        assert_eq!(divided(1, PerSet { free: 0, shared: 0 }), PerSet { free: 1, shared: 1 });
    }
}
