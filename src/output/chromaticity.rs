//! The chromaticity diagram as SVG: the colours that there are, and where some lights stand among them.

use super::data_uri::data_uri;
use super::png::encode as encode_png;
use crate::colour::gamut::brightest;
use crate::colour::{RgbSpace, encode_srgb_u8, from_xy, report, xy, xyz_to_linear_srgb};
use crate::error::Result;
use crate::sensor::Screen;
use crate::spectrum::{Observer, Spectrum};

/// Two lights, and the primaries of a match, in the x, y plane of an observer.
#[derive(Debug, Clone)]
pub struct Diagram<'a> {
    /// Whose plane it is.
    pub observer: &'a Observer,
    /// Where A (a ring) and B (a cross) stand.
    pub lights: [[f64; 2]; 2],
    /// Where the primaries stand, numbered from 1; lines between them enclose what they can mix.
    pub primaries: Vec<[f64; 2]>,
}

const SIZE: (f64, f64) = (510.0, 530.0);
/// Where x = y = 0 stands, and how long 1 is.
const ORIGIN: (f64, f64) = (80.0, 476.0);
const UNIT: f64 = 530.0;
/// What the axes span; the left one stands off, so that the locus has room for its wavelengths.
const LEFT: f64 = -0.06;
const SPAN: (f64, f64) = (0.78, 0.86);
/// Pixels of the coloured ground, each 0.01 wide and high.
const GROUND: (usize, usize) = (80, 86);
/// The spectral locus is drawn between these wavelengths, in nm; beyond them it turns back on itself.
const LOCUS_NM: (u32, u32) = (390, 700);
/// Temperatures that are written on the line of black bodies, in K.
const NAMED_K: [u32; 3] = [3000, 5000, 10_000];

const INK: &str = "class=\"ink\" stroke=\"#222\" fill=\"none\"";
const RULE: &str = "class=\"rule\" stroke=\"#ddd\" fill=\"none\"";
/// Marks on the coloured ground, which is the same in light and dark.
const MARK: &str = "stroke=\"#000\" fill=\"none\"";

/// The names of the lights, with a margin that sets them off.
const LABEL: &str =
    "fill=\"#000\" stroke=\"#fff\" stroke-width=\"4\" paint-order=\"stroke\" font-weight=\"700\" font-size=\"16\"";

impl Diagram<'_> {
    /// The diagram, which needs no other file.
    ///
    /// # Errors
    /// The machine's: a picture that PNG cannot hold.
    pub fn svg(&self) -> Result<String> {
        let (width, height) = SIZE;
        let size = format!("viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\"");
        let font = "font-family=\"system-ui, sans-serif\" font-size=\"13\" fill=\"#222\"";
        let parts = [
            format!("<svg class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" {size} {font}>\n"),
            format!("<rect class=\"paper\" width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"),
            axes(),
            self.ground()?,
            self.wavelengths(),
            self.black_bodies(),
            lines(&RgbSpace::Srgb.primaries_xy(), true, &format!("{MARK} stroke-dasharray=\"2 4\"")),
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

    /// Each chromaticity's colour as far as sRGB holds it, within the spectral locus.
    fn ground(&self) -> Result<String> {
        let (width, height) = GROUND;
        let colour = |i: usize| {
            let (column, row) = ((i % width) as f64, (height - 1 - i / width) as f64);
            let linear = xyz_to_linear_srgb(from_xy([0.01 * (column + 0.5), 0.01 * (row + 0.5)], 1.0));
            brightest(linear).map(encode_srgb_u8)
        };
        let screen = Screen::of_srgb(width, height, (0..width * height).map(colour).collect());
        let ((left, foot), (right, top)) = (at([0.0; 2]), at([0.01 * width as f64, 0.01 * height as f64]));
        let place = format!("x=\"{left}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\"", right - left, foot - top);
        let source = data_uri("image/png", &encode_png(&screen)?);
        let locus = lines(&self.locus(), true, "");
        let inside = format!("<defs><clipPath id=\"colours\">{locus}</clipPath></defs>\n");
        let image =
            format!("<image {place} preserveAspectRatio=\"none\" clip-path=\"url(#colours)\" href=\"{source}\"/>\n");
        Ok(inside + &image + &lines(&self.locus(), true, INK))
    }

    /// Ticks on the spectral locus, outwards.
    fn wavelengths(&self) -> String {
        let place = |nm: u32| at(xy(self.observer.xyz_bar(f64::from(nm))));
        let tick = |nm: u32| {
            let ((x, y), before, after) = (place(nm), place(nm - 1), place(nm + 1));
            let (along_x, along_y) = (after.0 - before.0, after.1 - before.1);
            let length = along_x.hypot(along_y);
            // The locus is walked with the colours to its right.
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
                "<path {INK} d=\"{from}{to}\"/><text x=\"{label_x:.1}\" y=\"{label_y:.1}\" font-size=\"11\" \
                 text-anchor=\"{anchor}\">{nm}</text>\n"
            )
        };
        [450, 470, 480, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 600, 620, 650].map(tick).concat()
    }

    /// The line of black bodies with some temperatures.
    fn black_bodies(&self) -> String {
        let body = |temperature_k: f64| {
            let body = Spectrum::blackbody(temperature_k).expect("a positive temperature");
            xy(report::xyz(&body, self.observer))
        };
        // Even steps of the reciprocal temperature, from 1000 K to 25,000 K, are even steps to the eye.
        let line: Vec<[f64; 2]> = (2..=50).map(|step| body(1e6 / (20.0 * f64::from(step)))).collect();
        let named = |kelvin: u32| {
            let place = body(f64::from(kelvin));
            let (x, y) = at(place);
            let dot = format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"2\" fill=\"#000\"/>\n");
            dot + &text(place, (2.0, 15.0), "fill=\"#000\" font-size=\"11\"", &format!("{kelvin} K"))
        };
        lines(&line, false, MARK) + &NAMED_K.map(named).concat()
    }

    fn primaries(&self) -> String {
        let mut svg = String::new();
        for (i, one) in self.primaries.iter().enumerate() {
            for other in &self.primaries[..i] {
                svg += &lines(&[*other, *one], false, &format!("{MARK} stroke-width=\"1.5\""));
            }
        }
        for (i, &place) in self.primaries.iter().enumerate() {
            let (x, y) = at(place);
            svg += &format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"8\" fill=\"#000\"/>\n");
            svg +=
                &text(place, (0.0, 4.0), "fill=\"#fff\" font-size=\"11\" text-anchor=\"middle\"", &(i + 1).to_string());
        }
        svg
    }

    /// A ring for A and a cross for B, so that both are seen where they coincide.
    fn marks(&self) -> String {
        let (ring, cross) = (at(self.lights[0]), at(self.lights[1]));
        let arms = format!("M{:.2} {:.2}l10 10m0 -10l-10 10", cross.0 - 5.0, cross.1 - 5.0);
        let drawn = |style: &str| {
            format!(
                "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"9\" fill=\"none\" {style}/><path d=\"{arms}\" {style}/>\n",
                ring.0, ring.1
            )
        };
        let label = |place, shift, name| text(place, shift, LABEL, name);
        let names = label(self.lights[0], (-22.0, -8.0), "A") + &label(self.lights[1], (11.0, 18.0), "B");
        drawn("stroke=\"#fff\" stroke-width=\"5\"") + &drawn("stroke=\"#000\" stroke-width=\"2\"") + &names
    }
}

