//! Objects as written → placed shapes with materials.

use super::motion::Way;
use super::{Resolver, mesh_materials, number_of, object};
use crate::error::{Error, Result};
use crate::scene::file::{EmissionFile, JsonPath, ObjectFile, ShapeFile};
use crate::scene::mesh::{self, MeshPart};
use crate::scene::motion::MovingShape;
use crate::scene::shape::{Placed, Shape};
use crate::scene::{Material, Object};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All objects, and what they are made of.
#[derive(Default)]
pub(super) struct Things<'a> {
    /// Shapes where they stand when the shutter opens, and their ways.
    pub(super) shapes: Vec<MovingShape>,
    pub(super) objects: Vec<Object>,
    pub(super) materials: Vec<Material>,
    /// Emitting objects: the file's number, the objects' numbers (several where a mesh has parts), the emission.
    pub(super) emitting: Vec<(usize, Vec<u32>, Emission<'a>)>,
    /// Materials by name.
    named: BTreeMap<&'a str, usize>,
}

impl Things<'_> {
    /// Whether a shape only bounds a medium.
    pub(super) fn is_boundary(&self, placed: &Placed) -> bool {
        self.materials[self.objects[placed.object as usize].material].is_boundary()
    }

    /// Adds a ball of air around the whole scene, which reaches `reach_m` around its `centre`: the medium fills it wherever no other body
    /// rules. Returns the ball's radius in m.
    pub(super) fn add_atmosphere(&mut self, (name, medium): (&str, usize), (centre, reach_m): (DVec3, f64)) -> f64 {
        /// The camera and the lamps stand inside, not on the rim.
        const MARGIN: f64 = 1.05;
        let radius = MARGIN * reach_m;
        let shape = Shape::Sphere { radius };
        let material = number_of(&mut self.materials, Material::boundary(name, medium, i32::MIN));
        let to_world = DAffine3::from_translation(centre);
        let placed = Placed { shape, to_world, object: self.objects.len() as u32 };
        self.shapes.push(MovingShape { placed, motion: None });
        self.objects.push(object("atmosphere".to_owned(), material));
        radius * (1.0 + 1e-6)
    }
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
        let name = name.clone().unwrap_or_else(|| format!("object {number}"));
        let Way { placing, motion } = self.way(transform, motion);
        let frame = DAffine3 { matrix3: placing.matrix3, translation: placing.translation * self.metres };
        let local = match shape {
            ShapeFile::Sphere { center, .. } => DAffine3::from_translation(DVec3::from(*center) * self.metres),
            ShapeFile::Mesh { .. } => DAffine3::from_scale(DVec3::splat(self.metres)),
            ShapeFile::Rectangle { .. }
            | ShapeFile::Disk { .. }
            | ShapeFile::Box { .. }
            | ShapeFile::Cylinder { .. }
            | ShapeFile::Prism { .. }
            | ShapeFile::Lens { .. } => DAffine3::IDENTITY,
        };
        let mut emitters = Vec::new();
        let add = |things: &mut Things<'a>, shape: Shape, name: String, material: usize| {
            let object_number = things.objects.len() as u32;
            things.objects.push(object(name, material));
            let placed = Placed { shape, to_world: frame * local, object: object_number };
            things.shapes.push(MovingShape { placed, motion: motion.clone().map(|motion| (motion, local)) });
            object_number
        };
        let material = match material {
            Some(name) => Some(self.material_number(&at.key("material"), name, things, notes)?),
            None => None,
        };
        if let Some(number) = material {
            self.check_filling(at, shape, &things.materials[number], emission.is_some())?;
        }
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

    /// Checks that an object that holds a medium encloses a space, and that what is no surface does not shine.
    fn check_filling(&self, at: &JsonPath<'_>, shape: &ShapeFile, material: &Material, shines: bool) -> Result<()> {
        let flat = matches!(shape, ShapeFile::Rectangle { .. } | ShapeFile::Disk { .. });
        if flat && material.body.as_ref().is_some_and(|body| body.medium.is_some()) {
            let error = Error::input(format!("found a flat shape, filled by the medium of \"{}\"", material.name))
                .expected("a shape that encloses a space");
            return self.at(&at.key("shape"), Err(error));
        }
        if shines && material.is_boundary() {
            let error = Error::input(format!("found on \"{}\", which is no surface", material.name))
                .expected("the medium's own `emission`");
            return self.at(&at.key("emission"), Err(error));
        }
        Ok(())
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
pub(super) fn centre<'a>(placed: impl Iterator<Item = &'a Placed>) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (thing, (min, max)) in placed.filter_map(|thing| Some((thing, thing.shape.bounds()?))) {
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
