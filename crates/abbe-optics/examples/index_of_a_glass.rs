//! Prints the refractive index of a glass at the lines of glass catalogues, and its Abbe number.
//!
//! ```text
//! cargo run --release -p abbe-optics --example index_of_a_glass -- N-SF11
//! ```
//!
//! Without an argument, the glass is N-BK7. An unknown name gives an error that suggests a similar
//! one.

use abbe_optics::glass::{catalogue, lines};
use abbe_spectra::Result;

fn main() -> Result<()> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "N-BK7".to_string());
    let glass = catalogue::find(&name)?;
    let index = &glass.index;
    let (from, to) = index.range_nm();
    println!("{}: {}", glass.name, glass.source);
    println!("the formula is valid from {from:.0} to {to:.0} nm");

    let lines = [
        ("h", lines::H_NM),
        ("g", lines::G_NM),
        ("F", lines::F_NM),
        ("e", lines::E_NM),
        ("d", lines::D_NM),
        ("D", lines::SODIUM_NM),
        ("C", lines::C_NM),
        ("r", lines::R_NM),
    ];
    println!("line       nm         n");
    for (line, nm) in lines {
        // Wavelengths and indices are relative to air, as in glass catalogues.
        println!("   {line} {nm:8.2}  {:.6}", index.n(nm));
    }
    match index.vd() {
        Some(vd) => println!("Abbe number V_d = (n_d − 1)/(n_F − n_C) = {vd:.2}"),
        None => println!("the index is the same at all wavelengths"),
    }
    if let Some(transmittance) = glass.internal_transmittance(lines::G_NM, 0.025) {
        println!("internal transmittance of 25 mm at the g line: {transmittance:.4}");
    }
    Ok(())
}
