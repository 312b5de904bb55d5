//! What matter does to light at a point: pure functions of angle, index and wavelength.
//!
//! [`fresnel`] says how much a smooth interface reflects and where it refracts; [`glass`] gives the index n(λ);
//! [`microfacet`] roughens an interface; [`surface`] puts them together into what a surface does to a light path;
//! [`phase`] says where a medium scatters; [`aperture`] bounds light and spreads it; [`lens`] traces rays through lenses of several
//! elements; [`prism`] holds the textbook angles of a prism, to test the rest against.

pub mod aperture;
pub mod fresnel;
pub mod glass;
pub mod lens;
pub mod microfacet;
pub mod phase;
pub mod prism;
pub mod surface;
mod zemax_text;
