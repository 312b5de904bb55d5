//! Materials in the scene file.

use crate::prelude::*;
use crate::{
    CircularPolariserFile, CoatingFile, GratingFile, IndexFile, JsonPath, NormalMapFile, PolariserFile,
    PolarisingFilterFile, ReflectanceFile, RetarderFile, ScalarFile, SpectrumFile, StressFile, check, forms,
    spectrum::SpectrumUse,
};
use abbe_spectra::error::Result;

/// A surface material: the string "absorber", or an object with one key.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Material", example = &"absorber")]
pub enum MaterialFile {
    /// A Lambertian surface: equal radiance in all directions, on both sides.
    #[schemars(example = json!({"diffuse": {"reflectance": 0.8}}))]
    Diffuse {
        /// Fraction of the light that is reflected.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        reflectance: ReflectanceFile,
    },
    /// A Lambertian surface with a fluorophore: it absorbs light and emits light of other
    /// wavelengths. The number of photons does not grow.
    #[schemars(example = json!({"fluorescent": {"reflectance": 0.9, "absorptance": {"table": {"nm": [400, 450, 500],
        "values": [0, 0.85, 0]}}, "emission": {"gaussian": {"peak_nm": 560, "fwhm_nm": 90}}, "quantum_yield": 0.9}}))]
    Fluorescent {
        /// Reflectance of the substrate for the light that the fluorophore does not absorb.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        reflectance: SpectrumFile,
        /// Fraction of the photons that the fluorophore absorbs. Outside a table, it is 0.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        absorptance: SpectrumFile,
        /// Relative number of emitted photons per nm, at any scale. Outside a table, it is 0.
        #[schemars(extend("minimum" = 0))]
        emission: SpectrumFile,
        /// Number of emitted photons, divided by the number of absorbed photons.
        #[schemars(range(min = 0, max = 1))]
        quantum_yield: f64,
    },
    /// A Lambertian surface with a measured bispectral matrix (Donaldson matrix).
    #[schemars(example = json!({"bispectral": {"reflectance": 0.85, "matrix": "paper.csv"}}))]
    Bispectral {
        /// Fraction of the light that is reflected without a change of wavelength.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        reflectance: SpectrumFile,
        /// Path of a CSV file with the emission. The first row contains the excitation wavelengths
        /// in nm, after one cell of text. Each other row contains an emission wavelength in nm, and
        /// the bispectral luminescent radiance factors per nm. Between the wavelengths, factors are
        /// interpolated. Outside them, they are 0.
        matrix: String,
    },
    /// Glass, water or gems: refraction and reflection by Fresnel's equations.
    #[schemars(example = json!({"dielectric": {"ior": "N-BK7", "roughness": 0, "absorption": 0.1, "medium": "milk",
        "priority": 0}}))]
    #[schemars(example = json!({"dielectric": {"ior": "N-BK7", "coating": {"layers": [{"ior": "MgF2",
        "thickness_nm": 100}]}}}))]
    Dielectric(DielectricFile),
    /// A polished uniaxial crystal, which splits light into an ordinary and an extraordinary ray.
    #[schemars(example = json!({"crystal": {"name": "calcite", "axis": [0, 1, 0]}}))]
    #[schemars(example = json!({"crystal": {"ordinary": {"file": "CaCO3-o.yml"},
        "extraordinary": {"file": "CaCO3-e.yml"}, "axis": [1, 1, 0], "absorption": 5,
        "priority": 1}}))]
    Crystal(CrystalFile),
    /// A thin pane: light passes straight through or is reflected.
    #[schemars(example = json!({"thin_dielectric": {"ior": 1.5}}))]
    #[schemars(example = json!({"thin_dielectric": {"ior": 1.52, "thickness": 0.006, "absorption": 7.3}}))]
    #[schemars(example = json!({"thin_dielectric": {"ior": 1.52,
        "transmittance": {"cosine_polynomial": [-0.028, 3.156, -3.058, -1.429, 4.014, -1.776]}}}))]
    #[schemars(example = json!({"thin_dielectric": {"ior": 1.52, "coating": {"layers": [{"ior": "MgF2",
        "thickness_nm": 100}]}}}))]
    ThinDielectric(ThinDielectricFile),
    /// A free-standing thin film, such as a soap bubble. Light passes straight through or is
    /// reflected. The surrounding medium is on both sides.
    #[schemars(example = json!({"thin_film": {"layers": [{"ior": "water", "thickness_nm": 300}]}}))]
    ThinFilm(CoatingFile),
    /// A sheet that is a linear polariser.
    #[schemars(example = json!({"polariser": {"axis": 90}}))]
    Polariser(PolariserFile),
    /// A sheet that is a linear retarder, such as a wave plate, a crystal or cellophane.
    #[schemars(example = json!({"retarder": {"retardance_nm": 275, "axis": 45}}))]
    Retarder(RetarderFile),
    /// A sheet of plastic or glass under stress, which retards light.
    #[schemars(example = json!({"stress": {"coefficient": 8e-11, "disc": {"load": 500, "diameter": 0.04}}}))]
    Stress(StressFile),
    /// A sheet that is a linear polariser with a quarter-wave plate behind it.
    #[schemars(example = json!({"circular_polariser": {"handedness": "right"}}))]
    CircularPolariser(CircularPolariserFile),
    /// A sheet of several polarising filters. Light of the front, the outside of the surface, meets
    /// the first one first.
    #[schemars(example = json!({"filters": [{"polariser": {}}, {"retarder": {"retardance_nm": 550, "axis": 45}},
        {"polariser": {"axis": 90}}]}))]
    Filters(#[schemars(length(min = 1))] Vec<PolarisingFilterFile>),
    /// A diffraction grating.
    #[schemars(example = json!({"grating": {"lines_per_mm": 600, "profile": {"blazed": {"order": 1, "nm": 550}},
        "transmittance": 0.9, "reflectance": 0.05, "angle": 90}}))]
    #[schemars(example = json!({"grating": {"lines_per_mm": 625, "grooves": "circular"}}))]
    Grating(GratingFile),
    /// A metal.
    #[schemars(example = json!({"conductor": {"metal": "gold", "roughness": 0.2}}))]
    #[schemars(example = json!({"conductor": {"eta": 0.2, "k": 3.4}}))]
    #[schemars(example = json!({"conductor": {"metal": "titanium", "coating": {"layers": [{"ior": "rutile TiO2",
        "thickness_nm": 60}]}}}))]
    #[schemars(example = json!({"conductor": {"file": "Au.yml", "roughness": 0.1}}))]
    #[schemars(example = json!({"conductor": {"reflectance": {"rgb": [0.9, 0.7, 0.4]}, "roughness": 0.3}}))]
    Conductor(ConductorFile),
    /// An ideal mirror with a given reflectance.
    #[schemars(example = json!({"mirror": {"reflectance": 0.95}}))]
    Mirror {
        /// Fraction of the light that is reflected.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        reflectance: ReflectanceFile,
    },
    /// A diffuse base under a clear dielectric coat, such as paint or plastic.
    #[schemars(example = json!({"glossy": {"reflectance": 0.5, "ior": 1.5, "roughness": 0.05}}))]
    #[schemars(example = json!({"glossy": {"reflectance": 0.8, "ior": 1.5, "roughness": 0.05,
        "interreflection": true}}))]
    Glossy {
        /// Reflectance of the base.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        reflectance: ReflectanceFile,
        /// Index of refraction of the coat.
        #[schemars(extend("minimum" = 1))]
        ior: IndexFile,
        /// Roughness of the coat: 0 is polished.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        roughness: ScalarFile,
        /// True if `reflectance` belongs to the bare base. Light that the coat reflects back to the
        /// base then makes the coated surface darker. False if `reflectance` is the fraction of the
        /// light in the coat that leaves it again.
        #[serde(default, skip_serializing_if = "forms::is_default")]
        #[schemars(skip_serializing_if = "crate::schema::never")]
        interreflection: bool,
    },
    /// A thin sheet that reflects and transmits diffusely, such as paper.
    #[schemars(example = json!({"translucent": {"reflectance": 0.5, "transmittance": 0.4}}))]
    #[schemars(example = json!({"translucent": {"reflectance": 0, "transmittance": 0.8}}))]
    Translucent {
        /// Fraction of the light that is reflected.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        reflectance: ReflectanceFile,
        /// Fraction of the light that is transmitted. The sum with `reflectance` is at most 1.
        #[schemars(extend("minimum" = 0, "maximum" = 1))]
        transmittance: ReflectanceFile,
    },
    /// A random choice of one of several materials at each interaction.
    #[schemars(example = json!({"mix": [{"material": "gold", "weight": 3}, {"material": "paint", "weight": 1}]}))]
    Mix(#[schemars(length(min = 1))] Vec<WeightedMaterialFile>),
    /// Another material, with shading normals from a picture.
    #[schemars(example = json!({"normal_map": {"material": "wall", "path": "bricks_normal.png"}}))]
    #[schemars(example = json!({"normal_map": {"material": "wall", "path": "bricks_normal.png", "strength": 0.5,
        "green": "down", "wrap": "clamp", "filter": "nearest", "uv": {"scale": [4, 4]}}}))]
    NormalMap(NormalMapFile),
    /// The boundary of a medium, without an optical surface.
    #[schemars(example = json!({"boundary": {"medium": "milk"}}))]
    Boundary {
        /// Name of the medium inside, from the scene's `media`.
        medium: String,
    },
    /// A surface that absorbs all light.
    Absorber,
}

