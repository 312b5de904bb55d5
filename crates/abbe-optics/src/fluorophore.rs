//! Fluorescence: a fluorophore absorbs photons and emits photons of other wavelengths.
//!
//! The model is the bispectral matrix (Donaldson 1954, "Spectrophotometry of Fluorescent
//! Pigments"). For a dye, it is factorised: the probability of absorption depends on the arriving
//! wavelength alone, and the spectrum of the emission does not depend on it. A measured matrix is a
//! sum of such terms. The number of photons never grows, and the energy of one is proportional to
//! 1/λ, so the emitted power is the absorbed power times the quantum yield and λ_i/λ_o (Stokes
//! loss).

use super::donaldson::DonaldsonMatrix;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Observer, Outside, Spectrum, WavelengthDistribution};
use std::ops::Range;

/// The light that a fluorophore emits after it absorbs photons of a range of wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct FluorescentEmission {
    /// a(λ)·λ in nm.
    excitation: Spectrum,
    quantum_yield: f64,
    /// Per nm: e(λ)/λ, where e is the number of photons per nm with the integral 1.
    power: Spectrum,
    /// The integral of `power` over the band in 1/nm: the mean of 1/λ over the emitted photons.
    mean_inverse_nm: f64,
    wavelengths: WavelengthDistribution,
}

/// A fluorophore, with the bispectral matrix Φ(λ_i → λ_o) = Σ a_r(λ_i) λ_i q e_r(λ_o)/λ_o. A dye
/// has one term. A measured matrix has one for each excitation wavelength of the file, with a
/// triangle as a_r, so that the sum interpolates between the wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluorophore {
    /// The sum of a_r.
    absorptance: Spectrum,
    /// The sum of a_r(λ)·λ.
    excitation: Spectrum,
    quantum_yield: f64,
    emissions: Vec<FluorescentEmission>,
    /// Of a matrix. Empty if there is only one term.
    excitation_nm: Vec<f64>,
    /// Per nm, of all terms.
    mean_power: Spectrum,
    wavelengths: WavelengthDistribution,
    /// True if light below the band excites the fluorophore in this render.
    ultraviolet: bool,
    /// The number of the fluorophore in the scene, which assigns it.
    pub number: usize,
    /// The number of the first emission in the scene, which assigns it.
    pub first_emission: usize,
}

/// The fractions of the absorbed power that a fluorophore does not emit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FluorescenceLosses {
    /// The Stokes loss: emitted photons have less energy than absorbed ones.
    pub stokes: f64,
    /// The quantum loss: some absorbed photons are not emitted.
    pub quantum: f64,
}

impl FluorescentEmission {
    /// `emission` is in relative photons per nm; negative or dark in the band is an error.
    fn new(absorptance: &Spectrum, emission: &Spectrum, quantum_yield: f64) -> Result<Self> {
        let photons = emission.integral();
        if !(emission.min() >= 0.0 && photons > 0.0 && photons.is_finite()) {
            return Err(Error::input("an emission without photons between 360 nm and 830 nm")
                .expected("values of 0 or more, and a value above 0 in the band"));
        }
        let power = emission.scaled(1.0 / photons).product(&Spectrum::power_law(1.0, 1.0, -1.0)?);
        let wavelengths = visible_wavelengths(&power)?;
        let excitation = excitation_of(absorptance)?;
        let mean_inverse_nm = power.integral();
        Ok(Self { excitation, quantum_yield, mean_inverse_nm, power, wavelengths })
    }

    /// Returns a_r(λ)·λ in nm, which times the power is proportional to absorbed photons.
    #[inline]
    pub fn excitation(&self, nm: f64) -> f64 {
        self.excitation.at(nm)
    }

    /// Returns the emitted power per nm at the wavelength `nm` for an excitation of 1 W·nm: the sum
    /// of power × [`Self::excitation`] over the arriving wavelengths.
    #[inline]
    pub fn emitted(&self, nm: f64) -> f64 {
        self.quantum_yield * self.power.at(nm)
    }

    /// Returns the emitted power at all wavelengths for an excitation of 1 W·nm.
    #[inline]
    pub fn emitted_power(&self) -> f64 {
        self.quantum_yield * self.mean_inverse_nm
    }

    /// Returns the distribution of the emitted wavelengths.
    pub fn wavelengths(&self) -> &WavelengthDistribution {
        &self.wavelengths
    }
}

