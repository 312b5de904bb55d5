//! Meters in the scene file.

use crate::prelude::*;
use crate::{JsonPath, check};
use abbe_scene::meter::{MeterGrid, Quantity, ReceivingSide};
use abbe_spectra::error::Result;

/// A meter, which `abbe measure` reads. State exactly one of `points`, `grid`, `surface`, `sphere`,
/// `cylinder` and `spot`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Meter", example = json!({"name": "desk", "quantity": "illuminance",
    "points": [[0, 0.75, 0], [1, 0.75, 0]], "normal": [0, 1, 0]}))]
#[schemars(example = json!({"name": "floor", "grid": {"origin": [0, 0, 0], "u": [4, 0, 0], "v": [0, 0, 4],
    "count": [8, 8]}}))]
#[schemars(example = json!({"name": "wall", "quantity": "luminous_flux", "surface": "wall", "side": "front"}))]
#[schemars(example = json!({"name": "head", "sphere": {"at": [0, 1.2, 0]}}))]
#[schemars(example = json!({"name": "face", "cylinder": {"at": [0, 1.2, 0], "axis": [0, 1, 0]}}))]
#[schemars(example = json!({"name": "screen", "spot": {"from": [0, 1, 3], "to": [0, 1, 0], "angle": 1}}))]
pub struct MeterFile {
    /// Name of the meter in reports.
    pub name: String,
    /// The quantity that the meter measures.
    #[schemars(extend("x-default" = "illuminance; luminance for a spot"))]
    pub quantity: Option<QuantityKindFile>,
    /// Positions of the receptors. Each reads the light that arrives at a plane with this `normal`.
    #[schemars(length(min = 1), extend("x-unit" = "scene unit"))]
    pub points: Option<Vec<[f64; 3]>>,
    /// A grid of points on a plane.
    pub grid: Option<MeterGridFile>,
    /// Normal of the plane, for `points` and `grid`.
    #[schemars(extend("x-range" = "not zero", "x-default" = "[0, 1, 0]"))]
    pub normal: Option<[f64; 3]>,
    /// Name of an object. The meter reads the light that arrives at its surface: the mean and the
    /// flux.
    pub surface: Option<String>,
    /// The sides of the surface that receive light, for `surface`.
    #[schemars(extend("x-default" = "both"))]
    pub side: Option<SideFile>,
    /// A sphere. The meter reads the mean spherical illuminance.
    pub sphere: Option<MeterSphereFile>,
    /// The side of a cylinder. The meter reads the mean cylindrical illuminance.
    pub cylinder: Option<MeterCylinderFile>,
    /// A cone of view. The meter reads the mean luminance in the cone.
    pub spot: Option<MeterSpotFile>,
}

/// A grid of points in the middles of the cells of a parallelogram.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Grid of a meter", example = json!({"origin": [0, 0, 0], "u": [4, 0, 0], "v": [0, 0, 4], "count": [8, 8]}))]
pub struct MeterGridFile {
    /// A corner of the parallelogram.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub origin: [f64; 3],
    /// The edge from the corner along the first index.
    #[schemars(extend("x-range" = "not zero", "x-unit" = "scene unit"))]
    pub u: [f64; 3],
    /// The edge from the corner along the second index.
    #[schemars(extend("x-range" = "not zero", "x-unit" = "scene unit"))]
    pub v: [f64; 3],
    /// Numbers of cells along `u` and along `v`. The first index changes fastest.
    #[schemars(inner(range(min = 1, max = 10_000)))]
    pub count: [u32; 2],
}

/// The position of a spherical receptor.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spherical receptor", example = json!({"at": [0, 1.2, 0]}))]
pub struct MeterSphereFile {
    /// Position of the sphere. The sphere has no extent.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub at: [f64; 3],
}

/// The position and the axis of a cylindrical receptor.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Cylindrical receptor", example = json!({"at": [0, 1.2, 0], "axis": [0, 1, 0]}))]
pub struct MeterCylinderFile {
    /// Position of the cylinder. The cylinder has no extent.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub at: [f64; 3],
    /// Axis of the cylinder.
    #[schemars(extend("x-range" = "not zero", "x-default" = "[0, 1, 0]"))]
    pub axis: Option<[f64; 3]>,
}

