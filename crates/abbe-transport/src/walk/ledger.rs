//! The energy balance of a pass.

use serde::{Deserialize, Serialize};

/// The power (W) of the photons of one pass, summed over the band: emitted + sampling = absorbed +
/// Stokes loss + quantum loss + escaped + depth limit.
///
/// The absorbed power is computed from the albedo and from Beer's law, never as a difference. An
/// error in a path weight therefore unbalances the ledger, or the mean of `sampling` over many
/// passes is not zero.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    pub emitted: f64,
    /// The part of `emitted` below 360 nm, which the explicit powers of the lights do not include.
    #[serde(default)]
    pub ultraviolet: f64,
    /// Power that was added (positive) or removed (negative) by Russian roulette, by the choice of
    /// one wavelength and by importance sampling.
    pub sampling: f64,
    /// Power absorbed by surfaces. Entry i is for material number i.
    pub absorbed: Vec<f64>,
    /// Power absorbed by bodies of glass, liquid or fog.
    pub absorbed_inside: f64,
    /// Power that fluorophores absorbed and did not emit, because the emitted photons have less
    /// energy.
    #[serde(default)]
    pub stokes_loss: f64,
    /// Power of the photons that fluorophores absorbed without emitting a photon.
    #[serde(default)]
    pub quantum_loss: f64,
    pub escaped: f64,
    /// The part of `escaped` that left inside a body: the body is open, or a path hit one of its
    /// edges so exactly that it missed the next face.
    #[serde(default)]
    pub escaped_inside: f64,
    /// Power of the photons that ended at the depth limit.
    pub depth_limit: f64,
    /// The part of `depth_limit` that surfaces or media scattered at least once.
    #[serde(default)]
    pub depth_limit_indirect: f64,
}

impl Ledger {
    pub fn new(materials: usize) -> Self {
        Self { absorbed: vec![0.0; materials], ..Self::default() }
    }

    pub fn absorbed_total(&self) -> f64 {
        self.absorbed.iter().sum::<f64>() + self.absorbed_inside
    }

    /// Returns emitted + sampling − absorbed − Stokes loss − quantum loss − escaped − depth limit,
    /// divided by the emitted power.
    pub fn balance(&self) -> f64 {
        let lost = self.absorbed_total() + self.stokes_loss + self.quantum_loss;
        let left = self.emitted + self.sampling - lost - self.escaped - self.depth_limit;
        if self.emitted > 0.0 { left / self.emitted } else { left }
    }

    /// Adds the power of a path that leaves the scene, `inside` a body or not.
    #[inline]
    pub fn add_escaped(&mut self, power_w: f64, inside: bool) {
        self.escaped += power_w;
        self.escaped_inside += if inside { power_w } else { 0.0 };
    }

    fn powers_mut(&mut self) -> [&mut f64; 10] {
        [
            &mut self.emitted,
            &mut self.ultraviolet,
            &mut self.sampling,
            &mut self.absorbed_inside,
            &mut self.stokes_loss,
            &mut self.quantum_loss,
            &mut self.escaped,
            &mut self.escaped_inside,
            &mut self.depth_limit,
            &mut self.depth_limit_indirect,
        ]
    }

    pub fn scale(&mut self, factor: f64) {
        self.powers_mut().into_iter().for_each(|power| *power *= factor);
        self.absorbed.iter_mut().for_each(|power| *power *= factor);
    }

    /// Adds another ledger. The same ledgers in the same order give a bit-identical sum.
    pub fn add(&mut self, other: &Self) {
        let mut other = other.clone();
        self.powers_mut().into_iter().zip(other.powers_mut()).for_each(|(power, more)| *power += *more);
        if self.absorbed.len() < other.absorbed.len() {
            self.absorbed.resize(other.absorbed.len(), 0.0);
        }
        self.absorbed.iter_mut().zip(&other.absorbed).for_each(|(power, more)| *power += more);
    }
}
