//! Interference colours between polarisers (Michel-Lévy).

use abbe_spectra::colour::Xyz;
use abbe_spectra::math::elementary::sin;
use abbe_spectra::spectrum::{BAND_NM, Observer, Spectrum};
use std::f64::consts::PI;

/// The colours of a birefringent plate with its axes at 45° between ideal polarisers, CIE 1931.
/// The unpolarised light without polarisers has Y = 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct InterferenceColours {
    /// Between crossed polarisers, ½ sin²(πΓ/λ).
    pub crossed: Xyz,
    /// Between parallel polarisers, ½ cos²(πΓ/λ).
    pub parallel: Xyz,
}

/// Returns the colours of a plate with the optical path difference Γ in nm at each wavelength in
/// nm, under a light. Surfaces of the plate do not reflect. The continuum is summed over whole nm
/// from 360 to 830, and each line counts at its centre. A light without Y gives 0.
pub fn interference_colours(light: &Spectrum, path_difference_nm: impl Fn(f64) -> f64) -> InterferenceColours {
    let observer = Observer::cie1931();
    let (mut found, mut luminance) = (InterferenceColours::default(), 0.0);
    let mut add = |nm: f64, power: f64| {
        let bars = observer.xyz_bar(nm);
        let sine = sin(PI * path_difference_nm(nm) / nm);
        luminance += power * bars[1];
        for (i, bar) in bars.into_iter().enumerate() {
            found.crossed[i] += 0.5 * power * bar * sine * sine;
            found.parallel[i] += 0.5 * power * bar * (1.0 - sine * sine);
        }
    };
    (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).for_each(|nm| add(nm, light.continuum_at(nm)));
    light.line_segments().iter().for_each(|line| add(line.centre(), line.power));
    let scale = if luminance > 0.0 { 1.0 / luminance } else { 0.0 };
    let scaled = |xyz: Xyz| xyz.map(|value| value * scale);
    InterferenceColours { crossed: scaled(found.crossed), parallel: scaled(found.parallel) }
}
