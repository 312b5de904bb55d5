//! Plots with linear axes side by side in one SVG document, with a common legend.

use super::axis::Axis;
use super::svg::{escape_xml, head, path};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineDash {
    Solid,
    Dashed,
    Dotted,
}

/// A line through points. It has gaps at points that are not finite.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotLine {
    /// The colour in SVG notation.
    pub colour: String,
    pub dash: LineDash,
    /// Pairs of the horizontal and the vertical value.
    pub points: Vec<(f64, f64)>,
}

/// The range of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlotRange {
    /// From the first to the second value, which is larger.
    Between(f64, f64),
    /// All values, and 0.
    WithZero,
    /// From the negative to the positive largest absolute value.
    Symmetric,
}

/// A plot of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct GridPlot {
    pub title: String,
    /// The quantity and unit of the horizontal axis.
    pub across: String,
    /// The quantity and unit of the vertical axis.
    pub up: String,
    pub across_range: PlotRange,
    pub up_range: PlotRange,
    /// Values of the horizontal axis that a thin vertical line marks, with a label at its head.
    pub marks: Vec<(f64, String)>,
    /// The lines. A later line is drawn on top of an earlier one.
    pub lines: Vec<PlotLine>,
}

/// An entry of the legend: a name, and the colour and the dash of its lines.
#[derive(Debug, Clone, PartialEq)]
pub struct LegendEntry {
    pub name: String,
    pub colour: String,
    pub dash: LineDash,
}

/// Plots in rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotGrid {
    pub title: String,
    pub legend: Vec<LegendEntry>,
    pub columns: usize,
    /// The width and the height of one plot with its labels.
    pub cell: (f64, f64),
    /// The plots, row by row.
    pub plots: Vec<GridPlot>,
}

const GRID_FONT: f64 = 14.0;
const GRID_MARGIN: f64 = 12.0;
const TITLE_LINE: f64 = 30.0;
const LEGEND_LINE: f64 = 22.0;
const SAMPLE: f64 = 26.0;
const CELL_LEFT: f64 = 70.0;
const CELL_RIGHT: f64 = 16.0;
const CELL_TOP: f64 = 28.0;
const CELL_BOTTOM: f64 = 46.0;
/// The smallest distance between the labels of ticks across and up, in units of the font size.
const TICK_PITCH: (f64, f64) = (5.0, 2.0);

impl PlotGrid {
    /// Puts the plots of several grids into one row, with the entries of all legends.
    pub fn beside(title: String, grids: Vec<Self>) -> Self {
        let (mut legend, mut plots, mut cell) = (Vec::new(), Vec::new(), (0.0, 0.0));
        for grid in grids {
            for entry in grid.legend {
                if !legend.contains(&entry) {
                    legend.push(entry);
                }
            }
            plots.extend(grid.plots);
            cell = grid.cell;
        }
        Self { title, legend, columns: plots.len(), cell, plots }
    }

    /// Returns the plots as a self-contained SVG document.
    pub fn svg(&self) -> String {
        let width = 2.0 * GRID_MARGIN + self.columns as f64 * self.cell.0;
        let title_height = if self.title.is_empty() { 0.0 } else { TITLE_LINE };
        let (legend, legend_height) = self.legend(width, title_height);
        let top = title_height + legend_height;
        let rows = self.plots.len().div_ceil(self.columns.max(1));
        let height = top + rows as f64 * self.cell.1 + GRID_MARGIN;
        let classes = if self.plots.len() == 1 { "plot single" } else { "plot grid" };
        let mut svg = head(classes, (width, height), GRID_FONT);
        if !self.title.is_empty() {
            let title = escape_xml(&self.title);
            svg += &format!("<text x=\"{GRID_MARGIN}\" y=\"22\" font-size=\"16\">{title}</text>\n");
        }
        svg += &legend;
        for (i, plot) in self.plots.iter().enumerate() {
            let (column, row) = (i % self.columns, i / self.columns);
            let corner = (GRID_MARGIN + column as f64 * self.cell.0, top + row as f64 * self.cell.1);
            svg += &plot.drawn(corner, self.cell, i);
        }
        svg + "</svg>\n"
    }

    /// Returns the legend in as many lines as it needs, and their height.
    fn legend(&self, width: f64, top: f64) -> (String, f64) {
        let (mut svg, mut x, mut line) = (String::new(), GRID_MARGIN, 0);
        for LegendEntry { name, colour, dash } in &self.legend {
            // Most letters are narrower than 0.56 of the font size.
            let entry = SAMPLE + 8.0 + 0.56 * GRID_FONT * name.chars().count() as f64 + 18.0;
            if x > GRID_MARGIN && x + entry > width {
                (x, line) = (GRID_MARGIN, line + 1);
            }
            let y = top + LEGEND_LINE * (f64::from(line) + 0.5);
            let style = stroke(*dash);
            svg += &format!("<path d=\"M{x:.1} {y:.1}h{SAMPLE}\" stroke=\"{colour}\" {style}/>\n");
            let (text_x, text_y, name) = (x + SAMPLE + 8.0, y + 4.8, escape_xml(name));
            svg += &format!("<text x=\"{text_x:.1}\" y=\"{text_y:.1}\">{name}</text>\n");
            x += entry;
        }
        let lines = if self.legend.is_empty() { 0.0 } else { f64::from(line + 1) };
        (svg, lines * LEGEND_LINE)
    }
}

