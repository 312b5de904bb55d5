//! Where the light of a pass went: the balance of emitted and absorbed power.

use serde::{Deserialize, Serialize};

/// The power that photons carried in one pass, in W over the band. Emitted + sampling = absorbed + escaped + depth limit.
///
/// *Absorbed* is computed from albedo and Beer's law and never as a difference, so that a weight that loses or gains energy
/// somewhere shows as an imbalance or as a *sampling* that is not zero in the mean.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    /// What the lights handed out.
    pub emitted: f64,
    /// What roulette, the choice of one wavelength and importance sampling gained (positive) or lost.
    pub sampling: f64,
    /// What surfaces absorbed, by material number.
    pub absorbed: Vec<f64>,
    /// What bodies of glass or liquid absorbed.
    pub absorbed_inside: f64,
    /// What left the scene.
    pub escaped: f64,
    /// What was given up at the limit of depth.
    pub depth_limit: f64,
}

impl Ledger {
    /// An empty ledger for this many materials.
    pub fn new(materials: usize) -> Self {
        Self { absorbed: vec![0.0; materials], ..Self::default() }
    }

    /// All that was absorbed.
    pub fn absorbed_total(&self) -> f64 {
        self.absorbed.iter().sum::<f64>() + self.absorbed_inside
    }

    /// Emitted + sampling − absorbed − escaped − depth limit, relative to emitted.
    pub fn balance(&self) -> f64 {
        let left = self.emitted + self.sampling - self.absorbed_total() - self.escaped - self.depth_limit;
        if self.emitted > 0.0 { left / self.emitted } else { left }
    }

    /// Multiplies all entries.
    pub fn scale(&mut self, factor: f64) {
        for entry in
            [&mut self.emitted, &mut self.sampling, &mut self.absorbed_inside, &mut self.escaped, &mut self.depth_limit]
        {
            *entry *= factor;
        }
        self.absorbed.iter_mut().for_each(|entry| *entry *= factor);
    }

    /// Adds another ledger's entries. Sums in a fixed order give the same bits again.
    pub fn add(&mut self, other: &Self) {
        self.emitted += other.emitted;
        self.sampling += other.sampling;
        self.absorbed_inside += other.absorbed_inside;
        self.escaped += other.escaped;
        self.depth_limit += other.depth_limit;
        if self.absorbed.len() < other.absorbed.len() {
            self.absorbed.resize(other.absorbed.len(), 0.0);
        }
        self.absorbed.iter_mut().zip(&other.absorbed).for_each(|(a, b)| *a += b);
    }
}
