//! Wavefront OBJ files with MTL materials.

use super::material::{MeshMaterial, MeshTexture};
use super::packed::read;
use super::part::{MeshPart, PartsAndNotes, listed};
use crate::{FileAccess, PictureFile};
use abbe_optics::texture::{Filter, UvTransform, Wrap};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use glam::DVec3;
use std::borrow::Cow;
use std::cell::RefCell;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// Reads the parts of an OBJ file. Also returns sentences about the materials that are ignored.
pub(super) fn load(path: &Path, file_access: FileAccess) -> Result<PartsAndNotes> {
    let bytes = read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let text = joined_lines(&text);
    check_faces(&text)?;
    let used = used_materials(&text);
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ignore_points: true, ignore_lines: true };
    let missing = RefCell::new(Vec::new());
    let (models, materials) = tobj::load_obj_buf(&mut Cursor::new(text.as_bytes()), &options, |library| {
        let unusable = |why: &dyn std::fmt::Display| {
            let sentence = format!("the material library \"{}\" cannot be used ({why})", library.display());
            missing.borrow_mut().push(sentence);
        };
        let file = file_access.file(path.parent().unwrap_or(Path::new("")), library).map_err(|error| {
            unusable(&error);
            tobj::LoadError::OpenFileFailed
        })?;
        tobj::load_mtl(file).inspect_err(|error| unusable(error))
    })
    .map_err(|error| Error::input(format!("not a valid OBJ file: {error}")))?;
    let materials = materials.unwrap_or_default();
    let mut ignored = missing.into_inner();
    ignored.extend(ignored_textures(&materials));
    let unknown = used.iter().filter(|name| !materials.iter().any(|known| known.name == **name));
    if let Some(names) = listed(unknown.map(String::as_str)) {
        ignored.push(format!("unknown materials became matt grey: {names}"));
    }
    let textured: Vec<MeshMaterial> = materials
        .iter()
        .map(|file| {
            let name = file.diffuse_texture.as_ref();
            let picture = name.map(|name| diffuse_texture(name, path, file_access)).transpose();
            let base_colour_texture = picture.unwrap_or_else(|error| {
                ignored.push(format!("the texture map_Kd of \"{}\" cannot be used ({})", file.name, error.what));
                None
            });
            MeshMaterial { base_colour_texture, ..material(file) }
        })
        .collect();
    let parts: Result<Vec<MeshPart>> = models
        .into_iter()
        .filter(|model| !model.mesh.indices.is_empty())
        .map(|model| {
            let material = model.mesh.material_id.and_then(|index| textured.get(index)).cloned();
            Ok(MeshPart { mesh: mesh(model.mesh)?, material, material_number: None, name: model.name })
        })
        .collect();
    Ok(PartsAndNotes { parts: parts?, ignored, has_lights: false })
}

/// Joins each line that ends with a backslash to the next line. The other lines keep their numbers.
fn joined_lines(text: &str) -> Cow<'_, str> {
    if !text.lines().any(|line| line.trim_end().ends_with('\\')) {
        return Cow::Borrowed(text);
    }
    let (mut joined, mut ends) = (String::with_capacity(text.len()), String::new());
    for line in text.lines() {
        ends.push('\n');
        match line.trim_end().strip_suffix('\\') {
            Some(begin) => joined += &format!("{begin} "),
            None => joined += &format!("{line}{}", std::mem::take(&mut ends)),
        }
    }
    Cow::Owned(joined)
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
    let file = file_access.file(obj.parent().unwrap_or(Path::new("")), Path::new(&name.replace('\\', "/")))?;
    let picture = Arc::new(PictureFile::read(&file)?);
    Ok(MeshTexture { picture, wrap: [wrap; 2], filter: Filter::Bilinear, transform })
}

fn used_materials(text: &str) -> Vec<String> {
    let names = text.lines().filter_map(|line| line.trim_start().strip_prefix("usemtl"));
    names.filter(|rest| rest.starts_with(char::is_whitespace)).map(|name| name.trim().to_string()).collect()
}

/// Describes the keys of the materials that are ignored: textures, transmission filters, and the
/// layers of the extension for physically based materials.
fn ignored_textures(materials: &[tobj::Material]) -> Vec<String> {
    let textures = materials.iter().flat_map(|material| {
        let known = [
            ("map_Ka", &material.ambient_texture),
            ("map_Ks", &material.specular_texture),
            ("map_Bump", &material.normal_texture),
            ("map_Ns", &material.shininess_texture),
            ("map_d", &material.dissolve_texture),
        ];
        let known = known.into_iter().filter(|(_, texture)| texture.is_some()).map(|(key, _)| key);
        let other = material.unknown_param.keys().map(String::as_str).filter(|key| is_texture(key));
        known.chain(other).collect::<Vec<_>>()
    });
    let is_set = |value: &str| value.split_whitespace().any(|number| number.parse::<f64>().is_ok_and(|it| it != 0.0));
    let layers = materials.iter().flat_map(|material| {
        let keys = ["Ps", "Pc", "Pcr", "aniso", "anisor"];
        keys.into_iter().filter(|key| material.unknown_param.get(*key).is_some_and(|value| is_set(value)))
    });
    let filters = materials.iter().any(|material| {
        let filter = material.unknown_param.get("Tf").map(String::as_str).unwrap_or_default();
        filter.split_whitespace().any(|number| number.parse::<f64>().is_ok_and(|it| it < 1.0))
    });
    let layers: Vec<&str> = layers.chain(filters.then_some("Tf")).collect();
    let mut textures: Vec<&str> = textures.collect();
    textures.sort_unstable();
    let textures = listed(textures).map(|keys| format!("textures are ignored: {keys}"));
    textures.into_iter().chain(listed(layers).map(|keys| format!("material keys are ignored: {keys}"))).collect()
}

