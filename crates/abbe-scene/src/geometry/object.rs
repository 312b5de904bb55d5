//! The surfaces of the objects as sets of faces, from which points are sampled.

use std::mem::size_of;

use glam::DVec3;

use super::hit::SurfaceId;

#[derive(Debug, Clone, Copy)]
pub(super) struct ObjectFace {
    pub(super) surface: SurfaceId,
    /// Area of the object's faces up to and including this face, in m².
    pub(super) area_so_far: f64,
}

/// The method for sampling points of an object, seen from a reference point.
#[derive(Debug, Clone, Copy)]
pub(super) enum ShapeSampling {
    /// Uniform sampling by area.
    Area,
    /// Uniform sampling of the cone of directions that a sphere subtends.
    Sphere { centre: DVec3, radius: f64 },
    /// Uniform sampling of the solid angle that a rectangle subtends.
    Rectangle(WorldRectangle),
}

/// A rectangle with right angles in world coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct WorldRectangle {
    pub(super) corner: DVec3,
    /// Unit vector along the width.
    pub(super) x: DVec3,
    /// Unit vector along the height.
    pub(super) y: DVec3,
    pub(super) width: f64,
    pub(super) height: f64,
}

#[derive(Debug, Clone)]
pub(super) struct ObjectSurface {
    pub(super) faces: Vec<ObjectFace>,
    pub(super) area: f64,
    pub(super) sampling: ShapeSampling,
    /// The instances of the object. They have no faces, because their points are not sampled.
    pub(super) instances: Vec<u32>,
}

/// The surfaces of all objects, by object number.
#[derive(Debug, Clone, Default)]
pub(super) struct ObjectSurfaces {
    pub(super) list: Vec<ObjectSurface>,
}

impl ObjectSurface {
    /// Returns the first face whose cumulative area exceeds `fraction`, in [0, 1), of the whole
    /// area, or `None` without faces.
    pub(super) fn face_at(&self, fraction: f64) -> Option<SurfaceId> {
        let area = fraction * self.area;
        let index = self.faces.partition_point(|face| face.area_so_far <= area);
        self.faces.get(index).or(self.faces.last()).map(|face| face.surface)
    }
}

impl ObjectSurfaces {
    pub(super) fn get(&self, object: u32) -> Option<&ObjectSurface> {
        self.list.get(object as usize)
    }

    /// Adds a face to an object. A face without area is not stored, because it is never sampled.
    pub(super) fn push(&mut self, object: u32, surface: SurfaceId, area: f64) {
        let object = self.entry(object);
        if area > 0.0 {
            object.area += area;
            object.faces.push(ObjectFace { surface, area_so_far: object.area });
        }
    }

    pub(super) fn push_instance(&mut self, object: u32, instance: u32, area: f64) {
        let object = self.entry(object);
        object.area += area;
        object.instances.push(instance);
    }

    fn entry(&mut self, object: u32) -> &mut ObjectSurface {
        let index = object as usize;
        if index >= self.list.len() {
            self.list.resize_with(index + 1, || ObjectSurface {
                faces: Vec::new(),
                area: 0.0,
                sampling: ShapeSampling::Area,
                instances: Vec::new(),
            });
        }
        &mut self.list[index]
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.list.shrink_to_fit();
        self.list.iter_mut().for_each(|object| object.faces.shrink_to_fit());
    }

    pub(super) fn memory_bytes(&self) -> usize {
        let faces: usize = self.list.iter().map(|object| object.faces.capacity() * size_of::<ObjectFace>()).sum();
        faces + self.list.capacity() * size_of::<ObjectSurface>()
    }
}
