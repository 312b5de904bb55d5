//! Thermal radiation.

/// First radiation constant for spectral radiance, 2hc², in W m² sr⁻¹ (exact in the SI of 2019).
const C1_RADIANCE: f64 = 1.191_042_972_397_188e-16;
/// Second radiation constant, hc/k, in m K (exact in the SI of 2019).
pub(crate) const C2_M_K: f64 = 0.014_387_768_775_039_337;

/// Beyond this exponent the radiance is below the least positive number at any wavelength in use.
const LAST_EXPONENT: f64 = 1600.0;

/// Spectral radiance of a black body by Planck's law, in W m⁻² sr⁻¹ m⁻¹, at a wavelength in nm and a temperature in
/// K, both positive.
///
/// The exponential is split in two halves, so that radiances far below the least normal value of exp(−x) keep their
/// digits.
pub fn planck(nm: f64, temperature_k: f64) -> f64 {
    let length_m = nm * 1e-9;
    let exponent = C2_M_K / (length_m * temperature_k);
    if exponent > LAST_EXPONENT {
        return 0.0;
    }
    let half = (-0.5 * exponent).exp();
    (C1_RADIANCE / length_m.powi(5) * half) * half / -(-exponent).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_waves_follow_rayleigh_and_jeans() {
        // For hc ≪ λkT the law tends to 2ckT/λ⁴ (1 − x/2 + x²/12).
        let (nm, temperature) = (830.0, 1e12);
        let x = C2_M_K / (830e-9 * 1e12);
        let classical = C1_RADIANCE / 830e-9_f64.powi(5) / x * (1.0 - 0.5 * x + x * x / 12.0);
        assert!((planck(nm, temperature) / classical - 1.0).abs() < 1e-12);
    }
}