/// A dielectric body.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DielectricFile {
    /// Index of refraction relative to air.
    #[schemars(extend("minimum" = 1))]
    pub ior: IndexFile,
    /// Roughness of the surface: 0 is polished.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("minimum" = 0, "maximum" = 1))]
    pub roughness: ScalarFile,
    /// Absorption coefficient inside the body (Beer's law).
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit", "x-default" = "no absorption"))]
    pub absorption: Option<SpectrumFile>,
    /// Thin films on the surface, from the outside to the glass. Each microfacet of a rough surface
    /// has these films.
    #[schemars(extend("x-default" = "no coating"))]
    pub coating: Option<CoatingFile>,
    /// Name of the medium inside, from the scene's `media`.
    #[schemars(extend("x-default" = "no medium"))]
    pub medium: Option<String>,
    /// Priority where dielectrics or media overlap: the highest one fills the space. Among equal
    /// priorities, the innermost body fills the space.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub priority: i32,
}

/// A uniaxial crystal. State `name`, or `ordinary` and `extraordinary`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CrystalFile {
    /// Name in the catalogue: `calcite`, `quartz`, `MgF2`, `sapphire`, `rutile` or `ice`. `abbe
    /// crystal` describes them.
    #[schemars(extend("x-default" = "the two indices"))]
    pub name: Option<String>,
    /// Index of refraction of the ordinary ray.
    #[schemars(extend("minimum" = 1, "x-default" = "that of the name"))]
    pub ordinary: Option<IndexFile>,
    /// Index of refraction of the extraordinary ray for fields along the optic axis.
    #[schemars(extend("minimum" = 1, "x-default" = "that of the name"))]
    pub extraordinary: Option<IndexFile>,
    /// Direction of the optic axis in the frame of the object.
    pub axis: [f64; 3],
    /// Absorption coefficient inside the body (Beer's law).
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit", "x-default" = "no absorption"))]
    pub absorption: Option<SpectrumFile>,
    /// Priority where dielectrics or media overlap: the highest one fills the space. Among equal
    /// priorities, the innermost body fills the space.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub priority: i32,
}