fn stroke(dash: LineDash) -> &'static str {
    match dash {
        LineDash::Solid => "stroke-width=\"1.8\"",
        LineDash::Dashed => "stroke-width=\"1.8\" stroke-dasharray=\"6 4\"",
        LineDash::Dotted => "stroke-width=\"1.8\" stroke-dasharray=\"1.5 3.5\"",
    }
}

fn axis(range: PlotRange, values: impl Iterator<Item = f64>, page: (f64, f64), pitch: f64) -> Axis {
    let intervals = ((page.1 - page.0).abs() / pitch).max(1.0);
    match range {
        PlotRange::Between(from, to) => Axis::between((from, to), intervals, page),
        PlotRange::WithZero => Axis::linear_with(values, true, intervals, page),
        PlotRange::Symmetric => {
            let most = values.filter(|value| value.is_finite()).map(f64::abs).fold(0.0, f64::max);
            Axis::linear_with([-most, most].into_iter(), true, intervals, page)
        }
    }
}

impl GridPlot {
    fn drawn(&self, corner: (f64, f64), cell: (f64, f64), number: usize) -> String {
        let (left, right) = (corner.0 + CELL_LEFT, corner.0 + cell.0 - CELL_RIGHT);
        let (top, foot) = (corner.1 + CELL_TOP, corner.1 + cell.1 - CELL_BOTTOM);
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let marks = self.marks.iter().map(|mark| mark.0);
        let across_values = points().map(|point| point.0).chain(marks);
        let across = axis(self.across_range, across_values, (left, right), TICK_PITCH.0 * GRID_FONT);
        let up = axis(self.up_range, points().map(|point| point.1), (foot, top), TICK_PITCH.1 * GRID_FONT);
        let mut svg = self.axes((&across, &up), (left, right), (top, foot));
        let (width, height) = (right - left, foot - top);
        let frame = format!("x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"");
        // The titles of a page differ, but the numbers of the plots do not.
        let clip = format!("plot{}-{number}", clip_name(&format!("{}{}{}", self.title, self.across, self.up)));
        svg += &format!("<clipPath id=\"{clip}\"><rect {frame}/></clipPath>\n<g clip-path=\"url(#{clip})\">\n");
        for line in &self.lines {
            let points = line.points.iter().map(|&(x, y)| (across.position(x), up.position(y)));
            let (path, colour, style) = (path(points, 1), &line.colour, stroke(line.dash));
            svg += &format!(
                "<path class=\"curve\" d=\"{path}\" fill=\"none\" stroke-linejoin=\"round\" stroke=\"{colour}\" {style}/>\n"
            );
        }
        svg + "</g>\n"
    }

    fn axes(&self, (across, up): (&Axis, &Axis), (left, right): (f64, f64), (top, foot): (f64, f64)) -> String {
        let mut svg = String::new();
        for (value, label) in ticks(up, self.up_range) {
            let y = up.position(value);
            svg += &format!("<path class=\"rule\" d=\"M{left:.1} {y:.1}H{right:.1}\" stroke=\"#ddd\"/>\n");
            let (x, y) = (left - 7.0, y + 4.8);
            svg += &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{}</text>\n", signed(&label));
        }
        for (value, label) in ticks(across, self.across_range) {
            let x = across.position(value);
            svg += &format!("<path class=\"rule\" d=\"M{x:.1} {top:.1}V{foot:.1}\" stroke=\"#ddd\"/>\n");
            let y = foot + 18.0;
            svg += &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>\n", signed(&label));
        }
        let zero_inside = |axis: &Axis, ends: (f64, f64)| {
            let place = axis.position(0.0);
            (place > ends.0 + 0.5 && place < ends.1 - 0.5).then_some(place)
        };
        if let Some(x) = zero_inside(across, (left, right)) {
            svg += &format!("<path d=\"M{x:.1} {top:.1}V{foot:.1}\" stroke=\"#999\"/>\n");
        }
        if let Some(y) = zero_inside(up, (top, foot)) {
            svg += &format!("<path d=\"M{left:.1} {y:.1}H{right:.1}\" stroke=\"#999\"/>\n");
        }
        // Labels of neighbours are at different heights, so that they do not overlap.
        let heights = if self.marks.len() > 3 { 3 } else { 1 };
        for (i, (value, label)) in self.marks.iter().enumerate() {
            let y = top + 28.0 + 15.0 * (i % heights) as f64;
            let (x, label) = (across.position(*value), escape_xml(label));
            svg += &format!("<path d=\"M{x:.1} {top:.1}V{foot:.1}\" stroke=\"#777\" stroke-dasharray=\"2 3\"/>\n");
            let (x, anchor) = if x > 0.5 * (left + right) { (x - 4.0, "end") } else { (x + 4.0, "start") };
            // The white rim keeps the label legible on lines.
            let style = format!(
                "text-anchor=\"{anchor}\" font-size=\"12\" fill=\"#555\" stroke=\"#fff\" stroke-width=\"3\" \
                 paint-order=\"stroke\""
            );
            svg += &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" {style}>{label}</text>\n");
        }
        svg += &format!(
            "<path class=\"ink\" d=\"M{left:.1} {top:.1}V{foot:.1}H{right:.1}\" fill=\"none\" stroke=\"#222\"/>\n"
        );
        let (middle, title, name) = (0.5 * (left + right), escape_xml(&self.title), escape_xml(&self.across));
        let (head, below) = (top - 9.0, foot + 37.0);
        svg += &format!("<text x=\"{middle:.1}\" y=\"{head:.1}\" text-anchor=\"middle\">{title}</text>\n");
        svg += &format!("<text x=\"{middle:.1}\" y=\"{below:.1}\" text-anchor=\"middle\">{name}</text>\n");
        let (x, y, name) = (left - CELL_LEFT + 13.0, 0.5 * (top + foot), escape_xml(&self.up));
        let turned = format!("transform=\"rotate(-90 {x:.1} {y:.1})\"");
        svg + &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" {turned}>{name}</text>\n")
    }
}

