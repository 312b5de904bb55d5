//! Phases of daylight of the CIE D series.

use std::sync::OnceLock;

use super::library;
use super::table::Outside;
use super::value::Spectrum;
use crate::error::{Error, Result};

/// The range of correlated colour temperatures, in K, for which the CIE defines daylight.
pub const DAYLIGHT_K: (f64, f64) = (4000.0, 25_000.0);

/// The mean S₀ and the first two characteristic vectors S₁ and S₂ of daylight, every 5 nm (CIE 15).
struct Components {
    nm: Vec<f64>,
    vectors: [Vec<f64>; 3],
}

fn components() -> &'static Components {
    static COMPONENTS: OnceLock<Components> = OnceLock::new();
    COMPONENTS.get_or_init(|| {
        let [nm, s0, s1, s2] = library::columns(include_str!("../../data/cie/d_series_basis_5nm.csv"));
        Components { nm, vectors: [s0, s1, s2] }
    })
}

impl Spectrum {
    /// Returns daylight of a correlated colour temperature in K by CIE 15, in relative power that
    /// is 100 at 560 nm, or an error outside 4000–25,000 K. The factors M₁ and M₂ are not rounded,
    /// so it differs slightly from the published tables of D50, D55, D65 and D75.
    pub fn daylight(temperature_k: f64) -> Result<Self> {
        if !(DAYLIGHT_K.0..=DAYLIGHT_K.1).contains(&temperature_k) {
            let what = format!("daylight of {temperature_k} K");
            return Err(Error::input(what).expected("a temperature from 4000 to 25000 K"));
        }
        Ok(daylight_extended(temperature_k))
    }
}

/// Computes [`Spectrum::daylight`], also above 25,000 K by the formula from 7000 K on.
pub(crate) fn daylight_extended(temperature_k: f64) -> Spectrum {
    let t = 1000.0 / temperature_k;
    let x = if temperature_k <= 7000.0 {
        0.244_063 + t * (0.099_11 + t * (2.9678 - t * 4.6070))
    } else {
        0.237_040 + t * (0.247_48 + t * (1.9018 - t * 2.0064))
    };
    let y = -0.275 + x * (2.870 - 3.0 * x);
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    let m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m;
    let Components { nm, vectors: [s0, s1, s2] } = components();
    let values: Vec<f64> = s0.iter().zip(s1).zip(s2).map(|((s0, s1), s2)| (s0 + m1 * s1 + m2 * s2).max(0.0)).collect();
    Spectrum::table(nm, &values, Outside::Zero).expect("the components' wavelengths ascend and sums are clamped to 0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn daylight_of_6504_k_is_d65_within_the_rounding_of_its_table() {
        let (daylight, d65) = (Spectrum::daylight(6504.0).unwrap(), library::find("D65").unwrap().spectrum);
        for nm in (360..=830).step_by(5).map(f64::from) {
            assert!((daylight.at(nm) - d65.at(nm)).abs() < 0.07, "{nm}: {} {}", daylight.at(nm), d65.at(nm));
        }
        assert!(Spectrum::daylight(3999.0).is_err() && Spectrum::daylight(f64::NAN).is_err());
    }
}
