//! The scene: as written (`file`), and resolved into surfaces, lights, materials and a camera in metres and watts.
//!
//! Rendering a resolved scene cannot fail for a reason in the scene.

pub mod bvh;
pub mod camera;
mod enclosure;
pub mod facts;
pub mod file;
pub mod geometry;
pub mod interior;
pub mod light;
pub mod medium;
pub mod mesh;
pub mod motion;
pub mod resolve;
pub mod shape;
pub mod sweep;

use crate::colour::gamut::GamutMapping;
use crate::colour::{RgbSpace, Xyz};
use crate::optics::glass::Index;
use crate::optics::surface::Surface;
use crate::spectrum::{Observer, Spectrum};
use camera::{Camera, Shutter};
use geometry::{Geometry, Hit, Ray};
use glam::{DAffine3, DVec3};
use interior::{Interior, Rank};
use light::{Emitter, Light, World};
use medium::{Density, Medium};
use motion::Motions;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A resolved scene, as it stands when the shutter opens. Positions are relative to `centre`.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The title, or the file's name.
    pub title: String,
    /// Where the origin of all positions stands in the scene file's world, in m.
    pub centre: DVec3,
    /// The radius of a ball around the origin that holds all surfaces and local lights, in m.
    pub radius_m: f64,
    /// The camera.
    pub camera: Camera,
    /// When the camera is open.
    pub shutter: Shutter,
    /// What moves meanwhile.
    pub motions: Motions,
    /// The film.
    pub film: FilmSpec,
    /// All surfaces.
    pub geometry: Arc<Geometry>,
    /// The faces of bodies that have no surface: they only bound a medium, and rays pass them without an event.
    pub boundaries: Arc<Geometry>,
    /// What the surfaces belong to, by object number.
    pub objects: Vec<Object>,
    /// The materials, by number.
    pub materials: Vec<Material>,
    /// The media, by number.
    pub media: Vec<Medium>,
    /// The lights, by number.
    pub lights: Vec<Light>,
    /// The lights at infinity, which rays that leave the scene see.
    pub distant_lights: Vec<usize>,
    /// The light that each medium is, where it glows.
    pub medium_lights: Vec<Option<usize>>,
    /// Render settings as far as the scene states them.
    pub settings: Settings,
    /// What a reader should know: residuals of matched lights, clamped indices, open meshes, …
    pub notes: Vec<String>,
    /// The index of the air.
    pub air: Index,
}

/// An object: a surface with a material.
#[derive(Debug, Clone)]
pub struct Object {
    /// Its name for reports.
    pub name: String,
    /// Its material's number.
    pub material: usize,
    /// Its light's number, if it shines.
    pub light: Option<usize>,
}

/// A material: a surface, and what stands behind it.
#[derive(Debug, Clone)]
pub struct Material {
    /// Its name for reports.
    pub name: String,
    /// What the surface does to light.
    pub surface: Surface,
    /// What fills the object, if it is transparent.
    pub body: Option<Body>,
}

/// The inside of a transparent object.
#[derive(Debug, Clone)]
pub struct Body {
    /// Refractive index; `None` is that of whatever is around: the body only bounds a medium.
    pub index: Option<Index>,
    /// Absorption coefficient in 1/m; `None` is perfectly clear.
    pub absorption: Option<Spectrum>,
    /// The number of the medium in it.
    pub medium: Option<usize>,
    /// Which body rules where several overlap: the higher.
    pub priority: i32,
}

/// The film as the scene wants it.
#[derive(Debug, Clone)]
pub struct FilmSpec {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Whose eye sees it.
    pub observer: &'static Observer,
    /// Number of spectral bands kept, 0 for none.
    pub spectral_bands: u32,
    /// The colour space of the PNG.
    pub space: RgbSpace,
    /// The light that the PNG shows as white, as XYZ of `observer` at any scale; `None` shows colours as they are.
    pub white: Option<Xyz>,
    /// What is done with colours outside that space.
    pub gamut: GamutMapping,
    /// How bright the PNG is.
    pub exposure: Exposure,
}

/// How radiance becomes brightness in the PNG.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Exposure {
    /// So that the picture is neither dark nor burnt out.
    Auto,
    /// The given luminance factor 2^ev relative to 1 cd/m² = white.
    Ev(f64),
    /// This luminance in cd/m² is white.
    White(f64),
    /// Luminance 1 cd/m² is white.
    None,
}

/// Render settings, as far as stated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    /// Number of passes.
    pub passes: Option<u64>,
    /// Photon paths a pass.
    pub photons: Option<u64>,
    /// Surface events a path may have.
    pub max_depth: Option<u32>,
    /// Photons within the first radius.
    pub nearest: Option<u32>,
    /// First radius in m, instead of `nearest`.
    pub radius_m: Option<f64>,
    /// Seed of all random streams.
    pub seed: Option<u64>,
    /// Worker threads.
    pub threads: Option<u32>,
    /// Seconds between checkpoints.
    pub checkpoint_seconds: Option<f64>,
    /// Cells of the first pass's light maps along the longest side of a medium's box.
    pub light_map: Option<u32>,
    /// Effects to switch on though no fact calls for them.
    pub force: Vec<String>,
    /// Effects to leave out though a fact calls for them.
    pub forbid: Vec<String>,
}

