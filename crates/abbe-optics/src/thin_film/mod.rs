//! Interference in stacks of thin films, and coated plates.
//!
//! The amplitudes follow from the Airy summation, from the last interface to the first (Rouard's
//! recursion; Macleod, *Thin-Film Optical Filters*). All phase factors of the recursion are at most
//! 1, so thick absorbing layers do not overflow.
//!
//! Fields vary as exp(−iωt), so the complex index is n + ik, and k > 0 absorbs. The amplitudes are
//! ratios of electric fields at the outer faces of the stack, and the reflected ones of s and p
//! have opposite signs at normal incidence.

mod airy;
mod clear;
mod plate;
mod stack;

pub use airy::{PolarisedResponse, StackResponse, response};
pub use plate::{CoatedPlate, PlateResponse};
pub use stack::{FilmLayer, FilmStack, OpticalIndex};
