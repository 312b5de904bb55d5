//! Strips of colours along an axis, as a picture or as SVG.

use super::axis::Axis;
use super::data_uri::data_uri;
use super::png::encode as encode_png;
use super::svg::{escape_xml, head};
use abbe_spectra::error::Result;
use abbe_transport::sensor::DisplayImage;

/// Colours along a linear axis that begins at 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourStrip {
    pub title: String,
    /// The quantity of the axis, with its unit.
    pub axis: String,
    /// The value at the end of the axis.
    pub end: f64,
    /// The sRGB codes of the colours, from left to right.
    pub codes: Vec<[u8; 3]>,
}

/// The height of the picture in pixels.
const STRIP_HEIGHT: usize = 120;
const STRIP_SIZE: (f64, f64) = (840.0, 220.0);
const STRIP_LEFT: f64 = 40.0;
const STRIP_TOP: f64 = 52.0;

impl ColourStrip {
    /// Returns the strip as a picture with one column per colour.
    pub fn picture(&self) -> DisplayImage {
        let codes: Vec<[u8; 3]> = (0..STRIP_HEIGHT).flat_map(|_| self.codes.iter().copied()).collect();
        DisplayImage::of_srgb(self.codes.len(), STRIP_HEIGHT, codes)
    }

    /// Returns a self-contained SVG document, or a machine error if the PNG encoder fails.
    pub fn svg(&self) -> Result<String> {
        let (right, foot) = (STRIP_SIZE.0 - STRIP_LEFT, STRIP_TOP + STRIP_HEIGHT as f64);
        let across = Axis::linear([0.0, self.end].into_iter(), true, (STRIP_LEFT, right));
        let mut svg = head("plot", STRIP_SIZE, 14.0);
        let title = escape_xml(&self.title);
        svg += &format!("<text x=\"{STRIP_LEFT}\" y=\"30\" font-size=\"18\">{title}</text>\n");
        let row = DisplayImage::of_srgb(self.codes.len(), 1, self.codes.clone());
        let source = data_uri("image/png", &encode_png(&row)?);
        let width = across.position(self.end) - STRIP_LEFT;
        let place = format!("x=\"{STRIP_LEFT}\" y=\"{STRIP_TOP}\" width=\"{width:.2}\" height=\"{STRIP_HEIGHT}\"");
        svg += &format!("<image {place} preserveAspectRatio=\"none\" href=\"{source}\"/>\n");
        for tick in across.ticks().into_iter().filter(|tick| tick.value <= self.end) {
            let (x, y, label) = (across.position(tick.value), foot + 20.0, tick.label.unwrap_or_default());
            svg += &format!("<path class=\"ink\" d=\"M{x:.2} {foot}v5\" stroke=\"#222\"/>\n");
            svg += &format!("<text x=\"{x:.2}\" y=\"{y}\" text-anchor=\"middle\">{label}</text>\n");
        }
        let (x, y, axis) = (0.5 * (STRIP_LEFT + right), foot + 40.0, escape_xml(&self.axis));
        svg += &format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{axis}</text>\n");
        Ok(svg + "</svg>\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_has_a_column_per_colour_and_labels_to_its_end() {
        let codes = vec![[0, 0, 0], [255, 0, 0], [0, 0, 255]];
        let strip = ColourStrip { title: "a < b".into(), axis: "Γ in nm".into(), end: 2500.0, codes };
        let picture = strip.picture();
        assert_eq!((picture.width, picture.height), (3, STRIP_HEIGHT));
        let svg = strip.svg().unwrap();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.contains("a &lt; b"));
        assert!(svg.contains(">0</text>") && svg.contains(">2500</text>") && svg.contains("data:image/png"));
    }
}