/// The cone of view of a luminance meter.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Luminance spot", example = json!({"from": [0, 1, 3], "to": [0, 1, 0], "angle": 1}))]
pub struct MeterSpotFile {
    /// Position of the meter.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub from: [f64; 3],
    /// A point at which the meter looks. It must differ from `from`.
    #[schemars(extend("x-unit" = "scene unit"))]
    pub to: [f64; 3],
    /// Full angle of the cone.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180, "x-unit" = "°"))]
    pub angle: f64,
}

/// A side of a surface.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Side of a surface")]
pub enum SideFile {
    /// The side of the surface normal.
    Front,
    /// The other side.
    Back,
    /// Both sides. Their light is summed.
    #[default]
    Both,
}

/// A quantity of a meter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Measured quantity")]
pub enum QuantityKindFile {
    /// Illuminance in lx.
    #[default]
    Illuminance,
    /// Irradiance over 360–830 nm, in W/m².
    Irradiance,
    /// Irradiance per wavelength in bands of 5 nm, in W/m²/nm.
    SpectralIrradiance,
    /// Luminance in cd/m², for `spot`.
    Luminance,
    /// Radiance over 360–830 nm in W/m²/sr, for `spot`.
    Radiance,
    /// Luminous flux in lm, for `surface`.
    LuminousFlux,
    /// Radiant flux over 360–830 nm in W, for `surface`.
    RadiantFlux,
    /// Photosynthetic photon flux density (400–700 nm) in µmol/m²/s.
    Ppfd,
    /// Irradiance weighted by the action spectrum of the S cones, in W/m² (CIE S 026).
    SConeOpic,
    /// Irradiance weighted by the action spectrum of the M cones, in W/m² (CIE S 026).
    MConeOpic,
    /// Irradiance weighted by the action spectrum of the L cones, in W/m² (CIE S 026).
    LConeOpic,
    /// Irradiance weighted by the action spectrum of the rods, in W/m² (CIE S 026).
    Rhodopic,
    /// Irradiance weighted by the action spectrum of melanopsin, in W/m² (CIE S 026).
    Melanopic,
    /// Melanopic equivalent daylight (D65) illuminance in lx (CIE S 026).
    MelanopicEdi,
    /// Illuminance in percent of the horizontal illuminance from the unobstructed sky.
    DaylightFactor,
    /// Correlated colour temperature of the light that arrives, in K.
    ColourTemperature,
    /// General colour rendering index of the light that arrives (CIE 13.3).
    ColourRendering,
    /// Fidelity index Rf of the light that arrives (TM-30, CIE 224).
    Tm30Rf,
    /// Gamut index Rg of the light that arrives (TM-30).
    Tm30Rg,
    /// Unified glare rating (CIE 117) of a view along `normal`, for `points` and `grid`.
    Ugr,
}

impl QuantityKindFile {
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Illuminance => Quantity::Illuminance,
            Self::Irradiance => Quantity::Irradiance,
            Self::SpectralIrradiance => Quantity::SpectralIrradiance,
            Self::Luminance => Quantity::Luminance,
            Self::Radiance => Quantity::Radiance,
            Self::LuminousFlux => Quantity::LuminousFlux,
            Self::RadiantFlux => Quantity::RadiantFlux,
            Self::Ppfd => Quantity::Ppfd,
            Self::SConeOpic => Quantity::SConeOpic,
            Self::MConeOpic => Quantity::MConeOpic,
            Self::LConeOpic => Quantity::LConeOpic,
            Self::Rhodopic => Quantity::Rhodopic,
            Self::Melanopic => Quantity::Melanopic,
            Self::MelanopicEdi => Quantity::MelanopicEdi,
            Self::DaylightFactor => Quantity::DaylightFactor,
            Self::ColourTemperature => Quantity::ColourTemperature,
            Self::ColourRendering => Quantity::ColourRendering,
            Self::Tm30Rf => Quantity::Tm30Rf,
            Self::Tm30Rg => Quantity::Tm30Rg,
            Self::Ugr => Quantity::UnifiedGlareRating,
        }
    }
}

impl SideFile {
    pub fn side(self) -> ReceivingSide {
        match self {
            Self::Front => ReceivingSide::Front,
            Self::Back => ReceivingSide::Back,
            Self::Both => ReceivingSide::Both,
        }
    }
}

