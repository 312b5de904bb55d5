//! A lens cut along its axis: outlines and rays to draw, in mm, as points (z, y).

use glam::DVec2;

use super::analysis::{Analysis, LINES, dark};
use super::field::beside;
use super::prescription::Lens;
use super::trace::{Limits, Ray, Travel};
use crate::error::Result;

/// A ray as a chain of points from the scene to the sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnRay {
    /// Which of [`LINES`] it is.
    pub line: usize,
    /// Which of [`Section::foci`] it goes to.
    pub field: usize,
    /// Its points.
    pub points: Vec<DVec2>,
}

/// The neighbourhood of an image point, to be magnified.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Focus {
    /// The field angle in degrees.
    pub angle_deg: f64,
    /// On the sensor.
    pub centre: DVec2,
    /// Half the size along and across the axis that shows how the colours part.
    pub half_size: DVec2,
    /// dy/dz of the bundle's middle ray there.
    pub slope: f64,
}

/// The drawing's parts.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Closed outlines of the elements.
    pub elements: Vec<Vec<DVec2>>,
    /// The stop: its upper and lower blade.
    pub stop: [[DVec2; 2]; 2],
    /// The sensor, edge on.
    pub sensor: [DVec2; 2],
    /// The rays, for the axis and the edge of the field.
    pub rays: Vec<DrawnRay>,
    /// Where they go: on the axis, and at the edge of the field.
    pub foci: Vec<Focus>,
}

/// Points along a surface.
const POINTS: u32 = 48;
/// Rays of each bundle.
const RAYS: u32 = 5;
/// How much of what passes they span: less than all, as other lines than d may be cut off at the very edge.
const FILLED: f64 = 0.97;

/// Cuts a lens along its axis. Fails where no light passes.
pub fn section(lens: &Lens, analysis: &Analysis) -> Result<Section> {
    let sensor_z_mm = lens.length_mm() + analysis.paraxial.bfd_mm;
    let widest_mm = lens.surfaces().iter().map(|surface| surface.semi_aperture_mm).fold(0.0, f64::max);
    let (mut rays, mut foci) = (Vec::new(), Vec::new());
    for (field, angle_deg) in [0.0, analysis.half_field_deg].into_iter().enumerate() {
        let bundle = bundle(lens, (field, angle_deg), sensor_z_mm, 0.5 * widest_mm)?;
        foci.push(focus(analysis, angle_deg, &bundle));
        rays.extend(bundle);
    }
    let half_mm = 1.15 * foci.iter().map(|focus| focus.centre.y.abs()).fold(0.1 * widest_mm, f64::max);
    Ok(Section {
        elements: elements(lens),
        stop: stop(lens, 0.35 * widest_mm),
        sensor: [half_mm, -half_mm].map(|y| DVec2::new(sensor_z_mm, y)),
        rays,
        foci,
    })
}

/// The outlines of all pieces of glass, those of cemented ones apart.
fn elements(lens: &Lens) -> Vec<Vec<DVec2>> {
    let is_glass = |i: &usize| lens.surfaces()[*i].index.nd() != 1.0;
    (0..lens.surfaces().len() - 1).filter(is_glass).map(|i| outline(lens, i)).collect()
}