impl Fluorophore {
    /// Creates a fluorophore whose emission spectrum does not depend on the absorbed wavelength.
    /// `absorptance` is the absorbed fraction of the arriving photons, `emission` the relative
    /// number of emitted photons per nm, at any scale, and `quantum_yield` the number of emitted
    /// photons per absorbed photon. Returns an error if the absorptance or the quantum yield is
    /// outside \[0, 1\], the emission is negative or has no power in the band, or one of them
    /// contains spectral lines.
    pub fn new(absorptance: Spectrum, emission: &Spectrum, quantum_yield: f64) -> Result<Self> {
        let below = absorptance.ultraviolet_range();
        let [least, most] = [absorptance.min().min(below.0), absorptance.max().max(below.1)];
        if !(least >= 0.0 && most <= 1.0) {
            return Err(
                Error::input(format!("an absorptance between {least} and {most}")).expected("values from 0 to 1")
            );
        }
        Self::with_absorption(absorptance, emission, quantum_yield)
    }

    /// Creates the fluorophore of a medium, with the dye's absorption coefficient in 1/m, without
    /// upper limit, as the absorptance, or returns the errors of [`Self::new`].
    pub fn with_absorption(absorption: Spectrum, emission: &Spectrum, quantum_yield: f64) -> Result<Self> {
        if !(0.0..=1.0).contains(&quantum_yield) {
            let error = Error::input(format!("a quantum yield of {quantum_yield}"));
            return Err(error.expected("a number from 0 to 1"));
        }
        if absorption.line_fraction() > 0.0 || emission.line_fraction() > 0.0 {
            return Err(
                Error::input("an absorptance or an emission with spectral lines").expected("continuous spectra")
            );
        }
        let emissions = vec![FluorescentEmission::new(&absorption, emission, quantum_yield)?];
        Self::of_emissions(absorption, quantum_yield, emissions, Vec::new())
    }

    /// Creates a fluorophore from a measured bispectral matrix. The quantum yield is 1, so the
    /// absorptance is the emitted photons per arriving photon. Returns an error if they exceed 1 at
    /// an excitation wavelength, or the matrix emits nothing in the band.
    pub fn of_matrix(matrix: &DonaldsonMatrix) -> Result<Self> {
        let DonaldsonMatrix { excitation_nm, emission_nm, factors } = matrix;
        let (mut yields, mut photons) = (Vec::new(), Vec::new());
        for (&nm, factors) in excitation_nm.iter().zip(factors) {
            // The factors are ratios of powers, and the energy of a photon is proportional to 1/λ.
            let counts: Vec<f64> =
                factors.iter().zip(emission_nm).map(|(factor, emitted)| factor * emitted / nm).collect();
            let spectrum = Spectrum::table(emission_nm, &counts, Outside::Zero)?;
            let emitted = spectrum.integral();
            if emitted > 1.0 {
                let what = format!("{emitted:.4} emitted photons for each photon of {nm} nm");
                return Err(Error::input(what).expected("at most 1 emitted photon for each absorbed photon"));
            }
            yields.push(emitted);
            photons.push(spectrum);
        }
        let absorptance = Spectrum::table(excitation_nm, &yields, Outside::Zero)?;
        let (mut emissions, mut rows_nm) = (Vec::new(), Vec::new());
        for (i, spectrum) in photons.iter().enumerate() {
            let near = i.saturating_sub(1)..(i + 2).min(excitation_nm.len());
            let triangle: Vec<f64> = near.clone().map(|k| if k == i { yields[i] } else { 0.0 }).collect();
            let triangle = Spectrum::table(&excitation_nm[near], &triangle, Outside::Zero)?;
            if triangle.integral() + triangle.ultraviolet_sum(&|_| 1.0) > 0.0 {
                emissions.push(FluorescentEmission::new(&triangle, spectrum, 1.0)?);
                rows_nm.push(excitation_nm[i]);
            }
        }
        if emissions.is_empty() {
            return Err(Error::input("a matrix without emission between 360 nm and 830 nm"));
        }
        Self::of_emissions(absorptance, 1.0, emissions, rows_nm)
    }

    fn of_emissions(
        absorptance: Spectrum,
        quantum_yield: f64,
        emissions: Vec<FluorescentEmission>,
        excitation_nm: Vec<f64>,
    ) -> Result<Self> {
        let weight = |emission: &FluorescentEmission| emission.excitation.integral().max(f64::MIN_POSITIVE);
        let total: f64 = emissions.iter().map(weight).sum();
        let parts: Vec<(f64, &Spectrum)> =
            emissions.iter().map(|emission| (weight(emission) / total, &emission.power)).collect();
        let mean_power = Spectrum::mix(&parts);
        let wavelengths = visible_wavelengths(&mean_power)?;
        let excitation = excitation_of(&absorptance)?;
        Ok(Self {
            absorptance,
            excitation,
            quantum_yield,
            emissions,
            excitation_nm,
            mean_power,
            wavelengths,
            ultraviolet: false,
            number: 0,
            first_emission: 0,
        })
    }

    /// Assigns the numbers of the fluorophore and its first emission from `next` on.
    pub fn assign_numbers(&mut self, next: &mut (usize, usize)) {
        (self.number, self.first_emission) = *next;
        *next = (next.0 + 1, next.1 + self.emissions.len());
    }

