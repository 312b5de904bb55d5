//! Stand-ins: values of any type, for the values of a text that could not be read. Every number is
//! 1, every text is empty, and every list is empty. An optional value is absent.

use serde::de::Visitor;

use super::access::Variant;
use super::deserialize::DeserializeResult;
use super::deserialize_error::{DeserializeError, DeserializeErrorKind};

/// Visits the stand-in of a type that accepts several kinds of values: a number.
///
/// # Errors
/// Returns an error of the kind [`DeserializeErrorKind::NoStandIn`] if the type accepts no numbers.
pub(super) fn number<'de, V: Visitor<'de>>(visitor: V) -> DeserializeResult<V::Value> {
    visitor.visit_f64::<DeserializeError>(1.0).map_err(|_| DeserializeError::new(DeserializeErrorKind::NoStandIn))
}

/// Visits the stand-in of an enum: the first variant.
///
/// # Errors
/// Returns an error of the kind [`DeserializeErrorKind::NoStandIn`] if the enum has no variants.
pub(super) fn variant<'de, V: Visitor<'de>>(
    variants: &'static [&'static str],
    visitor: V,
) -> DeserializeResult<V::Value> {
    match variants.first() {
        Some(first) => visitor.visit_enum(Variant::StandIn(first)),
        None => Err(DeserializeError::new(DeserializeErrorKind::NoStandIn)),
    }
}
