//! Opens glTF files, and checks what the crate `gltf` does not check.

use super::super::packed::read;
use super::address::{decoded_address, decoded_data};
use super::extensions;
use crate::FileAccess;
use ::gltf::buffer::{Buffer, Source};
use ::gltf::json::Root;
use ::gltf::{Document, Glb};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::text::bytes_without_byte_order_mark;
use serde_json::Value;
use std::borrow::Cow;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A glTF file whose geometry and pictures are not read yet.
pub struct GltfFile {
    pub document: Document,
    /// True if the file animates other properties than those of nodes (KHR_animation_pointer).
    pub has_property_animations: bool,
    blob: Option<Vec<u8>>,
    pub(super) folder: PathBuf,
    pub(super) file_access: FileAccess,
}

impl GltfFile {
    /// Reads a glTF file, and checks the addresses of its buffers.
    pub fn open(path: &Path, file_access: FileAccess) -> Result<Self> {
        let (mut value, blob) = parse(&read(path)?)?;
        let has_property_animations = add_optional_keys(&mut value);
        let mut root = root_of(value)?;
        check_extensions(&mut root)?;
        check_attributes(&root)?;
        let document = Document::from_json(root).map_err(|error| invalid(&error))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let file = Self { document, has_property_animations, blob, folder, file_access };
        for buffer in file.document.buffers() {
            match buffer.source() {
                Source::Uri(uri) if !uri.starts_with("data:") => drop(file.buffer_path(uri)?),
                Source::Uri(_) | Source::Bin => {}
            }
        }
        Ok(file)
    }

    /// Reads the buffers. This function is called once, because it moves the data of a binary file.
    pub fn buffers(&mut self) -> Result<Vec<Vec<u8>>> {
        let mut blob = self.blob.take();
        let mut read = |buffer: Buffer<'_>| {
            let (number, expected) = (buffer.index(), buffer.length());
            let data = match buffer.source() {
                Source::Uri(uri) => self.read_uri(uri)?,
                Source::Bin => blob.take().ok_or_else(|| malformed("the binary chunk is missing"))?,
            };
            if data.len() < expected {
                let what = format!("buffer {number} of the glTF file is truncated: {} of {expected} bytes", data.len());
                return Err(Error::input(what));
            }
            Ok(data)
        };
        self.document.buffers().map(&mut read).collect()
    }

    fn read_uri(&self, uri: &str) -> Result<Vec<u8>> {
        if let Some(data) = decoded_data(uri) {
            return data.ok_or_else(|| invalid_address(uri));
        }
        let path = self.buffer_path(uri)?;
        let name = decoded_address(uri).unwrap_or_default();
        std::fs::read(path).map_err(|cause| {
            Error::input(format!("the data file \"{name}\" cannot be read: {cause}"))
                .expected("the file that the glTF file names, in the same place as in the export")
        })
    }

    /// Returns the path of a buffer, which the file access must allow.
    fn buffer_path(&self, uri: &str) -> Result<PathBuf> {
        let decoded = decoded_address(uri).ok_or_else(|| invalid_address(uri))?;
        let path = decoded.strip_prefix("file://").or(decoded.strip_prefix("file:")).unwrap_or(&decoded);
        self.file_access.file(&self.folder, Path::new(path)).map(PathBuf::from)
    }
}

/// Returns the error of a buffer's address, which may hold megabytes of data.
fn invalid_address(uri: &str) -> Error {
    let start: String = uri.chars().take(60).collect();
    let dots = if start.len() < uri.len() { "…" } else { "" };
    Error::input(format!("the glTF buffer's address \"{start}{dots}\" is not valid"))
}

