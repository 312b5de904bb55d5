//! Colour rendering indices of CIE 13.3-1995.

use super::coordinates::uv1960;
use super::difference::delta_e_76;
use super::temperature::CorrelatedTemperature;
use super::tristimulus::Xyz;
use crate::math::elementary::cbrt;
use crate::spectrum::{Observer, Spectrum, daylight_extended, library};

/// The number of test colours, of which the first eight determine Ra.
const TEST_COLOURS: usize = 14;

/// The range of colour temperatures in K for which the index is computed.
pub(super) const RANGE_K: (f64, f64) = (1000.0, 50_000.0);

/// The reference illuminant is daylight from this temperature in K on, and a black body below.
const DAYLIGHT_FROM_K: f64 = 5000.0;

/// The step of the sums over wavelengths in CIE 13.3, in nm.
const CIE_STEP_NM: u32 = 5;

/// The colour rendering indices of a light, relative to a reference of the same colour temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourRendering {
    /// The general index, the mean of R1–R8.
    pub ra: f64,
    /// The special indices R1–R14.
    pub special: [f64; TEST_COLOURS],
}

/// Computes the colour rendering indices of a light of known correlated colour temperature, or
/// returns `None` outside 1000–50,000 K. As in CIE 13.3, the sums are over samples of the continuum
/// every 5 nm from 380 to 780 nm. Each line is evaluated at its wavelength.
pub fn cri(lamp: &Spectrum, temperature: CorrelatedTemperature) -> Option<ColourRendering> {
    cri_in_steps(lamp, temperature, CIE_STEP_NM)
}

/// Computes the same as [`cri`], but sums both continua in steps of `step_nm`.
pub fn cri_in_steps(lamp: &Spectrum, temperature: CorrelatedTemperature, step_nm: u32) -> Option<ColourRendering> {
    let cct_k = temperature.cct_k;
    if !(RANGE_K.0..=RANGE_K.1).contains(&cct_k) {
        return None;
    }
    let reference = if cct_k < DAYLIGHT_FROM_K { Spectrum::blackbody(cct_k).ok()? } else { daylight_extended(cct_k) };
    let white = Spectrum::constant(1.0);
    let xyz = |reflectance: &Spectrum, light: &Spectrum| xyz(reflectance, light, step_nm);
    let (lamp_white, reference_white) = (xyz(&white, lamp), xyz(&white, &reference));
    let adaptation = VonKriesAdaptation::new(lamp_white, reference_white);
    let special = std::array::from_fn(|i| {
        let colour =
            library::find(&format!("TCS{:02}", i + 1)).expect("the built-in library holds TCS01–TCS14").spectrum;
        let under_lamp = xyz(&colour, lamp).map(|value| 100.0 * value / lamp_white[1]);
        let under_reference = xyz(&colour, &reference).map(|value| 100.0 * value / reference_white[1]);
        let shown = uniform(under_lamp[1], adaptation.adapted(uv1960(under_lamp)), uv1960(reference_white));
        let wanted = uniform(under_reference[1], uv1960(under_reference), uv1960(reference_white));
        100.0 - 4.6 * delta_e_76(shown, wanted)
    });
    Some(ColourRendering { ra: special[..8].iter().sum::<f64>() / 8.0, special })
}

/// Returns the XYZ of a reflectance under a light, by samples that are `step_nm` apart.
fn xyz(reflectance: &Spectrum, light: &Spectrum, step_nm: u32) -> Xyz {
    let observer = Observer::cie1931();
    let narrow = light.narrow_part();
    let mut sum = narrow.as_ref().map_or([0.0; 3], |narrow| observer.xyz_under(reflectance, narrow));
    let mut add = |nm: f64, power: f64| {
        let reflected = power * reflectance.at(nm);
        sum.iter_mut().zip(observer.xyz_bar(nm)).for_each(|(sum, bar)| *sum += reflected * bar);
    };
    for nm in (380..=780).step_by(step_nm as usize).map(f64::from) {
        let power_per_nm = light.continuum_at(nm) - narrow.as_ref().map_or(0.0, |narrow| narrow.continuum_at(nm));
        add(nm, f64::from(step_nm) * power_per_nm);
    }
    for line in light.line_segments() {
        add(line.centre(), line.power);
    }
    sum
}

/// The von Kries adaptation of CIE 13.3, from the white of the light to that of the reference.
struct VonKriesAdaptation {
    ratio: [f64; 2],
}

impl VonKriesAdaptation {
    fn new(lamp: Xyz, reference: Xyz) -> Self {
        let ([c_lamp, d_lamp], [c, d]) = (c_d(uv1960(lamp)), c_d(uv1960(reference)));
        Self { ratio: [c / c_lamp, d / d_lamp] }
    }

    fn adapted(&self, uv: [f64; 2]) -> [f64; 2] {
        let [c, d] = c_d(uv);
        let (c, d) = (c * self.ratio[0], d * self.ratio[1]);
        let denominator = 16.518 + 1.481 * c - d;
        [(10.872 + 0.404 * c - 4.0 * d) / denominator, 5.520 / denominator]
    }
}

fn c_d([u, v]: [f64; 2]) -> [f64; 2] {
    [(4.0 - u - 10.0 * v) / v, (1.708 * v + 0.404 - 1.481 * u) / v]
}

/// Returns CIE 1964 W*, U*, V* of a luminance Y and chromaticity u, v. White has Y = 100.
fn uniform(y: f64, [u, v]: [f64; 2], [white_u, white_v]: [f64; 2]) -> [f64; 3] {
    let w = 25.0 * cbrt(y) - 17.0;
    [w, 13.0 * w * (u - white_u), 13.0 * w * (v - white_v)]
}
