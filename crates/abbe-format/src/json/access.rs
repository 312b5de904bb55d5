//! The parts of values in the form that serde's visitors read: entries of objects, elements of
//! arrays, variants of enums, and keys. Each type also represents stand-ins, so that the code of a
//! visitor exists only once in the program.

use std::borrow::Cow;

use serde::de::{DeserializeSeed, Deserializer, EnumAccess, MapAccess, SeqAccess, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;

use super::deserialize::{DeserializeResult, ValueDeserializer, deserialize};
use super::deserialize_error::DeserializeError;
use super::positions::{ChildValues, SpannedValue};
use super::repair::Repairs;
use super::stand_in::StandIn;

/// A deserialiser of a key, or of the name of a variant.
pub(super) struct KeyDeserializer<'de> {
    text: Cow<'de, str>,
    /// The place of the key in the text. `None` for an added key.
    place: Option<SpannedValue<'de>>,
}

impl<'de> KeyDeserializer<'de> {
    fn written(key: SpannedValue<'de>) -> Self {
        Self { text: key.content(), place: Some(key) }
    }

    fn added(key: &'static str) -> Self {
        Self { text: Cow::Borrowed(key), place: None }
    }
}

impl<'de> Deserializer<'de> for KeyDeserializer<'de> {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> DeserializeResult<V::Value> {
        visit_text(self.text, visitor).map_err(|error| match self.place {
            Some(place) => error.at(place),
            None => error,
        })
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

/// Visits a string.
pub(super) fn visit_text<'de, V: Visitor<'de>>(text: Cow<'de, str>, visitor: V) -> DeserializeResult<V::Value> {
    match text {
        Cow::Borrowed(text) => visitor.visit_borrowed_str(text),
        Cow::Owned(text) => visitor.visit_string(text),
    }
}

/// Gives the elements of an array to serde: the elements of the text, or stand-ins.
pub(super) enum ArrayElements<'a, 'de> {
    /// Elements of the text.
    Written(&'a mut ChildValues<'de>, &'a Repairs),
    /// This number of stand-ins.
    StandIns(usize),
}

impl<'de> SeqAccess<'de> for ArrayElements<'_, 'de> {
    type Error = DeserializeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> DeserializeResult<Option<T::Value>> {
        match self {
            Self::Written(elements, repairs) => {
                elements.next().map(|value| deserialize(seed, value, repairs)).transpose()
            }
            Self::StandIns(0) => Ok(None),
            Self::StandIns(left) => {
                *left -= 1;
                seed.deserialize(StandIn).map(Some)
            }
        }
    }

    fn size_hint(&self) -> Option<usize> {
        Some(match self {
            Self::Written(elements, _) => elements.left(),
            Self::StandIns(left) => *left,
        })
    }
}

/// Gives the entries of an object to serde: the entries of the text that are not dropped, and then
/// the added keys.
pub(super) struct ObjectEntries<'a, 'de> {
    /// The entries of the text. `None` if all values are stand-ins.
    written: Option<(ChildValues<'de>, &'a Repairs)>,
    /// The added keys, beginning with the last one.
    added: Vec<&'static str>,
    /// The value of the key that was read last. `None` stands for the value of an added key.
    value: Option<SpannedValue<'de>>,
}

impl<'a, 'de> ObjectEntries<'a, 'de> {
    /// Returns the entries of an object of the text.
    pub(super) fn of(object: SpannedValue<'de>, repairs: &'a Repairs) -> Self {
        let added = repairs.added_to(object).collect();
        Self { written: Some((object.children(), repairs)), added, value: None }
    }

    /// Returns entries with these keys, and stand-ins as their values.
    pub(super) fn stand_ins(keys: &[&'static str]) -> Self {
        Self { written: None, added: keys.iter().rev().copied().collect(), value: None }
    }

    /// Returns the next key of the text that is not dropped.
    pub(super) fn next_kept_key(&mut self) -> Option<SpannedValue<'de>> {
        let (entries, repairs) = self.written.as_mut()?;
        loop {
            let key = entries.next()?;
            self.value = entries.next();
            if !repairs.drops(key) {
                return Some(key);
            }
        }
    }

    /// Returns the name of the next entry.
    fn next_name(&mut self) -> Option<KeyDeserializer<'de>> {
        if let Some(key) = self.next_kept_key() {
            return Some(KeyDeserializer::written(key));
        }
        self.value = None;
        self.added.pop().map(KeyDeserializer::added)
    }
}

impl<'de> MapAccess<'de> for &mut ObjectEntries<'_, 'de> {
    type Error = DeserializeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> DeserializeResult<Option<K::Value>> {
        self.next_name().map(|key| seed.deserialize(key)).transpose()
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> DeserializeResult<V::Value> {
        match (self.value.take(), &self.written) {
            (Some(value), Some((_, repairs))) => deserialize(seed, value, repairs),
            _ => seed.deserialize(StandIn),
        }
    }
}

/// A variant of an enum.
pub(super) enum Variant<'r, 'de> {
    /// A variant without fields, written as a string.
    Plain(SpannedValue<'de>),
    /// A variant with fields. In JSON, it is an object with one key, and this key is the name of
    /// the variant.
    Keyed {
        /// The name.
        key: SpannedValue<'de>,
        /// The fields.
        value: SpannedValue<'de>,
        /// The repairs of the text.
        repairs: &'r Repairs,
    },
    /// The variant with this name, with stand-ins as its fields.
    StandIn(&'static str),
}

impl<'de> EnumAccess<'de> for Variant<'_, 'de> {
    type Error = DeserializeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> DeserializeResult<(V::Value, Self)> {
        let name = match &self {
            Self::Plain(name) => KeyDeserializer::written(*name),
            Self::Keyed { key, .. } => KeyDeserializer::written(*key),
            Self::StandIn(name) => KeyDeserializer::added(name),
        };
        Ok((seed.deserialize(name)?, self))
    }
}

/// Returns the error for a variant that has fields but is written as a string.
fn needs_fields(name: SpannedValue<'_>) -> DeserializeError {
    DeserializeError::mismatch(format!("an object {{{}: …}}", name.written())).at(name)
}

impl<'de> VariantAccess<'de> for Variant<'_, 'de> {
    type Error = DeserializeError;

    fn unit_variant(self) -> DeserializeResult<()> {
        match self {
            Self::Plain(_) | Self::StandIn(_) => Ok(()),
            Self::Keyed { key, value, .. } => {
                Err(DeserializeError::mismatch(format!("just the string {}", key.written())).at(value))
            }
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> DeserializeResult<T::Value> {
        match self {
            Self::Plain(name) => Err(needs_fields(name)),
            Self::Keyed { value, repairs, .. } => deserialize(seed, value, repairs),
            Self::StandIn(_) => seed.deserialize(StandIn),
        }
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> DeserializeResult<V::Value> {
        match self {
            Self::Plain(name) => Err(needs_fields(name)),
            Self::Keyed { value, repairs, .. } if !repairs.replaces(value) => {
                ValueDeserializer { value, repairs }.deserialize_tuple(length, visitor)
            }
            Self::Keyed { .. } | Self::StandIn(_) => StandIn.deserialize_tuple(length, visitor),
        }
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> DeserializeResult<V::Value> {
        match self {
            Self::Plain(name) => Err(needs_fields(name)),
            Self::Keyed { value, repairs, .. } if !repairs.replaces(value) => {
                ValueDeserializer { value, repairs }.visit_fields(fields, visitor)
            }
            Self::Keyed { .. } | Self::StandIn(_) => StandIn.deserialize_struct("", fields, visitor),
        }
    }
}
