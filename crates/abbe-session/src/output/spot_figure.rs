//! Spot diagrams as SVG: a row per field, a column per colour, and one for all colours.

use glam::DVec2;

use super::svg::{escape_xml, head};

/// The points of one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotPoints {
    /// The colour in SVG notation.
    pub colour: String,
    /// Points (x, y) in mm from the centre of the cell.
    pub points_mm: Vec<DVec2>,
}

/// A cell of the figure.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotCell {
    pub caption: String,
    pub spots: Vec<SpotPoints>,
}

/// The spot diagrams of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotRow {
    /// The lines of text in front of the row.
    pub labels: Vec<String>,
    pub cells: Vec<SpotCell>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct SpotFigure {
    pub title: String,
    /// The names of the columns.
    pub columns: Vec<String>,
    pub rows: Vec<SpotRow>,
    /// Radius in mm of a circle around the centre of each cell: the Airy disk.
    pub circle_mm: f64,
}

const SPOT_FONT: f64 = 14.0;
const SPOT_MARGIN: f64 = 12.0;
const SPOT_LEFT: f64 = 104.0;
const SPOT_TITLE: f64 = 26.0;
const SPOT_TOP: f64 = 50.0;
const SPOT_CAPTION: f64 = 34.0;
/// The width of all cells together.
const SPOT_CELLS: f64 = 960.0;
const SPOT_GAP: f64 = 14.0;
const LARGEST_CELL: f64 = 240.0;

impl SpotFigure {
    /// Returns the half width in mm of all cells: a round number that contains all points.
    fn half_mm(&self) -> f64 {
        let cells = self.rows.iter().flat_map(|row| &row.cells);
        let points = cells.flat_map(|cell| &cell.spots).flat_map(|spot| &spot.points_mm);
        let most = points.map(|point| point.abs().max_element()).fold(self.circle_mm, f64::max);
        let mut sizes = (-7..4).flat_map(|decade| [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|it| it * 10.0_f64.powi(decade)));
        sizes.find(|size| *size >= 1.04 * most).unwrap_or(1.04 * most)
    }

    /// Returns the figure as a self-contained SVG document.
    pub fn svg(&self) -> String {
        let count = self.columns.len().max(1) as f64;
        let cell = ((SPOT_CELLS - SPOT_GAP * (count - 1.0)) / count).min(LARGEST_CELL);
        // A figure of few columns has room on its right, so that all figures have the same scale.
        let width = 2.0 * SPOT_MARGIN + SPOT_LEFT + SPOT_CELLS;
        let row_height = cell + SPOT_CAPTION;
        let title_height = if self.title.is_empty() { 0.0 } else { SPOT_TITLE };
        let head_height = title_height + SPOT_TOP;
        let height = head_height + self.rows.len() as f64 * row_height + SPOT_MARGIN;
        let half_mm = self.half_mm();
        let mut svg = head("plot spots", (width, height), SPOT_FONT);
        if !self.title.is_empty() {
            let title = escape_xml(&self.title);
            svg += &format!("<text x=\"{SPOT_MARGIN}\" y=\"22\" font-size=\"16\">{title}</text>\n");
        }
        let (side, airy) = (micrometres(2.0 * half_mm), micrometres(self.circle_mm));
        let scale = format!("All squares are {side} wide. The circle is the Airy disk, with a radius of {airy}.");
        svg += &format!("<text x=\"{SPOT_MARGIN}\" y=\"{:.1}\" fill=\"#555\">{scale}</text>\n", title_height + 17.0);
        let x_of = |column: usize| SPOT_MARGIN + SPOT_LEFT + column as f64 * (cell + SPOT_GAP);
        for (i, name) in self.columns.iter().enumerate() {
            let (x, y, name) = (x_of(i) + 0.5 * cell, head_height - 9.0, escape_xml(name));
            svg += &format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{name}</text>\n");
        }
        for (i, row) in self.rows.iter().enumerate() {
            let top = head_height + i as f64 * row_height;
            for (line, label) in row.labels.iter().enumerate() {
                let (y, label) = (top + 0.5 * cell + 19.0 * line as f64 - 22.0, escape_xml(label));
                svg += &format!("<text x=\"{SPOT_MARGIN}\" y=\"{y:.1}\">{label}</text>\n");
            }
            for (column, drawn) in row.cells.iter().enumerate() {
                svg += &drawn.svg((x_of(column), top), cell, half_mm, self.circle_mm);
            }
        }
        svg + "</svg>\n"
    }
}

