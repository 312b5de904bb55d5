//! The flat list of primitives: analytic shapes and single triangles, placed in the world.

use std::mem::size_of;

use glam::{DMat3, DVec3};

use super::{Hit, Ray, SurfaceId};
use crate::scene::mesh::triangle_normal;
use crate::scene::shape::{Crossing, Line, Solid};

/// An analytic shape in the world.
#[derive(Debug, Clone)]
pub(super) struct Analytic {
    pub(super) solid: Solid,
    /// Shape frame → world, without the translation.
    pub(super) to_world: DMat3,
    pub(super) to_local: DMat3,
    /// |det| of `to_world`.
    pub(super) volume_scale: f64,
    /// Where the shape frame's origin stands.
    pub(super) position: DVec3,
    pub(super) object: u32,
    /// Areas of its faces in the world, in m².
    pub(super) face_areas: Vec<f64>,
}

/// A point of an analytic surface in the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct WorldSurface {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    pub(super) uv: [f64; 2],
    /// Area in the world per area in the shape's frame.
    pub(super) area_scale: f64,
}

impl Analytic {
    pub(super) fn line(&self, ray: &Ray) -> Line {
        Line { origin: self.to_local * (ray.origin - self.position), direction: self.to_local * ray.direction }
    }

    pub(super) fn next(&self, ray: &Ray, on: Option<u32>, after: f64) -> Option<Crossing> {
        self.solid.next(&self.line(ray), on, after)
    }

    /// The surface of a face at a world point on or near it.
    pub(super) fn surface(&self, point: DVec3, face: u32) -> WorldSurface {
        self.placed_surface(self.to_local * (point - self.position), face)
    }

    /// The surface of a face at a point of the shape's frame on or near it. Normals go by the inverse transpose,
    /// which keeps them outwards (and the sheets' on the side of the transformed +y) under mirroring too.
    pub(super) fn placed_surface(&self, local: DVec3, face: u32) -> WorldSurface {
        let surface = self.solid.surface(local, face);
        let normal = self.to_local.transpose() * surface.normal;
        let length = normal.length();
        WorldSurface {
            position: self.to_world * surface.point + self.position,
            normal: normal / length,
            uv: surface.uv,
            area_scale: length * self.volume_scale,
        }
    }

    /// Density, relative to uniform over the world's area, with which a face's points are drawn where the area
    /// scale is `area_scale`: 1 unless a curved face is scaled unequally.
    pub(super) fn density(&self, face: u32, area_scale: f64) -> f64 {
        self.face_areas[face as usize] / (self.solid.area(face) * area_scale)
    }
}

/// A triangle of a placed mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    /// Into `Primitives::vertices`.
    pub(super) vertices: [u32; 3],
    /// Into `Primitives::meshes`.
    pub(super) mesh: u32,
}

/// A mesh in the world: what its triangles have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedMesh {
    pub(super) object: u32,
    pub(super) closed: bool,
    pub(super) first_vertex: u32,
    /// Where its vertices' normals begin, if it has them.
    pub(super) first_normal: Option<u32>,
    /// Where its vertices' uvs begin, if it has them.
    pub(super) first_uv: Option<u32>,
}

/// One primitive.
#[derive(Debug, Clone, Copy)]
pub(super) enum Primitive {
    /// One of `Primitives::analytic`.
    Analytic(u32),
    Triangle(Triangle),
}

/// All primitives, in the tree's order, and what they refer to.
#[derive(Debug, Clone, Default)]
pub(super) struct Primitives {
    pub(super) list: Vec<Primitive>,
    pub(super) analytic: Vec<Analytic>,
    pub(super) meshes: Vec<PlacedMesh>,
    pub(super) vertices: Vec<DVec3>,
    /// Unit vectors; single precision is far below what interpolation makes of them.
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) dropped: usize,
    /// Largest coordinate of the centre that was subtracted.
    pub(super) centre_reach: f64,
}

/// A crossing of a primitive, as the search keeps it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) t: f64,
    pub(super) surface: SurfaceId,
    /// Barycentric weights on a triangle.
    pub(super) weights: [f64; 3],
}

impl Primitives {
    #[inline]
    pub(super) fn corners(&self, triangle: &Triangle) -> [DVec3; 3] {
        let [a, b, c] = triangle.vertices;
        [self.vertices[a as usize], self.vertices[b as usize], self.vertices[c as usize]]
    }

