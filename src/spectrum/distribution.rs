//! Drawing wavelengths from a spectrum.

use super::continuum::Continuum;
use super::index::BandIndex;
use super::observer::Observer;
use super::sweep::sweep;
use super::{BAND_NM, Spectrum};

/// The share of [`WavelengthDistribution::important`] that follows what an eye sees; the rest follows the power.
const VISUAL_SHARE: f64 = 0.85;

/// How near, as a share of its width, a draw may come to the end of a stretch where the density vanishes.
const END_GUARD: f64 = 1e-6;

/// In steps of this many nm a distribution follows what an eye sees: near enough for importance, and the table stays in the
/// processor's nearest cache.
const VISUAL_STEP_NM: u32 = 5;

/// How many steps of the guide a stretch has on average: enough that most draws find theirs at once.
const GUIDE_STEPS: usize = 4;

/// A stretch with a linear density, with the reciprocals that spare the inner loop its divisions.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    lower: f64,
    /// The last number below its upper end.
    last: f64,
    width: f64,
    per_width: f64,
    /// Density per nm at the lower end, and how much higher it is at the upper end.
    density: f64,
    rise: f64,
    /// The probability of all before it, and the reciprocal of its own.
    before: f64,
    per_mass: f64,
}

/// A stretch before the total is known: its ends in nm, the weights per nm there, the mass of all before it and its own.
struct Part {
    ends: (f64, f64),
    weights: (f64, f64),
    before: f64,
    mass: f64,
}

impl Stretch {
    fn new(part: &Part, total: f64) -> Self {
        let (lower, upper) = part.ends;
        let width = upper - lower;
        Self {
            lower,
            last: upper.next_down(),
            width,
            per_width: width.recip(),
            density: part.weights.0 / total,
            rise: (part.weights.1 - part.weights.0) / total,
            before: part.before / total,
            // Infinite of the smallest masses, and 0 times that would be no number.
            per_mass: (total / part.mass).min(f64::MAX),
        }
    }

    #[inline]
    fn at(&self, nm: f64) -> f64 {
        self.density + ((nm - self.lower) * self.per_width).min(1.0) * self.rise
    }

    /// The wavelength below which a share `v` of the stretch's mass lies.
    #[inline]
    fn quantile(&self, v: f64) -> f64 {
        let (from, to) = (self.density, self.density + self.rise);
        // The root of the quadratic in the form without cancellation.
        let root = (from * from + v * (self.rise * (from + to))).max(0.0).sqrt();
        let mut t = v * (from + to) / (from + root);
        if from.min(to) < 1e-9 * from.max(to) {
            t = if t > 0.0 { t.clamp(END_GUARD, 1.0 - END_GUARD) } else { END_GUARD };
        }
        (self.lower + t * self.width).min(self.last)
    }
}

/// A density over wavelength, in 1/nm, which is piecewise linear with knots wherever the spectrum (and the
/// observer) has one; lines are narrow stretches with their exact probability.
///
/// The density is what it is between knots, not the product of the spectrum and the observer there: an estimate
/// that divides by it is right whatever it is, as long as it is positive where the spectrum is.
#[derive(Debug, Clone, PartialEq)]
pub struct WavelengthDistribution {
    /// Stretches of positive probability in ascending order; between them the density is 0.
    stretches: Vec<Stretch>,
    by_wavelength: BandIndex,
    /// The probability of all before each stretch, and infinity at the end.
    before: Vec<f64>,
    /// For equal steps of probability, a power of two of them, the stretch that holds the step's lower end.
    guide: Vec<u32>,
}

impl WavelengthDistribution {
    /// A density proportional to the spectrum; none if it has no power.
    pub fn new(spectrum: &Spectrum) -> Option<Self> {
        Self::weighted(spectrum, None)
    }

