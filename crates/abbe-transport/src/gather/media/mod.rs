//! Participating media along a camera path.
//!
//! A medium attenuates the light from behind the medium, emits light, and scatters light into the
//! path. Direct light that a medium scatters is computed at one sampled distance per light, or with
//! a light map. Photons near the ray carry all other scattered light: light that came through glass
//! or from mirrors, and light that was scattered before.

mod direct;
mod distance;
mod mapped_lights;
mod photons;
mod segment;
