//! Builds a scene from its parts, without a file, and checks it.
//!
//! An [`ObjectSet`] first collects materials and shapes in world coordinates. [`SceneBuilder::new`]
//! then fixes the scene's centre, to which the positions of lights, media and the camera are
//! relative, and [`SceneBuilder::build`] returns the scene.
//!
//! # Example
//!
//! ```
//! use abbe_scene::geometry::shape::Shape;
//! use abbe_optics::{bsdf::Bsdf, glass::RefractiveIndex};
//! use abbe_scene::builder::{ObjectSet, SceneBuilder, SceneView, WhiteBalance};
//! use abbe_scene::camera::{Aperture, Camera, Shutter, look_at_axes};
//! use abbe_scene::light::{Emitter, Light, LightSpectrum, PointLight};
//! use abbe_scene::{Body, FilmSpec, Material};
//! use abbe_spectra::{Observer, Spectrum};
//! use glam::{DAffine3, DVec3};
//!
//! // A glass ball on a grey floor, in metres.
//! let mut objects = ObjectSet::default();
//! let grey = Bsdf::diffuse(Spectrum::constant(0.5))?;
//! let grey = objects.add_material(Material { name: "grey".into(), surface: grey, normal_map: None, body: None });
//! let crown = Some(RefractiveIndex::catalogue("N-BK7")?);
//! let body = Some(Body { index: crown, absorption: None, medium: None, priority: 0 });
//! let surface = Bsdf::dielectric(0.0)?;
//! let glass = objects.add_material(Material { name: "glass".into(), surface, normal_map: None, body });
//! let floor = Shape::Rectangle { width: 4.0, height: 4.0 };
//! objects.add_object("floor", grey, floor, DAffine3::IDENTITY)?;
//! let above = DAffine3::from_translation(DVec3::new(0.0, 1.0, 0.0));
//! objects.add_object("ball", glass, Shape::Sphere { radius: 0.5 }, above)?;
//!
//! let mut builder = SceneBuilder::new(objects)?;
//! let centre = builder.centre();
//! let film = FilmSpec::new(40, 30, Observer::cie1931());
//! let lamp = PointLight { position: DVec3::new(1.0, 3.0, 0.0) - centre, intensity: 10.0 };
//! let tungsten = LightSpectrum::new(&Spectrum::blackbody(2856.0)?);
//! builder.add_light(Light::new("lamp".into(), Emitter::Point(lamp), &tungsten, film.observer)?)?;
//!
//! let origin = DVec3::new(0.0, 1.5, 4.0) - centre;
//! let axes = look_at_axes(-origin, DVec3::Y);
//! let size = (film.width, film.height);
//! let camera = Camera::new(origin, axes, f64::tan(0.4), size, Aperture::Pinhole);
//! let shutter = Shutter::new(0.0, 0.0, None);
//! let white_balance = WhiteBalance::None;
//! let view = SceneView { camera, camera_motion: None, shutter, film, white_balance, meters: Vec::new() };
//! let scene = builder.build(view)?;
//! assert_eq!(scene.objects[1].name, "ball");
//! assert_eq!(scene.lights.len(), 1);
//! # Ok::<(), abbe_spectra::Error>(())
//! ```

use super::camera::{Camera, Shutter};
use super::light::Light;
use super::medium::Medium;
use super::meter::{Meter, Sensor};
use super::motion::{AnimatedLookAt, AnimatedShape, AnimatedTransform, SceneMotion};
use super::{FilmSpec, Material, Object, Scene, Settings};
use crate::geometry::Geometry;
use crate::geometry::shape::{PlacedShape, Shape};
use abbe_optics::glass::RefractiveIndex;
use abbe_spectra::colour::{AdaptationTransform, Xyz};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Spectrum;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// The objects of a scene under construction, with their materials.
#[derive(Debug, Default)]
pub struct ObjectSet {
    pub notes: Vec<String>,
    /// See [`crate::Scene::warnings`].
    pub warnings: Vec<String>,
    /// An object whose mesh overlaps itself has a shape for each shell.
    pub(super) shapes: Vec<AnimatedShape>,
    pub(super) objects: Vec<Object>,
    pub(super) materials: Vec<Material>,
}

