//! What is kept of the photons: some connected to the camera, some stored for the maps.

use super::crowd::Shares;
use crate::emit::{Arrival, Collision, Crossing, Receiver, connect::connect};
use crate::map::{Beam, Load, Photon, VolumeMap, VolumeMaps, VolumePhoton};
use crate::math::random::Stream;
use crate::plan::partition::{Estimator, LightPath, View, estimator, kept_in_map};
use crate::plan::{AperturePlan, CausticPlan, IndirectPlan, Plan, WavelengthPlan};
use crate::scene::Scene;
use crate::sensor::SplatSink;
use crate::walk::Tally;

/// A photon and its place (m, relative to the scene's centre).
pub(super) type Placed = (Photon, [f32; 3]);

/// Photons of one class of paths in media.
#[derive(Debug, Default)]
pub(super) struct InMedia {
    pub(super) points: Vec<VolumePhoton>,
    pub(super) beams: Vec<Beam>,
}

impl InMedia {
    pub(super) fn add(&mut self, other: &Self) {
        self.points.extend_from_slice(&other.points);
        self.beams.extend_from_slice(&other.beams);
    }

    /// The maps; what was kept moves into them.
    pub(super) fn maps(&mut self) -> VolumeMaps {
        VolumeMaps {
            points: VolumeMap::of_points(std::mem::take(&mut self.points)),
            beams: VolumeMap::of_beams(std::mem::take(&mut self.beams)),
        }
    }
}

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
    pub(super) volume_caustic: InMedia,
    pub(super) volume_indirect: InMedia,
    /// The probabilities with which photons in media are kept.
    shares: Shares,
    pub(super) splats: SplatSink,
    pub(super) tally: Tally,
}

impl<'a> Harvest<'a> {
    pub(super) fn new(scene: &'a Scene, plan: &'a Plan, (set, shares): (Set, Shares), splats: SplatSink) -> Self {
        Self {
            scene,
            plan,
            set,
            caustic: Vec::new(),
            indirect: Vec::new(),
            volume_caustic: InMedia::default(),
            volume_indirect: InMedia::default(),
            shares,
            splats,
            tally: Tally::default(),
        }
    }

    /// Where photons of this class are kept in media.
    fn in_media(&mut self, path: LightPath) -> &mut InMedia {
        match path {
            LightPath::Direct | LightPath::Caustic => &mut self.volume_caustic,
            LightPath::Indirect => &mut self.volume_indirect,
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
            AperturePlan::Pinhole | AperturePlan::LensSystem(_) => [0.5; 2],
            AperturePlan::ThinLens(_) => stream.pair(),
        };
        if let Some(splat) = connect(self.scene, self.plan.between, arrival, lens) {
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
        // Photons set out with several wavelengths; a dispersive refraction leaves them one.
        self.tally.dispersions += u64::from(arrival.wavelengths.count == 1);
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

    fn meet_body(&mut self) {
        self.tally.body_events += 1;
    }

    fn cross(&mut self, crossing: &Crossing<'_>, stream: &mut Stream) {
        let Crossing { stretch, medium, path, wavelengths, power, lane } = crossing;
        let here = &self.scene.media[*medium];
        let kept = self.plan.volume.keeps_beams(here.dense) && here.scatters() && stretch.length_m.is_finite();
        let share = self.shares.of(*path).beams;
        if kept && share > 0.0 && stream.uniform() < share {
            self.tally.volume_beams += 1;
            let ends = [stretch.ray.origin, stretch.ray.at(stretch.length_m)];
            let load = Load::new(wavelengths, power.map(|power| power / share), *lane);
            self.in_media(*path).beams.push(Beam::new(ends, *medium, load));
        }
    }

    fn collide(&mut self, collision: &Collision, stream: &mut Stream) {
        let Collision { position, incoming, medium, path, wavelengths, power, lane } = collision;
        let here = &self.scene.media[*medium];
        let share = self.shares.of(*path).points;
        let kept = self.plan.volume.keeps_points(here.dense) && here.scatters();
        if kept && share > 0.0 && stream.uniform() < share {
            self.tally.volume_points += 1;
            let load = Load::new(wavelengths, power.map(|power| power / share), *lane);
            self.in_media(*path).points.push(VolumePhoton::new(*position, *incoming, *medium, load));
        }
    }

    fn depart(&mut self, _light: usize, _aim: [f64; 2]) {
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
    Photon::new(Load::new(arrival.wavelengths, *arrival.power, arrival.lane), to_light, facing)
}
