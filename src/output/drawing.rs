//! The drawing of a lens cut along its axis, as SVG: glass, stop, sensor, rays, and magnified windows where they focus.

use glam::DVec2;

use super::plot::{append, escaped};

/// A chain of points in a colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Which of [`Drawing::colours`] it has.
    pub colour: usize,
    /// Which of [`Drawing::windows`] shows it magnified.
    pub window: usize,
    /// Its points (along the axis, across it).
    pub points: Vec<DVec2>,
}

/// A place to be magnified; its two directions have scales of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// What it shows.
    pub title: String,
    /// Its middle.
    pub centre: DVec2,
    /// Half its size, above 0.
    pub half_size: DVec2,
    /// The slope of the line through the centre that is shown level, so that steep bundles fill the window too.
    pub slope: f64,
}

/// What is drawn; all lengths in mm, the axis at 0 across.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// The title.
    pub title: String,
    /// What is worth knowing, below the title.
    pub caption: String,
    /// Closed outlines of glass.
    pub glass: Vec<Vec<DVec2>>,
    /// The blades of the stop.
    pub stop: [[DVec2; 2]; 2],
    /// The sensor.
    pub sensor: [DVec2; 2],
    /// The rays.
    pub strokes: Vec<Stroke>,
    /// The colours of strokes: what each means, and how it is written in SVG.
    pub colours: Vec<(String, String)>,
    /// The magnified places.
    pub windows: Vec<Window>,
}

const WIDTH: f64 = 1080.0;
const MARGIN: f64 = 28.0;
const TOP: f64 = 76.0;
/// The largest height of the lens itself.
const TALLEST: f64 = 460.0;
/// Height of a window, with its words.
const WINDOW: f64 = 190.0;
const BELOW: f64 = 52.0;

/// From mm to the page.
#[derive(Debug, Clone, Copy)]
struct Scale {
    origin: DVec2,
    per_mm: DVec2,
}

impl Scale {
    fn place(&self, point: DVec2) -> DVec2 {
        self.origin + self.per_mm * point * DVec2::new(1.0, -1.0)
    }

    fn path(&self, points: &[DVec2]) -> String {
        let mut path = String::new();
        for (i, point) in points.iter().enumerate() {
            let (command, place) = (if i == 0 { 'M' } else { 'L' }, self.place(*point));
            append(&mut path, format_args!("{command}{:.2} {:.2}", place.x, place.y));
        }
        path
    }
}