impl SpotCell {
    fn svg(&self, (x, y): (f64, f64), size: f64, half_mm: f64, circle_mm: f64) -> String {
        let (middle_x, middle_y, per_mm) = (x + 0.5 * size, y + 0.5 * size, 0.5 * size / half_mm);
        let (right, foot, radius) = (x + size, y + size, circle_mm * per_mm);
        let mut svg = format!(
            "<path class=\"rule\" d=\"M{x:.1} {middle_y:.1}H{right:.1}M{middle_x:.1} {y:.1}V{foot:.1}\" stroke=\"#ddd\"/>\n"
        );
        for SpotPoints { colour, points_mm } in &self.spots {
            let mut path = String::new();
            for point in points_mm {
                path += &format!("M{:.1} {:.1}h0", middle_x + point.x * per_mm, middle_y - point.y * per_mm);
            }
            let style = "stroke-width=\"2.6\" stroke-linecap=\"round\"";
            svg += &format!("<path class=\"spot\" d=\"{path}\" {style} stroke=\"{colour}\"/>\n");
        }
        let circle = format!("cx=\"{middle_x:.1}\" cy=\"{middle_y:.1}\" r=\"{radius:.2}\"");
        svg += &format!("<circle {circle} fill=\"none\" stroke=\"#222\"/>\n");
        let frame = format!("x=\"{x:.1}\" y=\"{y:.1}\" width=\"{size:.1}\" height=\"{size:.1}\"");
        svg += &format!("<rect {frame} fill=\"none\" stroke=\"#999\"/>\n");
        let (foot, caption) = (foot + 18.0, escape_xml(&self.caption));
        svg + &format!("<text x=\"{middle_x:.1}\" y=\"{foot:.1}\" text-anchor=\"middle\">{caption}</text>\n")
    }
}

/// Formats a length for people, in µm or from 1 mm on in mm.
fn micrometres(mm: f64) -> String {
    let rounded = |value: f64| format!("{:.*}", if value < 9.95 { 2 } else { usize::from(value < 99.5) }, value);
    let short = |text: String| text.trim_end_matches('0').trim_end_matches('.').to_string();
    if mm < 0.9995 {
        let text = rounded(1e3 * mm);
        format!("{} µm", if text.contains('.') { short(text) } else { text })
    } else {
        format!("{} mm", short(format!("{mm:.2}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_has_all_points_inside_its_squares() {
        let cell = |points_mm: Vec<DVec2>| SpotCell {
            caption: "RMS < 1".to_string(),
            spots: vec![SpotPoints { colour: "#123456".to_string(), points_mm }],
        };
        let figure = SpotFigure {
            title: "spots & more".to_string(),
            columns: vec!["d".to_string(), "all".to_string()],
            rows: vec![SpotRow {
                labels: vec!["14°".to_string()],
                cells: vec![cell(vec![DVec2::new(0.0, 0.12)]), cell(vec![DVec2::new(-0.02, 0.0), DVec2::ZERO])],
            }],
            circle_mm: 0.0014,
        };
        assert!((figure.half_mm() - 0.15).abs() < 1e-12);
        let svg = figure.svg();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
        assert!(svg.contains("spots &amp; more") && svg.contains("RMS &lt; 1"), "{svg}");
        assert!(svg.contains("300 µm wide") && svg.contains("radius of 1.4 µm"), "{svg}");
        assert_eq!(svg.matches("h0").count(), 3);
    }

    #[test]
    fn lengths_have_three_figures_and_a_fitting_unit() {
        let texts = [0.0014, 0.3, 0.0305, 0.07, 1.0, 2.5].map(micrometres);
        assert_eq!(texts, ["1.4 µm", "300 µm", "30.5 µm", "70 µm", "1 mm", "2.5 mm"]);
    }
}
