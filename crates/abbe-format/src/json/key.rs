//! A serde deserialiser for the keys of objects and for the names of variants.

use super::deserialize_error::{DeserializeError, ReadResult};
use super::positions::SpannedValue;
use serde::de::{Deserializer, Visitor};
use serde::forward_to_deserialize_any;
use std::borrow::Cow;

pub(super) struct KeyDeserializer<'de> {
    text: Cow<'de, str>,
    /// The place of the key in the text. `None` for an added key.
    place: Option<SpannedValue<'de>>,
}

impl<'de> KeyDeserializer<'de> {
    pub(super) fn written(key: SpannedValue<'de>) -> Self {
        Self { text: key.content(), place: Some(key) }
    }

    pub(super) fn added(key: &'static str) -> Self {
        Self { text: Cow::Borrowed(key), place: None }
    }
}

impl<'de> Deserializer<'de> for KeyDeserializer<'de> {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        visitor.visit_str(&self.text).map_err(|error: DeserializeError| match self.place {
            Some(place) => error.at(place),
            None => error,
        })
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}
