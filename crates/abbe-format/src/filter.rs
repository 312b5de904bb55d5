//! Polarising filters in the scene file.

use crate::prelude::*;
use crate::{JsonPath, ScalarFile, SpectrumFile, check, forms, spectrum::SpectrumUse};
use abbe_spectra::error::Result;

/// A filter that changes the polarisation of light: a polariser, a retarder, or a stack of them.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Polarising filter")]
pub enum PolarisingFilterFile {
    /// A linear polariser.
    #[schemars(example = json!({"polariser": {"axis": 90}}))]
    Polariser(PolariserFile),
    /// A linear retarder, such as a wave plate, a crystal or cellophane.
    #[schemars(example = json!({"retarder": {"retardance_nm": 275, "axis": 45}}))]
    Retarder(RetarderFile),
    /// A sheet of plastic or glass under stress.
    #[schemars(example = json!({"stress": {"coefficient": 8e-11, "disc": {"load": 500, "diameter": 0.04}}}))]
    Stress(StressFile),
    /// A linear polariser with a quarter-wave plate behind it.
    #[schemars(example = json!({"circular_polariser": {"handedness": "right"}}))]
    CircularPolariser(CircularPolariserFile),
    /// A cell of a twisted nematic liquid crystal.
    #[schemars(example = json!({"liquid_crystal": {"retardance_nm": 476, "axis": 0}}))]
    LiquidCrystal(LiquidCrystalFile),
    /// Filters on top of each other, of which the light of the front meets the first one first.
    #[schemars(example = json!({"filters": [{"polariser": {}}, {"retarder": {"crystal": "quartz",
        "thickness_nm": 20000, "axis": 45}}, {"polariser": {"axis": 90}}]}))]
    Filters(#[schemars(length(min = 1))] Vec<PolarisingFilterFile>),
}

/// A linear polariser. At oblique incidence, the direction that it absorbs is projected.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Linear polariser", example = json!({"axis": 90, "k1": 0.9, "k2": 0.001}))]
pub struct PolariserFile {
    /// Angle of the direction that passes, counter-clockwise as seen from the front: from u on a
    /// surface, or from the right side of the picture at the camera.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "degrees"))]
    pub axis: f64,
    /// Fraction of light along the axis that passes.
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-default" = "1"))]
    pub k1: Option<SpectrumFile>,
    /// Fraction of light across the axis that passes.
    #[schemars(extend("minimum" = 0, "maximum" = 1, "x-default" = "0"))]
    pub k2: Option<SpectrumFile>,
}

/// A linear retarder. State `retardance_nm`, or `crystal` and `thickness_nm`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Retarder", example = json!({"retardance_nm": 137.5, "axis": 45}))]
#[schemars(example = json!({"crystal": "calcite", "thickness_nm": 3000, "factor": {"gradient": {"a": 0, "b": 1}}}))]
pub struct RetarderFile {
    /// Angle of the fast axis, or of the optic axis of a crystal, counter-clockwise as seen from
    /// the front: from u on a surface, or from the right side of the picture at the camera. A texture
    /// is interpolated, and the camera takes its mean.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "degrees"))]
    pub axis: ScalarFile,
    /// Factor of the retardance, for a thickness that varies over the sheet. A texture is
    /// interpolated. Only one retarder of a sheet may have textures.
    #[schemars(extend("minimum" = 0, "x-default" = "1"))]
    pub factor: Option<ScalarFile>,
    /// Path by which light across the fast axis lags behind light along it.
    #[schemars(extend("minimum" = 0, "x-unit" = "nm", "x-default" = "that of the crystal"))]
    pub retardance_nm: Option<SpectrumFile>,
    /// Name of a uniaxial crystal with the optic axis in the sheet: `calcite`, `quartz`, `MgF2`,
    /// `sapphire`, `rutile` or `ice`.
    #[schemars(extend("x-default" = "no crystal"))]
    pub crystal: Option<String>,
    /// Thickness of the crystal.
    #[schemars(extend("minimum" = 0, "x-unit" = "nm", "x-default" = "no crystal"))]
    pub thickness_nm: Option<f64>,
}

