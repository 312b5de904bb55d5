//! The plots of a lens.

use abbe_optics::lens::axial_colour::AxialColour;
use abbe_optics::lens::field_curves::FieldCurves;
use abbe_optics::lens::mtf::{MtfCurve, MtfCurves, ThroughFocusMtf};
use abbe_optics::lens::ray_fans::FanCurves;
use abbe_optics::lens::spot_diagram::SpotDiagram;
use abbe_optics::lens::{AnalysisLine, Lens, LensAnalysis};
use abbe_session::output::plot_grid::{GridPlot, LegendEntry, LineDash, PlotGrid, PlotLine, PlotRange};
use abbe_session::output::spot_figure::{SpotCell, SpotFigure, SpotPoints, SpotRow};
use abbe_spectra::error::{Error, Result};

use super::lens::{drawing, line_colour, line_name};

/// A plot of a lens. The help text of `abbe lens --plot` describes the plots in these words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum LensPlot {
    /// The cross-section with rays at two fields, and magnified foci
    Section,
    /// Spot diagrams per field and wavelength
    Spots,
    /// Ray fans, tangential and sagittal
    RayFans,
    /// MTF against spatial frequency
    Mtf,
    /// MTF against the position of the sensor
    ThroughFocus,
    /// Field curvature (S and T) and distortion
    FieldCurves,
    /// Lateral colour against the field
    LateralColour,
    /// Relative illumination against the field
    Illumination,
    /// Longitudinal aberration, and focus against wavelength
    AxialColour,
}

impl LensPlot {
    /// All plots with their names, which are those of `abbe lens --plot`.
    pub const ALL: [(&'static str, Self); 9] = [
        ("section", Self::Section),
        ("spots", Self::Spots),
        ("ray-fans", Self::RayFans),
        ("mtf", Self::Mtf),
        ("through-focus", Self::ThroughFocus),
        ("field-curves", Self::FieldCurves),
        ("lateral-colour", Self::LateralColour),
        ("illumination", Self::Illumination),
        ("axial-colour", Self::AxialColour),
    ];

    /// Returns the plot with a name. Returns an error that lists all names for another one.
    pub fn by_name(name: &str) -> Result<Self> {
        let names = || Self::ALL.iter().map(|(name, _)| *name);
        let unknown = || {
            let expected = format!("one of {}", names().collect::<Vec<_>>().join(", "));
            Error::unknown_name("plot", name, names()).expected(expected)
        };
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, plot)| *plot).ok_or_else(unknown)
    }
}

const BLACK: &str = "#1b1b1b";
const GREY: &str = "#888888";
/// The colours of the fields, from the axis to the edge.
const FIELD_COLOURS: [&str; 4] = ["#1b1b1b", "#1e8449", "#8e44ad", "#ba4a00"];
/// The width of one plot of two in a row, and the heights of plots and of ray fans.
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 325.0;
const FAN_HEIGHT: f64 = 205.0;

/// Returns a plot as an SVG document that contains the name of the lens. Returns an error if no
/// light passes at one of the fields.
pub fn svg(plot: LensPlot, lens: &Lens, analysis: &LensAnalysis) -> Result<String> {
    let titled = |what: &str| format!("{}: {what}", lens.name());
    let grid = |what: &str, grids: Vec<PlotGrid>| PlotGrid::beside(titled(what), grids).svg();
    let curves = || FieldCurves::of(lens, analysis);
    Ok(match plot {
        LensPlot::Section => drawing(lens, analysis)?.svg(),
        LensPlot::Spots => SpotFigure { title: titled("spot diagrams"), ..spots(lens, analysis)? }.svg(),
        LensPlot::RayFans => PlotGrid { title: titled("ray fans"), ..ray_fans(lens, analysis)? }.svg(),
        LensPlot::Mtf => grid("MTF", vec![mtf(lens, analysis)?]),
        LensPlot::ThroughFocus => grid("MTF through focus", vec![through_focus(lens, analysis)?]),
        LensPlot::FieldCurves => {
            let curves = curves()?;
            let both = vec![field_curvature(analysis, &curves), distortion(&curves)];
            grid("field curvature and distortion", both)
        }
        LensPlot::LateralColour => grid("lateral colour", vec![lateral_colour(analysis, &curves()?)]),
        LensPlot::Illumination => grid("relative illumination", vec![illumination(&curves()?)]),
        LensPlot::AxialColour => {
            let axial = AxialColour::of(lens, analysis)?;
            let both = vec![longitudinal(analysis, &axial), focal_shift(analysis, &axial)];
            grid("longitudinal aberration and chromatic focal shift", both)
        }
    })
}

