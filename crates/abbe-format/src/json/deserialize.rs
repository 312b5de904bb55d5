//! A serde deserialiser for the values of a scanned text. Each error has the position of the wrong
//! value or key.

use serde::de::{DeserializeSeed, Deserializer, Visitor};
use serde::forward_to_deserialize_any;

use super::access::{ArrayElements, ObjectEntries, Variant, visit_text};
use super::describe::one_of;
use super::deserialize_error::{DeserializeError, DeserializeErrorKind};
use super::positions::{SpannedValue, ValueKind};
use super::repair::Repairs;
use super::stand_in::StandIn;

/// The result of reading a value.
pub(super) type DeserializeResult<T> = Result<T, DeserializeError>;

/// Deserialises a value. If the repairs replace the value, the result is a stand-in.
pub(super) fn deserialize<'de, T: DeserializeSeed<'de>>(
    seed: T,
    value: SpannedValue<'de>,
    repairs: &Repairs,
) -> DeserializeResult<T::Value> {
    if repairs.replaces(value) {
        seed.deserialize(StandIn)
    } else {
        seed.deserialize(ValueDeserializer { value, repairs })
    }
}

/// A deserialiser of one value.
#[derive(Debug, Clone, Copy)]
pub(super) struct ValueDeserializer<'r, 'de> {
    pub(super) value: SpannedValue<'de>,
    pub(super) repairs: &'r Repairs,
}

impl<'de> ValueDeserializer<'_, 'de> {
    /// Calls the visitor's method that matches the kind of this value.
    fn visit<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        match self.value.kind() {
            ValueKind::Null => visitor.visit_unit(),
            ValueKind::Bool => visitor.visit_bool(self.value.written() == "true"),
            ValueKind::Number => self.visit_number(visitor),
            ValueKind::String => visit_text(self.value.content(), visitor),
            ValueKind::Array => {
                let mut elements = self.value.children();
                let value = visitor.visit_seq(ArrayElements::Written(&mut elements, self.repairs))?;
                let left = elements.count();
                if left == 0 {
                    return Ok(value);
                }
                let wanted = self.value.children().count() - left;
                Err(DeserializeError::mismatch(format!("an array of {wanted}")))
            }
            ValueKind::Object => self.visit_object(visitor),
        }
    }

    /// Visits an object.
    fn visit_object<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let mut entries = ObjectEntries::of(self.value, self.repairs);
        let value = visitor.visit_map(&mut entries)?;
        // The visitor of a struct reads all keys. The visitor of an enum reads only the first key.
        match entries.next_kept_key() {
            None => Ok(value),
            Some(key) => Err(DeserializeError::new(DeserializeErrorKind::SecondKey(&[])).at(key)),
        }
    }

    /// Visits a number. If the text is an integer that fits 64 bits, the visitor gets an integer.
    /// Otherwise, the visitor gets a float.
    fn visit_number<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let written = self.value.written();
        if let Ok(number) = written.parse::<u64>() {
            visitor.visit_u64(number)
        } else if let Ok(number @ ..0) = written.parse::<i64>() {
            visitor.visit_i64(number)
        } else {
            visitor.visit_f64(self.float())
        }
    }

    /// Returns the number as a float. The scanner has checked the syntax.
    fn float(self) -> f64 {
        self.value.written().parse().unwrap_or(f64::NAN)
    }

    /// Visits a whole number. Forms such as 1e6 or 4.0 are accepted for numbers up to 2⁵³, because
    /// floats above 2⁵³ cannot represent every whole number.
    fn visit_whole<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let number = if self.value.kind() == ValueKind::Number { self.float() } else { f64::NAN };
        let exact = number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0;
        let result = match (exact, number >= 0.0) {
            (true, true) => visitor.visit_u64(number as u64),
            (true, false) => visitor.visit_i64(number as i64),
            (false, _) => self.visit(visitor),
        };
        result.map_err(|error| error.at(self.value))
    }

    /// Returns the error for a value that should be an object. `fields` are the keys of the object.
    fn not_an_object(self, fields: &[&str]) -> DeserializeError {
        let expected = match fields {
            [] => "an object".to_string(),
            [key] => format!("an object with the key {key}"),
            keys => format!("an object with the keys {}", one_of(keys).trim_start_matches("one of ")),
        };
        DeserializeError::mismatch(expected).at(self.value)
    }

    /// Visits an object with the known keys `fields`.
    pub(super) fn visit_fields<V: Visitor<'de>>(self, fields: &[&str], visitor: V) -> DeserializeResult<V::Value> {
        if self.value.kind() != ValueKind::Object {
            return Err(self.not_an_object(fields));
        }
        self.visit_object(visitor).map_err(|error| error.at(self.value))
    }
}

impl<'de> Deserializer<'de> for ValueDeserializer<'_, 'de> {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        self.visit(visitor).map_err(|error| error.at(self.value))
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        self.visit_whole(visitor)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        // Floats above 2⁵³ cannot represent every integer, so integers are read from the digits of
        // the text.
        if self.value.written().parse::<u64>().is_ok() {
            self.deserialize_any(visitor)
        } else {
            self.visit_whole(visitor)
        }
    }

    fn deserialize_i32<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        self.visit_whole(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let result = if self.value.kind() == ValueKind::Null { visitor.visit_none() } else { visitor.visit_some(self) };
        result.map_err(|error| error.at(self.value))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> DeserializeResult<V::Value> {
        if self.value.kind() == ValueKind::Array && self.value.children().count() == length {
            return self.deserialize_any(visitor);
        }
        Err(DeserializeError::mismatch(format!("an array of {length}")).at(self.value))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        self.visit_fields(&[], visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> DeserializeResult<V::Value> {
        self.visit_fields(fields, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> DeserializeResult<V::Value> {
        let result = match self.value.kind() {
            ValueKind::String => visitor.visit_enum(Variant::Plain(self.value)),
            ValueKind::Object => {
                let mut entries = self.value.entries().filter(|(key, _)| !self.repairs.drops(*key));
                match (entries.next(), entries.next()) {
                    (Some((key, value)), None) => {
                        visitor.visit_enum(Variant::Keyed { key, value, repairs: self.repairs })
                    }
                    (Some(_), Some((second, _))) => {
                        Err(DeserializeError::new(DeserializeErrorKind::SecondKey(variants)).at(second))
                    }
                    (None, _) => Err(DeserializeError::mismatch(one_of(variants))),
                }
            }
            ValueKind::Null | ValueKind::Bool | ValueKind::Number | ValueKind::Array => {
                Err(DeserializeError::mismatch(one_of(variants)))
            }
        };
        result.map_err(|error| error.at(self.value))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i64 i128 u8 u16 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple_struct
        identifier ignored_any
    }
}
