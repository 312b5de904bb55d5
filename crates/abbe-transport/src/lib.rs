//! Spectral light transport of the renderer Abbe: the plan that decides which effects are
//! simulated, the pilot that measures a scene, one pass of photon mapping, and the sensor that sums
//! the passes.
//!
//! A pass traces photons with real wavelengths. It connects some of them to the camera, stores
//! others, and gathers the stored ones along camera paths. Passes are independent of each other, so
//! they can run in any order and on any machine. Everything that adapts to a scene is decided by
//! the [`plan`] and by the [`pilot`] before the first pass.
//!
//! ```
//! use abbe_format::{parse, resolve::resolve};
//! use abbe_transport::plan::prepare;
//!
//! let text = r#"{"camera": {"from": [0, 0, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
//!   "film": {"width": 8, "height": 8}, "materials": {"glass": {"dielectric": {"ior": "N-BK7"}}},
//!   "objects": [{"name": "ball", "shape": {"sphere": {"radius": 1}}, "material": "glass"}],
//!   "lights": [{"environment": {"spectrum": "D65", "illuminance": 1000}}]}"#;
//! let (file, source) = parse(text, "ball.json".as_ref(), &[])?;
//! let (_plan, effects) = prepare(&mut resolve(&file, &source)?)?;
//! assert!(!effects.is_empty(), "each effect is listed with the reason why it is on or off");
//! # Ok::<(), abbe_spectra::Error>(())
//! ```
//!
//! `examples/trace_photon.rs` follows one photon through a glass ball.
//!
//! To add an effect to the plan, follow the recipe in `CONTRIBUTING.md`. By other recipes there, a
//! new material or phase function is a file of `abbe-optics`, and a new light is a file of
//! `abbe-scene`. Of these, only a material that refracts with dispersion or fluoresces changes this
//! crate.
//!
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`plan`] | effects, estimators of light paths, the budget of passes, photons and memory |
//! | [`walk`] | path segments, scattering and transmittance, for photons and camera paths |
//! | [`emit`] | photons: emission, the path through the scene, the connection to the camera |
//! | [`map`] | photon maps, kernels, radii, maps of direct light in media |
//! | [`gather`] | camera paths, direct light, density estimation, the path tracer |
//! | [`sensor`] | film sums, error bars, exposure, development |
//! | [`pass`] | one pass, of photon mapping or of the path tracer |
//! | [`pilot`] | measurements before pass 0: kernel radii, emission distributions, sample counts |
//! | [`photon_paths`] | photon paths with their vertices, for drawings |
//!
//! # Units and conventions
//!
//! Lengths are in m, wavelengths in nm, power in W and radiance in W/m²/sr. Photons are stored in
//! `f32` relative to the centre of the scene. At a scattering event, `wo` points back along the
//! path and `wi` along its continuation, so both point away from the surface. Transport computes
//! with wavelengths, and [`sensor`] converts the results to XYZ and RGB. The trial of the pilot
//! reads XYZ from the sensor, to weigh the noise.
//!
//! # Dependencies
//!
//! [`abbe_scene`] is the model that a pass reads, [`abbe_optics`] supplies the scattering
//! functions, and [`abbe_spectra`] supplies spectra, random streams and exact sums. The film
//! prepares the samples of [`abbe_denoise`]. The crates that depend on this one are `abbe-session`,
//! which repeats passes until a render is complete, and `abbe`, the program.

// Elementary functions of the C library differ between machines; see `math::elementary`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod emit;
pub mod gather;
pub mod map;
pub mod pass;
pub mod photon_paths;
pub mod pilot;
pub mod plan;
pub mod sensor;
pub mod walk;
