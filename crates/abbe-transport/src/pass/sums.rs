//! The results summed over passes.

use crate::plan::Tally;
use crate::sensor::Film;
use crate::walk::ledger::Ledger;
use serde::{Deserialize, Serialize};

#[derive(Debug)]
pub struct PassSums {
    pub film: Film,
    /// The energy balance in W, summed over passes.
    pub ledger: Ledger,
    pub tally: Tally,
    pub seconds: StageSeconds,
}

/// Wall-clock time of a render in s, by stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct StageSeconds {
    /// The whole render.
    pub total: f64,
    /// The pilot: learning emission distributions and first kernel radii.
    pub pilot: f64,
    /// Posing the scene.
    pub pose: f64,
    /// Tracing photons.
    pub emit: f64,
    /// Building photon maps and light maps.
    pub map: f64,
    /// Tracing camera paths.
    pub gather: f64,
    /// Developing the film's sums to XYZ.
    pub develop: f64,
}

impl StageSeconds {
    /// Adds the times of another run.
    pub fn add(&mut self, other: &Self) {
        let Self { total, pilot, pose, emit, map, gather, develop } = self;
        *total += other.total;
        *pilot += other.pilot;
        *pose += other.pose;
        *emit += other.emit;
        *map += other.map;
        *gather += other.gather;
        *develop += other.develop;
    }
}
