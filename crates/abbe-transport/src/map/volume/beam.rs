//! Photon beams (Jarosz, Nowrouzezahrai, Sadeghi & Jensen 2011, "A Comprehensive Theory of
//! Volumetric Radiance Estimation Using Photon Points and Beams"): whole segments of photon paths.
//! The kernel lies on the line perpendicular to the beam and to the camera ray.

use super::near_ray::{BeamPath, PhotonNearRay};
use crate::map::box_tree::{BoxTree, LEAF};
use crate::map::kernel;
use crate::map::photon::PhotonPower;
use crate::map::polarisation::StoredPolarisation;
use crate::map::query_cone::QueryCone;
use glam::{DVec3, Vec3};
use wide::f32x8;

#[derive(Debug, Clone, Copy)]
pub struct PhotonBeam {
    start: [f32; 3],
    end: [f32; 3],
    medium: u16,
    /// The number of surface events before, or 0 if the scene does not limit it.
    events: u16,
    power: PhotonPower,
}

/// The lower limit of the sine of the angle between beam and ray, by which the estimate is divided:
/// parallel rays would make it infinite. The light that the limit removes counts as bias.
const LEAST_SINE: f64 = 1e-3;

/// The lower limit of the sine in the estimate of the bias. The bias bars must stay finite.
const LEAST_SINE_OF_BIAS: f64 = 1e-6;

/// The number of pieces of the longest beam. Pieces of all beams have about the same length.
const MOST_PIECES: f64 = 48.0;

impl PhotonBeam {
    /// Takes the start and the end in m, relative to the scene's centre, the number of the medium,
    /// and the power at the start.
    pub fn new([start, end]: [DVec3; 2], medium: usize, power: PhotonPower) -> Self {
        let point = |p: DVec3| p.as_vec3().to_array();
        Self { start: point(start), end: point(end), medium: medium as u16, events: 0, power }
    }

    #[must_use]
    pub fn with_events(self, events: u16) -> Self {
        Self { events, ..self }
    }

    fn ends(&self) -> (DVec3, DVec3) {
        (Vec3::from(self.start).as_dvec3(), Vec3::from(self.end).as_dvec3())
    }

    /// Returns the stored direction, or 0 for a beam without length.
    pub fn direction(&self) -> DVec3 {
        let (start, end) = self.ends();
        (end - start).normalize_or_zero()
    }

    fn length(&self) -> f64 {
        let (start, end) = self.ends();
        (end - start).length()
    }

    /// Returns the number of the medium if the kernel of the beam intersects the ray of the cone.
    pub fn medium_near_ray(&self, cone: &QueryCone) -> Option<usize> {
        self.near_ray((0.0, 1.0), None, cone).map(|near| near.medium)
    }

    /// Returns the beam if its closest approach to the ray lies on the ray and on the `part` of the
    /// beam, two fractions of its length, and is nearer than the kernel radius there.
    fn near_ray<'m>(
        &'m self,
        part: (f64, f64),
        polarisation: Option<&'m StoredPolarisation>,
        cone: &QueryCone,
    ) -> Option<PhotonNearRay<'m>> {
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
            polarisation,
            incoming,
            medium: usize::from(self.medium),
            events: u32::from(self.events),
            t,
            offset,
            radius_m: radius,
            kernels: kernel::on_line(distance, radius)
                .limited(sine.max(LEAST_SINE).recip(), sine.max(LEAST_SINE_OF_BIAS).recip()),
            beam: Some(BeamPath { start, distance_m: s }),
        })
    }
}

/// A part of a beam. Long beams are cut into pieces, so that the boxes of the pieces stay small.
#[derive(Debug, Clone, Copy, Default)]
struct BeamPiece {
    beam: u32,
    /// The number of this piece, counted from 0.
    number: u16,
    count: u16,
}

impl BeamPiece {
    /// Returns the start and the end of the piece, as fractions of the beam's length.
    fn span(self) -> (f64, f64) {
        let count = f64::from(self.count);
        (f64::from(self.number) / count, f64::from(self.number + 1) / count)
    }

    /// Returns the start and the end of the piece, in m.
    fn ends(self, beams: &[PhotonBeam]) -> [DVec3; 2] {
        let (start, end) = beams[self.beam as usize].ends();
        let (from, to) = self.span();
        [start.lerp(end, from), start.lerp(end, to)]
    }
}

