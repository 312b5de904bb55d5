//! Construction of the geometry from placed shapes: primitives, hierarchy and face areas.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::bvh::Bvh;
use super::hit::SurfaceId;
use super::instance::{Instance, MIN_TRIANGLES, SharedMesh};
use super::mesh::{TriangleMesh, triangle_normal};
use super::object::{ObjectSurfaces, ShapeSampling, WorldRectangle};
use super::primitive::{PlacedMesh, PlacedSolid, Primitive, Primitives, Triangle};
use super::shape::{PlacedShape, Shape, Solid, ValidShape, bounds_of};
use super::world::Geometry;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::sin_cos;

/// Ratio (2⁻²³) of `Geometry::coincidence_range_m`, without its margin for the rounding of the
/// centre, to the largest coordinate of the scene.
const COINCIDENCE_RANGE_FRACTION: f64 = 1.2e-7;

impl Geometry {
    /// Builds the geometry of all placed shapes about `centre`, which is subtracted from every
    /// position. Returns an error if a shape is not a valid body, a transform is singular or not
    /// finite, a shape has no area, or the scene has more than 2³² primitives or vertices.
    pub fn build(placed: Vec<PlacedShape>, centre: DVec3) -> Result<Self> {
        let mut primitives =
            Primitives { largest_centre_coordinate: centre.abs().max_element(), ..Primitives::default() };
        let is_shared = shared_meshes(&placed);
        for (item, &is_shared) in placed.iter().zip(&is_shared) {
            let of_object = |mut error: Error| {
                error.what = format!("object {}: {}", item.object, error.what);
                error
            };
            primitives.place(item, is_shared, centre).map_err(of_object)?;
        }
        drop(placed);
        primitives.number_instances()?;
        let boxes: Vec<_> = primitives.list.iter().map(|primitive| primitives.bounds(primitive)).collect();
        let (bvh, order) = Bvh::build(&boxes)?;
        primitives.list = order.iter().map(|&index| primitives.list[index as usize]).collect();
        primitives.number_vertices_by_use();
        primitives.shrink_to_fit();
        let mut objects = primitives.objects();
        objects.shrink_to_fit();
        let (low, high) = bvh.bounds();
        let largest_coordinate_m = low.abs().max(high.abs()).max_element();
        let coincidence_range_m = if largest_coordinate_m.is_finite() {
            COINCIDENCE_RANGE_FRACTION * largest_coordinate_m + 256.0 * primitives.centre_rounding()
        } else {
            0.0
        };
        Ok(Self { bvh, primitives, objects, coincidence_range_m })
    }
}