impl Material {
    /// No surface, but the bounds of a medium.
    pub fn boundary(name: &str, medium: usize, priority: i32) -> Self {
        let body = Body { index: None, absorption: None, medium: Some(medium), priority };
        // Rays pass such faces without meeting the surface.
        Self { name: name.to_owned(), surface: Surface::Absorber, body: Some(body) }
    }

    /// Whether it only bounds a medium.
    pub fn is_boundary(&self) -> bool {
        self.body.as_ref().is_some_and(|body| body.index.is_none())
    }
}

impl Body {
    /// What decides whether it rules where bodies overlap.
    pub fn rank(&self) -> Rank {
        Rank { priority: self.priority, refracts: self.index.is_some() }
    }
}

impl Scene {
    /// What distant lights need to know.
    pub fn world(&self) -> World<'_> {
        World { geometry: &self.geometry, radius_m: self.radius_m }
    }

    /// Finds the distant lights, and every object's and medium's light, again after lights were added or taken out.
    pub fn renumber_lights(&mut self) {
        self.objects.iter_mut().for_each(|object| object.light = None);
        self.distant_lights.clear();
        self.medium_lights = vec![None; self.media.len()];
        for (number, light) in self.lights.iter().enumerate() {
            match &light.emitter {
                Emitter::Area(area) => self.objects[area.object as usize].light = Some(number),
                Emitter::Environment(_) | Emitter::Directional(_) => self.distant_lights.push(number),
                Emitter::Volume(volume) => {
                    let medium = self.media.iter().position(|medium| &medium.name == volume.medium_name());
                    medium.into_iter().for_each(|medium| {
                        self.medium_lights[medium].get_or_insert(number);
                    });
                }
                Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) => {}
            }
        }
    }

    /// The material of an object.
    pub fn material_of(&self, object: u32) -> &Material {
        &self.materials[self.objects[object as usize].material]
    }

    /// The body that fills an object, if it is transparent.
    pub fn body_of(&self, object: u32) -> Option<&Body> {
        self.material_of(object).body.as_ref()
    }

    /// The light that a medium is, if it glows.
    pub fn light_of_medium(&self, number: usize) -> Option<&Light> {
        self.medium_lights[number].map(|light| &self.lights[light])
    }

    /// The map from the unit cube onto a box that holds all of a medium: its own box, or one along the axes around the objects that it fills.
    /// `None` of a medium that fills nothing, or lies behind a flat face.
    pub fn box_of_medium(&self, number: usize) -> Option<DAffine3> {
        if let Density::Field(field) = &self.media[number].density {
            return Some(field.from_unit());
        }
        let boxes = [&self.geometry, &self.boundaries].map(|geometry| geometry.object_boxes());
        let filled = |object: u32| self.body_of(object).is_some_and(|body| body.medium == Some(number));
        let boxes = boxes.into_iter().flatten().filter(|(object, _)| filled(*object)).map(|(_, around)| around);
        let around = |(low, high): (DVec3, DVec3), (from, to): (DVec3, DVec3)| (low.min(from), high.max(to));
        let (low, high) = boxes.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), around);
        let is_box = low.is_finite() && high.is_finite() && (high - low).min_element() > 0.0;
        is_box.then(|| DAffine3::from_translation(low) * DAffine3::from_scale(high - low))
    }

    /// The bodies on the other side of a face that the ray meets.
    pub fn across(&self, interior: &Interior, ray: &Ray, hit: &Hit) -> Interior {
        match self.body_of(hit.object) {
            None => *interior,
            Some(_) if ray.direction.dot(hit.normal) < 0.0 => interior.entered(hit.object),
            Some(_) => interior.left(hit.object),
        }
    }

    /// Whether a face with these bodies on its two sides does not show: it lies inside a body of higher priority, which rules on both.
    #[inline]
    pub fn is_hidden(&self, hit: &Hit, here: &Interior, there: &Interior) -> bool {
        self.body_of(hit.object).is_some() && self.ruler(there) == self.ruler(here)
    }

    /// The object whose refractive index rules inside these bodies; `None` is the air.
    pub fn ruler(&self, interior: &Interior) -> Option<u32> {
        interior.ruler(|object| self.rank(object))
    }

    /// The body that fills the place inside these bodies, with a surface of its own or without; `None` is the air.
    fn filler(&self, interior: &Interior) -> Option<&Body> {
        interior.filler(|object| self.rank(object)).and_then(|object| self.body_of(object))
    }

    fn rank(&self, object: u32) -> Rank {
        self.body_of(object).map(Body::rank).unwrap_or_default()
    }

    /// The refractive index that rules inside these bodies.
    #[inline]
    pub fn index_in(&self, interior: &Interior) -> &Index {
        if interior.is_air() {
            return &self.air;
        }
        let body = self.ruler(interior).and_then(|object| self.body_of(object));
        body.and_then(|body| body.index.as_ref()).unwrap_or(&self.air)
    }

    /// The absorption that rules inside these bodies.
    pub fn absorption_in(&self, interior: &Interior) -> Option<&Spectrum> {
        self.filler(interior).and_then(|body| body.absorption.as_ref())
    }

    /// The number of the medium inside these bodies.
    pub fn medium_in(&self, interior: &Interior) -> Option<usize> {
        self.filler(interior).and_then(|body| body.medium)
    }
}
