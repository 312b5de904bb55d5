//! A lens in the meridional plane as SVG: glass, stop, sensor, rays, and magnified foci.

use glam::DVec2;

use super::svg::escape_xml;

#[derive(Debug, Clone, PartialEq)]
pub struct RayStroke {
    /// The index of the polyline's colour in [`LensDrawing::colours`].
    pub colour: usize,
    /// The index in [`LensDrawing::windows`] of the window that magnifies the polyline.
    pub window: usize,
    /// Each point is a position along the axis and a height above the axis.
    pub points: Vec<DVec2>,
}

/// A magnified view. The horizontal and the vertical direction have different scales.
#[derive(Debug, Clone, PartialEq)]
pub struct FocusInset {
    pub title: String,
    pub centre: DVec2,
    /// Half the width and half the height, both above 0.
    pub half_size: DVec2,
    /// The slope of a line through the centre, which the window shows as horizontal, so that steep
    /// bundles of rays fill the window too.
    pub slope: f64,
}

/// The content of a drawing. All lengths are in mm; the optical axis has the height 0.
#[derive(Debug, Clone, PartialEq)]
pub struct LensDrawing {
    pub title: String,
    pub caption: String,
    pub glass: Vec<Vec<DVec2>>,
    /// Thin surfaces, such as mirrors.
    pub sheets: Vec<Vec<DVec2>>,
    pub stop: [[DVec2; 2]; 2],
    pub sensor: [DVec2; 2],
    pub strokes: Vec<RayStroke>,
    /// The meaning of each colour, and the colour in SVG notation.
    pub colours: Vec<(String, String)>,
    pub windows: Vec<FocusInset>,
}

const DRAWING_WIDTH: f64 = 1080.0;
const DRAWING_MARGIN: f64 = 28.0;
const DRAWING_TOP: f64 = 76.0;
/// The largest height of the lens on the page.
const DRAWING_TALLEST: f64 = 460.0;
const WINDOW_HEIGHT: f64 = 190.0;
const DRAWING_BELOW: f64 = 52.0;

/// The mapping from lengths in mm to positions on the page.
#[derive(Debug, Clone, Copy)]
struct DrawingScale {
    origin: DVec2,
    per_mm: DVec2,
}

impl DrawingScale {
    fn position(&self, point: DVec2) -> DVec2 {
        self.origin + self.per_mm * point * DVec2::new(1.0, -1.0)
    }

    fn path(&self, points: &[DVec2]) -> String {
        let mut path = String::new();
        for (i, point) in points.iter().enumerate() {
            let (command, place) = (if i == 0 { 'M' } else { 'L' }, self.position(*point));
            path += &format!("{command}{:.2} {:.2}", place.x, place.y);
        }
        path
    }
}

