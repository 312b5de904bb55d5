//! The first surface of a camera sample, as the layers and the denoiser record it.

use abbe_spectra::spectrum::{BAND_NM, Observer, Outside, Spectrum, library};
use std::sync::LazyLock;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstSurface {
    /// The light that the surface reflects or transmits, at each of [`ALBEDO_NM`].
    pub albedo: [f64; ALBEDO_NM.len()],
    /// The unit normal in world space, on the visible side.
    pub normal: [f64; 3],
    /// The distance along the ray in m.
    pub depth_m: f64,
    pub uv: [f64; 2],
    pub object: usize,
    pub material: usize,
    /// What is seen at this surface.
    pub sight: Sight,
}

/// What a camera ray shows, by which the denoiser tells pixels apart: the first surface or, if that
/// is a mirror or clear glass, what lies at the end of the most likely path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The unit normal of the first surface. If that is a mirror or glass, the direction in which the
    /// path arrives at its end, minus the unit normal of the surface there, if there is one.
    pub normal: [f64; 3],
    /// The length (m) of the path up to its last surface.
    pub depth_m: f64,
}

/// The wavelengths (nm) at which the albedo of a surface is evaluated.
pub const ALBEDO_NM: [f64; 32] = {
    let mut nm = [0.0; 32];
    let mut i = 0;
    while i < nm.len() {
        nm[i] = 395.0 + 10.0 * i as f64;
        i += 1;
    }
    nm
};

/// The linear sRGB (D65) of an albedo of 1 at each of [`ALBEDO_NM`], in sum (1, 1, 1).
static ALBEDO_RGB: LazyLock<[[f64; 3]; ALBEDO_NM.len()]> = LazyLock::new(|| {
    let (observer, d65) = (Observer::cie1931(), d65());
    let mut rgb = [[0.0; 3]; ALBEDO_NM.len()];
    let count = (BAND_NM.1 - BAND_NM.0) as usize;
    for nm in (0..count).map(|i| BAND_NM.0 + i as f64 + 0.5) {
        // Each nanometre belongs to the nearest wavelength.
        let nearest = ((nm - ALBEDO_NM[0] + 5.0) / 10.0).clamp(0.0, (ALBEDO_NM.len() - 1) as f64) as usize;
        let more = abbe_spectra::colour::xyz_to_linear_srgb(observer.xyz_bar(nm).map(|bar| bar * d65.at(nm)));
        (0..3).for_each(|c| rgb[nearest][c] += more[c]);
    }
    let white: [f64; 3] = std::array::from_fn(|c| rgb.iter().map(|rgb| rgb[c]).sum());
    rgb.map(|rgb| std::array::from_fn(|c| rgb[c] / white[c]))
});

fn d65() -> Spectrum {
    let constant = || Spectrum::table(&[360.0, 830.0], &[1.0, 1.0], Outside::Hold).expect("a constant table is valid");
    library::find("D65").map_or_else(|_| constant(), |found| found.spectrum)
}

impl FirstSurface {
    /// Returns the albedo under D65 in linear sRGB.
    pub(super) fn albedo_rgb(&self) -> [f64; 3] {
        let lit = || self.albedo.iter().zip(ALBEDO_RGB.iter());
        [0, 1, 2].map(|c| lit().map(|(albedo, rgb)| albedo * rgb[c]).sum())
    }
}
