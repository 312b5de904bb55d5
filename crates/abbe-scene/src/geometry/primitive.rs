//! The list of primitives in world coordinates: analytic shapes and single triangles.

use std::mem::size_of;

use glam::{DMat3, DVec3};

use super::hit::{Hit, SurfaceId};
use super::instance::Instances;
use super::mesh::triangle_normal;
use super::ray::Ray;
use super::shape::{Crossing, LocalLine, Solid};

#[derive(Debug, Clone)]
pub(super) struct PlacedSolid {
    pub(super) solid: Solid,
    /// From the local frame to the world, without the translation.
    pub(super) to_world: DMat3,
    pub(super) to_local: DMat3,
    /// |det| of `to_world`.
    pub(super) volume_scale: f64,
    /// Origin of the local frame in world coordinates.
    pub(super) position: DVec3,
    pub(super) object: u32,
    /// In the world, in m².
    pub(super) face_areas: Vec<f64>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct WorldSurfacePoint {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    /// The area of a small piece of surface in the world, divided by its area in the local frame.
    pub(super) area_scale: f64,
}

impl PlacedSolid {
    pub(super) fn line(&self, ray: &Ray) -> LocalLine {
        LocalLine { origin: self.to_local * (ray.origin - self.position), direction: self.to_local * ray.direction }
    }

    pub(super) fn next_crossing(&self, ray: &Ray, start_face: Option<u32>, after: f64) -> Option<Crossing> {
        self.solid.next_crossing(&self.line(ray), start_face, after)
    }

    /// Projects a point in world coordinates, on a face or near it, onto the face.
    pub(super) fn surface(&self, point: DVec3, face: u32) -> WorldSurfacePoint {
        self.placed_surface(self.to_local * (point - self.position), face)
    }

    /// Projects a point in local coordinates, on a face or near it, onto the face. Normals are
    /// transformed by the inverse transpose, so outward normals stay outward even if the transform
    /// mirrors the shape. The normals of flat shapes stay on the side of the transformed +y axis.
    pub(super) fn placed_surface(&self, local: DVec3, face: u32) -> WorldSurfacePoint {
        let surface = self.solid.surface(local, face);
        let normal = self.to_local.transpose() * surface.normal;
        let length = normal.length();
        WorldSurfacePoint {
            position: self.to_world * surface.point + self.position,
            normal: normal / length,
            area_scale: length * self.volume_scale,
        }
    }

    /// Returns the density of `Solid::sample` on a face, divided by the density that is uniform by
    /// area in the world. It is 1, except on curved faces with unequal scaling.
    pub(super) fn relative_pdf(&self, face: u32, area_scale: f64) -> f64 {
        self.face_areas[face as usize] / (self.solid.area(face) * area_scale)
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    /// Indices into `Primitives::vertices`.
    pub(super) vertices: [u32; 3],
    /// Index into `Primitives::meshes`.
    pub(super) mesh: u32,
}

/// The data shared by all triangles of a placed mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedMesh {
    pub(super) object: u32,
    pub(super) closed: bool,
    pub(super) first_vertex: u32,
    pub(super) first_normal: Option<u32>,
    pub(super) first_uv: Option<u32>,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Primitive {
    /// Index into `Primitives::analytic`.
    Analytic(u32),
    Triangle(Triangle),
    /// Index of an instance. Its triangles have numbers after those of the list.
    Instance(u32),
}

#[derive(Debug, Clone, Default)]
pub(super) struct Primitives {
    pub(super) list: Vec<Primitive>,
    pub(super) analytic: Vec<PlacedSolid>,
    pub(super) meshes: Vec<PlacedMesh>,
    pub(super) vertices: Vec<DVec3>,
    /// Unit vectors. The rounding error of single precision is below that of interpolation.
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) instances: Instances,
    /// Largest absolute coordinate of the centre that `Geometry::build` subtracts.
    pub(super) largest_centre_coordinate: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) t: f64,
    pub(super) surface: SurfaceId,
    /// Barycentric weights on a triangle.
    pub(super) weights: [f64; 3],
}

