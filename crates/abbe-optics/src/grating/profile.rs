//! Profiles of grooves and their scalar efficiencies (Goodman, *Introduction to Fourier Optics*).

use std::f64::consts::PI;

use crate::glass::RefractiveIndex;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{bessel_j, cos, sin};
use abbe_spectra::spectrum::Spectrum;

/// The profile of the grooves of a grating. Phases scale with 1/λ and do not depend on the angle.
#[derive(Debug, Clone, PartialEq)]
pub enum GratingProfile {
    /// A sawtooth that sends all light of the wavelength `blaze_nm` to one order.
    Blazed {
        /// The order of the blaze.
        order: i32,
        /// The wavelength of the blaze in nm.
        blaze_nm: f64,
    },
    /// A sawtooth in the surface of a glass, for transmitted light.
    BlazedGlass {
        /// The index of the glass.
        index: RefractiveIndex,
        /// The depth of the grooves in nm.
        depth_nm: f64,
    },
    /// A sinusoidal phase.
    Sinusoidal {
        /// The amplitude of the phase in rad, at the wavelength `at_nm`.
        amplitude_rad: f64,
        /// The wavelength in nm to which the amplitude belongs.
        at_nm: f64,
    },
    /// A phase with two values: rectangular (lamellar) grooves.
    BinaryPhase {
        /// The difference of the two phases in rad, at the wavelength `at_nm`.
        phase_rad: f64,
        /// The wavelength in nm to which the phase belongs.
        at_nm: f64,
        /// The fraction of the period with the second value, from 0 to 1.
        duty: f64,
    },
    /// Opaque lines with clear gaps between them.
    BinaryAmplitude {
        /// The clear fraction of the period, from 0 to 1.
        duty: f64,
    },
    /// Measured efficiencies.
    Table(EfficiencyTable),
}

/// The measured efficiencies of some orders, beside which all others have the efficiency 0.
#[derive(Debug, Clone, PartialEq)]
pub struct EfficiencyTable(Vec<(i32, Spectrum)>);

impl EfficiencyTable {
    /// Creates a table of orders with their efficiencies. Returns an error if an order is listed
    /// twice, an efficiency is negative, or the sum of all exceeds 1 at a wavelength.
    pub fn new(orders: Vec<(i32, Spectrum)>) -> Result<Self> {
        for (place, (order, efficiency)) in orders.iter().enumerate() {
            if orders[..place].iter().any(|(other, _)| other == order) {
                return Err(Error::input(format!("order {order} twice")).expected("each order once"));
            }
            if efficiency.min() < 0.0 {
                let what = format!("an efficiency of {} in order {order}", efficiency.min());
                return Err(Error::input(what).expected("efficiencies from 0 to 1"));
            }
        }
        let parts: Vec<(f64, &Spectrum)> = orders.iter().map(|(_, efficiency)| (1.0, efficiency)).collect();
        let most = Spectrum::mix(&parts).max();
        if most > 1.0 + 1e-9 {
            let error = Error::input(format!("efficiencies with a sum of {most}"));
            return Err(error.expected("a sum of at most 1 at each wavelength"));
        }
        Ok(Self(orders))
    }

    fn efficiency(&self, order: i32, nm: f64) -> f64 {
        self.0.iter().find(|(other, _)| *other == order).map_or(0.0, |(_, efficiency)| efficiency.at(nm))
    }

    fn is_upsampled(&self) -> bool {
        self.0.iter().any(|(_, efficiency)| efficiency.is_upsampled())
    }
}

/// Returns sin(πu)/(πu), which is exactly 0 for whole numbers except 0.
fn sinc(u: f64) -> f64 {
    if u == 0.0 { 1.0 } else { sin(PI * (u - u.round())) / (PI * u) }
}

fn sinc_squared(u: f64) -> f64 {
    sinc(u) * sinc(u)
}

impl GratingProfile {
    /// Returns the scalar efficiency of an order at a wavelength in nm.
    pub fn efficiency(&self, order: i32, nm: f64) -> f64 {
        let m = f64::from(order);
        match self {
            Self::Blazed { order, blaze_nm } => sinc_squared(m - f64::from(*order) * blaze_nm / nm),
            Self::BlazedGlass { index, depth_nm } => sinc_squared(m - (index.n(nm) - 1.0) * depth_nm / nm),
            Self::Sinusoidal { amplitude_rad, at_nm } => {
                let amplitude = bessel_j(order, amplitude_rad * at_nm / nm);
                amplitude * amplitude
            }
            Self::BinaryPhase { phase_rad, at_nm, duty } => {
                let versine = 1.0 - cos(phase_rad * at_nm / nm);
                match order {
                    0 => 1.0 - 2.0 * duty * (1.0 - duty) * versine,
                    _ => 2.0 * versine * duty * duty * sinc_squared(m * duty),
                }
            }
            Self::BinaryAmplitude { duty } => duty * duty * sinc_squared(m * duty),
            Self::Table(table) => table.efficiency(order, nm),
        }
    }

    /// Returns the fraction of the power, from 0 to 1, that the orders that propagate share. `sum`
    /// is the sum of their efficiencies. The opaque lines of an amplitude grating absorb the rest,
    /// and a grating with measured efficiencies the power of evanescent orders.
    pub(super) fn total(&self, sum: impl FnOnce() -> f64) -> f64 {
        match self {
            Self::Blazed { .. } | Self::BlazedGlass { .. } | Self::Sinusoidal { .. } | Self::BinaryPhase { .. } => 1.0,
            Self::BinaryAmplitude { duty } => *duty,
            Self::Table(_) => sum(),
        }
    }

    /// Returns true if an efficiency was made from an RGB colour.
    pub fn is_upsampled(&self) -> bool {
        if let Self::Table(table) = self { table.is_upsampled() } else { false }
    }
}