/// A thin pane. A pane that absorbs states `thickness` and `absorption`, or its measured
/// `transmittance`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThinDielectricFile {
    /// Index of refraction relative to air.
    #[serde(default = "glass_index", skip_serializing_if = "is_glass_index")]
    #[schemars(extend("minimum" = 1))]
    pub ior: IndexFile,
    /// Thickness of the pane. It only decides how much light is absorbed.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit", "x-default" = "no absorption"))]
    pub thickness: Option<f64>,
    /// Absorption coefficient inside the pane (Beer's law).
    #[schemars(extend("minimum" = 0, "x-unit" = "1/scene unit", "x-default" = "no absorption"))]
    pub absorption: Option<SpectrumFile>,
    /// Measured transmittance of the pane. It replaces the transmittance that follows from `ior`.
    #[schemars(extend("x-default" = "computed from `ior`"))]
    pub transmittance: Option<PaneTransmittanceFile>,
    /// Thin films on both faces, from the outside to the pane.
    #[schemars(extend("x-default" = "no coating"))]
    pub coating: Option<CoatingFile>,
}

/// A measured transmittance of a pane for unpolarised light.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Transmittance of a pane")]
pub enum PaneTransmittanceFile {
    /// Coefficients of a polynomial in the cosine of the angle of incidence, beginning with the
    /// constant term. Values below 0 count as 0, and values above 1 as 1.
    #[schemars(example = json!({"cosine_polynomial": [0, 0.9]}))]
    CosinePolynomial(#[schemars(length(min = 1))] Vec<f64>),
}

fn glass_index() -> IndexFile {
    IndexFile::Number(1.52)
}

fn is_glass_index(index: &IndexFile) -> bool {
    *index == glass_index()
}

/// A conductor. State one of four: `metal`; `eta` and `k`; `file`; or `reflectance`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConductorFile {
    /// Name of the metal, such as "gold".
    pub metal: Option<String>,
    /// Real part of the index of refraction.
    #[schemars(extend("minimum" = 0))]
    pub eta: Option<SpectrumFile>,
    /// Extinction coefficient: the imaginary part of the index of refraction.
    #[schemars(extend("minimum" = 0))]
    pub k: Option<SpectrumFile>,
    /// Path of a file with n and k, relative to the scene's folder: an entry of the database
    /// refractiveindex.info (`.yml`), or a CSV file with a header row such as `nm,n,k`.
    pub file: Option<String>,
    /// Reflectance at normal incidence. At other angles, the reflectance follows Schlick's
    /// approximation, and it is 1 at grazing incidence.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub reflectance: Option<ReflectanceFile>,
    /// Roughness of the surface: 0 is polished.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("minimum" = 0, "maximum" = 1))]
    pub roughness: ScalarFile,
    /// Thin films on the metal, from the outside to the metal. They need an index of refraction,
    /// and no `reflectance`.
    #[schemars(extend("x-default" = "no coating"))]
    pub coating: Option<CoatingFile>,
}

