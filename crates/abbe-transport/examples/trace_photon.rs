//! Traces one photon of sodium light through a glass ball, and prints every surface that it hits.
//!
//! ```text
//! cargo run --release -p abbe-transport --example trace_photon
//! ```

use abbe_format::{self as format, resolve::resolve};
use abbe_optics::bsdf::TransportMode;
use abbe_scene::geometry::Ray;
use abbe_scene::medium_stack::MediumStack;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::spectrum::Wavelengths;
use abbe_transport::walk::{RayState, SurfaceLookup, next_interaction, scatter};
use glam::DVec3;

const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "N-BK7"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 10, "height": 10}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 2, 0], "radius": 1}}, "material": "glass"}],
  "lights": [{"beam": {"from": [0.5, 5, 0], "to": [0.5, 0, 0], "radius": 0.01,
                       "spectrum": "sodium-low-pressure", "power": 1}}]
}"#;

fn main() -> abbe_spectra::Result<()> {
    let (file, source) = format::parse(SCENE, "ball.json".as_ref(), &[])?;
    let scene = resolve(&file, &source)?;

    // Positions inside the program are relative to the centre of the scene.
    let origin = DVec3::new(0.5, 5.0, 0.0) - scene.centre;
    let mut state = RayState { ray: Ray::new(origin, DVec3::NEG_Y), from: None, medium_stack: MediumStack::AIR };
    let sodium = Wavelengths::single(589.3);
    let mut stream = Stream::new(Seed::new(7), Purpose::FreePhoton, 0, 0);

    let mut hits = Vec::new();
    while let Some(interaction) = next_interaction(&scene, state, SurfaceLookup::of_line(0.0)) {
        let name = scene.objects[interaction.hit.object as usize].name.as_str();
        let point = state.ray.at(interaction.hit.t) + scene.centre;
        println!("hits the {name} at {point:.3} after {:.3} m", interaction.distance_m);
        hits.push(name);
        // Photons transport importance in the sense of Veach: they start at the light.
        let Some(scattered) = scatter(&interaction, &sodium, TransportMode::Importance, &mut stream) else { break };
        if name == "floor" {
            break;
        }
        println!("  leaves in the direction {:.4}", scattered.direction);
        state = interaction.spawn_scattered(&scattered);
    }
    // The photon refracts into the ball, refracts out of it, and ends on the floor.
    assert_eq!(hits, ["ball", "ball", "floor"]);
    Ok(())
}