/// Returns the ticks with their labels, and the end of an axis between given values if its label is
/// short and stands apart from that of the last tick.
fn ticks(axis: &Axis, range: PlotRange) -> Vec<(f64, String)> {
    const SHORT: usize = 4;
    let labelled = axis.ticks().into_iter().map(|tick| (tick.value, tick.label.unwrap_or_default()));
    let mut ticks: Vec<(f64, String)> = labelled.collect();
    if let (PlotRange::Between(_, end), [.., before, last]) = (range, ticks.as_slice()) {
        let (label, steps) = (end.to_string(), (end - last.0) / (last.0 - before.0));
        if label.len() <= SHORT && steps > 0.6 {
            ticks.push((end, label));
        }
    }
    ticks
}

/// Returns a label with the minus sign of typography.
fn signed(label: &str) -> String {
    label.replace('-', "−")
}

/// Returns a short name for an identifier of SVG, which must be unique on a page.
fn clip_name(text: &str) -> String {
    let hash = text
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(up_range: PlotRange) -> GridPlot {
        let line = |dash, points| PlotLine { colour: "#123456".to_string(), dash, points };
        GridPlot {
            title: "a < b".to_string(),
            across: "mm".to_string(),
            up: "%".to_string(),
            across_range: PlotRange::Between(0.0, 14.0),
            up_range,
            marks: vec![(7.0, "best".to_string())],
            lines: vec![
                line(LineDash::Solid, vec![(0.0, 1.0), (7.0, f64::NAN), (14.0, 3.0)]),
                line(LineDash::Dashed, vec![(0.0, -1.0), (14.0, -2.0)]),
            ],
        }
    }

    #[test]
    fn a_grid_is_complete_and_its_text_escaped() {
        let entry = LegendEntry { name: "T & S".to_string(), colour: "#123456".to_string(), dash: LineDash::Dotted };
        let grid = PlotGrid {
            title: "<lens>".to_string(),
            legend: vec![entry; 9],
            columns: 2,
            cell: (300.0, 220.0),
            plots: vec![plot(PlotRange::Symmetric), plot(PlotRange::WithZero), plot(PlotRange::Between(0.0, 1.0))],
        };
        let svg = grid.svg();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(svg.contains("&lt;lens&gt;") && svg.contains("a &lt; b") && svg.contains("T &amp; S"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(svg.matches("class=\"curve\"").count(), 6);
        // The legend of nine entries needs two lines; two rows of plots follow.
        let height = TITLE_LINE + 2.0 * LEGEND_LINE + 2.0 * 220.0 + GRID_MARGIN;
        assert!(svg.contains(&format!("viewBox=\"0 0 624 {height}\"")), "{}", &svg[..200]);
        let row = PlotGrid::beside("row".to_string(), vec![grid.clone(), grid]);
        assert_eq!((row.legend.len(), row.columns, row.plots.len()), (1, 6, 6));
    }

    #[test]
    fn the_end_of_an_axis_is_labelled_if_there_is_room() {
        let last = |end: f64| {
            let range = PlotRange::Between(0.0, end);
            ticks(&axis(range, [].into_iter(), (0.0, 400.0), 100.0), range).pop().unwrap().1
        };
        assert_eq!([14.0, 11.0, 8.125, 20.0].map(last), ["14", "10", "5", "20"]);
    }

    #[test]
    fn a_symmetric_axis_has_its_zero_in_the_middle() {
        let middle = axis(PlotRange::Symmetric, [1.0, 3.0, f64::NAN].into_iter(), (0.0, 100.0), 20.0);
        assert_eq!(middle.position(0.0), 50.0);
        let points = [(0.0, 0.0), (1.0, f64::NAN), (2.0, 0.0), (3.0, 0.0)];
        let on_page = points.into_iter().map(|(x, y)| (middle.position(x), middle.position(y)));
        assert_eq!(path(on_page, 1).matches('M').count(), 2, "a gap");
    }
}
