//! Helpers for SVG documents.

use std::fmt::Write;

/// The colours of curves: black, red, blue, green, violet and brown. A style sheet may replace the
/// colours by means of the classes `s0` to `s5`.
pub(super) const CURVE_COLOURS: [&str; 6] = ["#1b1b1b", "#c0392b", "#2471a3", "#1e8449", "#8e44ad", "#a0690b"];

/// Appends formatted text.
pub(super) fn append(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("writing to a string cannot fail");
}

/// Escapes text for XML.
pub(super) fn escape_xml(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
