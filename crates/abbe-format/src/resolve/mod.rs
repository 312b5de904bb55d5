//! Translates the scene file to the scene model. Names become numbers, quantities are converted to
//! SI units, spectra become functions of wavelength, and the named files are read.
//!
//! [`SceneBuilder`] builds and checks the model, and this module adds positions to its errors. Most
//! structs are destructured without `..`, so that the compiler reports a forgotten field.

mod camera;
mod coating;
mod context;
mod emission;
mod environment_image;
mod film;
mod filter;
mod index;
mod lens;
mod lights;
mod materials;
mod media;
mod mesh_materials;
mod meshes;
mod meters;
mod motion;
mod objects;
mod ray_sets;
mod spectra;
mod textures;

pub use coating::{FilmSystem, lone_coating};
pub use index::{glass_file, glass_files};
pub use lens::{catalogues_beside, lens_file, lens_system_file, lone_lens};
pub use media::DEFAULT_MARCH_STEPS;
pub use spectra::Role;

use crate::read::{parse_source, read};
use crate::{FileAccess, JsonPath, JsonSource, MediumFile, RenderFile, SceneFile, SpectrumFile};
use abbe_scene::builder::{SceneBuilder, SceneError, ScenePart, SceneView, WhiteBalance};
use abbe_scene::{Scene, Settings};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Observer, Spectrum};
use context::{ResolvedFor, Resolver};
use glam::DVec3;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads and resolves a scene file. `sets` are patches of the form `PATH=JSON`.
///
/// # Errors
/// Returns the errors of [`read`](crate::read()) and of [`resolve`].
pub fn load(path: &Path, sets: &[String]) -> Result<Scene> {
    let (scene, source) = read(path, sets)?;
    resolve(&scene, &source)
}

/// Reads a scene from its text like [`parse`](crate::parse). `access` says which files it may name.
/// If the text has faults, the error also contains those that [`resolve`] finds.
pub fn parse_with_access(
    text: impl Into<String>,
    path: &Path,
    sets: &[String],
    access: FileAccess,
) -> Result<(SceneFile, JsonSource)> {
    let source = JsonSource::of_scene(text, path, sets, access)?;
    parse_source(source, &|scene, source| resolve_any(scene, source).err())
}

/// Resolves a scene.
///
/// # Errors
/// Returns the faults of all parts of the scene, each with its place in `source`: unknown names,
/// unreadable files, contradictory quantities, and features that are not supported yet.
pub fn resolve(scene: &SceneFile, source: &JsonSource) -> Result<Scene> {
    let (Some(camera), Some(film)) = (&scene.camera, &scene.film) else {
        let key = if scene.camera.is_none() { "camera" } else { "film" };
        let error = Error::input(format!("missing key \"{key}\""));
        return Err(source.error_at("", error.expected("a camera and a film; `abbe measure` reads only the meters")));
    };
    about_view(|centre| Resolver::new(scene, source, ResolvedFor::Picture(camera, film), centre))
}

/// Resolves the meters of a scene instead of its camera and its film, with the errors of
/// [`resolve`].
pub fn resolve_meters(scene: &SceneFile, source: &JsonSource) -> Result<Scene> {
    if scene.meters.is_empty() {
        return Err(source.fault(&JsonPath::Root, "the scene has no meters", "at least one entry in `meters`"));
    }
    about_view(|centre| Resolver::new(scene, source, ResolvedFor::Meters, centre))
}

/// Resolves a scene for its picture, or for its meters if it has no camera.
pub fn resolve_any(scene: &SceneFile, source: &JsonSource) -> Result<Scene> {
    let only_meters = scene.camera.is_none() && !scene.meters.is_empty();
    if only_meters { resolve_meters(scene, source) } else { resolve(scene, source) }
}

/// Resolves a scene about its centre in m, which `resolver` takes. `None` is the objects' middle.
fn about_view<'a>(resolver: impl Fn(Option<DVec3>) -> Resolver<'a>) -> Result<Scene> {
    let resolved = resolver(None).run()?;
    // If the camera sees a small part of a large world, its centre is a better origin for `f32`.
    if let Some(centre) = resolved.distant_view() { resolver(Some(centre)).run() } else { Ok(resolved) }
}

/// Resolves a spectrum outside a scene, with names of the library. Errors have a place in `source`.
pub fn lone_spectrum(spectrum: &SpectrumFile, source: &JsonSource, role: Role) -> Result<Spectrum> {
    lone_spectrum_with_notes(spectrum, source, role).map(|(spectrum, _)| spectrum)
}

