//! The importance of photons: how much each part of a light contributes to the picture.

use crate::emit::{MediumCrossing, PhotonState, PhotonVisitor, SurfaceArrival};
use crate::plan::partition::{LightPath, PhotonClass};
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_spectra::math::random::Stream;

/// The importance of photons: the paths of each stratum, with their estimated contributions to the
/// picture.
pub(super) struct Importance<'a> {
    scene: &'a Scene,
    /// For each stratum, two halves, which test each other.
    pub(super) paths: Vec<[Vec<ScoredPath>; 2]>,
    half: usize,
    /// For each object: true if a path reached the object.
    pub(super) reached: Vec<bool>,
    /// The stratum of the current path, and its point of the emission square.
    current: (usize, [f64; 2]),
    start_power: f64,
    surface_score: f64,
    /// Of the current path's segments in media: the largest, because those in a dense medium have
    /// nearly the same information.
    volume_score: f64,
}

/// A path, by its point of the emission square and its estimated contribution.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScoredPath {
    pub(super) point: [f64; 2],
    pub(super) score: f64,
}

impl<'a> Importance<'a> {
    /// Prepares the scoring of the paths of one task. Even and odd tasks form the two halves.
    pub(super) fn new(scene: &'a Scene, strata: usize, task: u64) -> Self {
        Self {
            scene,
            paths: vec![[Vec::new(), Vec::new()]; strata],
            half: (task % 2) as usize,
            reached: vec![false; scene.objects.len()],
            current: (0, [0.0; 2]),
            start_power: 0.0,
            surface_score: 0.0,
            volume_score: 0.0,
        }
    }

    pub(super) fn end_path(&mut self) {
        let (stratum, point) = self.current;
        let path = ScoredPath { point, score: self.surface_score + self.volume_score };
        self.paths[stratum][self.half].push(path);
        (self.surface_score, self.volume_score) = (0.0, 0.0);
    }

    /// Returns the photon's power, divided by its power at the start of the path.
    fn relative_power(&self, photon: &PhotonState) -> f64 {
        photon.power.iter().sum::<f64>() / self.start_power
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (paths, others) in self.paths.iter_mut().zip(&other.paths) {
            paths.iter_mut().zip(others).for_each(|(paths, others)| paths.extend_from_slice(others));
        }
        self.reached.iter_mut().zip(&other.reached).for_each(|(a, b)| *a |= b);
    }
}

impl PhotonVisitor for Importance<'_> {
    fn on_surface(&mut self, arrival: &SurfaceArrival<'_>, _stream: &mut Stream) {
        if arrival.photon.is_truncated() {
            return;
        }
        let in_view = self.scene.camera.connect(arrival.interaction.hit.position, [0.5; 2]).is_some();
        let power = self.relative_power(arrival.photon);
        self.surface_score += power
            * match (arrival.photon.light_path, in_view) {
                (LightPath::Direct, _) => 0.0,
                (LightPath::Caustic, true) => 1.0,
                (LightPath::Indirect, true) => 0.3,
                // The surface may be visible to the camera in a mirror.
                (LightPath::Caustic | LightPath::Indirect, false) => 0.02,
            };
    }

    fn on_medium_crossing(&mut self, crossing: &MediumCrossing<'_>, _stream: &mut Stream) {
        let MediumCrossing { segment, medium, photon } = crossing;
        let Some(class) = photon.light_path.photon_class() else { return };
        if photon.is_truncated() || !medium.medium.scatters() || !segment.length_m.is_finite() {
            return;
        }
        // Estimates the visible fraction of the segment from five points.
        let points = [0.1, 0.3, 0.5, 0.7, 0.9].map(|fraction| segment.ray.at(fraction * segment.length_m));
        let in_view = points.iter().filter(|&&point| self.scene.camera.connect(point, [0.5; 2]).is_some()).count();
        let weight = match class {
            PhotonClass::Caustic => 1.0,
            PhotonClass::Indirect => 0.3,
        };
        self.volume_score = self.volume_score.max(weight * 0.2 * in_view as f64 * self.relative_power(photon));
    }

    fn on_start(&mut self, _ray: &Ray, photon: &PhotonState) {
        self.start_power = photon.power.iter().sum();
    }

    fn on_emission(&mut self, stratum: usize, aim: [f64; 2]) {
        self.current = (stratum, aim);
    }

    fn on_arrival(&mut self, arrival: &SurfaceArrival<'_>) {
        let interaction = arrival.interaction;
        self.reached[interaction.hit.object as usize] = true;
        // A path passes through the faces of a body inside of a body of higher priority.
        interaction.here.bodies().for_each(|object| self.reached[object as usize] = true);
    }
}
