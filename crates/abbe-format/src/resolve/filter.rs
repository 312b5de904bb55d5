//! Translates the polarising filters of the scene file to layers.

use super::{context::Resolver, spectra::Role};
use crate::{
    BeamFile, CircularPolariserFile, DiscFile, HandednessFile, JsonPath, LiquidCrystalFile, PolariserFile,
    PolarisingFilterFile, RetarderFile, SpectrumFile, StressFile,
};
use abbe_optics::bsdf::{FilterElement, FilterLayer, PolarisingFilter, RetardanceField};
use abbe_optics::texture::SurfaceScalar;
use abbe_polarisation::crystal::Crystal;
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::{BAND_NM, Outside, Spectrum};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

impl Resolver<'_> {
    /// Resolves a filter. `at` is the place of the object that holds its only key.
    pub(super) fn filter(&self, at: &JsonPath, file: &PolarisingFilterFile) -> Result<PolarisingFilter> {
        let mut layers = Vec::new();
        self.add_filter(at, file, &mut layers)?;
        self.at(at, PolarisingFilter::new(layers))
    }

    fn add_filter(&self, at: &JsonPath, file: &PolarisingFilterFile, layers: &mut Vec<FilterLayer>) -> Result<()> {
        match file {
            PolarisingFilterFile::Polariser(file) => layers.push(self.polariser(&at.key("polariser"), file)?),
            PolarisingFilterFile::Retarder(file) => layers.push(self.retarder(&at.key("retarder"), file)?),
            PolarisingFilterFile::Stress(file) => layers.push(stress(file)),
            PolarisingFilterFile::CircularPolariser(file) => layers.extend(circular_polariser(file)),
            PolarisingFilterFile::LiquidCrystal(file) => {
                layers.push(self.liquid_crystal(&at.key("liquid_crystal"), file)?);
            }
            PolarisingFilterFile::Filters(files) => {
                let at = at.key("filters");
                for (i, file) in files.iter().enumerate() {
                    self.add_filter(&at.index(i), file, layers)?;
                }
            }
        }
        Ok(())
    }

    fn polariser(&self, at: &JsonPath, file: &PolariserFile) -> Result<FilterLayer> {
        let PolariserFile { axis, k1, k2 } = file;
        let fraction = |key: &str, file: &Option<SpectrumFile>, default: f64| match file {
            Some(file) => self.spectrum(&at.key(key), file, Role::Reflectance),
            None => Ok(Spectrum::constant(default)),
        };
        let element = FilterElement::Polariser { k1: fraction("k1", k1, 1.0)?, k2: fraction("k2", k2, 0.0)? };
        Ok(FilterLayer { element, axis_rad: axis.to_radians(), field: RetardanceField::Uniform })
    }

    fn liquid_crystal(&self, at: &JsonPath, file: &LiquidCrystalFile) -> Result<FilterLayer> {
        let LiquidCrystalFile { retardance_nm, axis, twist, factor } = file;
        let retardance_nm = self.spectrum(&at.key("retardance_nm"), retardance_nm, Role::Coefficient)?;
        let factor = factor.as_ref().map(|factor| self.scalar(&at.key("factor"), factor)).transpose()?;
        let (retardance_nm, field, _) = varied(retardance_nm, factor, SurfaceScalar::Uniform(0.0));
        // Light along the molecules is the slower one.
        let axis_rad = axis.to_radians() + FRAC_PI_2;
        let element = FilterElement::TwistedRetarder { retardance_nm, twist_rad: twist.to_radians() };
        Ok(FilterLayer { element, axis_rad, field })
    }

    fn retarder(&self, at: &JsonPath, file: &RetarderFile) -> Result<FilterLayer> {
        let RetarderFile { axis, factor, retardance_nm, crystal, thickness_nm } = file;
        let axis = self.scalar(&at.key("axis"), axis)?;
        let factor = factor.as_ref().map(|factor| self.scalar(&at.key("factor"), factor)).transpose()?;
        let mut axis_rad = 0.0;
        let retardance_nm = match (retardance_nm, crystal) {
            (Some(file), _) => self.spectrum(&at.key("retardance_nm"), file, Role::Coefficient)?,
            (None, crystal) => {
                let crystal = self.at(&at.key("crystal"), Crystal::find(crystal.as_deref().unwrap_or_default()))?;
                // Along the optic axis, the light of a negative crystal is the faster one.
                if crystal.at(0.5 * (BAND_NM.0 + BAND_NM.1)).birefringence() > 0.0 {
                    axis_rad += FRAC_PI_2;
                }
                let whole_nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
                let thickness = thickness_nm.unwrap_or(0.0);
                let path: Vec<f64> = whole_nm.iter().map(|&nm| crystal.path_difference_nm(thickness, nm)).collect();
                Spectrum::table(&whole_nm, &path, Outside::Hold)?
            }
        };
        let (retardance_nm, field, turn_rad) = varied(retardance_nm, factor, axis);
        axis_rad += turn_rad;
        Ok(FilterLayer { element: FilterElement::Retarder { retardance_nm }, axis_rad, field })
    }
}

/// Returns the retardance, how it varies over the sheet, and the angle in rad by which the axis
/// turns everywhere.
fn varied(
    retardance_nm: Spectrum,
    factor: Option<SurfaceScalar>,
    turn_deg: SurfaceScalar,
) -> (Spectrum, RetardanceField, f64) {
    match (factor.unwrap_or(SurfaceScalar::Uniform(1.0)), turn_deg) {
        (SurfaceScalar::Uniform(factor), SurfaceScalar::Uniform(turn)) => {
            (retardance_nm.scaled(factor), RetardanceField::Uniform, turn.to_radians())
        }
        (factor, turn_deg) => (retardance_nm, RetardanceField::Textured { factor, turn_deg }, 0.0),
    }
}

/// Returns the layer of a sheet under stress. The thickness cancels in both fields.
fn stress(file: &StressFile) -> FilterLayer {
    let StressFile { coefficient, axis, disc, beam } = file;
    let (stress_thickness, field) = match (disc, beam) {
        // In the middle of a disc, σ₁ − σ₂ is 8P/(πDh).
        (Some(DiscFile { load, diameter }), _) => (8.0 * load / (PI * diameter), RetardanceField::PressedDisc),
        // At the edges of a beam, σ is 6M/(hb²).
        (None, Some(BeamFile { moment, depth })) => (6.0 * moment / (depth * depth), RetardanceField::BentBeam),
        (None, None) => (0.0, RetardanceField::Uniform),
    };
    let retardance_nm = Spectrum::constant(1e9 * coefficient * stress_thickness);
    FilterLayer { element: FilterElement::Retarder { retardance_nm }, axis_rad: axis.to_radians(), field }
}

/// Returns the layers of a circular polariser: see [`abbe_polarisation::filter::circular_polariser`].
fn circular_polariser(file: &CircularPolariserFile) -> [FilterLayer; 2] {
    let CircularPolariserFile { handedness, axis, retardance_nm } = file;
    // Seen from the front, the light travels away, so the angle to the fast axis has the opposite
    // sign as for the receiver.
    let turn = match handedness {
        HandednessFile::Right => -FRAC_PI_4,
        HandednessFile::Left => FRAC_PI_4,
    };
    let axis_rad = axis.to_radians();
    let retardance_nm = Spectrum::constant(*retardance_nm);
    [
        FilterLayer { element: FilterElement::ideal_polariser(), axis_rad, field: RetardanceField::Uniform },
        FilterLayer {
            element: FilterElement::Retarder { retardance_nm },
            axis_rad: axis_rad + turn,
            field: RetardanceField::Uniform,
        },
    ]
}
