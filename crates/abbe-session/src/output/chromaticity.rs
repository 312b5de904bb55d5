//! The chromaticity diagram as SVG, with the chromaticities of two lights and of primaries.

use super::data_uri::data_uri;
use super::png::encode as encode_png;
use super::svg::head;
use abbe_spectra::colour::gamut::brightest;
use abbe_spectra::colour::{RgbSpace, encode_srgb_u8, from_xy, report, xy, xyz_to_linear_srgb};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::hypot;
use abbe_spectra::spectrum::{Observer, Spectrum};
use abbe_transport::sensor::DisplayImage;

/// Two lights, and optionally the primaries of a match, in the x, y plane of an observer.
#[derive(Debug, Clone)]
pub struct ChromaticityDiagram<'a> {
    pub observer: &'a Observer,
    /// The chromaticities of light A (drawn as a ring) and light B (drawn as a cross).
    pub lights: [[f64; 2]; 2],
    /// The primaries, numbered from 1, with lines around all their mixtures.
    pub primaries: Vec<[f64; 2]>,
}

const DIAGRAM_SIZE: (f64, f64) = (510.0, 530.0);
/// The position of x = y = 0 on the page, and the length of one unit of x or y.
const DIAGRAM_ORIGIN: (f64, f64) = (80.0, 476.0);
const DIAGRAM_UNIT: f64 = 530.0;
/// The ranges of the axes. The left end leaves room for the labels of the spectral locus.
const DIAGRAM_LEFT: f64 = -0.06;
const DIAGRAM_SPAN: (f64, f64) = (0.78, 0.86);
/// The size of the coloured background in pixels. Each pixel covers 0.01 × 0.01 in the x, y plane.
const BACKGROUND_PIXELS: (usize, usize) = (80, 86);
/// The wavelengths (nm) of the spectral locus, which turns back on itself outside.
const LOCUS_NM: (u32, u32) = (390, 700);
/// The Planckian locus has labels at these temperatures in K.
const NAMED_K: [u32; 3] = [3000, 5000, 10_000];

const DIAGRAM_INK: &str = "class=\"ink\" stroke=\"#222\" fill=\"none\"";
const DIAGRAM_RULE: &str = "class=\"rule\" stroke=\"#ddd\" fill=\"none\"";
/// The style of marks on the coloured background, which is the same in light and dark mode.
const DIAGRAM_MARK: &str = "stroke=\"#000\" fill=\"none\"";

/// The style of the labels with the names of the lights. The text has a white outline.
const DIAGRAM_LABEL: &str =
    "fill=\"#000\" stroke=\"#fff\" stroke-width=\"4\" paint-order=\"stroke\" font-weight=\"700\" font-size=\"16\"";

