//! sRGB colours in the scene file, as image editors and web pages write them.

use crate::forms::{Form, Forms};
use crate::{JsonPath, check, forms};
use abbe_spectra::colour::decode_srgb;
use abbe_spectra::error::{Error, Result};
use serde::de::{Error as _, MapAccess, Unexpected};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The description of a hexadecimal colour, for error messages.
const EXPECTED_HEX: &str = "a colour such as #ff8800 or #f80";

/// An sRGB colour with the transfer function of sRGB: a hexadecimal colour, or three components
/// from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub enum SrgbFile {
    /// A hexadecimal colour such as `#ff8800`.
    Hex(String),
    /// The components red, green and blue.
    Components([f64; 3]),
}

impl SrgbFile {
    /// Returns the colour in linear sRGB, or an error if the hexadecimal colour is malformed.
    pub fn linear(&self) -> Result<[f64; 3]> {
        match self {
            Self::Hex(text) => linear_of_hex(text),
            Self::Components(components) => Ok(components.map(decode_srgb)),
        }
    }

    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Hex(text) => linear_of_hex(text).map(|_| ()).map_err(|error| error.on_path(at.to_string())),
            Self::Components(components) => check::all(components.iter().enumerate().map(|(i, &component)| {
                let inside = (0.0..=1.0).contains(&component);
                let allowed = "a number from 0 to 1 (divide a component of 0 to 255 by 255)";
                check::rule(&at.index(i), component, inside, allowed)
            })),
        }
    }
}

/// Returns whether a spectrum's name is a hexadecimal colour. No name of the library has a `#`.
pub fn is_hex_colour(name: &str) -> bool {
    name.starts_with('#')
}

/// Returns the linear sRGB components of a hexadecimal colour of three or six digits.
pub fn linear_of_hex(text: &str) -> Result<[f64; 3]> {
    let malformed = || Error::input(format!("found \"{text}\"")).expected(EXPECTED_HEX);
    let digits = text.strip_prefix('#').filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
    let digits = digits.ok_or_else(malformed)?;
    let width = match digits.len() {
        3 => 1,
        6 => 2,
        _ => return Err(malformed()),
    };
    let component = |i: usize| {
        let digits = digits[i * width..(i + 1) * width].repeat(3 - width);
        u8::from_str_radix(&digits, 16).map(|code| decode_srgb(f64::from(code) / 255.0)).map_err(|_| malformed())
    };
    Ok([component(0)?, component(1)?, component(2)?])
}

impl Forms for SrgbFile {
    const EXPECTED: &'static str = "a colour such as \"#ff8800\", or an array of 3";

    const HAS_TRIPLE: bool = true;

    fn from_name(name: String) -> Option<Self> {
        Some(Self::Hex(name))
    }

    fn from_triple(triple: [f64; 3]) -> Option<Self> {
        Some(Self::Components(triple))
    }

    fn from_object<'de, A: MapAccess<'de>>(_: Form<A>) -> std::result::Result<Self, A::Error> {
        Err(A::Error::invalid_type(Unexpected::Map, &Self::EXPECTED))
    }
}

impl<'de> Deserialize<'de> for SrgbFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for SrgbFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Hex(text) => text.serialize(serializer),
            Self::Components(components) => components.serialize(serializer),
        }
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for SrgbFile {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "SrgbFile".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({"anyOf": [
            {"type": "string", "pattern": "^#([0-9a-fA-F]{3}){1,2}$"},
            {"type": "array", "items": {"type": "number", "minimum": 0, "maximum": 1}, "minItems": 3, "maxItems": 3}
        ]})
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_colours_have_three_or_six_digits() {
        assert_eq!(linear_of_hex("#ffffff").unwrap(), [1.0; 3]);
        assert_eq!(linear_of_hex("#f80").unwrap(), linear_of_hex("#FF8800").unwrap());
        // IEC 61966-2-1: the code 188 of 255 is 0.5029 in linear sRGB.
        assert!((linear_of_hex("#bcbcbc").unwrap()[0] - 0.5029).abs() < 1e-4);
        for text in ["#", "#ff", "#ff880", "#gg8800", "ff8800", "#ff88001", "#ääé"] {
            let error = linear_of_hex(text).unwrap_err().to_string();
            assert!(error.contains(text) && error.contains(EXPECTED_HEX), "{error}");
        }
    }
}