/// Cuts beams into pieces of about equal length.
fn pieces(beams: &[PhotonBeam]) -> Vec<BeamPiece> {
    let longest = beams.iter().map(PhotonBeam::length).fold(0.0, f64::max);
    let mut pieces = Vec::with_capacity(beams.len() * 8);
    for (number, beam) in beams.iter().enumerate() {
        let count = (beam.length() / longest * MOST_PIECES).ceil().clamp(1.0, MOST_PIECES) as u16;
        pieces.extend((0..count).map(|piece| BeamPiece { beam: number as u32, number: piece, count }));
    }
    pieces
}

/// The pieces in a leaf of the tree. Unused places have a negative length.
#[derive(Debug, Clone, Copy)]
struct PieceBlock {
    /// The coordinates of the starts, in m: x of all pieces, then y, then z.
    starts: [[f32; LEAF]; 3],
    directions: [[f32; LEAF]; 3],
    lengths: [f32; LEAF],
    pieces: [BeamPiece; LEAF],
}

impl PieceBlock {
    fn new(beams: &[PhotonBeam], pieces: impl Iterator<Item = BeamPiece>) -> Self {
        let mut block = Self {
            starts: Default::default(),
            directions: Default::default(),
            lengths: [-1.0; LEAF],
            pieces: Default::default(),
        };
        for (place, piece) in pieces.enumerate() {
            let [start, end] = piece.ends(beams);
            let direction = (end - start).normalize_or_zero();
            (0..3).for_each(|axis| block.starts[axis][place] = start[axis] as f32);
            (0..3).for_each(|axis| block.directions[axis][place] = direction[axis] as f32);
            (block.lengths[place], block.pieces[place]) = ((end - start).length() as f32, piece);
        }
        block
    }
}

#[derive(Debug)]
pub(super) struct BeamMap {
    beams: Vec<PhotonBeam>,
    /// The polarisation of each beam. Empty if the plan does not contain it.
    polarisation: Vec<StoredPolarisation>,
    blocks: Vec<PieceBlock>,
    tree: BoxTree,
}

impl BeamMap {
    pub(super) fn new(beams: Vec<PhotonBeam>, polarisation: Vec<StoredPolarisation>) -> Self {
        let pieces = pieces(&beams);
        let corners = |piece: &BeamPiece| {
            let [a, b] = piece.ends(&beams).map(DVec3::as_vec3);
            (a.min(b), a.max(b))
        };
        let boxes: Vec<(Vec3, Vec3)> = pieces.iter().map(corners).collect();
        let (tree, leaves) = BoxTree::build(&boxes);
        let block = |leaf: &[u32]| PieceBlock::new(&beams, leaf.iter().map(|&number| pieces[number as usize]));
        let blocks = leaves.iter().map(block).collect();
        Self { beams, polarisation, blocks, tree }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.beams.is_empty()
    }

    /// Calls `visit` for each beam whose kernel intersects the ray of the cone.
    pub(super) fn along(&self, cone: &QueryCone, mut visit: impl FnMut(PhotonNearRay<'_>)) {
        let approach = ClosestApproach::new(cone);
        self.tree.visit(cone, |leaf| {
            let block = &self.blocks[leaf];
            let mut near = approach.candidates(block);
            while near != 0 {
                let piece = block.pieces[near.trailing_zeros() as usize];
                near &= near - 1;
                let number = piece.beam as usize;
                let polarisation = self.polarisation.get(number);
                if let Some(found) = self.beams[number].near_ray(piece.span(), polarisation, cone) {
                    visit(found);
                }
            }
        });
    }
}

/// The cone in single precision, prepared for tests against pieces of beams.
struct ClosestApproach {
    origin: [f32x8; 3],
    direction: [f32x8; 3],
    length: f32x8,
    radius: f32x8,
    slope: f32x8,
    /// The largest coordinate of the ray's origin, in m.
    largest: f32x8,
}

/// Lines with a smaller squared sine of their angle are too parallel for single precision.
const LEAST_SINE2: f32 = 1e-6;

#[inline(always)]
fn lanes([x, y, z]: [[f32; 8]; 3]) -> [f32x8; 3] {
    [f32x8::from(x), f32x8::from(y), f32x8::from(z)]
}

impl ClosestApproach {
    fn new(cone: &QueryCone) -> Self {
        let splat = |values: DVec3| values.to_array().map(|value| f32x8::splat(value as f32));
        Self {
            origin: splat(cone.ray.origin),
            direction: splat(cone.ray.direction),
            length: f32x8::splat(cone.length_m as f32),
            radius: f32x8::splat(cone.radius_m as f32),
            slope: f32x8::splat(cone.slope as f32),
            largest: f32x8::splat(cone.ray.origin.abs().max_element() as f32),
        }
    }

