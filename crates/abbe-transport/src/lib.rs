//! Spectral light transport of the renderer Abbe: one pass of photon mapping, and the plan that
//! decides which effects are simulated.
//!
//! A pass emits photons with real wavelengths, stores them, and gathers them along camera paths.
//! Passes are independent of each other, so they can run in any order and on any machine.
//! Everything that adapts to a scene is decided by the [`plan`] and by the pilot before the first
//! pass.
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
//! # Modules
//!
//! | module | content |
//! | --- | --- |
//! | [`plan`] | effects, the partition of light paths among estimators, the budget |
//! | [`walk`] | path segments, scattering and transmittance, for photons and camera paths |
//! | [`emit`] | photon emission and photon paths |
//! | [`map`] | photon maps, kernels, radii |
//! | [`gather`] | camera paths, direct light, density estimation, the path tracer |
//! | [`sensor`] | film sums, error bars, exposure, development |
//! | [`pass`] | one pass, and the pilot |
//!
//! # Units and conventions
//!
//! Lengths are in m, wavelengths in nm, power in W and radiance in W/m²/sr. Photons are stored in
//! `f32` relative to the centre of the scene. At a scattering event, `wo` and `wi` point away from
//! the surface. Transport handles light by wavelength only: just [`sensor`] knows XYZ and RGB.
//!
//! # Dependencies
//!
//! [`abbe_scene`] is the model that a pass reads, [`abbe_optics`] scatters, and [`abbe_spectra`]
//! supplies spectra, random streams and exact sums.

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
