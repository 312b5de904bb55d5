//! Translates the objects of the scene file to placed shapes with materials.

use super::context::Resolver;
use super::mesh_materials;
use super::motion::ResolvedMotion;
use crate::error::Result;
use crate::format::mesh::{self, MeshFile, MeshPart};
use crate::format::{EmissionFile, JsonPath, MeshShapeFile, ObjectFile, ShapeFile};
use crate::geometry::shape::Shape;
use crate::optics::bsdf::Bsdf;
use crate::scene::Material;
use crate::scene::builder::{ObjectSet, Placement};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The resolved objects, and the emission of their surfaces.
#[derive(Default)]
pub(super) struct ResolvedObjects<'a> {
    pub(super) set: ObjectSet,
    pub(super) emitting: Vec<EmittingObject<'a>>,
    /// The material number for each material name.
    named: BTreeMap<&'a str, usize>,
}

/// An object with emission.
pub(super) struct EmittingObject<'a> {
    /// The position in the file's list of objects.
    pub(super) file_index: usize,
    /// The object numbers. A mesh with several parts has one number for each part.
    pub(super) objects: Vec<u32>,
    pub(super) emission: EmissionSource<'a>,
}

/// The emission of an object, from the scene file or from a mesh file.
pub(super) enum EmissionSource<'a> {
    /// The emission in the scene file.
    Scene(&'a EmissionFile),
    /// The emission in a mesh file, as linear RGB. White, (1, 1, 1), has a luminance of 1 cd/m².
    Mesh([f64; 3]),
}