    /// Returns the places of the pieces whose kernel may intersect the ray, as a set of bits.
    /// Rounding may add a piece too many, but never remove one.
    #[inline(always)]
    fn candidates(&self, block: &PieceBlock) -> u32 {
        let [sx, sy, sz] = lanes(block.starts);
        let [ux, uy, uz] = lanes(block.directions);
        let piece = f32x8::from(block.lengths);
        let [dx, dy, dz] = self.direction;
        let [ox, oy, oz] = self.origin;
        let [wx, wy, wz] = [sx - ox, sy - oy, sz - oz];
        let [nx, ny, nz] = [dy * uz - dz * uy, dz * ux - dx * uz, dx * uy - dy * ux];
        let sine2 = nx * nx + ny * ny + nz * nz;
        let inverse = f32x8::splat(1.0) / sine2;
        let dot = |[x, y, z]: [f32x8; 3]| x * nx + y * ny + z * nz;
        // w × u and w × d. Their products with n are the distances along the ray and the piece.
        let t = dot([wy * uz - wz * uy, wz * ux - wx * uz, wx * uy - wy * ux]) * inverse;
        let s = dot([wy * dz - wz * dy, wz * dx - wx * dz, wx * dy - wy * dx]) * inverse;
        let across = dot([wx, wy, wz]);
        let [ax, ay, az] = [sx.abs(), sy.abs(), sz.abs()];
        let rounding = f32x8::splat(32.0 * f32::EPSILON) * (ax.max(ay).max(az) + self.largest + piece) * inverse;
        let radius = self.radius + self.slope * (t + rounding) + rounding;
        let near = (t + rounding).simd_ge(f32x8::ZERO)
            & (t - rounding).simd_le(self.length)
            & (s + rounding).simd_ge(f32x8::ZERO)
            & (s - rounding).simd_le(piece)
            & (across * across * inverse).simd_le(radius * radius);
        let parallel = sine2.simd_lt(f32x8::splat(LEAST_SINE2));
        ((near | parallel) & piece.simd_ge(f32x8::ZERO)).to_bitmask()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{KernelWidth, WavelengthCode};
    use abbe_scene::geometry::Ray;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};
    use abbe_spectra::math::warp;

    /// The map finds the same beams as a test of each beam, also far from the scene's centre and
    /// for beams that are almost parallel to the ray.
    #[test]
    fn a_query_finds_every_beam_once() {
        let mut found_any = 0;
        for (seed, centre) in [(5, DVec3::ZERO), (6, DVec3::new(3e3, -2e4, 10.0))] {
            let mut stream = Stream::new(Seed::new(seed), Purpose::SurveyPhoton, 0, 0);
            let mut place = || centre + DVec3::from(std::array::from_fn(|_| stream.uniform() - 0.5));
            let power = PhotonPower::new(WavelengthCode::default(), [1.0; 4], None, 0.5);
            let beams: Vec<PhotonBeam> =
                (0..500).map(|number| PhotonBeam::new([place(), place()], number, power)).collect();
            let map = BeamMap::new(beams.clone(), Vec::new());
            let mut stream = Stream::new(Seed::new(seed), Purpose::SurveyPhoton, 1, 0);
            for query in 0..200 {
                let origin = centre + DVec3::from(std::array::from_fn(|_| stream.uniform() - 0.5));
                let mut direction = warp::sphere(stream.pair());
                if query % 3 == 0 {
                    let (start, end) = beams[query].ends();
                    direction = ((end - start).normalize() + 1e-4 * direction).normalize();
                }
                let ray = Ray::new(origin, direction);
                let cone = QueryCone::of_camera(ray, 0.8, 2.0, KernelWidth::PerDistance(0.01));
                let mut found = Vec::new();
                map.along(&cone, |near| found.push(near.medium));
                found.sort_unstable();
                let expected: Vec<usize> = beams.iter().filter_map(|beam| beam.medium_near_ray(&cone)).collect();
                assert_eq!(found, expected);
                found_any += found.len();
            }
        }
        assert!(found_any > 2000, "{found_any}");
    }
}
