//! The scene model of the renderer Abbe: shapes, lights, materials, media and a camera, in metres
//! and watts.
//!
//! The model is independent of files: [`builder::SceneBuilder`] builds and checks a [`Scene`] from
//! its parts, and the crate `abbe-format` translates a scene file into these parts. Once a scene is
//! built, errors in the scene cannot make rendering fail.
//!
//! ```
//! use abbe_scene::geometry::shape::{PlacedShape, Shape};
//! use abbe_scene::geometry::{Geometry, Ray};
//! use glam::{DAffine3, DVec3};
//!
//! let ball = PlacedShape { shape: Shape::Sphere { radius: 0.5 }, to_world: DAffine3::IDENTITY, object: 0 };
//! let geometry = Geometry::build(vec![ball], DVec3::ZERO)?;
//! let ray = Ray::new(DVec3::new(0.0, 0.0, 2.0), DVec3::NEG_Z);
//! let hit = geometry.intersect(&ray, None, f64::INFINITY).expect("the ray meets the ball");
//! assert_eq!(hit.t, 1.5);
//! # Ok::<(), abbe_spectra::Error>(())
//! ```
//!
//! The docs of [`builder`] show a whole scene, and `examples/intersect_a_ray.rs` follows a ray.
//!
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`builder`] | builds a scene from its parts, and checks it |
//! | [`geometry`] | shapes, meshes, the bounding volume hierarchy, ray intersection |
//! | [`camera`] | lenses, apertures, the shutter |
//! | [`light`] | point, area, beam, sky and volume lights, and their sampling |
//! | [`medium`] | scattering and glowing media, homogeneous and heterogeneous |
//! | [`medium_stack`] | the bodies that overlap at a point, by priority |
//! | [`meter`] | receivers of irradiance and other quantities |
//! | [`motion`], [`sweep`] | moving shapes, and the volumes that they sweep |
//! | [`facts`] | the properties of a scene on which the plan of a render depends |
//! | [`view`] | whether the camera sees an object |
//!
//! # Units and conventions
//!
//! Lengths are in m, wavelengths in nm and power in W. Power covers the band 360–830 nm. Positions
//! are relative to the centre of the scene. Geometry is computed in `f64`, and no intersection test
//! uses a fixed epsilon. Stored directions point in the direction in which light travels.
//!
//! # Dependencies
//!
//! [`abbe_spectra`] supplies spectra, and [`abbe_optics`] the scattering functions of materials.

mod animation;
mod body_ranks;
pub mod builder;
pub mod camera;
mod copies;
mod crystals;
mod emitting_media;
mod enclosure;
pub mod facts;
pub mod geometry;
mod initial_stack;
mod layer;
pub mod light;
pub mod medium;
pub mod medium_stack;
pub mod meter;
pub mod motion;
mod sensor_point;
pub mod sweep;
mod touching;
pub mod view;

use crate::geometry::{Geometry, Hit, Ray};
use abbe_optics::bsdf::Bsdf;
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::texture::NormalMap;
use abbe_spectra::colour::gamut::GamutMapping;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::colour::{RgbSpace, Transfer, Xyz};
use abbe_spectra::spectrum::{BAND_NM, Observer, Spectrum, ULTRAVIOLET_FROM_NM};
use camera::{Camera, Shutter};
use glam::{DAffine3, DVec3};
use light::{Light, SceneExtent};
use medium::{Density, Medium};
use medium_stack::{BodyPriority, MediumStack};
use meter::Meter;
use motion::SceneMotion;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

pub use layer::Layer;

/// A scene at the moment when the shutter opens. All positions are relative to `centre`.
#[derive(Debug, Clone)]
pub struct Scene {
    pub title: String,
    /// The origin of all positions, in world coordinates, in m.
    pub centre: DVec3,
    /// The radius in m of a sphere around the origin and all surfaces at all times, but not
    /// necessarily local lights and the camera.
    pub radius_m: f64,
    pub camera: Camera,
    pub shutter: Shutter,
    pub motions: SceneMotion,
    pub film: FilmSpec,
    /// Meters do not appear in a picture; see [`meter`].
    pub meters: Vec<Meter>,
    /// All surfaces except the boundaries.
    pub geometry: Arc<Geometry>,
    /// The faces that only bound a medium, which rays cross without an interaction.
    pub boundaries: Arc<Geometry>,
    /// Objects, materials, lights and media refer to each other by index.
    pub objects: Vec<Object>,
    /// By object, 0 without a body. Of two bodies, the one with the higher rank dominates.
    pub body_ranks: Vec<i32>,
    pub materials: Vec<Material>,
    pub media: Vec<Medium>,
    pub lights: Vec<Light>,
    /// The numbers of the lights that a ray that leaves the scene may see.
    pub distant_lights: Vec<usize>,
    /// For each medium: the number of its first volume light, if it emits light.
    pub medium_lights: Vec<Option<usize>>,
    pub settings: Settings,
    /// Remarks for the user, for example about clamped indices or open meshes.
    pub notes: Vec<String>,
    /// The notes about a loss, such as a texture whose file is missing.
    pub warnings: Vec<String>,
    pub air: RefractiveIndex,
}

