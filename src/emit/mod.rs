//! Lights → photons: which light, which wavelengths, which way; then from surface to surface until the photon's end.

mod aim;
mod choice;
pub mod connect;
mod drift;
mod photon;

pub use aim::{Aim, CELLS};
pub use choice::LightChoice;
pub use drift::{Collision, Crossing};
pub use photon::{Arrival, Emitters, Receiver, Wavelengthed, trace};
