//! Plots of one quantity against another, both on logarithmic axes, as SVG.

use super::plot::{append, escaped};

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// A line through its points, each of them a dot.
    Line,
    /// A dashed line without dots.
    Dashed,
    /// Small dots alone.
    Dots,
    /// A line that goes on level until it falls: the best so far.
    Steps,
    /// Rings around its points.
    Rings,
}

/// Points that belong together; those that are not above 0 have no place on the axes and are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it shows, for the legend; without a name it is not named there.
    pub name: String,
    /// How it is drawn.
    pub look: Look,
    /// Which of the colours it has.
    pub colour: usize,
    /// Its points: what goes to the right, what goes up.
    pub points: Vec<(f64, f64)>,
}

/// A plot whose axes are both logarithmic.
#[derive(Debug, Clone, PartialEq)]
pub struct Graph {
    /// The title.
    pub title: String,
    /// Quantity and unit of the axis to the right.
    pub across: String,
    /// Quantity and unit of the axis that goes up.
    pub up: String,
    /// What is drawn, the last on top.
    pub series: Vec<Series>,
}

/// Small enough for its letters to be read on a phone.
const SIZE: (f64, f64) = (580.0, 440.0);
const LEFT: f64 = 92.0;
const RIGHT: f64 = 18.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 62.0;
const FONT: f64 = 16.0;
/// Ink, red, blue, green, violet, brown; a page may give the classes `s0` … `s5` others.
const COLOURS: [&str; 6] = ["#1b1b1b", "#c0392b", "#2471a3", "#1e8449", "#8e44ad", "#a0690b"];

/// One logarithmic axis: the powers of ten of its ends, and where on the page they lie.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// The axis that holds these values with a little room; one decade at least.
    fn around(values: impl Iterator<Item = f64>, (from, to): (f64, f64)) -> Self {
        let powers = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
        let (least, most) = powers.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let (least, most) = if least <= most { (least, most) } else { (0.0, 0.0) };
        let room = (0.04 * (most - least)).max(0.5 * (1.0 - (most - least))).max(0.02);
        Self { low: least - room, high: most + room, from, to }
    }

    fn place(&self, value: f64) -> f64 {
        self.from + (value.log10() - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Values with a rule, and whether they have a number too: powers of ten, and 2 and 5 times these where there are few.
    fn ticks(&self) -> Vec<(f64, bool)> {
        let few = self.high - self.low < 2.5;
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let all = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| (digit, digit * 10.0_f64.powi(decade))));
        let inside = |value: f64| (self.low..=self.high).contains(&value.log10());
        all.filter(|(_, value)| inside(*value)).map(|(digit, value)| (value, few || digit == 1.0)).collect()
    }
}

/// A number on an axis: as it is, or as a power of ten where that would be long.
fn label(value: f64) -> String {
    if (0.0099..=99_999.0).contains(&value) {
        return format!("{}", (value * 1e6).round() / 1e6);
    }
    let exponent = (value.log10() + 1e-9).floor();
    let digit = (value / 10.0_f64.powf(exponent)).round();
    let power = power_of_ten(exponent as i32);
    if digit == 1.0 { power } else { format!("{digit}·{power}") }
}

/// A power of ten as it is printed, such as 10⁻⁴.
pub fn power_of_ten(exponent: i32) -> String {
    let small = |c: char| match c {
        '-' => '⁻',
        _ => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c.to_digit(10).unwrap_or(0) as usize],
    };
    format!("10{}", exponent.to_string().chars().map(small).collect::<String>())
}

impl Graph {
    /// The plot as a file that needs no other.
    pub fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|series| &series.points).filter(|(x, y)| *x > 0.0 && *y > 0.0);
        let (width, height) = SIZE;
        let across = Axis::around(points().map(|point| point.0), (LEFT, width - RIGHT));
        let up = Axis::around(points().map(|point| point.1), (height - BOTTOM, TOP));
        let mut svg = format!(
            "<svg class=\"plot graph\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"system-ui, sans-serif\" font-size=\"{FONT}\" fill=\"#222\">\n\
             <rect class=\"paper\" width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <text x=\"{LEFT}\" y=\"28\" font-size=\"18\">{}</text>\n",
            escaped(&self.title)
        );
        svg += &self.axes(&across, &up);
        for series in &self.series {
            svg += &series.drawn(&across, &up);
        }
        svg += &self.legend();
        svg += "</svg>\n";
        svg
    }

    fn axes(&self, across: &Axis, up: &Axis) -> String {
        let mut svg = String::new();
        let (right, foot) = (SIZE.0 - RIGHT, SIZE.1 - BOTTOM);
        for (value, numbered) in up.ticks() {
            let y = up.place(value);
            append(&mut svg, format_args!("<path class=\"rule\" d=\"M{LEFT} {y:.2}H{right}\" stroke=\"#ddd\"/>\n"));
            if numbered {
                let (x, y, label) = (LEFT - 8.0, y + 5.5, label(value));
                append(&mut svg, format_args!("<text x=\"{x}\" y=\"{y:.2}\" text-anchor=\"end\">{label}</text>\n"));
            }
        }
        for (value, numbered) in across.ticks() {
            let x = across.place(value);
            append(&mut svg, format_args!("<path class=\"rule\" d=\"M{x:.2} {TOP}V{foot}\" stroke=\"#ddd\"/>\n"));
            if numbered {
                let (y, label) = (foot + 21.0, label(value));
                append(&mut svg, format_args!("<text x=\"{x:.2}\" y=\"{y}\" text-anchor=\"middle\">{label}</text>\n"));
            }
        }
        append(
            &mut svg,
            format_args!("<path class=\"ink\" d=\"M{LEFT} {TOP}V{foot}H{right}\" fill=\"none\" stroke=\"#222\"/>\n"),
        );
        let (x, y, name) = (0.5 * (LEFT + right), SIZE.1 - 14.0, escaped(&self.across));
        append(&mut svg, format_args!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{name}</text>\n"));
        let (y, name) = (0.5 * (TOP + foot), escaped(&self.up));
        let turned = format!("transform=\"rotate(-90 17 {y})\"");
        append(&mut svg, format_args!("<text x=\"17\" y=\"{y}\" text-anchor=\"middle\" {turned}>{name}</text>\n"));
        svg
    }

    /// The names, in the upper right, which curves that fall leave free.
    fn legend(&self) -> String {
        let mut svg = String::new();
        for (i, series) in self.series.iter().filter(|series| !series.name.is_empty()).enumerate() {
            let (class, colour) = series.colour();
            let (x, y) = (SIZE.0 - RIGHT - 10.0, TOP + 20.0 + 20.0 * i as f64);
            let name = escaped(&series.name);
            append(
                &mut svg,
                format_args!(
                    "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>\n"
                ),
            );
        }
        svg
    }
}

