//! Ray fans: the transverse ray aberration against the height of the ray in the entrance pupil.

use glam::DVec2;

use super::analysis::{LensAnalysis, no_light};
use super::field::parallel_ray;
use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay, MonochromaticLens};
use abbe_spectra::error::Result;

/// The plane in which the rays of a fan enter the lens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FanPlane {
    /// The meridional plane, with the aberration along y.
    Tangential,
    /// The sagittal plane, with the aberration along x.
    Sagittal,
}

/// The ray fans of one field as curves.
#[derive(Debug, Clone, PartialEq)]
pub struct FanCurves {
    /// Field angle in degrees.
    pub angle_deg: f64,
    /// Heights in the entrance pupil, divided by the radius of the pupil, from −1 to 1.
    pub pupil: Vec<f64>,
    /// For each wavelength of the analysis the aberrations in mm in the meridional plane, from the
    /// chief ray of the reference wavelength, or `None` for vignetted rays.
    pub tangential_mm: Vec<Vec<Option<f64>>>,
    /// The aberrations in the sagittal plane, like `tangential_mm`.
    pub sagittal_mm: Vec<Vec<Option<f64>>>,
}

const STEPS: u32 = 80;

impl FanCurves {
    /// Computes the fans at the fields of an analysis, on its sensor. Returns an error if a chief
    /// ray does not pass.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Vec<Self>> {
        let pupil: Vec<f64> = (0..=STEPS).map(|i| 2.0 * f64::from(i) / f64::from(STEPS) - 1.0).collect();
        let curves = |angle_deg: f64| {
            let bench = FanBench::of(lens, analysis, angle_deg)?;
            let lines = 0..analysis.conditions.lines().len();
            let curve = |line, plane| pupil.iter().map(|p| bench.aberration_mm(line, plane, *p)).collect();
            Ok(Self {
                angle_deg,
                pupil: pupil.clone(),
                tangential_mm: lines.clone().map(|line| curve(line, FanPlane::Tangential)).collect(),
                sagittal_mm: lines.map(|line| curve(line, FanPlane::Sagittal)).collect(),
            })
        };
        analysis.fields.iter().map(|field| curves(field.angle_deg)).collect()
    }
}

/// A field for which rays of a fan are traced.
pub(super) struct FanBench<'a> {
    at: Vec<MonochromaticLens<'a>>,
    chief: LensRay,
    /// Where the chief ray reaches the sensor, in mm.
    chief_mm: DVec2,
    pupil_radius_mm: f64,
    sensor_z_mm: f64,
}

impl<'a> FanBench<'a> {
    pub(super) fn of(lens: &'a Lens, analysis: &LensAnalysis, angle_deg: f64) -> Result<Self> {
        let (at, sensor_z_mm) = (analysis.at(lens), analysis.sensor_z_mm);
        let reference = &at[analysis.conditions.reference()];
        let chief = reference.chief_ray(angle_deg)?;
        let end = reference.trace(chief, TraceDirection::ToSensor, ApertureCheck::Ignored);
        let chief_mm = end.map_err(|_| no_light(angle_deg))?.at_z(sensor_z_mm).truncate();
        let pupil_radius_mm = analysis.paraxial.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
        Ok(Self { at, chief, chief_mm, pupil_radius_mm, sensor_z_mm })
    }

    /// Returns the transverse aberration in mm of the ray with the coordinate `pupil` from −1 to 1
    /// at the wavelength with this index, or `None` if the ray is vignetted.
    pub(super) fn aberration_mm(&self, line: usize, plane: FanPlane, pupil: f64) -> Option<f64> {
        // Just inside the rim, so that rounding does not block the outermost ray.
        let height_mm = pupil * self.pupil_radius_mm * (1.0 - 1e-9);
        // The pupil is perpendicular to the axis, and the offset is perpendicular to the chief ray.
        let ray = match plane {
            FanPlane::Tangential => parallel_ray(self.chief, 0.0, height_mm * self.chief.direction.z),
            FanPlane::Sagittal => parallel_ray(self.chief, height_mm, 0.0),
        };
        let aberration = self.at[line].image_ray(ray, self.sensor_z_mm)?.at(0.0) - self.chief_mm;
        Some(match plane {
            FanPlane::Tangential => aberration.y,
            FanPlane::Sagittal => aberration.x,
        })
    }
}