impl<'a> Resolver<'a> {
    /// Resolves all objects.
    pub(super) fn objects(&self) -> ResolvedObjects<'a> {
        let mut resolved = ResolvedObjects::default();
        let root = JsonPath::Root;
        let at = root.key("objects");
        for (number, file) in self.scene.objects.iter().enumerate() {
            self.keep(self.object(&at.index(number), number, file, &mut resolved));
        }
        // Unused materials are checked as well.
        for name in self.scene.materials.keys().filter(|name| !resolved.named.contains_key(name.as_str())) {
            self.keep(self.material(&root.key("materials"), name, &mut Vec::new()));
        }
        resolved
    }

    fn object(
        &self,
        at: &JsonPath<'_>,
        number: usize,
        file: &'a ObjectFile,
        resolved: &mut ResolvedObjects<'a>,
    ) -> Result<()> {
        let ObjectFile { name, shape, material, transform, motion, emission } = file;
        let name = name.clone().unwrap_or_else(|| format!("object {number}"));
        let material = match material {
            Some(name) => match self.keep(self.material_number(&at.key("material"), name, resolved)) {
                Some(number) => Some(number),
                // The shape is checked even if the material has a fault.
                None => Some(resolved.set.add_material(Material {
                    name: name.clone(),
                    surface: Bsdf::Absorber,
                    body: None,
                })),
            },
            None => None,
        };
        let ResolvedMotion { start, motion } = self.motion(transform, motion);
        let frame = DAffine3 { matrix3: start.matrix3, translation: start.translation * self.metres };
        let spd_at = at.key("shape");
        let mut objects = Vec::new();
        if let ShapeFile::Mesh(MeshShapeFile { path, reverse, flat, smooth, flip_v }) = shape {
            let local = DAffine3::from_scale(DVec3::splat(self.metres));
            let motion = motion.map(|motion| (motion, local));
            let mesh_at = spd_at.key("mesh");
            let file = self.source.file(path).and_then(|path| mesh::load(&path, self.source.file_access()));
            let MeshFile { parts, ignored, has_lights } = self.at(&mesh_at.key("path"), file)?;
            if has_lights && self.scene.lights.is_empty() {
                let note = format!("mesh \"{path}\": its lights are not part of a mesh; `abbe import` reads them");
                resolved.set.notes.push(note);
            }
            // A material of the scene replaces the materials of the file.
            if let Some(ignored) = ignored.filter(|_| material.is_none()) {
                let note = format!("mesh \"{path}\": {ignored}");
                if !resolved.set.notes.contains(&note) {
                    resolved.set.notes.push(note);
                }
            }
            for part in parts {
                let part_name = if part.name.is_empty() { name.clone() } else { format!("{name}/{}", part.name) };
                let own_light = part.material.as_ref().map_or([0.0; 3], |own| own.emission);
                let part_material = match material {
                    Some(number) => number,
                    None => self.own_material(&mesh_at, &part, resolved)?,
                };
                let placement = Placement { to_world: frame * local, motion: motion.clone() };
                let mut mesh = part.mesh;
                mesh = if *flat { mesh.without_normals() } else { mesh };
                mesh = if *smooth { mesh.with_normals() } else { mesh };
                mesh = if *reverse { mesh.reversed() } else { mesh };
                mesh = if *flip_v { mesh.with_flipped_v() } else { mesh };
                let mesh = Shape::Mesh(Arc::new(mesh));
                let object = self.at(&spd_at, resolved.set.add_object(part_name, part_material, mesh, placement))?;
                objects.push(object);
                if material.is_none() && emission.is_none() && own_light.iter().any(|&c| c > 0.0) {
                    let emission = EmissionSource::Mesh(own_light);
                    resolved.emitting.push(EmittingObject { file_index: number, objects: vec![object], emission });
                }
            }
        } else if let (Some(material), ShapeFile::Triangles(triangles)) = (material, shape) {
            let local = DAffine3::from_scale(DVec3::splat(self.metres));
            let placement = Placement { to_world: frame * local, motion: motion.map(|motion| (motion, local)) };
            let mesh = Shape::Mesh(Arc::new(self.at(&spd_at.key("triangles"), triangles.mesh())?));
            objects.push(self.at(&spd_at, resolved.set.add_object(name, material, mesh, placement))?);
        } else if let (Some(material), Some((shape, local))) = (material, self.analytic_shape(shape)) {
            let placement = Placement { to_world: frame * local, motion: motion.map(|motion| (motion, local)) };
            objects.push(self.at(&spd_at, resolved.set.add_object(name, material, shape, placement))?);
        }
        if let Some(emission) = emission {
            let emission = EmissionSource::Scene(emission);
            resolved.emitting.push(EmittingObject { file_index: number, objects, emission });
        }
        Ok(())
    }

    fn material_number(&self, at: &JsonPath<'_>, name: &'a str, resolved: &mut ResolvedObjects<'a>) -> Result<usize> {
        if let Some(&number) = resolved.named.get(name) {
            return Ok(number);
        }
        let material = self.material(at, name, &mut resolved.set.notes)?;
        let number = resolved.set.add_material(material);
        resolved.named.insert(name, number);
        Ok(number)
    }

    /// Adds the material of a mesh part. If the part has no material, adds the default material.
    fn own_material(&self, at: &JsonPath<'_>, part: &MeshPart, resolved: &mut ResolvedObjects<'_>) -> Result<usize> {
        let textured = part.mesh.uvs().is_some();
        let material = mesh_materials::material(&part.material.clone().unwrap_or_default(), self.metres, textured);
        Ok(resolved.set.add_material(self.at(at, material)?))
    }

    /// Returns the shape in m, and the transform from the shape's frame to the object's frame.
    /// Returns `None` for a mesh.
    fn analytic_shape(&self, file: &ShapeFile) -> Option<(Shape, DAffine3)> {
        let m = self.metres;
        let shape = match *file {
            ShapeFile::Sphere { center, radius } => {
                let local = DAffine3::from_translation(DVec3::from(center) * self.metres);
                return Some((Shape::Sphere { radius: radius * m }, local));
            }
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
            ShapeFile::Mesh(_) | ShapeFile::Triangles(_) => return None,
        };
        Some((shape, DAffine3::IDENTITY))
    }
}
