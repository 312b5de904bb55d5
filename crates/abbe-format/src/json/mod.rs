//! JSON with positions: reads strict JSON text, applies `PATH=JSON` patches to it, and deserialises
//! it with serde. Every error names its file, line, column and JSON path.
//!
//! `patch` applies the patches, `expand` replaces the shorthands of scenes, `origin` keeps the
//! origin of each part of the text, `scan` checks the syntax and records the `positions` of the
//! values, and `deserialize` hands them to serde.
//! [`JsonSource`] holds the result, and adds the position to errors that are found later.

mod describe;
mod deserialize;
mod deserialize_error;
mod expand;
#[cfg(test)]
mod expand_tests;
mod file_access;
mod key;
mod origin;
mod patch;
mod path;
mod positions;
mod pretty;
mod repair;
mod scan;
mod serialize;
mod source;
#[cfg(test)]
pub(crate) mod tests;
mod text;

pub use file_access::{FileAccess, NamedFile};
pub use patch::PATCH_LABEL;
pub use path::JsonPath;
pub use pretty::{one_line, pretty};
pub use source::{JsonSource, RepairedValue};
pub use text::{MAX_BYTES, read_text};

/// The names of the fields of a struct, or of the variants of an enum.
pub(crate) type Names = &'static [&'static str];
