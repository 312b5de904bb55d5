//! Objects as written → placed shapes with materials.

use super::{Resolver, mesh_materials, number_of, object, unsupported};
use crate::error::Result;
use crate::scene::file::{EmissionFile, JsonPath, ObjectFile, ShapeFile};
use crate::scene::geometry::Geometry;
use crate::scene::mesh::{self, MeshPart};
use crate::scene::shape::{Placed, Shape};
use crate::scene::{Material, Object};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All objects, and what they are made of.
#[derive(Default)]
pub(super) struct Things<'a> {
    pub(super) placed: Vec<Placed>,
    pub(super) objects: Vec<Object>,
    pub(super) materials: Vec<Material>,
    /// Emitting objects: the file's number, the objects' numbers (several where a mesh has parts), the emission.
    pub(super) emitting: Vec<(usize, Vec<u32>, Emission<'a>)>,
    /// Materials by name.
    named: BTreeMap<&'a str, usize>,
}

/// Where an object's emission is stated.
pub(super) enum Emission<'a> {
    /// In the scene.
    Stated(&'a EmissionFile),
    /// In a mesh file: linear RGB in cd/m² of each component.
    OfMesh([f64; 3]),
}

impl<'a> Resolver<'a> {
    /// Resolves all objects.
    pub(super) fn objects(&self, notes: &mut Vec<String>) -> Result<Things<'a>> {
        let mut things = Things::default();
        let root = JsonPath::Root;
        let at = root.key("objects");
        for (number, file) in self.scene.objects.iter().enumerate() {
            self.object(&at.index(number), (number, file), &mut things, notes)?;
        }
        // Materials that nothing uses are checked all the same, but for what is not supported yet.
        for name in self.scene.materials.keys().filter(|name| !things.named.contains_key(name.as_str())) {
            let unused = self.material(&root.key("materials"), name, &mut Vec::new());
            if let Err(error) = unused.map(|_| ())
                && !error.what.ends_with("not supported yet")
            {
                return Err(error);
            }
        }
        Ok(things)
    }

    fn object(
        &self,
        at: &JsonPath<'_>,
        (number, file): (usize, &'a ObjectFile),
        things: &mut Things<'a>,
        notes: &mut Vec<String>,
    ) -> Result<()> {
        let ObjectFile { name, shape, material, transform, motion, emission } = file;
        if !motion.is_empty() {
            return self.at(&at.key("motion"), Err(unsupported("motion is")));
        }
        let name = name.clone().unwrap_or_else(|| format!("object {number}"));
        let written = transform.to_affine();
        let mut to_world = DAffine3 { matrix3: written.matrix3, translation: written.translation * self.metres };
        match shape {
            ShapeFile::Sphere { center, .. } => {
                to_world *= DAffine3::from_translation(DVec3::from(*center) * self.metres)
            }
            ShapeFile::Mesh { .. } => to_world *= DAffine3::from_scale(DVec3::splat(self.metres)),
            ShapeFile::Rectangle { .. }
            | ShapeFile::Disk { .. }
            | ShapeFile::Box { .. }
            | ShapeFile::Cylinder { .. }
            | ShapeFile::Prism { .. }
            | ShapeFile::Lens { .. } => {}
        }
        let mut emitters = Vec::new();
        let add = |things: &mut Things<'a>, shape: Shape, name: String, material: usize| {
            let object_number = things.objects.len() as u32;
            things.objects.push(object(name, material));
            things.placed.push(Placed { shape, to_world, object: object_number });
            object_number
        };
        let material = match material {
            Some(name) => Some(self.material_number(&at.key("material"), name, things, notes)?),
            None => None,
        };
        if let ShapeFile::Mesh { path } = shape {
            let shape_at = at.key("shape");
            let mesh_at = shape_at.key("mesh");
            let parts = self.source.file(path).and_then(|path| mesh::load(&path, self.source.reach()));
            let parts = self.at(&mesh_at.key("path"), parts)?;
            for part in parts {
                let part_name = if part.name.is_empty() { name.clone() } else { format!("{name}/{}", part.name) };
                let own_light = part.material.as_ref().map_or([0.0; 3], |own| own.emission);
                let part_material = match material {
                    Some(number) => number,
                    None => self.own_material(&mesh_at, &part, things)?,
                };
                self.check_mesh(&part, &part_name, &things.materials[part_material], notes);
                let object_number = add(things, Shape::Mesh(Arc::new(part.mesh)), part_name, part_material);
                emitters.push(object_number);
                if material.is_none() && emission.is_none() && own_light.iter().any(|&c| c > 0.0) {
                    things.emitting.push((number, vec![object_number], Emission::OfMesh(own_light)));
                }
            }
        } else if let Some(material) = material {
            let shape = self.shape(shape);
            self.at(&at.key("shape"), shape.validate())?;
            emitters.push(add(things, shape, name, material));
        }
        if let Some(emission) = emission {
            things.emitting.push((number, emitters, Emission::Stated(emission)));
        }
        Ok(())
    }

    fn material_number(
        &self,
        at: &JsonPath<'_>,
        name: &'a str,
        things: &mut Things<'a>,
        notes: &mut Vec<String>,
    ) -> Result<usize> {
        if let Some(&number) = things.named.get(name) {
            return Ok(number);
        }
        let material = self.material(at, name, notes)?;
        let number = number_of(&mut things.materials, material);
        things.named.insert(name, number);
        Ok(number)
    }

    /// The material that a mesh part brings along; grey without one.
    fn own_material(&self, at: &JsonPath<'_>, part: &MeshPart, things: &mut Things<'_>) -> Result<usize> {
        let material = mesh_materials::material(&part.material.clone().unwrap_or_default(), self.metres);
        Ok(number_of(&mut things.materials, self.at(at, material)?))
    }

    /// Warns of glass that is not closed.
    fn check_mesh(&self, part: &MeshPart, name: &str, material: &Material, notes: &mut Vec<String>) {
        if material.body.is_some() && !part.mesh.is_closed() {
            notes.push(format!("the mesh \"{name}\" is used as glass but is not closed: light may lose its way in it"));
        }
        if material.body.is_some() && part.mesh.is_closed() && part.mesh.signed_volume() < 0.0 {
            notes.push(format!("the mesh \"{name}\" is used as glass but faces inwards: its inside counts as outside"));
        }
    }

    /// A shape in m. (Meshes are loaded elsewhere.)
    fn shape(&self, file: &ShapeFile) -> Shape {
        let m = self.metres;
        match *file {
            ShapeFile::Sphere { center: _, radius } => Shape::Sphere { radius: radius * m },
            ShapeFile::Rectangle { width, height } => Shape::Rectangle { width: width * m, height: height * m },
            ShapeFile::Disk { radius } => Shape::Disk { radius: radius * m },
            ShapeFile::Box { size } => Shape::Box { size: DVec3::from(size) * m },
            ShapeFile::Cylinder { radius, height } => Shape::Cylinder { radius: radius * m, height: height * m },
            ShapeFile::Prism { side, length, apex } => {
                Shape::Prism { side: side * m, length: length * m, apex_deg: apex }
            }
            ShapeFile::Lens { radius1, radius2, thickness, diameter } => Shape::Lens {
                radius1: radius1 * m,
                radius2: radius2 * m,
                thickness: thickness * m,
                diameter: diameter * m,
            },
            ShapeFile::Mesh { path: _ } => Shape::Sphere { radius: m },
        }
    }
}

