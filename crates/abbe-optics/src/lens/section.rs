//! The cross-section of a lens, for a drawing: outlines and rays as points (z, y) in mm.

use glam::DVec2;

use super::analysis::{LensAnalysis, no_light};
use super::field::parallel_ray;
use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay};
use abbe_spectra::error::Result;

/// A ray as a polyline from the scene to the sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnRay {
    /// Index of the wavelength in the conditions of the analysis.
    pub line: usize,
    /// Index of the field in [`LensSection::foci`].
    pub field: usize,
    /// Points of the polyline.
    pub points: Vec<DVec2>,
}

/// The surroundings of an image point, for a magnified drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FocusDetail {
    /// Field angle in degrees.
    pub angle_deg: f64,
    /// Centre of the window, on the sensor.
    pub centre: DVec2,
    /// Half the window's length along the axis and its height, to show the lines' separate foci.
    pub half_size: DVec2,
    /// Slope dy/dz of the middle of the bundle at the sensor.
    pub slope: f64,
}

/// The parts of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct LensSection {
    /// Closed outlines of the elements.
    pub elements: Vec<Vec<DVec2>>,
    /// The stop: one line segment above the opening and one below it.
    pub stop: [[DVec2; 2]; 2],
    /// The sensor, seen edge-on.
    pub sensor: [DVec2; 2],
    /// Rays of the bundles for the axis and for the edge of the field.
    pub rays: Vec<DrawnRay>,
    /// Magnified image points: on the axis and at the edge of the field.
    pub foci: Vec<FocusDetail>,
}

const CURVE_POINTS: u32 = 48;
const RAYS_PER_BUNDLE: u32 = 5;
/// Width of the bundle of drawn rays, divided by that of the bundle that passes the lens at the
/// reference wavelength: below 1, because rays of the others may be vignetted at its edge.
const BUNDLE_FRACTION: f64 = 0.97;

/// Computes the cross-section of a lens. Returns an error if no light passes.
pub fn section(lens: &Lens, analysis: &LensAnalysis) -> Result<LensSection> {
    let sensor_z_mm = analysis.sensor_z_mm;
    let widest_mm = lens.surfaces().iter().map(|surface| surface.semi_aperture_mm).fold(0.0, f64::max);
    let (mut rays, mut foci) = (Vec::new(), Vec::new());
    for (field, angle_deg) in [0.0, analysis.half_field_deg].into_iter().enumerate() {
        let bundle = bundle(lens, analysis, field, angle_deg, 0.5 * widest_mm)?;
        foci.push(focus(analysis, angle_deg, &bundle));
        rays.extend(bundle);
    }
    let half_mm = 1.15 * foci.iter().map(|focus| focus.centre.y.abs()).fold(0.1 * widest_mm, f64::max);
    Ok(LensSection {
        elements: elements(lens),
        stop: stop(lens, 0.35 * widest_mm),
        sensor: [half_mm, -half_mm].map(|y| DVec2::new(sensor_z_mm, y)),
        rays,
        foci,
    })
}

fn elements(lens: &Lens) -> Vec<Vec<DVec2>> {
    let is_glass = |i: &usize| lens.surfaces()[*i].index.nd() != 1.0;
    (0..lens.surfaces().len() - 1).filter(is_glass).map(|i| outline(lens, i)).collect()
}

/// Returns the outline of the glass behind surface `i`, closed by a cylinder.
fn outline(lens: &Lens, i: usize) -> Vec<DVec2> {
    let [front, back] = [i, i + 1].map(|i| curve(lens, i));
    let (front_rim, back_rim) = (front[CURVE_POINTS as usize], back[CURVE_POINTS as usize]);
    let edge_mm = front_rim.y.max(back_rim.y);
    let corners = if front_rim.x < back_rim.x {
        vec![DVec2::new(front_rim.x, edge_mm), DVec2::new(back_rim.x, edge_mm)]
    } else {
        Vec::new()
    };
    let below = |point: &DVec2| DVec2::new(point.x, -point.y);
    let mut outline: Vec<DVec2> = front.iter().rev().map(below).collect();
    outline.extend(front.iter().skip(1));
    outline.extend(&corners);
    outline.extend(back.iter().rev());
    outline.extend(back.iter().skip(1).map(below));
    outline.extend(corners.iter().rev().map(below));
    outline
}

fn curve(lens: &Lens, i: usize) -> Vec<DVec2> {
    let surface = &lens.surfaces()[i];
    let heights = (0..=CURVE_POINTS).map(|step| surface.semi_aperture_mm * f64::from(step) / f64::from(CURVE_POINTS));
    heights.map(|y| DVec2::new(lens.vertex_z_mm(i) + surface.profile.sag_mm(y * y), y)).collect()
}

