//! Polar diagrams of the intensity of luminaires as SVG.

use super::axis::Axis;
use super::svg::{CURVE_COLOURS, escape_xml, head};
use abbe_spectra::math::elementary::sin_cos;

#[derive(Debug, Clone, PartialEq)]
pub struct PolarCurve {
    pub name: String,
    /// Pairs of an angle in degrees, from below and positive to the right, and a value.
    pub points: Vec<(f64, f64)>,
}

/// A polar diagram. The angle 0 points down, as for a ceiling luminaire.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarDiagram {
    pub title: String,
    pub unit: String,
    /// The curves. A later curve is drawn on top of an earlier curve.
    pub curves: Vec<PolarCurve>,
}

/// The size of the diagram, its centre and the radius of its largest circle.
const POLAR_SIZE: (f64, f64) = (620.0, 660.0);
const POLAR_CENTRE: (f64, f64) = (310.0, 330.0);
const POLAR_RADIUS: f64 = 240.0;

/// The angle between two spokes in degrees.
const SPOKE_DEG: u16 = 30;

/// The radial labels stand along this angle in degrees, between two spokes.
const LABEL_DEG: f64 = 15.0;

impl PolarDiagram {
    pub fn svg(&self) -> String {
        let values = self.curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
        let radius = Axis::linear(values, true, (0.0, POLAR_RADIUS));
        let mut svg = head("plot polar", POLAR_SIZE, 15.0);
        let title = escape_xml(&self.title);
        svg += &format!("<text x=\"20\" y=\"30\" font-size=\"18\">{title}</text>\n");
        svg += &self.grid(&radius);
        for (number, curve) in self.curves.iter().enumerate() {
            let places: Vec<String> =
                curve.points.iter().map(|&(angle, value)| place(angle, radius.position(value))).collect();
            let colour = colour(number);
            let path = places.join("L");
            svg += &format!(
                "<path d=\"M{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.5\" stroke-linejoin=\"round\"/>\n"
            );
        }
        svg + &self.legend() + "</svg>\n"
    }

    fn grid(&self, radius: &Axis) -> String {
        let mut svg = String::new();
        let (x, y) = POLAR_CENTRE;
        let ticks = radius.ticks();
        for tick in ticks.iter().skip(1) {
            let r = radius.position(tick.value);
            svg +=
                &format!("<circle class=\"rule\" cx=\"{x}\" cy=\"{y}\" r=\"{r:.2}\" fill=\"none\" stroke=\"#ddd\"/>\n");
        }
        for spoke in (0..360).step_by(usize::from(SPOKE_DEG)) {
            let angle = f64::from(spoke);
            let end = place(angle, POLAR_RADIUS);
            svg += &format!("<path class=\"rule\" d=\"M{x} {y}L{end}\" stroke=\"#ddd\"/>\n");
            let shown = if spoke > 180 { 360 - spoke } else { spoke };
            let (sin, cos) = sin_cos(angle.to_radians());
            let (x, y) = (x + (POLAR_RADIUS + 22.0) * sin, y + (POLAR_RADIUS + 22.0) * cos + 5.0);
            svg += &format!("<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"middle\">{shown}°</text>\n");
        }
        // Labels on every second circle leave room for the curves.
        let last = ticks.len().saturating_sub(1);
        for (number, tick) in ticks.iter().enumerate().skip(1) {
            let Some(label) = tick.label.as_ref().filter(|_| (last - number).is_multiple_of(2)) else { continue };
            let (sin, cos) = sin_cos(LABEL_DEG.to_radians());
            let r = radius.position(tick.value);
            let unit = if number == last { format!(" {}", escape_xml(&self.unit)) } else { String::new() };
            let (x, y) = (x + r * sin, y + r * cos + 5.0);
            svg += &format!(
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"13\" text-anchor=\"middle\">{label}{unit}</text>\n"
            );
        }
        svg
    }

    fn legend(&self) -> String {
        let entry = |(number, curve): (usize, &PolarCurve)| {
            let (x, y, name) = (20.0, POLAR_SIZE.1 - 16.0 - 20.0 * number as f64, escape_xml(&curve.name));
            format!("<text x=\"{x}\" y=\"{y}\" fill=\"{}\">{name}</text>\n", colour(number))
        };
        self.curves.iter().enumerate().map(entry).collect()
    }
}

/// Returns red, blue and so on. Black does not show on a dark page.
fn colour(number: usize) -> &'static str {
    CURVE_COLOURS[1 + number % (CURVE_COLOURS.len() - 1)]
}

/// Returns the coordinates at an angle in degrees and a distance from the centre.
fn place(angle_deg: f64, distance: f64) -> String {
    let (sin, cos) = sin_cos(angle_deg.to_radians());
    format!("{:.2} {:.2}", POLAR_CENTRE.0 + distance * sin, POLAR_CENTRE.1 + distance * cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_0_points_down_and_90_to_the_right() {
        let curve = PolarCurve { name: "C0 & C180".into(), points: vec![(0.0, 100.0), (90.0, 50.0), (180.0, 0.0)] };
        let diagram = PolarDiagram { title: "a < b".into(), unit: "cd".into(), curves: vec![curve] };
        let svg = diagram.svg();
        assert!(svg.contains("d=\"M310.00 570.00L430.00 330.00L310.00 330.00\""), "{svg}");
        assert!(svg.contains("a &lt; b") && svg.contains("C0 &amp; C180") && svg.contains("100 cd"), "{svg}");
    }
}