impl ChromaticityDiagram<'_> {
    /// Returns a self-contained SVG document, or a machine error if the PNG encoder fails.
    pub fn svg(&self) -> Result<String> {
        let parts = [
            head("plot", DIAGRAM_SIZE, 13.0),
            axes(),
            self.background()?,
            self.wavelengths(),
            self.black_bodies(),
            lines(&RgbSpace::Srgb.primaries_xy(), true, &format!("{DIAGRAM_MARK} stroke-dasharray=\"2 4\"")),
            text(RgbSpace::Srgb.primaries_xy()[1], (6.0, -2.0), "fill=\"#000\" font-size=\"12\"", "sRGB"),
            self.primaries(),
            self.marks(),
            "</svg>\n".to_string(),
        ];
        Ok(parts.concat())
    }

    fn locus(&self) -> Vec<[f64; 2]> {
        (LOCUS_NM.0..=LOCUS_NM.1).map(|nm| xy(self.observer.xyz_bar(f64::from(nm)))).collect()
    }

    /// Draws each chromaticity within the spectral locus in its brightest sRGB colour.
    fn background(&self) -> Result<String> {
        let (width, height) = BACKGROUND_PIXELS;
        let colour = |i: usize| {
            let (column, row) = ((i % width) as f64, (height - 1 - i / width) as f64);
            let linear = xyz_to_linear_srgb(from_xy([0.01 * (column + 0.5), 0.01 * (row + 0.5)], 1.0));
            brightest(linear).map(encode_srgb_u8)
        };
        let screen = DisplayImage::of_srgb(width, height, (0..width * height).map(colour).collect());
        let ((left, foot), (right, top)) = (position([0.0; 2]), position([0.01 * width as f64, 0.01 * height as f64]));
        let place = format!("x=\"{left}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\"", right - left, foot - top);
        let source = data_uri("image/png", &encode_png(&screen)?);
        let locus = lines(&self.locus(), true, "");
        let inside = format!("<defs><clipPath id=\"colours\">{locus}</clipPath></defs>\n");
        let image =
            format!("<image {place} preserveAspectRatio=\"none\" clip-path=\"url(#colours)\" href=\"{source}\"/>\n");
        Ok(inside + &image + &lines(&self.locus(), true, DIAGRAM_INK))
    }

    /// Draws ticks along the outer side of the spectral locus, and labels them with wavelengths.
    fn wavelengths(&self) -> String {
        let place = |nm: u32| position(xy(self.observer.xyz_bar(f64::from(nm))));
        let tick = |nm: u32| {
            let ((x, y), before, after) = (place(nm), place(nm - 1), place(nm + 1));
            let (along_x, along_y) = (after.0 - before.0, after.1 - before.1);
            let length = hypot(along_x, along_y);
            // Along the locus towards longer wavelengths, the colours are on the right.
            let (out_x, out_y) = (along_y / length, -along_x / length);
            let anchor = if out_x < -0.4 {
                "end"
            } else if out_x > 0.4 {
                "start"
            } else {
                "middle"
            };
            let (from, to) = (format!("M{x:.2} {y:.2}"), format!("l{:.2} {:.2}", 5.0 * out_x, 5.0 * out_y));
            let (label_x, label_y) = (x + 9.0 * out_x, y + 9.0 * out_y + 4.0);
            format!(
                "<path {DIAGRAM_INK} d=\"{from}{to}\"/><text x=\"{label_x:.1}\" y=\"{label_y:.1}\" font-size=\"11\" \
                 text-anchor=\"{anchor}\">{nm}</text>\n"
            )
        };
        [450, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 600, 620, 650].map(tick).concat()
    }

    /// Draws the Planckian locus, and labels some temperatures on it.
    fn black_bodies(&self) -> String {
        let body = |temperature_k: f64| {
            let body = Spectrum::blackbody(temperature_k).expect("a positive temperature");
            xy(report::xyz(&body, self.observer))
        };
        // The points are at equal steps of the reciprocal temperature, because such steps look
        // equal. They go from 25,000 K to 1000 K.
        let line: Vec<[f64; 2]> = (2..=50).map(|step| body(1e6 / (20.0 * f64::from(step)))).collect();
        let named = |kelvin: u32| {
            let place = body(f64::from(kelvin));
            let (x, y) = position(place);
            let dot = format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"2\" fill=\"#000\"/>\n");
            dot + &text(place, (2.0, 15.0), "fill=\"#000\" font-size=\"11\"", &format!("{kelvin} K"))
        };
        lines(&line, false, DIAGRAM_MARK) + &NAMED_K.map(named).concat()
    }

    fn primaries(&self) -> String {
        let mut svg = String::new();
        for (i, one) in self.primaries.iter().enumerate() {
            for other in &self.primaries[..i] {
                svg += &lines(&[*other, *one], false, &format!("{DIAGRAM_MARK} stroke-width=\"1.5\""));
            }
        }
        for (i, &place) in self.primaries.iter().enumerate() {
            let (x, y) = position(place);
            svg += &format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"8\" fill=\"#000\"/>\n");
            svg +=
                &text(place, (0.0, 4.0), "fill=\"#fff\" font-size=\"11\" text-anchor=\"middle\"", &(i + 1).to_string());
        }
        svg
    }

    /// Draws a ring for A and a cross for B, so that both are visible if they coincide.
    fn marks(&self) -> String {
        let (ring, cross) = (position(self.lights[0]), position(self.lights[1]));
        let arms = format!("M{:.2} {:.2}l10 10m0 -10l-10 10", cross.0 - 5.0, cross.1 - 5.0);
        let drawn = |style: &str| {
            format!(
                "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"9\" fill=\"none\" {style}/><path d=\"{arms}\" {style}/>\n",
                ring.0, ring.1
            )
        };
        let label = |place, shift, name| text(place, shift, DIAGRAM_LABEL, name);
        let names = label(self.lights[0], (-22.0, -8.0), "A") + &label(self.lights[1], (11.0, 18.0), "B");
        drawn("stroke=\"#fff\" stroke-width=\"5\"") + &drawn("stroke=\"#000\" stroke-width=\"2\"") + &names
    }
}

