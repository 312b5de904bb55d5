//! Plots of functions of wavelength as SVG.

use super::axis::Axis;
use super::svg::{CURVE_COLOURS, escape_xml, head, path};
use abbe_spectra::colour::{srgb_hex, xyz_to_linear_srgb};
use abbe_spectra::math::elementary::powf;
use abbe_spectra::spectrum::{BAND_NM, Observer, Spectrum};

#[derive(Debug, Clone, PartialEq)]
pub struct SpectralCurve {
    pub name: String,
    /// Pairs of wavelength in nm and value, sorted by wavelength.
    pub points: Vec<(f64, f64)>,
}

/// A plot of functions of wavelength, with the colours of the spectrum along the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralPlot {
    pub title: String,
    pub values: String,
    /// The curves. If the vertical axis begins at 0, the area under the first curve is coloured.
    pub curves: Vec<SpectralCurve>,
    /// Pairs of the wavelength in nm and the height of the stroke, as a fraction of the plot's.
    pub lines: Vec<(f64, f64)>,
    /// True if the vertical axis always includes 0, even if all values are larger.
    pub from_zero: bool,
}

const PLOT_SIZE: (f64, f64) = (840.0, 480.0);
const PLOT_LEFT: f64 = 84.0;
const PLOT_RIGHT: f64 = 24.0;
const PLOT_TOP: f64 = 52.0;
const PLOT_BOTTOM: f64 = 84.0;
/// The height of the strip of spectral colours below the axis.
const PLOT_STRIP: f64 = 14.0;

impl SpectralPlot {
    /// Plots a spectrum over the band: the continuum as a curve with the quantity and unit
    /// `density`, and spectral lines as strokes in proportion to their power with the unit `power`.
    pub fn of_spectrum(title: &str, spectrum: &Spectrum, density: &str, power: Option<&str>) -> Self {
        let lines = spectrum.line_segments();
        let strongest = lines.iter().map(|line| line.power).fold(0.0, f64::max);
        let nm = (0..=(BAND_NM.1 - BAND_NM.0) as u32).map(|i| BAND_NM.0 + f64::from(i));
        let points: Vec<(f64, f64)> = nm.map(|nm| (nm, spectrum.continuum_at(nm))).collect();
        let has_continuum = lines.is_empty() || points.iter().any(|point| point.1 > 0.0);
        let values = match (lines.is_empty(), has_continuum, power) {
            (true, ..) => density.to_string(),
            (false, true, Some(unit)) => format!("{density}; strongest line {strongest:.3} {unit}"),
            (false, true, None) => format!("{density}; lines: power relative to the strongest line"),
            (false, false, Some(unit)) => format!("line power; 1 is {strongest:.3} {unit}"),
            (false, false, None) => "line power, relative to the strongest line".to_string(),
        };
        Self {
            title: title.to_string(),
            values,
            curves: if has_continuum {
                vec![SpectralCurve { name: "continuum".to_string(), points }]
            } else {
                Vec::new()
            },
            lines: lines.iter().map(|line| (line.centre(), line.power / strongest)).collect(),
            from_zero: true,
        }
    }

    /// Returns a self-contained SVG document. Curves have gaps at points that are not finite.
    pub fn svg(&self) -> String {
        let values = self.curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
        let up = Axis::linear(values, self.from_zero, (PLOT_SIZE.1 - PLOT_BOTTOM, PLOT_TOP));
        let mut svg = head("plot", PLOT_SIZE, 14.0);
        let title = escape_xml(&self.title);
        svg += &format!("<text x=\"{PLOT_LEFT}\" y=\"30\" font-size=\"18\">{title}</text>\n");
        svg += &strip();
        svg += &axes(&up, &self.values);
        if let Some(curve) = self.curves.first().filter(|_| self.from_zero) {
            svg += &area(&up, &curve.points);
        }
        for &(nm, fraction) in &self.lines {
            let (x, foot) = (x(nm), PLOT_SIZE.1 - PLOT_BOTTOM);
            let top = foot - fraction * (foot - PLOT_TOP);
            let colour = spectral_colour(nm);
            svg += &format!("<path d=\"M{x:.2} {foot}V{top:.2}\" stroke=\"{colour}\" stroke-width=\"2\"/>\n");
        }
        for (i, curve) in self.curves.iter().enumerate().rev() {
            let colour = CURVE_COLOURS[i % CURVE_COLOURS.len()];
            let path = curve_path(&up, &curve.points);
            let style = "fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\"";
            svg += &format!("<path class=\"curve{i}\" d=\"{path}\" {style} stroke=\"{colour}\"/>\n");
        }
        svg + &self.legend() + "</svg>\n"
    }

