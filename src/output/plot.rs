//! Plots over wavelength as SVG.

use std::fmt::Write;

use crate::colour::{srgb_hex, xyz_to_linear_srgb};
use crate::spectrum::{BAND_NM, Observer, Spectrum};

/// A curve over wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What it shows, for the legend.
    pub name: String,
    /// Wavelength in nm and value, in the order of the wavelengths.
    pub points: Vec<(f64, f64)>,
}

/// A plot of functions of wavelength, with the colours of the spectrum along its axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// The title.
    pub title: String,
    /// Quantity and unit of the values.
    pub values: String,
    /// The curves; the first is drawn strongest.
    pub curves: Vec<Curve>,
    /// Spectral lines: wavelength in nm, and height as a share of the plot's.
    pub lines: Vec<(f64, f64)>,
    /// Whether the axis of values starts at 0 whatever the curves' least value is.
    pub from_zero: bool,
}

const SIZE: (f64, f64) = (840.0, 480.0);
const LEFT: f64 = 84.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 52.0;
const BOTTOM: f64 = 84.0;
/// The strip of spectral colours below the axis.
const STRIP: f64 = 14.0;
const COLOURS: [&str; 4] = ["#1b1b1b", "#c0392b", "#2471a3", "#1e8449"];

impl Plot {
    /// A spectrum over the band: its continuum as a curve, its lines as strokes as high as their share of the
    /// strongest one's power. `density` is the quantity and unit of the continuum, `power` that of a line where there
    /// is one.
    pub fn of_spectrum(title: &str, spectrum: &Spectrum, density: &str, power: Option<&str>) -> Self {
        let lines = spectrum.line_segments();
        let strongest = lines.iter().map(|line| line.power).fold(0.0, f64::max);
        let nm = (0..=(BAND_NM.1 - BAND_NM.0) as u32).map(|i| BAND_NM.0 + f64::from(i));
        let points: Vec<(f64, f64)> = nm.map(|nm| (nm, spectrum.continuum_at(nm))).collect();
        let has_continuum = lines.is_empty() || points.iter().any(|point| point.1 > 0.0);
        let values = match (lines.is_empty(), has_continuum, power) {
            (true, ..) => density.to_string(),
            (false, true, Some(unit)) => format!("{density}; tallest line {strongest:.3} {unit}"),
            (false, true, None) => format!("{density}; lines: power relative to the tallest"),
            (false, false, Some(unit)) => format!("line power; 1 is {strongest:.3} {unit}"),
            (false, false, None) => "line power, relative to the tallest".to_string(),
        };
        Self {
            title: title.to_string(),
            values,
            curves: if has_continuum { vec![Curve { name: "continuum".to_string(), points }] } else { Vec::new() },
            lines: lines.iter().map(|line| (line.centre(), line.power / strongest)).collect(),
            from_zero: true,
        }
    }

    /// The plot as a file that needs no other. Points that are not finite interrupt their curve.
    pub fn svg(&self) -> String {
        let frame = Frame::of(self);
        let (width, height) = SIZE;
        let mut svg = format!(
            "<svg class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"system-ui, sans-serif\" font-size=\"14\" fill=\"#222\">\n\
             <rect class=\"paper\" width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <text x=\"{LEFT}\" y=\"30\" font-size=\"18\">{}</text>\n",
            escaped(&self.title)
        );
        svg += &strip(&frame);
        svg += &axes(&frame, &self.values);
        if let Some(curve) = self.curves.first().filter(|_| self.from_zero) {
            svg += &area(&frame, &curve.points);
        }
        for &(nm, share) in &self.lines {
            let (x, foot) = (frame.x(nm), height - BOTTOM);
            let top = foot - share * (foot - TOP);
            let colour = spectral_colour(nm);
            append(
                &mut svg,
                format_args!("<path d=\"M{x:.2} {foot}V{top:.2}\" stroke=\"{colour}\" stroke-width=\"2\"/>\n"),
            );
        }
        for (i, curve) in self.curves.iter().enumerate().rev() {
            let colour = COLOURS[i % COLOURS.len()];
            let path = path(&frame, &curve.points);
            let style = "fill=\"none\" stroke-width=\"2\" stroke-linejoin=\"round\"";
            append(&mut svg, format_args!("<path class=\"curve{i}\" d=\"{path}\" {style} stroke=\"{colour}\"/>\n"));
        }
        svg += &self.legend();
        svg += "</svg>\n";
        svg
    }

