//! Prints the colours of thin films in daylight: a soap film in air, and oil on water.
//!
//! ```text
//! cargo run --release -p abbe-optics --example film_colours -- 45
//! ```
//!
//! The argument is the angle of incidence in degrees. Without an argument, light arrives at normal
//! incidence.

use abbe_optics::glass::RefractiveIndex;
use abbe_optics::texture::SurfaceScalar;
use abbe_optics::thin_film::{FilmLayer, FilmStack, OpticalIndex};
use abbe_spectra::spectrum::{Outside, library};
use abbe_spectra::{ColourReport, Observer, Result, Spectrum};

/// Returns the reflectance, from 360 to 830 nm, of a film between air and a substrate.
fn reflectance(film: &RefractiveIndex, thickness_nm: f64, substrate: &RefractiveIndex, cos: f64) -> Result<Spectrum> {
    let thickness = SurfaceScalar::Uniform(thickness_nm);
    let layer = FilmLayer { index: OpticalIndex::Transparent(film.clone()), thickness_nm: thickness };
    let stack = FilmStack::new(vec![layer])?;
    let nm: Vec<f64> = (360..=830).map(f64::from).collect();
    let of = |&nm: &f64| stack.response(cos, 1.0, substrate.n(nm).into(), nm, thickness_nm).reflectance();
    let values: Vec<f64> = nm.iter().map(of).collect();
    Spectrum::table(&nm, &values, Outside::Hold)
}

fn main() -> Result<()> {
    let degrees: f64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(0.0);
    let cos = degrees.to_radians().cos();
    let air = RefractiveIndex::constant(1.0)?;
    let water = RefractiveIndex::catalogue("water 20C")?;
    let oil = RefractiveIndex::constant(1.47)?;
    let daylight = library::find("D65")?.spectrum;

    println!("angle of incidence {degrees}°");
    for (name, film, substrate) in [("soap film in air", &water, &air), ("oil on water", &oil, &water)] {
        println!("{name}\n  thickness  colour   x, y              R at 550 nm");
        for thickness_nm in (0..=800).step_by(100).map(f64::from) {
            let film = reflectance(film, thickness_nm, substrate, cos)?;
            let colour = ColourReport::of_reflectance(&film, &daylight, Observer::cie1931())?;
            let reflected = 100.0 * film.at(550.0);
            println!("  {thickness_nm:6} nm  {}  {:.4?}  {reflected:5.2} %", colour.srgb_hex, colour.xy);
        }
    }
    Ok(())
}