/// One part of a mix of materials.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Part of a material mix", example = json!({"material": "gold", "weight": 3}))]
pub struct WeightedMaterialFile {
    /// Name of the material, from the scene's `materials`.
    pub material: String,
    /// Weight relative to the other parts. At least one weight must be above 0.
    #[schemars(extend("minimum" = 0))]
    pub weight: ScalarFile,
}

impl MaterialFile {
    /// Returns the polarising filter of a sheet.
    pub(super) fn filter(&self) -> Option<PolarisingFilterFile> {
        match self {
            Self::Polariser(file) => Some(PolarisingFilterFile::Polariser(file.clone())),
            Self::Retarder(file) => Some(PolarisingFilterFile::Retarder(file.clone())),
            Self::Stress(file) => Some(PolarisingFilterFile::Stress(file.clone())),
            Self::CircularPolariser(file) => Some(PolarisingFilterFile::CircularPolariser(file.clone())),
            Self::Filters(files) => Some(PolarisingFilterFile::Filters(files.clone())),
            Self::Diffuse { .. } | Self::Fluorescent { .. } | Self::Bispectral { .. } | Self::Dielectric(_) => None,
            Self::Crystal(_) => None,
            Self::ThinDielectric(_) | Self::ThinFilm(_) | Self::Grating(_) | Self::Conductor(_) => None,
            Self::Mirror { .. } | Self::Glossy { .. } | Self::Translucent { .. } | Self::Mix(_) => None,
            Self::NormalMap(_) | Self::Boundary { .. } | Self::Absorber => None,
        }
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Diffuse { reflectance } => reflectance.validate(&at.key("diffuse").key("reflectance")),
            Self::Fluorescent { reflectance, absorptance, emission, quantum_yield } => {
                let at = at.key("fluorescent");
                check::all([
                    reflectance.validate(&at.key("reflectance"), SpectrumUse::Fraction),
                    absorptance.validate(&at.key("absorptance"), SpectrumUse::Fraction),
                    emission.validate(&at.key("emission"), SpectrumUse::NotNegative),
                    check::fraction(&at.key("quantum_yield"), *quantum_yield),
                ])
            }
            Self::Bispectral { reflectance, matrix: _ } => {
                reflectance.validate(&at.key("bispectral").key("reflectance"), SpectrumUse::Fraction)
            }
            Self::Dielectric(dielectric) => dielectric.validate(&at.key("dielectric")),
            Self::Crystal(crystal) => crystal.validate(&at.key("crystal")),
            Self::ThinDielectric(pane) => pane.validate(&at.key("thin_dielectric")),
            Self::ThinFilm(film) => film.validate(&at.key("thin_film")),
            Self::Polariser(_)
            | Self::Retarder(_)
            | Self::Stress(_)
            | Self::CircularPolariser(_)
            | Self::Filters(_) => self.filter().map_or(Ok(()), |filter| filter.validate(at)),
            Self::Grating(grating) => grating.validate(&at.key("grating")),
            Self::Conductor(conductor) => conductor.validate(&at.key("conductor")),
            Self::Mirror { reflectance } => reflectance.validate(&at.key("mirror").key("reflectance")),
            Self::Glossy { reflectance, ior, roughness, interreflection: _ } => {
                let at = at.key("glossy");
                check::all([
                    reflectance.validate(&at.key("reflectance")),
                    ior.validate(&at.key("ior")),
                    roughness.validate(&at.key("roughness"), check::fraction),
                ])
            }
            Self::Translucent { reflectance, transmittance } => {
                validate_translucent(&at.key("translucent"), reflectance, transmittance)
            }
            Self::Mix(parts) => {
                let at = at.key("mix");
                check::entries(&at, parts.len(), 1, "at least one material with its weight")?;
                validate_weights(&at, parts)
            }
            Self::NormalMap(map) => check::not_negative(&at.key("normal_map").key("strength"), map.strength),
            Self::Boundary { medium: _ } | Self::Absorber => Ok(()),
        }
    }
}