/// Resolves a spectrum as [`lone_spectrum`] does, and also returns what the readers of its files
/// decided from the values, such as the scale of a CGATS file.
pub fn lone_spectrum_with_notes(
    spectrum: &SpectrumFile,
    source: &JsonSource,
    role: Role,
) -> Result<(Spectrum, Vec<String>)> {
    let notes = RefCell::default();
    let spectra = spectra::Spectra { named: &BTreeMap::new(), source, notes: &notes };
    let spectrum = spectra.checked(&JsonPath::Root, spectrum, role)?;
    Ok((spectrum, notes.take()))
}

impl Resolver<'_> {
    fn run(&self) -> Result<Scene> {
        let SceneFile { title, spectra, atmosphere, render, .. } = self.scene;
        let root = JsonPath::Root;
        // Unused spectra are checked as well.
        for name in spectra.keys() {
            self.keep(self.named_spectrum(name, spectra::Role::Coefficient));
        }
        let objects = self.objects();
        let set = objects.set;
        let builder =
            if let Some(centre) = self.centre { SceneBuilder::about(set, centre) } else { SceneBuilder::new(set) };
        let mut builder = match self.at(&root.key("objects"), builder) {
            Ok(builder) => builder,
            // The fault may only follow from an object that was left out.
            Err(fault) => return Err(self.kept_faults().unwrap_or(fault)),
        };
        self.media(&mut builder);
        let view = self.view(&mut builder);
        let observer = view.as_ref().map_or(Observer::cie1931(), |view| view.film.observer);
        self.lights(&objects.emitting, &mut builder, observer);
        if let Some(number) =
            atmosphere.as_ref().and_then(|name| self.keep(self.medium_number(&root.key("atmosphere"), name)))
        {
            builder.set_atmosphere(number);
        }
        builder.title = title.clone().unwrap_or_else(|| stem(&self.source.path));
        builder.settings = self.settings(render);
        builder.notes.extend(self.note_without_motion());
        builder.notes.extend(self.spectrum_notes.take());
        match (self.kept_faults(), view) {
            (None, Some(view)) => builder.build(view).map_err(|error| self.placed(error)),
            (faults, _) => Err(faults.unwrap_or_else(|| Error::input("the scene has a fault"))),
        }
    }

    /// Resolves the camera and the film, or the meters that take their place.
    fn view(&self, builder: &mut SceneBuilder) -> Option<SceneView> {
        let (root, shutter) = (JsonPath::Root, self.shutter.clone());
        let ResolvedFor::Picture(camera, film) = self.view else {
            let (camera, film, meters) = self.keep(self.meters(builder))?;
            let (camera_motion, white_balance) = (None, WhiteBalance::None);
            return Some(SceneView { camera, camera_motion, shutter, film, white_balance, meters });
        };
        let film_at = root.key("film");
        let size = (film.width, film.height);
        let white_balance = self.keep(self.white_balance(&film_at.key("white_balance"), &film.white_balance));
        let centre = builder.centre();
        let film = self.keep(self.film(&film_at, film, camera));
        let camera = self.keep(self.camera(&root.key("camera"), camera, size, centre, &mut builder.notes));
        let ((camera, camera_motion), film, white_balance) = (camera?, film?, white_balance?);
        Some(SceneView { camera, camera_motion, shutter, film, white_balance, meters: Vec::new() })
    }

    /// Adds the place in the file to an error of the scene model.
    fn placed(&self, SceneError { part, error }: SceneError) -> Error {
        let root = JsonPath::Root;
        let path = match part {
            ScenePart::Whole => String::new(),
            ScenePart::Objects => root.key("objects").to_string(),
            ScenePart::Film => root.key("film").to_string(),
            ScenePart::WhiteBalance => root.key("film").key("white_balance").to_string(),
            ScenePart::MediumEmission(number) => {
                self.scene.media.iter().nth(number).map_or_else(String::new, |(name, file)| {
                    let kind = match file {
                        MediumFile::Homogeneous(_) => "homogeneous",
                        MediumFile::Grid(_) => "grid",
                    };
                    root.key("media").key(name).key(kind).key("emission").to_string()
                })
            }
        };
        self.source.error_at(&path, error)
    }

    fn settings(&self, render: &RenderFile) -> Settings {
        let RenderFile { passes, photons, camera_samples, max_depth, nearest, radius, seed, threads, .. } = render;
        // `march_steps` is used where the media are resolved.
        let RenderFile { checkpoint_seconds, march_steps: _, light_map, force, forbid, .. } = render;
        Settings {
            passes: *passes,
            photons: *photons,
            camera_samples: *camera_samples,
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
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".to_string(), |stem| stem.to_string_lossy().into_owned())
}
