//! The usual figures of a lens design: focal lengths, distortion, colour errors and spots.

use std::borrow::Cow;

use glam::DVec2;

use super::conditions::{AnalysisConditions, AnalysisLine, SensorFocus};
use super::field::{ImageRay, LensSpot};
use super::paraxial::Paraxial;
use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay, MonochromaticLens};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::tan;

/// Field angles, each divided by half of the field of view.
const FIELD_FRACTIONS: [f64; 3] = [0.0, 0.7, 1.0];

/// Largest half field, in degrees, for a lens without a given field of view.
const DEFAULT_HALF_FIELD_DEG: f64 = 20.0;

/// The focus at one wavelength.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LineFocus {
    /// Name of the spectral line, or the wavelength in nm as text.
    pub line: Cow<'static, str>,
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
#[derive(Debug, Clone, PartialEq)]
pub struct FieldPoint {
    /// Field angle in degrees.
    pub angle_deg: f64,
    /// Height above the axis, in mm, at which the chief ray of the reference wavelength reaches the
    /// sensor.
    pub image_height_mm: f64,
    /// Image height relative to that of a paraxial lens, minus 1, or `None` on the axis. The height
    /// of a paraxial lens is f·tan(angle) in the paraxial focus.
    pub distortion: Option<f64>,
    /// Lateral colour in mm: the height of the chief ray of the shortest wavelength minus that of
    /// the longest.
    pub lateral_colour_mm: f64,
    /// The spot at each wavelength.
    pub spots: Vec<LensSpot>,
}

/// The analysis of a lens for distant objects.
#[derive(Debug, Clone, PartialEq)]
pub struct LensAnalysis {
    /// What the analysis computes.
    pub conditions: AnalysisConditions,
    /// Paraxial properties at the reference wavelength.
    pub paraxial: Paraxial,
    /// The foci at the wavelengths of the conditions.
    pub lines: Vec<LineFocus>,
    /// Half of the field of view in degrees.
    pub half_field_deg: f64,
    /// Distance in mm from the paraxial focus of the reference wavelength to the sensor.
    pub focus_shift_mm: f64,
    /// The value of `focus_shift_mm` for the best focus ([`SensorFocus::Best`]).
    pub best_focus_shift_mm: f64,
    /// Position of the sensor in mm from the first vertex.
    pub sensor_z_mm: f64,
    /// Three fields: on the axis, at 0.7 of the half field, and at the edge of the field.
    pub fields: Vec<FieldPoint>,
}

impl LensAnalysis {
    /// Analyses a lens under the default conditions with its own half field, or `half_field_deg`
    /// between 0 and 90 degrees. Returns an error if the lens forms no real image, or no light
    /// passes at one of the fields.
    pub fn of(lens: &Lens, half_field_deg: Option<f64>) -> Result<Self> {
        Self::under(lens, AnalysisConditions::default().with_half_field(half_field_deg))
    }

