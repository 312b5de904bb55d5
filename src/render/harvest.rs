//! What is kept of the photons: some connected to the camera, some stored for the maps.

use crate::emit::{Arrival, Collision, Crossing, Receiver, connect::connect};
use crate::map::{Beam, Load, Photon, VolumePhoton};
use crate::math::random::Stream;
use crate::plan::partition::{Estimator, LightPath, View, estimator, kept_in_map};
use crate::plan::{AperturePlan, CausticPlan, IndirectPlan, Plan, WavelengthPlan};
use crate::scene::Scene;
use crate::sensor::SplatSink;
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
    pub(super) points: Vec<VolumePhoton>,
    pub(super) beams: Vec<Beam>,
    /// The probability with which a beam is kept.
    beam_share: f64,
    pub(super) splats: SplatSink,
    pub(super) tally: Tally,
}

impl<'a> Harvest<'a> {
    pub(super) fn new(scene: &'a Scene, plan: &'a Plan, (set, beam_share): (Set, f64), splats: SplatSink) -> Self {
        Self {
            scene,
            plan,
            set,
            caustic: Vec::new(),
            indirect: Vec::new(),
            points: Vec::new(),
            beams: Vec::new(),
            beam_share,
            splats,
            tally: Tally::default(),
        }
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
            AperturePlan::Pinhole | AperturePlan::LensSystem => [0.5; 2],
            AperturePlan::ThinLens => stream.pair(),
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

    fn cross(&mut self, crossing: &Crossing<'_>, stream: &mut Stream) {
        let Crossing { stretch, medium, path, wavelengths, power, lane } = crossing;
        let here = &self.scene.media[*medium];
        let kept = self.plan.volume.keeps_beams(here.dense) && here.scatters() && stretch.length_m.is_finite();
        if kept && *path != LightPath::Direct && stream.uniform() < self.beam_share {
            self.tally.volume_beams += 1;
            let end = stretch.ray.at(stretch.length_m);
            let load = Load::new(wavelengths, power.map(|power| power / self.beam_share), *lane);
            self.beams.push(Beam::new(stretch.ray.origin, end, *medium, load));
        }
    }

    fn collide(&mut self, collision: &Collision, _stream: &mut Stream) {
        let Collision { position, incoming, medium, path, wavelengths, power, lane } = collision;
        let here = &self.scene.media[*medium];
        if self.plan.volume.keeps_points(here.dense) && here.scatters() && *path != LightPath::Direct {
            self.tally.volume_points += 1;
            self.points.push(VolumePhoton::new(*position, *incoming, *medium, Load::new(wavelengths, *power, *lane)));
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
    Photon::new(Load::new(&arrival.wavelengths, arrival.power, arrival.lane), to_light, facing)
}
