//! Abbe is a spectral photon-mapping renderer. It simulates how light passes through prisms,
//! lenses, fog and real lamps, and it reports the noise and the bias of every pixel.
//!
//! # Render a scene
//!
//! ```
//! use abbe::{RenderOptions, Scene};
//!
//! let scene = Scene::load("scenes/glass_ball.json")?;
//! let image = scene.render(&RenderOptions::default().size(32, 18).passes(2).photons(10_000))?;
//!
//! let (x, y) = (16, 9);
//! println!("luminance: {:.3} cd/m²", image.xyz(x, y)[1]);
//! match image.half_interval_95(x, y) {
//!     Some(half) => println!("95 % confidence: ± {half:.3} cd/m²"),
//!     None => println!("the error of this pixel is unknown"),
//! }
//! # let folder = std::env::temp_dir().join(format!("abbe-front-page-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder).unwrap();
//! # let file = |name: &str| folder.join(name);
//! # /*
//! image.write_exr("glass_ball.exr")?;
//! image.write_png("glass_ball.png")?;
//! # */
//! # image.write_exr(file("glass_ball.exr"))?;
//! # image.write_png(file("glass_ball.png"))?;
//! # std::fs::remove_dir_all(&folder).unwrap();
//! # Ok::<(), abbe::Error>(())
//! ```
//!
//! [`Scene`] loads a scene from a file, from text, or from the structs of [`mod@format`], and
//! [`RenderOptions`] says when the render stops and which settings of the scene it overrides. The
//! resulting [`Image`] contains the pixels and their error bars. The programs in `examples/` show
//! more: progress and cancellation, scenes without JSON, colours of spectra, and error bars. Each
//! crate has examples too, such as the path of a single photon in `crates/abbe-transport/examples`.
//!
//! # How a picture is computed
//!
//! ```text
//! scene.json ──► SceneFile ──► Scene ──► Facts ──► Plan
//!   parse          resolve       examine    decide which effects are simulated
//!
//! pilot            choose photon counts, first radii and aims
//! for each pass:
//!   emit           lights ──► photons with wavelengths and power
//!   map            photons ──► kd-trees
//!   gather         camera ray ──► spectral radiance of each pixel
//!   sensor         spectral radiance × colour-matching functions ──► sums of XYZ, noise, bias
//! develop          sums ──► EXR, PNG and statistics
//! ```
//!
//! Photon mapping computes caustics and indirect light, and camera rays compute direct light
//! (Jensen 1996). The passes are independent of each other, and their kernels shrink from pass to
//! pass (Knaus & Zwicker 2011), so different machines can render passes in any order and merge the
//! results.
//!
//! # Crates
//!
//! The source is a workspace, and each crate of it may depend only on crates above it in this list.
//! Programs that need only spectra, colour or optics can use the first two crates without the
//! renderer.
//!
//! | crate | content |
//! | --- | --- |
//! | [`abbe_spectra`] | the error type, random streams and quadrature, spectra and observers, colour |
//! | [`abbe_optics`] | glasses, lenses, gratings, thin films, BSDFs and phase functions |
//! | `abbe_polarisation` | Stokes vectors, Mueller matrices, crystals; not yet in pictures |
//! | [`abbe_scene`] | the resolved scene: shapes, cameras, lights, media, motion |
//! | `abbe_denoise` | the statistical denoiser |
//! | [`abbe_transport`] | the plan, photon emission, photon maps, camera paths, film sums |
//! | [`abbe_format`] | the scene file: strict JSON, the schema, and the resolution into a scene |
//! | [`abbe_session`] | renders of many passes, checkpoints and merging; EXR, PNG and HTML files |
//! | `abbe_import` | scenes of glTF, Mitsuba and pbrt |
//! | `abbe` | this crate: the public interface, reports, studies, the live view, the `abbe` program |
//! | `abbe_python` | the native module of the Python package, in `python/` |
//! | `abbe_web` | the WebAssembly module of the page in the browser, in `web/` |
//!
//! Only the items of this page are public interface. The modules of this crate, and those of the
//! other crates as far as this page does not name them, are visible to the tests, the benchmarks
//! and the Python package. They may change in every release.
//!
//! # Units and conventions
//!
//! Lengths in a scene file are in the file's `unit`, which is the metre by default. Inside the
//! program, positions are relative to the centre of the scene, lengths are in m, wavelengths in nm,
//! power in W and radiance in W/m²/sr. Power covers the band 360–830 nm, and the Y of a picture is
//! in cd/m². Stored directions point in the direction in which light travels, except that `wo` and
//! `wi` point away from the surface at a scattering event. Geometry is computed in `f64`, and
//! photons are stored in `f32`.
//!
//! # Scope and simplifications
//!
//! Abbe simulates the geometrical optics of unpolarised light. Wave optics is simulated where it
//! decides what a picture shows: as interference in thin films, and as diffraction at gratings and
//! at the camera's aperture. Every surface treats the arriving light as unpolarised.
//!
//! Surfaces and media may be fluorescent, in which case light from 300 nm on excites them. Media
//! may be homogeneous or heterogeneous, and they may glow. All rays and photons of a pass share one
//! shutter time, so nothing moves during a pass, and the mean over the passes contains the motion
//! blur.
//!
//! # Features
//!
//! | feature | default | content |
//! | --- | --- | --- |
//! | `cli` | yes | the `abbe` program; implies `pages` |
//! | `pages` | | HTML pages that compare pictures or lamps, and studies of accuracy |
//! | `view` | yes | the live view in the browser (`abbe view`); implies `cli` |
//! | `files` | yes | the other files that a scene names; without it, such a scene is an error |
//! | `meshes` | yes | OBJ, PLY, STL and glTF files, and scenes of other programs; implies `files` |
//! | `gems` | yes | gem designs of GemCad and Gem Cut Studio; implies `meshes` |
//!
//! To use the renderer without the command line, depend on it as `abbe = { version = "…",
//! default-features = false, features = ["files"] }`.

#![warn(missing_docs)]
// Elementary functions of the C library differ between machines; see `math::elementary`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod api;
#[cfg(feature = "cli")]
#[allow(missing_docs, reason = "no public interface")]
pub mod cli;
#[cfg(feature = "page")]
#[allow(missing_docs, reason = "no public interface")]
pub mod page;
#[allow(missing_docs, reason = "no public interface")]
pub mod reports;
#[cfg(feature = "pages")]
#[allow(missing_docs, reason = "no public interface")]
pub mod study;
#[cfg(feature = "view")]
#[allow(missing_docs, reason = "no public interface")]
pub mod view;

pub use abbe_format as format;
pub use abbe_session::render::{ErrorMilestone, Forecast, Integrator, Progress, Stats};
pub use abbe_spectra::colour::ColourReport;
pub use abbe_spectra::{Error, ErrorKind, ErrorLocation, Observer, Result, Spectrum};
pub use api::{Image, PixelSpectrum, RenderOptions, Scene};

/// Returns a spectrum of the built-in library, such as `D65`. `abbe spectrum --list` prints all
/// names. Letter case does not matter. Returns an error if the name is unknown. If a similar name
/// exists, the error suggests it.
pub fn spectrum_by_name(name: &str) -> Result<Spectrum> {
    Ok(abbe_spectra::spectrum::library::find(name)?.spectrum)
}
