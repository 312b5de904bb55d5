//! What planning leaves over: the two inner loops of a box of diffuse walls, as the renderer runs them and written out by hand for just such a box,
//! without a branch for anything that it lacks. Both draw the same random numbers and must find the same light.
//!
//! `cargo bench --bench plain` checks that. To count instructions (figures in `benches/README.md`), run what it built under valgrind:
//! `valgrind --tool=callgrind --callgrind-out-file=/dev/null target/release/deps/plain-… walk general 20000`, the same with `plain`, and both
//! with 0 photons, which is what preparing the scene takes.

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
            assert!(general == plain && general.len() > 3000, "the walk by hand keeps other photons");
            println!("walk: {} photons kept, the same by hand", plain.len());
            let maps = maps();
            let [general, plain] = [gather::general, gather::plain].map(|gather| gather(&prepared, &maps, 2000));
            assert!(
                (general / plain - 1.0).abs() < 1e-12 && general > 0.0,
                "gathered by hand it is other light: {general}, {plain}"
            );
            println!("gather: {general:.6e} in all, the same by hand");
        }
        _ => panic!("walk|gather general|plain COUNT, or nothing"),
    }
}

fn number(word: &str) -> u64 {
    word.parse().expect("a number of photons or pixels")
}