fn line(colour: &str, dash: LineDash, points: impl Iterator<Item = (f64, f64)>) -> PlotLine {
    PlotLine { colour: colour.to_string(), dash, points: points.collect() }
}

fn entry(name: impl Into<String>, colour: impl Into<String>, dash: LineDash) -> LegendEntry {
    LegendEntry { name: name.into(), colour: colour.into(), dash }
}

fn line_entries(lines: &[AnalysisLine]) -> Vec<LegendEntry> {
    lines.iter().map(|line| entry(line_name(line), line_colour(line), LineDash::Solid)).collect()
}

fn plane_entries() -> [LegendEntry; 2] {
    [entry("tangential (T)", GREY, LineDash::Solid), entry("sagittal (S)", GREY, LineDash::Dashed)]
}

fn single(legend: Vec<LegendEntry>, plot: GridPlot) -> PlotGrid {
    PlotGrid { title: String::new(), legend, columns: 1, cell: (WIDTH, HEIGHT), plots: vec![plot] }
}

/// Returns the spot diagrams: a row per field, and a column per wavelength and for all of them.
pub(super) fn spots(lens: &Lens, analysis: &LensAnalysis) -> Result<SpotFigure> {
    Ok(spot_figure(analysis.conditions.lines(), &SpotDiagram::of(lens, analysis)?, "°"))
}

/// Draws spot diagrams of fields in a unit.
pub(super) fn spot_figure(lines: &[AnalysisLine], diagrams: &[SpotDiagram], unit: &str) -> SpotFigure {
    let row = |spot: &SpotDiagram| {
        let points =
            |i: usize| SpotPoints { colour: line_colour(&lines[i]), points_mm: spot.lines[i].points_mm.clone() };
        let one = |i: usize| SpotCell {
            caption: format!("RMS {:.2} µm", 1e3 * spot.lines[i].rms_mm),
            spots: vec![points(i)],
        };
        let all = SpotCell {
            caption: format!("RMS {:.2} µm", 1e3 * spot.rms_mm),
            spots: (0..lines.len()).map(points).collect(),
        };
        let cells = (0..lines.len()).map(one).chain((lines.len() > 1).then_some(all));
        SpotRow {
            labels: vec![
                format!("{:.2}{unit}", spot.angle_deg),
                format!("{} mm", number(spot.centroid_mm, 3)),
                "largest radius".to_string(),
                format!("{:.2} µm", 1e3 * spot.largest_mm),
            ],
            cells: cells.collect(),
        }
    };
    SpotFigure {
        title: String::new(),
        columns: lines.iter().map(line_name).chain((lines.len() > 1).then(|| "all".to_string())).collect(),
        circle_mm: diagrams.first().map_or(0.0, |spot| spot.airy_mm),
        rows: diagrams.iter().map(row).collect(),
    }
}

/// Returns the ray fans: a row per field, with the tangential fan on the left.
pub(super) fn ray_fans(lens: &Lens, analysis: &LensAnalysis) -> Result<PlotGrid> {
    Ok(fan_grid(analysis.conditions.lines(), &FanCurves::of(lens, analysis)?, "°"))
}

/// Draws the ray fans of fields in a unit.
pub(super) fn fan_grid(lines: &[AnalysisLine], fans: &[FanCurves], unit: &str) -> PlotGrid {
    let all = fans.iter().flat_map(|fan| fan.tangential_mm.iter().chain(&fan.sagittal_mm)).flatten().flatten();
    let end_um = round_above(1e3 * all.fold(1e-6_f64, |most, mm| most.max(mm.abs())));
    let plot = |fan: &FanCurves, name: &str, values: &[Vec<Option<f64>>], pupil: &str, image: &str| {
        let curve = |(line_of, values): (&AnalysisLine, &Vec<Option<f64>>)| {
            let um = values.iter().map(|value| value.map_or(f64::NAN, |mm| 1e3 * mm));
            line(&line_colour(line_of), LineDash::Solid, fan.pupil.iter().copied().zip(um))
        };
        GridPlot {
            title: format!("{:.2}{unit}, {name}", fan.angle_deg),
            across: pupil.to_string(),
            up: image.to_string(),
            across_range: PlotRange::Between(-1.0, 1.0),
            up_range: PlotRange::Between(-end_um, end_um),
            marks: Vec::new(),
            lines: lines.iter().zip(values).map(curve).collect(),
        }
    };
    let both = |fan: &FanCurves| {
        [
            plot(fan, "tangential", &fan.tangential_mm, "height in the entrance pupil along y", "aberration εy in µm"),
            plot(fan, "sagittal", &fan.sagittal_mm, "height in the entrance pupil along x", "aberration εx in µm"),
        ]
    };
    let plots = fans.iter().flat_map(both).collect();
    let legend = line_entries(lines);
    PlotGrid { title: String::new(), legend, columns: 2, cell: (WIDTH, FAN_HEIGHT), plots }
}

