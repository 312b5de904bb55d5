//! One pass of the reference path tracer.

use super::context::PassContext;
use super::exposure::expose_rows;
use super::first_surface::first_surface;
use super::sums::PassSums;
use crate::gather::{DirectLighting, PathTracer, PixelSampler};
use abbe_spectra::error::Result;
use abbe_spectra::math::random::Purpose;
use web_time::Instant;

/// Traces one pass and adds it to `sums`. Returns false if the context's flag is raised before the
/// end of the pass, whose light is then not added, and an error if the scene cannot be posed.
pub fn path_pass(context: PassContext<'_>, pass: u64, sums: &mut PassSums) -> Result<bool> {
    let PassContext { plan, budget, lights, .. } = context;
    let scene = context.scene_of_pass(pass, sums)?;
    let start = Instant::now();
    let selector = context.light_selector(&scene);
    let direct = DirectLighting::tracked(&scene, &selector, plan.media_plan);
    let without_glass = direct.passes_panes().then(|| context.portals.without_glass());
    let tracer = PathTracer {
        scene: &scene,
        direct: direct
            .with_polarisation(plan.polarisation.is_on())
            .with_portals(without_glass.as_ref().unwrap_or(context.portals)),
        media_plan: plan.media_plan,
        polarised: plan.polarisation.is_on(),
        stokes: plan.polarisation.records_stokes(),
        wavelengths: &lights.wavelengths,
        spectra: context.spectra,
        excitation: &lights.excitation,
        stop: context.stop,
    };
    let records_surfaces = sums.film.records_surfaces(pass);
    let streams = budget.seed.streams(Purpose::Camera);
    // A picture has one sample per pixel and pass, so that the first picture appears early.
    let samples = if sums.film.measures() { budget.camera_samples.unwrap_or(1) } else { 1 };
    let is_whole = expose_rows(sums, (pass, context.stop), |row, tally| {
        row.expose(|pixel, sink| {
            for nth in 0..samples {
                let sampler = || PixelSampler::nth(streams, pass, pixel as u64, (nth, samples));
                tracer.sample(pixel as u64, sampler(), tally, sink);
                if records_surfaces && !context.stop.is_raised() {
                    sink.add_surface(first_surface(&scene, pixel as u64, sampler()).as_ref());
                }
            }
            samples
        })
    });
    if is_whole {
        sums.film.count_pass(pass);
    }
    sums.seconds.gather += start.elapsed().as_secs_f64();
    Ok(is_whole)
}
