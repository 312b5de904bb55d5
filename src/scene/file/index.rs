//! An index of refraction as written.

use schemars::JsonSchema;
use serde::de::MapAccess;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::check;
use super::forms::{self, Form, Forms};
use super::path::JsonPath;
use super::spectrum::validate_table;
use crate::error::Result;

/// An index of refraction, relative to the surrounding air: a number, a glass's name from the catalogue, or an object
/// with one key.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "IndexFile", transform = forms::or_number_or_name)]
pub enum IndexFile {
    /// The same at every wavelength: no dispersion.
    #[serde(skip)]
    Number(f64),
    /// A glass, liquid or crystal of the catalogue, by its Sellmeier formula.
    #[serde(skip)]
    Name(String),
    /// Cauchy's formula n = a + b/λ² + c/λ⁴ with λ in µm.
    Cauchy {
        /// The index towards long waves.
        a: f64,
        /// Coefficient of 1/λ² in µm².
        b: f64,
        /// Coefficient of 1/λ⁴ in µm⁴.
        #[serde(default, skip_serializing_if = "forms::is_default")]
        c: f64,
    },
    /// Sellmeier's formula n² = 1 + Σ bᵢλ²/(λ² − cᵢ) with λ in µm.
    Sellmeier {
        /// The strengths bᵢ.
        #[schemars(length(min = 1))]
        b: Vec<f64>,
        /// The squared resonance wavelengths cᵢ in µm².
        #[schemars(length(min = 1))]
        c: Vec<f64>,
    },
    /// The index at the d line and the Abbe number.
    Abbe {
        /// Index at 587.56 nm.
        #[schemars(range(min = 1))]
        nd: f64,
        /// Abbe number (n_d − 1)/(n_F − n_C).
        #[schemars(extend("exclusiveMinimum" = 0))]
        vd: f64,
    },
    /// Indices at wavelengths.
    Table {
        /// Wavelengths in nm, rising.
        nm: Vec<f64>,
        /// One index for each wavelength.
        values: Vec<f64>,
    },
    /// A glass of the catalogue with the formula to use, or of a Zemax catalogue's file.
    Glass {
        /// The file (`.agf`), relative to the scene's folder (default: the built-in catalogue).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        path: Option<String>,
        /// Its name.
        name: String,
        /// The formula (default: the catalogue's).
        #[serde(default, skip_serializing_if = "forms::is_default")]
        formula: FormulaFile,
    },
}

/// A dispersion formula.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FormulaFile {
    /// Sellmeier's, or whichever the catalogue states.
    #[default]
    Sellmeier,
    /// Cauchy's, fitted to the catalogue's.
    Cauchy,
}

impl Forms for IndexFile {
    const EXPECTED: &'static str = "a number, a glass's name, or an object with one of the keys cauchy, sellmeier, \
                                    abbe, table, glass";

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

/// An index relative to air: 1 or more.
fn index_number(at: &JsonPath, value: f64) -> Result<()> {
    check::rule(at, value, value >= 1.0, "an index of refraction of at least 1")
}

impl IndexFile {
    /// Checks ranges and lengths. (Whether a formula stays above 1 over the band is seen when it is resolved.)
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Number(value) => index_number(at, *value),
            Self::Name(_) | Self::Cauchy { .. } | Self::Glass { .. } => Ok(()),
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
                index_number(&at.key("nd"), *nd)?;
                check::positive(&at.key("vd"), *vd)
            }
            Self::Table { nm, values } => validate_table(&at.key("table"), nm, values, index_number),
        }
    }
}
