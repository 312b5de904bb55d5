//! Translates the emission of media in the scene file to emission coefficients.

use super::{context::Resolver, spectra::Role};
use crate::{JsonPath, MediumBlackbodyFile, MediumEmissionFile};
use abbe_scene::medium::MediumEmission;
use abbe_scene::medium::field::ScalarField;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Spectrum;
use std::f64::consts::PI;
use std::sync::Arc;

impl Resolver<'_> {
    /// Resolves the emission of a medium. `absorption` is the absorption coefficient at density 1
    /// in 1/m, and `temperature` the temperature field in K. The scale of an emission with a
    /// `power` is arbitrary, because the scene builder sets it when the volume is known.
    pub(super) fn medium_emission(
        &self,
        at: &JsonPath,
        file: &MediumEmissionFile,
        absorption: &Spectrum,
        temperature: Option<Arc<ScalarField>>,
    ) -> Result<MediumEmission> {
        let MediumEmissionFile { blackbody, spectrum, radiance, power } = file;
        if let Some(MediumBlackbodyFile { temperature: uniform }) = blackbody {
            if let Some(kelvin) = uniform {
                return Ok(MediumEmission::blackbody(absorption, *kelvin));
            }
            let missing = || Error::input("found no temperature").expected("`temperature`, or a grid that has one");
            let field = self.at(&at.key("blackbody"), temperature.ok_or_else(missing))?;
            return Ok(MediumEmission::thermal(absorption.clone(), field));
        }
        let missing = || Error::input("found neither").expected("one of `blackbody`, `spectrum`");
        let spectrum = self.at(at, spectrum.as_ref().ok_or_else(missing))?;
        let spectrum = self.spectrum(&at.key("spectrum"), spectrum, Role::Light)?;
        let normalised = spectrum.scaled(1.0 / spectrum.integral());
        Ok(MediumEmission::uniform(match (radiance, power) {
            (Some(radiance), _) => absorption.product(&normalised).scaled(*radiance),
            (None, Some(power)) => normalised.scaled(power / (4.0 * PI)),
            (None, None) => {
                return Err(self.source.fault(at, "found none of the keys it needs", "exactly one of radiance, power"));
            }
        }))
    }
}