impl Primitives {
    fn place(&mut self, placed: &PlacedShape, is_shared: bool, centre: DVec3) -> Result<()> {
        let linear = placed.to_world.matrix3;
        let position = placed.to_world.translation - centre;
        let lengths = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length);
        let volume = lengths[0] * lengths[1] * lengths[2];
        let determinant = linear.determinant();
        if !position.is_finite() || !volume.is_finite() || determinant.abs() <= 1e-12 * volume {
            return Err(Error::input("the transform is singular or not finite").expected("an invertible transform"));
        }
        match placed.shape.validated()? {
            ValidShape::Mesh(mesh) if is_shared => self.place_instance(mesh, linear, position, placed.object),
            ValidShape::Mesh(mesh) => self.place_mesh(mesh, linear, position, placed.object),
            ValidShape::Solid(solid) => self.place_solid(solid, linear, position, placed.object),
        }
    }

    fn place_solid(&mut self, solid: Solid, linear: DMat3, position: DVec3, object: u32) -> Result<()> {
        let index = index(self.analytic.len())?;
        let mut placed = PlacedSolid {
            face_areas: Vec::new(),
            solid,
            to_world: linear,
            to_local: linear.inverse(),
            volume_scale: linear.determinant().abs(),
            position,
            object,
        };
        placed.face_areas = (0..placed.solid.faces()).map(|face| placed.face_area(face)).collect();
        if !placed.face_areas.iter().any(|&area| area > 0.0) {
            let error = Error::input("the placed shape is so small that the computed area is 0");
            return Err(error.expected("a larger shape"));
        }
        self.analytic.push(placed);
        self.list.push(Primitive::Analytic(index));
        Ok(())
    }

    fn place_mesh(&mut self, mesh: &Arc<TriangleMesh>, linear: DMat3, position: DVec3, object: u32) -> Result<()> {
        let mirrored = linear.determinant() < 0.0;
        let first_vertex = index(self.vertices.len())?;
        index(self.vertices.len() + mesh.positions().len())?;
        self.vertices.extend(mesh.positions().iter().map(|&vertex| linear * vertex + position));
        let first_normal = mesh.normals().map(|normals| {
            let first = self.normals.len() as u32;
            // With the inverse transpose, outward normals stay outward even under mirroring.
            let to_normal = linear.inverse().transpose();
            let placed = |&normal: &DVec3| (to_normal * normal).normalize_or_zero().as_vec3().to_array();
            self.normals.extend(normals.iter().map(placed));
            first
        });
        let first_uv = mesh.uvs().map(|uvs| {
            let first = self.uvs.len() as u32;
            self.uvs.extend(uvs.iter().map(|uv| uv.map(|x| x as f32)));
            first
        });
        let mesh_index = index(self.meshes.len())?;
        self.meshes.push(PlacedMesh { object, closed: mesh.is_closed(), first_vertex, first_normal, first_uv });
        let before = self.list.len();
        for &[a, b, c] in mesh.triangles() {
            let winding = if mirrored { [a, c, b] } else { [a, b, c] };
            let triangle = Triangle { vertices: winding.map(|index| index + first_vertex), mesh: mesh_index };
            if triangle_normal(self.corners(&triangle)).length_squared() > 0.0 {
                self.list.push(Primitive::Triangle(triangle));
            }
        }
        if self.list.len() == before {
            return Err(Error::input("the placed mesh has no area"));
        }
        Ok(())
    }

    fn place_instance(&mut self, mesh: &Arc<TriangleMesh>, linear: DMat3, position: DVec3, object: u32) -> Result<()> {
        let known = self.instances.shared.iter().position(|shared| shared.is_of(mesh));
        let shared = match known {
            Some(known) => known,
            None => {
                self.instances.shared.push(SharedMesh::new(mesh)?);
                self.instances.shared.len() - 1
            }
        };
        let (mesh_index, first_vertex) = (index(self.meshes.len())?, index(self.vertices.len())?);
        let closed = mesh.is_closed();
        self.meshes.push(PlacedMesh { object, closed, first_vertex, first_normal: None, first_uv: None });
        self.list.push(Primitive::Instance(index(self.instances.list.len())?));
        self.instances.list.push(Instance::new(index(shared)?, object, mesh_index, linear, position));
        Ok(())
    }

    /// Numbers the triangles of the instances after the primitives of the list.
    fn number_instances(&mut self) -> Result<()> {
        let mut next = self.list.len();
        for instance in &mut self.instances.list {
            instance.first_primitive = index(next)?;
            next += self.instances.shared[instance.shared as usize].triangle_count();
        }
        index(next).map(|_| ())
    }

    /// Renumbers the vertices of each mesh by their first use by the triangles of the hierarchy, so
    /// that near triangles are close in memory. Unused vertices come last.
    fn number_vertices_by_use(&mut self) {
        let mut new_numbers: Vec<Option<u32>> = vec![None; self.vertices.len()];
        let mut next: Vec<u32> = self.meshes.iter().map(|mesh| mesh.first_vertex).collect();
        for primitive in &mut self.list {
            let Primitive::Triangle(triangle) = primitive else { continue };
            for vertex in &mut triangle.vertices {
                let next = &mut next[triangle.mesh as usize];
                *vertex = *new_numbers[*vertex as usize].get_or_insert_with(|| take_number(next));
            }
        }
        let ends: Vec<u32> =
            (self.meshes.iter().skip(1).map(|mesh| mesh.first_vertex)).chain([self.vertices.len() as u32]).collect();
        let old = (self.vertices.clone(), self.normals.clone(), self.uvs.clone());
        for ((mesh, end), next) in self.meshes.iter().zip(ends).zip(&mut next) {
            for vertex in mesh.first_vertex..end {
                let number = new_numbers[vertex as usize].unwrap_or_else(|| take_number(next));
                let (from, to) = ((vertex - mesh.first_vertex) as usize, (number - mesh.first_vertex) as usize);
                self.vertices[number as usize] = old.0[vertex as usize];
                if let Some(first) = mesh.first_normal {
                    self.normals[first as usize + to] = old.1[first as usize + from];
                }
                if let Some(first) = mesh.first_uv {
                    self.uvs[first as usize + to] = old.2[first as usize + from];
                }
            }
        }
    }

    pub(super) fn bounds(&self, primitive: &Primitive) -> (DVec3, DVec3) {
        match primitive {
            Primitive::Analytic(index) => {
                let analytic = &self.analytic[*index as usize];
                let (low, high) = analytic.solid.bounds(&analytic.to_world);
                (low + analytic.position, high + analytic.position)
            }
            Primitive::Triangle(triangle) => bounds_of(self.corners(triangle).into_iter()),
            Primitive::Instance(index) => self.instances.bounds(*index),
        }
    }

    /// Returns the faces, in the order of the list, and areas of all objects.
    fn objects(&self) -> ObjectSurfaces {
        let mut objects = ObjectSurfaces::default();
        let mut count = std::collections::HashMap::<u32, u32>::new();
        for (primitive, item) in (0..).zip(&self.list) {
            *count.entry(self.object(primitive)).or_default() += 1;
            match item {
                Primitive::Triangle(triangle) => {
                    let area = 0.5 * triangle_normal(self.corners(triangle)).length();
                    let object = self.meshes[triangle.mesh as usize].object;
                    objects.push(object, SurfaceId { primitive, face: 0 }, area);
                }
                Primitive::Instance(index) => {
                    let instance = &self.instances.list[*index as usize];
                    let area = instance.area(&self.instances.shared[instance.shared as usize]);
                    objects.push_instance(instance.object, *index, area);
                }
                Primitive::Analytic(index) => {
                    let analytic = &self.analytic[*index as usize];
                    for (face, &area) in (0..).zip(&analytic.face_areas) {
                        objects.push(analytic.object, SurfaceId { primitive, face }, area);
                    }
                }
            }
        }
        for analytic in self.analytic.iter().filter(|analytic| count.get(&analytic.object) == Some(&1)) {
            objects.list[analytic.object as usize].sampling = analytic.sampling();
        }
        objects
    }
}

