//! Traces a set of photons on all threads.

use super::deposits::PhotonDeposits;
use super::recorder::{PhotonRecorder, RecordingOptions};
use crate::emit::{PhotonSource, trace};
use crate::plan::partition::{PhotonClass, PhotonSet};
use crate::plan::{Plan, Tally};
use crate::sensor::SplatSink;
use crate::walk::ledger::Ledger;
use rayon::prelude::*;

/// The photon paths of one parallel task. They are recorded together, so this number fixes the
/// order of the stored photons.
const PHOTONS_PER_TASK: u64 = 2048;

#[derive(Debug, Default)]
pub(crate) struct TracedPhotons {
    pub(crate) deposits: PhotonDeposits,
    /// The contributions of connections to the camera, one sink per task.
    pub(crate) splats: Vec<SplatSink>,
    /// The photons beyond the depth limit of the scene, for the estimated bias.
    pub(crate) truncated: PhotonDeposits,
    pub(crate) truncated_splats: Vec<SplatSink>,
    /// The energy balance in W.
    pub(crate) ledger: Ledger,
    pub(crate) tally: Tally,
}

/// Traces all photons of a source on the current thread pool, with the same result for any number
/// of threads. `splat_sink` creates an empty sink for connections to the camera.
pub(crate) fn trace_photons(
    source: &PhotonSource<'_>,
    plan: &Plan,
    set: PhotonSet,
    options: RecordingOptions<'_>,
    splat_sink: impl Fn() -> SplatSink + Sync,
) -> TracedPhotons {
    let points = source.points();
    let tasks = (0..source.count.div_ceil(PHOTONS_PER_TASK))
        .into_par_iter()
        .map(|task: u64| {
            let mut recorder = PhotonRecorder::new(source.scene, source.spectra, plan, set, options, &splat_sink);
            let mut ledger = Ledger::new(source.scene.materials.len());
            let indices = task * PHOTONS_PER_TASK..((task + 1) * PHOTONS_PER_TASK).min(source.count);
            trace(source, &points, indices, &mut recorder, &mut ledger);
            recorder.finish();
            (recorder, ledger)
        })
        .collect::<Vec<_>>();
    let mut traced = TracedPhotons::default();
    for class in PhotonClass::ALL {
        let count = tasks.iter().map(|(recorder, _)| recorder.deposits.surface[class].len()).sum();
        traced.deposits.surface[class].reserve_exact(count);
    }
    for (recorder, ledger) in tasks {
        traced.deposits.append(&recorder.deposits);
        traced.splats.push(recorder.splats);
        traced.truncated.append(&recorder.truncated);
        traced.truncated_splats.push(recorder.truncated_splats);
        traced.tally.add(&recorder.tally);
        traced.ledger.add(&ledger);
    }
    traced
}
