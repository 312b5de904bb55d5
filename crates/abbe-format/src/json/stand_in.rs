//! A serde deserialiser that returns some value of any type, for the values of a text that could
//! not be read.

use serde::de::{Deserializer, Visitor};
use serde::forward_to_deserialize_any;

use super::access::{ArrayElements, ObjectEntries, Variant};
use super::deserialize::DeserializeResult;
use super::deserialize_error::{DeserializeError, DeserializeErrorKind};

/// A deserialiser without a text. Every number is 1, every text is empty, and every list is empty.
/// The variant of an enum is the first one. An optional value is absent.
///
/// A type that accepts several kinds of values gets a number. If such a type accepts no numbers,
/// the deserialiser returns an error of the kind [`DeserializeErrorKind::NoStandIn`].
#[derive(Debug, Clone, Copy)]
pub(super) struct StandIn;

impl<'de> Deserializer<'de> for StandIn {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_f64::<DeserializeError>(1.0).map_err(|_| DeserializeError::new(DeserializeErrorKind::NoStandIn))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_bool(false)
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_u64(1)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_u64(1)
    }

    fn deserialize_i32<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_u64(1)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_borrowed_str("")
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_borrowed_str("")
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_none()
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_seq(ArrayElements::StandIns(0))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_seq(ArrayElements::StandIns(length))
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visitor.visit_map(&mut ObjectEntries::stand_ins(&[]))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> DeserializeResult<V::Value> {
        visitor.visit_map(&mut ObjectEntries::stand_ins(fields))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> DeserializeResult<V::Value> {
        match variants.first() {
            Some(first) => visitor.visit_enum(Variant::StandIn(first)),
            None => Err(DeserializeError::new(DeserializeErrorKind::NoStandIn)),
        }
    }

    forward_to_deserialize_any! {
        i8 i16 i64 i128 u8 u16 u128 f32 f64 char bytes byte_buf unit unit_struct tuple_struct identifier ignored_any
    }
}