    /// Analyses a lens. Returns an error if the lens forms no real image, no light passes at one of
    /// the fields, or the sensor would not be behind the lens.
    pub fn under(lens: &Lens, conditions: AnalysisConditions) -> Result<Self> {
        let at: Vec<MonochromaticLens<'_>> = conditions.lines().iter().map(|line| lens.at(line.nm)).collect();
        let reference = &at[conditions.reference()];
        let focus_z_mm = lens.length_mm() + reference.image_distance_mm(f64::INFINITY)?;
        let paraxial = reference.paraxial()?;
        let mut lines = Vec::new();
        for (AnalysisLine { name, nm }, at) in conditions.lines().iter().zip(&at) {
            let Paraxial { efl_mm, bfd_mm, .. } = at.paraxial()?;
            let transmittance = at.axial_transmittance();
            lines.push(LineFocus { line: name.clone(), wavelength_nm: *nm, efl_mm, bfd_mm, transmittance });
        }
        let half_field_deg =
            conditions.half_field_deg.or(lens.half_field_deg()).unwrap_or_else(|| widest_field_deg(reference));
        // The edge comes first, so that the error for too wide a field names its angle.
        let angles = FIELD_FRACTIONS.iter().rev().map(|fraction| fraction * half_field_deg);
        let bundle = |angle_deg| FieldBundle::of(&at, conditions.reference(), angle_deg, focus_z_mm);
        let mut bundles: Vec<FieldBundle> = angles.map(bundle).collect::<Result<_>>()?;
        bundles.reverse();
        let best_focus_shift_mm = best_shift_mm(&bundles);
        let focus_shift_mm = match conditions.focus {
            SensorFocus::Shift(shift_mm) => shift_mm,
            SensorFocus::Best => best_focus_shift_mm,
        };
        let sensor_z_mm = focus_z_mm + focus_shift_mm;
        if !(sensor_z_mm.is_finite() && sensor_z_mm >= lens.length_mm()) {
            let what = format!("a sensor {focus_shift_mm} mm behind the paraxial focus is not behind the lens");
            return Err(Error::input(what).expected(format!("a shift of at least {:.4} mm", -paraxial.bfd_mm)));
        }
        let ideal_mm = |angle_deg| paraxial_height_mm(&paraxial, angle_deg, focus_z_mm, sensor_z_mm);
        let field = |bundle: &FieldBundle| {
            let height_mm = ideal_mm(bundle.angle_deg);
            field_point(&at, conditions.reference(), bundle, [sensor_z_mm, focus_shift_mm], height_mm)
        };
        let fields = bundles.iter().map(field).collect::<Result<_>>()?;
        Ok(Self {
            paraxial,
            lines,
            half_field_deg,
            focus_shift_mm,
            best_focus_shift_mm,
            sensor_z_mm,
            fields,
            conditions,
        })
    }

    /// Returns the image height in mm of a paraxial lens on the sensor: where the ray through the
    /// centre of its exit pupil arrives.
    pub(super) fn paraxial_height_mm(&self, angle_deg: f64) -> f64 {
        paraxial_height_mm(&self.paraxial, angle_deg, self.sensor_z_mm - self.focus_shift_mm, self.sensor_z_mm)
    }

    /// Returns the longitudinal colour in mm: back focus of the shortest wavelength minus that of
    /// the longest.
    pub fn fc_shift_mm(&self) -> f64 {
        self.lines[0].bfd_mm - self.lines[self.lines.len() - 1].bfd_mm
    }

    /// Returns the lens at each wavelength of the conditions.
    pub(super) fn at<'a>(&self, lens: &'a Lens) -> Vec<MonochromaticLens<'a>> {
        self.conditions.lines().iter().map(|line| lens.at(line.nm)).collect()
    }
}

/// The light of a distant point in the image.
pub(super) struct FieldBundle {
    pub(super) angle_deg: f64,
    /// The chief ray of the reference wavelength in front of the lens.
    pub(super) chief: LensRay,
    /// The rays at each wavelength, of which at least one passes.
    pub(super) rays: Vec<Vec<ImageRay>>,
}

