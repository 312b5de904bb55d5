//! Reports: figures of glasses, crystals, lenses, films, gratings, spectra and lamps, and results
//! of measurements and studies. The command line prints them as text or as JSON, and the Python
//! package receives the same JSON, so the names and the order of the fields are public. `Option`
//! fields are null in JSON unless their documentation says that they are left out.

pub mod colour;
pub mod crystal;
pub mod film;
pub mod folded_lens;
#[cfg(feature = "pages")]
pub mod folded_plots;
pub mod glass;
pub mod grating;
pub mod lamps;
pub mod lens;
#[cfg(feature = "pages")]
pub mod lens_page;
pub mod lens_plots;
pub mod luminaire;
pub mod measurement;
#[cfg(feature = "pages")]
pub mod measurement_page;
pub mod metal;
pub mod named;
pub mod regression;
pub mod requirements;
#[cfg(feature = "pages")]
pub mod study;
