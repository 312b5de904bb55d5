//! Adds the shapes of a pbrt file to the scene, with their materials and emission.

use super::shape::{PbrtShape, ReadShape, ShapeReader};
use super::state::{is_placement, transform};
use super::texture::{is_uniform, map_numbers};
use super::token::{Place, Tokens};
use super::{light::read_emission, material::ReadMaterial, parameters::Parameters, reader::PbrtReader};
use abbe_format::without_nulls;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::cbrt;
use serde_json::{Value, json};

impl PbrtReader<'_> {
    pub(super) fn shape(
        &mut self,
        class: &str,
        parameters: &Parameters,
        place: &Place,
        left_out: &mut Vec<String>,
    ) -> Result<()> {
        let spectra = self.spectra();
        let mut reader = ShapeReader {
            folder: self.folder,
            base: spectra.folder,
            file_access: spectra.file_access,
            reverse: self.state.reverse,
            textured: self.is_textured(&self.state.material.1)
                || parameters.get("alpha").is_some_and(|alpha| alpha.kind == "texture"),
            emits: self.state.area_light.is_some(),
            left_out: Vec::new(),
        };
        let shape = reader.read(class, parameters)?;
        left_out.extend(reader.left_out);
        let Some(ReadShape { shape, local, area }) = shape else { return Ok(()) };
        let to_world = self.world * self.state.ctm * local;
        if !is_placement(&to_world) {
            left_out.push("a shape whose transform cannot be inverted is left out".into());
            return Ok(());
        }
        let scale = cbrt(self.state.ctm.determinant().abs());
        let area = area.map(|area| area * scale * scale);
        let lit = self.state.area_light.as_ref();
        let emission = lit.map(|light| read_emission(light, area, &spectra, left_out)).transpose()?;
        let (name, material) = self.state.material.clone();
        let placed = self.placed_material(&name, &material, emission.is_some(), left_out);
        let Some(material) = placed else { return Ok(()) };
        let alpha = self.with_textures(left_out, |textures| textures.value(parameters, "alpha", true, 1.0))?;
        if emission.is_some() && alpha == json!(0.0) {
            left_out.push("an area light with an alpha of 0 is visible".into());
        }
        let material = self.scene.with_holes(&material, &alpha, &complement(&alpha)).unwrap_or_else(|| {
            left_out.push("the opacity of a body, or of a mix of materials, is left out".into());
            material
        });
        let placed = PbrtShape { shape, to_world, material, emission };
        match self.defining.as_ref().and_then(|name| self.objects.get_mut(name)) {
            Some(shapes) => {
                if placed.emission.is_some() {
                    self.scene.leave_out(place.text(), "an area light inside an object is left out");
                }
                let mut shape = placed.shape;
                if shape.get("triangles").is_some() {
                    let name = format!("{} {}", self.defining.as_deref().unwrap_or_default(), shapes.len() + 1);
                    shape = json!({"shared": self.scene.add_shape(&name, shape)});
                }
                shapes.push(PbrtShape { shape, emission: None, ..placed });
            }
            None => self.add_object(placed),
        }
        Ok(())
    }

    fn is_textured(&self, material: &ReadMaterial) -> bool {
        match material {
            ReadMaterial::Interface => false,
            ReadMaterial::Surface { material, normal_map } => normal_map.is_some() || has_texture(material),
            ReadMaterial::Mix(names, amount) => {
                let mut parts = names.iter().filter_map(|name| self.named_material(name));
                has_texture(amount)
                    || parts.any(|part| !matches!(**part, ReadMaterial::Mix(..)) && self.is_textured(part))
            }
        }
    }

    /// Adds the material of a shape and returns its name, or `None` if the shape has no effect.
    fn placed_material(
        &mut self,
        name: &str,
        material: &ReadMaterial,
        is_lit: bool,
        left_out: &mut Vec<String>,
    ) -> Option<String> {
        let inside = self.media.get(&self.state.media[0]).cloned();
        match material {
            ReadMaterial::Interface => match inside {
                _ if is_lit => Some(self.scene.add_material("absorber", json!("absorber"))),
                Some(medium) => {
                    let boundary = json!({"boundary": {"medium": medium}});
                    Some(self.scene.add_material(&format!("boundary of {medium}"), boundary))
                }
                None => {
                    if !self.state.media[1].is_empty() {
                        left_out.push("an opening in a medium is left out".into());
                    }
                    None
                }
            },
            ReadMaterial::Surface { material, normal_map } => {
                let mut surface = material.clone();
                if let (Some(dielectric), Some(medium)) = (surface.get_mut("dielectric"), inside) {
                    dielectric["medium"] = json!(medium);
                }
                let name = self.scene.add_material(name, surface);
                normal_map.clone().and_then(|map| self.scene.with_normal_map(&name, map)).or(Some(name))
            }
            ReadMaterial::Mix(names, amount) => {
                let mut parts = Vec::new();
                for part in names {
                    let Some(material) = self.named_material(part).cloned() else {
                        self.unknown_material.get_or_insert_with(|| part.clone());
                        left_out.push(format!("the part \"{part}\" of a mix does not exist and is left out"));
                        continue;
                    };
                    if let ReadMaterial::Surface { material, normal_map } = &*material {
                        if normal_map.is_some() {
                            left_out.push(format!("the normal map of the part \"{part}\" of a mix is left out"));
                        }
                        let plain = ReadMaterial::Surface { material: material.clone(), normal_map: None };
                        parts.extend(self.placed_material(part, &plain, is_lit, left_out));
                    } else {
                        left_out.push(format!("the part \"{part}\" of a mix is not a surface and is left out"));
                    }
                }
                let mix = match parts.as_slice() {
                    [a, b] => json!({"mix": [
                        {"material": a, "weight": complement(amount)}, {"material": b, "weight": amount}
                    ]}),
                    [only] => return Some(only.clone()),
                    _ => json!({"diffuse": {"reflectance": 0.5}}),
                };
                Some(self.scene.add_material(name, mix))
            }
        }
    }

    fn add_object(&mut self, placed: PbrtShape) {
        let PbrtShape { shape, to_world, material, emission } = placed;
        let steps = transform(&to_world);
        let steps = (steps != json!([])).then_some(steps);
        self.scene.add_object(without_nulls(json!({
            "shape": shape, "material": material, "transform": steps, "emission": emission
        })));
    }

    pub(super) fn instance(&mut self, tokens: &mut Tokens, place: &Place) -> Result<()> {
        let name = tokens.string("ObjectInstance")?;
        let shapes = self.objects.get(&name).cloned();
        let shapes = shapes.ok_or_else(|| place.error(format!("there is no object \"{name}\"")))?;
        // The shapes are already in Abbe's world.
        let instance = self.world * self.state.ctm * self.world;
        for shape in shapes {
            let to_world = instance * shape.to_world;
            if is_placement(&to_world) {
                self.add_object(PbrtShape { to_world, ..shape });
            }
        }
        Ok(())
    }
}

fn has_texture(form: &Value) -> bool {
    !is_uniform(form) || form.as_object().is_some_and(|entries| entries.values().any(has_texture))
}

/// Returns 1 minus a number or a texture of numbers.
fn complement(amount: &Value) -> Value {
    map_numbers(amount.clone(), &|x| 1.0 - x)
}
