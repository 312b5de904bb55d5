//! From placed shapes to primitives, boxes, tree and areas.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::object::{Aim, Objects, Rectangle};
use super::primitive::{Analytic, PlacedMesh, Primitive, Primitives, Triangle};
use super::{Geometry, SurfaceId};
use crate::error::{Error, Result};
use crate::scene::bvh::Tree;
use crate::scene::mesh::{TriangleMesh, triangle_normal};
use crate::scene::shape::{Placed, Shape, Solid, around};

/// `near` as a share of the scene's largest coordinate (2⁻²³).
const NEAR: f64 = 1.2e-7;

impl Geometry {
    /// Builds the tree over all placed shapes. `centre` is subtracted from every position.
    ///
    /// # Errors
    /// A shape with numbers that make no body, a transform that is not finite or flattens space, a mesh without
    /// area, more than 2³² primitives or vertices.
    pub fn build(placed: Vec<Placed>, centre: DVec3) -> Result<Self> {
        let mut primitives = Primitives { centre_reach: centre.abs().max_element(), ..Primitives::default() };
        for item in &placed {
            let of_object = |mut error: Error| {
                error.what = format!("object {}: {}", item.object, error.what);
                error
            };
            primitives.place(item, centre).map_err(of_object)?;
        }
        drop(placed);
        let boxes: Vec<_> = primitives.list.iter().map(|primitive| primitives.bounds(primitive)).collect();
        let (tree, order) = Tree::build(&boxes)?;
        primitives.list = order.iter().map(|&index| primitives.list[index as usize]).collect();
        primitives.number_vertices_by_use();
        primitives.shrink_to_fit();
        let mut objects = primitives.objects();
        objects.shrink_to_fit();
        let (low, high) = tree.bounds();
        let reach = low.abs().max(high.abs()).max_element();
        let near = if reach.is_finite() { NEAR * reach + 256.0 * primitives.centre_rounding() } else { 0.0 };
        Ok(Self { tree, primitives, objects, near })
    }
}