fn stop(lens: &Lens, blade_mm: f64) -> [[DVec2; 2]; 2] {
    let rim = curve(lens, lens.stop())[CURVE_POINTS as usize];
    let end = DVec2::new(rim.x, rim.y + blade_mm);
    [[rim, end], [DVec2::new(rim.x, -rim.y), DVec2::new(end.x, -end.y)]]
}

/// Returns rays evenly spaced across the bundle that passes at the reference wavelength, each at
/// all wavelengths, from a plane in front of the lens perpendicular to the bundle.
fn bundle(lens: &Lens, analysis: &LensAnalysis, field: usize, angle_deg: f64, lead_mm: f64) -> Result<Vec<DrawnRay>> {
    let (at, sensor_z_mm) = (analysis.at(lens), analysis.sensor_z_mm);
    let reference = &at[analysis.conditions.reference()];
    let chief = reference.chief_ray(angle_deg)?;
    let (lowest_mm, highest_mm) = reference.passing_range_mm(chief)?.ok_or_else(|| no_light(angle_deg))?;
    let (middle_mm, half_mm) = (0.5 * (lowest_mm + highest_mm), 0.5 * BUNDLE_FRACTION * (highest_mm - lowest_mm));
    let offsets =
        (0..RAYS_PER_BUNDLE).map(|i| middle_mm + half_mm * (2.0 * f64::from(i) / f64::from(RAYS_PER_BUNDLE - 1) - 1.0));
    let mut rays = Vec::new();
    for start in offsets.map(|offset| parallel_ray(chief, 0.0, offset)) {
        for (line, at) in at.iter().enumerate() {
            let mut points = Vec::new();
            let visit = |_, point: glam::DVec3| points.push(DVec2::new(point.z, point.y));
            if let Ok(out) = at.trace_through(start, TraceDirection::ToSensor, ApertureCheck::Enforced, visit) {
                points.push(DVec2::new(sensor_z_mm, out.at_z(sensor_z_mm).y));
                rays.push(DrawnRay { line, field, points });
            }
        }
    }
    start_on_one_plane(&mut rays, chief, lead_mm);
    Ok(rays)
}

/// Inserts a first point into each ray, on one plane perpendicular to the bundle that lies
/// `lead_mm`, along the chief ray, in front of the foremost point at which a ray reaches the lens.
fn start_on_one_plane(rays: &mut [DrawnRay], chief: LensRay, lead_mm: f64) {
    let along = DVec2::new(chief.direction.z, chief.direction.y);
    let first = rays.iter().map(|ray| ray.points[0].dot(along)).fold(f64::INFINITY, f64::min) - lead_mm;
    for ray in rays {
        let start = ray.points[0] + along * (first - ray.points[0].dot(along));
        ray.points.insert(0, start);
    }
}

/// Returns the window of an image point: along the axis with the foci of all spectral lines, and
/// across it with all points where the rays reach the sensor.
fn focus(analysis: &LensAnalysis, angle_deg: f64, bundle: &[DrawnRay]) -> FocusDetail {
    let ends = || bundle.iter().filter_map(|ray| ray.points.last());
    let (low, high) =
        ends().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), end| (low.min(end.y), high.max(end.y)));
    let from_sensor_mm = |bfd_mm: f64| (bfd_mm - analysis.paraxial.bfd_mm - analysis.focus_shift_mm).abs();
    let shift_mm = analysis.lines.iter().map(|line| from_sensor_mm(line.bfd_mm)).fold(0.0, f64::max);
    let along_mm = (2.5 * shift_mm).max(1e-4 * analysis.paraxial.efl_mm);
    let least_mm = 0.2 * along_mm / analysis.paraxial.f_number.unwrap_or(1.0);
    let sensor_z_mm = ends().next().map_or(0.0, |end| end.x);
    let centre = DVec2::new(sensor_z_mm, 0.5 * (low + high));
    let slopes: Vec<f64> = bundle.iter().filter_map(slope_at_end).collect();
    let (least, most) = slopes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(*s), b.max(*s)));
    let half_size = DVec2::new(along_mm, (0.6 * (high - low)).max(least_mm));
    FocusDetail { angle_deg, centre, half_size, slope: 0.5 * (least + most) }
}

/// Returns dy/dz of the last segment of a ray.
fn slope_at_end(ray: &DrawnRay) -> Option<f64> {
    let [.., before, last] = ray.points.as_slice() else { return None };
    Some((last.y - before.y) / (last.x - before.x))
}
