//! Abbe is a spectral photon-mapping renderer: light as it goes through prisms, lenses and real lamps, with numbers that can be
//! checked and a picture that says how wrong it may be.
//!
//! # The way of a picture
//!
//! ```text
//! scene.json ─► SceneFile ─► Scene ─► Facts ─► Plan        what was written → what it means → what it calls for
//!                                               │
//!    for each pass:                             ▼
//!      emit    lights ─► photons, each with its wavelengths and power
//!      map     photons ─► kd-trees
//!      gather  camera ray ─► spectral radiance at each pixel
//!      sensor  × colour-matching functions ─► XYZ sums, noise and bias
//!    develop ─► EXR + PNG + report
//! ```
//!
//! The modules, in the order in which one may import another: [`math`], [`spectrum`], then [`colour`] and [`optics`], [`scene`], [`plan`],
//! [`walk`], [`map`], then [`emit`] and [`gather`] (which do not know each other), [`render`], [`study`]; beside them [`sensor`] and [`output`]
//! behind `colour`; `cli` sees all. A test checks it.
//!
//! # Units and conventions
//!
//! Lengths in m relative to the scene's centre, wavelengths in nm, power in W over the band 360–830 nm, radiance in W/m²/sr. A picture's Y is in cd/m².
//! Stored directions point the way light travels; at a scattering event `wo` and `wi` point away from the surface. Geometry is
//! `f64`, stored photons are `f32`.
//!
//! # Scope and simplifications
//!
//! Geometrical optics of unpolarised light: no interference, no fluorescence. Time is frozen for each pass: all its rays and photons see the scene
//! at one moment while the shutter is open, and the mean over passes is the motion's blur. Surfaces and homogeneous absorbing bodies; scattering media and
//! textures are not simulated yet, and a scene that asks for them is refused.
//!
//! # Follow one photon
//!
//! A sodium photon from a beam through a glass ball: it refracts twice, as Snell says, and ends on the floor.
//!
//! ```
//! use abbe::math::random::{Purpose, Stream};
//! use abbe::optics::surface::Transport;
//! use abbe::scene::{file, geometry::Ray, interior::Interior, resolve::resolve};
//! use abbe::spectrum::Wavelengths;
//! use abbe::walk::{Start, next, scatter};
//! use glam::DVec3;
//!
//! let text = r#"{
//!   "camera": {"from": [0, 2, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
//!   "film": {"width": 8, "height": 8},
//!   "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "N-BK7"}}},
//!   "objects": [
//!     {"name": "floor", "shape": {"rectangle": {"width": 10, "height": 10}}, "material": "grey"},
//!     {"name": "ball", "shape": {"sphere": {"center": [0, 2, 0], "radius": 1}}, "material": "glass"}],
//!   "lights": [{"beam": {"from": [0.5, 5, 0], "to": [0.5, 0, 0], "radius": 0.01, "spectrum": "sodium-low-pressure", "power": 1}}]
//! }"#;
//! let (written, source) = file::parse(text, "ball.json".as_ref(), &[])?;
//! let scene = resolve(&written, &source)?;
//!
//! let origin = DVec3::new(0.5, 5.0, 0.0) - scene.centre;
//! let mut start = Start { ray: Ray::new(origin, DVec3::NEG_Y), from: None, interior: Interior::AIR };
//! let sodium = Wavelengths::single(589.3);
//! let mut stream = Stream::new(7, Purpose::FreePhoton, 0, 0);
//! let mut met = Vec::new();
//! while let Some(encounter) = next(&scene, start, 0.0) {
//!     met.push(scene.objects[encounter.hit.object as usize].name.clone());
//!     let Some(scattered) = scatter(&encounter, &sodium, Transport::Importance, &mut stream) else { break };
//!     if met.last().is_some_and(|name| name == "floor") { break }
//!     start = encounter.after(&scattered);
//! }
//! assert_eq!(met, ["ball", "ball", "floor"]);
//! # Ok::<(), abbe::error::Error>(())
//! ```

pub mod colour;
pub mod emit;
pub mod error;
pub mod gather;
pub mod map;
pub mod math;
pub mod optics;
pub mod output;
pub mod plan;
pub mod render;
pub mod scene;
pub mod sensor;
pub mod spectrum;
pub mod study;
pub mod walk;