impl PlacedSolid {
    /// Computes the area of a face in the world, in m².
    fn face_area(&self, face: u32) -> f64 {
        let local = self.solid.area(face);
        let scale_at = |u: [f64; 2]| self.placed_surface(self.solid.sample(face, u), face).area_scale;
        if is_similarity(&self.to_world) || self.solid.has_flat_faces() {
            return local * scale_at([0.5, 0.5]);
        }
        // The area scale is averaged over the face, which `sample` covers uniformly: in equal steps
        // around the axis, which converge fast for a smooth periodic function, and by three-point
        // Gauss quadrature along it, on pieces that are shortest at the ends, where stretched
        // bodies are most curved. The error is 1e-6 for an ellipsoid with an axis ratio of 1000 :
        // 1.
        let around = |u: f64| -> f64 {
            refined((8, 512), |count| {
                let steps = (0..count).map(|i| (f64::from(i) + 0.5) / f64::from(count));
                steps.map(|azimuth| scale_at([u, azimuth])).sum::<f64>() / f64::from(count)
            })
        };
        if self.solid.has_straight_sides() {
            return local * around(0.5);
        }
        let gauss = [(-0.6_f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6_f64.sqrt(), 5.0 / 18.0)];
        let mean = refined((8, 256), |count| {
            let mut mean = 0.0;
            for piece in 0..count {
                for (node, weight) in gauss {
                    let (sin, cos) = sin_cos(PI * (f64::from(piece) + 0.5 + 0.5 * node) / f64::from(count));
                    mean += 0.5 * PI * sin * weight * around(0.5 * (1.0 - cos)) / f64::from(count);
                }
            }
            mean
        });
        local * mean
    }

    fn sampling(&self) -> ShapeSampling {
        let [x, z] = [self.to_world.x_axis, self.to_world.z_axis];
        if let Some(radius) = self.solid.sphere_radius().filter(|_| is_similarity(&self.to_world)) {
            return ShapeSampling::Sphere { centre: self.position, radius: radius * x.length() };
        }
        let right_angled = x.dot(z).abs() <= 1e-12 * x.length() * z.length();
        let Some((half_width, half_height)) = self.solid.rectangle().filter(|_| right_angled) else {
            return ShapeSampling::Area;
        };
        ShapeSampling::Rectangle(WorldRectangle {
            corner: self.position - half_width * x - half_height * z,
            x: x.normalize(),
            y: z.normalize(),
            width: 2.0 * half_width * x.length(),
            height: 2.0 * half_height * z.length(),
        })
    }
}

/// Doubles the number of steps of a quadrature from the first to the last number, until the result
/// hardly changes.
fn refined((first, last): (u32, u32), quadrature: impl Fn(u32) -> f64) -> f64 {
    const TOLERANCE: f64 = 1e-10;
    let (mut count, mut result) = (first, quadrature(first));
    while count < last {
        count *= 2;
        let finer = quadrature(count);
        let change = (finer - result).abs();
        result = finer;
        if change <= TOLERANCE * finer {
            break;
        }
    }
    result
}

pub(super) fn is_similarity(map: &DMat3) -> bool {
    let [x, y, z] = [map.x_axis, map.y_axis, map.z_axis];
    let scale = x.length_squared();
    let deviations = [x.dot(y), y.dot(z), z.dot(x), y.length_squared() - scale, z.length_squared() - scale];
    deviations.iter().all(|deviation| deviation.abs() <= 1e-12 * scale)
}

/// Returns for each shape whether it is a mesh that is placed several times.
fn shared_meshes(placed: &[PlacedShape]) -> Vec<bool> {
    let mesh = |item: &PlacedShape| {
        let Shape::Mesh(mesh) = &item.shape else { return None };
        (mesh.triangles().len() >= MIN_TRIANGLES).then_some(Arc::as_ptr(mesh))
    };
    let mut uses = std::collections::HashMap::<_, usize>::new();
    placed.iter().filter_map(mesh).for_each(|mesh| *uses.entry(mesh).or_default() += 1);
    placed.iter().map(|item| mesh(item).is_some_and(|mesh| uses[&mesh] > 1)).collect()
}

fn take_number(next: &mut u32) -> u32 {
    let number = *next;
    *next += 1;
    number
}

fn index(value: usize) -> Result<u32> {
    u32::try_from(value).map_err(|_| Error::input("the scene has more than 2³² vertices or primitives"))
}
