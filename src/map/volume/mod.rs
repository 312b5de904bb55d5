//! Photons in media, as a ray finds them: as points where they met particles, or as beams along their whole way. Beside them the light that
//! comes straight from lamps, worked out beforehand on a grid.

mod beam;
mod light_map;
mod point;

pub use beam::Beam;
pub use light_map::{LightMap, LightMaps, Look};
pub use point::VolumePhoton;

use super::kernel::Kernels;
use super::near_ray::{Cone, NearRay};
use super::photon::Load;
use glam::{DVec3, Vec3};

/// The photons of one class of paths in media: points in some media, beams in others.
#[derive(Debug, Default)]
pub struct VolumeMaps {
    /// Where photons met particles.
    pub points: VolumeMap,
    /// Photons' whole ways.
    pub beams: VolumeMap,
}

/// Photons of a pass in media.
#[derive(Debug, Default)]
pub struct VolumeMap {
    kept: Kept,
    index: NearRay,
}

#[derive(Debug)]
enum Kept {
    Points(Vec<VolumePhoton>),
    Beams {
        beams: Vec<Beam>,
        /// The pieces into which long beams are cut, so that their boxes stay small: beam, and which of how many.
        pieces: Vec<beam::Piece>,
    },
}

impl Default for Kept {
    fn default() -> Self {
        Self::Points(Vec::new())
    }
}

/// A photon that a ray passes close by.
#[derive(Debug)]
pub struct Neighbour<'m> {
    /// Its light.
    pub load: &'m Load,
    /// The way it goes, unit.
    pub incoming: DVec3,
    /// The medium's number.
    pub medium: usize,
    /// Where along the ray it is nearest, in m.
    pub t: f64,
    /// The kernels there: 1/m² for points, 1/m² for beams too, the sine of the crossing angle included.
    pub kernels: Kernels,
    /// Of a beam, how it came there; of a point nothing: its power is that at the point already.
    pub came: Option<Came>,
}

/// How a beam came to where a ray passes it.
#[derive(Debug, Clone, Copy)]
pub struct Came {
    /// Its start.
    pub start: DVec3,
    /// How far from there the ray passes, in m.
    pub distance_m: f64,
}

impl VolumeMap {
    /// A map of points.
    pub fn of_points(points: Vec<VolumePhoton>) -> Self {
        let boxes: Vec<(Vec3, Vec3)> = points.iter().map(|p| (p.position.into(), p.position.into())).collect();
        Self { index: NearRay::build(&boxes), kept: Kept::Points(points) }
    }

    /// A map of beams.
    pub fn of_beams(beams: Vec<Beam>) -> Self {
        let pieces = beam::pieces(&beams);
        let boxes: Vec<(Vec3, Vec3)> = pieces.iter().map(|piece| piece.bounds(&beams)).collect();
        Self { index: NearRay::build(&boxes), kept: Kept::Beams { beams, pieces } }
    }

    /// Whether there are no photons.
    pub fn is_empty(&self) -> bool {
        match &self.kept {
            Kept::Points(points) => points.is_empty(),
            Kept::Beams { beams, .. } => beams.is_empty(),
        }
    }

    /// Calls `visit` with every photon whose kernel the cone's ray passes.
    pub fn along(&self, cone: &Cone, mut visit: impl FnMut(Neighbour<'_>)) {
        match &self.kept {
            Kept::Points(points) => self.index.visit(cone, |i| {
                if let Some(found) = points[i as usize].seen_from(cone) {
                    visit(found);
                }
            }),
            Kept::Beams { beams, pieces } => self.index.visit(cone, |i| {
                if let Some(found) = pieces[i as usize].seen_from(beams, cone) {
                    visit(found);
                }
            }),
        }
    }
}
