//! The mixture of a phase function over the wavelengths of a path.

use super::{Deflection, PhaseFunction};
use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_spectra::spectrum::{LANES, Lanes, Wavelengths};
use glam::DVec3;

/// The pdf from which a camera path with several wavelengths samples its direction in a medium.
///
/// Each wavelength has a fraction of it in proportion to its importance (the balance heuristic over
/// wavelengths; Wilkie et al., "Hero wavelength spectral sampling", 2014), so its weight is bounded
/// even if its phase function differs strongly from that at the hero wavelength. A phase function
/// that does not depend on the wavelength is the pdf itself.
#[derive(Debug, Clone, Copy)]
pub struct PhaseMixture<'a> {
    phase: &'a PhaseFunction,
    nm: Lanes,
    /// Of each wavelength; 0 in unused lanes.
    fractions: Lanes,
    count: usize,
}

impl<'a> PhaseMixture<'a> {
    /// Creates the mixture for a path with this importance of each of its wavelengths.
    pub fn new(phase: &'a PhaseFunction, wavelengths: &Wavelengths, importance: &Lanes) -> Self {
        let total: f64 = importance[..wavelengths.count].iter().sum();
        let mixed = wavelengths.count > 1 && total > 0.0 && phase.depends_on_wavelength();
        if !mixed {
            return Self::at(phase, wavelengths.nm[0]);
        }
        let fractions = importance.map(|value| value / total);
        Self { phase, nm: wavelengths.nm, fractions, count: wavelengths.count }
    }

    /// Creates the pdf of a single wavelength in nm.
    pub fn at(phase: &'a PhaseFunction, nm: f64) -> Self {
        Self { phase, nm: [nm; LANES], fractions: [1.0, 0.0, 0.0, 0.0], count: 1 }
    }

    /// Returns true if the phase function has no peak.
    pub fn is_smooth(&self) -> bool {
        matches!(self.phase, PhaseFunction::Isotropic | PhaseFunction::Rayleigh)
    }

    /// Returns the pdf per steradian of [`sample`](Self::sample). `deflection` is that of the path,
    /// whose direction is opposite to the light's.
    pub fn pdf(&self, deflection: Deflection) -> f64 {
        if self.count == 1 {
            return self.phase.reversed_pdf(deflection, self.nm[0]);
        }
        (0..self.count).map(|k| self.fractions[k] * self.phase.reversed_pdf(deflection, self.nm[k])).sum()
    }

    /// Samples the direction in which the path continues; see [`PhaseFunction::sample_reversed`].
    pub fn sample(&self, incoming: DVec3, [mut u, v]: [f64; 2]) -> DVec3 {
        let mut lane = 0;
        while lane + 1 < self.count && u >= self.fractions[lane] {
            u -= self.fractions[lane];
            lane += 1;
        }
        if self.count > 1 {
            u = (u / self.fractions[lane]).clamp(0.0, ONE_MINUS_ULP);
        }
        self.phase.sample_reversed(incoming, self.nm[lane], [u, v])
    }
}

const _: () = assert!(LANES == 4, "the fractions of a single wavelength list four lanes");

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};
    use abbe_spectra::spectrum::{Outside, Spectrum};

    fn chromatic() -> PhaseFunction {
        PhaseFunction::HenyeyGreenstein {
            g: Spectrum::table(&[400.0, 700.0], &[0.95, 0.1], Outside::Hold).expect("a table of two values"),
        }
    }

    /// Each wavelength's mean weight is 1, and no weight exceeds the inverse of its fraction.
    #[test]
    fn samples_follow_the_mixture_and_weights_are_bounded() {
        let phase = chromatic();
        let wavelengths = Wavelengths::new([420.0, 500.0, 600.0, 690.0]);
        let mixture = PhaseMixture::new(&phase, &wavelengths, &[1.0, 2.0, 4.0, 3.0]);
        let mut stream = Stream::new(Seed::new(5), Purpose::Camera, 0, 0);
        let n = 40_000;
        let mut sums = [0.0; LANES];
        for _ in 0..n {
            let deflection = Deflection::between(DVec3::Z, mixture.sample(DVec3::Z, stream.pair()));
            for (k, sum) in sums.iter_mut().enumerate() {
                let weight = phase.eval(deflection, wavelengths.nm[k]) / mixture.pdf(deflection);
                assert!(weight <= 1.0 / [0.1, 0.2, 0.4, 0.3][k] + 1e-9, "lane {k}: {weight}");
                *sum += weight / f64::from(n);
            }
        }
        for (k, mean) in sums.iter().enumerate() {
            assert!((mean - 1.0).abs() < 0.05, "lane {k}: {mean}");
        }
    }

    #[test]
    fn a_grey_phase_function_is_sampled_as_it_is() {
        let phase = PhaseFunction::HenyeyGreenstein { g: Spectrum::constant(0.5) };
        let wavelengths = Wavelengths::new([420.0, 500.0, 600.0, 690.0]);
        let mixture = PhaseMixture::new(&phase, &wavelengths, &[1.0, 2.0, 4.0, 3.0]);
        let deflection = Deflection::horizontal(0.3);
        assert_eq!(mixture.pdf(deflection), phase.eval(deflection, 420.0));
        assert_eq!(mixture.sample(DVec3::Z, [0.2, 0.7]), phase.sample(DVec3::Z, 420.0, [0.2, 0.7]));
    }
}
