//! Photon beams (Jarosz, Nowrouzezahrai, Sadeghi & Jensen 2011, "A Comprehensive Theory of
//! Volumetric Radiance Estimation Using Photon Points and Beams"). A beam is a whole segment of a
//! photon path. The kernel is one-dimensional: it lies on the line perpendicular to the beam and to
//! the camera ray.

use super::{BeamPath, PhotonNearRay};
use crate::map::kernel;
use crate::map::photon::PhotonPower;
use crate::map::query_cone::QueryCone;
use glam::{DVec3, Vec3};

/// A segment of a photon path in a medium.
#[derive(Debug, Clone, Copy)]
pub struct PhotonBeam {
    start: [f32; 3],
    end: [f32; 3],
    medium: u16,
    /// The power at the start.
    power: PhotonPower,
}

/// One piece of a beam.
#[derive(Debug, Clone, Copy)]
pub(super) struct BeamPiece {
    beam: u32,
    /// The number of this piece, counted from 0.
    number: u16,
    /// The number of pieces of the beam.
    count: u16,
}

/// The estimate is divided by the sine of the angle between a beam and a ray. This constant is the
/// lower limit of the sine. Without a limit, the estimate would be infinite for a parallel ray.
const LEAST_SINE: f64 = 1e-3;

/// The number of pieces of the longest beam. Pieces of all beams have about the same length.
const MOST_PIECES: f64 = 48.0;

impl PhotonBeam {
    /// Creates a beam in the medium number `medium`. The two positions are the start and the end of
    /// the beam. They are in m, relative to the scene's centre. `power` is the power at the start.
    pub fn new([start, end]: [DVec3; 2], medium: usize, power: PhotonPower) -> Self {
        let point = |p: DVec3| p.as_vec3().to_array();
        Self { start: point(start), end: point(end), medium: medium as u16, power }
    }

    fn ends(&self) -> (DVec3, DVec3) {
        (Vec3::from(self.start).as_dvec3(), Vec3::from(self.end).as_dvec3())
    }

    fn length(&self) -> f64 {
        let (start, end) = self.ends();
        (end - start).length()
    }
}

/// Cuts beams into pieces of about equal length.
pub(super) fn pieces(beams: &[PhotonBeam]) -> Vec<BeamPiece> {
    let longest = beams.iter().map(PhotonBeam::length).fold(0.0, f64::max);
    let mut pieces = Vec::with_capacity(beams.len() * 8);
    for (number, beam) in beams.iter().enumerate() {
        let count = (beam.length() / longest * MOST_PIECES).ceil().clamp(1.0, MOST_PIECES) as u16;
        pieces.extend((0..count).map(|piece| BeamPiece { beam: number as u32, number: piece, count }));
    }
    pieces
}

impl BeamPiece {
    /// Returns the start and the end of the piece, as fractions of the beam's length.
    fn span(&self) -> (f64, f64) {
        let count = f64::from(self.count);
        (f64::from(self.number) / count, f64::from(self.number + 1) / count)
    }

    /// Returns the least and the largest coordinates of the piece.
    pub(super) fn bounds(&self, beams: &[PhotonBeam]) -> (Vec3, Vec3) {
        let (start, end) = beams[self.beam as usize].ends();
        let (from, to) = self.span();
        let (a, b) = (start.lerp(end, from).as_vec3(), start.lerp(end, to).as_vec3());
        (a.min(b), a.max(b))
    }

    /// Returns the beam if two conditions are true. First, the closest approach of the beam and the
    /// ray must lie on this piece and on the ray. Second, the distance between the beam and the ray
    /// must be less than the kernel radius at this place.
    pub(super) fn near_ray<'m>(&self, beams: &'m [PhotonBeam], cone: &QueryCone) -> Option<PhotonNearRay<'m>> {
        let beam = &beams[self.beam as usize];
        let (start, end) = beam.ends();
        let along = end - start;
        let length = along.length();
        if length <= 0.0 {
            return None;
        }
        let (incoming, direction) = (along / length, cone.ray.direction);
        let across = direction.cross(incoming);
        let sine2 = across.length_squared();
        if sine2 <= 0.0 {
            return None;
        }
        let offset = start - cone.ray.origin;
        let t = offset.cross(incoming).dot(across) / sine2;
        if !(t > 0.0 && t < cone.length_m) {
            return None;
        }
        let s = offset.cross(direction).dot(across) / sine2;
        let (from, to) = self.span();
        if !(s >= from * length && s < to * length) {
            return None;
        }
        let sine = sine2.sqrt();
        let (distance, radius) = ((offset.dot(across) / sine).abs(), cone.radius_at(t));
        (distance < radius).then(|| PhotonNearRay {
            power: &beam.power,
            incoming,
            medium: usize::from(beam.medium),
            t,
            kernels: kernel::on_line(distance, radius).times(1.0 / sine.max(LEAST_SINE)),
            beam: Some(BeamPath { start, distance_m: s }),
        })
    }
}
