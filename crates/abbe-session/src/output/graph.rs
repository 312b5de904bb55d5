//! Plots with two logarithmic axes as SVG.

use super::axis::Axis;
use super::svg::{CURVE_COLOURS, escape_xml, head};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeriesStyle {
    /// A line through the points, and a dot at each point.
    Line,
    Dashed,
    Dots,
    /// A step function, such as the best value so far, which holds until the next point.
    Steps,
    Rings,
}

/// A series of points. Points with a coordinate of 0 or below are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotSeries {
    /// The name in the legend. A series with an empty name is not in the legend.
    pub name: String,
    pub style: SeriesStyle,
    pub colour: usize,
    pub points: Vec<(f64, f64)>,
}

/// A plot whose axes are both logarithmic.
#[derive(Debug, Clone, PartialEq)]
pub struct LogLogPlot {
    pub title: String,
    pub across: String,
    /// The quantity and unit of the vertical axis.
    pub up: String,
    /// The series. A later series is drawn on top of an earlier series.
    pub series: Vec<PlotSeries>,
}

/// The size of the plot. The page is small, so that the text stays readable on a phone.
const GRAPH_SIZE: (f64, f64) = (580.0, 440.0);
const GRAPH_LEFT: f64 = 92.0;
const GRAPH_RIGHT: f64 = 18.0;
const GRAPH_TOP: f64 = 46.0;
const GRAPH_BOTTOM: f64 = 62.0;
const GRAPH_FONT: f64 = 16.0;

impl LogLogPlot {
    /// Returns the plot as a self-contained SVG document.
    pub fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|series| &series.points).filter(|(x, y)| *x > 0.0 && *y > 0.0);
        let (width, height) = GRAPH_SIZE;
        let across = Axis::logarithmic(points().map(|point| point.0), (GRAPH_LEFT, width - GRAPH_RIGHT));
        let up = Axis::logarithmic(points().map(|point| point.1), (height - GRAPH_BOTTOM, GRAPH_TOP));
        let mut svg = head("plot graph", (width, height), GRAPH_FONT);
        let title = escape_xml(&self.title);
        svg += &format!("<text x=\"{GRAPH_LEFT}\" y=\"28\" font-size=\"18\">{title}</text>\n");
        svg += &self.axes(&across, &up);
        for series in &self.series {
            svg += &series.drawn(&across, &up);
        }
        svg + &self.legend() + "</svg>\n"
    }

    fn axes(&self, across: &Axis, up: &Axis) -> String {
        let mut svg = String::new();
        let (right, foot) = (GRAPH_SIZE.0 - GRAPH_RIGHT, GRAPH_SIZE.1 - GRAPH_BOTTOM);
        for tick in up.ticks() {
            let y = up.position(tick.value);
            svg += &format!("<path class=\"rule\" d=\"M{GRAPH_LEFT} {y:.2}H{right}\" stroke=\"#ddd\"/>\n");
            if let Some(label) = tick.label {
                let (x, y) = (GRAPH_LEFT - 8.0, y + 5.5);
                svg += &format!("<text x=\"{x}\" y=\"{y:.2}\" text-anchor=\"end\">{label}</text>\n");
            }
        }
        for tick in across.ticks() {
            let x = across.position(tick.value);
            svg += &format!("<path class=\"rule\" d=\"M{x:.2} {GRAPH_TOP}V{foot}\" stroke=\"#ddd\"/>\n");
            if let Some(label) = tick.label {
                let y = foot + 21.0;
                svg += &format!("<text x=\"{x:.2}\" y=\"{y}\" text-anchor=\"middle\">{label}</text>\n");
            }
        }
        svg += &format!(
            "<path class=\"ink\" d=\"M{GRAPH_LEFT} {GRAPH_TOP}V{foot}H{right}\" fill=\"none\" stroke=\"#222\"/>\n"
        );
        let (x, y, name) = (0.5 * (GRAPH_LEFT + right), GRAPH_SIZE.1 - 14.0, escape_xml(&self.across));
        svg += &format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{name}</text>\n");
        let (y, name) = (0.5 * (GRAPH_TOP + foot), escape_xml(&self.up));
        let turned = format!("transform=\"rotate(-90 17 {y})\"");
        svg += &format!("<text x=\"17\" y=\"{y}\" text-anchor=\"middle\" {turned}>{name}</text>\n");
        svg
    }

    /// Draws the names in the upper right corner. Falling curves leave this corner free.
    fn legend(&self) -> String {
        let entry = |(i, series): (usize, &PlotSeries)| {
            let (class, colour) = series.colour();
            let (x, y) = (GRAPH_SIZE.0 - GRAPH_RIGHT - 10.0, GRAPH_TOP + 20.0 + 20.0 * i as f64);
            let name = escape_xml(&series.name);
            format!("<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>\n")
        };
        self.series.iter().filter(|series| !series.name.is_empty()).enumerate().map(entry).collect()
    }
}