/// Checks that no weight is negative, and that at least one weight is above 0 or is a texture.
fn validate_weights(at: &JsonPath, parts: &[WeightedMaterialFile]) -> Result<()> {
    let weights =
        parts.iter().enumerate().map(|(i, part)| part.weight.validate(&at.index(i).key("weight"), check::not_negative));
    check::all(weights)?;
    if parts.iter().all(|part| part.weight == ScalarFile::Number(0.0)) {
        return Err(check::fault(at, "found only weights of 0", "at least one weight above 0"));
    }
    Ok(())
}

/// If the reflectance and the transmittance are plain numbers, checks that their sum is at most 1.
fn validate_translucent(at: &JsonPath, reflectance: &ReflectanceFile, transmittance: &ReflectanceFile) -> Result<()> {
    check::all([reflectance.validate(&at.key("reflectance")), transmittance.validate(&at.key("transmittance"))])?;
    if let (
        ReflectanceFile::Spectrum(SpectrumFile::Number(reflected)),
        ReflectanceFile::Spectrum(SpectrumFile::Number(transmitted)),
    ) = (reflectance, transmittance)
        && reflected + transmitted > 1.0
    {
        let allowed = format!("at most 1 together with the reflectance of {}", check::number(*reflected));
        return check::rule(&at.key("transmittance"), *transmitted, false, &allowed);
    }
    Ok(())
}

impl DielectricFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { ior, roughness, absorption, coating, medium: _, priority: _ } = self;
        check::all([
            ior.validate(&at.key("ior")),
            roughness.validate(&at.key("roughness"), check::fraction),
            absorption.as_ref().map_or(Ok(()), |it| it.validate(&at.key("absorption"), SpectrumUse::NotNegative)),
            coating_on(at, coating.as_ref()),
        ])
    }
}

