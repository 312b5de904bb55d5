//! Values that may be written as a number, a name, or an object whose one key selects the variant.
//!
//! The types with several forms derive serde's traits with `remote = "Self"`. The derived functions
//! read and write the object form, and [`deserialize`] adds the plain forms. serde's untagged enums
//! would do the same, but they buffer the value and lose the position of errors.

use crate::json::Names;
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, Error, IntoDeserializer, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use std::fmt;
use std::marker::PhantomData;

/// A type that can be written in plain forms (a number, a string or an array of three numbers), and
/// not only as an object. The functions return `None` for a plain form that the type does not have.
pub(super) trait Forms: Sized {
    /// Description of the allowed forms, for error messages.
    const EXPECTED: &'static str;

    fn from_number(_number: f64) -> Option<Self> {
        None
    }

    fn from_name(_name: String) -> Option<Self> {
        None
    }

    fn from_triple(_triple: [f64; 3]) -> Option<Self> {
        None
    }

    /// True if an array of three numbers is a form of the type.
    const HAS_TRIPLE: bool = false;

    /// Reads an object whose first key is read. `form` deserialises all of it, with this key.
    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> Result<Self, A::Error>;
}

/// Reads a value in any of its forms.
pub(super) fn deserialize<'de, T: Forms, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    deserializer.deserialize_any(FormsVisitor(PhantomData))
}

struct FormsVisitor<T>(PhantomData<T>);

impl<'de, T: Forms> Visitor<'de> for FormsVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
        T::from_number(number).ok_or_else(|| E::invalid_type(Unexpected::Float(number), &self))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<T, E> {
        T::from_name(name.to_string()).ok_or_else(|| E::invalid_type(Unexpected::Str(name), &self))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut array: A) -> Result<T, A::Error> {
        if !T::HAS_TRIPLE {
            return Err(A::Error::invalid_type(Unexpected::Seq, &self));
        }
        let mut triple = [0.0; 3];
        for (i, number) in triple.iter_mut().enumerate() {
            *number = array.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        T::from_triple(triple).ok_or_else(|| A::Error::invalid_type(Unexpected::Seq, &self))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut object: A) -> Result<T, A::Error> {
        let empty = || A::Error::invalid_type(Unexpected::Map, &self);
        let key = object.next_key()?.ok_or_else(empty)?;
        T::from_object(Form { key, rest: object })
    }
}

/// A deserialiser of an object whose first key has been read.
pub(super) struct Form<A> {
    pub(super) key: String,
    /// The rest of the object, which starts with the value of the first key.
    rest: A,
}

impl<'de, A: MapAccess<'de>> Deserializer<'de> for Form<A> {
    type Error = A::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, A::Error> {
        visitor.visit_map(Entries { key: Some(self.key), rest: self.rest })
    }

    fn deserialize_enum<V: Visitor<'de>>(self, _: &'static str, _: Names, visitor: V) -> Result<V::Value, A::Error> {
        visitor.visit_enum(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

/// The entries of a [`Form`] including the first key.
struct Entries<A> {
    key: Option<String>,
    rest: A,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Entries<A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, A::Error> {
        match self.key.take() {
            Some(key) => seed.deserialize(key.into_deserializer()).map(Some),
            None => self.rest.next_key_seed(seed),
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.rest.next_value_seed(seed)
    }
}

impl<'de, A: MapAccess<'de>> EnumAccess<'de> for Form<A> {
    type Error = A::Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), A::Error> {
        let variant = seed.deserialize(self.key.as_str().into_deserializer())?;
        Ok((variant, self))
    }
}

impl<'de, A: MapAccess<'de>> VariantAccess<'de> for Form<A> {
    type Error = A::Error;

    fn unit_variant(mut self) -> Result<(), A::Error> {
        self.rest.next_value()
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(mut self, seed: T) -> Result<T::Value, A::Error> {
        self.rest.next_value_seed(seed)
    }

    fn tuple_variant<V: Visitor<'de>>(mut self, length: usize, visitor: V) -> Result<V::Value, A::Error> {
        self.rest.next_value_seed(Contents { fields: None, length, visitor })
    }

    fn struct_variant<V: Visitor<'de>>(mut self, fields: Names, visitor: V) -> Result<V::Value, A::Error> {
        self.rest.next_value_seed(Contents { fields: Some(fields), length: 0, visitor })
    }
}

/// The contents of a variant: a struct with these fields, or a tuple of this length.
struct Contents<V> {
    fields: Option<&'static [&'static str]>,
    length: usize,
    visitor: V,
}

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Contents<V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        match self.fields {
            Some(fields) => deserializer.deserialize_struct("", fields, self.visitor),
            None => deserializer.deserialize_tuple(self.length, self.visitor),
        }
    }
}

/// Reads the radius of a lens surface. The value null becomes 0, which means a plane.
pub(super) fn deserialize_radius<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(0.0))
}

/// Returns whether a value is the default of its type, which is left out when a scene is written.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
