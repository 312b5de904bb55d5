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
/// lower limit of the sine. Without a limit, the estimate would be infinite for a parallel ray. The
/// light that the limit removes counts as bias.
const LEAST_SINE: f64 = 1e-3;

/// The lower limit of the sine in the estimate of the bias. The bias bars must stay finite.
const LEAST_SINE_OF_BIAS: f64 = 1e-6;

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

    /// Returns the number of the medium if the kernel of the beam intersects the ray of the cone.
    pub fn medium_near_ray(&self, cone: &QueryCone) -> Option<usize> {
        self.near_ray((0.0, 1.0), cone).map(|near| near.medium)
    }

    /// Returns the beam if two conditions are true. First, the closest approach of the beam and the
    /// ray must lie on the ray and on a part of the beam. The two numbers of `part` are the start
    /// and the end of the part, as fractions of the beam's length. Second, the distance between the
    /// beam and the ray must be less than the kernel radius at this place.
    fn near_ray(&self, part: (f64, f64), cone: &QueryCone) -> Option<PhotonNearRay<'_>> {
        let (start, end) = self.ends();
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
        if !(s >= part.0 * length && s < part.1 * length) {
            return None;
        }
        let sine = sine2.sqrt();
        let offset = offset.dot(across) / sine2 * across;
        let (distance, radius) = (offset.length(), cone.radius_at(t));
        (distance < radius).then(|| PhotonNearRay {
            power: &self.power,
            incoming,
            medium: usize::from(self.medium),
            t,
            offset,
            radius_m: radius,
            kernels: kernel::on_line(distance, radius)
                .limited(sine.max(LEAST_SINE).recip(), sine.max(LEAST_SINE_OF_BIAS).recip()),
            beam: Some(BeamPath { start, distance_m: s }),
        })
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

    /// Returns the beam if its closest approach to the ray lies on this piece, and if the kernel
    /// there contains the ray.
    pub(super) fn near_ray<'m>(&self, beams: &'m [PhotonBeam], cone: &QueryCone) -> Option<PhotonNearRay<'m>> {
        beams[self.beam as usize].near_ray(self.span(), cone)
    }
}