/// A cell of a twisted nematic liquid crystal, whose molecules turn evenly from the front to the
/// back. Between crossed polarisers along its axes, a cell without a voltage is bright, and one
/// whose voltage has set the molecules upright (`factor` 0) is dark.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Liquid crystal", example = json!({"retardance_nm": 476, "axis": 45, "twist": -90,
    "factor": {"image": {"path": "digits.png"}}}))]
pub struct LiquidCrystalFile {
    /// Retardance of the cell if its molecules did not turn: thickness times n_e − n_o.
    #[schemars(extend("minimum" = 0, "x-unit" = "nm"))]
    pub retardance_nm: SpectrumFile,
    /// Angle of the molecules at the front, counter-clockwise as seen from the front: from u on a
    /// surface, or from the right side of the picture at the camera.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "degrees"))]
    pub axis: f64,
    /// Angle by which the molecules turn from the front to the back, counter-clockwise as seen from
    /// the front.
    #[serde(default = "quarter_turn", skip_serializing_if = "is_quarter_turn")]
    #[schemars(extend("x-unit" = "degrees"))]
    pub twist: f64,
    /// Factor of the retardance, which a voltage lowers. A texture is interpolated.
    #[schemars(extend("minimum" = 0, "x-default" = "1"))]
    pub factor: Option<ScalarFile>,
}

/// A sheet under stress, which retards light by the stress-optic law. State `disc` or `beam`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Stress", example = json!({"coefficient": 8e-11, "axis": 0, "disc": {"load": 500,
    "diameter": 0.04}}))]
#[schemars(example = json!({"coefficient": 8e-11, "beam": {"moment": 2, "depth": 0.03}}))]
pub struct StressFile {
    /// Stress-optic coefficient C: the retardance is C times the thickness times the difference of
    /// the principal stresses. The fast axis is along the smaller stress.
    #[schemars(extend("minimum" = 0, "x-unit" = "m²/N"))]
    pub coefficient: f64,
    /// Angle by which the field is turned counter-clockwise as seen from the front.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "degrees"))]
    pub axis: f64,
    /// A disc that is pressed at its upper and its lower edge.
    #[schemars(extend("x-default" = "no disc"))]
    pub disc: Option<DiscFile>,
    /// A beam that is bent without a shear force.
    #[schemars(extend("x-default" = "no beam"))]
    pub beam: Option<BeamFile>,
}

/// A pressed disc. Its surface has the texture coordinates of a `disk`: they cover its square.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Pressed disc", example = json!({"load": 500, "diameter": 0.04}))]
pub struct DiscFile {
    /// The force on the disc, along v.
    #[schemars(extend("minimum" = 0, "x-unit" = "N"))]
    pub load: f64,
    /// Diameter of the disc.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "m"))]
    pub diameter: f64,
}

/// A bent beam along u. Its depth is along v.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Bent beam", example = json!({"moment": 2, "depth": 0.03}))]
pub struct BeamFile {
    /// The bending moment.
    #[schemars(extend("minimum" = 0, "x-unit" = "N·m"))]
    pub moment: f64,
    /// The depth of the beam in the plane of bending.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "m"))]
    pub depth: f64,
}

/// A circular polariser for light from the front. Light from the back passes the wave plate first.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Circular polariser", example = json!({"handedness": "left", "axis": 30, "retardance_nm": 140}))]
pub struct CircularPolariserFile {
    /// Sense in which the field of the transmitted light turns, as its receiver sees it: `right` is
    /// clockwise.
    pub handedness: HandednessFile,
    /// Angle of the direction that the linear polariser passes; see the key of `polariser`.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "degrees"))]
    pub axis: f64,
    /// Retardance of the wave plate, at 45° to the polariser. The default is a quarter of 550 nm.
    #[serde(default = "quarter_of_550_nm", skip_serializing_if = "is_quarter_of_550_nm")]
    #[schemars(range(min = 0), extend("x-unit" = "nm"))]
    pub retardance_nm: f64,
}

/// The sense of circular polarisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Handedness")]
pub enum HandednessFile {
    /// Clockwise for the receiver: S3 is above 0.
    Right,
    /// Counter-clockwise for the receiver.
    Left,
}

