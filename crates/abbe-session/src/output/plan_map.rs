//! The plan of a grid of readings as SVG: a cell in false colours for each reading, and isolines.

use glam::{DVec2, DVec3};

use super::axis::Axis;
use super::heat::heat;
use super::svg::{escape_xml, head};

#[derive(Debug, Clone)]
pub struct PlanMap {
    /// The edges u and v of the parallelogram in the scene's unit, and the normal of the meter,
    /// from whose side the plan is seen, with u to the right.
    pub frame: [DVec3; 3],
    pub count: [usize; 2],
    /// One value for each cell. The index along u changes fastest.
    pub values: Vec<f64>,
    pub unit: &'static str,
    pub number: fn(f64) -> String,
}

/// The width of the drawing of a plan, and its largest height.
const SIZE: [f64; 2] = [900.0, 640.0];

const MARGIN: f64 = 34.0;

/// The values are written into the cells if the cells are at least this wide and high.
const LEAST_CELL_WITH_NUMBER: [f64; 2] = [54.0, 20.0];

impl PlanMap {
    pub fn svg(&self) -> String {
        let (corners, scale) = self.layout();
        let [origin, along_u, along_v] = corners;
        let [columns, rows] = self.count.map(|count| count as f64);
        let at = |column: f64, row: f64| origin + along_u * (column / columns) + along_v * (row / rows);
        let outline = [at(0.0, 0.0), at(columns, 0.0), at(columns, rows), at(0.0, rows)];
        let height = outline.iter().fold(0.0, |most: f64, corner| most.max(corner.y)) + MARGIN;
        let mut svg = head("map", (SIZE[0], height), 12.0).replace("fill=\"#fff\"", "fill=\"none\"");
        let cell = [along_u.length() / columns, along_v.length() / rows];
        let with_numbers = cell[0] >= LEAST_CELL_WITH_NUMBER[0] && cell[1] >= LEAST_CELL_WITH_NUMBER[1];
        let most = self.most();
        for (i, &value) in self.values.iter().enumerate() {
            let (column, row) = ((i % self.count[0]) as f64, (i / self.count[0]) as f64);
            let corners = [at(column, row), at(column + 1.0, row), at(column + 1.0, row + 1.0), at(column, row + 1.0)];
            let [r, g, b] = heat(value / most);
            // A stroke of the same colour hides the gaps between cells.
            svg += &format!(
                "<polygon points=\"{}\" fill=\"rgb({r} {g} {b})\" stroke=\"rgb({r} {g} {b})\" stroke-width=\"0.5\"/>\n",
                points(&corners)
            );
        }
        let mut labels = Vec::new();
        for level in self.levels() {
            let lines = self.isoline(level);
            let Some(place) = self.label_place(&lines) else { continue };
            let mut path = String::new();
            for [a, b] in &lines {
                let [a, b] = [a, b].map(|point| at(point.x + 0.5, point.y + 0.5));
                path += &format!("M{:.1} {:.1}L{:.1} {:.1}", a.x, a.y, b.x, b.y);
            }
            for (colour, width) in [("#000", 2.6), ("#fff", 1.2)] {
                svg += &format!(
                    "<path class=\"isoline\" d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>\n"
                );
            }
            let place = at(place.x + 0.5, place.y + 0.5) + DVec2::new(0.0, 4.0);
            labels.push((place, (self.number)(level)));
        }
        if with_numbers {
            for (i, &value) in self.values.iter().enumerate() {
                let (column, row) = ((i % self.count[0]) as f64, (i / self.count[0]) as f64);
                let place = at(column + 0.5, row + 0.5) + DVec2::new(0.0, 4.0);
                let [ink, halo] = if value / most > 0.55 { ["#000", "#fff"] } else { ["#fff", "#000"] };
                let style = format!("fill=\"{ink}\" stroke=\"{halo}\" stroke-width=\"2\" paint-order=\"stroke\"");
                text_at(&mut svg, place, &style, &(self.number)(value));
            }
        }
        for (place, text) in labels {
            let style = "fill=\"#fff\" stroke=\"#000\" stroke-width=\"3\" paint-order=\"stroke\" font-weight=\"600\"";
            text_at(&mut svg, place, style, &text);
        }
        svg += &format!("<polygon class=\"edge\" points=\"{}\" fill=\"none\"/>\n", points(&outline));
        // The length of each edge stands beside the edge, on the outer side.
        let middle = 0.5 * (outline[0] + outline[2]);
        for (ends, length) in [([outline[0], outline[1]], along_u), ([outline[0], outline[3]], along_v)] {
            let beside = 0.5 * (ends[0] + ends[1]);
            let place = beside + (beside - middle).normalize_or_zero() * 16.0 + DVec2::new(0.0, 4.0);
            text_at(&mut svg, place, "", &(self.number)(length.length() / scale));
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn most(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE)
    }

    /// Returns the value at the end of the scale of colours, with its unit.
    pub fn most_label(&self) -> String {
        format!("{} {}", (self.number)(self.most()), self.unit)
    }

    /// Returns a sentence about the isolines and the sides of the plan.
    pub fn caption(&self) -> String {
        let levels = self.levels();
        let lines = match levels[..] {
            [] => "There are no isolines.".to_string(),
            [only] => format!("The isoline is at {} {}.", (self.number)(only), self.unit),
            [first, second, ..] => {
                let step = (self.number)(second - first);
                format!(
                    "The isolines begin at {} {unit} and are {step} {unit} apart.",
                    (self.number)(first),
                    unit = self.unit
                )
            }
        };
        format!("{lines} The numbers at the edges are lengths in the unit of the scene.")
    }

    /// Returns the values of the isolines: round numbers between the least and the largest value.
    fn levels(&self) -> Vec<f64> {
        let finite = self.values.iter().copied().filter(|value| value.is_finite());
        let (least, most) = finite
            .clone()
            .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), value| (low.min(value), high.max(value)));
        let ticks = Axis::linear(finite, false, (0.0, 1.0)).ticks();
        ticks
            .into_iter()
            .map(|tick| tick.value)
            .filter(|level| (least..most).contains(level) && *level > least)
            .collect()
    }

    /// Returns the corner and the edges of the plan on the page, and the scale of lengths.
    fn layout(&self) -> ([DVec2; 3], f64) {
        let [u, v, facing] = self.frame;
        let plane = u.cross(v).normalize_or_zero();
        let normal = if plane.dot(facing + 1e-3 * DVec3::Y) < 0.0 { -plane } else { plane };
        let right = u.normalize();
        let up = normal.cross(right);
        let on_page = |vector: DVec3| DVec2::new(vector.dot(right), -vector.dot(up));
        let (u, v) = (on_page(u), on_page(v));
        let corners = [DVec2::ZERO, u, v, u + v];
        let low = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let size = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max) - low;
        let scale = ((SIZE[0] - 2.0 * MARGIN) / size.x).min((SIZE[1] - 2.0 * MARGIN) / size.y.max(1e-9 * size.x));
        ([DVec2::splat(MARGIN) - low * scale, u * scale, v * scale], scale)
    }

    /// Returns the place of an isoline's label in cells: the middle of the segment that is farthest
    /// from the middles of the cells, where readings may be written, and not beyond the readings if
    /// it can be helped.
    fn label_place(&self, lines: &[[DVec2; 2]]) -> Option<DVec2> {
        let last = DVec2::new(self.count[0] as f64 - 1.0, self.count[1] as f64 - 1.0);
        let distance = |place: DVec2| {
            let inside = place.cmpge(DVec2::ZERO).all() && place.cmple(last).all();
            (place - place.round()).length() + if inside { 1.0 } else { 0.0 }
        };
        let middles = lines.iter().map(|[a, b]| 0.5 * (*a + *b));
        middles.max_by(|a, b| distance(*a).total_cmp(&distance(*b)))
    }

    /// Returns the value at a node of the lattice of readings and edges: node 0 is the lower edge,
    /// node 1 the first reading, and the last node the upper edge. Beyond the readings, the value
    /// continues as between the last two.
    fn at_node(&self, node: [usize; 2]) -> f64 {
        let of = |axis: usize| {
            let last = self.count[axis] - 1;
            let (near, far) = match node[axis] {
                0 => (0, 1.min(last)),
                node if node > last + 1 => (last, last.saturating_sub(1)),
                node => (node - 1, node - 1),
            };
            [(near, if near == far { 1.0 } else { 1.5 }), (far, if near == far { 0.0 } else { -0.5 })]
        };
        let [columns, rows] = [of(0), of(1)];
        let term =
            |(column, a): (usize, f64), (row, b): (usize, f64)| a * b * self.values[row * self.count[0] + column];
        rows.iter().map(|row| columns.iter().map(|column| term(*column, *row)).sum::<f64>()).sum()
    }

    /// Returns the segments of an isoline in cells, from the middle of the first one. Between four
    /// nodes, the values are interpolated linearly in the four triangles around their mean.
    fn isoline(&self, level: f64) -> Vec<[DVec2; 2]> {
        let place = |node: usize, axis: usize| (node as f64 - 1.0).clamp(-0.5, self.count[axis] as f64 - 0.5);
        let mut segments = Vec::new();
        for row in 0..=self.count[1] {
            for column in 0..=self.count[0] {
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| {
                    let (column, row) = (column + i, row + j);
                    (DVec2::new(place(column, 0), place(row, 1)), self.at_node([column, row]))
                });
                let mean = corners.iter().map(|(_, value)| 0.25 * value).sum();
                let middle = (0.25 * corners.iter().map(|(place, _)| *place).sum::<DVec2>(), mean);
                for side in 0..4 {
                    segments.extend(across([corners[side], corners[(side + 1) % 4], middle], level));
                }
            }
        }
        segments
    }
}

