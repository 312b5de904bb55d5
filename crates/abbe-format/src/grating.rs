//! Diffraction gratings in the scene file.

use crate::prelude::*;
use crate::{JsonPath, SpectrumFile, check, forms, spectrum::SpectrumUse};
use abbe_spectra::error::Result;
use std::f64::consts::PI;

/// A diffraction grating on a surface. Light of each wavelength leaves in the directions of the
/// orders. The surrounding medium is on both sides. The efficiencies are those of scalar theory.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GratingFile {
    /// Number of grooves per mm.
    #[schemars(range(min = 0.1, max = 10_000), extend("x-unit" = "1/mm"))]
    pub lines_per_mm: f64,
    /// Profile of the grooves.
    #[serde(default)]
    #[schemars(extend("x-default" = "a blaze at 500 nm in order 1"))]
    pub profile: GratingProfileFile,
    /// Fraction of the light that is reflected.
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-default" = "1, or 0 with `transmittance`"))]
    pub reflectance: Option<SpectrumFile>,
    /// Fraction of the light that is transmitted. The sum with `reflectance` is at most 1.
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-default" = "0"))]
    pub transmittance: Option<SpectrumFile>,
    /// Course of the grooves over the surface.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub grooves: GroovesFile,
    /// Angle by which parallel grooves appear turned counter-clockwise. At 0, they run along v, and
    /// positive orders lean towards u.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "degrees"))]
    pub angle: f64,
}

/// The course of the grooves of a grating.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Course of grooves")]
pub enum GroovesFile {
    /// Parallel to v.
    #[default]
    Parallel,
    /// Circles around the centre of the unit square of uv, as on an optical disc.
    Circular,
}

/// The profile of the grooves of a grating. It determines the share of the light in each order.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Profile of grooves")]
pub enum GratingProfileFile {
    /// A sawtooth that sends all light of one wavelength to one order.
    #[schemars(example = json!({"blazed": {"order": 1, "nm": 550}}))]
    Blazed {
        /// The order of the blaze.
        order: i32,
        /// The wavelength of the blaze.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "nm"))]
        nm: f64,
    },
    /// A sinusoidal phase.
    #[schemars(example = json!({"sinusoidal": {"amplitude": 1.84, "nm": 550}}))]
    Sinusoidal {
        /// Amplitude of the phase.
        #[schemars(extend("minimum" = 0, "x-unit" = "rad"))]
        amplitude: f64,
        /// The wavelength to which the amplitude belongs.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "nm"))]
        nm: f64,
    },
    /// Rectangular grooves: a phase with two values.
    #[schemars(example = json!({"lamellar": {"phase": 3, "nm": 550, "duty": 0.4}}))]
    Lamellar {
        /// Difference of the two phases.
        #[serde(default = "half_a_turn")]
        #[schemars(extend("x-unit" = "rad"))]
        phase: f64,
        /// The wavelength to which the phase belongs.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "nm"))]
        nm: f64,
        /// Fraction of the period with the second phase.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        duty: f64,
    },
    /// Measured efficiencies of single orders. All other orders have the efficiency 0. The grating
    /// absorbs the rest of the light, and the light of orders that do not propagate.
    #[schemars(example = json!({"table": [{"order": 0, "efficiency": 0.1}, {"order": 1, "efficiency": 0.75}]}))]
    Table(Vec<OrderEfficiencyFile>),
    /// Opaque lines with clear gaps. The lines absorb the rest of the light.
    #[schemars(example = json!({"slits": {"duty": 0.5}}))]
    Slits {
        /// Clear fraction of the period.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        duty: f64,
    },
}

/// The measured efficiency of an order of a grating.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Efficiency of an order", example = json!({"order": 1, "efficiency": 0.75}))]
pub struct OrderEfficiencyFile {
    /// Number of the order.
    pub order: i32,
    /// Fraction of the light in this order: a number, or a spectrum. The sum over all orders is at
    /// most 1.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub efficiency: SpectrumFile,
}

fn half() -> f64 {
    0.5
}

fn half_a_turn() -> f64 {
    PI
}

impl Default for GratingProfileFile {
    fn default() -> Self {
        Self::Blazed { order: 1, nm: 500.0 }
    }
}

impl GratingFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { lines_per_mm, profile, reflectance, transmittance, grooves: _, angle: _ } = self;
        let density = check::rule(
            &at.key("lines_per_mm"),
            *lines_per_mm,
            (0.1..=10_000.0).contains(lines_per_mm),
            "a number from 0.1 to 10000",
        );
        let at_profile = at.key("profile");
        let profile = match profile {
            GratingProfileFile::Blazed { order: _, nm } => check::positive(&at_profile.key("blazed").key("nm"), *nm),
            GratingProfileFile::Sinusoidal { amplitude, nm } => {
                let at = at_profile.key("sinusoidal");
                let amplitude = check::not_negative(&at.key("amplitude"), *amplitude);
                check::all([amplitude, check::positive(&at.key("nm"), *nm)])
            }
            GratingProfileFile::Lamellar { phase: _, nm, duty } => {
                let at = at_profile.key("lamellar");
                check::all([check::positive(&at.key("nm"), *nm), check::fraction(&at.key("duty"), *duty)])
            }
            GratingProfileFile::Slits { duty } => check::fraction(&at_profile.key("slits").key("duty"), *duty),
            GratingProfileFile::Table(orders) => {
                let at = at_profile.key("table");
                check::all(orders.iter().enumerate().map(|(place, OrderEfficiencyFile { order: _, efficiency })| {
                    efficiency.validate(&at.index(place).key("efficiency"), SpectrumUse::Fraction)
                }))
            }
        };
        let fraction = |key: &str, file: &Option<SpectrumFile>| {
            file.as_ref().map_or(Ok(()), |file| file.validate(&at.key(key), SpectrumUse::Fraction))
        };
        let (reflected, transmitted) = (fraction("reflectance", reflectance), fraction("transmittance", transmittance));
        check::all([density, profile, reflected, transmitted])
    }
}
