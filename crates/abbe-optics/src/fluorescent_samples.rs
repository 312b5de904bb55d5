//! Fluorescent sample surfaces for the comparison of lamps.

use crate::bsdf::Fluorescent;
use crate::fluorophore::Fluorophore;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::cos;
use abbe_spectra::spectrum::{Outside, Spectrum};
use std::f64::consts::FRAC_PI_2;

/// The names of the sample surfaces.
pub const NAMES: [&str; 2] = ["white paper with brightener", "red day-glow"];

/// In nm, between adjacent samples of a lobe.
const STEP_NM: f64 = 5.0;

/// A peak that falls to 0 as cos² on both sides.
struct Lobe {
    peak: f64,
    at_nm: f64,
    /// Towards short and towards long wavelengths, in nm.
    widths_nm: [f64; 2],
}

impl Lobe {
    fn spectrum(&self) -> Result<Spectrum> {
        let Self { peak, at_nm, widths_nm: [left, right] } = *self;
        let steps = ((left + right) / STEP_NM) as u32;
        let nm: Vec<f64> = (0..=steps).map(|step| at_nm - left + f64::from(step) * STEP_NM).collect();
        let value = |nm: &f64| {
            let width = if *nm < at_nm { left } else { right };
            let cosine = cos(FRAC_PI_2 * ((nm - at_nm) / width).clamp(-1.0, 1.0));
            peak * cosine * cosine
        };
        Spectrum::table(&nm, &nm.iter().map(value).collect::<Vec<_>>(), Outside::Zero)
    }
}

/// Returns the sample surfaces, in the order of [`NAMES`]. Their spectra are typical of no one
/// product, and valid, so there is no error.
pub fn surfaces() -> Result<[Fluorescent; 2]> {
    let paper_nm = [360.0, 400.0, 450.0, 550.0, 700.0, 830.0];
    let paper = Spectrum::table(&paper_nm, &[0.65, 0.75, 0.82, 0.86, 0.88, 0.88], Outside::Hold)?;
    let brightener = Fluorophore::new(
        Lobe { peak: 0.75, at_nm: 370.0, widths_nm: [70.0, 50.0] }.spectrum()?,
        &Lobe { peak: 1.0, at_nm: 435.0, widths_nm: [35.0, 85.0] }.spectrum()?,
        0.8,
    )?;
    let dye = Fluorophore::new(
        Lobe { peak: 0.92, at_nm: 545.0, widths_nm: [105.0, 55.0] }.spectrum()?,
        &Lobe { peak: 1.0, at_nm: 605.0, widths_nm: [30.0, 95.0] }.spectrum()?,
        0.85,
    )?;
    Ok([Fluorescent::new(paper, brightener)?, Fluorescent::new(Spectrum::constant(0.85), dye)?])
}
