//! Meshes that are placed several times.
//!
//! The instances of a mesh share its vertices and its bounding volume hierarchy, which are in the
//! frame of the mesh. A ray finds the instances in the hierarchy of the scene, and their triangles
//! in that of the mesh. The corners of a triangle are transformed to the world before the test, so
//! a hit is the same as that of a copied mesh.
//!
//! Triangle k of an instance is the primitive `first_primitive` + k; these numbers follow those of
//! the primitives of the list.

use std::mem::size_of;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::build::is_similarity;
use super::bvh::Bvh;
use super::hit::{Hit, SurfaceId};
use super::mesh::{TriangleMesh, triangle_normal};
use super::primitive::{Candidate, triangle_hit, triangle_uv};
use super::ray::Ray;
use super::shape::bounds_of;
use super::trace::RayQuery;
use abbe_spectra::error::Result;

/// The least number of triangles of a shared mesh. Rays find those of copies faster.
pub(super) const MIN_TRIANGLES: usize = 128;

/// A mesh with its own hierarchy.
#[derive(Debug, Clone)]
pub(super) struct SharedMesh {
    mesh: Arc<TriangleMesh>,
    bvh: Bvh,
    order: Vec<u32>,
    area: f64,
}

/// One placement of a shared mesh.
#[derive(Debug, Clone)]
pub(super) struct Instance {
    /// Index into `Instances::shared`.
    pub(super) shared: u32,
    pub(super) object: u32,
    /// Index into `Primitives::meshes`.
    pub(super) mesh: u32,
    pub(super) first_primitive: u32,
    /// From the frame of the mesh to the world.
    to_world: DMat3,
    to_local: DMat3,
    /// Origin of the frame of the mesh in world coordinates.
    position: DVec3,
    mirrored: bool,
}

/// A triangle of an instance, in world coordinates.
struct InstancedTriangle<'a> {
    mesh: &'a TriangleMesh,
    /// The vertices in the mesh, counter-clockwise in the world.
    vertices: [u32; 3],
    corners: [DVec3; 3],
}

impl SharedMesh {
    pub(super) fn new(mesh: &Arc<TriangleMesh>) -> Result<Self> {
        let boxes: Vec<_> = mesh.triangles().iter().map(|&t| bounds_of(mesh.corners(t).into_iter())).collect();
        let (bvh, order) = Bvh::build(&boxes)?;
        Ok(Self { mesh: Arc::clone(mesh), bvh, order, area: mesh.area() })
    }

    pub(super) fn is_of(&self, mesh: &Arc<TriangleMesh>) -> bool {
        Arc::ptr_eq(&self.mesh, mesh)
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.order.len()
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.bvh.memory_bytes() + self.order.capacity() * size_of::<u32>() + self.mesh.memory_bytes()
    }

    fn triangle(&self, instance: &Instance, number: u32) -> InstancedTriangle<'_> {
        let [a, b, c] = self.mesh.triangles()[self.order[number as usize] as usize];
        let vertices = if instance.mirrored { [a, c, b] } else { [a, b, c] };
        let place = |index: u32| instance.to_world * self.mesh.positions()[index as usize] + instance.position;
        InstancedTriangle { mesh: &self.mesh, vertices, corners: vertices.map(place) }
    }
}

impl Instance {
    pub(super) fn new(shared: u32, object: u32, mesh: u32, to_world: DMat3, position: DVec3) -> Self {
        let (to_local, mirrored) = (to_world.inverse(), to_world.determinant() < 0.0);
        Self { shared, object, mesh, first_primitive: 0, to_world, to_local, position, mirrored }
    }

    /// Returns a box around the transformed box of the mesh.
    pub(super) fn bounds(&self, shared: &SharedMesh) -> (DVec3, DVec3) {
        let (low, high) = shared.bvh.bounds();
        let corner = |i: usize| DVec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
        bounds_of((0..8).map(|i| self.to_world * corner(i) + self.position))
    }

    /// Returns the area in m².
    pub(super) fn area(&self, shared: &SharedMesh) -> f64 {
        if is_similarity(&self.to_world) {
            return self.to_world.x_axis.length_squared() * shared.area;
        }
        let area = |number| 0.5 * triangle_normal(shared.triangle(self, number).corners).length();
        (0..shared.order.len() as u32).map(area).sum()
    }
}