/// Where a chromaticity stands.
fn at([x, y]: [f64; 2]) -> (f64, f64) {
    (ORIGIN.0 + UNIT * x, ORIGIN.1 - UNIT * y)
}

fn lines(points: &[[f64; 2]], closed: bool, style: &str) -> String {
    let path: Vec<String> = points.iter().map(|&point| at(point)).map(|(x, y)| format!("{x:.2} {y:.2}")).collect();
    format!("<path d=\"M{}{}\" {style}/>\n", path.join("L"), if closed { "Z" } else { "" })
}

/// Text beside a chromaticity.
fn text(place: [f64; 2], shift: (f64, f64), style: &str, words: &str) -> String {
    let (x, y) = at(place);
    format!("<text x=\"{:.2}\" y=\"{:.2}\" {style}>{words}</text>\n", x + shift.0, y + shift.1)
}

fn axes() -> String {
    let mut svg = String::new();
    for tick in 0..=8 {
        let value = 0.1 * f64::from(tick);
        svg += &lines(&[[LEFT, value], [SPAN.0, value]], false, RULE);
        svg += &text([LEFT, value], (-8.0, 4.0), "text-anchor=\"end\"", &format!("{value:.1}"));
        if value <= SPAN.0 {
            svg += &lines(&[[value, 0.0], [value, SPAN.1]], false, RULE);
            svg += &text([value, 0.0], (0.0, 18.0), "text-anchor=\"middle\"", &format!("{value:.1}"));
        }
    }
    svg += &lines(&[[LEFT, SPAN.1], [LEFT, 0.0], [SPAN.0, 0.0]], false, INK);
    svg += &text([0.4, 0.0], (0.0, 38.0), "text-anchor=\"middle\"", "x");
    svg + &text([LEFT, 0.4], (-40.0, 4.0), "text-anchor=\"middle\"", "y")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lights_stand_where_their_chromaticities_are() {
        let primaries = vec![[0.7, 0.3], [0.2, 0.7], [0.15, 0.05]];
        let diagram = Diagram { observer: Observer::cie1931(), lights: [[0.5, 0.4], [0.3, 0.3]], primaries };
        let svg = diagram.svg().unwrap();
        let (x, y) = at([0.5, 0.4]);
        assert!(svg.contains(&format!("cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"9\"")), "{svg}");
        assert_eq!((svg.matches("r=\"8\"").count(), svg.matches("stroke-width=\"1.5\"").count()), (3, 3));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}
