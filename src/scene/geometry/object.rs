//! The objects' surfaces as sets to draw points from.

use std::mem::size_of;

use glam::DVec3;

use super::SurfaceId;

/// A face of a primitive, in the list of its object's faces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) surface: SurfaceId,
    /// Area of the object's pieces up to and with this one, in m².
    pub(super) area_so_far: f64,
}

/// How points are drawn as seen from somewhere.
#[derive(Debug, Clone, Copy)]
pub(super) enum Aim {
    /// By area.
    Area,
    /// A round sphere: by the cone of directions that it fills.
    Sphere { centre: DVec3, radius: f64 },
    /// A right-angled rectangle: by the solid angle that it fills.
    Rectangle(Rectangle),
}

/// A right-angled rectangle in the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rectangle {
    pub(super) corner: DVec3,
    /// Unit vector along the width.
    pub(super) x: DVec3,
    /// Unit vector along the height.
    pub(super) y: DVec3,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// One object.
#[derive(Debug, Clone)]
pub(super) struct Object {
    pub(super) pieces: Vec<Piece>,
    pub(super) area: f64,
    pub(super) aim: Aim,
}

/// All objects, by their number.
#[derive(Debug, Clone, Default)]
pub(super) struct Objects {
    pub(super) list: Vec<Object>,
}

impl Object {
    /// The piece at a share of the area in [0, 1).
    pub(super) fn piece_at(&self, share: f64) -> Option<SurfaceId> {
        let area = share * self.area;
        let index = self.pieces.partition_point(|piece| piece.area_so_far <= area);
        self.pieces.get(index).or(self.pieces.last()).map(|piece| piece.surface)
    }
}

impl Objects {
    pub(super) fn get(&self, object: u32) -> Option<&Object> {
        self.list.get(object as usize)
    }

    /// Adds a face; pieces without area are never drawn and not kept.
    pub(super) fn push(&mut self, object: u32, surface: SurfaceId, area: f64) {
        let index = object as usize;
        if index >= self.list.len() {
            self.list.resize_with(index + 1, || Object { pieces: Vec::new(), area: 0.0, aim: Aim::Area });
        }
        if area > 0.0 {
            let object = &mut self.list[index];
            object.area += area;
            object.pieces.push(Piece { surface, area_so_far: object.area });
        }
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.list.shrink_to_fit();
        self.list.iter_mut().for_each(|object| object.pieces.shrink_to_fit());
    }

    pub(super) fn memory_bytes(&self) -> usize {
        let pieces: usize = self.list.iter().map(|object| object.pieces.capacity() * size_of::<Piece>()).sum();
        pieces + self.list.capacity() * size_of::<Object>()
    }
}