impl CrystalFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { name, ordinary, extraordinary, axis, absorption, priority: _ } = self;
        let index =
            |key: &str, file: &Option<IndexFile>| file.as_ref().map_or(Ok(()), |file| file.validate(&at.key(key)));
        check::all([
            index("ordinary", ordinary),
            index("extraordinary", extraordinary),
            check::direction(&at.key("axis"), *axis),
            absorption.as_ref().map_or(Ok(()), |it| it.validate(&at.key("absorption"), SpectrumUse::NotNegative)),
        ])?;
        let allowed = "`name`, or both `ordinary` and `extraordinary`";
        match (name, ordinary, extraordinary) {
            (Some(_), None, None) | (None, Some(_), Some(_)) => Ok(()),
            (None, None, None) => Err(check::fault(at, "found none of the indices", allowed)),
            (None, _, _) => Err(check::fault(at, "found one of the two indices", allowed)),
            (Some(_), _, _) => Err(check::fault(at, "found a name together with an index", allowed)),
        }
    }
}

fn coating_on(at: &JsonPath, coating: Option<&CoatingFile>) -> Result<()> {
    coating.map_or(Ok(()), |coating| coating.validate(&at.key("coating")))
}

impl ThinDielectricFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { ior, thickness, absorption, transmittance, coating } = self;
        let allowed = "both `thickness` and `absorption`, or neither";
        let measured = match transmittance {
            Some(_) if thickness.is_some() || coating.is_some() => {
                let what = "found `transmittance` together with `thickness` or `coating`";
                Err(check::fault(at, what, "only one of them"))
            }
            Some(PaneTransmittanceFile::CosinePolynomial(coefficients)) => {
                let at = at.key("transmittance");
                check::entries(&at.key("cosine_polynomial"), coefficients.len(), 1, "at least one coefficient")
            }
            None => Ok(()),
        };
        let layer = match (thickness, absorption) {
            (None, None) => Ok(()),
            (Some(_), None) => Err(check::fault(at, "found `thickness` without `absorption`", allowed)),
            (None, Some(_)) => Err(check::fault(at, "found `absorption` without `thickness`", allowed)),
            (Some(thickness), Some(absorption)) => check::all([
                check::positive(&at.key("thickness"), *thickness),
                absorption.validate(&at.key("absorption"), SpectrumUse::NotNegative),
            ]),
        };
        check::all([ior.validate(&at.key("ior")), layer, measured, coating_on(at, coating.as_ref())])
    }
}

impl ConductorFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { metal, eta, k, file, reflectance, roughness, coating } = self;
        let allowed = "one of `metal`, both `eta` and `k`, `file`, or `reflectance`";
        let others = metal.is_some() || eta.is_some() || k.is_some();
        let form = match (metal, eta, k) {
            _ if reflectance.is_some() && coating.is_some() => {
                Err(check::fault(&at.key("coating"), "found together with `reflectance`", "a metal with an index"))
            }
            _ if reflectance.is_some() && (others || file.is_some()) => {
                Err(check::fault(&at.key("reflectance"), "found together with an index of refraction", allowed))
            }
            _ if file.is_some() && others => {
                Err(check::fault(&at.key("file"), "found together with another index of refraction", allowed))
            }
            (None, None, None) if reflectance.is_some() || file.is_some() => Ok(()),
            (Some(_), None, None) | (None, Some(_), Some(_)) => Ok(()),
            (Some(_), Some(_), _) => Err(check::fault(&at.key("eta"), "found together with `metal`", allowed)),
            (Some(_), None, Some(_)) => Err(check::fault(&at.key("k"), "found together with `metal`", allowed)),
            (None, Some(_), None) => Err(check::fault(at, "found `eta` without `k`", allowed)),
            (None, None, Some(_)) => Err(check::fault(at, "found `k` without `eta`", allowed)),
            (None, None, None) => Err(check::fault(at, "found none of the keys it needs", allowed)),
        };
        check::all([
            form,
            eta.as_ref().map_or(Ok(()), |it| it.validate(&at.key("eta"), SpectrumUse::NotNegative)),
            k.as_ref().map_or(Ok(()), |it| it.validate(&at.key("k"), SpectrumUse::NotNegative)),
            reflectance.as_ref().map_or(Ok(()), |it| it.validate(&at.key("reflectance"))),
            roughness.validate(&at.key("roughness"), check::fraction),
            coating_on(at, coating.as_ref()),
        ])
    }
}