fn position([x, y]: [f64; 2]) -> (f64, f64) {
    (DIAGRAM_ORIGIN.0 + DIAGRAM_UNIT * x, DIAGRAM_ORIGIN.1 - DIAGRAM_UNIT * y)
}

fn lines(points: &[[f64; 2]], closed: bool, style: &str) -> String {
    let path: Vec<String> =
        points.iter().map(|&point| position(point)).map(|(x, y)| format!("{x:.2} {y:.2}")).collect();
    format!("<path d=\"M{}{}\" {style}/>\n", path.join("L"), if closed { "Z" } else { "" })
}

fn text(place: [f64; 2], shift: (f64, f64), style: &str, words: &str) -> String {
    let (x, y) = position(place);
    format!("<text x=\"{:.2}\" y=\"{:.2}\" {style}>{words}</text>\n", x + shift.0, y + shift.1)
}

fn axes() -> String {
    let mut svg = String::new();
    for tick in 0..=8 {
        let value = 0.1 * f64::from(tick);
        svg += &lines(&[[DIAGRAM_LEFT, value], [DIAGRAM_SPAN.0, value]], false, DIAGRAM_RULE);
        svg += &text([DIAGRAM_LEFT, value], (-8.0, 4.0), "text-anchor=\"end\"", &format!("{value:.1}"));
        if value <= DIAGRAM_SPAN.0 {
            svg += &lines(&[[value, 0.0], [value, DIAGRAM_SPAN.1]], false, DIAGRAM_RULE);
            svg += &text([value, 0.0], (0.0, 18.0), "text-anchor=\"middle\"", &format!("{value:.1}"));
        }
    }
    svg += &lines(&[[DIAGRAM_LEFT, DIAGRAM_SPAN.1], [DIAGRAM_LEFT, 0.0], [DIAGRAM_SPAN.0, 0.0]], false, DIAGRAM_INK);
    svg += &text([0.4, 0.0], (0.0, 38.0), "text-anchor=\"middle\"", "x");
    svg + &text([DIAGRAM_LEFT, 0.4], (-40.0, 4.0), "text-anchor=\"middle\"", "y")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_drawn_at_their_chromaticities() {
        let primaries = vec![[0.7, 0.3], [0.2, 0.7], [0.15, 0.05]];
        let diagram =
            ChromaticityDiagram { observer: Observer::cie1931(), lights: [[0.5, 0.4], [0.3, 0.3]], primaries };
        let svg = diagram.svg().unwrap();
        let (x, y) = position([0.5, 0.4]);
        assert!(svg.contains(&format!("cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"9\"")), "{svg}");
        assert_eq!((svg.matches("r=\"8\"").count(), svg.matches("stroke-width=\"1.5\"").count()), (3, 3));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}
