//! A serde deserialiser for the values of a scanned text. Each error has the position of the wrong
//! value or key.

use std::borrow::Cow;

use serde::de::{DeserializeSeed, Deserializer, EnumAccess, Error as _, MapAccess, SeqAccess, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;

use super::describe::one_of;
use super::deserialize_error::{DeserializeError, DeserializeErrorKind};
use super::positions::{ChildValues, SpannedValue, ValueKind};

/// The result of reading a value.
type DeserializeResult<T> = Result<T, DeserializeError>;

/// A deserialiser of one value.
#[derive(Debug, Clone, Copy)]
pub(super) struct ValueDeserializer<'de>(SpannedValue<'de>);

impl<'de> ValueDeserializer<'de> {
    /// Returns a deserialiser of this value.
    pub(super) fn new(value: SpannedValue<'de>) -> Self {
        Self(value)
    }

    /// Calls the visitor's method that matches the kind of this value.
    fn visit<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        match self.0.kind() {
            ValueKind::Null => visitor.visit_unit(),
            ValueKind::Bool => visitor.visit_bool(self.0.written() == "true"),
            ValueKind::Number => self.visit_number(visitor),
            ValueKind::String => visit_text(self.0.content(), visitor),
            ValueKind::Array => {
                let mut elements = self.0.children();
                let value = visitor.visit_seq(ArrayElements(&mut elements))?;
                let left = elements.count();
                if left == 0 {
                    return Ok(value);
                }
                let wanted = self.0.children().count() - left;
                Err(DeserializeError::mismatch(format!("an array of {wanted}")))
            }
            ValueKind::Object => self.visit_object(visitor),
        }
    }

    /// Visits an object.
    fn visit_object<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let mut entries = self.0.children();
        let value = visitor.visit_map(ObjectEntries { entries: &mut entries, value: None })?;
        // The visitor of a struct reads all keys. The visitor of an enum reads only the first key.
        match entries.next() {
            None => Ok(value),
            Some(key) => Err(DeserializeError::new(DeserializeErrorKind::SecondKey(&[])).at(key)),
        }
    }

    /// Visits a number. If the text is an integer that fits 64 bits, the visitor gets an integer.
    /// Otherwise, the visitor gets a float.
    fn visit_number<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let written = self.0.written();
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
        self.0.written().parse().unwrap_or(f64::NAN)
    }

    /// Visits a whole number. Forms such as 1e6 or 4.0 are accepted for numbers up to 2⁵³, because
    /// floats above 2⁵³ cannot represent every whole number.
    fn visit_whole<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let number = if self.0.kind() == ValueKind::Number { self.float() } else { f64::NAN };
        let exact = number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0;
        let result = match (exact, number >= 0.0) {
            (true, true) => visitor.visit_u64(number as u64),
            (true, false) => visitor.visit_i64(number as i64),
            (false, _) => self.visit(visitor),
        };
        result.map_err(|error| error.at(self.0))
    }

    /// Returns the error for a value that should be an object. `fields` are the keys of the object.
    fn not_an_object(self, fields: &[&str]) -> DeserializeError {
        let expected = match fields {
            [] => "an object".to_string(),
            [key] => format!("an object with the key {key}"),
            keys => format!("an object with the keys {}", one_of(keys).trim_start_matches("one of ")),
        };
        DeserializeError::mismatch(expected).at(self.0)
    }

    /// Visits an object with the known keys `fields`.
    fn visit_fields<V: Visitor<'de>>(self, fields: &[&str], visitor: V) -> DeserializeResult<V::Value> {
        if self.0.kind() != ValueKind::Object {
            return Err(self.not_an_object(fields));
        }
        self.visit_object(visitor).map_err(|error| error.at(self.0))
    }
}

/// Visits a string.
fn visit_text<'de, V: Visitor<'de>>(text: Cow<'de, str>, visitor: V) -> DeserializeResult<V::Value> {
    match text {
        Cow::Borrowed(text) => visitor.visit_borrowed_str(text),
        Cow::Owned(text) => visitor.visit_string(text),
    }
}