impl PlotSeries {
    fn colour(&self) -> (String, &'static str) {
        let colour = self.colour % CURVE_COLOURS.len();
        (format!("s{colour}"), CURVE_COLOURS[colour])
    }

    fn drawn(&self, across: &Axis, up: &Axis) -> String {
        let seen = self.points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite());
        let places: Vec<(f64, f64)> = seen.map(|(x, y)| (across.position(*x), up.position(*y))).collect();
        let (class, colour) = self.colour();
        let mut svg = String::new();
        let style = match self.style {
            SeriesStyle::Line | SeriesStyle::Steps => Some("stroke-width=\"2\""),
            SeriesStyle::Dashed => Some("stroke-width=\"1.5\" stroke-dasharray=\"7 5\""),
            SeriesStyle::Dots | SeriesStyle::Rings => None,
        };
        if let Some(style) = style {
            let path = path(&places, self.style == SeriesStyle::Steps);
            let style = format!("fill=\"none\" stroke-linejoin=\"round\" {style}");
            svg += &format!("<path class=\"{class}\" d=\"{path}\" {style} stroke=\"{colour}\"/>\n");
        }
        let (radius, style) = match self.style {
            SeriesStyle::Line => (3.5, format!("fill=\"{colour}\"")),
            SeriesStyle::Dots => (2.5, format!("fill=\"{colour}\"")),
            SeriesStyle::Rings => (8.0, format!("fill=\"none\" stroke-width=\"2.5\" stroke=\"{colour}\"")),
            SeriesStyle::Dashed | SeriesStyle::Steps => return svg,
        };
        let kind = if self.style == SeriesStyle::Rings { " ring" } else { "" };
        for (x, y) in places {
            svg += &format!("<circle class=\"{class}{kind}\" cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" {style}/>\n");
        }
        svg
    }
}

fn path(places: &[(f64, f64)], level: bool) -> String {
    let mut path = String::new();
    for (i, (x, y)) in places.iter().enumerate() {
        match (i, level) {
            (0, _) => path += &format!("M{x:.2} {y:.2}"),
            (_, true) => path += &format!("H{x:.2}V{y:.2}"),
            (_, false) => path += &format!("L{x:.2} {y:.2}"),
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(style: SeriesStyle, points: Vec<(f64, f64)>) -> PlotSeries {
        PlotSeries { name: "a <b>".to_string(), style, colour: 1, points }
    }

    #[test]
    fn points_without_a_logarithm_are_left_out() {
        let points = vec![(1.0, 1.0), (10.0, 0.1), (0.0, 5.0), (20.0, -1.0), (100.0, 0.01)];
        let graph = LogLogPlot {
            title: "t & u".to_string(),
            across: "s".to_string(),
            up: "e".to_string(),
            series: vec![
                series(SeriesStyle::Line, points),
                series(SeriesStyle::Steps, vec![]),
                series(SeriesStyle::Rings, vec![(3.0, 0.1)]),
            ],
        };
        let svg = graph.svg();
        assert_eq!(svg.matches("<circle").count(), 4);
        assert!(
            svg.contains("a &lt;b&gt;") && svg.contains("t &amp; u") && !svg.contains("NaN") && !svg.contains("inf")
        );
    }
}