impl InstancedTriangle<'_> {
    fn hit(&self, candidate: &Candidate, instance: &Instance) -> Hit {
        let to_normal = instance.to_local.transpose();
        let placed = |normal: DVec3| (to_normal * normal).normalize_or_zero().as_vec3().as_dvec3();
        let normals = self.mesh.normals().map(|normals| self.vertices.map(|vertex| placed(normals[vertex as usize])));
        triangle_hit(candidate, instance.object, self.corners, normals)
    }

    fn uv(&self, point: DVec3) -> [f64; 2] {
        let uvs = self.mesh.uvs().map(|uvs| self.vertices.map(|vertex| uvs[vertex as usize]));
        triangle_uv(self.corners, uvs, point)
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct Instances {
    pub(super) shared: Vec<SharedMesh>,
    /// In the order of `first_primitive`.
    pub(super) list: Vec<Instance>,
}

impl Instances {
    /// Returns the instance to which a primitive belongs, and the number of its triangle.
    fn find(&self, primitive: u32) -> (&Instance, u32) {
        let index = self.list.partition_point(|instance| instance.first_primitive <= primitive) - 1;
        let instance = &self.list[index];
        (instance, primitive - instance.first_primitive)
    }

    pub(super) fn instance_of(&self, primitive: u32) -> &Instance {
        self.find(primitive).0
    }

    fn triangle(&self, primitive: u32) -> (&Instance, InstancedTriangle<'_>) {
        let (instance, number) = self.find(primitive);
        (instance, self.shared[instance.shared as usize].triangle(instance, number))
    }

    pub(super) fn corners(&self, primitive: u32) -> [DVec3; 3] {
        self.triangle(primitive).1.corners
    }

    pub(super) fn hit(&self, candidate: &Candidate) -> Hit {
        let (instance, triangle) = self.triangle(candidate.surface.primitive);
        triangle.hit(candidate, instance)
    }

    pub(super) fn uv(&self, primitive: u32, point: DVec3) -> [f64; 2] {
        self.triangle(primitive).1.uv(point)
    }

    pub(super) fn bounds(&self, index: u32) -> (DVec3, DVec3) {
        let instance = &self.list[index as usize];
        instance.bounds(&self.shared[instance.shared as usize])
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.list.iter().map(|instance| self.shared[instance.shared as usize].triangle_count()).sum()
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.shared.iter().map(SharedMesh::memory_bytes).sum::<usize>() + self.list.capacity() * size_of::<Instance>()
    }
}

impl RayQuery<'_> {
    /// Calls `visit` with each crossing of an instance at t ≤ `limit`, approximately in order of
    /// distance. `visit` returns a new limit. A negative limit ends the search.
    pub(super) fn instance_crossings(&self, index: u32, limit: f64, mut visit: impl FnMut(&Candidate) -> f64) {
        let instances = &self.geometry.primitives.instances;
        let instance = &instances.list[index as usize];
        let shared = &instances.shared[instance.shared as usize];
        let Some(triangle_ray) = &self.triangle_ray else { return };
        // The search starts before the ray's origin, where a coincident surface may lie.
        let back = self.coincidence_range_m;
        let direction = instance.to_local * self.ray.direction;
        let stretch = direction.length();
        let origin = instance.to_local * (self.ray.origin - back * self.ray.direction - instance.position);
        let mut limit = limit;
        shared.bvh.traverse(&Ray::new(origin, direction / stretch), (limit + back) * stretch, |number| {
            let surface = SurfaceId { primitive: instance.first_primitive + number, face: 0 };
            if self.from.is_none_or(|from| from.primitive != surface.primitive)
                && let Some(hit) = triangle_ray.intersect(shared.triangle(instance, number).corners)
            {
                let candidate = Candidate { t: hit.t, surface, weights: hit.weights };
                if hit.t > self.coincidence_range_m || self.accepts_near_start(&candidate) {
                    limit = visit(&candidate);
                }
            }
            if limit < 0.0 { -1.0 } else { (limit + back) * stretch }
        });
    }
}