/// An object: a surface with a material.
#[derive(Debug, Clone)]
pub struct Object {
    pub name: String,
    pub material: usize,
    pub light: Option<usize>,
    /// True if the body consists of shells that may overlap, so that a path can be inside it
    /// several times.
    pub overlaps_itself: bool,
}

/// A material: a surface, and the body behind it.
#[derive(Debug, Clone)]
pub struct Material {
    pub name: String,
    pub surface: Bsdf,
    /// `None` if the shading normals are those of the shape.
    pub normal_map: Option<NormalMap>,
    /// `None` for an opaque or a thin object.
    pub body: Option<Body>,
}

/// The inside of a transparent object.
#[derive(Debug, Clone)]
pub struct Body {
    /// `None` if the body only bounds a medium, and thus has the index of its surroundings.
    pub index: Option<RefractiveIndex>,
    /// In 1/m, or `None` for a clear body.
    pub absorption: Option<Spectrum>,
    pub medium: Option<usize>,
    /// Where bodies overlap, the body of the highest priority dominates.
    pub priority: i32,
}

/// The film specified by the scene.
#[derive(Debug, Clone)]
pub struct FilmSpec {
    pub width: u32,
    pub height: u32,
    pub observer: &'static Observer,
    /// The number of spectral bands in the output, if above 0.
    pub spectral_bands: u32,
    pub space: RgbSpace,
    pub transfer: Transfer,
    /// The white of the PNG as XYZ for `observer` on any scale, or `None` without white balance.
    pub white: Option<Xyz>,
    pub gamut: GamutMapping,
    pub tone: ToneCurve,
    pub exposure: Exposure,
    /// The bloom of the PNG, or `None` without bloom.
    pub bloom: Option<Bloom>,
    /// The layers that the EXR contains in addition to the colours.
    pub layers: Vec<Layer>,
    /// Whether the film records what a denoiser needs, and the PNG shows the denoised picture.
    /// `None` leaves both to the program.
    pub denoise: Option<bool>,
}

impl FilmSpec {
    /// Returns a film with the settings of a scene that states only the size and the observer.
    pub fn new(width: u32, height: u32, observer: &'static Observer) -> Self {
        Self {
            width,
            height,
            observer,
            spectral_bands: 0,
            space: RgbSpace::default(),
            transfer: Transfer::default(),
            white: None,
            gamut: GamutMapping::default(),
            tone: ToneCurve::default(),
            exposure: Exposure::Auto,
            bloom: None,
            layers: Vec::new(),
            denoise: None,
        }
    }
}

/// The light that the eye of a viewer scatters around bright parts of the PNG.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bloom {
    /// The horizontal angle that the picture fills in the field of view, in degrees.
    pub fov_degrees: f64,
    /// The age of the viewer in years: older eyes scatter more light.
    pub age: f64,
}

impl Bloom {
    /// The age in years of an eye whose age is not stated.
    pub const DEFAULT_AGE: f64 = 25.0;
}

/// The mapping from luminance to the brightness of the PNG.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Exposure {
    /// Chosen from the picture, so that the PNG is neither too dark nor overexposed.
    Auto,
    /// Multiplies the luminance by 2^ev: at ev 0, the PNG shows 1 cd/m² as white.
    Ev(f64),
    /// The luminance in cd/m² that the PNG shows as white.
    White(f64),
    /// The PNG shows 1 cd/m² as white.
    None,
}

