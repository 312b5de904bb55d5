//! The quantities that a meter measures.

use abbe_spectra::spectrum::{LUMENS_PER_WATT, MELANOPIC_W_PER_LM_OF_D65, Observer};
use std::sync::OnceLock;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Illuminance in lx; for a surface, the mean illuminance.
    Illuminance,
    Irradiance,
    SpectralIrradiance,
    Luminance,
    Radiance,
    LuminousFlux,
    RadiantFlux,
    /// Photosynthetic photon flux density: photons of 400–700 nm, in µmol/m²/s.
    Ppfd,
    /// Irradiance weighted by the action spectrum of the S cones, in W/m² (CIE S 026).
    SConeOpic,
    MConeOpic,
    LConeOpic,
    Rhodopic,
    Melanopic,
    /// The illuminance of D65 that has the same melanopic irradiance, in lx (CIE S 026).
    MelanopicEdi,
    /// Illuminance, as a percentage of the horizontal illuminance from the unobstructed sky.
    DaylightFactor,
    ColourTemperature,
    ColourRendering,
    Tm30Rf,
    Tm30Rg,
    /// Unified glare rating (CIE 117) for a view along the normal.
    UnifiedGlareRating,
}

/// How the readings of a quantity are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuantityKind {
    /// One integral over the spectrum.
    Integral,
    /// The spectrum itself.
    Spectrum,
    /// A function of the spectrum.
    OfSpectrum,
}

impl QuantityKind {
    /// The number of spectral bands of a measurement: none, bands of 5 nm for a spectrum, and bands
    /// of 2.5 nm for a function of the spectrum.
    pub fn bands(self) -> u32 {
        match self {
            Self::Integral => 0,
            Self::Spectrum => 94,
            Self::OfSpectrum => 188,
        }
    }
}

/// The function of wavelength that weights the light of a quantity.
enum WavelengthWeight {
    Luminous,
    Radiometric,
    Photosynthetic,
    /// An action spectrum of [`Observer::alpha_opic`].
    AlphaOpic(usize),
}

/// The Avogadro constant times the Planck constant times the speed of light, in J·m/mol.
const MOLAR_PLANCK: f64 = 6.022_140_76e23 * 6.626_070_15e-34 * 299_792_458.0;

impl Quantity {
    pub const ALL: [Self; 20] = [
        Self::Illuminance,
        Self::Irradiance,
        Self::SpectralIrradiance,
        Self::Luminance,
        Self::Radiance,
        Self::LuminousFlux,
        Self::RadiantFlux,
        Self::Ppfd,
        Self::SConeOpic,
        Self::MConeOpic,
        Self::LConeOpic,
        Self::Rhodopic,
        Self::Melanopic,
        Self::MelanopicEdi,
        Self::DaylightFactor,
        Self::ColourTemperature,
        Self::ColourRendering,
        Self::Tm30Rf,
        Self::Tm30Rg,
        Self::UnifiedGlareRating,
    ];

    /// The name, the unit and the weight of the wavelengths.
    fn definition(self) -> (&'static str, &'static str, WavelengthWeight) {
        use WavelengthWeight::{AlphaOpic, Luminous, Photosynthetic, Radiometric};
        match self {
            Self::Illuminance => ("illuminance", "lx", Luminous),
            Self::Irradiance => ("irradiance", "W/m²", Radiometric),
            Self::SpectralIrradiance => ("spectral_irradiance", "W/m²/nm", Radiometric),
            Self::Luminance => ("luminance", "cd/m²", Luminous),
            Self::Radiance => ("radiance", "W/m²/sr", Radiometric),
            Self::LuminousFlux => ("luminous_flux", "lm", Luminous),
            Self::RadiantFlux => ("radiant_flux", "W", Radiometric),
            Self::Ppfd => ("ppfd", "µmol/m²/s", Photosynthetic),
            Self::SConeOpic => ("s_cone_opic", "W/m²", AlphaOpic(0)),
            Self::MConeOpic => ("m_cone_opic", "W/m²", AlphaOpic(1)),
            Self::LConeOpic => ("l_cone_opic", "W/m²", AlphaOpic(2)),
            Self::Rhodopic => ("rhodopic", "W/m²", AlphaOpic(3)),
            Self::Melanopic => ("melanopic", "W/m²", AlphaOpic(4)),
            Self::MelanopicEdi => ("melanopic_edi", "lx", AlphaOpic(4)),
            Self::DaylightFactor => ("daylight_factor", "%", Luminous),
            Self::ColourTemperature => ("colour_temperature", "K", Luminous),
            Self::ColourRendering => ("colour_rendering", "1", Luminous),
            Self::Tm30Rf => ("tm30_rf", "1", Luminous),
            Self::Tm30Rg => ("tm30_rg", "1", Luminous),
            Self::UnifiedGlareRating => ("ugr", "1", Luminous),
        }
    }