/// The middle of all shapes' bounding boxes, in m: positions relative to it keep their digits wherever the scene stands.
pub(super) fn centre(placed: &[Placed]) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for thing in placed {
        let (min, max) = bounds(&thing.shape);
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
            let point = thing.to_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
            low = low.min(point);
            high = high.max(point);
        }
    }
    let middle = 0.5 * (low + high);
    if middle.is_finite() { middle } else { DVec3::ZERO }
}

/// Corners of a box around a shape in its own frame, in m. (For a prism, a ball's would do as well: only the middle counts.)
fn bounds(shape: &Shape) -> (DVec3, DVec3) {
    let around = |half: DVec3| (-half, half);
    match shape {
        Shape::Sphere { radius } => around(DVec3::splat(*radius)),
        Shape::Rectangle { width, height } => around(0.5 * DVec3::new(*width, 0.0, *height)),
        Shape::Disk { radius } => around(DVec3::new(*radius, 0.0, *radius)),
        Shape::Box { size } => around(0.5 * *size),
        Shape::Cylinder { radius, height } => around(DVec3::new(*radius, 0.5 * height, *radius)),
        Shape::Prism { side, length, .. } => around(DVec3::new(*side, *side, 0.5 * length)),
        Shape::Lens { thickness, diameter, .. } => {
            let rim = 0.5 * diameter;
            (DVec3::new(-rim, -rim, 0.0), DVec3::new(rim, rim, *thickness))
        }
        Shape::Mesh(mesh) => {
            let corners = mesh.positions().iter();
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)))
        }
    }
}

/// The radius of a ball around the origin that holds all surfaces.
pub(super) fn radius(geometry: &Geometry) -> f64 {
    let (low, high) = geometry.bounds();
    let reach = low.abs().max(high.abs()).length();
    // A hair more, so that no surface touches it.
    if reach.is_finite() { reach * (1.0 + 1e-6) } else { 1.0 }
}
