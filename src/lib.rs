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
//! [`Scene`] loads a scene from a file, from text, or from the structs of [`mod@format`].
//! [`RenderOptions`] contains the stop rules of the render, and overrides settings of the scene.
//! [`Image`] contains the pixels and their error bars. The folder `examples/` of the source code
//! shows more: progress and cancellation, scenes without JSON, colours of spectra, error bars, the
//! path of a single photon.
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
//! (Jensen 1996). Passes are independent of each other, and their kernels shrink from pass to pass
//! (Knaus & Zwicker 2011). Passes can therefore run on different machines in any order, and their
//! results can be merged.
//!
//! # Modules
//!
//! Each module may import only modules above it in this list. A test checks the exact order.
//!
//! | module | content |
//! | --- | --- |
//! | `error` | the error type |
//! | `math` | random streams, sampling, quadrature |
//! | `spectrum` | functions of wavelength, observers, the library of spectra |
//! | `colour` | XYZ, RGB, colour differences, colour rendering |
//! | `optics` | glass, BSDFs, phase functions, lenses |
//! | `geometry` | shapes, meshes, the bounding volume hierarchy |
//! | `scene` | the resolved scene: cameras, lights, media, motion |
//! | `json` | strict JSON with line, column and path of every value |
//! | `format` | the scene file, and its resolution into a scene |
//! | `plan` | the decision which effects are simulated, with reasons |
//! | `walk` | path segments, scattering, transmittance |
//! | `map` | photon maps, kernels, radii |
//! | `emit` | photon emission and photon paths |
//! | `gather` | camera paths, direct light, photon density estimates, the path tracer |
//! | `sensor` | film sums, noise and bias, exposure, development |
//! | `output` | EXR and PNG files, comparisons, plots, pages |
//! | `pass` | the transport of one pass: the pilot, photon recording, camera samples |
//! | `render` | a render of many passes: stop rules, forecasts, checkpoints, merging |
//! | `study` | error against time (feature `pages`) |
//! | `api` | the items of this page |
//! | `view` | the live view in the browser (feature `view`) |
//! | `cli` | the `abbe` program (feature `cli`) |
//! | `python` | the native module of the Python package (feature `python`) |
//!
//! Only the items of this page are public interface. The modules are visible to the tests and
//! benchmarks of this package, and they may change in every release.
//!
//! # Units and conventions
//!
//! Lengths in a scene file are in the file's `unit`. The default unit is the metre. Inside the
//! program, positions are relative to the centre of the scene. Lengths are in m, wavelengths in nm,
//! power in W and radiance in W/m²/sr. Power covers the band 360–830 nm. The Y of a picture is in
//! cd/m². Stored directions point in the direction in which light travels. At a scattering event,
//! `wo` and `wi` point away from the surface. Geometry is computed in `f64`, and photons are stored
//! in `f32`.
//!
//! # Scope and simplifications
//!
//! Abbe simulates the geometrical optics of unpolarised light. Diffraction is simulated only at the
//! camera's aperture. Abbe does not simulate polarisation. Surfaces and media may be fluorescent,
//! and light from 300 nm on excites them. Abbe simulates surfaces, homogeneous and heterogeneous
//! scattering media, and glowing media. All rays and photons of a pass share one shutter time, so
//! nothing moves during a pass. The mean over the passes contains the motion blur.
//!
//! # Features
//!
//! | feature | default | content |
//! | --- | --- | --- |
//! | `cli` | yes | the `abbe` program; implies `pages` |
//! | `pages` | | HTML pages that compare pictures or lamps, and studies of accuracy |
//! | `view` | yes | the live view in the browser (`abbe view`); implies `cli` |
//! | `meshes` | yes | OBJ, PLY, STL and glTF files |
//! | `python` | | the native module of the Python package in `python/`; implies `cli` and `meshes` |
//!
//! To use the renderer without the command line, depend on it as
//! `abbe = { version = "…", default-features = false }`.

// Elementary functions of the C library differ between machines; see `math::elementary`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod api;
#[cfg(feature = "cli")]
pub mod cli;
pub mod reports;
#[cfg(feature = "pages")]
pub mod study;
#[cfg(feature = "view")]
pub mod view;

pub use abbe_format as format;
pub use abbe_session::render::{ErrorMilestone, Forecast, Integrator, Progress, Stats};
pub use abbe_spectra::colour::ColourReport;
pub use abbe_spectra::{Error, ErrorKind, ErrorLocation, Observer, Result, Spectrum};
pub use api::{Image, PixelSpectrum, RenderOptions, Scene};

/// Returns a spectrum of the built-in library, such as `D65`. `abbe spectrum --list` prints all
/// names. Letter case does not matter.
///
/// # Errors
/// Returns an error if the name is unknown. If a similar name exists, the error suggests it.
pub fn spectrum_by_name(name: &str) -> Result<Spectrum> {
    Ok(abbe_spectra::spectrum::library::find(name)?.spectrum)
}
