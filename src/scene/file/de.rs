//! Hands the values of a scanned text to serde, so that every fault knows the value or key it was found at.

use std::borrow::Cow;

use serde::de::{DeserializeSeed, Deserializer, EnumAccess, Error as _, MapAccess, SeqAccess, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;

use super::fault::{Fault, What, one_of};
use super::positions::{Elements, Kind, Value};

/// The result of reading a value.
type Read<T> = Result<T, Fault>;

/// A deserialiser of one value.
#[derive(Debug, Clone, Copy)]
pub(super) struct ValueDeserializer<'de>(Value<'de>);

impl<'de> ValueDeserializer<'de> {
    /// A deserialiser of this value.
    pub(super) fn new(value: Value<'de>) -> Self {
        Self(value)
    }

    /// Gives a visitor what stands here.
    fn visit<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        match self.0.kind() {
            Kind::Null => visitor.visit_unit(),
            Kind::Bool => visitor.visit_bool(self.0.written() == "true"),
            Kind::Number => self.visit_number(visitor),
            Kind::String => visit_text(self.0.content(), visitor),
            Kind::Array => {
                let mut elements = self.0.elements();
                let value = visitor.visit_seq(Array(&mut elements))?;
                let left = elements.count();
                if left == 0 {
                    return Ok(value);
                }
                let wanted = self.0.elements().count() - left;
                Err(Fault::mismatch(format!("an array of {wanted}")))
            }
            Kind::Object => self.visit_object(visitor),
        }
    }

    /// Gives a visitor an object.
    fn visit_object<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        let mut entries = self.0.elements();
        let value = visitor.visit_map(Object { entries: &mut entries, value: None })?;
        // What is left over belongs to a form with one key.
        match entries.next() {
            None => Ok(value),
            Some(key) => Err(Fault::new(What::SecondKey(&[])).at(key)),
        }
    }

    /// Gives a visitor a number: a whole one as such where it fits.
    fn visit_number<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        let written = self.0.written();
        if let Ok(number) = written.parse::<u64>() {
            visitor.visit_u64(number)
        } else if let Ok(number @ ..0) = written.parse::<i64>() {
            visitor.visit_i64(number)
        } else {
            visitor.visit_f64(self.float())
        }
    }

    /// The number as a float; the scanner has checked that there is one.
    fn float(self) -> f64 {
        self.0.written().parse().unwrap_or(f64::NAN)
    }

    /// Gives a visitor a whole number, also where it is written as 1e6 or 4.0 (up to 2⁵³, where floats are exact).
    fn visit_whole<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        let number = if self.0.kind() == Kind::Number { self.float() } else { f64::NAN };
        let exact = number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0;
        let result = match (exact, number >= 0.0) {
            (true, true) => visitor.visit_u64(number as u64),
            (true, false) => visitor.visit_i64(number as i64),
            (false, _) => self.visit(visitor),
        };
        result.map_err(|fault| fault.at(self.0))
    }

    /// The fault of a value that should be an object with certain keys.
    fn not_an_object(self, fields: &[&str]) -> Fault {
        let expected = match fields {
            [] => "an object".to_string(),
            [key] => format!("an object with the key {key}"),
            keys => format!("an object with the keys {}", one_of(keys).trim_start_matches("one of ")),
        };
        Fault::mismatch(expected).at(self.0)
    }

    /// Gives a visitor an object whose keys are known.
    fn visit_fields<V: Visitor<'de>>(self, fields: &[&str], visitor: V) -> Read<V::Value> {
        if self.0.kind() != Kind::Object {
            return Err(self.not_an_object(fields));
        }
        self.visit_object(visitor).map_err(|fault| fault.at(self.0))
    }
}

/// Gives a visitor a string.
fn visit_text<'de, V: Visitor<'de>>(text: Cow<'de, str>, visitor: V) -> Read<V::Value> {
    match text {
        Cow::Borrowed(text) => visitor.visit_borrowed_str(text),
        Cow::Owned(text) => visitor.visit_string(text),
    }
}