fn is_texture(key: &str) -> bool {
    let key = key.to_ascii_lowercase();
    key.starts_with("map_") || ["bump", "norm", "disp", "decal", "refl"].contains(&key.as_str())
}

fn mesh(mesh: tobj::Mesh) -> Result<TriangleMesh> {
    let count = mesh.positions.len() / 3;
    let triples = |values: &[f64]| values.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>();
    // If only some faces have normals, the whole mesh has no normals.
    let normals = (mesh.normals.len() == 3 * count).then(|| triples(&mesh.normals));
    // In OBJ files, v increases upwards.
    let uvs = (mesh.texcoords.len() == 2 * count)
        .then(|| mesh.texcoords.chunks_exact(2).map(|uv| [uv[0], 1.0 - uv[1]]).collect::<Vec<_>>());
    let triangles = mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    TriangleMesh::new(triples(&mesh.positions), normals, uvs, triangles)
}

/// Checks that faces refer to vertices before them. Errors name the line of the face.
fn check_faces(text: &str) -> Result<()> {
    // The numbers of v, vt and vn lines so far, in the order of the indices of a corner.
    let mut counts = [0_i64; 3];
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => counts[0] += 1,
            Some("vt") => counts[1] += 1,
            Some("vn") => counts[2] += 1,
            Some("f") => {
                let mut corners = 0;
                for corner in words {
                    corners += 1;
                    check_corner(corner, counts).map_err(|error| error.at(number + 1, 1))?;
                }
                if corners < 3 {
                    let error = Error::input(format!("a face has {corners} corners")).expected("at least three");
                    return Err(error.at(number + 1, 1));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

fn check_corner(corner: &str, counts: [i64; 3]) -> Result<()> {
    let wrong = || {
        Error::input(format!("a face has the corner \"{corner}\"")).expected(format!(
            "indices of {} positions, {} texture coordinates, {} normals",
            counts[0], counts[1], counts[2]
        ))
    };
    let mut parts = corner.split('/');
    for (place, count) in counts.into_iter().enumerate() {
        match parts.next() {
            None | Some("") if place > 0 => {}
            None => return Err(wrong()),
            Some(part) => {
                let index: i64 = part.parse().map_err(|_| wrong())?;
                if !(1..=count).contains(&index) && !(-count..=-1).contains(&index) {
                    return Err(wrong());
                }
            }
        }
    }
    if parts.next().is_some() { Err(wrong()) } else { Ok(()) }
}

/// Converts an MTL material.
///
/// `Kd` is the base colour, `Ni` the index of refraction and `d` the opacity. `Tr` is 1 − `d`. If
/// the file states neither `d` nor `Tr`, a material with the illumination model 4, 6, 7 or 9
/// becomes glass. The Phong exponent `Ns` corresponds to the microfacet parameter α = √(2/(Ns + 2))
/// (Walter et al. 2007). The extension key `Pm` states the metalness directly, and `Pr` states the
/// roughness. An opaque material with a black `Kd` and a specular colour `Ks` is a metal of this
/// colour, as in files with mirrors.
fn material(file: &tobj::Material) -> MeshMaterial {
    let extension = |name: &str| file.unknown_param.get(name).and_then(|value| value.trim().parse::<f64>().ok());
    let glass = matches!(file.illumination_model, Some(4 | 6 | 7 | 9));
    let opacity = file.dissolve.or_else(|| extension("Tr").map(|tr| 1.0 - tr));
    let transmission = opacity.map_or(if glass { 1.0 } else { 0.0 }, |opacity| 1.0 - opacity).clamp(0.0, 1.0);
    let shines = file.specular.is_some_and(|colour| colour.iter().any(|&c| c > 0.0));
    let shininess = file.shininess.filter(|_| shines || transmission > 0.0);
    let of_shininess = shininess.map(|ns| (2.0 / (ns.max(0.0) + 2.0)).sqrt().sqrt());
    let roughness = extension("Pr").or(of_shininess).unwrap_or(if transmission > 0.0 { 0.0 } else { 1.0 });
    let is_black = file.diffuse.is_some_and(|colour| colour == [0.0; 3]) && file.diffuse_texture.is_none();
    let emits = file.emissive.is_some_and(|colour| colour != [0.0; 3]);
    let metal = file.specular.filter(|_| is_black && shines && transmission < 0.5 && !emits);
    let colour = metal.map(|colour| colour.map(|component| component.min(1.0))).or(file.diffuse);
    MeshMaterial {
        name: file.name.clone(),
        base_colour: colour.unwrap_or(MeshMaterial::default().base_colour),
        metallic: extension("Pm").unwrap_or(if metal.is_some() { 1.0 } else { 0.0 }).clamp(0.0, 1.0),
        roughness: roughness.clamp(0.0, 1.0),
        // A surface of an OBJ file is either glass or opaque.
        transmission: if transmission >= 0.5 { 1.0 } else { 0.0 },
        ior: file.optical_density.filter(|&ni| ni >= 1.0).unwrap_or(MeshMaterial::default().ior),
        emission: file.emissive.unwrap_or([0.0; 3]),
        ..MeshMaterial::default()
    }
}