/// Returns the segment of an isoline in a triangle, if the isoline crosses it.
fn across(triangle: [(DVec2, f64); 3], level: f64) -> Option<[DVec2; 2]> {
    let cut = |a: (DVec2, f64), b: (DVec2, f64)| {
        ((a.1 < level) != (b.1 < level)).then(|| a.0 + (b.0 - a.0) * ((level - a.1) / (b.1 - a.1)))
    };
    let [a, b, c] = triangle;
    let cuts: Vec<DVec2> = [cut(a, b), cut(b, c), cut(c, a)].into_iter().flatten().collect();
    cuts.try_into().ok()
}

fn points(corners: &[DVec2]) -> String {
    corners.iter().map(|corner| format!("{:.1},{:.1}", corner.x, corner.y)).collect::<Vec<_>>().join(" ")
}

/// Writes a text that is centred at a place.
fn text_at(svg: &mut String, place: DVec2, style: &str, text: &str) {
    let text = escape_xml(text);
    *svg += &format!("<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" {style}>{text}</text>\n", place.x, place.y);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(u: DVec3, v: DVec3, count: [usize; 2], value: impl Fn(f64, f64) -> f64) -> PlanMap {
        let values = (0..count[0] * count[1]).map(|i| value((i % count[0]) as f64, (i / count[0]) as f64)).collect();
        PlanMap { frame: [u, v, DVec3::Y], count, values, unit: "lx", number: |value| format!("{value:.0}") }
    }

    #[test]
    fn isolines_lie_where_the_function_has_their_value() {
        let linear = plan(DVec3::X, DVec3::Z, [9, 7], |x, y| 10.0 * x + 3.0 * y);
        let levels = linear.levels();
        assert_eq!(levels, [20.0, 40.0, 60.0, 80.0]);
        for level in levels {
            let segments = linear.isoline(level);
            assert!(segments.len() >= 6);
            for point in segments.into_iter().flatten() {
                assert!((10.0 * point.x + 3.0 * point.y - level).abs() < 1e-9, "{point}");
            }
        }
        let cone = plan(DVec3::X, DVec3::Z, [41, 41], |x, y| (x - 20.0).hypot(y - 20.0));
        for point in cone.isoline(10.0).into_iter().flatten() {
            assert!((point.distance(DVec2::splat(20.0)) - 10.0).abs() < 0.02, "{point}");
        }
        assert!(plan(DVec3::X, DVec3::Z, [3, 3], |_, _| 5.0).levels().is_empty());
    }

    /// From above, x leads to the right and z down. A skew grid keeps its angles.
    #[test]
    fn plans_are_seen_from_the_side_of_the_normal() {
        let ([_, u, v], scale) = plan(4.0 * DVec3::X, 2.0 * DVec3::Z, [2, 2], |x, _| x).layout();
        assert!(
            (u / scale - DVec2::new(4.0, 0.0)).length() < 1e-12 && (v / scale - DVec2::new(0.0, 2.0)).length() < 1e-12
        );
        let ([_, u, v], _) = plan(4.0 * DVec3::X, DVec3::new(1.0, 0.0, -1.0), [2, 2], |x, _| x).layout();
        assert!(v.y < 0.0 && (u.angle_to(v).abs().to_degrees() - 45.0).abs() < 1e-9);
    }
}
