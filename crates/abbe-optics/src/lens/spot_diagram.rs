//! Spot diagrams: the points at which the rays of a distant point reach the sensor.

use glam::DVec2;

use super::analysis::{FieldBundle, LensAnalysis};
use super::field::{ImageRay, LensSpot, parallel_ray};
use super::mtf::bundles;
use super::prescription::Lens;
use super::trace::{LensRay, MonochromaticLens};
use abbe_spectra::error::Result;

/// The spot diagram of one field. Points are relative to the centroid of all wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotDiagram {
    /// Field angle in degrees.
    pub angle_deg: f64,
    /// Height of the centroid above the axis in mm.
    pub centroid_mm: f64,
    /// The diagram of each wavelength.
    pub lines: Vec<LineSpot>,
    /// Root mean square distance in mm of the rays of all wavelengths from the centroid.
    pub rms_mm: f64,
    /// The largest distance in mm of a ray from the centroid, of all rays that give the RMS radius.
    pub largest_mm: f64,
    /// Radius of the Airy disk in mm, 1.22 λN with the f-number N on the axis.
    pub airy_mm: f64,
}

/// The rays of one wavelength in a spot diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct LineSpot {
    /// The points in mm of rays that form a hexagonal lattice in front of the lens.
    pub points_mm: Vec<DVec2>,
    /// Root mean square distance in mm of the rays of this wavelength from their own centroid.
    pub rms_mm: f64,
}

/// Distance of neighbouring rays of the lattice, divided by the radius of the entrance pupil.
const LATTICE: f64 = 0.125;

impl SpotDiagram {
    /// Computes the diagrams at the fields of an analysis, on its sensor. Returns an error if no
    /// light passes at one of the fields.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Vec<Self>> {
        bundles(lens, analysis)?.iter().map(|bundle| Self::at(lens, analysis, bundle)).collect()
    }

    fn at(lens: &Lens, analysis: &LensAnalysis, bundle: &FieldBundle) -> Result<Self> {
        let count = bundle.points(0.0).count() as f64;
        let centroid = bundle.points(0.0).sum::<DVec2>() / count;
        let square = |point: DVec2| point.distance_squared(centroid);
        let mut lines = Vec::new();
        for (at, rays) in analysis.at(lens).iter().zip(&bundle.rays) {
            let points = lattice(at, bundle.chief, analysis.sensor_z_mm)?;
            let points_mm = points.iter().map(|ray| ray.at(0.0) - centroid).collect();
            lines.push(LineSpot { points_mm, rms_mm: LensSpot::of(rays, 0.0).map_or(0.0, |spot| spot.rms_mm) });
        }
        let nm = analysis.conditions.lines()[analysis.conditions.reference()].nm;
        Ok(Self {
            angle_deg: bundle.angle_deg,
            centroid_mm: centroid.y,
            lines,
            rms_mm: (bundle.points(0.0).map(square).sum::<f64>() / count).sqrt(),
            largest_mm: bundle.points(0.0).map(square).fold(0.0, f64::max).sqrt(),
            airy_mm: 1.22 * nm * 1e-6 * analysis.paraxial.f_number.unwrap_or(0.0),
        })
    }
}

/// Traces a hexagonal lattice of rays, in the plane perpendicular to the chief ray, to the sensor.
fn lattice(at: &MonochromaticLens<'_>, chief: LensRay, sensor_z_mm: f64) -> Result<Vec<ImageRay>> {
    let pupil_mm = at.paraxial()?.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
    let pitch_mm = LATTICE * pupil_mm;
    let half = if pitch_mm > 0.0 { (at.bundle_radius_mm()? / pitch_mm).ceil() as i32 } else { 0 };
    // The rows are nearer to each other than the rays of a row.
    let row_mm = 0.75_f64.sqrt() * pitch_mm;
    let offset = |row: i32, i: i32| {
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        DVec2::new((f64::from(i) + shift) * pitch_mm, f64::from(row) * row_mm)
    };
    let offsets = (-half..=half).flat_map(|row| (-half..=half).map(move |i| offset(row, i)));
    let rays = offsets.map(|offset| parallel_ray(chief, offset.x, offset.y));
    Ok(rays.filter_map(|ray| at.image_ray(ray, sensor_z_mm)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::catalogue;

    /// The points of the lattice give nearly the same radius as the finer grid of the analysis.
    #[test]
    fn the_points_agree_with_the_radii_of_the_analysis() {
        let lens = catalogue::find("double-gauss").unwrap();
        let analysis = LensAnalysis::of(lens, None).unwrap();
        for (spot, field) in SpotDiagram::of(lens, &analysis).unwrap().iter().zip(&analysis.fields) {
            for (line, known) in spot.lines.iter().zip(&field.spots) {
                assert_eq!(line.rms_mm, known.rms_mm);
                let count = line.points_mm.len() as f64;
                let middle = line.points_mm.iter().sum::<DVec2>() / count;
                let square = line.points_mm.iter().map(|point| point.distance_squared(middle)).sum::<f64>() / count;
                assert!((square.sqrt() / line.rms_mm - 1.0).abs() < 0.05, "{} {}", square.sqrt(), line.rms_mm);
            }
            assert!(spot.rms_mm < spot.largest_mm && (spot.airy_mm - 1.22 * 587.5618e-6 * 2.0).abs() < 1e-6);
        }
    }
}
