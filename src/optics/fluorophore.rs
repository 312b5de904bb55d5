//! Fluorescence: a fluorophore absorbs photons and emits photons of other wavelengths.
//!
//! The model is the factorised bispectral matrix (Donaldson 1954, "Spectrophotometry of Fluorescent
//! Pigments"). The probability of absorption depends on the arriving wavelength alone. The spectrum
//! of the emission does not depend on the arriving wavelength. The number of photons never grows.
//! The energy of a photon is proportional to 1/λ, so the emitted power is the absorbed power
//! multiplied by the quantum yield and by λ_i/λ_o (Stokes loss).

use crate::error::{Error, Result};
use crate::spectrum::{Observer, Spectrum, WavelengthDistribution};

/// A fluorophore.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluorophore {
    absorptance: Spectrum,
    /// a(λ)·λ in nm.
    excitation: Spectrum,
    quantum_yield: f64,
    /// The emitted power per nm: e(λ)/λ, where e is the number of photons per nm with the integral
    /// 1.
    power: Spectrum,
    /// The integral of `power` over the band, in 1/nm. It is the mean of 1/λ over the emitted
    /// photons.
    mean_inverse_nm: f64,
    wavelengths: WavelengthDistribution,
}

/// The fractions of the absorbed power that a fluorophore does not emit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FluorescenceLosses {
    /// The Stokes loss: the emitted photons have less energy than the absorbed photons.
    pub stokes: f64,
    /// The quantum loss: some of the absorbed photons are not emitted.
    pub quantum: f64,
}

impl Fluorophore {
    /// Creates a fluorophore.
    ///
    /// `absorptance` is the fraction of the arriving photons that the fluorophore absorbs.
    /// `emission` is the relative number of emitted photons per nm, at any scale. `quantum_yield`
    /// is the number of emitted photons, divided by the number of absorbed photons.
    ///
    /// # Errors
    /// Returns an error if the absorptance or the quantum yield is outside \[0, 1\], or if the
    /// emission is negative or has no power in the band, or if one of them contains spectral lines.
    pub fn new(absorptance: Spectrum, emission: &Spectrum, quantum_yield: f64) -> Result<Self> {
        if !(0.0..=1.0).contains(&quantum_yield) {
            let error = Error::input(format!("a quantum yield of {quantum_yield}"));
            return Err(error.expected("a number from 0 to 1"));
        }
        if !(absorptance.min() >= 0.0 && absorptance.max() <= 1.0) {
            let [least, most] = [absorptance.min(), absorptance.max()];
            return Err(
                Error::input(format!("an absorptance between {least} and {most}")).expected("values from 0 to 1")
            );
        }
        let photons = emission.integral();
        if !(emission.min() >= 0.0 && photons > 0.0 && photons.is_finite()) {
            return Err(Error::input("an emission without photons between 360 nm and 830 nm")
                .expected("values of 0 or more, and a value above 0 in the band"));
        }
        if absorptance.line_share() > 0.0 || emission.line_share() > 0.0 {
            return Err(
                Error::input("an absorptance or an emission with spectral lines").expected("continuous spectra")
            );
        }
        let power = emission.scaled(1.0 / photons).product(&Spectrum::power_law(1.0, 1.0, -1.0)?);
        let wavelengths = WavelengthDistribution::visually_weighted(&power, Observer::cie1931())
            .ok_or_else(|| Error::input("an emission without power"))?;
        let excitation = absorptance.product(&Spectrum::power_law(1.0, 1.0, 1.0)?);
        let mean_inverse_nm = power.integral();
        Ok(Self { absorptance, excitation, quantum_yield, mean_inverse_nm, power, wavelengths })
    }

    /// Returns the fraction of the photons of the wavelength `nm` that the fluorophore absorbs.
    #[inline]
    pub fn absorptance(&self, nm: f64) -> f64 {
        self.absorptance.at(nm)
    }

    /// Returns the fraction of the photons that the fluorophore does not absorb, as a spectrum.
    pub fn transmittance(&self) -> Spectrum {
        self.absorptance.complement()
    }

    /// Returns the quantum yield.
    pub fn quantum_yield(&self) -> f64 {
        self.quantum_yield
    }

    /// Returns the spectrum of the emitted power, at an arbitrary scale.
    pub fn emitted_power(&self) -> &Spectrum {
        &self.power
    }

    /// Returns the distribution of the emitted wavelengths.
    pub fn wavelengths(&self) -> &WavelengthDistribution {
        &self.wavelengths
    }

    /// Returns the distribution of the absorbed photons in light of this power spectrum. Returns
    /// `None` if the fluorophore absorbs nothing.
    pub fn absorbed_wavelengths(&self, light: &Spectrum) -> Option<WavelengthDistribution> {
        WavelengthDistribution::new(&light.product(&self.absorptance))
    }

    /// Returns a(λ)·λ in nm. The product of this value and the power at `nm` is proportional to the
    /// number of absorbed photons.
    #[inline]
    pub fn excitation(&self, nm: f64) -> f64 {
        self.excitation.at(nm)
    }

    /// Returns [`Self::excitation`] as a spectrum.
    pub fn excitation_spectrum(&self) -> &Spectrum {
        &self.excitation
    }

    /// Returns the emitted power per nm at the wavelength `nm`, for an excitation of 1 W·nm. The
    /// excitation is the sum of power × [`Self::excitation`] over the arriving wavelengths.
    #[inline]
    pub fn emitted(&self, nm: f64) -> f64 {
        self.quantum_yield * self.power.at(nm)
    }

    /// Returns the bispectral factor Φ(λ_i → λ_o) per nm.
    pub fn bispectral_factor(&self, from_nm: f64, to_nm: f64) -> f64 {
        self.excitation(from_nm) * self.emitted(to_nm)
    }

    /// Returns the fraction of the arriving power at `nm` that the fluorophore emits again, at all
    /// wavelengths together.
    #[inline]
    pub fn emitted_fraction(&self, nm: f64) -> f64 {
        self.quantum_yield * self.excitation(nm) * self.mean_inverse_nm
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