impl Series {
    fn colour(&self) -> (String, &'static str) {
        let colour = self.colour % COLOURS.len();
        (format!("s{colour}"), COLOURS[colour])
    }

    fn drawn(&self, across: &Axis, up: &Axis) -> String {
        let seen = self.points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite());
        let places: Vec<(f64, f64)> = seen.map(|(x, y)| (across.place(*x), up.place(*y))).collect();
        let (class, colour) = self.colour();
        let mut svg = String::new();
        let style = match self.look {
            Look::Line | Look::Steps => Some("stroke-width=\"2\""),
            Look::Dashed => Some("stroke-width=\"1.5\" stroke-dasharray=\"7 5\""),
            Look::Dots | Look::Rings => None,
        };
        if let Some(style) = style {
            let path = path(&places, self.look == Look::Steps);
            let style = format!("fill=\"none\" stroke-linejoin=\"round\" {style}");
            append(&mut svg, format_args!("<path class=\"{class}\" d=\"{path}\" {style} stroke=\"{colour}\"/>\n"));
        }
        let (radius, style) = match self.look {
            Look::Line => (3.5, format!("fill=\"{colour}\"")),
            Look::Dots => (2.5, format!("fill=\"{colour}\"")),
            Look::Rings => (8.0, format!("fill=\"none\" stroke-width=\"2.5\" stroke=\"{colour}\"")),
            Look::Dashed | Look::Steps => return svg,
        };
        let kind = if self.look == Look::Rings { " ring" } else { "" };
        for (x, y) in places {
            append(
                &mut svg,
                format_args!("<circle class=\"{class}{kind}\" cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" {style}/>\n"),
            );
        }
        svg
    }
}

fn path(places: &[(f64, f64)], level: bool) -> String {
    let mut path = String::new();
    for (i, (x, y)) in places.iter().enumerate() {
        match (i, level) {
            (0, _) => append(&mut path, format_args!("M{x:.2} {y:.2}")),
            (_, true) => append(&mut path, format_args!("H{x:.2}V{y:.2}")),
            (_, false) => append(&mut path, format_args!("L{x:.2} {y:.2}")),
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(look: Look, points: Vec<(f64, f64)>) -> Series {
        Series { name: "a <b>".to_string(), look, colour: 1, points }
    }

    #[test]
    fn a_power_law_is_a_straight_line_and_what_has_no_logarithm_is_left_out() {
        let points = vec![(1.0, 1.0), (10.0, 0.1), (0.0, 5.0), (20.0, -1.0), (100.0, 0.01)];
        let graph = Graph {
            title: "t & u".to_string(),
            across: "s".to_string(),
            up: "e".to_string(),
            series: vec![
                series(Look::Line, points),
                series(Look::Steps, vec![]),
                series(Look::Rings, vec![(3.0, 0.1)]),
            ],
        };
        let svg = graph.svg();
        assert_eq!(svg.matches("<circle").count(), 4);
        assert!(
            svg.contains("a &lt;b&gt;") && svg.contains("t &amp; u") && !svg.contains("NaN") && !svg.contains("inf")
        );
        let across = Axis::around([1.0, 100.0].into_iter(), (0.0, 100.0));
        let [a, b, c] = [1.0, 10.0, 100.0].map(|value| across.place(value));
        assert!((b - a - (c - b)).abs() < 1e-9 && a > 0.0 && c < 100.0);
    }

    #[test]
    fn axes_are_numbered_briefly() {
        let labels = [0.01, 1.0, 50.0, 2e-3, 1e-4, 1e7].map(label);
        assert_eq!(labels, ["0.01", "1", "50", "2·10⁻³", "10⁻⁴", "10⁷"]);
        let ticks = Axis::around([0.9, 12.0].into_iter(), (0.0, 1.0)).ticks();
        let numbered: Vec<f64> = ticks.iter().filter(|tick| tick.1).map(|tick| tick.0).collect();
        assert_eq!(numbered, [1.0, 2.0, 5.0, 10.0]);
        let nothing = Axis::around([].into_iter(), (0.0, 1.0));
        assert!(nothing.low < nothing.high && nothing.ticks().len() >= 2);
    }
}
