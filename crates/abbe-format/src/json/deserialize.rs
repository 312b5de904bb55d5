//! A serde deserialiser for the values of a scanned text, whose errors have a position.
//!
//! The types for entries, elements and variants also represent stand-ins, so that the code of
//! serde's visitors exists only once in the program.

use super::deserialize_error::{DeserializeError, DeserializeErrorKind, ReadResult};
use super::positions::{ChildValues, SpannedValue, ValueKind};
use super::{Names, describe::one_of, key::KeyDeserializer, repair::Repairs};
use serde::de::{DeserializeSeed, Deserializer, EnumAccess, MapAccess, SeqAccess, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;

/// A deserialiser of one value of the text, or a stand-in for a value that could not be read.
///
/// As a stand-in, every number is 1, every text and every list is empty, an optional value is
/// absent, and an enum is its first variant. A type that accepts several kinds of values gets a
/// number; if it accepts none, the error is [`DeserializeErrorKind::NoStandIn`].
#[derive(Debug, Clone, Copy)]
pub(super) enum ValueDeserializer<'r, 'de> {
    Written(WrittenValue<'r, 'de>),
    StandIn,
}

impl<'r, 'de> ValueDeserializer<'r, 'de> {
    pub(super) fn new(value: SpannedValue<'de>, repairs: &'r Repairs) -> Self {
        if repairs.replaces(value) { Self::StandIn } else { Self::Written(WrittenValue { value, repairs }) }
    }
}

impl<'de> Deserializer<'de> for ValueDeserializer<'_, 'de> {
    type Error = DeserializeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written.visit_any(visitor),
            Self::StandIn => visitor.visit_f64(1.0).map_err(|_: DeserializeError| DeserializeError::no_stand_in()),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written.visit_any(visitor),
            Self::StandIn => visitor.visit_bool(false),
        }
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written.visit_whole(visitor),
            Self::StandIn => visitor.visit_u64(1),
        }
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self {
            // Floats above 2⁵³ cannot represent every integer, so the digits of the text are read.
            Self::Written(written) if written.value.written().parse::<u64>().is_ok() => written.visit_any(visitor),
            Self::Written(written) => written.visit_whole(visitor),
            Self::StandIn => visitor.visit_u64(1),
        }
    }

    fn deserialize_i32<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        self.deserialize_u32(visitor)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written.visit_any(visitor),
            Self::StandIn => visitor.visit_str(""),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        let Self::Written(WrittenValue { value, .. }) = self else { return visitor.visit_none() };
        let result = if value.kind() == ValueKind::Null { visitor.visit_none() } else { visitor.visit_some(self) };
        result.map_err(|error| error.at(value))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> ReadResult<V::Value> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written.visit_any(visitor),
            Self::StandIn => visitor.visit_seq(ArrayElements::StandIns(0)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => {
                written.check_length(length)?;
                written.visit_any(visitor)
            }
            Self::StandIn => visitor.visit_seq(ArrayElements::StandIns(length)),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written.visit_fields(&[], true, visitor),
            Self::StandIn => visitor.visit_map(&mut ObjectEntries::stand_ins(&[])),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(self, _: &'static str, keys: Names, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written.visit_fields(keys, keys.contains(&NOTE), visitor),
            Self::StandIn => visitor.visit_map(&mut ObjectEntries::stand_ins(keys)),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(self, _: &'static str, names: Names, visitor: V) -> ReadResult<V::Value> {
        match self {
            Self::Written(written) => written
                .variant(names)
                .and_then(|variant| visitor.visit_enum(variant))
                .map_err(|error| error.at(written.value)),
            Self::StandIn => match names.first() {
                Some(first) => visitor.visit_enum(Variant::StandIn(first)),
                None => Err(DeserializeError::no_stand_in()),
            },
        }
    }

    forward_to_deserialize_any! {
        i8 i16 i64 i128 u8 u16 u128 f32 f64 char bytes byte_buf unit unit_struct tuple_struct identifier ignored_any
    }
}

/// The key of a comment, which every object may have except those whose keys are names.
const NOTE: &str = "note";

/// Returns whether an entry of an object is a comment.
fn is_note(key: SpannedValue, value: SpannedValue) -> bool {
    value.kind() == ValueKind::String && key.content() == NOTE
}

enum WrittenNumber {
    Unsigned(u64),
    Negative(i64),
    Float(f64),
}

#[derive(Debug, Clone, Copy)]
pub(super) struct WrittenValue<'r, 'de> {
    value: SpannedValue<'de>,
    repairs: &'r Repairs,
}

impl<'r, 'de> WrittenValue<'r, 'de> {
    fn visit_any<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        self.visit(visitor).map_err(|error| error.at(self.value))
    }

    fn visit<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self.value.kind() {
            ValueKind::Null => visitor.visit_unit(),
            ValueKind::Bool => visitor.visit_bool(self.value.written() == "true"),
            ValueKind::Number => self.visit_number(visitor),
            ValueKind::String => visitor.visit_str(&self.value.content()),
            ValueKind::Array => {
                let mut elements = self.value.children();
                let value = visitor.visit_seq(ArrayElements::Written(&mut elements, self.repairs))?;
                self.check_end(elements).map(|()| value)
            }
            ValueKind::Object => self.visit_object(false, visitor),
        }
    }

    fn visit_object<V: Visitor<'de>>(self, has_note: bool, visitor: V) -> ReadResult<V::Value> {
        let mut entries = ObjectEntries::of(self.value, self.repairs, has_note);
        let value = visitor.visit_map(&mut entries)?;
        entries.check_end().map(|()| value)
    }

    /// Returns an error if `left` are the elements of this array that a visitor has not read.
    fn check_end(self, left: ChildValues<'de>) -> ReadResult<()> {
        let left = left.count();
        if left == 0 {
            return Ok(());
        }
        let wanted = self.value.children().count() - left;
        Err(DeserializeError::mismatch(format!("an array of {wanted}")))
    }

    fn visit_number<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        match self.number() {
            WrittenNumber::Unsigned(number) => visitor.visit_u64(number),
            WrittenNumber::Negative(number) => visitor.visit_i64(number),
            WrittenNumber::Float(number) => visitor.visit_f64(number),
        }
    }

    /// Returns the number. An integer that fits 64 bits stays an integer.
    fn number(self) -> WrittenNumber {
        let written = self.value.written();
        if let Ok(number) = written.parse() {
            WrittenNumber::Unsigned(number)
        } else if let Ok(number @ ..0) = written.parse() {
            WrittenNumber::Negative(number)
        } else {
            WrittenNumber::Float(self.float())
        }
    }

    /// Returns the number as a float. The scanner has checked the syntax.
    fn float(self) -> f64 {
        self.value.written().parse().unwrap_or(f64::NAN)
    }

    /// Visits a whole number. Forms such as 1e6 or 4.0 are accepted for numbers up to 2⁵³, because
    /// floats above 2⁵³ cannot represent every whole number.
    fn visit_whole<V: Visitor<'de>>(self, visitor: V) -> ReadResult<V::Value> {
        let number = if self.value.kind() == ValueKind::Number { self.float() } else { f64::NAN };
        let exact = number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0;
        let result = match (exact, number >= 0.0) {
            (true, true) => visitor.visit_u64(number as u64),
            (true, false) => visitor.visit_i64(number as i64),
            (false, _) => self.visit(visitor),
        };
        result.map_err(|error| error.at(self.value))
    }

    fn not_an_object(self, fields: &[&str]) -> DeserializeError {
        let expected = match fields {
            [] => "an object".to_string(),
            [key] => format!("an object with the key {key}"),
            keys => format!("an object with the keys {}", one_of(keys).trim_start_matches("one of ")),
        };
        DeserializeError::mismatch(expected).at(self.value)
    }

    /// Visits the entries of an object. `has_note` says that a note is an entry like others.
    fn visit_fields<V: Visitor<'de>>(self, fields: &[&str], has_note: bool, visitor: V) -> ReadResult<V::Value> {
        if self.value.kind() != ValueKind::Object {
            return Err(self.not_an_object(fields));
        }
        self.visit_object(has_note, visitor).map_err(|error| error.at(self.value))
    }

    fn check_length(self, length: usize) -> ReadResult<()> {
        if self.value.kind() == ValueKind::Array && self.value.children().count() == length {
            return Ok(());
        }
        Err(DeserializeError::mismatch(format!("an array of {length}")).at(self.value))
    }

    fn variant(self, variants: Names) -> ReadResult<Variant<'r, 'de>> {
        match self.value.kind() {
            ValueKind::String => Ok(Variant::Plain(self.value)),
            ValueKind::Object => {
                let is_note = |key, value| !variants.contains(&NOTE) && is_note(key, value);
                let mut entries =
                    self.value.entries().filter(|&(key, value)| !self.repairs.drops(key) && !is_note(key, value));
                match (entries.next(), entries.next()) {
                    (Some((key, value)), None) => Ok(Variant::Keyed { key, value, repairs: self.repairs }),
                    (Some(_), Some((second, _))) => {
                        Err(DeserializeError::new(DeserializeErrorKind::SecondKey(variants)).at(second))
                    }
                    (None, _) => Err(DeserializeError::mismatch(one_of(variants))),
                }
            }
            ValueKind::Null | ValueKind::Bool | ValueKind::Number | ValueKind::Array => {
                Err(DeserializeError::mismatch(one_of(variants)))
            }
        }
    }
}

