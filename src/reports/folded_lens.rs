//! The analysis of a system that is no camera lens: with mirrors, tilts, surfaces without symmetry,
//! ideal lenses or gratings, or without a real image of a distant object.

use abbe_optics::lens::folded::{FoldedAnalysis, FoldedField, FoldedSystem};
use serde::Serialize;

use super::lens::{SpotReport, spot_report};

/// The analysis of a folded system, by [`FoldedAnalysis`].
#[derive(Debug, Serialize)]
pub struct FoldedLensReport<'a> {
    pub name: &'a str,
    pub surfaces: usize,
    pub mirrors: usize,
    /// The focal length along y, or `None` without power.
    pub efl_mm: Option<f64>,
    pub efl_x_mm: Option<f64>,
    pub bfd_mm: Option<f64>,
    /// The back focus along x.
    pub bfd_x_mm: Option<f64>,
    /// The distance from the last surface to the image plane of the file.
    pub image_distance_mm: f64,
    /// The focal length divided by the diameter of the entering bundle, for a distant object.
    pub f_number: Option<f64>,
    /// The diameter of the entrance pupil.
    pub entrance_diameter_mm: f64,
    /// The distance of the object in front of the first surface, or `None` for a distant object.
    pub object_mm: Option<f64>,
    /// Half the field of view of a distant object.
    pub half_field_deg: Option<f64>,
    /// The fields: on the axis, and on both sides of it.
    pub fields: Vec<FoldedFieldReport>,
}

/// The image of a point of the object.
#[derive(Debug, Serialize)]
pub struct FoldedFieldReport {
    /// The angle of a distant object.
    pub angle_deg: Option<f64>,
    /// The height of the point of a near object.
    pub object_height_mm: Option<f64>,
    /// The x coordinate of the centre of the spot, or `None` if no light passes.
    pub image_x_mm: Option<f64>,
    /// The y coordinate of the centre of the spot.
    pub image_height_mm: Option<f64>,
    /// The spots of all wavelengths, or none if no light passes.
    pub spots: Vec<SpotReport>,
    /// The fraction of the rays that pass, from 0 to 1.
    pub passing: f64,
}

impl<'a> FoldedLensReport<'a> {
    /// Reports an analysis of the system.
    pub fn of(system: &'a FoldedSystem, analysis: &FoldedAnalysis) -> Self {
        let is_distant = system.object_mm.is_none();
        let field = |field: &FoldedField| {
            let passes = field.passing > 0.0;
            let spots = analysis.conditions.lines().iter().zip(&field.rms_mm).filter(|_| passes);
            FoldedFieldReport {
                angle_deg: is_distant.then_some(field.field),
                object_height_mm: (!is_distant).then_some(field.field),
                image_x_mm: passes.then_some(field.centroid_mm.x),
                image_height_mm: passes.then_some(field.centroid_mm.y),
                spots: spots.map(|(line, rms_mm)| spot_report(line, *rms_mm)).collect(),
                passing: field.passing,
            }
        };
        Self {
            name: &system.name,
            surfaces: system.surfaces.len(),
            mirrors: system.mirrors(),
            efl_mm: analysis.efl_mm[0],
            efl_x_mm: analysis.efl_mm[1],
            bfd_mm: analysis.back_focus_mm[0],
            bfd_x_mm: analysis.back_focus_mm[1],
            image_distance_mm: analysis.image_distance_mm,
            f_number: analysis.f_number,
            entrance_diameter_mm: analysis.entrance_mm,
            object_mm: system.object_mm,
            half_field_deg: is_distant.then_some(analysis.half_field),
            fields: analysis.fields.iter().map(field).collect(),
        }
    }
}