impl LensDrawing {
    /// Returns the drawing as a self-contained SVG document.
    pub fn svg(&self) -> String {
        let (low, high) = self.bounds();
        let size = high - low;
        let per_mm = ((DRAWING_WIDTH - 2.0 * DRAWING_MARGIN) / size.x).min(DRAWING_TALLEST / size.y);
        let left = 0.5 * (DRAWING_WIDTH - per_mm * size.x);
        let scale = DrawingScale {
            origin: DVec2::new(left - per_mm * low.x, DRAWING_TOP + per_mm * high.y),
            per_mm: DVec2::splat(per_mm),
        };
        let foot = DRAWING_TOP + per_mm * size.y + 24.0;
        let height = foot + if self.windows.is_empty() { 0.0 } else { WINDOW_HEIGHT + DRAWING_BELOW };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {DRAWING_WIDTH} {height:.0}\" width=\"{DRAWING_WIDTH}\" height=\"{height:.0}\" \
             font-family=\"system-ui, sans-serif\" font-size=\"14\" fill=\"#222\">\n\
             <rect width=\"{DRAWING_WIDTH}\" height=\"{height:.0}\" fill=\"#fff\"/>\n\
             <text x=\"{DRAWING_MARGIN}\" y=\"32\" font-size=\"18\">{}</text>\n\
             <text x=\"{DRAWING_MARGIN}\" y=\"54\" fill=\"#555\">{}</text>\n",
            escape_xml(&self.title),
            escape_xml(&self.caption)
        );
        svg += &self.legend();
        svg += &self.lens(&scale, (low.x, high.x));
        for i in 0..self.windows.len() {
            svg += &self.window(i, foot);
        }
        svg + "</svg>\n"
    }

    /// Returns the lower and the upper corner of the bounding box of all points.
    fn bounds(&self) -> (DVec2, DVec2) {
        let rays = self.strokes.iter().flat_map(|stroke| &stroke.points);
        let points = self
            .glass
            .iter()
            .chain(&self.sheets)
            .flatten()
            .chain(rays)
            .chain(self.stop.iter().flatten())
            .chain(&self.sensor);
        let (low, high) = points
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), point| (low.min(*point), high.max(*point)));
        (low, high.max(low + DVec2::splat(f64::MIN_POSITIVE)))
    }

    fn legend(&self) -> String {
        let longest = self.colours.iter().map(|(name, _)| name.chars().count()).max().unwrap_or_default();
        let pitch = 12.0 * longest as f64 - 2.0;
        let entry = |(i, (name, colour)): (usize, &(String, String))| {
            let (x, name) = (DRAWING_WIDTH - DRAWING_MARGIN - pitch * i as f64, escape_xml(name));
            format!("<text x=\"{x}\" y=\"32\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>\n")
        };
        self.colours.iter().rev().enumerate().map(entry).collect()
    }

    fn lens(&self, scale: &DrawingScale, (from, to): (f64, f64)) -> String {
        let mut svg = String::new();
        for outline in &self.glass {
            let path = scale.path(outline);
            let style = "fill=\"#cfe3f2\" fill-opacity=\"0.85\" stroke=\"#43627a\" stroke-width=\"1.2\" stroke-linejoin=\"round\"";
            svg += &format!("<path class=\"glass\" d=\"{path}Z\" {style}/>\n");
        }
        for sheet in &self.sheets {
            let style = "fill=\"none\" stroke=\"#43627a\" stroke-width=\"2.5\"";
            svg += &format!("<path class=\"sheet\" d=\"{}\" {style}/>\n", scale.path(sheet));
        }
        let axis = scale.path(&[DVec2::new(from, 0.0), DVec2::new(to, 0.0)]);
        svg += &format!("<path class=\"axis\" d=\"{axis}\" stroke=\"#888\" stroke-dasharray=\"14 4 2 4\"/>\n");
        svg += &self.rays(scale);
        for blade in &self.stop {
            let path = scale.path(blade);
            svg += &format!("<path class=\"stop\" d=\"{path}\" stroke=\"#111\" stroke-width=\"5\"/>\n");
        }
        let path = scale.path(&self.sensor);
        svg += &format!("<path class=\"sensor\" d=\"{path}\" stroke=\"#111\" stroke-width=\"2.5\"/>\n");
        svg
    }

    /// Draws the rays, the first ones wider, so that all colours stay visible where they coincide.
    fn rays(&self, scale: &DrawingScale) -> String {
        let mut svg = String::new();
        for (i, (_, colour)) in self.colours.iter().enumerate() {
            let width = 0.8 + (self.colours.len() - 1 - i) as f64;
            for stroke in self.strokes.iter().filter(|stroke| stroke.colour == i) {
                ray(&mut svg, &scale.path(&stroke.points), colour, width);
            }
        }
        svg
    }

    fn window(&self, i: usize, top: f64) -> String {
        let FocusInset { title, centre, half_size, slope: _ } = &self.windows[i];
        let pitch = (DRAWING_WIDTH - DRAWING_MARGIN) / self.windows.len() as f64;
        let (x, width) = (DRAWING_MARGIN + pitch * i as f64, pitch - DRAWING_MARGIN);
        let size = DVec2::new(width, WINDOW_HEIGHT);
        let per_mm = size / (2.0 * *half_size);
        let middle = DVec2::new(x + 0.5 * width, top + 0.5 * WINDOW_HEIGHT);
        let scale = DrawingScale { origin: middle - per_mm * *centre * DVec2::new(1.0, -1.0), per_mm };
        let frame = format!("x=\"{x:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{WINDOW_HEIGHT}\"");
        let mut svg =
            format!("<clipPath id=\"window{i}\"><rect {frame}/></clipPath>\n<g clip-path=\"url(#window{i})\">\n");
        for stroke in self.strokes.iter().filter(|stroke| stroke.window == i) {
            let colour = self.colours.get(stroke.colour).map_or("#222", |colour| colour.1.as_str());
            ray(&mut svg, &scale.path(&across(&self.windows[i], &stroke.points)), colour, 1.4);
        }
        let sensor = format!("M{:.2} {top:.2}v{WINDOW_HEIGHT}", middle.x);
        svg += &format!("<path class=\"sensor\" d=\"{sensor}\" stroke=\"#111\" stroke-width=\"2.5\"/>\n</g>\n");
        svg += &format!("<rect {frame} fill=\"none\" stroke=\"#999\"/>\n");
        let (y, title) = (top + WINDOW_HEIGHT + 22.0, escape_xml(title));
        svg += &format!("<text x=\"{:.2}\" y=\"{y:.2}\" text-anchor=\"middle\">{title}</text>\n", middle.x);
        let size = format!("{:.3} mm along the axis, {:.4} mm across", 2.0 * half_size.x, 2.0 * half_size.y);
        let y = y + 19.0;
        let style = "text-anchor=\"middle\" font-size=\"12\" fill=\"#555\"";
        svg += &format!("<text x=\"{:.2}\" y=\"{y:.2}\" {style}>{size}</text>\n", middle.x);
        svg
    }
}

