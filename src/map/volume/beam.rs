//! Photon beams (Jarosz et al. 2011): a photon's whole way through a medium, seen where a ray passes it. The kernel is a line across both.

use super::{Came, Neighbour};
use crate::map::kernel;
use crate::map::near_ray::Cone;
use crate::map::photon::Load;
use glam::{DVec3, Vec3};

/// A photon's way through a medium.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    start: [f32; 3],
    end: [f32; 3],
    medium: u16,
    /// The light that sets out.
    load: Load,
}

/// One piece of a beam.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    beam: u32,
    number: u16,
    count: u16,
}

/// Sines of crossing angles below this are taken for it: rays that run along a beam would see it infinitely bright.
const LEAST_SINE: f64 = 1e-3;

/// Beams are cut into pieces about this long, as a share of the longest.
const PIECES: f64 = 48.0;

impl Beam {
    /// A photon that sets out from the first to the second of `ends` (m, relative to the scene's centre) with this load, in the medium of this
    /// number.
    pub fn new([start, end]: [DVec3; 2], medium: usize, load: Load) -> Self {
        let point = |p: DVec3| p.as_vec3().to_array();
        Self { start: point(start), end: point(end), medium: medium as u16, load }
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
pub(super) fn pieces(beams: &[Beam]) -> Vec<Piece> {
    let longest = beams.iter().map(Beam::length).fold(0.0, f64::max);
    let mut pieces = Vec::with_capacity(beams.len() * 8);
    for (number, beam) in beams.iter().enumerate() {
        let count = (beam.length() / longest * PIECES).ceil().clamp(1.0, PIECES) as u16;
        pieces.extend((0..count).map(|piece| Piece { beam: number as u32, number: piece, count }));
    }
    pieces
}

impl Piece {
    /// The shares of the beam's length at which it starts and ends.
    fn span(&self) -> (f64, f64) {
        let count = f64::from(self.count);
        (f64::from(self.number) / count, f64::from(self.number + 1) / count)
    }

    pub(super) fn bounds(&self, beams: &[Beam]) -> (Vec3, Vec3) {
        let (start, end) = beams[self.beam as usize].ends();
        let (from, to) = self.span();
        let (a, b) = (start.lerp(end, from).as_vec3(), start.lerp(end, to).as_vec3());
        (a.min(b), a.max(b))
    }

    /// The piece as a ray sees it where the two lines are nearest, if that lies on both.
    pub(super) fn seen_from<'m>(&self, beams: &'m [Beam], cone: &Cone) -> Option<Neighbour<'m>> {
        let beam = &beams[self.beam as usize];
        let (start, end) = beam.ends();
        let way = end - start;
        let length = way.length();
        if length <= 0.0 {
            return None;
        }
        let (incoming, direction) = (way / length, cone.ray.direction);
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
        (distance < radius).then(|| Neighbour {
            load: &beam.load,
            incoming,
            medium: usize::from(beam.medium),
            t,
            kernels: kernel::on_line(distance, radius).times(1.0 / sine.max(LEAST_SINE)),
            came: Some(Came { start, distance_m: s }),
        })
    }
}
