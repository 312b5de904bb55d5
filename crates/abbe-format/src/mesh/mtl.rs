//! Material libraries of OBJ files (MTL).

use super::material::{MeshMaterial, MeshOpacity, MeshTexture};
use super::part::listed;
use crate::{FileAccess, PictureFile};
use abbe_optics::texture::{Filter, UvTransform, Wrap};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::without_byte_order_mark;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// A material of a library: the values of its keys.
#[derive(Debug, Default)]
pub(super) struct MtlMaterial {
    pub(super) name: String,
    /// The keys as the file writes them, and their values, by the key in lower case. If a key
    /// occurs twice, the last one counts.
    keys: BTreeMap<String, (String, String)>,
}

/// Parses a library. Keys before the first `newmtl` belong to no material.
pub(super) fn parse(bytes: &[u8]) -> Vec<MtlMaterial> {
    let text = String::from_utf8_lossy(bytes);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    for line in without_byte_order_mark(&text).lines() {
        let line = line.trim();
        let (key, value) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let value = value.trim();
        if key.eq_ignore_ascii_case("newmtl") {
            materials.push(MtlMaterial { name: value.to_owned(), keys: BTreeMap::new() });
        } else if let Some(material) = materials.last_mut().filter(|_| !key.is_empty() && !key.starts_with('#')) {
            material.keys.insert(key.to_ascii_lowercase(), (key.to_owned(), value.to_owned()));
        }
    }
    materials
}

/// Converts the materials of all libraries of an OBJ file, and adds sentences about the pictures
/// that cannot be used. `obj` is the path of the OBJ file, to whose folder their names are
/// relative.
pub(super) fn converted(
    materials: &[MtlMaterial],
    obj: &Path,
    file_access: FileAccess,
    notes: &mut Vec<String>,
) -> Vec<MeshMaterial> {
    materials
        .iter()
        .map(|file| {
            let picture = file.value("map_kd").map(|name| diffuse_texture(name, obj, file_access)).transpose();
            let base_colour_texture = picture.unwrap_or_else(|error| {
                // The error of a picture names its file.
                notes.push(format!("the texture map_Kd of \"{}\" cannot be used ({error})", file.name));
                None
            });
            MeshMaterial { base_colour_texture, ..material(file) }
        })
        .collect()
}

impl MtlMaterial {
    fn value(&self, key: &str) -> Option<&str> {
        self.keys.get(key).map(|(_, value)| value.as_str())
    }

    /// Returns a finite number, or `None` if there is none.
    fn number(&self, key: &str) -> Option<f64> {
        finite(self.value(key)?.split_whitespace().next()?)
    }

    /// Returns a colour of one or three components. A single one is that of a grey.
    fn colour(&self, key: &str) -> Option<[f64; 3]> {
        let components: Option<Vec<f64>> = words(self.value(key)?).map(finite).collect();
        match components?[..] {
            [grey] => Some([grey; 3]),
            [r, g, b] => Some([r, g, b]),
            _ => None,
        }
    }

    /// Returns the illumination model.
    fn model(&self) -> Option<u8> {
        self.number("illum").map(|model| model as u8)
    }

    /// Returns the covered part of the surface: `d`, or 1 − `Tr`.
    fn opacity(&self) -> Option<f64> {
        let opacity = self.number("d").or_else(|| self.number("tr").map(|transparency| 1.0 - transparency));
        opacity.map(|opacity| opacity.clamp(0.0, 1.0))
    }

    fn is_black(&self) -> bool {
        self.colour("kd").is_some_and(|colour| colour == [0.0; 3]) && self.value("map_kd").is_none()
    }

    /// Returns true if the material is glass: its illumination model refracts, or it states no
    /// model but an index of refraction or a black surface, and most of the light passes through.
    fn is_glass(&self) -> bool {
        let (refracts, default) = match self.model() {
            Some(model) => (matches!(model, 4 | 6 | 7 | 9), 0.0),
            None => (self.is_black() || self.number("ni").is_some_and(|index| index > 1.0), 1.0),
        };
        refracts && self.opacity().unwrap_or(default) <= 0.5
    }

