//! The layers of a film: quantities by pixel that are recorded on request.
//!
//! The light of path classes and of light groups is X, Y and Z, like the picture. Those of first
//! surfaces are sums over camera samples. All sums are exact, so the order of the passes does not
//! matter.

use super::cryptomatte::{NameCounts, hash_name, normal_hash};
use super::denoising;
use super::first_surface::FirstSurface;
use abbe_spectra::math::random::REPLICATES;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayerSet {
    /// The quantities of first surfaces that the film records.
    pub surfaces: Vec<SurfaceLayer>,
    /// The names of the objects in the order of their numbers, if the film records objects.
    pub objects: Option<Vec<String>>,
    /// The names of the materials in the order of their numbers, if the film records materials.
    pub materials: Option<Vec<String>>,
    /// In the order of their numbers. Empty if the film does not separate path classes.
    pub paths: Vec<String>,
    /// The names of the light groups. Empty if the film does not separate lights.
    pub light_groups: Vec<String>,
    /// For each light, the number of its group. Empty if the film does not separate lights.
    pub group_of_light: Vec<u16>,
    /// True if the film has the sums for a denoiser.
    #[serde(default)]
    pub denoising: bool,
    /// True if the film records the polarisation of the light.
    #[serde(default)]
    pub stokes: bool,
}

/// A quantity of the first surfaces on camera rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceLayer {
    /// The fraction of light that the surface reflects or transmits.
    Albedo,
    Normal,
    Depth,
    Uv,
    /// The number of camera samples, also of those that hit no surface.
    Samples,
}

pub(super) const COMPONENTS: usize = 3;

impl LayerSet {
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns true if the film records first surfaces or the number of samples.
    pub fn has_surfaces(&self) -> bool {
        !self.surfaces.is_empty() || self.objects.is_some() || self.materials.is_some()
    }

    fn has(&self, layer: SurfaceLayer) -> bool {
        self.surfaces.contains(&layer)
    }

    pub fn separates_light(&self) -> bool {
        !(self.paths.is_empty() && self.light_groups.is_empty())
    }

    /// Returns the names of the layers, for messages.
    pub fn words(&self) -> String {
        let flags = [
            (self.has(SurfaceLayer::Albedo), "albedo"),
            (self.has(SurfaceLayer::Normal), "normal"),
            (self.has(SurfaceLayer::Depth), "depth"),
            (self.objects.is_some(), "object"),
            (self.materials.is_some(), "material"),
            (self.has(SurfaceLayer::Uv), "uv"),
            (self.has(SurfaceLayer::Samples), "samples"),
            (!self.paths.is_empty(), "paths"),
            (!self.light_groups.is_empty(), "lights"),
            (self.stokes, "stokes"),
            (self.denoising, "denoised"),
        ];
        let words: Vec<&str> = flags.into_iter().filter(|(on, _)| *on).map(|(_, word)| word).collect();
        if words.is_empty() { "no layers".to_string() } else { format!("the layers {}", words.join(", ")) }
    }

    /// Returns the planes of sums in any case. Lists of names may need more.
    pub fn planes(&self) -> usize {
        self.light_channels() + self.surface_channels().len() + if self.denoising { denoising::PLANES } else { 0 }
    }

    /// Returns the number of channels for the light of path classes and light groups, and for its
    /// polarisation.
    pub(super) fn light_channels(&self) -> usize {
        self.stokes_channel() + if self.stokes { COMPONENTS * REPLICATES } else { 0 }
    }

    /// Returns the first channel of the polarisation: S1, S2 and S3 of Y in each replicate.
    pub(super) fn stokes_channel(&self) -> usize {
        COMPONENTS * (self.paths.len() + self.light_groups.len())
    }

    /// Returns the first channel of a path class, if the film separates path classes.
    pub(super) fn channel_of_class(&self, class: usize) -> Option<usize> {
        (class < self.paths.len()).then_some(COMPONENTS * class)
    }