    /// The name in scene files and reports.
    pub fn name(self) -> &'static str {
        self.definition().0
    }

    pub fn unit(self) -> &'static str {
        self.definition().1
    }

    pub fn kind(self) -> QuantityKind {
        if self == Self::SpectralIrradiance {
            QuantityKind::Spectrum
        } else if matches!(self, Self::ColourTemperature | Self::ColourRendering | Self::Tm30Rf | Self::Tm30Rg) {
            QuantityKind::OfSpectrum
        } else {
            QuantityKind::Integral
        }
    }

    /// Returns true if the quantity is a radiance or a luminance, so that the sensor must be a
    /// cone.
    pub fn is_radiance(self) -> bool {
        matches!(self, Self::Luminance | Self::Radiance)
    }

    /// Returns true if the quantity is a flux, so that the sensor must be a surface.
    pub fn is_flux(self) -> bool {
        matches!(self, Self::LuminousFlux | Self::RadiantFlux)
    }

    /// The observer whose function ȳ weights the wavelengths. The integral times
    /// [`LUMENS_PER_WATT`] and [`Self::scale`] is the quantity, or the illuminance for a function
    /// of the spectrum and for the glare rating.
    pub fn observer(self) -> &'static Observer {
        match self.definition().2 {
            WavelengthWeight::Luminous => Observer::cie1931(),
            WavelengthWeight::Radiometric => Observer::radiometric(),
            WavelengthWeight::Photosynthetic => photosynthetic(),
            WavelengthWeight::AlphaOpic(number) => Observer::alpha_opic()[number],
        }
    }

    /// The factor that converts the integral of [`Self::observer`] to the unit of the quantity.
    pub fn scale(self) -> f64 {
        match self.definition().2 {
            WavelengthWeight::Luminous => 1.0,
            WavelengthWeight::AlphaOpic(_) if self == Self::MelanopicEdi => {
                1.0 / (LUMENS_PER_WATT * MELANOPIC_W_PER_LM_OF_D65)
            }
            WavelengthWeight::Radiometric | WavelengthWeight::Photosynthetic | WavelengthWeight::AlphaOpic(_) => {
                1.0 / LUMENS_PER_WATT
            }
        }
    }
}

/// The observer that counts photons of 400–700 nm, in µmol/J.
fn photosynthetic() -> &'static Observer {
    static OBSERVER: OnceLock<Observer> = OnceLock::new();
    OBSERVER.get_or_init(|| {
        let micromoles_per_joule = |nm: f64| 1e6 * nm * 1e-9 / MOLAR_PLANCK;
        Observer::with_luminosity(
            "ppfd",
            |nm| {
                if (400.0..=700.0).contains(&nm) { micromoles_per_joule(nm) } else { 0.0 }
            },
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::library;

    /// Light of 1 W at 555 nm has 4.64 µmol/s of photons, and D65 has 1 lx of melanopic EDI per lx.
    #[test]
    fn quantities_have_their_units() {
        let line = Observer::xyz_bar(Quantity::Ppfd.observer(), 555.0)[1];
        assert!((line - 4.639_5).abs() < 1e-3, "{line}");
        let d65 = library::find("D65").unwrap().spectrum;
        let lux = |quantity: Quantity| quantity.observer().xyz(&d65)[1] * LUMENS_PER_WATT * quantity.scale();
        let ratio = lux(Quantity::MelanopicEdi) / lux(Quantity::Illuminance);
        assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
        for quantity in Quantity::ALL {
            assert!(Quantity::ALL.iter().filter(|other| other.name() == quantity.name()).count() == 1);
        }
    }
}