/// Returns the next of some round numbers above a positive number.
fn round_above(value: f64) -> f64 {
    let decade = 10.0_f64.powi(abbe_spectra::math::elementary::log10(value).floor() as i32);
    let digits = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0];
    digits.map(|digit| digit * decade).into_iter().find(|round| *round >= value).unwrap_or(value)
}

fn field_legend(fields: &[MtfCurve]) -> Vec<LegendEntry> {
    let names = fields.iter().zip(FIELD_COLOURS);
    let entries = names.map(|(field, colour)| entry(format!("{:.2}°", field.angle_deg), colour, LineDash::Solid));
    entries.chain(plane_entries()).collect()
}

fn contrast_lines(fields: &[MtfCurve], across: &[f64]) -> Vec<PlotLine> {
    let both = |(field, colour): (&MtfCurve, &str)| {
        let curve = |dash, values: &[f64]| line(colour, dash, across.iter().copied().zip(values.iter().copied()));
        [curve(LineDash::Dashed, &field.sagittal), curve(LineDash::Solid, &field.tangential)]
    };
    fields.iter().zip(FIELD_COLOURS).flat_map(both).collect()
}

/// Returns the MTF against spatial frequency.
pub(super) fn mtf(lens: &Lens, analysis: &LensAnalysis) -> Result<PlotGrid> {
    Ok(mtf_grid(&MtfCurves::of(lens, analysis)?))
}

/// Draws the MTF of fields in degrees.
pub(super) fn mtf_grid(curves: &MtfCurves) -> PlotGrid {
    let mut legend = field_legend(&curves.fields);
    legend.push(entry("diffraction limit", GREY, LineDash::Dotted));
    let limit = curves.per_mm.iter().copied().zip(curves.diffraction_limit.iter().copied());
    let lines = std::iter::once(line(GREY, LineDash::Dotted, limit));
    let plot = GridPlot {
        title: "MTF against spatial frequency".to_string(),
        across: "spatial frequency in cycles/mm".to_string(),
        up: "MTF".to_string(),
        across_range: PlotRange::Between(0.0, curves.per_mm.last().copied().unwrap_or(1.0)),
        up_range: PlotRange::Between(0.0, 1.0),
        marks: Vec::new(),
        lines: lines.chain(contrast_lines(&curves.fields, &curves.per_mm)).collect(),
    };
    single(legend, plot)
}

/// Returns the MTF against the position of the sensor.
pub(super) fn through_focus(lens: &Lens, analysis: &LensAnalysis) -> Result<PlotGrid> {
    let curves = ThroughFocusMtf::of(lens, analysis)?;
    let mut legend = field_legend(&curves.fields);
    legend.push(entry("diffraction limit", GREY, LineDash::Dotted));
    let end_mm = curves.shifts_mm.last().copied().unwrap_or(1.0);
    let best_mm = analysis.best_focus_shift_mm - analysis.focus_shift_mm;
    // A mark at the sensor itself would hide its axis.
    let marks = (best_mm.abs() > 0.02 * end_mm).then(|| (best_mm, "best focus".to_string()));
    let limit = line(GREY, LineDash::Dotted, [-end_mm, end_mm].map(|mm| (mm, curves.diffraction_limit)).into_iter());
    let plot = GridPlot {
        title: format!("MTF at {} cycles/mm through focus", curves.per_mm),
        across: "distance from the sensor in mm".to_string(),
        up: "MTF".to_string(),
        across_range: PlotRange::Between(-end_mm, end_mm),
        up_range: PlotRange::Between(0.0, 1.0),
        marks: marks.into_iter().collect(),
        lines: std::iter::once(limit).chain(contrast_lines(&curves.fields, &curves.shifts_mm)).collect(),
    };
    Ok(single(legend, plot))
}