/// Gives the elements of an array to serde: the elements of the text, or stand-ins.
enum ArrayElements<'a, 'de> {
    Written(&'a mut ChildValues<'de>, &'a Repairs),
    /// This number of stand-ins.
    StandIns(usize),
}

impl<'a, 'de> ArrayElements<'a, 'de> {
    fn next(&mut self) -> Option<ValueDeserializer<'a, 'de>> {
        match self {
            Self::Written(elements, repairs) => elements.next().map(|value| ValueDeserializer::new(value, repairs)),
            Self::StandIns(left) => {
                *left = left.checked_sub(1)?;
                Some(ValueDeserializer::StandIn)
            }
        }
    }
}

impl<'de> SeqAccess<'de> for ArrayElements<'_, 'de> {
    type Error = DeserializeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> ReadResult<Option<T::Value>> {
        self.next().map(|value| seed.deserialize(value)).transpose()
    }

    fn size_hint(&self) -> Option<usize> {
        Some(match self {
            Self::Written(elements, _) => elements.left(),
            Self::StandIns(left) => *left,
        })
    }
}

/// Gives the entries of an object to serde: the kept ones of the text, then the added keys.
struct ObjectEntries<'a, 'de> {
    /// The entries of the text. `None` if all values are stand-ins.
    written: Option<(ChildValues<'de>, &'a Repairs)>,
    /// The added keys, beginning with the last one.
    added: Vec<&'static str>,
    /// True if a note is an entry like others, and not a comment.
    has_note: bool,
    /// The value of the key that was read last. `None` stands for the value of an added key.
    value: Option<SpannedValue<'de>>,
}

impl<'a, 'de> ObjectEntries<'a, 'de> {
    fn of(object: SpannedValue<'de>, repairs: &'a Repairs, has_note: bool) -> Self {
        let added = repairs.added_to(object).collect();
        Self { written: Some((object.children(), repairs)), added, has_note, value: None }
    }

