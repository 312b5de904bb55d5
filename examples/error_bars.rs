//! Reads the error bars of a picture, and prints its worst pixels.
//!
//! ```text
//! cargo run --release --example error_bars -- out/glass_ball.exr
//! ```
//!
//! Without an argument, the example renders a small picture first.

use abbe::{Image, RenderOptions, Scene};

fn main() -> abbe::Result<()> {
    let image = match std::env::args_os().nth(1) {
        Some(path) => Image::read_exr(path)?,
        None => {
            // The noise is known after eight passes: it comes from eight independent replicates.
            let options = RenderOptions::default().size(48, 27).photons(20_000).passes(8);
            Scene::load("scenes/glass_ball.json")?.render(&options)?
        }
    };

    match image.relative_error() {
        Some(error) => println!("relative error of the picture: {:.2} %", 100.0 * error),
        None => println!("the error of the picture is unknown"),
    }

    let pixels = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    let (known, unknown): (Vec<_>, Vec<_>) =
        pixels.map(|(x, y)| (x, y, image.half_interval_95(x, y))).partition(|(_, _, half)| half.is_some());
    println!("pixels with unknown error: {}", unknown.len());

    let mut worst: Vec<(f64, usize, usize)> =
        known.into_iter().filter_map(|(x, y, half)| Some((half?, x, y))).collect();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("   x    y        Y    noise     bias   95 % interval, all in cd/m²");
    for (half, x, y) in worst.into_iter().take(5) {
        let luminance = image.xyz(x, y)[1];
        let [noise, bias] = [image.noise(x, y), image.bias(x, y)].map(|value| value.unwrap_or(f64::NAN));
        let edge = if image.is_near_edge(x, y) == Some(true) { "  (near an edge of light)" } else { "" };
        println!("{x:>4} {y:>4} {luminance:>8.3} {noise:>8.4} {bias:>8.4}   ± {half:.4}{edge}");
    }
    Ok(())
}