/// Returns a plot whose vertical axis is the field angle.
fn over_field(
    title: &str,
    across: &str,
    across_range: PlotRange,
    curves: &FieldCurves,
    lines: Vec<PlotLine>,
) -> GridPlot {
    GridPlot {
        title: title.to_string(),
        across: across.to_string(),
        up: "field angle in °".to_string(),
        across_range,
        up_range: PlotRange::Between(0.0, curves.angles_deg.last().copied().unwrap_or(1.0)),
        marks: Vec::new(),
        lines,
    }
}

/// Returns the field curvature.
pub(super) fn field_curvature(analysis: &LensAnalysis, curves: &FieldCurves) -> PlotGrid {
    let some = |lines: &[Vec<f64>]| -> Vec<Vec<Option<f64>>> {
        lines.iter().map(|line| line.iter().copied().map(Some).collect()).collect()
    };
    let planes = [some(&curves.sagittal_mm), some(&curves.tangential_mm)];
    let lines = analysis.conditions.lines();
    foci_grid(lines, "field angle in °", &curves.angles_deg, planes.each_ref().map(Vec::as_slice))
}

/// Draws the sagittal and the tangential foci in mm of each wavelength against fields in order.
pub(super) fn foci_grid(
    lines: &[AnalysisLine],
    field: &str,
    fields: &[f64],
    planes: [&[Vec<Option<f64>>]; 2],
) -> PlotGrid {
    let both = |i: usize| {
        let curve = |(dash, plane): (LineDash, &[Vec<Option<f64>>])| {
            let mm = plane[i].iter().map(|mm| mm.unwrap_or(f64::NAN));
            line(&line_colour(&lines[i]), dash, mm.zip(fields.iter().copied()))
        };
        [LineDash::Dashed, LineDash::Solid].into_iter().zip(planes).map(curve).collect::<Vec<_>>()
    };
    let plot = GridPlot {
        title: "field curvature".to_string(),
        across: "focus from the sensor in mm".to_string(),
        up: field.to_string(),
        across_range: PlotRange::WithZero,
        up_range: PlotRange::Between(
            fields.first().copied().unwrap_or(0.0).min(0.0),
            fields.last().copied().unwrap_or(1.0),
        ),
        marks: Vec::new(),
        lines: (0..lines.len()).flat_map(both).collect(),
    };
    single(line_entries(lines).into_iter().chain(plane_entries()).collect(), plot)
}

/// Returns the distortion.
pub(super) fn distortion(curves: &FieldCurves) -> PlotGrid {
    let percent = curves.distortion.iter().map(|fraction| 100.0 * fraction);
    let line = line(BLACK, LineDash::Solid, percent.zip(curves.angles_deg.iter().copied()));
    single(Vec::new(), over_field("distortion", "distortion in %", PlotRange::WithZero, curves, vec![line]))
}

/// Returns the lateral colour with the radius of the Airy disk.
pub(super) fn lateral_colour(analysis: &LensAnalysis, curves: &FieldCurves) -> PlotGrid {
    let conditions = &analysis.conditions;
    let reference = &conditions.lines()[conditions.reference()];
    let airy_um = 1.22e-3 * reference.nm * analysis.paraxial.f_number.unwrap_or(0.0);
    let end = curves.angles_deg.last().copied().unwrap_or(1.0);
    let airy = [-airy_um, airy_um].map(|um| line(GREY, LineDash::Dotted, [(um, 0.0), (um, end)].into_iter()));
    let curve = |(line_of, mm): (&AnalysisLine, &Vec<f64>)| {
        let um = mm.iter().map(|mm| 1e3 * mm);
        line(&line_colour(line_of), LineDash::Solid, um.zip(curves.angles_deg.iter().copied()))
    };
    let lines = airy.into_iter().chain(conditions.lines().iter().zip(&curves.lateral_colour_mm).map(curve));
    let across = format!("height minus that of {} in µm", short_name(reference));
    let plot = over_field("lateral colour", &across, PlotRange::Symmetric, curves, lines.collect());
    let mut legend = line_entries(conditions.lines());
    legend.push(entry("radius of the Airy disk", GREY, LineDash::Dotted));
    single(legend, plot)
}