    fn legend(&self) -> String {
        if self.curves.len() < 2 {
            return String::new();
        }
        let entry = |(i, curve): (usize, &SpectralCurve)| {
            let colour = CURVE_COLOURS[i % CURVE_COLOURS.len()];
            let (x, y) = (PLOT_SIZE.0 - PLOT_RIGHT - 12.0, PLOT_TOP + 20.0 + 20.0 * i as f64);
            let name = escape_xml(&curve.name);
            format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>\n")
        };
        self.curves.iter().enumerate().map(entry).collect()
    }
}

fn x(nm: f64) -> f64 {
    PLOT_LEFT + (nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0) * (PLOT_SIZE.0 - PLOT_LEFT - PLOT_RIGHT)
}

fn axes(up: &Axis, values: &str) -> String {
    let mut svg = String::new();
    let (right, foot) = (PLOT_SIZE.0 - PLOT_RIGHT, PLOT_SIZE.1 - PLOT_BOTTOM);
    for tick in up.ticks() {
        let y = up.position(tick.value);
        svg += &format!("<path class=\"rule\" d=\"M{PLOT_LEFT} {y:.2}H{right}\" stroke=\"#ddd\"/>\n");
        let (x, y, label) = (PLOT_LEFT - 8.0, y + 5.0, tick.label.unwrap_or_default());
        svg += &format!("<text x=\"{x}\" y=\"{y:.2}\" text-anchor=\"end\">{label}</text>\n");
    }
    for nm in (400..=800).step_by(50) {
        let (x, top, y) = (x(f64::from(nm)), foot + PLOT_STRIP, foot + PLOT_STRIP + 22.0);
        svg += &format!("<path class=\"ink\" d=\"M{x:.2} {top}v5\" stroke=\"#222\"/>\n");
        svg += &format!("<text x=\"{x:.2}\" y=\"{y}\" text-anchor=\"middle\">{nm}</text>\n");
    }
    let frame = format!("d=\"M{PLOT_LEFT} {PLOT_TOP}V{foot}H{right}\" fill=\"none\"");
    svg += &format!("<path class=\"ink\" {frame} stroke=\"#222\"/>\n");
    let (x, y) = (0.5 * (PLOT_LEFT + right), PLOT_SIZE.1 - 18.0);
    svg += &format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">wavelength in nm</text>\n");
    let (y, label) = (0.5 * (PLOT_TOP + foot), escape_xml(values));
    let turned = format!("transform=\"rotate(-90 20 {y})\"");
    svg += &format!("<text x=\"20\" y=\"{y}\" text-anchor=\"middle\" {turned}>{label}</text>\n");
    svg
}

fn strip() -> String {
    let (from, to) = (x(BAND_NM.0), x(BAND_NM.1));
    let place = format!("gradientUnits=\"userSpaceOnUse\" x1=\"{from}\" x2=\"{to}\"");
    let mut svg = format!("<defs><linearGradient id=\"spectrum\" {place}>\n");
    for nm in (BAND_NM.0 as u32..=BAND_NM.1 as u32).step_by(10).map(f64::from) {
        let (fraction, colour) = ((nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0), spectral_colour(nm));
        svg += &format!("<stop offset=\"{fraction:.4}\" stop-color=\"{colour}\"/>\n");
    }
    let (y, width) = (PLOT_SIZE.1 - PLOT_BOTTOM, to - from);
    let place = format!("x=\"{from}\" y=\"{y}\" width=\"{width}\" height=\"{PLOT_STRIP}\"");
    svg += &format!("</linearGradient></defs>\n<rect {place} fill=\"url(#spectrum)\"/>\n");
    svg
}

/// Returns the display colour of a wavelength: mixed with white until it is within sRGB, scaled to
/// the largest brightness, and darker towards the ends of the visible range. (At the true
/// luminance, violet would be almost black.)
fn spectral_colour(nm: f64) -> String {
    let bar = Observer::cie1931().xyz_bar(nm);
    let linear = xyz_to_linear_srgb(bar);
    let white = linear.into_iter().fold(0.0, |white: f64, component| white.max(-component));
    let brightest = white + linear.into_iter().fold(0.0, f64::max);
    if brightest <= 0.0 {
        return "#000000".to_string();
    }
    let seen = powf((bar.iter().sum::<f64>() / 0.5).min(1.0), 0.5);
    srgb_hex(linear.map(|component| (component + white) / brightest * seen))
}