/// The render settings of a scene. A field is `None` if the scene does not set it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    pub passes: Option<u64>,
    /// The number of photon paths per pass.
    pub photons: Option<u64>,
    /// The number of camera samples per pixel and pass.
    pub camera_samples: Option<u32>,
    /// The largest number of surface events on a path. Otherwise only Russian roulette ends paths.
    pub max_depth: Option<u32>,
    /// The number of photons within the radius of the first pass.
    pub nearest: Option<u32>,
    /// The radius of the first pass in m, which overrides `nearest`.
    pub radius_m: Option<f64>,
    pub seed: Option<u64>,
    pub threads: Option<u32>,
    /// The time in s between two checkpoints.
    pub checkpoint_seconds: Option<f64>,
    /// The cells of a light map along the longest side of a medium's box in the first pass.
    pub light_map: Option<u32>,
    /// Effects that are simulated even if no fact requires them.
    pub force: Vec<String>,
    /// Effects that are left out even if a fact requires them.
    pub forbid: Vec<String>,
}

impl Settings {
    /// Returns true if the scene forces the effect with this name.
    pub fn forces(&self, effect: &str) -> bool {
        self.force.iter().any(|name| name == effect)
    }
}

impl Material {
    /// A material whose objects only bound a medium.
    pub fn boundary(name: &str, medium: usize, priority: i32) -> Self {
        let body = Body { index: None, absorption: None, medium: Some(medium), priority };
        // Rays cross such faces without an interaction, so the surface is never evaluated.
        Self { name: name.to_owned(), surface: Bsdf::Absorber, normal_map: None, body: Some(body) }
    }

    /// Returns true if a property of the material varies over a surface.
    #[inline(always)]
    pub fn is_textured(&self) -> bool {
        self.normal_map.is_some() || self.surface.is_textured()
    }

    pub fn is_boundary(&self) -> bool {
        self.body.as_ref().is_some_and(|body| body.index.is_none())
    }
}

impl Body {
    /// What decides whether the body dominates; `rank` is from [`Scene::body_ranks`].
    pub fn body_priority(&self, rank: i32) -> BodyPriority {
        BodyPriority { priority: rank, refracts: self.index.is_some() }
    }
}

impl Scene {
    /// The XYZ values of all lights, weighted by their power.
    pub fn xyz_of_lights(&self) -> Xyz {
        let mut sum = [0.0; 3];
        for light in &self.lights {
            let power_w = light.power_w(self.extent());
            let xyz = self.film.observer.xyz(&light.spectrum);
            sum.iter_mut().zip(xyz).for_each(|(sum, value)| *sum += power_w * value);
        }
        sum
    }

    /// The fluorophores of the surfaces and of the media, in the order of their numbers.
    pub fn fluorophores(&self) -> impl Iterator<Item = &Fluorophore> {
        let surfaces = self.materials.iter().flat_map(|material| material.surface.fluorescent());
        let of_media = self.media.iter().filter_map(|medium| medium.fluorophore.as_deref());
        surfaces.map(|surface| &surface.fluorophore).chain(of_media)
    }

    /// Adds the ultraviolet of the lights, which excites fluorophores. Lights sample photons below
    /// the band in proportion to the power and the importance of the excited light. Wavelengths of
    /// little importance keep a small pdf, so the estimate is unbiased.
    pub fn add_ultraviolet(&mut self) {
        /// The smallest importance of a wavelength, as a fraction of the largest.
        const LEAST: f64 = 0.02;
        let observer = self.film.observer;
        let mut lights = std::mem::take(&mut self.lights);
        let values: Vec<_> = self.fluorophores().map(|fluorophore| fluorophore.visual_value(observer)).collect();
        let value = |nm: f64| values.iter().map(|value| value(nm)).fold(0.0, f64::max);
        let nm = (ULTRAVIOLET_FROM_NM as u32..BAND_NM.0 as u32).map(f64::from);
        let least = LEAST * nm.map(value).fold(0.0, f64::max);
        lights.iter_mut().for_each(|light| light.add_ultraviolet(&|nm| value(nm).max(least)));
        drop(values);
        self.lights = lights;
        for material in &mut self.materials {
            material.surface.for_each_fluorophore(&mut Fluorophore::add_ultraviolet);
        }
        self.media.iter_mut().for_each(Medium::add_ultraviolet);
    }

    fn number_fluorophores(&mut self) {
        let mut next = (0, 0);
        for material in &mut self.materials {
            material.surface.for_each_fluorophore(&mut |fluorophore| fluorophore.assign_numbers(&mut next));
        }
        for medium in &mut self.media {
            medium.fluorophore.iter_mut().for_each(|fluorophore| fluorophore.assign_numbers(&mut next));
        }
    }

    /// Returns true if the sensors of meters take the place of a camera with a picture.
    pub fn measures(&self) -> bool {
        !self.meters.is_empty()
    }