/// The extensions (not of materials) that Abbe reads and that the crate `gltf` does not know.
const OWN_EXTENSIONS: [&str; 3] = ["EXT_lights_ies", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization"];

/// The extensions that pack geometry. Abbe does not read them.
const PACKED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// Parses a glTF file. Returns the JSON text, and the binary chunk of a `.glb` file.
fn parse(bytes: &[u8]) -> Result<(Value, Option<Vec<u8>>)> {
    if !bytes.starts_with(b"glTF") {
        return Ok((serde_json::from_slice(bytes_without_byte_order_mark(bytes)).map_err(malformed)?, None));
    }
    check_length(bytes)?;
    let file = Glb::from_slice(bytes).map_err(|error| invalid(&error))?;
    Ok((serde_json::from_slice(&file.json).map_err(malformed)?, file.bin.map(Cow::into_owned)))
}

/// Converts the JSON values to the types of the crate `gltf`. The crate `gltf` contains the
/// compiled deserialiser of a text, whereas a deserialiser of values would take seconds to compile.
fn root_of(value: Value) -> Result<Root> {
    let text = value.to_string();
    drop(value);
    Root::from_str(&text).map_err(|error| {
        // The position is one in the text above.
        let position = format!(" at line {} column {}", error.line(), error.column());
        malformed(error.to_string().trim_end_matches(&position))
    })
}

fn malformed(error: impl Display) -> Error {
    Error::input(format!("not a valid glTF file: {error}"))
}

/// Adds keys that are optional in glTF, and that the crate `gltf` requires. Removes the channels of
/// animations that move no node. Returns true if there are such channels.
fn add_optional_keys(value: &mut Value) -> bool {
    let scenes = value.get_mut("scenes").and_then(Value::as_array_mut);
    for scene in scenes.into_iter().flatten().filter_map(Value::as_object_mut) {
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    let animations = value.get_mut("animations").and_then(Value::as_array_mut);
    let mut removed = false;
    for animation in animations.into_iter().flatten() {
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else { continue };
        let all = channels.len();
        channels.retain(|channel| channel.get("target").is_none_or(|target| target.get("node").is_some()));
        removed |= channels.len() < all;
    }
    complete_images(value);
    removed
}

/// The extensions that name the picture of a texture in another format.
const PICTURE_EXTENSIONS: [&str; 4] =
    ["EXT_texture_webp", "EXT_texture_avif", "KHR_texture_basisu", "MSFT_texture_dds"];

/// Completes images and textures, because the crate `gltf` panics where a key is missing. The first
/// bytes of a picture state its kind, so any kind can stand in the key `mimeType`. A texture
/// without a picture that the extensions name gets an image without an address, which is reported
/// where a material uses it.
fn complete_images(value: &mut Value) {
    let mut count = 0;
    for image in value.get_mut("images").and_then(Value::as_array_mut).into_iter().flatten() {
        count += 1;
        let Some(image) = image.as_object_mut() else { continue };
        // The crate reads `null` like a missing key.
        image.retain(|_, value| !value.is_null());
        if image.contains_key("bufferView") {
            image.entry("mimeType").or_insert_with(|| "image/png".into());
        } else {
            image.entry("uri").or_insert_with(|| "".into());
        }
    }
    let mut lacks_image = false;
    for texture in value.get_mut("textures").and_then(Value::as_array_mut).into_iter().flatten() {
        let extensions = texture.get("extensions");
        let by_extension = PICTURE_EXTENSIONS.iter().find_map(|name| extensions?.get(name)?.get("source")?.as_u64());
        let Some(texture) = texture.as_object_mut() else { continue };
        texture.retain(|_, value| !value.is_null());
        if !texture.contains_key("source") {
            let source = by_extension.filter(|source| *source < count);
            lacks_image |= source.is_none();
            texture.insert("source".to_owned(), source.unwrap_or(count).into());
        }
    }
    if lacks_image && let Some(file) = value.as_object_mut() {
        let images = file.entry("images").or_insert_with(|| Value::Array(Vec::new()));
        images.as_array_mut().into_iter().for_each(|images| images.push(serde_json::json!({"uri": ""})));
    }
}

/// Checks the extensions that a file requires. The crate `gltf` refuses a file that requires an
/// extension unknown to the crate, so the known ones are removed from the list.
fn check_extensions(root: &mut Root) -> Result<()> {
    let packed = |name: &&String| PACKED.contains(&name.as_str());
    let is_packed = |primitive: &::gltf::json::mesh::Primitive| {
        let names = primitive.extensions.iter().flat_map(|extensions| extensions.others.keys());
        names.into_iter().any(|name| PACKED.contains(&name.as_str()))
    };
    let by_primitive = root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(is_packed);
    let name = root.extensions_required.iter().find(packed).map(String::as_str);
    if let Some(name) = name.or(by_primitive.then_some(PACKED[0])) {
        return Err(Error::input(format!("the geometry is compressed by {name}"))
            .expected("a file without compression of meshes; switch it off in the export"));
    }
    let is_known = |name: &str| OWN_EXTENSIONS.contains(&name) || PICTURE_EXTENSIONS.contains(&name);
    root.extensions_required.retain(|name| !is_known(name) && !extensions::is_accepted(name));
    Ok(())
}

/// Checks the length of a binary file. A wrong one would underflow in the crate `gltf`.
fn check_length(bytes: &[u8]) -> Result<()> {
    let explicit = bytes.get(8..12).and_then(|length| length.try_into().ok()).map(u32::from_le_bytes);
    match explicit {
        Some(explicit) if explicit as usize > bytes.len() => Err(Error::input("the glTF file is truncated")),
        Some(explicit) if explicit >= 20 => Ok(()),
        Some(_) | None => Err(Error::input("not a valid glTF file: its header is incomplete")),
    }
}

/// Checks that attributes refer to existing accessors. Others would panic in the crate `gltf`.
fn check_attributes(root: &::gltf::json::Root) -> Result<()> {
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let largest = primitives.flat_map(|primitive| primitive.attributes.values()).map(|index| index.value()).max();
    if largest.is_some_and(|index| index >= root.accessors.len()) {
        return Err(Error::input("not a valid glTF file: an attribute names an accessor that does not exist"));
    }
    Ok(())
}

fn invalid(error: &::gltf::Error) -> Error {
    Error::input(format!("not a valid glTF file: {error}"))
}