impl Primitives {
    fn place(&mut self, placed: &Placed, centre: DVec3) -> Result<()> {
        let linear = placed.to_world.matrix3;
        let position = placed.to_world.translation - centre;
        let lengths = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length);
        let volume = lengths[0] * lengths[1] * lengths[2];
        let determinant = linear.determinant();
        if !position.is_finite() || !volume.is_finite() || determinant.abs() <= 1e-12 * volume {
            return Err(Error::input("the transform is not finite or makes the object flat")
                .expected("a transform that keeps three dimensions"));
        }
        if let Shape::Mesh(mesh) = &placed.shape {
            return self.place_mesh(mesh, linear, position, placed.object);
        }
        if let Some(solid) = Solid::new(&placed.shape)? {
            let index = index(self.analytic.len())?;
            let to_local = linear.inverse();
            let mut analytic = Analytic {
                face_areas: Vec::new(),
                solid,
                to_world: linear,
                to_local,
                volume_scale: determinant.abs(),
                position,
                object: placed.object,
            };
            analytic.face_areas = (0..analytic.solid.faces()).map(|face| analytic.face_area(face)).collect();
            self.analytic.push(analytic);
            self.list.push(Primitive::Analytic(index));
        }
        Ok(())
    }

    fn place_mesh(&mut self, mesh: &Arc<TriangleMesh>, linear: DMat3, position: DVec3, object: u32) -> Result<()> {
        let mirrored = linear.determinant() < 0.0;
        let first_vertex = index(self.vertices.len())?;
        index(self.vertices.len() + mesh.positions().len())?;
        self.vertices.extend(mesh.positions().iter().map(|&vertex| linear * vertex + position));
        let first_normal = mesh.normals().map(|normals| {
            let first = self.normals.len() as u32;
            // Outwards by the inverse transpose, under mirroring too.
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
            } else {
                self.dropped += 1;
            }
        }
        if self.list.len() == before {
            return Err(Error::input("the placed mesh has no area"));
        }
        Ok(())
    }

    /// Renumbers each mesh's vertices in the order in which the tree's triangles use them, so that triangles near
    /// each other in space are near each other in memory. Vertices that nothing uses come last.
    fn number_vertices_by_use(&mut self) {
        const UNUSED: u32 = u32::MAX;
        let mut new_number = vec![UNUSED; self.vertices.len()];
        let mut next: Vec<u32> = self.meshes.iter().map(|mesh| mesh.first_vertex).collect();
        for primitive in &mut self.list {
            let Primitive::Triangle(triangle) = primitive else { continue };
            for vertex in &mut triangle.vertices {
                let number = &mut new_number[*vertex as usize];
                if *number == UNUSED {
                    *number = next[triangle.mesh as usize];
                    next[triangle.mesh as usize] += 1;
                }
                *vertex = *number;
            }
        }
        let ends: Vec<u32> =
            (self.meshes.iter().skip(1).map(|mesh| mesh.first_vertex)).chain([self.vertices.len() as u32]).collect();
        let old = (self.vertices.clone(), self.normals.clone(), self.uvs.clone());
        for ((mesh, end), next) in self.meshes.iter().zip(ends).zip(&mut next) {
            for vertex in mesh.first_vertex..end {
                let number = &mut new_number[vertex as usize];
                if *number == UNUSED {
                    *number = *next;
                    *next += 1;
                }
                let (from, to) = ((vertex - mesh.first_vertex) as usize, (*number - mesh.first_vertex) as usize);
                self.vertices[*number as usize] = old.0[vertex as usize];
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
            Primitive::Triangle(triangle) => around(self.corners(triangle).into_iter()),
        }
    }

    /// The objects' faces and areas, in the order of the final list.
    fn objects(&self) -> Objects {
        let mut objects = Objects::default();
        let mut count = std::collections::HashMap::<u32, u32>::new();
        for (primitive, item) in (0..).zip(&self.list) {
            *count.entry(self.object(primitive)).or_default() += 1;
            match item {
                Primitive::Triangle(triangle) => {
                    let area = 0.5 * triangle_normal(self.corners(triangle)).length();
                    let object = self.meshes[triangle.mesh as usize].object;
                    objects.push(object, SurfaceId { primitive, face: 0 }, area);
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
            objects.list[analytic.object as usize].aim = analytic.aim();
        }
        objects
    }
}

impl Analytic {
    /// Area of a face in the world, in m².
    fn face_area(&self, face: u32) -> f64 {
        let local = self.solid.area(face);
        let scale_at = |u: [f64; 2]| self.placed_surface(self.solid.sample(face, u), face).area_scale;
        if self.is_similarity() || self.solid.has_flat_faces() {
            return local * scale_at([0.5, 0.5]);
        }
        // The mean over the face, which `sample` covers evenly: around the axis by equal steps, which converge as
        // fast as the function is smooth; along it by Gauss's three points in short pieces, shortest at the ends,
        // where stretched bodies are most curved. A needle of 1000 : 1 is right to 1e-6.
        const PIECES: u32 = 256;
        const TURN: u32 = 512;
        let gauss = [(-0.6_f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6_f64.sqrt(), 5.0 / 18.0)];
        let mut mean = 0.0;
        for piece in 0..PIECES {
            for (node, weight) in gauss {
                let (sin, cos) = (PI * (f64::from(piece) + 0.5 + 0.5 * node) / f64::from(PIECES)).sin_cos();
                let u = 0.5 * (1.0 - cos);
                let around: f64 = (0..TURN).map(|i| scale_at([u, (f64::from(i) + 0.5) / f64::from(TURN)])).sum();
                mean += 0.5 * PI * sin * weight * around / f64::from(TURN * PIECES);
            }
        }
        local * mean
    }

    /// Whether the transform keeps all angles.
    fn is_similarity(&self) -> bool {
        let [x, y, z] = [self.to_world.x_axis, self.to_world.y_axis, self.to_world.z_axis];
        let scale = x.length_squared();
        let deviations = [x.dot(y), y.dot(z), z.dot(x), y.length_squared() - scale, z.length_squared() - scale];
        deviations.iter().all(|deviation| deviation.abs() <= 1e-12 * scale)
    }

    fn aim(&self) -> Aim {
        let [x, z] = [self.to_world.x_axis, self.to_world.z_axis];
        if let Some(radius) = self.solid.sphere_radius().filter(|_| self.is_similarity()) {
            return Aim::Sphere { centre: self.position, radius: radius * x.length() };
        }
        let right_angled = x.dot(z).abs() <= 1e-12 * x.length() * z.length();
        let Some((half_width, half_height)) = self.solid.rectangle().filter(|_| right_angled) else {
            return Aim::Area;
        };
        Aim::Rectangle(Rectangle {
            corner: self.position - half_width * x - half_height * z,
            x: x.normalize(),
            y: z.normalize(),
            width: 2.0 * half_width * x.length(),
            height: 2.0 * half_height * z.length(),
        })
    }
}

fn index(value: usize) -> Result<u32> {
    u32::try_from(value).map_err(|_| Error::input("the scene has more than 2³² vertices or primitives"))
}