    /// Returns the first channel of a light's group, if the film separates lights.
    pub(super) fn channel_of_light(&self, light: usize) -> Option<usize> {
        let group = self.group_of_light.get(light)?;
        Some(COMPONENTS * (self.paths.len() + usize::from(*group)))
    }

    /// Returns the names of the sums over first surfaces, in the order of [`Self::add_surface`].
    pub(super) fn surface_channels(&self) -> Vec<&'static str> {
        if !self.has_surfaces() {
            return Vec::new();
        }
        let mut names = vec!["samples", "hits"];
        let mut extend = |on: bool, more: &[&'static str]| names.extend_from_slice(if on { more } else { &[] });
        extend(self.has(SurfaceLayer::Albedo), &["albedoR", "albedoG", "albedoB"]);
        extend(self.has(SurfaceLayer::Normal), &["normalX", "normalY", "normalZ"]);
        extend(self.has(SurfaceLayer::Depth), &["depth"]);
        extend(self.has(SurfaceLayer::Uv), &["u", "v"]);
        names
    }

    /// `surface` is `None` if the camera ray hits nothing.
    pub(super) fn add_surface(&self, sums: &mut [f64], surface: Option<&FirstSurface>) {
        let mut slots = sums.iter_mut();
        let mut add = |values: &[f64]| values.iter().zip(&mut slots).for_each(|(value, slot)| *slot += value);
        let Some(surface) = surface else { return add(&[1.0]) };
        add(&[1.0, 1.0]);
        if self.has(SurfaceLayer::Albedo) {
            add(&surface.albedo_rgb());
        }
        if self.has(SurfaceLayer::Normal) {
            add(&surface.normal);
        }
        if self.has(SurfaceLayer::Depth) {
            add(&[surface.depth_m]);
        }
        if self.has(SurfaceLayer::Uv) {
            add(&surface.uv);
        }
    }

    /// Returns the tables of names, in a fixed order: objects, then materials.
    pub(super) fn name_tables(&self) -> impl Iterator<Item = (NameKind, &Vec<String>)> {
        let objects = self.objects.iter().map(|names| (NameKind::Object, names));
        objects.chain(self.materials.iter().map(|names| (NameKind::Material, names)))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NameKind {
    Object,
    Material,
}

impl NameKind {
    pub fn layer_name(self) -> &'static str {
        match self {
            Self::Object => "CryptoObject",
            Self::Material => "CryptoMaterial",
        }
    }

    /// Returns the name of the plane with the entries at a place of the pixels' lists.
    pub fn plane_name(self, place: usize) -> String {
        match self {
            Self::Object => format!("object{place}"),
            Self::Material => format!("material{place}"),
        }
    }
}

/// The names of one kind that camera samples hit, by pixel.
#[derive(Debug)]
pub(super) struct NameLayer {
    pub(super) kind: NameKind,
    names: Vec<String>,
    hashes: Vec<u32>,
    pub(super) pixels: Vec<NameCounts>,
}

impl NameLayer {
    /// The expected memory of one pixel: its list, which usually has room for four entries.
    pub(super) const BYTES_PER_PIXEL: usize = size_of::<NameCounts>() + 4 * size_of::<(u32, u32)>();

    pub(super) fn new(kind: NameKind, names: &[String], pixels: usize) -> Self {
        let hashes = names.iter().map(|name| normal_hash(hash_name(name))).collect();
        Self { kind, names: names.to_vec(), hashes, pixels: vec![NameCounts::default(); pixels] }
    }

    /// Returns the largest number of names in a pixel.
    pub(super) fn ranks(&self) -> usize {
        self.pixels.iter().map(NameCounts::len).max().unwrap_or(0)
    }

    pub(super) fn rows(&mut self, width: usize) -> impl Iterator<Item = NameRow<'_>> {
        let Self { kind, hashes, pixels, .. } = self;
        pixels.chunks_mut(width).map(|pixels| NameRow { kind: *kind, hashes, pixels })
    }
}

