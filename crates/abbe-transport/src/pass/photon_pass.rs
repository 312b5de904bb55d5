//! One pass of photon mapping: trace photons, build maps, trace camera paths.

use super::context::{EmissionRequest, PassContext};
use super::exposure::expose_rows;
use super::first_surface::first_surface;
use super::parameters::PassParameters;
use super::recorder::RecordingOptions;
use super::sensors::SensorKernels;
use super::sums::PassSums;
use super::trace::trace_photons;
use crate::gather::{CameraPass, PathBuffers, PixelSampler, TruncatedMaps};
use crate::map::radius::{scale, scales};
use crate::map::{LightMaps, SetMaps};
use crate::plan::partition::{PerSet, PhotonSet};
use crate::walk::DepthLimit;
use crate::walk::ledger::Ledger;
use abbe_scene::Scene;
use abbe_spectra::error::Result;
use abbe_spectra::math::random::Purpose;
use std::borrow::Cow;
use web_time::Instant;

/// Traces one pass of photon mapping and adds it to `sums`. `light_maps` holds those of earlier
/// passes, which a still scene reuses or updates. Returns false if the context's flag is raised
/// before the end of the pass, whose light is then not added, and an error if the scene cannot be
/// posed.
pub fn photon_pass<'a>(
    context: PassContext<'a>,
    parameters: &PassParameters,
    light_maps: &mut LightMaps<'a>,
    pass: u64,
    sums: &mut PassSums,
) -> Result<bool> {
    let PassContext { plan, budget, stop, .. } = context;
    let scene = context.scene_of_pass(pass, sums)?;

    let start = Instant::now();
    let shared = context.shared_wavelengths(pass);
    let film = &sums.film;
    let scales = scales(pass, parameters.stored_photons);
    let first = (parameters.sensor_radii.as_slice(), scale(pass, 2));
    let sensors = SensorKernels::of_pass(&context, &scene, first, parameters.photons_per_sample().free);
    let traced = PerSet::from_fn(|set| {
        let purpose = match set {
            PhotonSet::Free => Purpose::FreePhoton,
            PhotonSet::Shared => Purpose::SharedPhoton,
        };
        let request =
            EmissionRequest { wavelengths: shared.sampling(set), count: parameters.photons[set], purpose, pass };
        let source = parameters.photon_source(&context, &scene, request);
        // Only free photons have wavelengths of their own: all those of the lights.
        let received = sensors.as_ref().filter(|_| set == PhotonSet::Free);
        let recording = RecordingOptions { sensors: received, ..parameters.recording(set) };
        trace_photons(&source, plan, set, recording, || film.splat_sink().of_pass(pass))
    });
    sums.seconds.emit += start.elapsed().as_secs_f64();
    if stop.is_raised() {
        return Ok(false);
    }

    let start = Instant::now();
    let PerSet { free, shared: on_shared } = traced;
    let maps = PerSet { free: free.deposits.into_maps(), shared: on_shared.deposits.into_maps() };
    let truncated = PerSet { free: free.truncated.into_maps(), shared: on_shared.truncated.into_maps() };
    let mut own_light_maps = LightMaps::default();
    let light_maps = match &scene {
        Cow::Borrowed(still) => updated(light_maps, &context, still, pass),
        Cow::Owned(posed) => updated(&mut own_light_maps, &context, posed, pass),
    };
    sums.seconds.map += start.elapsed().as_secs_f64();

    let start = Instant::now();
    let selector = context.light_selector(&scene);
    let camera_pass = CameraPass {
        truncated: truncated_maps(&context, [&free.ledger, &on_shared.ledger], &truncated),
        scales,
        sensors: sensors.as_ref().map_or(&[], SensorKernels::weights),
        ..parameters.camera_pass(&context, (&scene, &selector), (&maps, light_maps), shared)
    };
    let records_surfaces = sums.film.records_surfaces(pass);
    let streams = budget.seed.streams(Purpose::Camera);
    let is_whole = expose_rows(sums, (pass, stop), |row, tally| {
        let mut buffers = PathBuffers::default();
        row.expose(|pixel, sink| {
            let samples = parameters.camera_samples.of(pixel);
            for nth in 0..samples {
                let sampler = || PixelSampler::nth(streams, pass, pixel as u64, (nth, samples));
                camera_pass.sample(pixel as u64, sampler(), &parameters.radii.of(pixel), &mut buffers, tally, sink);
                if records_surfaces && !stop.is_raised() {
                    sink.add_surface(first_surface(&scene, pixel as u64, sampler()).as_ref());
                }
            }
            samples
        })
    });
    if !is_whole {
        return Ok(false);
    }
    for (splats, tally) in [(&free.splats, &free.tally), (&on_shared.splats, &on_shared.tally)] {
        for splats in splats {
            sums.tally.rejected += sums.film.add_splats(pass, splats);
        }
        sums.tally.add(tally);
    }
    for splats in free.truncated_splats.iter().chain(&on_shared.truncated_splats) {
        sums.film.add_truncated_splats(pass, splats);
    }
    sums.film.count_pass(pass);
    sums.seconds.gather += start.elapsed().as_secs_f64();

    // Each set alone represents the whole emission, so the ledger of the pass is their mean,
    // weighted by the numbers of photons.
    let total = (parameters.photons.free + parameters.photons.shared) as f64;
    for (mut ledger, count) in [(free.ledger, parameters.photons.free), (on_shared.ledger, parameters.photons.shared)] {
        ledger.scale(count as f64 / total);
        sums.ledger.add(&ledger);
    }
    Ok(true)
}

