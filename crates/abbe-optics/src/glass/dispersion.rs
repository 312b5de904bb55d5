//! Dispersion formulas n(λ).

use abbe_spectra::math::elementary::powf;

/// One term b·λ²/(λ² − c) of Sellmeier's formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SellmeierTerm {
    /// Strength of the resonance: dimensionless, or in 1/µm² in [`Dispersion::Gas`].
    pub b: f64,
    /// Squared resonance wavelength in µm², or wavenumber in 1/µm² in [`Dispersion::Gas`].
    pub c: f64,
}

/// One term c·λᵖ of a power series, with λ in µm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerTerm {
    /// Coefficient in µm⁻ᵖ.
    pub c: f64,
    /// Exponent.
    pub p: i32,
}

/// A formula of λ in µm. The argument of [`Dispersion::n`] is in nm.
#[derive(Debug, Clone, PartialEq)]
pub enum Dispersion {
    /// The same index at every wavelength.
    Constant(f64),
    /// Cauchy 1836: n = a + b/λ² + c/λ⁴.
    Cauchy {
        /// Limit of the index for long wavelengths.
        a: f64,
        /// Coefficient in µm².
        b: f64,
        /// Coefficient in µm⁴.
        c: f64,
    },
    /// Sellmeier 1871: n² = 1 + c0 + Σ b λ²/(λ² − c).
    Sellmeier {
        /// Contribution of resonances far in the ultraviolet, the same at every wavelength.
        c0: f64,
        /// Resonance terms.
        poles: Box<[SellmeierTerm]>,
    },
    /// n² = c0 + Σ c λᵖ, used by Schott until 1992.
    SquaredPowers {
        /// Constant term.
        c0: f64,
        /// Terms that depend on the wavelength.
        powers: Box<[PowerTerm]>,
    },
    /// n = c0 + Σ c λᵖ.
    Powers {
        /// Constant term.
        c0: f64,
        /// Terms that depend on the wavelength.
        powers: Box<[PowerTerm]>,
    },
    /// n² = c₁ + c₂ λ^c₃/(λ² − c₄^c₅) + c₆ λ^c₇/(λ² − c₈^c₉): formula 4 of refractiveindex.info.
    Rational(Box<[f64; 9]>),
    /// n = 1 + c0 + Σ b/(c − λ⁻²), for gases (Ciddor 1996).
    Gas {
        /// Constant term.
        c0: f64,
        /// Resonance terms.
        poles: Box<[SellmeierTerm]>,
    },
    /// Conrady 1929: n = a + b/λ + c/λ^3.5.
    Conrady {
        /// Limit of the index for long wavelengths.
        a: f64,
        /// Coefficient in µm.
        b: f64,
        /// Coefficient in µm^3.5.
        c: f64,
    },
    /// Herzberger 1959: n = c₀ + c₁L + c₂L² + c₃λ² + c₄λ⁴ + c₅λ⁶ with L = 1/(λ² − 0.028 µm²).
    Herzberger(Box<[f64; 6]>),
    /// Linear interpolation of measured points, which continues the first and the last value.
    Table {
        /// At least one wavelength in nm, strictly increasing.
        nm: Box<[f64]>,
        /// Index at each wavelength.
        n: Box<[f64]>,
    },
}

impl Dispersion {
    /// Returns the index at a wavelength in nm, or NaN for a negative n².
    /// [`super::RefractiveIndex::n`] clamps the wavelength to the range of validity.
    pub fn n(&self, wavelength_nm: f64) -> f64 {
        let um = wavelength_nm * 1e-3;
        match self {
            Self::Constant(n) => *n,
            Self::Cauchy { a, b, c } => {
                let per_um2 = 1.0 / (um * um);
                a + per_um2 * (b + per_um2 * c)
            }
            Self::Sellmeier { c0, poles } => {
                let um2 = um * um;
                let sum: f64 = poles.iter().map(|pole| pole.b * um2 / (um2 - pole.c)).sum();
                (1.0 + c0 + sum).sqrt()
            }
            Self::SquaredPowers { c0, powers } => (c0 + sum_of_powers(powers, um)).sqrt(),
            Self::Powers { c0, powers } => c0 + sum_of_powers(powers, um),
            Self::Rational(c) => {
                let first = c[1] * powf(um, c[2]) / (um * um - powf(c[3], c[4]));
                let second = c[5] * powf(um, c[6]) / (um * um - powf(c[7], c[8]));
                (c[0] + first + second).sqrt()
            }
            Self::Gas { c0, poles } => {
                let per_um2 = 1.0 / (um * um);
                let sum: f64 = poles.iter().map(|pole| pole.b / (pole.c - per_um2)).sum();
                1.0 + c0 + sum
            }
            Self::Conrady { a, b, c } => a + b / um + c / powf(um, 3.5),
            Self::Herzberger(c) => {
                let (um2, l) = (um * um, 1.0 / (um * um - 0.028));
                c[0] + l * (c[1] + l * c[2]) + um2 * (c[3] + um2 * (c[4] + um2 * c[5]))
            }
            Self::Table { nm, n } => interpolate(nm, n, wavelength_nm),
        }
    }
}

fn sum_of_powers(powers: &[PowerTerm], um: f64) -> f64 {
    powers.iter().map(|power| power.c * um.powi(power.p)).sum()
}

/// Interpolates linearly between points with strictly increasing `xs`, of which there is at least
/// one, and holds the first and the last value beyond them.
pub(super) fn interpolate(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let next = xs.partition_point(|&knot| knot <= x);
    if next == 0 {
        return ys[0];
    }
    if next == xs.len() {
        return ys[next - 1];
    }
    let t = (x - xs[next - 1]) / (xs[next] - xs[next - 1]);
    ys[next - 1] + t * (ys[next] - ys[next - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cauchy_is_a_plus_b_over_the_square_in_micrometres() {
        let cauchy = Dispersion::Cauchy { a: 1.5, b: 0.004, c: 0.0001 };
        assert!((cauchy.n(500.0) - (1.5 + 0.004 / 0.25 + 0.0001 / 0.0625)).abs() < 1e-15);
    }

    #[test]
    fn a_table_is_linear_between_its_points_and_held_outside() {
        let table = Dispersion::Table { nm: [400.0, 500.0, 700.0].into(), n: [1.6, 1.5, 1.4].into() };
        let values = [300.0, 400.0, 450.0, 500.0, 600.0, 700.0, 900.0].map(|nm| table.n(nm));
        assert_eq!(values, [1.6, 1.6, 1.55, 1.5, 1.45, 1.4, 1.4]);
    }
}
