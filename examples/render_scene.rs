//! Renders a scene file, prints the progress, and writes an EXR and a PNG file.
//!
//! ```text
//! cargo run --release --example render_scene -- scenes/glass_ball.json out/glass_ball.exr
//! ```
//!
//! Without arguments, the example renders `scenes/glass_ball.json` into the folder for temporary
//! files.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Duration;

use abbe::{RenderOptions, Scene};

fn main() -> abbe::Result<()> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let scene = arguments.next().unwrap_or_else(|| PathBuf::from("scenes/glass_ball.json"));
    let output = arguments.next().unwrap_or_else(|| std::env::temp_dir().join("abbe-render-scene.exr"));

    let scene = Scene::load(scene)?;
    for note in scene.check()? {
        println!("note: {note}");
    }

    // The render stops at the first of three limits: a number of passes, a time, an error.
    let options =
        RenderOptions::default().size(96, 54).photons(50_000).passes(8).time(Duration::from_secs(5)).target_error(0.01);
    let image = scene.render_with(&options, |progress| {
        let seconds = progress.elapsed.as_secs_f64();
        match progress.relative_error {
            Some(error) => println!("{} passes, {seconds:.1} s, error {:.1} %", progress.passes, 100.0 * error),
            None => println!("{} passes, {seconds:.1} s", progress.passes),
        }
        // `ControlFlow::Break(())` would stop the render here.
        ControlFlow::Continue(())
    })?;

    image.write_exr(&output)?;
    image.write_png(output.with_extension("png"))?;
    println!("wrote {} and the PNG file beside it", output.display());
    Ok(())
}
