//! Plane diffraction gratings: directions and scalar efficiencies of the orders.
//!
//! The grating is the plane z = 0, with grooves along y. All directions are unit vectors along
//! which light travels. Light arrives from z > 0. A reflected order returns to z > 0, where the
//! order 0 keeps the x component of its direction, and a transmitted order continues to z < 0.

mod closed_set;
mod profile;

pub use profile::{EfficiencyTable, GratingProfile};

use crate::bsdf::ScatterEvent;
use abbe_spectra::error::{Error, Result};
use closed_set::ClosedSet;
use glam::DVec3;

/// A grating: the period of its grooves, and their profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Grating {
    period_nm: f64,
    profile: GratingProfile,
}

/// An order of a grating that propagates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiffractedOrder {
    /// The number of the order.
    pub order: i32,
    /// In which the light travels, a unit vector.
    pub direction: DVec3,
    /// The fraction of the incident power. The orders of a phase grating sum to 1.
    pub efficiency: f64,
    /// By scalar theory, before the power of evanescent orders is divided among the others.
    pub scalar_efficiency: f64,
}

impl DiffractedOrder {
    /// Returns the angle to the normal in degrees, from 0 to 90.
    pub fn polar_deg(&self) -> f64 {
        abbe_spectra::math::elementary::asin(self.direction.truncate().length().min(1.0)).to_degrees()
    }

    /// Returns the angle across the grooves in degrees, from −90 to 90, positive towards x.
    pub fn signed_deg(&self) -> f64 {
        abbe_spectra::math::elementary::asin(self.direction.x.clamp(-1.0, 1.0)).to_degrees()
    }
}

/// At which the period is 100 nm.
const MOST_LINES_PER_MM: f64 = 1e4;

impl Grating {
    /// Creates a grating, or returns an error for a density outside 0.1 to 10000 lines per mm.
    pub fn new(lines_per_mm: f64, profile: GratingProfile) -> Result<Self> {
        if !(0.1..=MOST_LINES_PER_MM).contains(&lines_per_mm) {
            return Err(Error::input(format!("{lines_per_mm} lines per mm")).expected("from 0.1 to 10000"));
        }
        Ok(Self { period_nm: 1e6 / lines_per_mm, profile })
    }

    /// Returns the period in nm.
    pub fn period_nm(&self) -> f64 {
        self.period_nm
    }

    /// Returns the profile of the grooves.
    pub fn profile(&self) -> &GratingProfile {
        &self.profile
    }

    /// Returns the direction of an order, or `None` if it is evanescent. `incident`, with z < 0, is
    /// the unit direction of arrival, `indices` are those of the media in which the light arrives
    /// and leaves, and `nm` is the wavelength in air.
    pub fn direction(
        &self,
        incident: DVec3,
        order: i32,
        event: ScatterEvent,
        indices: [f64; 2],
        nm: f64,
    ) -> Option<DVec3> {
        let [n_in, n_out] = indices;
        let x = (n_in * incident.x + f64::from(order) * nm / self.period_nm) / n_out;
        let y = n_in * incident.y / n_out;
        let squared = 1.0 - x * x - y * y;
        let sign = match event {
            ScatterEvent::Reflection => 1.0,
            ScatterEvent::Transmission => -1.0,
        };
        (squared > 0.0).then(|| DVec3::new(x, y, sign * squared.sqrt()))
    }

    /// Returns the numbers of all orders that propagate, in rising order; see [`Self::direction`].
    fn propagating(&self, incident: DVec3, [n_in, n_out]: [f64; 2], nm: f64) -> std::ops::RangeInclusive<i32> {
        let y = n_in * incident.y;
        let widest = (n_out * n_out - y * y).max(0.0).sqrt();
        let number = |x: f64| (x - n_in * incident.x) * self.period_nm / nm;
        number(-widest).ceil() as i32..=number(widest).floor() as i32
    }

    /// Returns the sum of the scalar efficiencies of all orders that propagate.
    fn scalar_sum(&self, incident: DVec3, index: f64, nm: f64) -> f64 {
        self.propagating(incident, [index; 2], nm).map(|order| self.profile.efficiency(order, nm)).sum()
    }

    /// Returns the closed set of the directions of all orders, and its first order. `None` for a
    /// grating with measured efficiencies, which are not scaled, and for a very large set.
    fn closed_set(&self, incident: DVec3, index: f64, nm: f64) -> Option<(ClosedSet, i32)> {
        if matches!(self.profile, GratingProfile::Table(_)) {
            return None;
        }
        let numbers = self.propagating(incident, [index; 2], nm);
        let first = *numbers.start();
        let (count, from) = (numbers.count(), usize::try_from(-first).ok()?);
        Some((ClosedSet::new(count, from, |order| self.profile.efficiency(order, nm))?, first))
    }

    /// Returns the efficiency of a propagating order in one `index`. Lossless and reciprocal: it is
    /// that of the order of the same number of light that is sent back.
    pub fn efficiency(&self, incident: DVec3, order: i32, index: f64, nm: f64) -> f64 {
        let fraction = match self.closed_set(incident, index, nm) {
            Some((set, first)) => set.efficiency(order - first),
            None => {
                let sum = self.scalar_sum(incident, index, nm);
                let of_zero = f64::from(u8::from(order == 0));
                if sum > 0.0 { self.profile.efficiency(order, nm) / sum } else { of_zero }
            }
        };
        self.total_efficiency(incident, index, nm) * fraction
    }

    /// Returns the fraction of the power that all orders that propagate share.
    pub fn total_efficiency(&self, incident: DVec3, index: f64, nm: f64) -> f64 {
        self.profile.total(|| self.scalar_sum(incident, index, nm))
    }

