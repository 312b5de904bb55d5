//! Prints the colour values of a lamp: XYZ, chromaticity, colour temperature, CRI and TM-30.
//!
//! ```text
//! cargo run --release -p abbe-spectra --example colour_of_a_spectrum -- FL11
//! cargo run --release -p abbe-spectra --example colour_of_a_spectrum -- lamp.csv
//! ```
//!
//! The argument is a name of the built-in library, or a file with two columns (wavelength in nm and
//! power) or in the format IES TM-27 (`.spdx`). Without an argument, the lamp is the fluorescent
//! lamp FL2.

use abbe_spectra::spectrum::{Outside, library, read};
use abbe_spectra::{ColourReport, Observer, Result, Spectrum};
use std::path::Path;

/// Returns the spectrum of a file, or of the library if no such file exists.
fn lamp(name: &str) -> Result<Spectrum> {
    let path = Path::new(name);
    if path.is_file() { read::spectrum_file(path, Outside::Zero) } else { Ok(library::find(name)?.spectrum) }
}

fn main() -> Result<()> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "FL2".to_string());
    let lamp = lamp(&name)?;
    let colour = ColourReport::of_light(&lamp, Observer::cie1931())?;

    println!("{name}, observer CIE 1931");
    println!("XYZ       {:.2?}", colour.xyz);
    println!("x, y      {:.4?}", colour.xy);
    println!("sRGB      {}", colour.srgb_hex);
    if let Some(efficacy) = colour.efficacy_lm_per_w {
        println!("efficacy  {efficacy:.0} lm/W of the radiation from 360 to 830 nm");
    }
    match colour.temperature {
        Some(found) => println!("CCT       {:.0} K, Duv {:+.4}", found.cct_k, found.duv),
        None => println!("CCT       undefined: the colour is too far from the Planckian locus"),
    }
    if let Some(cri) = &colour.rendering {
        println!("CRI       Ra {:.1}, R9 {:.1}", cri.ra, cri.special[8]);
    }
    if let Some(tm30) = &colour.rendition {
        println!("TM-30     Rf {:.1}, Rg {:.1}", tm30.rf, tm30.rg);
    }
    if let Some(ratio) = colour.melanopic_ratio {
        println!("melanopic daylight efficacy ratio {ratio:.3}");
    }
    Ok(())
}
