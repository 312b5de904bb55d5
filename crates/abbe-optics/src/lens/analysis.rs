//! The usual figures of a lens design: focal lengths, distortion, colour errors and spots.

use super::field::LensSpot;
use super::paraxial::Paraxial;
use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, MonochromaticLens};
use crate::glass::lines;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::tan;

/// The spectral lines of the analysis: name and wavelength in nm.
pub const LINES: [(&str, f64); 3] = [("F", lines::F_NM), ("d", lines::D_NM), ("C", lines::C_NM)];

/// Field angles, each divided by half of the field of view.
const FIELD_FRACTIONS: [f64; 3] = [0.0, 0.7, 1.0];

/// Largest half field, in degrees, for a lens without a given field of view.
const DEFAULT_HALF_FIELD_DEG: f64 = 20.0;

/// The focus at one spectral line.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LineFocus {
    /// Name of the line.
    pub line: &'static str,
    /// Wavelength in nm.
    #[serde(rename = "nm")]
    pub wavelength_nm: f64,
    /// Effective focal length in mm.
    pub efl_mm: f64,
    /// Back focal distance in mm.
    pub bfd_mm: f64,
    /// Transmittance of all surfaces on the axis.
    pub transmittance: f64,
}

/// The image of a distant point at an angle to the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldPoint {
    /// Field angle in degrees.
    pub angle_deg: f64,
    /// Height above the axis, in mm, at which the chief ray of the d line reaches the sensor.
    pub image_height_mm: f64,
    /// Relative to f·tan(angle), or `None` on the axis.
    pub distortion: Option<f64>,
    /// Lateral colour in mm: the height of the chief ray of the F line minus that of the C line.
    pub lateral_colour_mm: f64,
    /// The spots at [`LINES`].
    pub spots: [LensSpot; 3],
}

/// The analysis of a lens with the sensor at the focus of the d line for a distant object.
#[derive(Debug, Clone, PartialEq)]
pub struct LensAnalysis {
    /// Paraxial properties at the d line.
    pub paraxial: Paraxial,
    /// The foci at [`LINES`].
    pub lines: [LineFocus; 3],
    /// Half of the field of view in degrees.
    pub half_field_deg: f64,
    /// Three fields: on the axis, at 0.7 of the half field, and at the edge of the field.
    pub fields: Vec<FieldPoint>,
}

impl LensAnalysis {
    /// Analyses a lens with its own half field, or `half_field_deg` between 0 and 90 degrees.
    /// Returns an error if the lens forms no real image, or no light passes at one of the fields.
    pub fn of(lens: &Lens, half_field_deg: Option<f64>) -> Result<Self> {
        let at = LINES.map(|(_, nm)| lens.at(nm));
        let [_, d, _] = &at;
        let sensor_z_mm = lens.length_mm() + d.image_distance_mm(f64::INFINITY)?;
        let paraxial = d.paraxial()?;
        let mut foci = Vec::new();
        for (line, at) in LINES.iter().zip(&at) {
            let Paraxial { efl_mm, bfd_mm, .. } = at.paraxial()?;
            let transmittance = at.axial_transmittance();
            foci.push(LineFocus { line: line.0, wavelength_nm: line.1, efl_mm, bfd_mm, transmittance });
        }
        let half_field_deg = half_field_deg.or(lens.half_field_deg()).unwrap_or_else(|| widest_field_deg(d));
        // The edge comes first, so that the error for too wide a field names its angle.
        let angles = FIELD_FRACTIONS.iter().rev().map(|fraction| fraction * half_field_deg);
        let field = |angle_deg| field_point(&at, angle_deg, sensor_z_mm, paraxial.efl_mm);
        let lines = [foci[0], foci[1], foci[2]];
        let mut fields: Vec<FieldPoint> = angles.map(field).collect::<Result<_>>()?;
        fields.reverse();
        Ok(Self { paraxial, lines, half_field_deg, fields })
    }

    /// Returns the longitudinal colour in mm: back focus of the F line minus the C line.
    pub fn fc_shift_mm(&self) -> f64 {
        self.lines[0].bfd_mm - self.lines[2].bfd_mm
    }
}

/// Returns the largest whole degree, from 1 to [`DEFAULT_HALF_FIELD_DEG`], with a chief ray.
fn widest_field_deg(at: &MonochromaticLens<'_>) -> f64 {
    let passes = |degrees: f64| {
        at.chief_ray(degrees)
            .is_ok_and(|chief| at.trace(chief, TraceDirection::ToSensor, ApertureCheck::Enforced).is_ok())
    };
    (1..=DEFAULT_HALF_FIELD_DEG as u32).map(f64::from).take_while(|degrees| passes(*degrees)).last().unwrap_or(1.0)
}

fn field_point(at: &[MonochromaticLens<'_>; 3], angle_deg: f64, sensor_z_mm: f64, efl_mm: f64) -> Result<FieldPoint> {
    let [f, d, c] = at;
    let chief = d.chief_ray(angle_deg)?;
    let end_mm = |at: &MonochromaticLens<'_>| -> Result<f64> {
        let out = at.trace(at.chief_ray(angle_deg)?, TraceDirection::ToSensor, ApertureCheck::Ignored);
        out.map(|ray| ray.at_z(sensor_z_mm).y).map_err(|_| no_light(angle_deg))
    };
    let mut spots = Vec::new();
    for at in at {
        spots.push(at.spot(chief, sensor_z_mm)?.ok_or_else(|| no_light(angle_deg))?);
    }
    let (image_height_mm, ideal_mm) = (end_mm(d)?, efl_mm * tan(angle_deg.to_radians()));
    Ok(FieldPoint {
        angle_deg,
        image_height_mm,
        distortion: (ideal_mm != 0.0).then(|| image_height_mm / ideal_mm - 1.0),
        lateral_colour_mm: end_mm(f)? - end_mm(c)?,
        spots: [spots[0], spots[1], spots[2]],
    })
}

pub(super) fn no_light(angle_deg: f64) -> Error {
    Error::input(format!("no light passes the lens at {angle_deg} degrees: every ray is vignetted"))
        .expected("a smaller field, or larger apertures")
}