    /// Returns entries with these keys, and stand-ins as their values.
    fn stand_ins(keys: &[&'static str]) -> Self {
        Self { written: None, added: keys.iter().rev().copied().collect(), has_note: true, value: None }
    }

    fn next_kept_key(&mut self) -> Option<SpannedValue<'de>> {
        let (entries, repairs) = self.written.as_mut()?;
        loop {
            let key = entries.next()?;
            self.value = entries.next();
            let is_note = !self.has_note && self.value.is_some_and(|value| is_note(key, value));
            if !repairs.drops(key) && !is_note {
                return Some(key);
            }
        }
    }

    /// Refuses further entries. A struct's visitor reads all keys, and an enum's only the first.
    fn check_end(&mut self) -> ReadResult<()> {
        let second = |key| Err(DeserializeError::new(DeserializeErrorKind::SecondKey(&[])).at(key));
        self.next_kept_key().map_or(Ok(()), second)
    }

    fn take_value(&mut self) -> ValueDeserializer<'a, 'de> {
        match (self.value.take(), &self.written) {
            (Some(value), Some((_, repairs))) => ValueDeserializer::new(value, repairs),
            _ => ValueDeserializer::StandIn,
        }
    }

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

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> ReadResult<Option<K::Value>> {
        self.next_name().map(|key| seed.deserialize(key)).transpose()
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> ReadResult<V::Value> {
        seed.deserialize(self.take_value())
    }
}

enum Variant<'r, 'de> {
    /// A variant without fields, written as a string.
    Plain(SpannedValue<'de>),
    /// A variant with fields. In JSON, it is an object whose one key is the name of the variant.
    Keyed { key: SpannedValue<'de>, value: SpannedValue<'de>, repairs: &'r Repairs },
    /// The variant with this name, with stand-ins as its fields.
    StandIn(&'static str),
}

impl<'de> EnumAccess<'de> for Variant<'_, 'de> {
    type Error = DeserializeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> ReadResult<(V::Value, Self)> {
        let name = match &self {
            Self::Plain(name) => KeyDeserializer::written(*name),
            Self::Keyed { key, .. } => KeyDeserializer::written(*key),
            Self::StandIn(name) => KeyDeserializer::added(name),
        };
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'r, 'de> Variant<'r, 'de> {
    fn fields(self) -> ReadResult<ValueDeserializer<'r, 'de>> {
        match self {
            Self::Plain(name) => {
                Err(DeserializeError::mismatch(format!("an object {{{}: …}}", name.written())).at(name))
            }
            Self::Keyed { value, repairs, .. } => Ok(ValueDeserializer::new(value, repairs)),
            Self::StandIn(_) => Ok(ValueDeserializer::StandIn),
        }
    }
}

impl<'de> VariantAccess<'de> for Variant<'_, 'de> {
    type Error = DeserializeError;

    fn unit_variant(self) -> ReadResult<()> {
        match self {
            Self::Plain(_) | Self::StandIn(_) => Ok(()),
            Self::Keyed { key, value, .. } => {
                Err(DeserializeError::mismatch(format!("just the string {}", key.written())).at(value))
            }
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> ReadResult<T::Value> {
        seed.deserialize(self.fields()?)
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> ReadResult<V::Value> {
        self.fields()?.deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: Names, visitor: V) -> ReadResult<V::Value> {
        self.fields()?.deserialize_struct("", fields, visitor)
    }
}