    /// Selects an order that propagates in proportion to its efficiency, by the random number `u`
    /// in \[0, 1). Returns the order and its probability.
    pub fn sample_order(&self, incident: DVec3, index: f64, nm: f64, u: f64) -> (i32, f64) {
        let set = self.closed_set(incident, index, nm);
        let sum = set.as_ref().map_or_else(|| self.scalar_sum(incident, index, nm), |_| 1.0);
        if sum <= 0.0 {
            return (0, 1.0);
        }
        let (mut rest, mut chosen) = (u * sum, (0, 1.0));
        for order in self.propagating(incident, [index; 2], nm) {
            let efficiency = match &set {
                Some((set, first)) => set.efficiency(order - first),
                None => self.profile.efficiency(order, nm),
            };
            if efficiency > 0.0 {
                chosen = (order, efficiency / sum);
                rest -= efficiency;
                if rest < 0.0 {
                    break;
                }
            }
        }
        chosen
    }

    /// Returns all orders of one beam that propagate, with their efficiencies; see
    /// [`Self::direction`].
    ///
    /// Scalar efficiencies are scaled, so that a phase grating loses no power to evanescent orders,
    /// and if all are 0, the order 0 receives the power. They are those of the beam alone and are
    /// not reciprocal, because a beam in the opposite direction has other evanescent orders; see
    /// [`Self::efficiency`] for those of a surface. Measured ones are not scaled.
    pub fn orders(&self, incident: DVec3, event: ScatterEvent, indices: [f64; 2], nm: f64) -> Vec<DiffractedOrder> {
        let numbers = self.propagating(incident, indices, nm);
        let found = numbers.filter_map(|order| {
            let direction = self.direction(incident, order, event, indices, nm)?;
            let scalar_efficiency = self.profile.efficiency(order, nm);
            Some(DiffractedOrder { order, direction, efficiency: 0.0, scalar_efficiency })
        });
        let mut orders: Vec<DiffractedOrder> = found.collect();
        let sum = orders.iter().map(|it| it.scalar_efficiency).sum::<f64>();
        let total = self.profile.total(|| sum);
        for it in &mut orders {
            let fraction = if sum > 0.0 { it.scalar_efficiency / sum } else { f64::from(u8::from(it.order == 0)) };
            it.efficiency = total * fraction;
        }
        orders
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::Spectrum;

    #[test]
    fn the_orders_of_a_phase_grating_share_all_the_power() {
        let profiles = [
            GratingProfile::Blazed { order: 1, blaze_nm: 550.0 },
            GratingProfile::Sinusoidal { amplitude_rad: 1.2, at_nm: 550.0 },
            GratingProfile::BinaryPhase { phase_rad: 3.0, at_nm: 550.0, duty: 0.4 },
        ];
        for profile in profiles {
            let grating = Grating::new(1200.0, profile).unwrap();
            for degrees in [0.0_f64, 20.0, 80.0] {
                let incident = DVec3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos());
                let orders = grating.orders(incident, ScatterEvent::Reflection, [1.0; 2], 500.0);
                let total: f64 = orders.iter().map(|it| it.efficiency).sum();
                assert!((total - 1.0).abs() < 1e-12, "{total}");
                assert!(orders.iter().all(|it| (it.direction.length() - 1.0).abs() < 1e-12));
            }
        }
    }

    /// At 30° and 700 nm, the order 1 of 1000 lines per mm is evanescent.
    #[test]
    fn measured_efficiencies_are_not_scaled() {
        let spectrum = |value: f64| Spectrum::constant(value);
        let table = EfficiencyTable::new(vec![(-1, spectrum(0.5)), (0, spectrum(0.1)), (1, spectrum(0.3))]).unwrap();
        let grating = Grating::new(1000.0, GratingProfile::Table(table)).unwrap();
        let incident = DVec3::new(0.5, 0.0, -0.75_f64.sqrt());
        let orders = grating.orders(incident, ScatterEvent::Reflection, [1.0; 2], 700.0);
        let found: Vec<(i32, f64)> = orders.iter().map(|it| (it.order, it.efficiency)).collect();
        for ((order, efficiency), (expected_order, expected)) in found.iter().zip([(-2, 0.0), (-1, 0.5), (0, 0.1)]) {
            assert!(*order == expected_order && (efficiency - expected).abs() < 1e-15, "{found:?}");
        }
        assert_eq!(found.len(), 3);
        assert!((grating.total_efficiency(incident, 1.0, 700.0) - 0.6).abs() < 1e-15);
        for u in [0.0, 0.5, 0.9, 0.99] {
            let (order, fraction) = grating.sample_order(incident, 1.0, 700.0, u);
            let efficiency = grating.efficiency(incident, order, 1.0, 700.0);
            assert!((efficiency / fraction - 0.6).abs() < 1e-15, "{order}");
        }
    }

    #[test]
    fn wrong_efficiencies_are_refused() {
        let spectrum = |value: f64| Spectrum::constant(value);
        let message = |orders| EfficiencyTable::new(orders).unwrap_err().to_string();
        assert!(message(vec![(0, spectrum(0.7)), (1, spectrum(0.4))]).contains("a sum of 1.1"));
        assert!(message(vec![(1, spectrum(0.2)), (1, spectrum(0.4))]).contains("order 1 twice"));
        assert!(message(vec![(1, spectrum(-0.2))]).contains("-0.2 in order 1"));
    }

    #[test]
    fn line_densities_out_of_range_are_refused() {
        for density in [0.0, -5.0, 2e4, f64::NAN] {
            let message = Grating::new(density, GratingProfile::BinaryAmplitude { duty: 0.5 }).unwrap_err().to_string();
            assert!(message.contains("lines per mm"), "{message}");
        }
    }
}
