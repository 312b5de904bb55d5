//! From the scene as written to the scene as meant: names → numbers, units → SI, spectra → functions of wavelength.
//!
//! Every key of the file is read here or answered with "not supported yet": structs are taken apart exhaustively, so that a
//! forgotten field does not compile.

mod camera;
mod film;
mod glows;
mod lens;
mod lights;
mod materials;
mod media;
mod mesh_materials;
mod motion;
mod objects;
mod spectra;
mod surroundings;

pub use lens::{catalogues_beside, glass_file, lens_file, lone_lens};
pub use media::DEFAULT_MARCH_STEPS;
pub use spectra::Role;

use super::camera::{Camera, Shutter};
use super::file::{self, JsonPath, RenderFile, SceneFile, Source, SpectrumFile};
use super::geometry::{Geometry, Hit, Ray};
use super::interior::Interior;
use super::light::{Emitter, Light};
use super::motion::Motions;
use super::shape::Placed;
use super::{Material, Object, Scene, Settings};
use crate::error::{Error, Result};
use crate::optics::glass::Index;
use crate::spectrum::Spectrum;
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Reads and resolves a scene file; `sets` are `PATH=JSON` patches.
///
/// # Errors
/// Whatever is wrong with the file, with its place; and what it asks for that is not supported yet.
pub fn load(path: &Path, sets: &[String]) -> Result<Scene> {
    let (scene, source) = file::read(path, sets)?;
    resolve(&scene, &source)
}

/// Resolves a scene.
///
/// # Errors
/// Unknown names, files that cannot be read, quantities that make no sense together, what is not supported yet; each with its
/// place in `source`.
pub fn resolve(scene: &SceneFile, source: &Source) -> Result<Scene> {
    let resolver = Resolver { scene, source, metres: scene.unit.metres(), shutter: motion::shutter(&scene.camera) };
    resolver.run()
}

/// Resolves a spectrum that stands by itself, outside any scene: it can name no spectra but the library's.
///
/// # Errors
/// Unknown names, files that cannot be read, values that do not fit the role; each with its place in `source`.
pub fn lone_spectrum(spectrum: &SpectrumFile, source: &Source, role: Role) -> Result<Spectrum> {
    spectra::Spectra { named: &BTreeMap::new(), source }.checked(&JsonPath::Root, spectrum, role)
}

/// The answer to a part of the scene file that this version cannot simulate.
fn unsupported(what: &str) -> Error {
    Error::input(format!("{what} not supported yet"))
}

/// What resolving needs at hand.
struct Resolver<'a> {
    scene: &'a SceneFile,
    source: &'a Source,
    /// Metres in a unit of length.
    metres: f64,
    /// When the camera is open: the scene is resolved as it stands when it opens.
    shutter: Shutter,
}

impl Resolver<'_> {
    /// Gives an error its place.
    fn at<T>(&self, path: &JsonPath<'_>, result: Result<T>) -> Result<T> {
        result.map_err(|error| self.source.error_at(&path.to_string(), error))
    }

    fn run(&self) -> Result<Scene> {
        let SceneFile { schema: _, title, unit: _, camera, film, spectra, media: _, materials: _, .. } = self.scene;
        let SceneFile { objects: _, lights: _, atmosphere, render, .. } = self.scene;
        let root = JsonPath::Root;
        // Spectra that nothing uses are checked all the same.
        for name in spectra.keys() {
            self.named_spectrum(name, spectra::Role::Coefficient)?;
        }
        let mut notes = Vec::new();
        let mut things = self.objects(&mut notes)?;
        let centre = objects::centre(things.shapes.iter().map(|shape| &shape.placed));
        let mut media = self.media(centre, &mut notes)?;
        let holders = glows::holders(&things);
        let of_kind = |things: &objects::Things<'_>, boundaries: bool| -> Vec<Placed> {
            let placed = things.shapes.iter().map(|shape| &shape.placed);
            placed.filter(|placed| things.is_boundary(placed) == boundaries).cloned().collect()
        };
        let geometry = self.at(&root.key("objects"), Geometry::build(of_kind(&things, false), centre))?;
        let film = self.film(&root.key("film"), film)?;
        let (camera, camera_motion) =
            self.camera(&root.key("camera"), camera, (film.width, film.height), centre, &mut notes)?;
        let mut lights = self.lights(&things, (&geometry, centre), film.observer, &mut notes)?;
        let around = atmosphere.as_ref().map(|name| self.medium_number(&root.key("atmosphere"), name)).transpose()?;
        lights.extend(self.volume_lights(&mut media, &holders, around, (centre, film.observer))?);
        if lights.is_empty() {
            let error = Error::input("the scene has no light")
                .expected("at least one entry in `lights` or an object with `emission`");
            return Err(self.source.error_at("", error));
        }
        let mut radius_m = geometry.radius_m();
        if let Some((name, number)) = atmosphere.as_ref().zip(around) {
            let things_reach = reach(&geometry, &camera, &lights).max(media[number].reach_m());
            radius_m = things.add_atmosphere((name, number), (centre, things_reach));
        }
        self.find_dense(&mut media, &things);
        let boundaries = self.at(&root.key("objects"), Geometry::build(of_kind(&things, true), centre))?;
        if atmosphere.is_none() && !boundaries.is_empty() {
            radius_m = radius_m.max(boundaries.radius_m());
        }
        let mut resolved = Scene {
            title: title.clone().unwrap_or_else(|| stem(&self.source.path)),
            centre,
            radius_m,
            camera,
            shutter: self.shutter.clone(),
            motions: Motions { shapes: motion::shapes(things.shapes), camera: camera_motion },
            film,
            geometry: Arc::new(geometry),
            boundaries: Arc::new(boundaries),
            media,
            objects: things.objects,
            materials: things.materials,
            lights,
            distant_lights: Vec::new(),
            medium_lights: Vec::new(),
            settings: self.settings(render),
            notes,
            air: Index::constant(1.0)?,
        };
        resolved.notes.extend(self.standing_still());
        let swept = resolved.swept_boxes();
        resolved.radius_m = swept.iter().fold(resolved.radius_m, |radius, (low, high)| {
            let reach = low.abs().max(high.abs()).length();
            if reach.is_finite() { radius.max(reach) } else { radius }
        });
        resolved.renumber_lights();
        resolved.find_interiors();
        resolved.film.white = self.white(&resolved)?;
        Ok(resolved)
    }

    fn settings(&self, render: &RenderFile) -> Settings {
        let RenderFile { passes, photons, max_depth, nearest, radius, seed, threads, .. } = render;
        // How a medium is marched through is the medium's matter.
        let RenderFile { checkpoint_seconds, march_steps: _, light_map, force, forbid, .. } = render;
        Settings {
            passes: *passes,
            photons: *photons,
            max_depth: *max_depth,
            nearest: *nearest,
            radius_m: radius.map(|radius| radius * self.metres),
            seed: *seed,
            threads: *threads,
            checkpoint_seconds: *checkpoint_seconds,
            light_map: light_map.map(|map| map.resolution),
            force: force.clone(),
            forbid: forbid.clone(),
        }
    }

    /// A point of the file in m, relative to the scene's centre.
    fn point(&self, point: [f64; 3], centre: DVec3) -> DVec3 {
        DVec3::from(point) * self.metres - centre
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".to_string(), |stem| stem.to_string_lossy().into_owned())
}