/// The position and the motion of an object.
#[derive(Debug, Clone)]
pub struct Placement {
    /// Transforms the shape's frame to the world when the shutter opens. Lengths are in m.
    pub to_world: DAffine3,
    /// The motion of a frame while the shutter is open; lengths are in m.
    pub motion: Option<(AnimatedTransform, DAffine3)>,
}

impl From<DAffine3> for Placement {
    fn from(to_world: DAffine3) -> Self {
        Self { to_world, motion: None }
    }
}

impl ObjectSet {
    pub fn add_material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds an object with this material and returns its number. Returns an error if the shape is
    /// not a valid body, the material does not exist, or a flat shape's material contains a medium.
    pub fn add_object(
        &mut self,
        name: impl Into<String>,
        material: usize,
        shape: Shape,
        placement: impl Into<Placement>,
    ) -> Result<u32> {
        let (name, placement) = (name.into(), placement.into());
        let material = self.turned_crystal(material, &shape, &placement)?;
        let Some(Material { name: material_name, body, .. }) = self.materials.get(material) else {
            return Err(Error::input(format!("the object \"{name}\" has the material number {material}"))
                .expected(format!("a number below {}", self.materials.len())));
        };
        let flat = matches!(shape, Shape::Rectangle { .. } | Shape::Disk { .. });
        if flat && body.as_ref().is_some_and(|body| body.medium.is_some()) {
            return Err(Error::input(format!("found a flat shape, filled by the medium of \"{material_name}\""))
                .expected("a shape that encloses a space"));
        }
        shape.validate()?;
        let mut shells = None;
        if let (Shape::Mesh(mesh), Some(_)) = (&shape, body) {
            let note = mesh.fault_as_body(&placement.to_world);
            self.notes.extend(note.map(|note| format!("the mesh \"{name}\" is transparent but {note}")));
            shells = mesh.overlapping_shells();
        }
        if let Some(shells) = &shells {
            let count = shells.len();
            self.notes.push(format!(
                "the mesh \"{name}\" consists of {count} closed shells, of which some touch or overlap: its body is their union"
            ));
        }
        let number = self.objects.len() as u32;
        self.objects.push(Object { name, material, light: None, overlaps_itself: shells.is_some() });
        let shapes = match shells {
            None => vec![shape],
            Some(shells) => shells.into_iter().map(|shell| Shape::Mesh(Arc::new(shell))).collect(),
        };
        let Placement { to_world, motion } = placement;
        for shape in shapes {
            let placed = PlacedShape { shape, to_world, object: number };
            self.shapes.push(AnimatedShape { placed, motion: motion.clone() });
        }
        Ok(number)
    }

    pub fn name(&self, object: u32) -> &str {
        &self.objects[object as usize].name
    }

    /// The middle of the bounding box of all shapes, in m, or the origin if there is none.
    /// Positions relative to it are precise even if the scene is far from the world's origin.
    fn centre(&self) -> DVec3 {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let placed = self.shapes.iter().map(|shape| &shape.placed);
        for (placed, (min, max)) in placed.filter_map(|placed| Some((placed, placed.shape.bounds()?))) {
            for corner in 0..8 {
                let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
                let point = placed.to_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
                low = low.min(point);
                high = high.max(point);
            }
        }
        let middle = 0.5 * (low + high);
        if middle.is_finite() { middle } else { DVec3::ZERO }
    }

    pub(super) fn material_of(&self, object: u32) -> &Material {
        &self.materials[self.objects[object as usize].material]
    }

    /// Builds the faces that only bound a medium (`boundaries`), or those of all surfaces.
    fn build(&self, boundaries: bool, centre: DVec3) -> Result<Geometry> {
        let placed = self.shapes.iter().map(|shape| &shape.placed);
        let of_kind = placed.filter(|placed| self.material_of(placed.object).is_boundary() == boundaries);
        Geometry::build(of_kind.cloned().collect(), centre)
    }
}

