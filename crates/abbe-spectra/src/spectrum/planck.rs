//! Thermal radiation: Planck's law.

use crate::math::elementary::{exp, exp_m1};

/// The first radiation constant for spectral radiance, 2hc² in W m² sr⁻¹, exact in the SI of 2019.
const C1_RADIANCE: f64 = 1.191_042_972_397_188e-16;
/// The second radiation constant, hc/k in m K, exact in the SI of 2019.
pub(crate) const C2_M_K: f64 = 0.014_387_768_775_039_337;

/// The largest exponent that is evaluated. Above it, the radiance is below the smallest `f64`.
const LAST_EXPONENT: f64 = 1600.0;

/// Returns the spectral radiance of a black body by Planck's law, in W m⁻² sr⁻¹ m⁻¹, for a positive
/// wavelength in nm and temperature in K. The exponential is split into two equal factors, so that
/// very small radiances keep their precision.
pub fn planck(nm: f64, temperature_k: f64) -> f64 {
    let length_m = nm * 1e-9;
    let exponent = C2_M_K / (length_m * temperature_k);
    if exponent > LAST_EXPONENT {
        return 0.0;
    }
    let half = exp(-0.5 * exponent);
    // The difference loses precision only for small exponents.
    let denominator = if exponent > 1.0 { 1.0 - half * half } else { -exp_m1(-exponent) };
    (C1_RADIANCE / length_m.powi(5) * half) * half / denominator
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_waves_follow_the_rayleigh_jeans_law() {
        // For x = hc/(λkT) ≪ 1, the law tends to 2ckT/λ⁴ (1 − x/2 + x²/12).
        let (nm, temperature) = (830.0, 1e12);
        let x = C2_M_K / (830e-9 * 1e12);
        let classical = C1_RADIANCE / 830e-9_f64.powi(5) / x * (1.0 - 0.5 * x + x * x / 12.0);
        assert!((planck(nm, temperature) / classical - 1.0).abs() < 1e-12);
    }

    /// An exponent of 1 is where one form of the denominator replaces the other.
    #[test]
    fn radiance_is_smooth_where_the_form_changes() {
        let temperature = C2_M_K / 550e-9;
        let [below, at, above] = [1.0 - 1e-7, 1.0, 1.0 + 1e-7].map(|factor| planck(550.0, temperature * factor));
        assert!(((above - at) / (at - below) - 1.0).abs() < 1e-6, "{below} {at} {above}");
    }
}
