//! A photon's hit, connected to the camera: light tracing, without a kernel and so without bias.

use super::photon::Arrival;
use crate::math::random::hash64;
use crate::optics::surface::Transport;
use crate::plan::BetweenPlan;
use crate::scene::Scene;
use crate::spectrum::{LANES, Lanes};
use crate::walk::{passages, passes};

/// What a connected photon adds to one pixel.
#[derive(Debug, Clone, Copy)]
pub struct Splat {
    /// The pixel.
    pub pixel: u32,
    /// Radiance (W/m²/sr) per wavelength of the photon, already divided by all densities.
    pub radiance: Lanes,
}

/// Connects the photon's hit to the camera through the place of the aperture that `lens` draws; `None` if the camera does not see it.
pub fn connect(scene: &Scene, between: BetweenPlan, arrival: &Arrival<'_>, lens: [f64; 2]) -> Option<Splat> {
    let encounter = arrival.encounter;
    let sighting = scene.camera.sight(encounter.hit.position, lens)?;
    let to_camera = encounter.frame.to_local(sighting.direction);
    let to_light = encounter.wo;
    let sides = encounter.sides_towards(sighting.direction);
    let geometry =
        to_camera.z.abs() * encounter.adjoint_correction(arrival.to_light(), sighting.direction) * sighting.importance;
    let mut radiance = [0.0; LANES];
    let mut any = false;
    for (k, &nm) in arrival.wavelengths.active().iter().enumerate() {
        let f = encounter.surface.eval(to_camera, to_light, sides, Transport::Radiance, nm);
        radiance[k] = f * arrival.power[k] * geometry;
        any |= radiance[k] > 0.0;
    }
    if !(any && encounter.sees(scene, sighting.direction, sighting.distance, None)) {
        return None;
    }
    if !between.is_clear() {
        let start = encounter.leave(sighting.direction, encounter.interior_towards(sighting.direction));
        let seed = hash64([u64::from(sighting.pixel), lens[0].to_bits()]);
        let through = passages(scene, start, sighting.distance, seed);
        let active = arrival.wavelengths.active().iter().zip(&mut radiance);
        active.for_each(|(&nm, radiance)| *radiance *= passes(&through, nm));
    }
    Some(Splat { pixel: sighting.pixel, radiance })
}
