//! Renders eight passes of a scene that is built in code, and prints a pixel with its error bar.
//!
//! ```text
//! cargo run --release -p abbe-session --example error_bar
//! ```

use abbe_optics::bsdf::Bsdf;
use abbe_scene::builder::{ObjectSet, SceneBuilder, SceneView, WhiteBalance};
use abbe_scene::camera::{Aperture, Camera, Shutter, look_at_axes};
use abbe_scene::geometry::shape::Shape;
use abbe_scene::light::{Emitter, Light, LightSpectrum, PointLight};
use abbe_scene::{FilmSpec, Material, Scene};
use abbe_session::render::{Integrator, Job, NoMonitor, Request, StopRules};
use abbe_spectra::{Observer, Result, Spectrum};
use glam::{DAffine3, DVec3};

/// Returns a grey floor of 4 m × 4 m under an incandescent point light.
fn scene() -> Result<Scene> {
    let mut objects = ObjectSet::default();
    let surface = Bsdf::diffuse(Spectrum::constant(0.5))?;
    let grey = objects.add_material(Material { name: "grey".into(), surface, normal_map: None, body: None });
    objects.add_object("floor", grey, Shape::Rectangle { width: 4.0, height: 4.0 }, DAffine3::IDENTITY)?;
    let mut builder = SceneBuilder::new(objects)?;
    builder.settings.photons = Some(10_000);
    let centre = builder.centre();
    let (observer, width, height) = (Observer::cie1931(), 16, 12);
    let film = FilmSpec::new(width, height, observer);
    let lamp = PointLight { position: DVec3::new(1.0, 3.0, 0.0) - centre, intensity: 10.0 };
    let spectrum = LightSpectrum::new(&Spectrum::blackbody(2856.0)?);
    builder.add_light(Light::new("lamp".into(), Emitter::Point(lamp), &spectrum, observer)?)?;
    let origin = DVec3::new(0.0, 1.5, 4.0) - centre;
    let camera = Camera::new(origin, look_at_axes(-origin, DVec3::Y), 0.4, (width, height), Aperture::Pinhole);
    let (shutter, white_balance) = (Shutter::new(0.0, 0.0, None), WhiteBalance::None);
    let view = SceneView { camera, camera_motion: None, shutter, film, white_balance, meters: Vec::new() };
    Ok(builder.build(view)?)
}

fn main() -> Result<()> {
    let job = Job::new(scene()?)?;
    // Eight replicates share no random numbers, so the noise is known after eight passes.
    let stop = StopRules { passes: Some(8), ..StopRules::default() };
    let rendered = job.render(Request { integrator: Integrator::default(), stop }, &mut NoMonitor)?;
    let picture = &rendered.picture;
    let pixel = picture.width * (picture.height / 2) + picture.width / 2;
    let luminance = picture.xyz[pixel][1];
    match picture.half_interval_95(pixel, 0.0) {
        Some(half) => println!("luminance in the middle: {luminance:.3} ± {half:.3} cd/m² (95 %)"),
        None => println!("luminance in the middle: {luminance:.3} cd/m², error unknown"),
    }
    println!("{} passes, {} photons", rendered.stats.passes, rendered.stats.photons_emitted);
    Ok(())
}