/// Returns the light that is missing because photon paths ended at a limit, from the photons within
/// the limit and those `truncated` by an explicit limit.
///
/// At the cap, scattered photons have been in the same cavity for thousands of events, so their
/// power falls by the same ratio from event to event. The power of the missing photons, divided by
/// that of the stored ones, is then c/(1 − c) for the fraction c of the emitted power that reaches
/// the cap. Photons that were never scattered are trapped in glass by total reflection, and do not
/// leave it.
fn truncated_maps<'m>(
    context: &PassContext<'_>,
    ledgers: [&Ledger; 2],
    truncated: &'m PerSet<SetMaps>,
) -> Option<TruncatedMaps<'m>> {
    if DepthLimit::of(context.scene).is_explicit() {
        return Some(TruncatedMaps::Explicit { beyond: truncated.as_ref() });
    }
    let sum = |power: fn(&Ledger) -> f64| ledgers.iter().map(|ledger| power(ledger)).sum::<f64>();
    let (capped, emitted) = (sum(|ledger| ledger.depth_limit_indirect), sum(|ledger| ledger.emitted));
    (capped > 0.0).then(|| TruncatedMaps::Cap { factor: ratio_beyond_cap(capped, emitted) })
}

/// Returns the ratio of the power beyond the cap and before. `capped` of `emitted` reaches it.
fn ratio_beyond_cap(capped: f64, emitted: f64) -> f64 {
    /// The largest ratio. In a lossless cavity, the ratio would be infinite.
    const LARGEST: f64 = 1e6;
    (capped / (emitted - capped)).clamp(0.0, LARGEST)
}

fn updated<'m, 'a>(
    maps: &'m mut LightMaps<'a>,
    context: &PassContext<'_>,
    scene: &'a Scene,
    pass: u64,
) -> &'m LightMaps<'a> {
    if context.plan.media_plan.has_light_maps() {
        maps.update(scene, context.budget.light_map_cells(pass), context.budget.seed, pass);
    }
    maps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If the fraction c reaches the cap, the light beyond is c + c² + c³ + … times that before.
    #[test]
    fn light_beyond_the_cap_is_a_geometric_series() {
        for fraction in [0.01_f64, 0.3, 0.9] {
            let series: f64 = (1..2000).map(|power| fraction.powi(power)).sum();
            assert!((ratio_beyond_cap(2.0 * fraction, 2.0) / series - 1.0).abs() < 1e-12, "{fraction}");
        }
        assert_eq!([ratio_beyond_cap(0.0, 1.0), ratio_beyond_cap(1.0, 1.0)], [0.0, 1e6]);
    }
}
