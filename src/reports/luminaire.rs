//! The figures and the polar diagram of a luminaire.

use abbe_format::luminaire::{BeamAngles, LuminaireSummary, Photometry};
use abbe_scene::light::{OpeningShape, PhotometricType};
use abbe_session::output::polar::{PolarCurve, PolarDiagram};
use abbe_spectra::colour::ColourReport;
use abbe_spectra::spectrum::Observer;
use serde::Serialize;

/// The names of the two planes of the diagram, and their angles C in degrees.
const PLANES: [(&str, f64); 2] = [("C0–C180", 0.0), ("C90–C270", 90.0)];

/// Returns the polar diagram of the luminous intensity in two planes.
pub fn diagram(summary: &LuminaireSummary) -> PolarDiagram {
    let curve = |(name, c_deg): (&str, f64)| PolarCurve { name: name.to_string(), points: summary.polar_curve(c_deg) };
    PolarDiagram { title: "Luminous intensity".to_string(), unit: "cd".to_string(), curves: PLANES.map(curve).to_vec() }
}

/// Returns the figures as names and values, for people.
pub fn rows(photometry: &Photometry, summary: &LuminaireSummary) -> Vec<(&'static str, String)> {
    let kind = match photometry.kind {
        PhotometricType::C => "C",
        PhotometricType::B => "B",
        PhotometricType::A => "A",
    };
    let (verticals, horizontals) = (photometry.vertical_deg.len(), photometry.horizontal_deg.len());
    let mut rows = vec![
        ("format", format!("{}, type {kind}, {verticals} × {horizontals} angles", photometry.format)),
        ("symmetry", photometry.symmetry.description().to_string()),
        ("flux", format!("{:.1} lm, {:.1} % of it downwards", summary.flux_lm, 100.0 * summary.downward)),
    ];
    if let Some((down, flux_lm)) = pointing_down(photometry, summary) {
        let turned: Vec<String> =
            photometry.tilt.iter().map(|(angle, factor)| format!("{factor} at {angle}°")).collect();
        let tilt =
            format!("factors {}; pointing down, the light is {down} × the table: {flux_lm:.1} lm", turned.join(", "));
        rows.push(("tilt", tilt));
    }
    if let Some(lamps) = photometry.lamp_lumens {
        rows.push(("lamps", format!("{lamps} lm, light output ratio {:.1} %", 100.0 * summary.flux_lm / lamps)));
    }
    let [gamma, c] = summary.peak_deg;
    rows.push(("peak", format!("{:.1} cd at γ {gamma:.1}°, C {c:.1}°", summary.peak_cd)));
    let angles = |angle: fn(&BeamAngles) -> f64| {
        let planes = PLANES.iter().zip(&summary.beams);
        let text = planes.map(|((name, _), beam)| {
            beam.as_ref().map_or_else(|| format!("no light in {name}"), |beam| format!("{:.1}° in {name}", angle(beam)))
        });
        text.collect::<Vec<_>>().join(", ")
    };
    rows.push(("beam angle", angles(|beam| beam.half_deg)));
    rows.push(("field angle", angles(|beam| beam.tenth_deg)));
    if let Some((watts, efficacy)) = photometry.input_watts.zip(summary.efficacy) {
        rows.push(("efficacy", format!("{efficacy:.1} lm/W at {watts} W")));
    }
    if let Some(colour) = light_colour(photometry) {
        let temperature = colour.temperature.map(|it| format!("correlated colour temperature {:.0} K", it.cct_k));
        let rendering = colour.rendering.map(|it| format!("Ra {:.0}", it.ra));
        let [x, y] = colour.xy;
        let parts = [Some(format!("xy {x:.4} {y:.4}")), temperature, rendering];
        rows.push(("spectrum", parts.into_iter().flatten().collect::<Vec<_>>().join(", ")));
    }
    let opening = photometry.opening;
    let shape = match opening.shape {
        OpeningShape::Point => "a point".to_string(),
        OpeningShape::Rectangle => format!("{:.3} m along C0 × {:.3} m", opening.along_c0_m, opening.along_c90_m),
        OpeningShape::Ellipse => {
            format!("an ellipse, {:.3} m along C0 × {:.3} m", opening.along_c0_m, opening.along_c90_m)
        }
    };
    rows.push(("opening", shape));
    rows
}

