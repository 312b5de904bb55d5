//! Converts the shapes of a Mitsuba scene to objects.

use super::reader::{MitsubaReader, MitsubaSurface};
use super::transform::{affine, steps};
use super::{primitives, primitives::BasicShape, properties::Properties, xml::XmlElement};
use crate::facing::{NormalSide, normal_side};
use abbe_format::mesh;
use abbe_format::mesh::MeshPart;
use abbe_format::without_nulls;
use abbe_spectra::error::Result;
use glam::{DMat4, DVec3};
use serde_json::{Value, json};
use std::path::Path;
use std::rc::Rc;

/// The properties of a shape that decide its form.
struct ShapePlacement {
    to_world: DMat4,
    /// True if the material has a texture.
    textured: bool,
    /// True if the front and the back are exchanged.
    flipped: bool,
    /// True if the shape emits light.
    emits: bool,
}

impl MitsubaReader<'_> {
    /// Converts a shape, or all shapes of a group. `outer` is the placement of the group.
    pub(super) fn shape(&mut self, shape: &Rc<XmlElement>, outer: DMat4) -> Result<()> {
        match shape.plugin() {
            // The instances of a group place its shapes.
            "shapegroup" => Ok(()),
            "instance" => self.instance(shape, outer),
            "merge" => self.members(shape, outer),
            _ => self.single_shape(shape, outer),
        }
    }

    fn instance(&mut self, instance: &Rc<XmlElement>, outer: DMat4) -> Result<()> {
        let properties = Properties::new(instance);
        let to_world = outer * properties.transform("to_world")?;
        let is_group = |child: &Rc<XmlElement>| self.document.resolve(child).plugin() == "shapegroup";
        let groups = properties.take(is_group).into_iter().map(|it| self.document.resolve(it));
        let groups: Vec<Rc<XmlElement>> = groups.collect();
        if groups.is_empty() {
            return Err(instance.error("an instance without a shape group"));
        }
        self.note_unread(&properties);
        groups.iter().try_for_each(|group| self.members(group, to_world))
    }

    fn members(&mut self, group: &Rc<XmlElement>, to_world: DMat4) -> Result<()> {
        let properties = Properties::new(group);
        let members = self.tagged(&properties, "shape");
        self.note_unread(&properties);
        for member in members {
            // Nested instances could multiply without limit, and Mitsuba has none.
            if member.plugin() == "instance" {
                return Err(member.error("an instance inside a shape group"));
            }
            self.shape(&member, to_world)?;
        }
        Ok(())
    }

    fn single_shape(&mut self, shape: &Rc<XmlElement>, outer: DMat4) -> Result<()> {
        let properties = Properties::new(shape);
        let medium = self.interior(&properties)?;
        let [bsdfs, emitters, sensors] = ["bsdf", "emitter", "sensor"].map(|tag| self.tagged(&properties, tag));
        if !sensors.is_empty() {
            self.note(shape, "a sensor on a shape is left out");
        }
        let emission = emitters.first().map_or(Ok(None), |emitter| self.area_emission(emitter))?;
        let surface = match bsdfs.first() {
            Some(bsdf) => self.surface(bsdf, medium.as_deref())?,
            None => self.default_surface(!emitters.is_empty()),
        };
        let (material, one_sided) = match surface {
            MitsubaSurface::Material { name, one_sided } => (name, one_sided),
            MitsubaSurface::Invisible if emission.is_some() => {
                (self.scene.add_material("absorber", json!("absorber")), false)
            }
            MitsubaSurface::Invisible => return Ok(()),
        };
        let form = ShapePlacement {
            to_world: outer * properties.transform("to_world")?,
            textured: self.is_textured(&material) || emission.as_ref().is_some_and(|it| it.get("slide").is_some()),
            flipped: properties.boolean("flip_normals", false)?,
            emits: emission.is_some(),
        };
        let found = self.form(&properties, &form)?;
        let Some(BasicShape { shape: converted, steps: mut transform }) = found else { return Ok(()) };
        self.note_unread(&properties);
        self.note_open_shape(&properties, &material, one_sided && emission.is_none())?;
        transform.extend(steps(affine(shape, form.to_world)?));
        let (name, transform) = (shape.attribute("id"), (!transform.is_empty()).then_some(transform));
        self.scene.add_object(without_nulls(json!({
            "shape": converted, "material": material, "name": name, "transform": transform, "emission": emission
        })));
        Ok(())
    }

    /// Converts the geometry of a shape. Returns `None` if the shape is left out.
    fn form(&mut self, properties: &Properties, form: &ShapePlacement) -> Result<Option<BasicShape>> {
        let shape = properties.element;
        Ok(Some(match shape.plugin() {
            "rectangle" => primitives::rectangle(form.textured, form.flipped),
            "cube" => primitives::cube(form.textured, form.flipped),
            "sphere" => {
                if form.flipped {
                    self.note(shape, "`flip_normals` of a sphere is left out: it faces outwards");
                }
                let centre = properties.vector("center")?.unwrap_or(DVec3::ZERO);
                primitives::sphere(centre, self.radius(properties)?, form.textured)
            }
            "disk" => primitives::disk(form.textured, form.flipped),
            "cylinder" => {
                let from = properties.vector("p0")?.unwrap_or(DVec3::ZERO);
                let to = properties.vector("p1")?.unwrap_or(DVec3::Z);
                let cylinder = primitives::cylinder(from, to, self.radius(properties)?, form.flipped);
                cylinder.ok_or_else(|| shape.error("the two ends of a cylinder are equal"))?
            }
            "obj" | "ply" | "serialized" => self.mesh(properties, form)?,
            other => {
                self.note(shape, format!("a shape of the type \"{other}\" is not supported and is left out"));
                return Ok(None);
            }
        }))
    }

    fn radius(&mut self, properties: &Properties) -> Result<f64> {
        let radius = properties.number("radius", 1.0)?;
        if radius > 0.0 {
            return Ok(radius);
        }
        Err(properties.element.error(format!("found the radius {radius}")).expected("a number above 0"))
    }

    fn mesh(&mut self, properties: &Properties, form: &ShapePlacement) -> Result<BasicShape> {
        let shape = properties.element;
        let (path, file) = self.document.file(shape, properties.required_text("filename")?)?;
        if !Path::new(&path).extension().is_some_and(|it| it.eq_ignore_ascii_case(shape.plugin())) {
            let what = format!("the mesh \"{path}\" has an unusual extension");
            return Err(shape.error(what).expected(format!(".{}", shape.plugin())));
        }
        properties.ignore(&["collapse", "max_smooth_angle"]);
        let flat = properties.boolean("face_normals", false)?;
        // OBJ files have v = 0 at the lower edge of a picture. Mitsuba takes the coordinates of PLY
        // files as they are, and Abbe reads them like those of OBJ files.
        // The coordinates of serialized files have their meaning in both programs.
        let flip_v = match shape.plugin() {
            "serialized" => properties.boolean("flip_tex_coords", false)?,
            plugin => !properties.boolean("flip_tex_coords", plugin == "obj")?,
        };
        let part = (shape.plugin() == "serialized").then(|| properties.number("shape_index", 0.0)).transpose()?;
        // Abbe keeps the front of a mirrored mesh. In Mitsuba, normals or else corners decide.
        let mirrored = form.to_world.determinant() < 0.0;
        let part = part.map(|part| part as u32);
        let file_access = self.document.file_access;
        let parts = || -> Result<Vec<MeshPart>> {
            let read = mesh::load_unplaced(&file, file_access).map_err(|error| shape.locate(error))?;
            let is_chosen = |number: u32| part.is_none_or(|part| part == number);
            Ok(read.parts.into_iter().filter(|(number, _)| is_chosen(*number)).map(|(_, part)| part).collect())
        };
        let by_corners = || -> Result<bool> { Ok(flat || parts()?.iter().any(|part| part.mesh.normals().is_none())) };
        let side = if form.emits && !flat { normal_side(&parts()?) } else { NormalSide::Front };
        let turned = side == NormalSide::Back;
        if side == NormalSide::Both {
            self.note(shape, "the normals of a light point to both sides of its faces: it shines to their front");
        } else if turned {
            self.note(shape, "the faces of a light are turned to the side of its vertex normals, which are left out");
        }
        let reverse = form.flipped != ((mirrored && by_corners()?) != turned);
        let (path, flat) = (format!("{}{path}", self.folder), flat || turned);
        let [reverse, flat, smooth, flip_v] = [reverse, flat, !flat, flip_v].map(|is_set| is_set.then_some(true));
        let mesh = without_nulls(json!({
            "path": path, "part": part, "reverse": reverse, "flat": flat, "smooth": smooth, "flip_v": flip_v
        }));
        Ok(BasicShape { shape: json!({"mesh": mesh}), steps: Vec::new() })
    }

    fn interior(&mut self, properties: &Properties) -> Result<Option<String>> {
        if let Some(exterior) = properties.find("exterior") {
            let exterior = self.document.resolve(exterior);
            if !self.outside.as_ref().is_some_and(|outside| Rc::ptr_eq(outside, &exterior)) {
                self.note(properties.element, "the exterior medium of a shape is left out: the body around states it");
            }
        }
        let Some(interior) = properties.find("interior") else { return Ok(None) };
        let interior = self.document.resolve(interior);
        self.medium(&interior)
    }

    fn is_textured(&self, material: &str) -> bool {
        fn has_texture(value: &Value) -> bool {
            match value {
                Value::Object(entries) => {
                    let is_texture = |key: &str| ["image", "checker", "normal_map"].contains(&key);
                    entries.iter().any(|(key, value)| is_texture(key) || has_texture(value))
                }
                Value::Array(items) => items.iter().any(has_texture),
                Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => false,
            }
        }
        let Some(material) = self.scene.material(material) else { return false };
        let parts = material.get("mix").and_then(Value::as_array).into_iter().flatten();
        let mut names = parts.filter_map(|part| part.get("material")?.as_str());
        has_texture(material) || names.any(|name| self.is_textured(name))
    }

    /// Notes what is different on a shape that is not closed.
    fn note_open_shape(&mut self, properties: &Properties, material: &str, one_sided: bool) -> Result<()> {
        let has = |kind: &str| self.scene.material(material).is_some_and(|material| material.get(kind).is_some());
        let needs_body = has("dielectric") || has("boundary");
        if !(needs_body || one_sided) || !self.is_open(properties)? {
            return Ok(());
        }
        let what = if needs_body {
            "glass or a medium behind an open shape needs a closed shape in Abbe"
        } else {
            "a surface that is black from behind scatters light on both sides"
        };
        self.note(properties.element, what);
        Ok(())
    }

    fn is_open(&self, properties: &Properties) -> Result<bool> {
        let shape = properties.element;
        Ok(match shape.plugin() {
            "rectangle" | "disk" | "cylinder" => true,
            "obj" | "ply" | "serialized" => {
                let (_, file) = self.document.file(shape, properties.required_text("filename")?)?;
                let parts = mesh::load_unplaced(&file, self.document.file_access).map_err(|it| shape.locate(it))?;
                let chosen = (shape.plugin() == "serialized").then(|| properties.number("shape_index", 0.0));
                let chosen = chosen.transpose()?.map(|index| index as u32);
                let is_chosen = |number: u32| chosen.is_none_or(|chosen| chosen == number);
                parts.parts.iter().any(|(&number, part)| is_chosen(number) && !part.mesh.is_closed())
            }
            _ => false,
        })
    }
}