/// Returns a number with the minus sign of typography.
pub(super) fn number(value: f64, decimals: usize) -> String {
    signed(value, decimals).trim_start_matches('+').to_string()
}

/// Returns a number with its sign, unless all of its decimals are 0.
pub(super) fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    let is_zero = text.chars().all(|c| !c.is_ascii_digit() || c == '0');
    if is_zero { text[1..].to_string() } else { text.replace('-', "−") }
}

/// Returns a wavelength as a word: `d`, or `550 nm`.
pub(super) fn short_name(line: &AnalysisLine) -> String {
    if line.name.parse::<f64>().is_ok() { format!("{} nm", line.nm) } else { line.name.to_string() }
}

/// Returns the relative illumination, and the fourth power of the cosine for comparison.
pub(super) fn illumination(curves: &FieldCurves) -> PlotGrid {
    let percent = curves.relative_illumination.iter().map(|fraction| 100.0 * fraction);
    let fourth = |angle: &f64| (*angle, 100.0 * abbe_spectra::math::elementary::cos(angle.to_radians()).powi(4));
    let plot = GridPlot {
        title: "relative illumination".to_string(),
        across: "field angle in °".to_string(),
        up: "illuminance relative to the axis in %".to_string(),
        across_range: PlotRange::Between(0.0, curves.angles_deg.last().copied().unwrap_or(1.0)),
        up_range: PlotRange::WithZero,
        marks: Vec::new(),
        lines: vec![
            line(GREY, LineDash::Dotted, curves.angles_deg.iter().map(fourth)),
            line(BLACK, LineDash::Solid, curves.angles_deg.iter().copied().zip(percent)),
        ],
    };
    let legend = vec![
        entry("relative illumination", BLACK, LineDash::Solid),
        entry("cos⁴ of the field angle", GREY, LineDash::Dotted),
    ];
    single(legend, plot)
}

/// Returns the longitudinal aberration.
pub(super) fn longitudinal(analysis: &LensAnalysis, axial: &AxialColour) -> PlotGrid {
    let lines = analysis.conditions.lines();
    let curve = |(line_of, mm): (&AnalysisLine, &Vec<Option<f64>>)| {
        let mm = mm.iter().map(|mm| mm.unwrap_or(f64::NAN));
        line(&line_colour(line_of), LineDash::Solid, mm.zip(axial.pupil.iter().copied()))
    };
    let plot = GridPlot {
        title: "longitudinal aberration on the axis".to_string(),
        across: "focus from the sensor in mm".to_string(),
        up: "height in the entrance pupil".to_string(),
        across_range: PlotRange::WithZero,
        up_range: PlotRange::Between(0.0, 1.0),
        marks: Vec::new(),
        lines: lines.iter().zip(&axial.longitudinal_mm).map(curve).collect(),
    };
    single(line_entries(lines), plot)
}

/// Returns the chromatic focal shift.
pub(super) fn focal_shift(analysis: &LensAnalysis, axial: &AxialColour) -> PlotGrid {
    let lines = analysis.conditions.lines();
    let shift = axial.nm.iter().copied().zip(axial.focal_shift_mm.iter().copied());
    let ends = [axial.nm.first(), axial.nm.last()].map(|nm| nm.copied().unwrap_or_default());
    let reference = short_name(&lines[analysis.conditions.reference()]);
    let plot = GridPlot {
        title: format!("chromatic focal shift from {reference}"),
        across: "wavelength in nm".to_string(),
        up: "focal shift in mm".to_string(),
        across_range: PlotRange::Between(ends[0], ends[1]),
        up_range: PlotRange::WithZero,
        marks: lines.iter().map(|line| (line.nm, line.name.to_string())).collect(),
        lines: vec![line(BLACK, LineDash::Solid, shift)],
    };
    single(Vec::new(), plot)
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn plots_have_the_names_of_the_command_line() {
        let names: Vec<String> = LensPlot::value_variants()
            .iter()
            .map(|plot| plot.to_possible_value().unwrap().get_name().to_owned())
            .collect();
        assert_eq!(names, LensPlot::ALL.map(|(name, _)| name));
        assert!(LensPlot::value_variants().iter().zip(LensPlot::ALL).all(|(plot, (_, same))| *plot == same));
        assert_eq!(LensPlot::by_name("mtf").unwrap(), LensPlot::Mtf);
        let error = LensPlot::by_name("spot").unwrap_err();
        assert_eq!(error.suggestion.as_deref(), Some("spots"));
    }
}
