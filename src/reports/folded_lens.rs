//! The analysis of a system with mirrors or coordinate breaks.

use abbe_optics::lens::folded::{FoldedField, FoldedSystem};
use abbe_spectra::error::Result;
use serde::Serialize;

use super::lens::SpotReport;

/// The analysis of a folded system, by [`abbe_optics::lens::folded::FoldedAnalysis`].
#[derive(Debug, Serialize)]
pub struct FoldedLensReport<'a> {
    pub name: &'a str,
    pub surfaces: usize,
    pub mirrors: usize,
    pub efl_mm: f64,
    pub efl_x_mm: f64,
    pub bfd_mm: f64,
    /// The back focus along x.
    pub bfd_x_mm: f64,
    /// The distance from the last surface to the image plane of the file.
    pub image_distance_mm: f64,
    /// The focal length divided by the diameter of the entering bundle.
    pub f_number: f64,
    /// The diameter of the entering bundle.
    pub entrance_diameter_mm: f64,
    /// Half the field of view.
    pub half_field_deg: f64,
    /// The fields: on the axis, and on both sides of it.
    pub fields: Vec<FoldedFieldReport>,
}

/// The image of a distant point.
#[derive(Debug, Serialize)]
pub struct FoldedFieldReport {
    pub angle_deg: f64,
    pub image_x_mm: f64,
    /// The y coordinate of the centre of the spot.
    pub image_height_mm: f64,
    /// The spots of the lines F, d and C.
    pub spots: Vec<SpotReport>,
    /// The fraction of the rays that pass, from 0 to 1.
    pub passing: f64,
}

impl<'a> FoldedLensReport<'a> {
    /// Analyses a system, with a half field that may replace its own. Returns an error if the
    /// system has no focus, or if no light passes at one of the fields.
    pub fn of(system: &'a FoldedSystem, half_field_deg: Option<f64>) -> Result<Self> {
        let analysis = system.analysis(half_field_deg)?;
        let field = |field: &FoldedField| FoldedFieldReport {
            angle_deg: field.angle_deg,
            image_x_mm: field.centroid_mm.x,
            image_height_mm: field.centroid_mm.y,
            spots: SpotReport::of_lines(field.rms_mm),
            passing: field.passing,
        };
        Ok(Self {
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
            half_field_deg: analysis.half_field_deg,
            fields: analysis.fields.iter().map(field).collect(),
        })
    }
}
