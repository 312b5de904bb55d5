//! Reports as JSON text.

use serde::Serialize;

/// Returns a report as JSON text.
pub(super) fn json<T: Serialize>(report: &T) -> String {
    serde_json::to_string(report).expect("reports have text keys and no fallible values")
}