impl<'de> Deserializer<'de> for ValueDeserializer<'de> {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        self.visit(visitor).map_err(|error| error.at(self.0))
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        self.visit_whole(visitor)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        // Floats above 2⁵³ cannot represent every integer, so integers are read from the digits of
        // the text.
        if self.0.written().parse::<u64>().is_ok() { self.deserialize_any(visitor) } else { self.visit_whole(visitor) }
    }

    fn deserialize_i32<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        self.visit_whole(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        let result = if self.0.kind() == ValueKind::Null { visitor.visit_none() } else { visitor.visit_some(self) };
        result.map_err(|error| error.at(self.0))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> DeserializeResult<V::Value> {
        if self.0.kind() == ValueKind::Array && self.0.children().count() == length {
            return self.deserialize_any(visitor);
        }
        Err(DeserializeError::mismatch(format!("an array of {length}")).at(self.0))
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
        let result = match self.0.kind() {
            ValueKind::String => visitor.visit_enum(PlainVariant(self.0)),
            ValueKind::Object => {
                let mut entries = self.0.entries();
                match (entries.next(), entries.next()) {
                    (Some((key, value)), None) => visitor.visit_enum(KeyedVariant { key, value }),
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
        result.map_err(|error| error.at(self.0))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i64 i128 u8 u16 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple_struct
        identifier ignored_any
    }
}

/// A deserialiser of a key.
struct KeyDeserializer<'de>(SpannedValue<'de>);

impl<'de> Deserializer<'de> for KeyDeserializer<'de> {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visit_text(self.0.content(), visitor).map_err(|error| error.at(self.0))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

/// Gives the elements of an array to serde.
struct ArrayElements<'a, 'de>(&'a mut ChildValues<'de>);

impl<'de> SeqAccess<'de> for ArrayElements<'_, 'de> {
    type Error = DeserializeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> DeserializeResult<Option<T::Value>> {
        self.0.next().map(|value| seed.deserialize(ValueDeserializer(value))).transpose()
    }
}

/// Gives the entries of an object to serde. `value` belongs to the key that was read last.
struct ObjectEntries<'a, 'de> {
    entries: &'a mut ChildValues<'de>,
    value: Option<SpannedValue<'de>>,
}

impl<'de> MapAccess<'de> for ObjectEntries<'_, 'de> {
    type Error = DeserializeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> DeserializeResult<Option<K::Value>> {
        let Some(key) = self.entries.next() else { return Ok(None) };
        self.value = self.entries.next();
        seed.deserialize(KeyDeserializer(key)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> DeserializeResult<V::Value> {
        let value = self.value.take().ok_or_else(|| DeserializeError::custom("found a key without a value"))?;
        seed.deserialize(ValueDeserializer(value))
    }
}

/// An enum variant without fields, written as a string.
struct PlainVariant<'de>(SpannedValue<'de>);

impl<'de> EnumAccess<'de> for PlainVariant<'de> {
    type Error = DeserializeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> DeserializeResult<(V::Value, Self)> {
        Ok((seed.deserialize(KeyDeserializer(self.0))?, self))
    }
}

impl PlainVariant<'_> {
    /// Returns the error for a variant that has fields but is written as a string.
    fn needs_fields(&self) -> DeserializeError {
        DeserializeError::mismatch(format!("an object {{{}: …}}", self.0.written())).at(self.0)
    }
}

impl<'de> VariantAccess<'de> for PlainVariant<'de> {
    type Error = DeserializeError;

    fn unit_variant(self) -> DeserializeResult<()> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, _: T) -> DeserializeResult<T::Value> {
        Err(self.needs_fields())
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> DeserializeResult<V::Value> {
        Err(self.needs_fields())
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &'static [&'static str], _: V) -> DeserializeResult<V::Value> {
        Err(self.needs_fields())
    }
}

/// An enum variant with fields. In JSON, the variant is an object with one key, and this key is the
/// name of the variant.
struct KeyedVariant<'de> {
    key: SpannedValue<'de>,
    value: SpannedValue<'de>,
}

impl<'de> EnumAccess<'de> for KeyedVariant<'de> {
    type Error = DeserializeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> DeserializeResult<(V::Value, Self)> {
        Ok((seed.deserialize(KeyDeserializer(self.key))?, self))
    }
}

impl<'de> VariantAccess<'de> for KeyedVariant<'de> {
    type Error = DeserializeError;

    fn unit_variant(self) -> DeserializeResult<()> {
        Err(DeserializeError::mismatch(format!("just the string {}", self.key.written())).at(self.value))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> DeserializeResult<T::Value> {
        seed.deserialize(ValueDeserializer(self.value))
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> DeserializeResult<V::Value> {
        ValueDeserializer(self.value).deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> DeserializeResult<V::Value> {
        ValueDeserializer(self.value).visit_fields(fields, visitor)
    }
}