    pub(super) fn object(&self, primitive: u32) -> u32 {
        match self.list[primitive as usize] {
            Primitive::Analytic(index) => self.analytic[index as usize].object,
            Primitive::Triangle(triangle) => self.meshes[triangle.mesh as usize].object,
        }
    }

    pub(super) fn is_closed(&self, primitive: u32) -> bool {
        match self.list[primitive as usize] {
            Primitive::Analytic(index) => self.analytic[index as usize].solid.is_closed(),
            Primitive::Triangle(triangle) => self.meshes[triangle.mesh as usize].closed,
        }
    }

    /// Largest coordinate that takes part in placing a primitive.
    pub(super) fn reach(&self, primitive: u32) -> f64 {
        match &self.list[primitive as usize] {
            Primitive::Analytic(index) => self.analytic[*index as usize].position.abs().max_element(),
            Primitive::Triangle(triangle) => {
                self.corners(triangle).into_iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max)
            }
        }
    }

    /// The mesh that a primitive is a triangle of.
    pub(super) fn mesh(&self, primitive: u32) -> Option<u32> {
        match self.list[primitive as usize] {
            Primitive::Analytic(_) => None,
            Primitive::Triangle(triangle) => Some(triangle.mesh),
        }
    }

    /// Geometric unit normal of a surface at a point on or near it.
    pub(super) fn normal(&self, surface: SurfaceId, point: DVec3) -> DVec3 {
        match self.list[surface.primitive as usize] {
            Primitive::Analytic(index) => self.analytic[index as usize].surface(point, surface.face).normal,
            Primitive::Triangle(triangle) => triangle_normal(self.corners(&triangle)).normalize(),
        }
    }

    /// Everything about a crossing that was found.
    pub(super) fn hit(&self, ray: &Ray, candidate: &Candidate) -> Hit {
        let Candidate { t, surface, weights } = *candidate;
        match self.list[surface.primitive as usize] {
            Primitive::Analytic(index) => {
                let analytic = &self.analytic[index as usize];
                let found = analytic.surface(ray.at(t), surface.face);
                Hit {
                    t: t.max(0.0),
                    position: found.position,
                    normal: found.normal,
                    shading_normal: found.normal,
                    uv: found.uv,
                    object: analytic.object,
                    surface,
                }
            }
            Primitive::Triangle(triangle) => self.triangle_hit(t, surface, &triangle, weights),
        }
    }

    fn triangle_hit(&self, t: f64, surface: SurfaceId, triangle: &Triangle, weights: [f64; 3]) -> Hit {
        let mesh = &self.meshes[triangle.mesh as usize];
        let corners = self.corners(triangle);
        let normal = triangle_normal(corners).normalize();
        let [a, b, c] = corners;
        // From one corner, so that the point is in the plane to rounding even where the weights' sum is not 1.
        let position = a + weights[1] * (b - a) + weights[2] * (c - a);
        let attribute = |first: u32, corner: usize| (triangle.vertices[corner] - mesh.first_vertex + first) as usize;
        let shading_normal = mesh.first_normal.map_or(normal, |first| {
            let corner = |i: usize| weights[i] * DVec3::from_array(self.normals[attribute(first, i)].map(f64::from));
            let mean = (corner(0) + corner(1) + corner(2)).normalize_or(normal);
            if mean.dot(normal) < 0.0 { -mean } else { mean }
        });
        let uv = mesh.first_uv.map_or([weights[1], weights[2]], |first| {
            let corner = |i: usize| self.uvs[attribute(first, i)].map(|x| weights[i] * f64::from(x));
            let [p, q, r] = [corner(0), corner(1), corner(2)];
            [p[0] + q[0] + r[0], p[1] + q[1] + r[1]]
        });
        Hit { t: t.max(0.0), position, normal, shading_normal, uv, object: mesh.object, surface }
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.list.shrink_to_fit();
        self.analytic.shrink_to_fit();
        self.vertices.shrink_to_fit();
        self.normals.shrink_to_fit();
        self.uvs.shrink_to_fit();
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.list.capacity() * size_of::<Primitive>()
            + self.analytic.capacity() * size_of::<Analytic>()
            + self.meshes.capacity() * size_of::<PlacedMesh>()
            + self.vertices.capacity() * size_of::<DVec3>()
            + self.normals.capacity() * size_of::<[f32; 3]>()
            + self.uvs.capacity() * size_of::<[f32; 2]>()
    }
}
