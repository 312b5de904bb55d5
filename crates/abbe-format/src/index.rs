//! Indices of refraction in the scene file.

use crate::forms::{Form, Forms};
use crate::prelude::*;
use crate::{JsonPath, check, forms, spectrum::validate_table};
use abbe_spectra::error::Result;
use serde::de::MapAccess;

/// An index of refraction relative to air: a number, the name of a material in the built-in
/// catalogue, or an object with one key. `abbe glass --list` prints the names.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "IndexFile", title = "Index of refraction", transform = crate::schema::or_number_or_name)]
#[schemars(example = json!(1.5), example = &"N-BK7")]
pub enum IndexFile {
    /// The same index at every wavelength, without dispersion.
    #[serde(skip)]
    Number(f64),
    /// A glass, liquid or crystal of the catalogue, by its Sellmeier formula.
    #[serde(skip)]
    Name(String),
    /// Cauchy's formula n = a + b/λ² + c/λ⁴ with λ in µm.
    #[schemars(example = json!({"cauchy": {"a": 1.5046, "b": 0.0042, "c": 0.0001}}))]
    Cauchy {
        /// The index in the limit of long wavelengths.
        a: f64,
        /// Coefficient of 1/λ².
        #[schemars(extend("x-unit" = "µm²"))]
        b: f64,
        /// Coefficient of 1/λ⁴.
        #[serde(default, skip_serializing_if = "forms::is_default")]
        #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "µm⁴"))]
        c: f64,
    },
    /// Sellmeier's formula n² = 1 + Σ bᵢλ²/(λ² − cᵢ) with λ in µm.
    #[schemars(example = json!({"sellmeier": {"b": [1.03961212, 0.231792344, 1.01046945],
        "c": [0.00600069867, 0.0200179144, 103.560653]}}))]
    Sellmeier {
        /// The coefficients bᵢ.
        #[schemars(length(min = 1))]
        b: Vec<f64>,
        /// The squared resonance wavelengths cᵢ, one for each bᵢ.
        #[schemars(length(min = 1), extend("x-unit" = "µm²"))]
        c: Vec<f64>,
    },
    /// The index at the d line and the Abbe number.
    #[schemars(example = json!({"abbe": {"nd": 1.5168, "vd": 64.17}}))]
    Abbe {
        /// Index of refraction at the d line, 587.56 nm.
        #[schemars(range(min = 1))]
        nd: f64,
        /// Abbe number (n_d − 1)/(n_F − n_C).
        #[schemars(extend("exclusiveMinimum" = 0))]
        vd: f64,
    },
    /// Indices at given wavelengths, interpolated between them.
    #[schemars(example = json!({"table": {"nm": [400, 550, 700], "values": [1.53, 1.519, 1.513]}}))]
    Table {
        /// Wavelengths in rising order.
        #[schemars(length(min = 2), transform = crate::schema::positive_items, extend("x-unit" = "nm"))]
        nm: Vec<f64>,
        /// One index for each wavelength.
        #[schemars(inner(range(min = 1)))]
        values: Vec<f64>,
    },
    /// A material of the built-in catalogue, or of a Zemax catalogue file, and the formula to use.
    #[schemars(example = json!({"glass": {"path": "schott.agf", "name": "N-SF10", "formula": "sellmeier"}}))]
    Glass {
        /// Path of a Zemax glass catalogue (`.agf`), relative to the scene's folder.
        #[schemars(extend("x-default" = "built-in catalogue"))]
        path: Option<String>,
        /// Name of the material in the catalogue.
        name: String,
        /// The dispersion formula.
        #[serde(default, skip_serializing_if = "forms::is_default")]
        #[schemars(skip_serializing_if = "crate::schema::never")]
        formula: FormulaFile,
    },
    /// Path of a file with measured indices, relative to the scene's folder: an entry of the
    /// database refractiveindex.info (`.yml`), or a CSV file with a header row such as `nm,n` or
    /// `um,n,k`.
    #[schemars(example = json!({"file": "PMMA.yml"}))]
    File(String),
}

/// The dispersion formula of a catalogue material.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Dispersion formula")]
pub enum FormulaFile {
    /// The formula of the catalogue, normally Sellmeier's.
    #[default]
    Sellmeier,
    /// Cauchy's formula, fitted to the catalogue's formula.
    Cauchy,
}

impl Forms for IndexFile {
    const EXPECTED: &'static str = "a number, a glass's name, or an object with one of the keys cauchy, sellmeier, \
                                    abbe, table, glass, file";

    fn from_number(number: f64) -> Option<Self> {
        Some(Self::Number(number))
    }

    fn from_name(name: String) -> Option<Self> {
        Some(Self::Name(name))
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for IndexFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for IndexFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        if let Self::Number(number) = self {
            serializer.serialize_f64(*number)
        } else if let Self::Name(name) = self {
            serializer.serialize_str(name)
        } else {
            Self::serialize(self, serializer)
        }
    }
}

/// Checks that an index of refraction relative to air is at least 1.
fn index_number(at: &JsonPath, value: f64) -> Result<()> {
    check::rule(at, value, value >= 1.0, "an index of refraction of at least 1")
}

impl IndexFile {
    /// Checks the ranges of numbers and the lengths of lists. If the index is given by a formula,
    /// the resolver checks later that the index is at least 1 everywhere within 360–830 nm.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Number(value) => index_number(at, *value),
            Self::Name(_) | Self::Cauchy { .. } | Self::Glass { .. } | Self::File(_) => Ok(()),
            Self::Sellmeier { b, c } => {
                let at = at.key("sellmeier");
                check::entries(&at.key("b"), b.len(), 1, "at least one coefficient")?;
                if b.len() == c.len() {
                    return Ok(());
                }
                let allowed = format!("an array of {}, one for each of `b`", b.len());
                Err(check::fault(&at.key("c"), format!("found an array of {}", c.len()), allowed))
            }
            Self::Abbe { nd, vd } => {
                let at = at.key("abbe");
                check::all([index_number(&at.key("nd"), *nd), check::positive(&at.key("vd"), *vd)])
            }
            Self::Table { nm, values } => validate_table(&at.key("table"), nm, values, &index_number),
        }
    }
}