/// The camera with its shutter and film.
#[derive(Debug, Clone)]
pub struct SceneView {
    /// The camera when the shutter opens, relative to the scene's centre.
    pub camera: Camera,
    /// The motion of the camera, with positions in m, relative to the scene's centre.
    pub camera_motion: Option<AnimatedLookAt>,
    pub shutter: Shutter,
    /// Must have the camera's width and height in pixels.
    pub film: FilmSpec,
    pub white_balance: WhiteBalance,
    /// The meters, if the camera consists of their sensors.
    pub meters: Vec<Meter>,
}

/// The light that the picture shows as white, which determines [`FilmSpec::white`].
#[derive(Debug, Clone)]
pub enum WhiteBalance {
    /// Leaves [`FilmSpec::white`] as it is.
    None,
    /// All lights of the scene, weighted by their power.
    SceneLights,
    /// A light of this spectrum. Error messages use the name.
    Illuminant(String, Spectrum),
}

/// The part of a scene in which [`SceneBuilder::build`] found an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScenePart {
    Whole,
    Objects,
    /// The emission of the medium with this number.
    MediumEmission(usize),
    Film,
    WhiteBalance,
}

#[derive(Debug, Clone)]
pub struct SceneError {
    pub part: ScenePart,
    pub error: Error,
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        error.error
    }
}

impl ScenePart {
    pub(super) fn error(self, error: Error) -> SceneError {
        SceneError { part: self, error }
    }
}

/// A scene under construction, to which all objects have been added.
#[derive(Debug)]
pub struct SceneBuilder {
    pub title: String,
    pub settings: Settings,
    pub notes: Vec<String>,
    /// See [`crate::Scene::warnings`].
    pub warnings: Vec<String>,
    pub(super) objects: ObjectSet,
    pub(super) centre: DVec3,
    pub(super) geometry: Geometry,
    pub(super) media: Vec<EmittingMedium>,
    pub(super) lights: Vec<Light>,
    pub(super) atmosphere: Option<usize>,
}

/// A medium and the power in W over the band that it must emit, if the scene gives one.
#[derive(Debug)]
pub(super) struct EmittingMedium {
    pub(super) medium: Medium,
    pub(super) power_w: Option<f64>,
}

impl SceneBuilder {
    /// Builds the surfaces of the objects about their middle. Returns an error if a transform is
    /// singular or not finite, a shape has no area, or there are more than 2³² primitives or
    /// vertices.
    pub fn new(objects: ObjectSet) -> Result<Self> {
        let centre = objects.centre();
        Self::about(objects, centre)
    }

    /// Builds the surfaces of the objects about `centre` (in m), with the errors of [`Self::new`].
    pub fn about(mut objects: ObjectSet, centre: DVec3) -> Result<Self> {
        let geometry = objects.build(false, centre)?;
        let [notes, warnings] = [&mut objects.notes, &mut objects.warnings].map(std::mem::take);
        Ok(Self {
            title: "scene".to_owned(),
            settings: Settings::default(),
            notes,
            warnings,
            objects,
            centre,
            geometry,
            media: Vec::new(),
            lights: Vec::new(),
            atmosphere: None,
        })
    }