/// Wavelengths in nm and colours in sRGB, dark enough for lines on white paper. Unlike the colours
/// of the spectrum, they still change in the red.
const INKS: [(f64, [u8; 3]); 9] = [
    (400.0, [0x6a, 0x1f, 0xb0]),
    (450.0, [0x24, 0x3f, 0xcf]),
    (490.0, [0x08, 0x8c, 0x9c]),
    (530.0, [0x1c, 0x87, 0x2a]),
    (570.0, [0x84, 0x8c, 0x00]),
    (590.0, [0xcc, 0x96, 0x00]),
    (610.0, [0xd8, 0x66, 0x1c]),
    (640.0, [0xcf, 0x22, 0x2a]),
    (700.0, [0x6e, 0x0c, 0x1c]),
];

/// Returns a colour in SVG notation for lines that stand for a wavelength in nm.
pub fn ink_colour(nm: f64) -> String {
    let nm = nm.clamp(INKS[0].0, INKS[INKS.len() - 1].0);
    let pair = INKS.windows(2).find(|pair| nm <= pair[1].0).unwrap_or(&INKS[..2]);
    let fraction = (nm - pair[0].0) / (pair[1].0 - pair[0].0);
    let component = |c: usize| {
        let [from, to] = [pair[0].1[c], pair[1].1[c]].map(f64::from);
        (from + fraction * (to - from)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", component(0), component(1), component(2))
}

fn curve_path(up: &Axis, points: &[(f64, f64)]) -> String {
    path(points.iter().map(|&(nm, value)| (x(nm), up.position(value))), 2)
}

/// Fills the area under a curve with the colours of the spectrum, unless a point is not finite.
fn area(up: &Axis, points: &[(f64, f64)]) -> String {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return String::new() };
    if !points.iter().all(|(nm, value)| nm.is_finite() && value.is_finite()) {
        return String::new();
    }
    let (path, foot) = (curve_path(up, points), up.position(0.0));
    let (from, to) = (x(first.0), x(last.0));
    format!("<path d=\"{path}L{to:.2} {foot:.2}H{from:.2}Z\" fill=\"url(#spectrum)\" fill-opacity=\"0.45\"/>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<(f64, f64)>, from_zero: bool) -> SpectralPlot {
        let curves = vec![SpectralCurve { name: "a & b".to_string(), points }];
        SpectralPlot { title: "<D65>".to_string(), values: "power".to_string(), curves, lines: Vec::new(), from_zero }
    }

    #[test]
    fn labels_depend_on_the_content_of_a_spectrum() {
        let line = |nm, power| abbe_spectra::spectrum::SpectralLine { nm, power, fwhm_nm: None };
        let lines = Spectrum::lines(&[line(500.0, 2.0), line(600.0, 4.0)]).unwrap();
        let (smooth, mixed) =
            (Spectrum::constant(0.5), Spectrum::mix(&[(0.5, &lines), (1.0, &Spectrum::constant(0.5))]));
        let values = |spectrum: &Spectrum, power| SpectralPlot::of_spectrum("", spectrum, "W/nm", power).values;
        assert_eq!(values(&smooth, Some("W")), "W/nm");
        assert_eq!(values(&lines, Some("W")), "line power; 1 is 4.000 W");
        assert_eq!(values(&mixed, Some("W")), "W/nm; strongest line 2.000 W");
        assert_eq!(values(&lines, None), "line power, relative to the strongest line");
        let plot = SpectralPlot::of_spectrum("", &mixed, "W/nm", None);
        assert_eq!(plot.lines.iter().map(|line| line.1).collect::<Vec<_>>(), [0.5, 1.0]);
        assert!(
            plot.svg().contains("fill-opacity")
                && SpectralPlot::of_spectrum("", &lines, "W/nm", None).curves.is_empty()
        );
    }

    #[test]
    fn the_file_is_well_formed_and_names_are_escaped() {
        let svg = plot(vec![(400.0, 1.0), (500.0, f64::NAN), (600.0, 2.0)], true).svg();
        assert!(svg.contains("&lt;D65&gt;") && !svg.contains("<D65>"));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn red_green_and_blue_wavelengths_have_their_colours() {
        let component = |nm: f64, c: usize| u8::from_str_radix(&spectral_colour(nm)[1 + 2 * c..3 + 2 * c], 16).unwrap();
        let strongest = |nm: f64| (0..3).max_by_key(|&c| component(nm, c)).unwrap();
        assert_eq!([650.0, 530.0, 450.0].map(strongest), [0, 1, 2]);
        assert!(component(360.0, 2) < component(430.0, 2), "the ends fade");
        assert_eq!([380.0, 510.0, 640.0, 800.0].map(ink_colour), ["#6a1fb0", "#128a63", "#cf222a", "#6e0c1c"]);
    }
}