    /// The surfaces and the bounding sphere, which the methods of lights need.
    pub fn extent(&self) -> SceneExtent<'_> {
        SceneExtent { geometry: &self.geometry, radius_m: self.radius_m }
    }

    /// Recomputes the indices of lights after lights were added or removed.
    pub fn renumber_lights(&mut self) {
        self.objects.iter_mut().for_each(|object| object.light = None);
        self.distant_lights.clear();
        self.medium_lights = vec![None; self.media.len()];
        for (number, light) in self.lights.iter().enumerate() {
            if let Some(object) = light.object() {
                self.objects[object as usize].light = Some(number);
            }
            if light.is_distant() {
                self.distant_lights.push(number);
            }
            if let Some(name) = light.medium_name() {
                let medium = self.media.iter().position(|medium| medium.name == name);
                medium.into_iter().for_each(|medium| {
                    self.medium_lights[medium].get_or_insert(number);
                });
            }
        }
    }

    pub fn material_of(&self, object: u32) -> &Material {
        &self.materials[self.objects[object as usize].material]
    }

    /// The body that fills an object, or `None` for an opaque or a thin object.
    pub fn body_of(&self, object: u32) -> Option<&Body> {
        self.material_of(object).body.as_ref()
    }

    /// The map from the unit cube to a box around a whole medium: that of a grid, or one around all
    /// objects that contain it. `None` if there are none, or the box is flat.
    pub fn box_of_medium(&self, number: usize) -> Option<DAffine3> {
        if let Density::Field(field) = &self.media[number].density {
            return Some(field.from_unit());
        }
        let boxes = [&self.geometry, &self.boundaries].map(|geometry| geometry.object_bounds());
        let filled = |object: u32| self.body_of(object).is_some_and(|body| body.medium == Some(number));
        let boxes = boxes.into_iter().flatten().filter(|(object, _)| filled(*object)).map(|(_, around)| around);
        let around = |(low, high): (DVec3, DVec3), (from, to): (DVec3, DVec3)| (low.min(from), high.max(to));
        let (low, high) = boxes.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), around);
        let is_box = low.is_finite() && high.is_finite() && (high - low).min_element() > 0.0;
        is_box.then(|| DAffine3::from_translation(low) * DAffine3::from_scale(high - low))
    }

    /// The medium stack on the other side of a face that the ray hits.
    pub fn across(&self, medium_stack: &MediumStack, ray: &Ray, hit: &Hit) -> MediumStack {
        match self.body_of(hit.object) {
            None => *medium_stack,
            Some(_) if medium_stack.is_full() => self.across_with_full_stack(medium_stack, ray, hit),
            Some(_) if ray.direction.dot(hit.normal) < 0.0 => self.entered(*medium_stack, hit.object),
            Some(_) => medium_stack.left(hit.object),
        }
    }

    /// The object that determines the refractive index at a point, or `None` for air.
    #[inline]
    pub fn dominant_dielectric(&self, medium_stack: &MediumStack) -> Option<u32> {
        medium_stack.dominant_dielectric(|object| self.body_priority(object))
    }

    /// The body that determines the medium at a point, with or without a surface. `None` for air.
    fn dominant_body(&self, medium_stack: &MediumStack) -> Option<&Body> {
        medium_stack.dominant_body(|object| self.body_priority(object)).and_then(|object| self.body_of(object))
    }

    fn body_priority(&self, object: u32) -> BodyPriority {
        self.body_of(object).map(|body| body.body_priority(self.body_ranks[object as usize])).unwrap_or_default()
    }

    #[inline]
    pub fn index_in(&self, medium_stack: &MediumStack) -> &RefractiveIndex {
        if medium_stack.is_air() {
            return &self.air;
        }
        self.index_of(self.dominant_dielectric(medium_stack))
    }

    /// The refractive index at a point at which `object` is the dominant dielectric; air if `None`.
    #[inline]
    pub fn index_of(&self, object: Option<u32>) -> &RefractiveIndex {
        let body = object.and_then(|object| self.body_of(object));
        body.and_then(|body| body.index.as_ref()).unwrap_or(&self.air)
    }

    /// The absorption coefficient at a point, or `None` if the body there is clear.
    pub fn absorption_in(&self, medium_stack: &MediumStack) -> Option<&Spectrum> {
        self.dominant_body(medium_stack).and_then(|body| body.absorption.as_ref())
    }

    pub fn medium_in(&self, medium_stack: &MediumStack) -> Option<usize> {
        self.dominant_body(medium_stack).and_then(|body| body.medium)
    }
}