fn ray(svg: &mut String, path: &str, colour: &str, width: f64) {
    let style = "fill=\"none\" stroke-linejoin=\"round\"";
    *svg += &format!("<path class=\"ray\" d=\"{path}\" {style} stroke=\"{colour}\" stroke-width=\"{width}\"/>\n");
}

/// Extends the last segment of a polyline to both sides of a window. Heights are measured from the
/// sloped line that the window shows as horizontal.
fn across(window: &FocusInset, points: &[DVec2]) -> Vec<DVec2> {
    let [.., before, last] = points else { return Vec::new() };
    let slope = (last.y - before.y) / (last.x - before.x);
    let side = |sign: f64| {
        let x = window.centre.x + sign * window.half_size.x;
        DVec2::new(x, last.y + slope * (x - last.x) - window.slope * sign * window.half_size.x)
    };
    vec![side(-1.0), side(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> LensDrawing {
        let stroke = |window, points| RayStroke { colour: 0, window, points };
        let window = |y| FocusInset {
            title: "focus".to_string(),
            centre: DVec2::new(100.0, y),
            half_size: DVec2::new(1.0, 0.1),
            slope: 0.0,
        };
        LensDrawing {
            title: "a <lens> & more".to_string(),
            caption: String::new(),
            glass: vec![vec![DVec2::new(0.0, -10.0), DVec2::new(0.0, 10.0), DVec2::new(5.0, 0.0)]],
            sheets: Vec::new(),
            stop: [[DVec2::new(0.0, 10.0), DVec2::new(0.0, 12.0)], [DVec2::new(0.0, -10.0), DVec2::new(0.0, -12.0)]],
            sensor: [DVec2::new(100.0, 5.0), DVec2::new(100.0, -5.0)],
            strokes: vec![
                stroke(0, vec![DVec2::new(-10.0, 8.0), DVec2::new(0.0, 8.0), DVec2::new(100.0, 0.0)]),
                stroke(1, vec![DVec2::new(-10.0, 0.0), DVec2::new(100.0, 4.0)]),
            ],
            colours: vec![("d".to_string(), "#123456".to_string())],
            windows: vec![window(0.0), window(4.0)],
        }
    }

    #[test]
    fn the_document_is_complete_and_its_text_escaped() {
        let svg = drawing().svg();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(svg.contains("a &lt;lens&gt; &amp; more") && !svg.contains("NaN") && !svg.contains("inf"));
        let count = |class: &str| svg.matches(&format!("class=\"{class}\"")).count();
        // Each ray is in the lens and in its window, and the sensor in the lens and both windows.
        assert_eq!([count("glass"), count("stop"), count("ray"), count("sensor")], [1, 2, 4, 3]);
    }

    #[test]
    fn a_window_extends_the_last_segment_of_its_rays() {
        let LensDrawing { windows, strokes, .. } = drawing();
        let shown = across(&windows[0], &strokes[0].points);
        assert_eq!(shown, [DVec2::new(99.0, 0.08), DVec2::new(101.0, -0.08)]);
        assert!(across(&windows[0], &strokes[0].points[..1]).is_empty());
        // A window with the slope of the ray shows the ray horizontally.
        let level = across(&FocusInset { slope: -0.08, ..windows[0].clone() }, &strokes[0].points);
        assert!(level.iter().all(|point| point.y.abs() < 1e-15), "{level:?}");
    }
}
