//! Translates the objects of the scene file to placed shapes with materials.

use super::meshes::{LoadedMesh, LoadedPart, MeshCache};
use super::{context::Resolver, mesh_materials, motion::ResolvedMotion};
use crate::{EmissionFile, JsonPath, ObjectFile, ShapeFile};
use abbe_optics::bsdf::Bsdf;
use abbe_optics::texture::SurfaceSpectrum;
use abbe_scene::Material;
use abbe_scene::builder::{ObjectSet, Placement};
use abbe_scene::geometry::shape::Shape;
use abbe_spectra::error::Result;
use glam::{DAffine3, DVec3};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The resolved objects, and the emission of their surfaces.
#[derive(Default)]
pub(super) struct SceneObjects<'a> {
    pub(super) set: ObjectSet,
    pub(super) emitting: Vec<EmittingObject<'a>>,
    /// The material number for each material name.
    named: BTreeMap<&'a str, usize>,
    meshes: MeshCache<'a>,
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
    Scene(&'a EmissionFile),
    /// The emission in a mesh file. The colour is linear RGB, and white, (1, 1, 1), has a luminance
    /// of 1 cd/m². The slide is a picture that multiplies the colour.
    Mesh([f64; 3], Option<SurfaceSpectrum>),
}

impl<'a> Resolver<'a> {
    pub(super) fn objects(&self) -> SceneObjects<'a> {
        let mut resolved = SceneObjects::default();
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

    fn object(&self, at: &JsonPath, index: usize, file: &'a ObjectFile, resolved: &mut SceneObjects<'a>) -> Result<()> {
        let ObjectFile { name, shape, material, transform, motion, emission } = file;
        let name = name.clone().unwrap_or_else(|| format!("object {index}"));
        let material = material.as_ref().map(|name| {
            let number = self.keep(self.material_number(&at.key("material"), name, resolved));
            // The shape is checked even if the material has a fault.
            let absorber = || Material { name: name.clone(), surface: Bsdf::Absorber, normal_map: None, body: None };
            number.unwrap_or_else(|| resolved.set.add_material(absorber()))
        });
        let ResolvedMotion { start, motion } = self.motion(transform, motion);
        let frame = DAffine3 { matrix3: start.matrix3, translation: start.translation * self.metres };
        let placed = |local: DAffine3| Placement {
            to_world: frame * local,
            motion: motion.clone().map(|motion| (motion, local)),
        };
        let objects = self.shared_shape(&at.key("shape"), shape, |shape_at, shape| {
            if let Some((shape, local)) = self.analytic_shape(shape) {
                let Some(material) = material else {
                    let expected = "a material for shapes other than meshes";
                    return Err(self.source.fault(at, "the shape has no material", expected));
                };
                // The error of a shape names its key, such as `side`, but not the place of the
                // shape.
                let added = resolved.set.add_object(name, material, shape, placed(local)).map_err(|mut error| {
                    error.location.path = None;
                    error
                });
                return Ok(vec![self.at(shape_at, added)?]);
            }
            let Some(mesh) = self.mesh(shape_at, shape, &mut resolved.meshes)? else { return Ok(Vec::new()) };
            let local = DAffine3::from_scale(DVec3::splat(self.metres));
            if let ShapeFile::Mesh(file) = shape {
                self.note_ignored(&file.path, &mesh, material.is_none(), &mut resolved.set);
            }
            let mut objects = Vec::new();
            for part in &mesh.parts {
                let painted = if material.is_none() { self.at(shape_at, part.painted())? } else { Cow::Borrowed(part) };
                let part = painted.as_ref();
                let name = if part.name.is_empty() { name.clone() } else { format!("{name}/{}", part.name) };
                let own_light = part.emitter().filter(|_| material.is_none() && emission.is_none());
                let is_luminous = emission.is_some() || own_light.is_some();
                if part.copies > 0 && !is_luminous {
                    let copies = part.copies;
                    resolved.set.notes.push(format!(
                        "the mesh \"{name}\" has {copies} triangles with the corners of others, most likely doubled \
                         faces, and the copies are dropped"
                    ));
                }
                let shape = Shape::Mesh(part.mesh_for(is_luminous));
                let own = || self.own_material(shape_at, part, resolved);
                let material = material.map_or_else(own, Ok)?;
                let object = self.at(shape_at, resolved.set.add_object(name, material, shape, placed(local)))?;
                objects.push(object);
                if let Some(light) = own_light {
                    let light = super::mesh_materials::emission(light, part.mesh.uvs().is_some());
                    let (rgb, slide) = self.at(shape_at, light)?;
                    let emission = EmissionSource::Mesh(rgb, slide);
                    resolved.emitting.push(EmittingObject { file_index: index, objects: vec![object], emission });
                }
            }
            Ok(objects)
        })?;
        if let Some(emission) = emission {
            let emission = EmissionSource::Scene(emission);
            resolved.emitting.push(EmittingObject { file_index: index, objects, emission });
        }
        Ok(())
    }

    fn material_number(&self, at: &JsonPath, name: &'a str, resolved: &mut SceneObjects<'a>) -> Result<usize> {
        if let Some(&number) = resolved.named.get(name) {
            return Ok(number);
        }
        let material = self.material(at, name, &mut resolved.set.notes)?;
        let number = resolved.set.add_material(material);
        resolved.named.insert(name, number);
        Ok(number)
    }

    /// Returns the number of a mesh part's material, or that of the default material.
    fn own_material(&self, at: &JsonPath, part: &LoadedPart, resolved: &mut SceneObjects) -> Result<usize> {
        if let Some(known) = part.material_number.get() {
            return Ok(known);
        }
        let (own, textured) = (part.material.clone().unwrap_or_default(), part.mesh.uvs().is_some());
        let material = mesh_materials::material(&own, self.metres, textured, part.mesh.is_closed());
        let number = resolved.set.add_material(self.at(at, material)?);
        part.material_number.set(Some(number));
        Ok(number)
    }

    /// Notes what the mesh reader ignored. A material of the scene replaces those of the file.
    fn note_ignored(&self, path: &str, mesh: &LoadedMesh, has_own_materials: bool, set: &mut ObjectSet) {
        let lights = (mesh.has_lights && self.scene.lights.is_empty())
            .then(|| "its lights are not part of a mesh; `abbe import` reads them".to_string());
        let ignored = mesh.ignored.clone().filter(|_| has_own_materials);
        for what in lights.into_iter().chain(ignored).chain(mesh.remarks.iter().cloned()) {
            let note = format!("mesh \"{path}\": {what}");
            if !set.notes.contains(&note) {
                set.notes.push(note);
            }
        }
        for what in mesh.warnings.iter().filter(|_| has_own_materials) {
            let warning = format!("mesh \"{path}\": {what}");
            if !set.warnings.contains(&warning) {
                set.notes.push(warning.clone());
                set.warnings.push(warning);
            }
        }
    }

    /// Returns the shape in m, and its frame in that of the object. Returns `None` for a mesh.
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
            ShapeFile::Lens { radius1, radius2, thickness, diameter } => {
                let [radius1, radius2, thickness, diameter] =
                    [radius1, radius2, thickness, diameter].map(|length| length * m);
                Shape::Lens { radius1, radius2, thickness, diameter }
            }
            ShapeFile::Mesh(_) | ShapeFile::Triangles(_) | ShapeFile::Shared(_) => return None,
        };
        Some((shape, DAffine3::IDENTITY))
    }
}
