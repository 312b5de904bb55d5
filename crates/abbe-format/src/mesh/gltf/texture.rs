//! Pictures of glTF files: buffer views, data addresses and files.

use super::super::material::MeshTexture;
use super::address::{decoded_address, decoded_data};
use crate::{FileAccess, PictureFile};
use ::gltf::image::Source;
use ::gltf::material::NormalTexture;
use ::gltf::texture::{Info, MagFilter, WrappingMode};
use ::gltf::{Document, Image, Texture};
use abbe_optics::texture::{Filter, UvTransform, Wrap};
use abbe_spectra::error::{Error, Result};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads the pictures of a glTF file, each once.
pub(super) struct GltfPictures<'b> {
    document: &'b Document,
    buffers: &'b [Vec<u8>],
    folder: PathBuf,
    file_access: FileAccess,
    /// The pictures by their index in the file.
    known: Vec<Option<Arc<PictureFile>>>,
    /// Sentences about the pictures that cannot be used.
    pub(super) unusable: Vec<String>,
}

impl<'b> GltfPictures<'b> {
    pub(super) fn new(document: &'b Document, buffers: &'b [Vec<u8>], folder: &Path, file_access: FileAccess) -> Self {
        let known = vec![None; document.images().len()];
        Self { document, buffers, folder: folder.to_owned(), file_access, known, unusable: Vec::new() }
    }

    /// Reads a texture over the set of texture coordinates `set`. Returns `None` if the picture
    /// cannot be used, or if the texture uses another set.
    pub(super) fn texture(&mut self, info: &Info, set: u32) -> Option<MeshTexture> {
        let transform = info.texture_transform().map_or(UvTransform::IDENTITY, |it| {
            let pair = |pair: [f32; 2]| pair.map(f64::from);
            UvTransform::new(pair(it.scale()), f64::from(it.rotation()), pair(it.offset()))
        });
        if uv_set_of(info) == set { self.placed(&info.texture(), transform) } else { None }
    }

    /// Reads a normal map over the set of texture coordinates `set`. Returns `None` if the picture
    /// cannot be used, or if the map uses another set.
    pub(super) fn normal_map(&mut self, file: &NormalTexture, set: u32) -> Option<MeshTexture> {
        let transform = explicit_transform(file.extension_value("KHR_texture_transform"));
        if normal_uv_set_of(file) == set { self.placed(&file.texture(), transform) } else { None }
    }

    /// Reads the texture that the JSON of an extension states. Returns `None` if there is none over
    /// the set of texture coordinates `set`, or if the picture cannot be used.
    pub(super) fn explicit(&mut self, info: &Value, set: u32) -> Option<MeshTexture> {
        let transform = info.get("extensions").and_then(|it| it.get("KHR_texture_transform"));
        let number = |value: Option<&Value>| value.and_then(Value::as_u64);
        let used = number(transform.and_then(|it| it.get("texCoord"))).or(number(info.get("texCoord"))).unwrap_or(0);
        let texture = self.document.textures().nth(usize::try_from(number(info.get("index"))?).ok()?)?;
        if used == u64::from(set) { self.placed(&texture, explicit_transform(transform)) } else { None }
    }

    fn placed(&mut self, texture: &Texture, transform: UvTransform) -> Option<MeshTexture> {
        let sampler = texture.sampler();
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(|mode| match mode {
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::Repeat => Wrap::Repeat,
        });
        let is_nearest = sampler.mag_filter() == Some(MagFilter::Nearest);
        let filter = if is_nearest { Filter::Nearest } else { Filter::Bilinear };
        let image = texture.source();
        let picture = match &self.known[image.index()] {
            Some(known) => known.clone(),
            None => match self.read(image.source()) {
                Ok(read) => self.known[image.index()].insert(Arc::new(read)).clone(),
                Err(error) => {
                    let sentence = format!("the image {} cannot be used ({})", named(&image), reason(&error));
                    if !self.unusable.contains(&sentence) {
                        self.unusable.push(sentence);
                    }
                    return None;
                }
            },
        };
        Some(MeshTexture { picture, wrap, filter, transform })
    }

    fn read(&self, source: Source<'_>) -> Result<PictureFile> {
        match source {
            Source::View { view, mime_type: _ } => {
                let buffer = self.buffers.get(view.buffer().index());
                let end = view.offset().checked_add(view.length());
                let bytes = buffer.zip(end).and_then(|(buffer, end)| buffer.get(view.offset()..end));
                PictureFile::decode(bytes.ok_or_else(|| Error::input("it reaches beyond its buffer"))?)
            }
            Source::Uri { uri, mime_type: _ } => match decoded_data(uri) {
                Some(data) => PictureFile::decode(&data.ok_or_else(|| Error::input("its data address is not valid"))?),
                None if uri.is_empty() => Err(Error::input("it has neither an address nor data")),
                None => {
                    let decoded = decoded_address(uri).ok_or_else(|| Error::input("its address is not valid"))?;
                    PictureFile::read(&self.file_access.file(&self.folder, Path::new(&decoded))?)
                }
            },
        }
    }
}

/// Returns the number of an image, and the name of its file or its own name.
fn named(image: &Image) -> String {
    let file = match image.source() {
        Source::Uri { uri, .. } if !uri.is_empty() && decoded_data(uri).is_none() => decoded_address(uri),
        Source::Uri { .. } | Source::View { .. } => None,
    };
    let name = file.as_deref().or(image.name()).filter(|name| !name.is_empty());
    name.map_or_else(|| image.index().to_string(), |name| format!("{}, \"{name}\",", image.index()))
}

/// Returns the fault of a picture, and what was expected.
fn reason(error: &Error) -> String {
    let what = error.what.as_str();
    error.expected.as_ref().map_or_else(|| what.to_owned(), |expected| format!("{what}; expected {expected}"))
}

/// Returns the map of texture coordinates in the JSON of KHR_texture_transform.
fn explicit_transform(explicit: Option<&Value>) -> UvTransform {
    let number = |value: Option<&Value>, default: f64| value.and_then(Value::as_f64).unwrap_or(default);
    explicit.map_or(UvTransform::IDENTITY, |it| {
        let pair = |key: &str, default: f64| [0, 1].map(|i| number(it.get(key).and_then(|pair| pair.get(i)), default));
        UvTransform::new(pair("scale", 1.0), number(it.get("rotation"), 0.0), pair("offset", 0.0))
    })
}

/// Returns the number of the set of texture coordinates that a texture uses.
pub(super) fn uv_set_of(info: &Info) -> u32 {
    info.texture_transform().and_then(|transform| transform.tex_coord()).unwrap_or(info.tex_coord())
}

/// Returns the number of the set of texture coordinates that a normal map uses.
pub(super) fn normal_uv_set_of(file: &NormalTexture) -> u32 {
    let explicit = file.extension_value("KHR_texture_transform").and_then(|it| it.get("texCoord"));
    explicit.and_then(Value::as_u64).and_then(|set| u32::try_from(set).ok()).unwrap_or(file.tex_coord())
}
