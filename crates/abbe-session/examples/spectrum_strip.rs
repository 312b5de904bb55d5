//! Writes a spectrum from 380 to 700 nm as two PNG files: with the gamut mapping `desaturate`, and
//! with `compress`, which the renderer uses by default. The default folder is `target`.
//!
//! ```sh
//! cargo run --release -p abbe-session --example spectrum_strip -- FOLDER
//! ```
//!
//! Each band has equal energy at all wavelengths. The exposure doubles from one band to the next.

use std::path::PathBuf;

use abbe_session::output::png;
use abbe_spectra::colour::gamut::GamutMapping;
use abbe_spectra::{Observer, Result};
use abbe_transport::sensor::{Development, Picture, develop};

const WIDTH: usize = 1280;
const BAND_HEIGHT: usize = 60;

/// The luminances at the brightest wavelength, relative to white.
const BRIGHTEST: [f64; 4] = [0.125, 0.25, 0.5, 1.0];

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "target".to_string()));
    let mut picture = Picture::black(WIDTH, BAND_HEIGHT * BRIGHTEST.len());
    for (pixel, xyz) in picture.xyz.iter_mut().enumerate() {
        let nm = 380.0 + 320.0 * (pixel % WIDTH) as f64 / (WIDTH - 1) as f64;
        let brightest = BRIGHTEST[pixel / WIDTH / BAND_HEIGHT];
        *xyz = Observer::cie1931().xyz_bar(nm).map(|value| value * brightest);
    }
    for gamut in [GamutMapping::Desaturate, GamutMapping::Compress] {
        let development = Development { gamut, ..Development::default() };
        let file = folder.join(format!("spectrum_strip_{}.png", gamut.name()));
        png::write(&file, &develop(&picture, 1.0, &development))?;
        println!("wrote {}", file.display());
    }
    Ok(())
}