impl Scene {
    /// Finds the bodies of glass in which the camera and the lamps stand.
    pub(super) fn find_interiors(&mut self) {
        self.camera.interior = self.interior_at(self.camera.origin());
        let interiors: Vec<Interior> = self.lights.iter().map(|light| self.interior_of_light(light)).collect();
        self.lights.iter_mut().zip(interiors).for_each(|(light, interior)| light.interior = interior);
    }

    fn interior_of_light(&self, light: &Light) -> Interior {
        match &light.emitter {
            Emitter::Point(light) => self.interior_at(light.at),
            Emitter::Spot(light) => self.interior_at(light.at()),
            Emitter::Beam(light) => self.interior_at(light.centre()),
            Emitter::Directional(_) | Emitter::Environment(_) => Interior::AIR,
            Emitter::Volume(light) => self.interior_at(light.typical_place()),
            Emitter::Area(area) => {
                let place = self.geometry.sample_area(area.object, [0.37, 0.61, 0.53]);
                self.interior_along(Ray { origin: place.position, direction: place.normal }, Some(place.surface))
            }
        }
    }

    /// The bodies around a point.
    pub fn interior_at(&self, point: DVec3) -> Interior {
        // Any direction does; this one is parallel to nothing that people build.
        let direction = DVec3::new(0.391_827, 0.803_153, 0.448_713).normalize();
        self.interior_along(Ray { origin: point, direction }, None)
    }

    /// The bodies around a ray's origin: those that it leaves more often than it enters, the outermost (left last) first.
    fn interior_along(&self, ray: Ray, from: Option<super::geometry::SurfaceId>) -> Interior {
        let mut open: Vec<(u32, i32, f64)> = Vec::new();
        let mut count = |hit: &Hit| {
            if self.body_of(hit.object).is_none() {
                return;
            }
            let leaves = if ray.direction.dot(hit.normal) > 0.0 { 1 } else { -1 };
            match open.iter_mut().find(|(object, _, _)| *object == hit.object) {
                Some(entry) => {
                    entry.1 += leaves;
                    entry.2 = hit.t;
                }
                None => open.push((hit.object, leaves, hit.t)),
            }
        };
        self.geometry.for_each_hit(&ray, from, &mut count);
        self.boundaries.for_each_hit(&ray, None, &mut count);
        open.retain(|&(_, balance, _)| balance > 0);
        open.sort_by(|a, b| b.2.total_cmp(&a.2));
        open.iter().fold(Interior::AIR, |interior, &(object, _, _)| interior.entered(object))
    }
}

/// The radius of a ball around the centre that holds all surfaces, the camera and the local lights.
fn reach(geometry: &Geometry, camera: &Camera, lights: &[Light]) -> f64 {
    let places = lights.iter().filter_map(|light| match &light.emitter {
        Emitter::Point(light) => Some(light.at),
        Emitter::Spot(light) => Some(light.at()),
        Emitter::Beam(light) => Some(light.centre()),
        Emitter::Directional(_) | Emitter::Environment(_) | Emitter::Area(_) | Emitter::Volume(_) => None,
    });
    places.chain([camera.origin()]).map(DVec3::length).fold(geometry.radius_m(), f64::max)
}

/// A material for objects whose own could not be named otherwise.
fn number_of(materials: &mut Vec<Material>, material: Material) -> usize {
    materials.push(material);
    materials.len() - 1
}

/// A plain object.
fn object(name: String, material: usize) -> Object {
    Object { name, material, light: None }
}