    /// A density that mixes 85 % of spectrum × (x̄ + ȳ + z̄), these taken every 5 nm, with 15 % of the spectrum alone, so that no
    /// wavelength with power is left out; none if there is no power.
    pub fn important(spectrum: &Spectrum, observer: &Observer) -> Option<Self> {
        let nm = (BAND_NM.0 as u32..=BAND_NM.1 as u32).step_by(VISUAL_STEP_NM as usize).map(f64::from);
        let knots: Vec<(f64, f64)> = nm.map(|nm| (nm, observer.sum_bar().at(nm))).collect();
        let seen = Spectrum::smooth(Continuum::from_knots(&knots));
        let (all, visible) = (spectrum.integral(), spectrum.product_integral(&seen));
        let ratio = all / visible;
        if ratio.is_finite() {
            return Self::weighted(spectrum, Some((&seen, VISUAL_SHARE * ratio, 1.0 - VISUAL_SHARE)));
        }
        Self::weighted(spectrum, None)
    }

    /// A density ∝ Φ, or ∝ Φ·(a·w + b) at the knots of Φ and w, given `(w, a, b)`.
    fn weighted(spectrum: &Spectrum, weight: Option<(&Spectrum, f64, f64)>) -> Option<Self> {
        let peak = spectrum.max();
        if !(peak.is_finite() && peak > 0.0) {
            return None;
        }
        let one = Spectrum::constant(1.0);
        let (weight, a, b) = weight.unwrap_or((&one, 1.0, 0.0));
        let mut parts = Vec::new();
        let mut total = 0.0;
        sweep([spectrum, weight], |(lower, upper), [power, weight]| {
            let from = power.0 / peak * (a * weight.0 + b);
            let to = power.1 / peak * (a * weight.1 + b);
            let mass = (upper - lower) * (0.5 * from + 0.5 * to);
            if mass > 0.0 {
                parts.push(Part { ends: (lower, upper), weights: (from, to), before: total, mass });
                total += mass;
            }
        });
        (total > 0.0 && total.is_finite()).then(|| Self::normalised(&parts, total))
    }

    fn normalised(parts: &[Part], total: f64) -> Self {
        let stretches: Vec<Stretch> = parts.iter().map(|part| Stretch::new(part, total)).collect();
        let before: Vec<f64> = stretches.iter().map(|stretch| stretch.before).chain([f64::INFINITY]).collect();
        let steps = (GUIDE_STEPS * stretches.len()).next_power_of_two();
        let mut guide = Vec::with_capacity(steps);
        let mut stretch = 0;
        for step in 0..steps {
            while before[stretch + 1] <= step as f64 / steps as f64 {
                stretch += 1;
            }
            guide.push(stretch as u32);
        }
        let by_wavelength = BandIndex::new(stretches.iter().map(|stretch| stretch.lower));
        Self { stretches, by_wavelength, before, guide }
    }

    /// The wavelength in nm, and its density in 1/nm, for a number `u` in [0, 1). Larger `u` give longer
    /// wavelengths, so that stratified `u` stratify the spectrum. The density is positive and equals
    /// [`pdf`](Self::pdf) of the wavelength.
    #[inline(always)]
    pub fn sample(&self, u: f64) -> (f64, f64) {
        // Exact, as there are a power of two of steps.
        let step = ((u * self.guide.len() as f64) as usize).min(self.guide.len() - 1);
        let mut i = self.guide[step] as usize;
        while self.before[i + 1] <= u {
            i += 1;
        }
        let stretch = &self.stretches[i];
        let nm = stretch.quantile(((u - stretch.before) * stretch.per_mass).clamp(0.0, 1.0));
        (nm, stretch.at(nm))
    }

    /// The density at a wavelength, in 1/nm; 0 outside the band.
    #[inline]
    pub fn pdf(&self, nm: f64) -> f64 {
        let first = self.stretches[0].lower;
        let last = self.stretches[self.stretches.len() - 1].last;
        if !(nm >= first && nm <= last) {
            return 0.0;
        }
        let stretch = &self.stretches[self.by_wavelength.find(nm, |i| self.stretches[i].lower)];
        if nm <= stretch.last { stretch.at(nm) } else { 0.0 }
    }
}
