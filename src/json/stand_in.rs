//! A serde deserialiser that returns some value of any type, for the values of a text that could
//! not be read.

use serde::de::Visitor;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess};
use serde::forward_to_deserialize_any;

use super::deserialize_error::{DeserializeError, DeserializeErrorKind};

/// A deserialiser without a text. Every number is 1, every text is empty, and every list is empty.
/// The variant of an enum is the first one. An optional value is absent.
///
/// A type that accepts several kinds of values gets a number. If such a type accepts no numbers,
/// the deserialiser returns an error of the kind [`DeserializeErrorKind::NoStandIn`].
#[derive(Debug, Clone, Copy)]
pub(super) struct StandIn;

/// The result of reading a value.
type StandInResult<T> = Result<T, DeserializeError>;

impl<'de> Deserializer<'de> for StandIn {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_f64::<DeserializeError>(1.0).map_err(|_| DeserializeError::new(DeserializeErrorKind::NoStandIn))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_bool(false)
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_u64(1)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_u64(1)
    }

    fn deserialize_i32<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_u64(1)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_borrowed_str("")
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_borrowed_str("")
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_none()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_seq(StandInElements(0))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_seq(StandInElements(length))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> StandInResult<V::Value> {
        visitor.visit_map(StandInEntries(&[]))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> StandInResult<V::Value> {
        visitor.visit_map(StandInEntries(fields))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> StandInResult<V::Value> {
        match variants.first() {
            Some(first) => visitor.visit_enum(FirstVariant(first)),
            None => Err(DeserializeError::new(DeserializeErrorKind::NoStandIn)),
        }
    }

    forward_to_deserialize_any! {
        i8 i16 i64 i128 u8 u16 u128 f32 f64 char bytes byte_buf unit unit_struct tuple_struct identifier ignored_any
    }
}

/// The given number of stand-ins, as the elements of an array.
struct StandInElements(usize);

impl<'de> SeqAccess<'de> for StandInElements {
    type Error = DeserializeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> StandInResult<Option<T::Value>> {
        let Some(left) = self.0.checked_sub(1) else { return Ok(None) };
        self.0 = left;
        seed.deserialize(StandIn).map(Some)
    }
}

/// The fields of a struct, each with a stand-in as its value.
struct StandInEntries(&'static [&'static str]);

impl<'de> MapAccess<'de> for StandInEntries {
    type Error = DeserializeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> StandInResult<Option<K::Value>> {
        let Some((first, rest)) = self.0.split_first() else { return Ok(None) };
        self.0 = rest;
        let key: StrDeserializer<'_, DeserializeError> = first.into_deserializer();
        seed.deserialize(key).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> StandInResult<V::Value> {
        seed.deserialize(StandIn)
    }
}

/// The first variant of an enum, with stand-ins as its fields.
struct FirstVariant(&'static str);

impl<'de> EnumAccess<'de> for FirstVariant {
    type Error = DeserializeError;
    type Variant = StandIn;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> StandInResult<(V::Value, StandIn)> {
        let name: StrDeserializer<'_, DeserializeError> = self.0.into_deserializer();
        Ok((seed.deserialize(name)?, StandIn))
    }
}

impl<'de> VariantAccess<'de> for StandIn {
    type Error = DeserializeError;

    fn unit_variant(self) -> StandInResult<()> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> StandInResult<T::Value> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> StandInResult<V::Value> {
        self.deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: &'static [&'static str], visitor: V) -> StandInResult<V::Value> {
        self.deserialize_struct("", fields, visitor)
    }
}
