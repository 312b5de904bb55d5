//! Stacks of thin films in the scene file and on the command line.

use crate::forms::{Form, Forms};
use crate::prelude::*;
use crate::{IndexFile, JsonPath, ScalarFile, SpectrumFile, check, forms, spectrum::SpectrumUse};
use abbe_spectra::error::Result;
use serde::de::MapAccess;

/// Thin films on top of each other, in which light interferes. The order of the films is from the
/// outside to the substrate.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Stack of thin films")]
#[schemars(example = json!({"layers": [{"ior": "MgF2", "thickness_nm": 100}]}))]
#[schemars(example = json!({"incident": "air", "layers": [{"ior": 1.38, "thickness_nm": 99.6}, {"ior": 2.05,
    "thickness_nm": 19.4}], "substrate": "N-BK7"}))]
pub struct CoatingFile {
    /// The medium in which light arrives. A material in a scene may leave it out; otherwise it must
    /// be air.
    #[schemars(extend("x-default" = "air"))]
    pub incident: Option<CoatingIndexFile>,
    /// The films, from the outside to the substrate.
    pub layers: Vec<CoatingLayerFile>,
    /// The medium below the films. A material in a scene may leave it out; otherwise it must be the
    /// material itself.
    #[schemars(extend("x-default" = "air, or the coated material"))]
    pub substrate: Option<CoatingIndexFile>,
}

/// One thin film.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Thin film", example = json!({"ior": "rutile TiO2", "thickness_nm": 60}))]
#[schemars(example = json!({"ior": "silver", "thickness_nm": 30}))]
#[schemars(example = json!({"ior": "water", "thickness_nm": {"gradient": {"a": 20, "b": 900, "power": 0.5}}}))]
pub struct CoatingLayerFile {
    /// The index of refraction of the film.
    pub ior: CoatingIndexFile,
    /// Thickness of the film. A texture is interpolated between its texels. Only one film of a
    /// stack may have a texture.
    #[schemars(extend("minimum" = 0, "maximum" = 1e6, "x-unit" = "nm"))]
    pub thickness_nm: ScalarFile,
}

/// The index of refraction of a film or of a medium beside it: the forms of an index of refraction,
/// `"air"` for an index of 1, the name of a metal, or n and k.
#[derive(Debug, Clone, PartialEq)]
pub enum CoatingIndexFile {
    /// A form of an index of refraction, or the name of a metal.
    Index(IndexFile),
    /// The complex index n + ik.
    Complex(ComplexIndexFile),
}

/// A complex index of refraction n + ik.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Complex index of refraction", example = json!({"n": 0.2, "k": 3.4}))]
pub struct ComplexIndexFile {
    /// Real part of the index of refraction.
    #[schemars(extend("minimum" = 0))]
    pub n: SpectrumFile,
    /// Extinction coefficient: the imaginary part of the index of refraction.
    #[schemars(extend("minimum" = 0))]
    pub k: SpectrumFile,
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for CoatingIndexFile {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "CoatingIndexFile".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let choices = [generator.subschema_for::<IndexFile>(), generator.subschema_for::<ComplexIndexFile>()];
        schemars::json_schema!({
            "title": "Index of a film",
            "description": "The index of refraction of a film or of a medium beside it: an index of refraction, \
                            `\"air\"` for an index of 1, the name of a metal, or n and k.",
            "examples": ["MgF2", "silver", {"n": 0.2, "k": 3.4}],
            "anyOf": choices
        })
    }
}

impl Forms for CoatingIndexFile {
    const EXPECTED: &'static str = "a number, the name of a glass, a liquid or a metal, n and k, or an object with one \
                                    of the keys cauchy, sellmeier, abbe, table, glass, file";

    fn from_number(number: f64) -> Option<Self> {
        Some(Self::Index(IndexFile::Number(number)))
    }

    fn from_name(name: String) -> Option<Self> {
        Some(Self::Index(IndexFile::Name(name)))
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        if matches!(form.key.as_str(), "n" | "k") {
            ComplexIndexFile::deserialize(form).map(Self::Complex)
        } else {
            IndexFile::from_object(form).map(Self::Index)
        }
    }
}

impl<'de> Deserialize<'de> for CoatingIndexFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for CoatingIndexFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Index(index) => serde::Serialize::serialize(index, serializer),
            Self::Complex(complex) => complex.serialize(serializer),
        }
    }
}

impl CoatingFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { incident, layers, substrate } = self;
        let index = |key: &str, index: &Option<CoatingIndexFile>| {
            index.as_ref().map_or(Ok(()), |index| index.validate(&at.key(key)))
        };
        let at_layers = at.key("layers");
        let layers = check::all(layers.iter().enumerate().map(|(i, layer)| {
            let at = at_layers.index(i);
            let thickness = layer.thickness_nm.validate(&at.key("thickness_nm"), thickness);
            check::all([layer.ior.validate(&at.key("ior")), thickness])
        }));
        check::all([index("incident", incident), layers, index("substrate", substrate)])
    }
}

fn thickness(at: &JsonPath, nm: f64) -> Result<()> {
    check::rule(at, nm, (0.0..=1e6).contains(&nm), "a number from 0 to 1000000")
}

impl CoatingIndexFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Index(index) => index.validate(at),
            Self::Complex(ComplexIndexFile { n, k }) => check::all([
                n.validate(&at.key("n"), SpectrumUse::NotNegative),
                k.validate(&at.key("k"), SpectrumUse::NotNegative),
            ]),
        }
    }
}