    /// Returns the fraction of the photons of the wavelength `nm` that the fluorophore absorbs.
    #[inline]
    pub fn absorptance(&self, nm: f64) -> f64 {
        self.absorptance.at(nm)
    }

    /// Returns the absorptance as a spectrum.
    pub fn absorptance_spectrum(&self) -> &Spectrum {
        &self.absorptance
    }

    /// Returns the quantum yield.
    pub fn quantum_yield(&self) -> f64 {
        self.quantum_yield
    }

    /// Returns the terms of the bispectral matrix.
    pub fn emissions(&self) -> &[FluorescentEmission] {
        &self.emissions
    }

    /// Returns the indices of the terms that light of the wavelength `nm` excites.
    #[inline]
    pub fn excited_by(&self, nm: f64) -> Range<usize> {
        if self.excitation_nm.is_empty() {
            return 0..1;
        }
        let above = self.excitation_nm.partition_point(|row| *row < nm);
        above.saturating_sub(1)..(above + 1).min(self.excitation_nm.len())
    }

    /// Returns the emitted power, at any scale, in equal light at all absorbed wavelengths.
    pub fn emitted_power(&self) -> &Spectrum {
        &self.mean_power
    }

    /// Returns the distribution of emitted wavelengths in equal light at all absorbed ones.
    pub fn wavelengths(&self) -> &WavelengthDistribution {
        &self.wavelengths
    }

    /// Returns the distribution of the photons absorbed from this light, `None` if there are none.
    pub fn absorbed_wavelengths(&self, light: &Spectrum) -> Option<WavelengthDistribution> {
        let absorbed = light.product(&self.absorptance);
        let band = WavelengthDistribution::new(&absorbed);
        if !self.ultraviolet {
            return band;
        }
        absorbed.extended_wavelengths(band.as_ref(), absorbed.integral(), &|_| 1.0, 1.0)
    }

    /// Returns the power that the fluorophore absorbs below the band in this light.
    pub fn absorbed_ultraviolet(&self, light: &Spectrum) -> f64 {
        light.ultraviolet_sum(&|nm| self.absorptance.at(nm))
    }

    /// Lets light below the band excite the fluorophore.
    pub fn add_ultraviolet(&mut self) {
        self.ultraviolet = true;
    }

    /// Returns the visual importance X + Y + Z that 1 W of light excites, by its wavelength in nm.
    /// Where the fluorophore absorbs most, it absorbs all light.
    pub fn visual_value(&self, observer: &Observer) -> impl Fn(f64) -> f64 + '_ {
        let most = self.absorptance.max().max(self.absorptance.ultraviolet_range().1);
        let emitted: f64 = observer.xyz(&self.mean_power).iter().sum();
        let per_excitation = if most > 0.0 { self.quantum_yield * emitted / most } else { 0.0 };
        move |nm| per_excitation * self.excitation.at(nm)
    }

    /// Returns the sum of a_r(λ)·λ as a spectrum, in nm.
    pub fn excitation_spectrum(&self) -> &Spectrum {
        &self.excitation
    }

    /// Returns the bispectral factor Φ(λ_i → λ_o) per nm.
    #[inline]
    pub fn bispectral_factor(&self, from_nm: f64, to_nm: f64) -> f64 {
        let excited = &self.emissions[self.excited_by(from_nm)];
        excited.iter().map(|emission| emission.excitation(from_nm) * emission.emitted(to_nm)).sum()
    }

    /// Returns the fraction of the power at `nm` that is emitted again at all wavelengths.
    #[inline]
    pub fn emitted_fraction(&self, nm: f64) -> f64 {
        let excited = &self.emissions[self.excited_by(nm)];
        excited.iter().map(|emission| emission.excitation(nm) * emission.emitted_power()).sum()
    }

    /// Returns the fractions of the arriving power at `nm` that the fluorophore absorbs and does
    /// not emit again. The Stokes loss is negative if the emitted photons have more energy.
    #[inline]
    pub fn losses(&self, nm: f64) -> FluorescenceLosses {
        let absorbed = self.absorptance.at(nm);
        FluorescenceLosses {
            stokes: self.quantum_yield * absorbed - self.emitted_fraction(nm),
            quantum: (1.0 - self.quantum_yield) * absorbed,
        }
    }
}

/// Returns a(λ)·λ in nm.
fn excitation_of(absorptance: &Spectrum) -> Result<Spectrum> {
    Ok(absorptance.product(&Spectrum::power_law(1.0, 1.0, 1.0)?))
}

/// Returns a distribution of the wavelengths of an emission that prefers visible wavelengths.
fn visible_wavelengths(power: &Spectrum) -> Result<WavelengthDistribution> {
    WavelengthDistribution::visually_weighted(power, Observer::cie1931())
        .ok_or_else(|| Error::input("an emission without power"))
}