impl MeterFile {
    pub fn quantity(&self) -> Quantity {
        let default = if self.spot.is_some() { QuantityKindFile::Luminance } else { QuantityKindFile::Illuminance };
        self.quantity.unwrap_or(default).quantity()
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { name: _, quantity: _, points, grid, normal, surface, side, sphere, cylinder, spot } = self;
        let forms = [
            ("points", points.is_some()),
            ("grid", grid.is_some()),
            ("surface", surface.is_some()),
            ("sphere", sphere.is_some()),
            ("cylinder", cylinder.is_some()),
            ("spot", spot.is_some()),
        ];
        let explicit: Vec<&str> = forms.iter().filter(|(_, explicit)| *explicit).map(|(key, _)| *key).collect();
        let one_of = "exactly one of points, grid, surface, sphere, cylinder and spot";
        if explicit.len() != 1 {
            let found = if explicit.is_empty() { "none of them".to_string() } else { explicit.join(" and ") };
            return Err(check::fault(at, format!("found {found}"), one_of));
        }
        let flat = points.is_some() || grid.is_some();
        let unused = |key: &str, explicit: bool, of: &str| {
            let error = || check::fault(&at.key(key), format!("found `{key}` in a meter without {of}"), "no such key");
            if explicit { Err(error()) } else { Ok(()) }
        };
        let quantity = self.quantity();
        let expected = match spot {
            Some(_) if !quantity.is_radiance() => Some("luminance or radiance"),
            None if quantity.is_radiance() => Some("a quantity other than luminance"),
            _ if quantity.is_flux() && surface.is_none() => Some("a flux only with `surface`"),
            _ if quantity == Quantity::UnifiedGlareRating && !flat => {
                Some("a glare rating only with `points` or `grid`")
            }
            _ => None,
        };
        let wrong = |expected: &str| check::fault(&at.key("quantity"), format!("found {}", quantity.name()), expected);
        let fits = expected.map_or(Ok(()), |expected| Err(wrong(expected)));
        let axis = cylinder.as_ref().and_then(|cylinder| cylinder.axis);
        check::all([
            fits,
            points.as_ref().map_or(Ok(()), |it| check::entries(&at.key("points"), it.len(), 1, "at least one point")),
            grid.as_ref().map_or(Ok(()), |grid| grid.validate(&at.key("grid"))),
            normal.map_or(Ok(()), |normal| check::direction(&at.key("normal"), normal)),
            unused("normal", normal.is_some() && !flat, "`points` or `grid`"),
            unused("side", side.is_some() && surface.is_none(), "`surface`"),
            axis.map_or(Ok(()), |axis| check::direction(&at.key("cylinder").key("axis"), axis)),
            spot.as_ref().map_or(Ok(()), |spot| spot.validate(&at.key("spot"))),
        ])
    }
}

impl MeterGridFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { origin: _, u, v, count } = self;
        let at_count = at.key("count");
        let counts = count.iter().enumerate();
        let counts = counts.map(|(i, &it)| check::count(&at_count.index(i), u64::from(it), 1, 10_000));
        check::all([check::direction(&at.key("u"), *u), check::direction(&at.key("v"), *v)].into_iter().chain(counts))
    }

    pub fn grid(&self) -> MeterGrid {
        let Self { origin, u, v, count } = *self;
        MeterGrid { origin, u, v, count }
    }

    /// Returns the points of the grid, in the scene's unit.
    pub fn points(&self) -> Vec<[f64; 3]> {
        let Self { origin, u, v, count: [columns, rows] } = *self;
        let middle = |i: u32, count: u32| (f64::from(i) + 0.5) / f64::from(count);
        let point = |column: u32, row: u32| {
            let (a, b) = (middle(column, columns), middle(row, rows));
            std::array::from_fn(|axis| origin[axis] + a * u[axis] + b * v[axis])
        };
        (0..rows).flat_map(|row| (0..columns).map(move |column| point(column, row))).collect()
    }
}

impl MeterSpotFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { from, to, angle } = self;
        let apart = check::apart(&at.key("to"), *to, "from", *from);
        check::all([apart, check::between(&at.key("angle"), *angle, 0.0, 180.0)])
    }
}
