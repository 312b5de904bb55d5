//! Writes short descriptions of JSON values, and lists of allowed names, for error messages.

use super::positions::{SpannedValue, ValueKind};

/// A longer list of allowed names is shortened to this many names; it never leaves out only one.
const MAX_LISTED_NAMES: usize = 12;
const MAX_QUOTED_CHARACTERS: usize = 40;

/// Lists the allowed names: `one of a, b, c`. A long list is shortened.
pub(super) fn one_of(names: &[&str]) -> String {
    match names {
        [only] => (*only).to_string(),
        _ if names.len() <= MAX_LISTED_NAMES + 1 => format!("one of {}", names.join(", ")),
        _ => {
            let (listed, others) = names.split_at(MAX_LISTED_NAMES);
            format!("one of {} and {} others", listed.join(", "), others.len())
        }
    }
}

/// Describes a value: a plain one by its text, an array by its length, an object by its emptiness.
pub(super) fn found(value: SpannedValue) -> String {
    match value.kind() {
        ValueKind::Null | ValueKind::Bool | ValueKind::Number | ValueKind::String => shorten(value.written()),
        ValueKind::Object if value.children().next().is_none() => "an empty object".into(),
        ValueKind::Object => "an object".into(),
        ValueKind::Array => match value.children().count() {
            0 => "an empty array".into(),
            count => format!("an array of {count}"),
        },
    }
}

/// Cuts a text after its first 40 characters.
pub(super) fn shorten(text: &str) -> String {
    let end = text.char_indices().nth(MAX_QUOTED_CHARACTERS);
    end.map_or_else(|| text.to_string(), |(end, _)| format!("{}…", &text[..end]))
}
