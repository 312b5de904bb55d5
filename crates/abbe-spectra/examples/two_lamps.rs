//! Compares two lamps: the colours of surfaces, and pairs of surfaces that match under one only.
//!
//! ```text
//! cargo run --release -p abbe-spectra --example two_lamps -- D65 LED-B3
//! ```
//!
//! The arguments are names of the built-in library. Without arguments, the example compares D65
//! with a low-pressure sodium lamp, under which many different colours match.

use abbe_spectra::colour::LampComparison;
use abbe_spectra::spectrum::library;
use abbe_spectra::{Observer, Result};

fn main() -> Result<()> {
    let mut names = std::env::args().skip(1);
    let a = names.next().unwrap_or_else(|| "D65".to_string());
    let b = names.next().unwrap_or_else(|| "sodium-low-pressure".to_string());
    let lamps = [library::find(&a)?.spectrum, library::find(&b)?.spectrum];
    let compared = LampComparison::between([&lamps[0], &lamps[1]], Observer::cie1931())?;

    println!("{}", compared.verdict([&a, &b]));
    println!("ΔE2000 of the lamps themselves: {:.2}", compared.lights.delta_e_2000);
    println!("ΔE2000 of the 24 patches of the ColorChecker, each lamp being its own white point:");
    for patch in &compared.patches {
        println!("  {:<16} {:5.2}", patch.short_name(), patch.delta_e_2000);
    }
    println!("  {:<16} {:5.2}", "mean", compared.mean());

    // Two surfaces that look alike under one lamp and different under the other are metamers.
    println!("{} of {} pairs of surfaces match under one lamp only", compared.pairs.len(), compared.pair_count());
    for pair in compared.pairs.iter().take(5) {
        let [first, second] = compared.surfaces_of(pair).map(|surface| surface.short_name());
        let [under_a, under_b] = pair.delta_e_2000;
        println!("  {first} and {second}: ΔE2000 {under_a:.1} under {a}, {under_b:.1} under {b}");
    }
    Ok(())
}