impl Drawing {
    /// The drawing as a file that needs no other.
    pub fn svg(&self) -> String {
        let (low, high) = self.bounds();
        let size = high - low;
        let per_mm = ((WIDTH - 2.0 * MARGIN) / size.x).min(TALLEST / size.y);
        let left = 0.5 * (WIDTH - per_mm * size.x);
        let scale =
            Scale { origin: DVec2::new(left - per_mm * low.x, TOP + per_mm * high.y), per_mm: DVec2::splat(per_mm) };
        let foot = TOP + per_mm * size.y + 24.0;
        let height = foot + if self.windows.is_empty() { 0.0 } else { WINDOW + BELOW };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" width=\"{WIDTH}\" height=\"{height:.0}\" \
             font-family=\"system-ui, sans-serif\" font-size=\"14\" fill=\"#222\">\n\
             <rect width=\"{WIDTH}\" height=\"{height:.0}\" fill=\"#fff\"/>\n\
             <text x=\"{MARGIN}\" y=\"32\" font-size=\"18\">{}</text>\n\
             <text x=\"{MARGIN}\" y=\"54\" fill=\"#555\">{}</text>\n",
            escaped(&self.title),
            escaped(&self.caption)
        );
        svg += &self.legend();
        svg += &self.lens(&scale, (low.x, high.x));
        for i in 0..self.windows.len() {
            svg += &self.window(i, foot);
        }
        svg += "</svg>\n";
        svg
    }

    /// Lower and upper corner of all that is drawn.
    fn bounds(&self) -> (DVec2, DVec2) {
        let rays = self.strokes.iter().flat_map(|stroke| &stroke.points);
        let points = self.glass.iter().flatten().chain(rays).chain(self.stop.iter().flatten()).chain(&self.sensor);
        let (low, high) = points
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), point| (low.min(*point), high.max(*point)));
        (low, high.max(low + DVec2::splat(f64::MIN_POSITIVE)))
    }

    fn legend(&self) -> String {
        let mut svg = String::new();
        for (i, (name, colour)) in self.colours.iter().rev().enumerate() {
            let x = WIDTH - MARGIN - 130.0 * i as f64;
            let name = escaped(name);
            append(
                &mut svg,
                format_args!("<text x=\"{x}\" y=\"32\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>\n"),
            );
        }
        svg
    }

    fn lens(&self, scale: &Scale, (from, to): (f64, f64)) -> String {
        let mut svg = String::new();
        for outline in &self.glass {
            let path = scale.path(outline);
            let style = "fill=\"#cfe3f2\" fill-opacity=\"0.85\" stroke=\"#43627a\" stroke-width=\"1.2\" stroke-linejoin=\"round\"";
            append(&mut svg, format_args!("<path class=\"glass\" d=\"{path}Z\" {style}/>\n"));
        }
        let axis = scale.path(&[DVec2::new(from, 0.0), DVec2::new(to, 0.0)]);
        append(
            &mut svg,
            format_args!("<path class=\"axis\" d=\"{axis}\" stroke=\"#888\" stroke-dasharray=\"14 4 2 4\"/>\n"),
        );
        svg += &self.rays(scale);
        for blade in &self.stop {
            let path = scale.path(blade);
            append(&mut svg, format_args!("<path class=\"stop\" d=\"{path}\" stroke=\"#111\" stroke-width=\"5\"/>\n"));
        }
        let path = scale.path(&self.sensor);
        append(&mut svg, format_args!("<path class=\"sensor\" d=\"{path}\" stroke=\"#111\" stroke-width=\"2.5\"/>\n"));
        svg
    }

    /// The rays through the lens: where the colours run together they lie inside each other, so that each shows.
    fn rays(&self, scale: &Scale) -> String {
        let mut svg = String::new();
        for (i, (_, colour)) in self.colours.iter().enumerate() {
            let width = 0.8 + (self.colours.len() - 1 - i) as f64;
            for stroke in self.strokes.iter().filter(|stroke| stroke.colour == i) {
                ray(&mut svg, &scale.path(&stroke.points), colour, width);
            }
        }
        svg
    }

    /// The neighbourhood of a focus, magnified.
    fn window(&self, i: usize, top: f64) -> String {
        let Window { title, centre, half_size, slope: _ } = &self.windows[i];
        let share = (WIDTH - MARGIN) / self.windows.len() as f64;
        let (x, width) = (MARGIN + share * i as f64, share - MARGIN);
        let size = DVec2::new(width, WINDOW);
        let per_mm = size / (2.0 * *half_size);
        let middle = DVec2::new(x + 0.5 * width, top + 0.5 * WINDOW);
        let scale = Scale { origin: middle - per_mm * *centre * DVec2::new(1.0, -1.0), per_mm };
        let frame = format!("x=\"{x:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{WINDOW}\"");
        let mut svg =
            format!("<clipPath id=\"window{i}\"><rect {frame}/></clipPath>\n<g clip-path=\"url(#window{i})\">\n");
        for stroke in self.strokes.iter().filter(|stroke| stroke.window == i) {
            let colour = self.colours.get(stroke.colour).map_or("#222", |colour| colour.1.as_str());
            ray(&mut svg, &scale.path(&across(&self.windows[i], &stroke.points)), colour, 1.4);
        }
        let sensor = format!("M{:.2} {top:.2}v{WINDOW}", middle.x);
        append(
            &mut svg,
            format_args!("<path class=\"sensor\" d=\"{sensor}\" stroke=\"#111\" stroke-width=\"2.5\"/>\n</g>\n"),
        );
        append(&mut svg, format_args!("<rect {frame} fill=\"none\" stroke=\"#999\"/>\n"));
        let (y, title) = (top + WINDOW + 22.0, escaped(title));
        append(
            &mut svg,
            format_args!("<text x=\"{:.2}\" y=\"{y:.2}\" text-anchor=\"middle\">{title}</text>\n", middle.x),
        );
        let size = format!("{:.3} mm along the axis, {:.4} mm across", 2.0 * half_size.x, 2.0 * half_size.y);
        let y = y + 19.0;
        let style = "text-anchor=\"middle\" font-size=\"12\" fill=\"#555\"";
        append(&mut svg, format_args!("<text x=\"{:.2}\" y=\"{y:.2}\" {style}>{size}</text>\n", middle.x));
        svg
    }
}

fn ray(svg: &mut String, path: &str, colour: &str, width: f64) {
    let style = "fill=\"none\" stroke-linejoin=\"round\"";
    append(
        svg,
        format_args!("<path class=\"ray\" d=\"{path}\" {style} stroke=\"{colour}\" stroke-width=\"{width}\"/>\n"),
    );
}

/// The line of a chain's last two points, from one side of a window to the other, less the window's slope.
fn across(window: &Window, points: &[DVec2]) -> Vec<DVec2> {
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

    fn drawing() -> Drawing {
        let stroke = |window, points| Stroke { colour: 0, window, points };
        let window = |y| Window {
            title: "focus".to_string(),
            centre: DVec2::new(100.0, y),
            half_size: DVec2::new(1.0, 0.1),
            slope: 0.0,
        };
        Drawing {
            title: "a <lens> & more".to_string(),
            caption: String::new(),
            glass: vec![vec![DVec2::new(0.0, -10.0), DVec2::new(0.0, 10.0), DVec2::new(5.0, 0.0)]],
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
    fn the_file_is_whole_and_its_text_escaped() {
        let svg = drawing().svg();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(svg.contains("a &lt;lens&gt; &amp; more") && !svg.contains("NaN") && !svg.contains("inf"));
        let count = |class: &str| svg.matches(&format!("class=\"{class}\"")).count();
        // Each ray once in the lens and once in its window; the sensor in all three.
        assert_eq!([count("glass"), count("stop"), count("ray"), count("sensor")], [1, 2, 4, 3]);
    }

    #[test]
    fn a_window_shows_the_last_piece_of_its_rays_from_side_to_side() {
        let Drawing { windows, strokes, .. } = drawing();
        let shown = across(&windows[0], &strokes[0].points);
        assert_eq!(shown, [DVec2::new(99.0, 0.08), DVec2::new(101.0, -0.08)]);
        assert!(across(&windows[0], &strokes[0].points[..1]).is_empty());
        // Along the ray itself it is level.
        let level = across(&Window { slope: -0.08, ..windows[0].clone() }, &strokes[0].points);
        assert!(level.iter().all(|point| point.y.abs() < 1e-15), "{level:?}");
    }
}
