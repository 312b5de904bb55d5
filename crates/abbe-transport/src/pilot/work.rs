//! The work of a pass in instructions, which the pilot estimates from the events of the trial and
//! never from times, so that it is the same on all machines.

use super::small_pass::TRIALS;
use crate::plan::Tally;

/// The average instructions of each event, which Callgrind measured in benches/scenes. Those of
/// emission and of photons in media are times in these scenes and in bodies of fog, in instructions
/// of the average time.
mod instructions {
    pub(super) const EMITTED_PHOTON: f64 = 2_500.0;
    pub(super) const RAY: f64 = 2_700.0;
    pub(super) const STORED_PHOTON: f64 = 600.0;
    pub(super) const CONNECTION: f64 = 4_000.0;
    pub(super) const RIBBON_NODE: f64 = 12_000.0;
    pub(super) const RIBBON_PIXEL: f64 = 300.0;
    pub(super) const CAMERA_SAMPLE: f64 = 3_000.0;
    pub(super) const GATHERED_PHOTON: f64 = 700.0;
    pub(super) const TABULATED_PHOTON: f64 = 200.0;
    pub(super) const GATHERED_IN_MEDIUM: f64 = 5_000.0;
    pub(super) const PIXEL: f64 = 400.0;
}

/// The work of the parts of a pass, in instructions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Work {
    /// The work that depends neither on the photons nor on the camera samples.
    pub(super) pass: f64,
    pub(super) trace: f64,
    /// The work to paint the ribbon of one path.
    pub(super) paint: f64,
    /// The work to store the indirect photons of one path on surfaces.
    pub(super) store_on_surfaces: f64,
    pub(super) store_in_media: f64,
    /// The work of one camera sample in every pixel, without the photons in the kernels.
    pub(super) sample: f64,
    /// Of the photons in the kernels during these samples, per photon path.
    pub(super) gather_on_surfaces: f64,
    pub(super) gather_in_media: f64,
}

/// The work of camera samples, in instructions.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampleWork {
    sample: f64,
    gather_on_surfaces: f64,
    gather_in_media: f64,
}

impl Work {
    /// Estimates the work from the events of the photon paths and of the camera samples in all
    /// passes of the trial, with `paths` photon paths each, on a film of `pixels` pixels.
    pub(super) fn of_trial(photons: &Tally, samples: &Tally, paths: f64, pixels: f64) -> Self {
        use instructions::*;
        let stored_in_media = (photons.volume_points + photons.volume_beams) as f64;
        let (trace, paint) = (trace(photons), paint(photons));
        let per_path = 1.0 / (paths * TRIALS as f64);
        let per_sample = pixels / samples.camera_samples as f64;
        let SampleWork { sample, gather_on_surfaces, gather_in_media } = SampleWork::of(samples);
        Self {
            pass: PIXEL * pixels,
            trace: trace * per_path,
            paint: paint * per_path,
            store_on_surfaces: STORED_PHOTON * photons.stored as f64 * per_path,
            store_in_media: STORED_PHOTON * stored_in_media * per_path,
            sample: sample * per_sample,
            gather_on_surfaces: gather_on_surfaces * per_sample / paths,
            gather_in_media: gather_in_media * per_sample / paths,
        }
    }
}

/// Returns the work of events in the trial or in a pass, in instructions.
pub(super) fn of_events(photons: &Tally, samples: &Tally) -> f64 {
    let stored = photons.stored + photons.volume_points + photons.volume_beams;
    let of_photons = trace(photons) + paint(photons) + instructions::STORED_PHOTON * stored as f64;
    of_photons + SampleWork::of(samples).with_photons(1.0)
}

fn trace(photons: &Tally) -> f64 {
    use instructions::*;
    EMITTED_PHOTON * photons.photons as f64
        + RAY * photons.photon_segments as f64
        + CONNECTION * photons.connections as f64
}

fn paint(photons: &Tally) -> f64 {
    use instructions::*;
    RIBBON_NODE * photons.ribbon_nodes as f64 + RIBBON_PIXEL * photons.ribbon_pixels as f64
}

impl SampleWork {
    pub(super) fn of(tally: &Tally) -> Self {
        use instructions::*;
        let rays = (tally.camera_segments + tally.shadow_rays) as f64;
        let gathered = GATHERED_PHOTON * tally.gathered as f64 + TABULATED_PHOTON * tally.tabulated as f64;
        Self {
            sample: CAMERA_SAMPLE * tally.camera_samples as f64 + RAY * rays,
            gather_on_surfaces: gathered,
            gather_in_media: GATHERED_IN_MEDIUM * tally.volume_gathered as f64,
        }
    }

    pub(super) fn with_photons(&self, multiple: f64) -> f64 {
        self.sample + multiple * (self.gather_on_surfaces + self.gather_in_media)
    }
}