    /// The scene's centre in the world, in m.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    pub fn objects(&self) -> &ObjectSet {
        &self.objects
    }

    /// The area of an object's surface in m²: 0 if the object only bounds a medium.
    pub fn area_m2(&self, object: u32) -> f64 {
        self.geometry.area(object)
    }

    /// Adds a medium and returns its number, by which bodies refer to it. If `power_w` is given and
    /// the emission is uniform, [`build`](Self::build) scales the emission so that the medium emits
    /// this power in W over the band. Thermal emission is not scaled.
    pub fn add_medium(&mut self, medium: Medium, power_w: Option<f64>) -> usize {
        self.media.push(EmittingMedium { medium, power_w });
        self.media.len() - 1
    }

    /// Fills all space outside of bodies with the medium of this number.
    pub fn set_atmosphere(&mut self, medium: usize) {
        self.atmosphere = Some(medium);
    }

    /// Adds a light, or returns an error if its object does not exist or has no surface.
    pub fn add_light(&mut self, mut light: Light) -> Result<()> {
        if let Some(object) = light.object() {
            if object as usize >= self.objects.objects.len() {
                return Err(Error::input(format!("the light \"{}\" has the object number {object}", light.name))
                    .expected(format!("a number below {}", self.objects.objects.len())));
            }
            let material = self.objects.material_of(object);
            if material.is_boundary() {
                return Err(Error::input(format!("found on \"{}\", which has no surface", material.name))
                    .expected("the medium's own `emission`"));
            }
        }
        if light.is_rotation_invariant() {
            light.motion = None;
        }
        self.lights.push(light);
        Ok(())
    }

    /// Builds the scene: creates the atmosphere, the boundaries of media and the lights of emitting
    /// media, and finds the bounding sphere, the dense media, the distant lights, the white of the
    /// film, and the medium stacks of the camera and the lights.
    ///
    /// Returns an error if the scene has no light, more than 1000 objects are at one place, a body
    /// refers to a medium that does not exist,
    /// an emitting medium has no bounds, emits nothing in the band or is inside a moving body, the
    /// camera and the film have different sizes, or the light of the white balance is too
    /// saturated.
    pub fn build(mut self, view: SceneView) -> std::result::Result<Scene, SceneError> {
        let SceneView { camera, camera_motion, shutter, film, white_balance, meters } = view;
        self.check_numbers(&camera, &film)?;
        self.add_volume_lights(film.observer)?;
        if self.lights.is_empty() {
            let error = Error::input("the scene has no light");
            let error = error.expected("at least one entry in `lights` or an object with `emission`");
            return Err(ScenePart::Whole.error(error));
        }
        let mut radius_m = self.geometry.radius_m();
        if let Some(number) = self.atmosphere {
            let medium = &self.media[number].medium;
            let (name, inner_m) = (medium.name.clone(), self.inner_radius_m(&camera).max(medium.radius_m()));
            radius_m = self.add_atmosphere(&name, number, inner_m);
        }
        self.find_dense_media();
        let boundaries = self.objects.build(true, self.centre).map_err(|error| ScenePart::Objects.error(error))?;
        if self.atmosphere.is_none() && !boundaries.is_empty() {
            radius_m = radius_m.max(boundaries.radius_m());
        }
        let ObjectSet { shapes, objects, materials, .. } = self.objects;
        let shapes = if shapes.iter().any(|shape| shape.motion.is_some()) { shapes.into() } else { Arc::default() };
        let air = RefractiveIndex::constant(1.0).map_err(|error| ScenePart::Whole.error(error))?;
        let mut scene = Scene {
            title: self.title,
            centre: self.centre,
            radius_m,
            camera,
            shutter,
            motions: SceneMotion { shapes, camera: camera_motion },
            film,
            meters,
            geometry: Arc::new(self.geometry),
            boundaries: Arc::new(boundaries),
            body_ranks: Vec::new(),
            objects,
            materials,
            media: self.media.into_iter().map(|EmittingMedium { medium, .. }| medium).collect(),
            lights: self.lights,
            distant_lights: Vec::new(),
            medium_lights: Vec::new(),
            settings: self.settings,
            notes: self.notes,
            warnings: self.warnings,
            air,
        };
        scene.number_fluorophores();
        let swept = scene.swept_boxes();
        scene.radius_m = swept.iter().fold(scene.radius_m, |radius, (low, high)| {
            let farthest_m = low.abs().max(high.abs()).length();
            if farthest_m.is_finite() { radius.max(farthest_m) } else { radius }
        });
        scene.renumber_lights();
        scene.check_copies()?;
        scene.rank_bodies();
        scene.find_medium_stacks();
        scene.check_crystals()?;
        scene.notes.extend(scene.notes_of_touching_bodies());
        if let Some(white) = white(&scene, &white_balance)? {
            scene.film.white = Some(white);
        }
        Ok(scene)
    }

    /// Checks the numbers of media and the size of the film.
    fn check_numbers(&self, camera: &Camera, film: &FilmSpec) -> std::result::Result<(), SceneError> {
        let media = self.media.len();
        let of_bodies = self.objects.materials.iter().filter_map(|material| material.body.as_ref()?.medium);
        if let Some(number) = of_bodies.chain(self.atmosphere).find(|&number| number >= media) {
            let error = Error::input(format!("found the medium number {number}"));
            return Err(ScenePart::Objects.error(error.expected(format!("a number below {media}"))));
        }
        let pixels = u64::from(film.width) * u64::from(film.height);
        if (camera.width() as u64, camera.pixel_count() as u64) != (u64::from(film.width), pixels) {
            let error = Error::input(format!("found a film of {} × {} pixels", film.width, film.height));
            let expected = format!("the camera's {} × {}", camera.width(), camera.pixel_count() / camera.width());
            return Err(ScenePart::Film.error(error.expected(expected)));
        }
        Ok(())
    }

    /// The radius in m of a sphere around the scene's centre that contains all surfaces, the
    /// camera, and the positions of point, spot and beam lights.
    fn inner_radius_m(&self, camera: &Camera) -> f64 {
        let positions = self.lights.iter().filter_map(Light::position);
        let sensors = camera.sensors().iter().filter_map(Sensor::position);
        positions.chain(sensors).chain([camera.origin()]).map(DVec3::length).fold(self.geometry.radius_m(), f64::max)
    }

    /// Adds a sphere of lowest priority, filled with the atmosphere's medium, around the scene,
    /// whose radius is `inner_m`. Returns the radius of the bounding sphere in m.
    fn add_atmosphere(&mut self, name: &str, medium: usize, inner_m: f64) -> f64 {
        /// The radius of the sphere divided by `inner_m`: above 1, so that the camera and the
        /// lights are inside the sphere and not on its surface.
        const MARGIN: f64 = 1.05;
        let radius = MARGIN * inner_m;
        let shape = Shape::Sphere { radius };
        let material = self.objects.add_material(Material::boundary(name, medium, i32::MIN));
        let to_world = DAffine3::from_translation(self.centre);
        let placed = PlacedShape { shape, to_world, object: self.objects.objects.len() as u32 };
        self.objects.shapes.push(AnimatedShape { placed, motion: None });
        self.objects.objects.push(Object {
            name: "atmosphere".to_owned(),
            material,
            light: None,
            overlaps_itself: false,
        });
        radius * (1.0 + 1e-6)
    }

    /// Marks a medium as dense if it is optically thick in at least one of its bodies.
    fn find_dense_media(&mut self) {
        for AnimatedShape { placed, .. } in &self.objects.shapes {
            let medium = self.objects.material_of(placed.object).body.as_ref().and_then(|body| body.medium);
            if let Some((number, (low, high))) = medium.zip(placed.shape.bounds()) {
                let axes = placed.to_world.matrix3;
                let sides = (high - low) * DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
                let medium = &mut self.media[number].medium;
                medium.dense |= medium.is_dense_across(sides.min_element());
            }
        }
    }
}

/// XYZ of the white for the film's observer, or `None` if [`FilmSpec::white`] is not changed.
fn white(scene: &Scene, white_balance: &WhiteBalance) -> std::result::Result<Option<Xyz>, SceneError> {
    let (white, what) = match white_balance {
        WhiteBalance::None => return Ok(None),
        WhiteBalance::SceneLights => (scene.xyz_of_lights(), "the scene's light".to_owned()),
        WhiteBalance::Illuminant(name, spectrum) => (scene.film.observer.xyz(spectrum), format!("\"{name}\"")),
    };
    if !AdaptationTransform::Bradford.can_adapt_from(white) {
        let error = Error::input(format!("{what} has a colour that is too saturated for white balance"));
        return Err(ScenePart::WhiteBalance.error(error.expected("light with red, green and blue components")));
    }
    Ok(Some(white))
}