    /// The curves' names, where there are several.
    fn legend(&self) -> String {
        let mut svg = String::new();
        if self.curves.len() < 2 {
            return svg;
        }
        for (i, curve) in self.curves.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            let (x, y) = (SIZE.0 - RIGHT - 12.0, TOP + 20.0 + 20.0 * i as f64);
            let name = escaped(&curve.name);
            append(
                &mut svg,
                format_args!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>\n"),
            );
        }
        svg
    }
}

/// What the axes span.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    least: f64,
    most: f64,
    /// Distance of the value axis's ticks.
    step: f64,
}

impl Frame {
    fn of(plot: &Plot) -> Self {
        let values = plot.curves.iter().flat_map(|curve| &curve.points).map(|point| point.1).filter(|v| v.is_finite());
        let (mut least, mut most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if plot.from_zero || least > most {
            (least, most) = (least.min(0.0), most.max(0.0));
        }
        if most - least <= 1e-12 * most.abs().max(least.abs()) {
            // Nothing to see in height: show the level in the middle, or up to 1 where all is 0.
            let room = if most == 0.0 { 1.0 } else { 0.1 * most.abs() };
            (least, most) = (if plot.from_zero { least.min(0.0) } else { least - room }, most + room);
        }
        let step = nice_step((most - least) / 6.0);
        Self { least: (least / step).floor() * step, most: (most / step).ceil() * step, step }
    }

    fn x(&self, nm: f64) -> f64 {
        LEFT + (nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0) * (SIZE.0 - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        SIZE.1 - BOTTOM - (value - self.least) / (self.most - self.least) * (SIZE.1 - TOP - BOTTOM)
    }
}

/// The step of 1, 2 or 5 times a power of ten that is nearest above.
fn nice_step(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|nice| *nice >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// A tick's number with as many digits as the step needs, and a power of ten where the axis is far from 1.
fn tick(value: f64, frame: &Frame) -> String {
    let largest = frame.most.abs().max(frame.least.abs());
    let exponent = if (1e-2..1e5).contains(&largest) { 0 } else { largest.log10().floor() as i32 };
    let unit = 10.0_f64.powi(exponent);
    let decimals = (-(frame.step / unit * (1.0 + 1e-9)).log10().floor()).clamp(0.0, 9.0) as usize;
    // No sign before a zero that came out of a subtraction.
    let is_zero = value.abs() < frame.step / 2.0;
    let number = format!("{:.decimals$}", if is_zero { 0.0 } else { value / unit });
    if exponent == 0 || is_zero { number } else { format!("{number}e{exponent}") }
}

fn axes(frame: &Frame, values: &str) -> String {
    let mut svg = String::new();
    let (right, foot) = (SIZE.0 - RIGHT, SIZE.1 - BOTTOM);
    let count = ((frame.most - frame.least) / frame.step).round() as usize;
    for i in 0..=count {
        let value = frame.least + i as f64 * frame.step;
        let y = frame.y(value);
        append(&mut svg, format_args!("<path class=\"rule\" d=\"M{LEFT} {y:.2}H{right}\" stroke=\"#ddd\"/>\n"));
        let (x, y, label) = (LEFT - 8.0, y + 5.0, tick(value, frame));
        append(&mut svg, format_args!("<text x=\"{x}\" y=\"{y:.2}\" text-anchor=\"end\">{label}</text>\n"));
    }
    for nm in (400..=800).step_by(50) {
        let (x, top, y) = (frame.x(f64::from(nm)), foot + STRIP, foot + STRIP + 22.0);
        append(&mut svg, format_args!("<path class=\"ink\" d=\"M{x:.2} {top}v5\" stroke=\"#222\"/>\n"));
        append(&mut svg, format_args!("<text x=\"{x:.2}\" y=\"{y}\" text-anchor=\"middle\">{nm}</text>\n"));
    }
    let frame = format!("d=\"M{LEFT} {TOP}V{foot}H{right}\" fill=\"none\"");
    append(&mut svg, format_args!("<path class=\"ink\" {frame} stroke=\"#222\"/>\n"));
    let (x, y) = (0.5 * (LEFT + right), SIZE.1 - 18.0);
    append(&mut svg, format_args!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">wavelength in nm</text>\n"));
    let (y, label) = (0.5 * (TOP + foot), escaped(values));
    let turned = format!("transform=\"rotate(-90 20 {y})\"");
    append(&mut svg, format_args!("<text x=\"20\" y=\"{y}\" text-anchor=\"middle\" {turned}>{label}</text>\n"));
    svg
}

/// The colours of the spectrum along the axis.
fn strip(frame: &Frame) -> String {
    let (from, to) = (frame.x(BAND_NM.0), frame.x(BAND_NM.1));
    let place = format!("gradientUnits=\"userSpaceOnUse\" x1=\"{from}\" x2=\"{to}\"");
    let mut svg = format!("<defs><linearGradient id=\"spectrum\" {place}>\n");
    for nm in (BAND_NM.0 as u32..=BAND_NM.1 as u32).step_by(10).map(f64::from) {
        let (share, colour) = ((nm - BAND_NM.0) / (BAND_NM.1 - BAND_NM.0), spectral_colour(nm));
        append(&mut svg, format_args!("<stop offset=\"{share:.4}\" stop-color=\"{colour}\"/>\n"));
    }
    let (y, width) = (SIZE.1 - BOTTOM, to - from);
    let place = format!("x=\"{from}\" y=\"{y}\" width=\"{width}\" height=\"{STRIP}\"");
    append(&mut svg, format_args!("</linearGradient></defs>\n<rect {place} fill=\"url(#spectrum)\"/>\n"));
    svg
}

/// How a wavelength is shown: its colour with just enough white added that sRGB holds it, as bright as can be, and
/// darker towards the ends of what an eye sees. (Keeping the luminance instead would leave violet all but black.)
fn spectral_colour(nm: f64) -> String {
    let bar = Observer::cie1931().xyz_bar(nm);
    let linear = xyz_to_linear_srgb(bar);
    let white = linear.into_iter().fold(0.0, |white: f64, component| white.max(-component));
    let brightest = white + linear.into_iter().fold(0.0, f64::max);
    if brightest <= 0.0 {
        return "#000000".to_string();
    }
    let seen = (bar.iter().sum::<f64>() / 0.5).min(1.0).powf(0.5);
    srgb_hex(linear.map(|component| (component + white) / brightest * seen))
}

/// A curve's path; it is interrupted where a value is not finite.
fn path(frame: &Frame, points: &[(f64, f64)]) -> String {
    let mut path = String::new();
    let mut command = 'M';
    for &(nm, value) in points {
        if value.is_finite() && nm.is_finite() {
            append(&mut path, format_args!("{command}{:.2} {:.2}", frame.x(nm), frame.y(value)));
            command = 'L';
        } else {
            command = 'M';
        }
    }
    path
}

/// What lies between a curve and zero, in the colours of the spectrum; nothing where the curve is interrupted.
fn area(frame: &Frame, points: &[(f64, f64)]) -> String {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return String::new() };
    if !points.iter().all(|(nm, value)| nm.is_finite() && value.is_finite()) {
        return String::new();
    }
    let (path, foot) = (path(frame, points), frame.y(0.0));
    let (from, to) = (frame.x(first.0), frame.x(last.0));
    format!("<path d=\"{path}L{to:.2} {foot:.2}H{from:.2}Z\" fill=\"url(#spectrum)\" fill-opacity=\"0.45\"/>\n")
}

pub(super) fn append(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("writing to a string cannot fail");
}

/// Text inside XML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<(f64, f64)>, from_zero: bool) -> Plot {
        let curves = vec![Curve { name: "a & b".to_string(), points }];
        Plot { title: "<D65>".to_string(), values: "power".to_string(), curves, lines: Vec::new(), from_zero }
    }

    #[test]
    fn axes_end_at_round_numbers_that_hold_all_values() {
        let frame = Frame::of(&plot(vec![(400.0, 0.13), (500.0, 0.87)], false));
        assert_eq!((frame.step, frame.least, frame.most), (0.2, 0.0, 1.0));
        let index = Frame::of(&plot(vec![(400.0, 1.5133), (800.0, 1.5308)], false));
        assert!(index.least <= 1.5133 && index.most >= 1.5308 && index.most - index.least < 0.03, "{index:?}");
        let zero = Frame::of(&plot(vec![(400.0, 0.0)], true));
        assert!(zero.least == 0.0 && zero.most >= 1.0);
        let level = Frame::of(&plot(vec![(400.0, 0.5), (800.0, 0.5)], true));
        assert!(level.least == 0.0 && level.most >= 0.5);
        let nothing = Frame::of(&plot(vec![(400.0, f64::NAN)], false));
        assert!(nothing.least.is_finite() && nothing.most > nothing.least, "{nothing:?}");
    }

    #[test]
    fn spectra_are_labelled_for_what_they_hold() {
        let line = |nm, power| crate::spectrum::SpectralLine { nm, power, fwhm_nm: None };
        let lines = Spectrum::lines(&[line(500.0, 2.0), line(600.0, 4.0)]).unwrap();
        let (smooth, mixed) =
            (Spectrum::constant(0.5), Spectrum::mix(&[(0.5, &lines), (1.0, &Spectrum::constant(0.5))]));
        let values = |spectrum: &Spectrum, power| Plot::of_spectrum("", spectrum, "W/nm", power).values;
        assert_eq!(values(&smooth, Some("W")), "W/nm");
        assert_eq!(values(&lines, Some("W")), "line power; 1 is 4.000 W");
        assert_eq!(values(&mixed, Some("W")), "W/nm; tallest line 2.000 W");
        assert_eq!(values(&lines, None), "line power, relative to the tallest");
        let plot = Plot::of_spectrum("", &mixed, "W/nm", None);
        assert_eq!(plot.lines.iter().map(|line| line.1).collect::<Vec<_>>(), [0.5, 1.0]);
        assert!(plot.svg().contains("fill-opacity") && Plot::of_spectrum("", &lines, "W/nm", None).curves.is_empty());
    }

    #[test]
    fn steps_and_ticks_are_short() {
        assert_eq!([0.11, 0.2, 3.0, 7.0].map(nice_step), [0.2, 0.2, 5.0, 10.0]);
        let tick = |value: f64, step: f64, most: f64| tick(value, &Frame { least: 0.0, most, step });
        assert_eq!(tick(0.30000000000000004, 0.1, 0.6), "0.3");
        assert_eq!(tick(-1e-17, 0.1, 0.6), "0.0");
        assert_eq!(tick(1.525, 0.005, 1.53), "1.525");
        assert_eq!(tick(2e13, 1e13, 6e13), "2e13");
        assert_eq!([5e-5, 2e-4].map(|value| tick(value, 5e-5, 2e-4)), ["0.5e-4", "2.0e-4"]);
    }

    #[test]
    fn the_file_is_well_formed_and_names_are_escaped() {
        let svg = plot(vec![(400.0, 1.0), (500.0, f64::NAN), (600.0, 2.0)], true).svg();
        assert!(svg.contains("&lt;D65&gt;") && !svg.contains("<D65>"));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn wavelengths_have_the_colours_that_everybody_knows() {
        let component = |nm: f64, c: usize| u8::from_str_radix(&spectral_colour(nm)[1 + 2 * c..3 + 2 * c], 16).unwrap();
        let strongest = |nm: f64| (0..3).max_by_key(|&c| component(nm, c)).unwrap();
        assert_eq!([650.0, 530.0, 450.0].map(strongest), [0, 1, 2]);
        assert!(component(360.0, 2) < component(430.0, 2), "the ends fade");
    }
}
