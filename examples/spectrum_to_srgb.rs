//! Converts spectra to sRGB: a black body, an LED band, and a surface under two lamps.
//!
//! ```text
//! cargo run --release --example spectrum_to_srgb
//! ```

use abbe::{ColourReport, Observer, Spectrum};

fn main() -> abbe::Result<()> {
    let observer = Observer::cie1931();

    let lights = [
        ("black body, 3000 K", Spectrum::blackbody(3000.0)?),
        ("LED band at 530 nm", Spectrum::gaussian(530.0, 35.0)?),
        ("D65 from the library", abbe::spectrum_by_name("D65")?),
    ];
    for (name, spectrum) in &lights {
        let colour = ColourReport::of_light(spectrum, observer)?;
        println!("{name:<22} {}  linear sRGB {:.3?}  xy {:.4?}", colour.srgb_hex, colour.linear_srgb, colour.xy);
    }

    // The colour of a surface depends on the lamp.
    let leaf = abbe::spectrum_by_name("leaf/green")?;
    for lamp in ["D65", "sodium-low-pressure"] {
        let colour = ColourReport::of_reflectance(&leaf, &abbe::spectrum_by_name(lamp)?, observer)?;
        println!("a leaf under {lamp:<20} {}", colour.srgb_hex);
    }
    Ok(())
}
