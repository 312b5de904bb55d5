//! The colour vector graphic of TM-30 as SVG.

use super::svg::head;
use abbe_spectra::colour::gamut::desaturate;
use abbe_spectra::colour::{ColourRendition, RgbSpace, from_lab, srgb_hex, xyz_to_linear_srgb};
use abbe_spectra::math::elementary::{hypot, sin_cos};
use std::f64::consts::TAU;

/// The size of the graphic, its centre and the radius of the reference circle.
const GRAPHIC_SIZE: f64 = 460.0;
const GRAPHIC_CENTRE: f64 = 0.5 * GRAPHIC_SIZE;
const REFERENCE_RADIUS: f64 = 145.0;

/// Rings at these radii show chroma shifts of ±20 %. The radius of the reference is 1.
const RINGS: [f64; 2] = [0.8, 1.2];
/// The lines between the hue bins end at this radius, and the numbers of the bins stand there.
const EDGE: f64 = 1.45;

/// Returns the colour vector graphic as a self-contained SVG document. Arrows lead from the circle
/// of the reference to the polygon of the mean colours of the hue bins under the light.
pub fn colour_vector_graphic(rendition: &ColourRendition) -> String {
    let mut svg = head("plot", (GRAPHIC_SIZE, GRAPHIC_SIZE), 13.0);
    let circle = |radius: f64, style: &str| {
        let r = radius * REFERENCE_RADIUS;
        format!("<circle cx=\"{GRAPHIC_CENTRE}\" cy=\"{GRAPHIC_CENTRE}\" r=\"{r}\" fill=\"none\" {style}/>\n")
    };
    for radius in RINGS {
        svg += &circle(radius, "class=\"rule\" stroke=\"#ddd\"");
    }
    let angle = TAU / rendition.arrows.len() as f64;
    for bin in 0..rendition.arrows.len() {
        let at = |bins: f64, radius: f64| {
            let (sin, cos) = sin_cos(bins * angle);
            place([radius * cos, radius * sin])
        };
        let (border, (x, y)) = (at(bin as f64, EDGE), at(bin as f64 + 0.5, EDGE));
        svg += &format!(
            "<path class=\"rule\" stroke=\"#ddd\" d=\"M{GRAPHIC_CENTRE} {GRAPHIC_CENTRE}L{:.2} {:.2}\"/>\
                 <text x=\"{x:.2}\" y=\"{:.2}\" text-anchor=\"middle\">{}</text>\n",
            border.0,
            border.1,
            y + 4.0,
            bin + 1
        );
    }
    svg += &circle(1.0, "class=\"ink\" stroke=\"#222\" stroke-width=\"1.5\"");
    let tips: Vec<String> = rendition.arrows.iter().map(|arrow| point(place(arrow[1]))).collect();
    svg += &format!("<path fill=\"none\" stroke=\"#c0392b\" stroke-width=\"2.5\" d=\"M{}Z\"/>\n", tips.join("L"));
    for arrow in &rendition.arrows {
        svg += &arrow_path(arrow);
    }
    svg + "</svg>\n"
}

/// Draws an arrow in a colour of its hue.
fn arrow_path(arrow: &[[f64; 2]; 2]) -> String {
    /// The length and half the width of the largest head, in pixels.
    const HEAD: (f64, f64) = (9.0, 4.0);
    let [[a, b], _] = *arrow;
    let lab = [60.0, 45.0 * a, 45.0 * b];
    let rgb = desaturate(xyz_to_linear_srgb(from_lab(lab, RgbSpace::Srgb.white())), RgbSpace::Srgb);
    let colour = srgb_hex(rgb);
    let [from, to] = arrow.map(place);
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = hypot(dx, dy);
    if length < 0.5 {
        return String::new();
    }
    let (along_x, along_y) = (dx / length, dy / length);
    // The head of a short arrow is smaller, so that the arrow keeps its length.
    let size = (length / HEAD.0).min(1.0);
    let (back, half) = (HEAD.0 * size, HEAD.1 * size);
    let neck = (to.0 - back * along_x, to.1 - back * along_y);
    let corner = |side: f64| point((neck.0 - side * half * along_y, neck.1 + side * half * along_x));
    format!(
        "<path fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"2.5\" d=\"M{}L{}\"/>\
         <path fill=\"{colour}\" d=\"M{}L{}L{}Z\"/>\n",
        point(from),
        point(neck),
        point(to),
        corner(1.0),
        corner(-1.0)
    )
}

fn place([a, b]: [f64; 2]) -> (f64, f64) {
    (GRAPHIC_CENTRE + REFERENCE_RADIUS * a, GRAPHIC_CENTRE - REFERENCE_RADIUS * b)
}

fn point((x, y): (f64, f64)) -> String {
    format!("{x:.2} {y:.2}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::colour::rendition;
    use abbe_spectra::spectrum::library;

    #[test]
    fn the_polygon_joins_the_tips_of_the_arrows() {
        let light = library::find("FL12").unwrap().spectrum;
        let found = rendition(&light).unwrap();
        let svg = colour_vector_graphic(&found);
        for arrow in &found.arrows {
            let (from, to) = (point(place(arrow[0])), point(place(arrow[1])));
            assert!(svg.contains(&format!("d=\"M{from}L")) && svg.matches(to.as_str()).count() >= 2, "{svg}");
        }
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
}
