//! Translates the scene file to the scene model. Names become numbers, quantities are converted to
//! SI units, spectra become functions of wavelength, and the named files are read.
//!
//! [`SceneBuilder`] builds and checks the model. This module adds the position in the file to the
//! builder's errors. This module reads every key of the file, or refuses the key with the message
//! "not supported yet". If a struct is destructured without `..`, the compiler reports a forgotten
//! field.

mod camera;
mod coating;
mod context;
mod emission;
mod environment_image;
mod film;
mod index;
mod lens;
mod lights;
mod materials;
mod media;
mod mesh_materials;
mod meshes;
mod motion;
mod objects;
mod spectra;
mod textures;

pub use coating::{FilmSystem, lone_coating};
pub use index::glass_file;
pub use lens::{catalogues_beside, lens_file, lens_system_file, lone_lens};
pub use media::DEFAULT_MARCH_STEPS;
pub use spectra::Role;

use super::{MediumFile, RenderFile, SceneFile, SpectrumFile};
use crate::error::{Error, Result};
use crate::json::{JsonPath, JsonSource};
use crate::scene::builder::{SceneBuilder, SceneError, ScenePart, SceneView};
use crate::scene::{Scene, Settings};
use crate::spectrum::{Observer, Spectrum};
use context::Resolver;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads and resolves a scene file. `sets` are patches of the form `PATH=JSON`.
///
/// # Errors
/// Returns an error if the file is invalid or uses a feature that is not supported yet. The error
/// states the place in the file.
pub fn load(path: &Path, sets: &[String]) -> Result<Scene> {
    let (scene, source) = super::read(path, sets)?;
    resolve(&scene, &source)
}

/// Resolves a scene.
///
/// # Errors
/// Returns an error if a name is unknown, if a file cannot be read, if quantities contradict each
/// other, or if a feature is not supported yet. The error contains the faults of all parts of the
/// scene, and states the place of each in `source`.
pub fn resolve(scene: &SceneFile, source: &JsonSource) -> Result<Scene> {
    let shutter = || motion::shutter(&scene.camera);
    let resolved = Resolver::new(scene, source, shutter(), None).run()?;
    // If the camera looks at a small part of a large world, the centre of the view is a better
    // origin for positions in single precision.
    match resolved.distant_view() {
        Some(centre) => Resolver::new(scene, source, shutter(), Some(centre)).run(),
        None => Ok(resolved),
    }
}

/// Resolves a spectrum that is not part of a scene. If the spectrum is a name, the library must
/// contain a spectrum with this name.
///
/// # Errors
/// Returns an error if a name is unknown, if a file cannot be read, or if a value does not fit the
/// role. The error states the place in `source`.
pub fn lone_spectrum(spectrum: &SpectrumFile, source: &JsonSource, role: Role) -> Result<Spectrum> {
    spectra::Spectra { named: &BTreeMap::new(), source }.checked(&JsonPath::Root, spectrum, role)
}

impl Resolver<'_> {
    fn run(&self) -> Result<Scene> {
        let SceneFile { schema: _, title, unit: _, camera, film, spectra, media: _, materials: _, .. } = self.scene;
        let SceneFile { objects: _, lights: _, atmosphere, render, .. } = self.scene;
        let root = JsonPath::Root;
        // Unused spectra are checked as well.
        for name in spectra.keys() {
            self.keep(self.named_spectrum(name, spectra::Role::Coefficient));
        }
        let objects = self.objects();
        let builder = match self.centre {
            None => SceneBuilder::new(objects.set),
            Some(centre) => SceneBuilder::about(objects.set, centre),
        };
        let mut builder = match self.at(&root.key("objects"), builder) {
            Ok(builder) => builder,
            // The fault may only follow from an object that was left out.
            Err(fault) => return Err(self.kept_faults().unwrap_or(fault)),
        };
        let centre = builder.centre();
        self.media(&mut builder);
        let film_at = root.key("film");
        let size = (film.width, film.height);
        let film = self.keep(self.film(&film_at, film));
        let camera = self.keep(self.camera(&root.key("camera"), camera, size, centre, &mut builder.notes));
        let observer = film.as_ref().map_or(Observer::cie1931(), |film| film.observer);
        self.lights(&objects.emitting, &mut builder, observer);
        if let Some(number) =
            atmosphere.as_ref().and_then(|name| self.keep(self.medium_number(&root.key("atmosphere"), name)))
        {
            builder.set_atmosphere(number);
        }
        builder.title = title.clone().unwrap_or_else(|| stem(&self.source.path));
        builder.settings = self.settings(render);
        builder.notes.extend(self.note_without_motion());
        let white_balance = self.keep(self.white_balance(&film_at.key("white_balance")));
        let shutter = self.shutter.clone();
        match (self.kept_faults(), camera, film, white_balance) {
            (None, Some((camera, camera_motion)), Some(film), Some(white_balance)) => builder
                .build(SceneView { camera, camera_motion, shutter, film, white_balance })
                .map_err(|error| self.placed(error)),
            (faults, ..) => Err(faults.unwrap_or_else(|| Error::input("the scene has a fault"))),
        }
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