impl Primitives {
    /// Returns an entry of the list, or `None` for a triangle of an instance.
    #[inline]
    fn get(&self, primitive: u32) -> Option<&Primitive> {
        self.list.get(primitive as usize)
    }

    #[inline]
    pub(super) fn corners(&self, triangle: &Triangle) -> [DVec3; 3] {
        let [a, b, c] = triangle.vertices;
        [self.vertices[a as usize], self.vertices[b as usize], self.vertices[c as usize]]
    }

    /// Returns the corners of a triangle of the list or of an instance.
    pub(super) fn triangle_corners(&self, primitive: u32) -> [DVec3; 3] {
        match self.get(primitive) {
            Some(Primitive::Triangle(triangle)) => self.corners(triangle),
            Some(Primitive::Analytic(_) | Primitive::Instance(_)) | None => self.instances.corners(primitive),
        }
    }

    pub(super) fn object(&self, primitive: u32) -> u32 {
        match self.get(primitive) {
            Some(Primitive::Analytic(index)) => self.analytic[*index as usize].object,
            Some(Primitive::Triangle(triangle)) => self.meshes[triangle.mesh as usize].object,
            Some(Primitive::Instance(index)) => self.instances.list[*index as usize].object,
            None => self.instances.instance_of(primitive).object,
        }
    }

    pub(super) fn is_closed(&self, primitive: u32) -> bool {
        match self.mesh(primitive) {
            Some(mesh) => self.meshes[mesh as usize].closed,
            None => {
                matches!(self.get(primitive), Some(Primitive::Analytic(index)) if self.analytic[*index as usize].solid.is_closed())
            }
        }
    }

    /// Returns the largest absolute coordinate of a shape's position, or of a triangle's corners.
    pub(super) fn largest_coordinate(&self, primitive: u32) -> f64 {
        let largest =
            |corners: [DVec3; 3]| corners.map(|corner| corner.abs().max_element()).into_iter().fold(0.0, f64::max);
        match self.get(primitive) {
            Some(Primitive::Analytic(index)) => self.analytic[*index as usize].position.abs().max_element(),
            Some(Primitive::Triangle(_) | Primitive::Instance(_)) | None => largest(self.triangle_corners(primitive)),
        }
    }

    /// Returns the mesh of a primitive, or `None` if the primitive is an analytic shape.
    pub(super) fn mesh(&self, primitive: u32) -> Option<u32> {
        match self.get(primitive) {
            Some(Primitive::Analytic(_)) => None,
            Some(Primitive::Triangle(triangle)) => Some(triangle.mesh),
            Some(Primitive::Instance(_)) | None => Some(self.instances.instance_of(primitive).mesh),
        }
    }

    /// Returns the geometric unit normal of a surface at a point on it or near it.
    pub(super) fn normal(&self, surface: SurfaceId, point: DVec3) -> DVec3 {
        match self.get(surface.primitive) {
            Some(Primitive::Analytic(index)) => self.analytic[*index as usize].surface(point, surface.face).normal,
            Some(Primitive::Triangle(_) | Primitive::Instance(_)) | None => {
                triangle_normal(self.triangle_corners(surface.primitive)).normalize()
            }
        }
    }

    pub(super) fn hit(&self, ray: &Ray, candidate: &Candidate) -> Hit {
        let Candidate { t, surface, weights: _ } = *candidate;
        match self.get(surface.primitive) {
            Some(Primitive::Analytic(index)) => {
                let analytic = &self.analytic[*index as usize];
                let found = analytic.surface(ray.at(t), surface.face);
                Hit {
                    t: t.max(0.0),
                    position: found.position,
                    normal: found.normal,
                    shading_normal: found.normal,
                    object: analytic.object,
                    surface,
                }
            }
            Some(Primitive::Triangle(triangle)) => self.triangle_hit(candidate, triangle),
            Some(Primitive::Instance(_)) | None => self.instances.hit(candidate),
        }
    }