impl FieldBundle {
    /// Traces the bundle around the chief ray of the reference wavelength, at all wavelengths, to
    /// the plane z = `sensor_z_mm`. Returns an error if no light passes at one of them.
    pub(super) fn of(at: &[MonochromaticLens<'_>], reference: usize, angle_deg: f64, sensor_z_mm: f64) -> Result<Self> {
        let chief = at[reference].chief_ray(angle_deg)?;
        let mut rays = Vec::new();
        for at in at {
            rays.push(at.image_rays(chief, sensor_z_mm)?);
        }
        if rays.iter().any(Vec::is_empty) {
            return Err(no_light(angle_deg));
        }
        Ok(Self { angle_deg, chief, rays })
    }

    /// Returns the points in mm of all rays on a plane `shift_mm` behind the sensor.
    pub(super) fn points(&self, shift_mm: f64) -> impl Iterator<Item = DVec2> {
        self.rays.iter().flatten().map(move |ray| ray.at(shift_mm))
    }
}

/// Returns the shift in mm at which the sum over the fields of the mean square spot radius is
/// least. The mean square radius is a quadratic function of the shift.
fn best_shift_mm(bundles: &[FieldBundle]) -> f64 {
    let (mut mixed, mut square) = (0.0, 0.0);
    for bundle in bundles {
        let rays = || bundle.rays.iter().flatten();
        let count = rays().count() as f64;
        let middle = rays().map(|ray| ray.point_mm).sum::<DVec2>() / count;
        let slope = rays().map(|ray| ray.slope).sum::<DVec2>() / count;
        mixed += rays().map(|ray| (ray.point_mm - middle).dot(ray.slope - slope)).sum::<f64>() / count;
        square += rays().map(|ray| (ray.slope - slope).length_squared()).sum::<f64>() / count;
    }
    if square > 0.0 { -mixed / square } else { 0.0 }
}

/// Returns the largest whole degree, from 1 to [`DEFAULT_HALF_FIELD_DEG`], with a chief ray.
fn widest_field_deg(at: &MonochromaticLens<'_>) -> f64 {
    let passes = |degrees: f64| {
        at.chief_ray(degrees)
            .is_ok_and(|chief| at.trace(chief, TraceDirection::ToSensor, ApertureCheck::Enforced).is_ok())
    };
    (1..=DEFAULT_HALF_FIELD_DEG as u32).map(f64::from).take_while(|degrees| passes(*degrees)).last().unwrap_or(1.0)
}

fn field_point(
    at: &[MonochromaticLens<'_>],
    reference: usize,
    bundle: &FieldBundle,
    [sensor_z_mm, focus_shift_mm]: [f64; 2],
    ideal_mm: f64,
) -> Result<FieldPoint> {
    let angle_deg = bundle.angle_deg;
    let heights_mm = chief_heights_mm(at, angle_deg, sensor_z_mm)?;
    let spots = bundle.rays.iter().map(|rays| LensSpot::of(rays, focus_shift_mm).ok_or_else(|| no_light(angle_deg)));
    let image_height_mm = heights_mm[reference];
    Ok(FieldPoint {
        angle_deg,
        image_height_mm,
        distortion: (ideal_mm != 0.0).then(|| image_height_mm / ideal_mm - 1.0),
        lateral_colour_mm: heights_mm[0] - heights_mm[heights_mm.len() - 1],
        spots: spots.collect::<Result<_>>()?,
    })
}

fn paraxial_height_mm(paraxial: &Paraxial, angle_deg: f64, focus_z_mm: f64, sensor_z_mm: f64) -> f64 {
    let in_focus_mm = paraxial.efl_mm * tan(angle_deg.to_radians());
    match paraxial.exit_pupil {
        Some(pupil) if sensor_z_mm != focus_z_mm => {
            in_focus_mm * (sensor_z_mm - pupil.z_mm) / (focus_z_mm - pupil.z_mm)
        }
        Some(_) | None => in_focus_mm,
    }
}

/// Returns the height in mm at which the chief ray of each wavelength reaches the sensor.
pub(super) fn chief_heights_mm(at: &[MonochromaticLens<'_>], angle_deg: f64, sensor_z_mm: f64) -> Result<Vec<f64>> {
    let end_mm = |at: &MonochromaticLens<'_>| -> Result<f64> {
        let out = at.trace(at.chief_ray(angle_deg)?, TraceDirection::ToSensor, ApertureCheck::Ignored);
        out.map(|ray| ray.at_z(sensor_z_mm).y).map_err(|_| no_light(angle_deg))
    };
    at.iter().map(end_mm).collect()
}

pub(super) fn no_light(angle_deg: f64) -> Error {
    Error::input(format!("no light passes the lens at {angle_deg} degrees: every ray is vignetted"))
        .expected("a smaller field, or larger apertures")
}