fn quarter_turn() -> f64 {
    90.0
}

#[expect(clippy::float_cmp, reason = "the default is written as a literal")]
fn is_quarter_turn(degrees: &f64) -> bool {
    *degrees == quarter_turn()
}

fn quarter_of_550_nm() -> f64 {
    137.5
}

#[expect(clippy::float_cmp, reason = "the default is written as a literal")]
fn is_quarter_of_550_nm(nm: &f64) -> bool {
    *nm == quarter_of_550_nm()
}

impl PolarisingFilterFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Polariser(file) => file.validate(&at.key("polariser")),
            Self::Retarder(file) => file.validate(&at.key("retarder")),
            Self::Stress(file) => file.validate(&at.key("stress")),
            Self::CircularPolariser(file) => file.validate(&at.key("circular_polariser")),
            Self::LiquidCrystal(file) => file.validate(&at.key("liquid_crystal")),
            Self::Filters(files) => {
                let at = at.key("filters");
                check::entries(&at, files.len(), 1, "at least one filter")?;
                check::all(files.iter().enumerate().map(|(i, file)| file.validate(&at.index(i))))
            }
        }
    }
}

impl PolariserFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { axis: _, k1, k2 } = self;
        let fraction = |key: &str, file: &Option<SpectrumFile>| {
            file.as_ref().map_or(Ok(()), |file| file.validate(&at.key(key), SpectrumUse::Fraction))
        };
        check::all([fraction("k1", k1), fraction("k2", k2)])
    }
}

impl RetarderFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { axis, factor, retardance_nm, crystal, thickness_nm } = self;
        check::all([
            axis.validate(&at.key("axis"), |_, _| Ok(())),
            factor.as_ref().map_or(Ok(()), |factor| factor.validate(&at.key("factor"), check::not_negative)),
        ])?;
        let allowed = "`retardance_nm`, or both `crystal` and `thickness_nm`";
        match (retardance_nm, crystal, thickness_nm) {
            (Some(file), None, None) => file.validate(&at.key("retardance_nm"), SpectrumUse::NotNegative),
            (None, Some(_), Some(thickness)) => check::not_negative(&at.key("thickness_nm"), *thickness),
            (None, Some(_), None) => Err(check::fault(at, "found `crystal` without `thickness_nm`", allowed)),
            (None, None, Some(_)) => Err(check::fault(at, "found `thickness_nm` without `crystal`", allowed)),
            (None, None, None) => Err(check::fault(at, "found none of the keys it needs", allowed)),
            (Some(_), _, _) => Err(check::fault(at, "found `retardance_nm` together with a crystal", allowed)),
        }
    }
}

impl LiquidCrystalFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { retardance_nm, axis: _, twist: _, factor } = self;
        check::all([
            retardance_nm.validate(&at.key("retardance_nm"), SpectrumUse::NotNegative),
            factor.as_ref().map_or(Ok(()), |factor| factor.validate(&at.key("factor"), check::not_negative)),
        ])
    }
}

impl StressFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { coefficient, axis: _, disc, beam } = self;
        let coefficient = check::not_negative(&at.key("coefficient"), *coefficient);
        let field = match (disc, beam) {
            (Some(DiscFile { load, diameter }), None) => {
                let at = at.key("disc");
                check::all([
                    check::not_negative(&at.key("load"), *load),
                    check::positive(&at.key("diameter"), *diameter),
                ])
            }
            (None, Some(BeamFile { moment, depth })) => {
                let at = at.key("beam");
                check::all([check::not_negative(&at.key("moment"), *moment), check::positive(&at.key("depth"), *depth)])
            }
            (Some(_), Some(_)) => Err(check::fault(at, "found `disc` and `beam`", "only one of them")),
            (None, None) => Err(check::fault(at, "found neither `disc` nor `beam`", "one of them")),
        };
        check::all([coefficient, field])
    }
}

impl CircularPolariserFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        check::not_negative(&at.key("retardance_nm"), self.retardance_nm)
    }
}