    fn triangle_hit(&self, candidate: &Candidate, triangle: &Triangle) -> Hit {
        let mesh = &self.meshes[triangle.mesh as usize];
        let attribute = |first: u32, vertex: u32| (vertex - mesh.first_vertex + first) as usize;
        let normals = mesh.first_normal.map(|first| {
            let normal = |vertex| DVec3::from_array(self.normals[attribute(first, vertex)].map(f64::from));
            triangle.vertices.map(normal)
        });
        triangle_hit(candidate, mesh.object, self.corners(triangle), normals)
    }

    pub(super) fn uv(&self, surface: SurfaceId, point: DVec3) -> [f64; 2] {
        match self.get(surface.primitive) {
            Some(Primitive::Analytic(index)) => {
                let analytic = &self.analytic[*index as usize];
                analytic.solid.uv(analytic.to_local * (point - analytic.position), surface.face)
            }
            Some(Primitive::Triangle(triangle)) => self.triangle_uv(triangle, point),
            Some(Primitive::Instance(_)) | None => self.instances.uv(surface.primitive, point),
        }
    }

    /// Returns true if u is the azimuth about an axis, so that u = 0 and u = 1 are the same line.
    pub(super) fn closes_around_axis(&self, surface: SurfaceId) -> bool {
        match self.get(surface.primitive) {
            Some(Primitive::Analytic(index)) => self.analytic[*index as usize].solid.closes_around_axis(surface.face),
            Some(Primitive::Triangle(_) | Primitive::Instance(_)) | None => false,
        }
    }

    fn triangle_uv(&self, triangle: &Triangle, point: DVec3) -> [f64; 2] {
        let mesh = &self.meshes[triangle.mesh as usize];
        let uvs = mesh.first_uv.map(|first| {
            triangle.vertices.map(|vertex| self.uvs[(vertex - mesh.first_vertex + first) as usize].map(f64::from))
        });
        triangle_uv(self.corners(triangle), uvs, point)
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
            + self.analytic.capacity() * size_of::<PlacedSolid>()
            + self.meshes.capacity() * size_of::<PlacedMesh>()
            + self.vertices.capacity() * size_of::<DVec3>()
            + self.normals.capacity() * size_of::<[f32; 3]>()
            + self.uvs.capacity() * size_of::<[f32; 2]>()
            + self.instances.memory_bytes()
    }
}

/// Computes the hit of a triangle. `normals` are the unit normals of the corners, if any.
#[inline]
pub(super) fn triangle_hit(
    candidate: &Candidate,
    object: u32,
    corners: [DVec3; 3],
    normals: Option<[DVec3; 3]>,
) -> Hit {
    let Candidate { t, surface, weights } = *candidate;
    let normal = triangle_normal(corners).normalize();
    let [a, b, c] = corners;
    // From one corner, it stays in the plane even if rounded weights do not sum to 1.
    let position = a + weights[1] * (b - a) + weights[2] * (c - a);
    let shading_normal = normals.map_or(normal, |normals| {
        let corner = |i: usize| weights[i] * normals[i];
        let mean = (corner(0) + corner(1) + corner(2)).normalize_or(normal);
        if mean.dot(normal) < 0.0 { -mean } else { mean }
    });
    Hit { t: t.max(0.0), position, normal, shading_normal, object, surface }
}

/// Returns the texture coordinates of a point in the plane of a triangle from those of the corners.
/// Without them, the result consists of the weights of the second and the third corner.
pub(super) fn triangle_uv([a, b, c]: [DVec3; 3], uvs: Option<[[f64; 2]; 3]>, point: DVec3) -> [f64; 2] {
    let (to_b, to_c, to_point) = (b - a, c - a, point - a);
    // The weights solve the normal equations of point = a + v (b − a) + w (c − a).
    let (bb, bc, cc) = (to_b.length_squared(), to_b.dot(to_c), to_c.length_squared());
    let (pb, pc) = (to_point.dot(to_b), to_point.dot(to_c));
    let determinant = bb * cc - bc * bc;
    let (v, w) = ((cc * pb - bc * pc) / determinant, (bb * pc - bc * pb) / determinant);
    uvs.map_or([v, w], |[p, q, r]| std::array::from_fn(|i| (1.0 - v - w) * p[i] + v * q[i] + w * r[i]))
}