impl<'de> Deserializer<'de> for ValueDeserializer<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        self.visit(visitor).map_err(|fault| fault.at(self.0))
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        self.visit_whole(visitor)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        // Above 2⁵³ only the written digits are exact.
        if self.0.written().parse::<u64>().is_ok() { self.deserialize_any(visitor) } else { self.visit_whole(visitor) }
    }

    fn deserialize_i32<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        self.visit_whole(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        let result = if self.0.kind() == Kind::Null { visitor.visit_none() } else { visitor.visit_some(self) };
        result.map_err(|fault| fault.at(self.0))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Read<V::Value> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Read<V::Value> {
        if self.0.kind() == Kind::Array && self.0.elements().count() == length {
            return self.deserialize_any(visitor);
        }
        Err(Fault::mismatch(format!("an array of {length}")).at(self.0))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        self.visit_fields(&[], visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Read<V::Value> {
        self.visit_fields(fields, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Read<V::Value> {
        let result = match self.0.kind() {
            Kind::String => visitor.visit_enum(PlainVariant(self.0)),
            Kind::Object => {
                let mut entries = self.0.entries();
                match (entries.next(), entries.next()) {
                    (Some((key, value)), None) => visitor.visit_enum(KeyedVariant { key, value }),
                    (Some(_), Some((second, _))) => Err(Fault::new(What::SecondKey(variants)).at(second)),
                    (None, _) => Err(Fault::mismatch(one_of(variants))),
                }
            }
            Kind::Null | Kind::Bool | Kind::Number | Kind::Array => Err(Fault::mismatch(one_of(variants))),
        };
        result.map_err(|fault| fault.at(self.0))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i64 i128 u8 u16 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple_struct
        identifier ignored_any
    }
}

/// A deserialiser of a key.
struct KeyDeserializer<'de>(Value<'de>);

impl<'de> Deserializer<'de> for KeyDeserializer<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Read<V::Value> {
        visit_text(self.0.content(), visitor).map_err(|fault| fault.at(self.0))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

/// The elements of an array.
struct Array<'a, 'de>(&'a mut Elements<'de>);

impl<'de> SeqAccess<'de> for Array<'_, 'de> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Read<Option<T::Value>> {
        self.0.next().map(|value| seed.deserialize(ValueDeserializer(value))).transpose()
    }
}

/// The entries of an object.
struct Object<'a, 'de> {
    entries: &'a mut Elements<'de>,
    value: Option<Value<'de>>,
}

impl<'de> MapAccess<'de> for Object<'_, 'de> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Read<Option<K::Value>> {
        let Some(key) = self.entries.next() else { return Ok(None) };
        self.value = self.entries.next();
        seed.deserialize(KeyDeserializer(key)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Read<V::Value> {
        let value = self.value.take().ok_or_else(|| Fault::custom("found a key without a value"))?;
        seed.deserialize(ValueDeserializer(value))
    }
}

/// A variant that is written as a plain string.
struct PlainVariant<'de>(Value<'de>);

impl<'de> EnumAccess<'de> for PlainVariant<'de> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Read<(V::Value, Self)> {
        Ok((seed.deserialize(KeyDeserializer(self.0))?, self))
    }
}

impl PlainVariant<'_> {
    /// The fault of a variant that has fields but is written as a plain string.
    fn needs_fields(&self) -> Fault {
        Fault::mismatch(format!("an object {{{}: …}}", self.0.written())).at(self.0)
    }
}

impl<'de> VariantAccess<'de> for PlainVariant<'de> {
    type Error = Fault;

    fn unit_variant(self) -> Read<()> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, _: T) -> Read<T::Value> {
        Err(self.needs_fields())
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Read<V::Value> {
        Err(self.needs_fields())
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &'static [&'static str], _: V) -> Read<V::Value> {
        Err(self.needs_fields())
    }
}

/// A variant that is written as the one key of an object.
struct KeyedVariant<'de> {
    key: Value<'de>,
    value: Value<'de>,
}

impl<'de> EnumAccess<'de> for KeyedVariant<'de> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Read<(V::Value, Self)> {
        Ok((seed.deserialize(KeyDeserializer(self.key))?, self))
    }
}

impl<'de> VariantAccess<'de> for KeyedVariant<'de> {
    type Error = Fault;

    fn unit_variant(self) -> Read<()> {
        Err(Fault::mismatch(format!("just the string {}", self.key.written())).at(self.value))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Read<T::Value> {
        seed.deserialize(ValueDeserializer(self.value))
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Read<V::Value> {
        ValueDeserializer(self.value).deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: &'static [&'static str], visitor: V) -> Read<V::Value> {
        ValueDeserializer(self.value).visit_fields(fields, visitor)
    }
}