/// The glass behind surface `i`: its two surfaces, joined by a cylinder where they leave room for one.
fn outline(lens: &Lens, i: usize) -> Vec<DVec2> {
    let [front, back] = [i, i + 1].map(|i| curve(lens, i));
    let (front_rim, back_rim) = (front[POINTS as usize], back[POINTS as usize]);
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

/// The upper half of a surface from the axis to its rim.
fn curve(lens: &Lens, i: usize) -> Vec<DVec2> {
    let surface = &lens.surfaces()[i];
    let heights = (0..=POINTS).map(|step| surface.semi_aperture_mm * f64::from(step) / f64::from(POINTS));
    heights.map(|y| DVec2::new(lens.vertex_z_mm(i) + surface.profile.sag_mm(y * y), y)).collect()
}

fn stop(lens: &Lens, blade_mm: f64) -> [[DVec2; 2]; 2] {
    let rim = curve(lens, lens.stop())[POINTS as usize];
    let end = DVec2::new(rim.x, rim.y + blade_mm);
    [[rim, end], [DVec2::new(rim.x, -rim.y), DVec2::new(end.x, -end.y)]]
}

/// Rays evenly over what passes at the d line, each in all three lines, from a plane across the bundle before the lens.
fn bundle(lens: &Lens, (field, angle_deg): (usize, f64), sensor_z_mm: f64, lead_mm: f64) -> Result<Vec<DrawnRay>> {
    let [_, d, _] = LINES.map(|(_, nm)| lens.at(nm));
    let chief = d.chief_ray(angle_deg)?;
    let (lowest_mm, highest_mm) = d.passing_mm(chief)?.ok_or_else(|| dark(angle_deg))?;
    let (middle_mm, half_mm) = (0.5 * (lowest_mm + highest_mm), 0.5 * FILLED * (highest_mm - lowest_mm));
    let offsets = (0..RAYS).map(|i| middle_mm + half_mm * (2.0 * f64::from(i) / f64::from(RAYS - 1) - 1.0));
    let mut rays = Vec::new();
    for start in offsets.map(|offset| beside(chief, 0.0, offset)) {
        for (line, (_, nm)) in LINES.iter().enumerate() {
            let mut points = Vec::new();
            let visit = |_, point: glam::DVec3| points.push(DVec2::new(point.z, point.y));
            if let Ok(out) = lens.at(*nm).trace_through(start, Travel::ToSensor, Limits::Apertures, visit) {
                points.push(DVec2::new(sensor_z_mm, out.at_z(sensor_z_mm).y));
                rays.push(DrawnRay { line, field, points });
            }
        }
    }
    begin_on_one_plane(&mut rays, chief, lead_mm);
    Ok(rays)
}

/// Puts a first point before each ray, `lead_mm` before the one that meets the lens first.
fn begin_on_one_plane(rays: &mut [DrawnRay], chief: Ray, lead_mm: f64) {
    let along = DVec2::new(chief.direction.z, chief.direction.y);
    let first = rays.iter().map(|ray| ray.points[0].dot(along)).fold(f64::INFINITY, f64::min) - lead_mm;
    for ray in rays {
        let start = ray.points[0] + along * (first - ray.points[0].dot(along));
        ray.points.insert(0, start);
    }
}

/// The window that shows where the lines focus, and all rays on the sensor.
fn focus(analysis: &Analysis, angle_deg: f64, bundle: &[DrawnRay]) -> Focus {
    let ends = || bundle.iter().filter_map(|ray| ray.points.last());
    let (low, high) =
        ends().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), end| (low.min(end.y), high.max(end.y)));
    let shift_mm = analysis.lines.iter().map(|line| (line.bfd_mm - analysis.paraxial.bfd_mm).abs()).fold(0.0, f64::max);
    let along_mm = (2.5 * shift_mm).max(1e-4 * analysis.paraxial.efl_mm);
    let least_mm = 0.2 * along_mm / analysis.paraxial.f_number.unwrap_or(1.0);
    let sensor_z_mm = ends().next().map_or(0.0, |end| end.x);
    let centre = DVec2::new(sensor_z_mm, 0.5 * (low + high));
    let slopes: Vec<f64> = bundle.iter().filter_map(slope_at_end).collect();
    let (least, most) = slopes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(*s), b.max(*s)));
    let half_size = DVec2::new(along_mm, (0.6 * (high - low)).max(least_mm));
    Focus { angle_deg, centre, half_size, slope: 0.5 * (least + most) }
}

/// dy/dz of a ray's last piece.
fn slope_at_end(ray: &DrawnRay) -> Option<f64> {
    let [.., before, last] = ray.points.as_slice() else { return None };
    Some((last.y - before.y) / (last.x - before.x))
}