    /// Returns true if `Tr` states an opacity, as OpenMVS and MeshLab write it: the surface would
    /// otherwise be invisible.
    fn has_reversed_transparency(&self) -> bool {
        self.number("d").is_none() && self.number("tr") == Some(1.0) && !self.is_glass()
    }

    /// Returns the part of its area that the surface covers.
    fn covered(&self) -> f64 {
        if self.is_glass() || self.has_reversed_transparency() { 1.0 } else { self.opacity().unwrap_or(1.0) }
    }
}

fn words(value: &str) -> impl Iterator<Item = &str> {
    value.split_whitespace().take_while(|word| !word.starts_with('#'))
}

fn finite(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Splits the value of a texture key into the name of the file, the map of texture coordinates, and
/// what the picture looks like outside the unit square.
fn texture_options(value: &str) -> Result<(&str, UvTransform, Wrap)> {
    let (mut rest, mut scale, mut offset, mut wrap) = (value.trim(), [1.0; 2], [0.0; 2], Wrap::Repeat);
    while rest.starts_with('-') {
        let (option, mut after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        match option {
            "-s" | "-o" => {
                let pair = if option == "-s" { &mut scale } else { &mut offset };
                // One to three numbers follow, of which the third one is for volumes.
                for place in 0..3 {
                    let (word, left) = after.trim_start().split_once(char::is_whitespace).unwrap_or((after, ""));
                    let Ok(number) = word.parse::<f64>() else { break };
                    if let Some(component) = pair.get_mut(place) {
                        *component = number;
                    }
                    after = left;
                }
            }
            "-clamp" => {
                let (word, left) = after.trim_start().split_once(char::is_whitespace).unwrap_or((after, ""));
                wrap = if word == "on" { Wrap::Clamp } else { Wrap::Repeat };
                after = left;
            }
            _ => return Err(Error::input(format!("the option {option} of \"{value}\" is not supported"))),
        }
        rest = after.trim_start();
    }
    // In OBJ files, v increases upwards.
    let offset = [offset[0], 1.0 - scale[1] - offset[1]];
    Ok((rest, UvTransform::new(scale, 0.0, offset), wrap))
}

/// Reads the picture of a material's diffuse colour. `value` is the value of the key `map_Kd`.
fn diffuse_texture(value: &str, obj: &Path, file_access: FileAccess) -> Result<MeshTexture> {
    let (name, transform, wrap) = texture_options(value)?;
    if name.is_empty() {
        return Err(Error::input("it names no file"));
    }
    let file = file_access.file(obj.parent().unwrap_or(Path::new("")), Path::new(&name.replace('\\', "/")))?;
    let picture = Arc::new(PictureFile::read(&file)?);
    Ok(MeshTexture { picture, wrap: [wrap; 2], filter: Filter::Bilinear, transform })
}

/// Describes the keys of the materials that are ignored, and those that can be read in two ways.
pub(super) fn ignored_keys(materials: &[MtlMaterial]) -> Vec<String> {
    let keys = || materials.iter().flat_map(|material| &material.keys);
    let mut textures: Vec<&str> =
        keys().filter(|(key, _)| is_texture(key) && *key != "map_kd").map(|(_, (key, _))| key.as_str()).collect();
    textures.sort_unstable();
    let any = |value: &str, holds: fn(f64) -> bool| words(value).filter_map(finite).any(holds);
    let layers = keys().filter(|(key, (_, value))| match key.as_str() {
        "ps" | "pc" | "pcr" | "aniso" | "anisor" => any(value, |number| number != 0.0),
        "tf" => any(value, |number| number < 1.0),
        _ => false,
    });
    let layers: Vec<&str> = layers.map(|(_, (key, _))| key.as_str()).collect();
    let unreadable = materials.iter().flat_map(|material| {
        let wrong = |(key, _): &(&String, &(String, String))| match key.as_str() {
            "kd" | "ks" | "ke" => material.colour(key).is_none(),
            "ns" | "ni" | "d" | "tr" | "illum" | "pm" | "pr" => material.number(key).is_none(),
            _ => false,
        };
        material.keys.iter().filter(wrong).map(|(_, (key, value))| format!("{key} {value}"))
    });
    let unreadable: Vec<String> = unreadable.collect();
    let reversed = materials.iter().filter(|material| material.has_reversed_transparency());
    let partial = materials.iter().filter(|material| material.covered() < 1.0);
    let names = |name: &MtlMaterial| format!("\"{}\"", name.name);
    let (reversed, partial): (Vec<_>, Vec<_>) = (reversed.map(names).collect(), partial.map(names).collect());
    let list = |names: &[String], before: &str, after: &str| {
        listed(names.iter().map(String::as_str)).map(|names| format!("{before}{names}{after}"))
    };
    [
        listed(textures).map(|keys| format!("textures are ignored: {keys}")),
        listed(layers).map(|keys| format!("material keys are ignored: {keys}")),
        list(&unreadable, "values of materials that are not numbers or colours are ignored: ", ""),
        list(&reversed, "`Tr 1` would make a surface invisible, so it counts as opaque: material ", ""),
        list(
            &partial,
            "`d` and `Tr` state the covered part of a surface, and light passes through the rest without refraction: material ",
            " (for glass, state `illum 6`)",
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn is_texture(key: &str) -> bool {
    key.starts_with("map_") || ["bump", "norm", "disp", "decal", "refl"].contains(&key)
}

/// Converts a material.
///
/// `Kd` is the base colour, `Ni` the index of refraction and `d` the part of its area that the
/// surface covers. `Tr` is 1 − `d`. A material with the illumination model 4, 6, 7 or 9 is glass
/// unless `d` or `Tr` state that it is mostly opaque, and a pane of glass on an open mesh. The
/// Phong exponent `Ns` corresponds to the microfacet parameter α = √(2/(Ns + 2)) (Walter et al.
/// 2007). The extension key `Pm` states the metalness directly, and `Pr` states the roughness. An
/// opaque material with a black `Kd` and a specular colour `Ks` is a metal of this colour, as in
/// files with mirrors.
fn material(file: &MtlMaterial) -> MeshMaterial {
    let (is_glass, covered) = (file.is_glass(), file.covered());
    let specular = file.colour("ks");
    let shines = specular.is_some_and(|colour| colour.iter().any(|&c| c > 0.0));
    let shininess = file.number("ns").filter(|_| shines || is_glass);
    let of_shininess = shininess.map(|ns| (2.0 / (ns.max(0.0) + 2.0)).sqrt().sqrt());
    let roughness = file.number("pr").or(of_shininess).unwrap_or(if is_glass { 0.0 } else { 1.0 });
    let emission = file.colour("ke").unwrap_or([0.0; 3]).map(|component| component.max(0.0));
    let metal = specular.filter(|_| file.is_black() && shines && !is_glass && emission == [0.0; 3]);
    let colour = metal.map(|colour| colour.map(|component| component.min(1.0))).or(file.colour("kd"));
    // The colour of a pane is a transmittance, which MTL files do not state by `Kd`.
    let colour = if is_glass { Some([1.0; 3]) } else { colour };
    MeshMaterial {
        name: file.name.clone(),
        base_colour: colour.unwrap_or(MeshMaterial::default().base_colour),
        metallic: file.number("pm").unwrap_or(if metal.is_some() { 1.0 } else { 0.0 }).clamp(0.0, 1.0),
        roughness: roughness.clamp(0.0, 1.0),
        // A surface of an OBJ file is either glass or opaque.
        transmission: if is_glass { 1.0 } else { 0.0 },
        is_sheet: is_glass,
        ior: file.number("ni").filter(|&ni| ni >= 1.0).unwrap_or(MeshMaterial::default().ior),
        opacity: if covered < 1.0 { MeshOpacity::Blend { alpha: covered } } else { MeshOpacity::Opaque },
        emission,
        ..MeshMaterial::default()
    }
}