/// Returns the colour of the light if the file contains its spectrum.
fn light_colour(photometry: &Photometry) -> Option<ColourReport> {
    photometry.spectrum.as_ref().and_then(|spectrum| ColourReport::of_light(spectrum, Observer::cie1931()).ok())
}

/// Returns the tilt factor and the flux in lm of a luminaire with tilt factors that points down.
fn pointing_down(photometry: &Photometry, summary: &LuminaireSummary) -> Option<(f64, f64)> {
    let factor = photometry.tilt_factor(0.0);
    (!photometry.tilt.is_empty()).then_some((factor, factor * summary.flux_lm))
}

/// The figures of a luminaire. Angles are in degrees.
#[derive(Debug, Serialize)]
pub struct LuminaireReport<'a> {
    /// The name in the file, or the path of the file.
    pub name: &'a str,
    /// The format of the file, with its version.
    pub format: &'a str,
    pub symmetry: &'a str,
    /// The luminous flux of the table.
    pub flux_lm: f64,
    /// The flux of a luminaire that points down, if the file has tilt factors.
    pub flux_pointing_down_lm: Option<f64>,
    /// The fraction of the flux in the hemisphere around the photometric axis.
    pub downward: f64,
    /// The flux of the lamps alone.
    pub lamp_lumens: Option<f64>,
    /// The largest intensity.
    pub peak_cd: f64,
    /// The angle of the largest intensity to the photometric axis.
    pub peak_gamma_deg: f64,
    /// The half-plane of the largest intensity.
    pub peak_c_deg: f64,
    /// The beam angles in the planes C0–C180 and C90–C270.
    pub beam_deg: [Option<f64>; 2],
    /// The field angles in the planes C0–C180 and C90–C270.
    pub field_deg: [Option<f64>; 2],
    /// The electrical power in W.
    pub input_watts: Option<f64>,
    /// The flux divided by the electrical power.
    pub efficacy_lm_per_w: Option<f64>,
    /// The chromaticity of the spectrum, if the file contains one.
    pub xy: Option<[f64; 2]>,
    /// The correlated colour temperature of the spectrum in K, if it is defined.
    pub cct_k: Option<f64>,
    /// The general colour rendering index of the spectrum, if it is defined.
    pub ra: Option<f64>,
}

impl<'a> LuminaireReport<'a> {
    /// Returns the figures of a photometric table and its summary.
    pub fn new(name: &'a str, photometry: &'a Photometry, summary: &LuminaireSummary) -> Self {
        let colour = light_colour(photometry);
        Self {
            name,
            format: &photometry.format,
            symmetry: photometry.symmetry.description(),
            flux_lm: summary.flux_lm,
            flux_pointing_down_lm: pointing_down(photometry, summary).map(|(_, flux_lm)| flux_lm),
            downward: summary.downward,
            lamp_lumens: photometry.lamp_lumens,
            peak_cd: summary.peak_cd,
            peak_gamma_deg: summary.peak_deg[0],
            peak_c_deg: summary.peak_deg[1],
            beam_deg: summary.beams.map(|beam| beam.map(|beam| beam.half_deg)),
            field_deg: summary.beams.map(|beam| beam.map(|beam| beam.tenth_deg)),
            input_watts: photometry.input_watts,
            efficacy_lm_per_w: summary.efficacy,
            xy: colour.as_ref().map(|colour| colour.xy),
            cct_k: colour.as_ref().and_then(|colour| colour.temperature).map(|temperature| temperature.cct_k),
            ra: colour.as_ref().and_then(|colour| colour.rendering.as_ref()).map(|rendering| rendering.ra),
        }
    }
}
