//! Participating media along a camera path, which attenuate the light from behind, emit light, and
//! scatter light into the path: direct light at one sampled distance per light, or with a light
//! map, and all other light from the photons near the ray.

mod direct;
mod distance;
mod mapped_lights;
mod photons;
mod segment;
