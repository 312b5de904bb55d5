//! The cost of generality in the two inner loops.
//!
//! The scene is a box of diffuse walls. Each inner loop runs twice: as the renderer runs it, and
//! written by hand for such a box, without any branch for features that the box lacks. Both
//! versions use the same random numbers and must compute the same light.
//!
//! `cargo bench --bench plain` checks that both versions agree. To count instructions, run the
//! built executable under valgrind: `valgrind --tool=callgrind --callgrind-out-file=/dev/null
//! target/release/deps/plain-… walk general 20000`, then the same with `plain`. Run both with 0
//! photons too, which gives the cost of preparing the scene. The measured counts are in
//! `benches/README.md`.

mod gather;
#[path = "../stages/scenes.rs"]
mod scenes;
mod walk;

use scenes::Prepared;
use std::hint::black_box;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let prepared = Prepared::new("s3_box.json");
    let maps = || prepared.harvest(20_000).maps();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["walk", "general", count] => drop(black_box(walk::general(&prepared, number(count)))),
        ["walk", "plain", count] => drop(black_box(walk::plain(&prepared, number(count)))),
        ["gather", "general", count] => drop(black_box(gather::general(&prepared, &maps(), number(count)))),
        ["gather", "plain", count] => drop(black_box(gather::plain(&prepared, &maps(), number(count)))),
        [] => {
            let [general, plain] = [walk::general, walk::plain].map(|walk| walk(&prepared, 5000));
            assert!(general == plain && general.len() > 3000, "the two walks store different photons");
            println!("walk: both versions store the same {} photons", plain.len());
            let maps = maps();
            let [general, plain] = [gather::general, gather::plain].map(|gather| gather(&prepared, &maps, 2000));
            assert!(
                (general / plain - 1.0).abs() < 1e-12 && general > 0.0,
                "the two versions gather different light: {general}, {plain}"
            );
            println!("gather: both versions gather the radiance sum {general:.6e}");
        }
        _ => panic!("expected the arguments walk|gather general|plain COUNT, or no arguments"),
    }
}

fn number(word: &str) -> u64 {
    word.parse().expect("COUNT is a number of photons or pixels")
}