#[derive(Debug)]
pub(super) struct NameRow<'f> {
    pub(super) kind: NameKind,
    pub(super) hashes: &'f [u32],
    pub(super) pixels: &'f mut [NameCounts],
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct PictureLayers {
    pub channels: Vec<LayerChannel>,
    pub mattes: Vec<MatteNames>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct LayerChannel {
    pub name: String,
    pub values: Vec<f32>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MatteNames {
    pub layer: String,
    /// The names of the objects or materials, with their hashes.
    pub names: Vec<(String, u32)>,
}

/// The largest number of names that a Cryptomatte layer shows in a pixel.
const MOST_RANKS: usize = 16;

impl PictureLayers {
    /// Adds the red, green and blue channel of a layer.
    pub(super) fn add_colours(&mut self, layer: &str, rgb: &[[f64; 3]]) {
        for (c, colour) in ["R", "G", "B"].into_iter().enumerate() {
            self.add(format!("{layer}.{colour}"), rgb.iter().map(|rgb| rgb[c] as f32));
        }
    }

    pub(super) fn add(&mut self, name: String, values: impl Iterator<Item = f32>) {
        self.channels.push(LayerChannel { name, values: values.collect() });
    }

    /// `sums` returns the sum of a channel of [`LayerSet::surface_channels`] at a pixel.
    pub(super) fn add_surfaces(&mut self, set: &LayerSet, pixels: usize, sums: impl Fn(usize, usize) -> f64) {
        let mean = |channel: usize, by: usize, without: f64| {
            let sums = &sums;
            (0..pixels).map(move |pixel| {
                let count = sums(pixel, by);
                (if count > 0.0 { sums(pixel, channel) / count } else { without }) as f32
            })
        };
        const SAMPLES: usize = 0;
        const HITS: usize = 1;
        for (channel, name) in set.surface_channels().into_iter().enumerate() {
            match name {
                "samples" if set.has(SurfaceLayer::Samples) => {
                    self.add(name.to_string(), (0..pixels).map(|p| sums(p, SAMPLES) as f32))
                }
                "samples" | "hits" => {}
                "depth" => self.add("depth.Z".to_string(), mean(channel, HITS, f64::INFINITY)),
                "u" => self.add("uv.U".to_string(), mean(channel, HITS, 0.0)),
                "v" => self.add("uv.V".to_string(), mean(channel, HITS, 0.0)),
                _ => {
                    let (layer, component) = name.split_at(name.len() - 1);
                    self.add(format!("{layer}.{component}"), mean(channel, SAMPLES, 0.0));
                }
            }
        }
    }

    /// Adds identity and coverage, the largest first. `samples` is that of a pixel.
    pub(super) fn add_names(&mut self, layer: &NameLayer, samples: impl Fn(usize) -> f64) {
        let levels = layer.ranks().clamp(1, MOST_RANKS).div_ceil(2);
        let name = layer.kind.layer_name();
        let ranked: Vec<Vec<(u32, u32)>> = layer.pixels.iter().map(NameCounts::ranked).collect();
        for rank in 0..2 * levels {
            let [identity, coverage] = if rank % 2 == 0 { ["R", "G"] } else { ["B", "A"] };
            let channel = |component: &str| format!("{name}{:02}.{component}", rank / 2);
            let entry = |pixel: usize| ranked[pixel].get(rank).copied().unwrap_or_default();
            let pixels = 0..ranked.len();
            self.add(channel(identity), pixels.clone().map(|pixel| f32::from_bits(entry(pixel).0)));
            self.add(
                channel(coverage),
                pixels.map(|pixel| (f64::from(entry(pixel).1) / samples(pixel).max(1.0)) as f32),
            );
        }
        let mut names: Vec<(String, u32)> = layer.names.iter().cloned().zip(layer.hashes.iter().copied()).collect();
        names.sort_unstable();
        names.dedup();
        self.mattes.push(MatteNames { layer: name.to_string(), names });
    }
}
