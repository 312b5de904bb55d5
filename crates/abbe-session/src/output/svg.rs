//! Helpers for SVG documents.

/// The colours of curves: black, red, blue, green, violet and brown. A style sheet may replace them
/// by the classes `s0` to `s5`.
pub(super) const CURVE_COLOURS: [&str; 6] = ["#1b1b1b", "#c0392b", "#2471a3", "#1e8449", "#8e44ad", "#a0690b"];

/// Returns the opening tag, with the classes, the size and the font size, and the background.
pub(super) fn head(classes: &str, (width, height): (f64, f64), font_size: f64) -> String {
    format!(
        "<svg class=\"{classes}\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" font-family=\"system-ui, sans-serif\" font-size=\"{font_size}\" \
         fill=\"#222\">\n<rect class=\"paper\" width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
    )
}

/// Returns the path through points of the page, with this number of decimals. It has gaps at points
/// that are not finite.
pub(super) fn path(points: impl Iterator<Item = (f64, f64)>, decimals: usize) -> String {
    let mut path = String::new();
    let mut command = 'M';
    for (x, y) in points {
        if x.is_finite() && y.is_finite() {
            path += &format!("{command}{x:.decimals$} {y:.decimals$}");
            command = 'L';
        } else {
            command = 'M';
        }
    }
    path
}

pub(super) fn escape_xml(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
