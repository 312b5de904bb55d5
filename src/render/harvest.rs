//! What is kept of the photons: some connected to the camera, some stored for the maps.

use crate::emit::{Arrival, Receiver, connect::connect};
use crate::map::Photon;
use crate::math::random::Stream;
use crate::plan::partition::{Estimator, LightPath, View, estimator, kept_in_map};
use crate::plan::{AperturePlan, CausticPlan, IndirectPlan, Plan, WavelengthPlan};
use crate::scene::Scene;
use crate::sensor::SplatSink;
use crate::spectrum::LANES;
use crate::walk::Tally;

/// A photon and its place (m, relative to the scene's centre).
pub(super) type Placed = (Photon, [f32; 3]);

/// Which photons these are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Set {
    /// With wavelengths of their own.
    Free,
    /// On the pass's shared wavelengths.
    Shared,
}

/// One worker's harvest.
#[derive(Debug)]
pub(super) struct Harvest<'a> {
    scene: &'a Scene,
    plan: &'a Plan,
    set: Set,
    pub(super) caustic: Vec<Placed>,
    pub(super) indirect: Vec<Placed>,
    pub(super) splats: SplatSink,
    pub(super) tally: Tally,
}

impl<'a> Harvest<'a> {
    pub(super) fn new(scene: &'a Scene, plan: &'a Plan, set: Set, splats: SplatSink) -> Self {
        Self { scene, plan, set, caustic: Vec::new(), indirect: Vec::new(), splats, tally: Tally::default() }
    }

    /// Connects an arrival to the camera, if the partition leaves it to connections.
    fn connect(&mut self, arrival: &Arrival<'_>, stream: &mut Stream) {
        let class = arrival.encounter.surface.class();
        let connects = estimator(arrival.path, class, View::Seen) == Estimator::Connection;
        // Camera paths that take shared wavelengths from the start leave connections to nobody: the map serves them.
        let free = self.set == Set::Free && self.plan.wavelengths != WavelengthPlan::Shared;
        if !(free && connects) {
            return;
        }
        let lens = match self.plan.aperture {
            AperturePlan::Pinhole | AperturePlan::LensSystem(_) => [0.5; 2],
            AperturePlan::ThinLens(_) => stream.pair(),
        };
        if let Some(splat) = connect(self.scene, arrival, lens) {
            self.tally.connections += 1;
            let lanes = arrival.wavelengths.active().iter().copied().zip(splat.radiance);
            self.splats.splat(splat.pixel, lanes);
        }
    }
}

impl Receiver for Harvest<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_>, stream: &mut Stream) {
        let wanted = match arrival.path {
            LightPath::Direct => false,
            LightPath::Caustic => self.plan.caustics != CausticPlan::Absent,
            LightPath::Indirect => self.plan.indirect != IndirectPlan::Absent,
        };
        if !wanted {
            return;
        }
        self.connect(arrival, stream);
        let mut components = self.scene.materials[arrival.encounter.material].surface.components();
        if components.any(|surface| kept_in_map(arrival.path, surface.class())) {
            self.tally.stored += 1;
            let placed = (stored(arrival), arrival.encounter.hit.position.as_vec3().to_array());
            match arrival.path {
                LightPath::Direct | LightPath::Caustic => self.caustic.push(placed),
                LightPath::Indirect => self.indirect.push(placed),
            }
        }
    }

    fn depart(&mut self, _light: usize, _cell: usize) {
        self.tally.photons += 1;
        self.tally.shared_photons += u64::from(self.set == Set::Shared);
        self.tally.aimed += u64::from(self.plan.aim == crate::plan::AimPlan::Learned);
    }
}

/// What is kept of an arrival.
fn stored(arrival: &Arrival<'_>) -> Photon {
    let hit = &arrival.encounter.hit;
    let to_light = arrival.to_light();
    let facing = if to_light.dot(hit.normal) >= 0.0 { hit.normal } else { -hit.normal };
    let lane = if arrival.wavelengths.count == LANES { 0 } else { arrival.lane };
    let mut photon = Photon::new(to_light, facing, arrival.wavelengths.count, lane);
    photon.nm = arrival.wavelengths.nm.map(|nm| nm as f32);
    photon.power = arrival.power.map(|power| power as f32);
    photon
}
