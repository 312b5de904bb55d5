//! The plots of a folded system: its section, spot diagrams, ray fans, MTF and field curvature.

use glam::{DVec2, DVec3};

use super::{Deflection, FoldedAnalysis, FoldedField, FoldedSystem, ImagePoint};
use crate::lens::mtf::{MtfCurves, contrast, perfect_contrast};
use crate::lens::ray_fans::FanCurves;
use crate::lens::section::DrawnRay;
use crate::lens::spot_diagram::{LineSpot, SpotDiagram};
use abbe_spectra::error::{Error, Result};

/// The projection of a system onto the yz plane. Points are (z, y) in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldedSection {
    /// Closed outlines of glass.
    pub elements: Vec<Vec<DVec2>>,
    /// Mirrors, ideal lenses and gratings.
    pub sheets: Vec<Vec<DVec2>>,
    /// The stop: one line segment on either side of the light.
    pub stop: [[DVec2; 2]; 2],
    /// The image plane, seen edge-on.
    pub image: [DVec2; 2],
    /// Rays of the bundles of all fields, in the plane of their field.
    pub rays: Vec<DrawnRay>,
    /// True if the light leaves the yz plane, so that rays are longer than in the drawing.
    pub leaves_plane: bool,
}

/// The foci of thin bundles against the field.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldFoci {
    /// Angles in degrees, or heights of the object in mm.
    pub fields: Vec<f64>,
    /// For each wavelength the distance in mm from the image plane to the focus of a thin bundle
    /// in the yz plane, along the normal of the image plane, or `None` without a focus.
    pub tangential_mm: Vec<Vec<Option<f64>>>,
    /// The foci of bundles perpendicular to it.
    pub sagittal_mm: Vec<Vec<Option<f64>>>,
}

const RAYS_PER_BUNDLE: u32 = 5;
const CURVE_POINTS: u32 = 48;
const FAN_STEPS: u32 = 80;
const FIELD_STEPS: u32 = 40;
/// Fraction of the bundle between the pair of rays whose crossing is a focus.
const THIN: f64 = 1e-3;

impl FoldedSystem {
    /// Returns the spot diagrams of an analysis, with a fifth of its rays as points.
    pub fn spots(&self, analysis: &FoldedAnalysis) -> Vec<SpotDiagram> {
        let nm = analysis.conditions.lines()[analysis.conditions.reference()].nm;
        let airy_mm = 1.22 * nm * 1e-6 * analysis.f_number.unwrap_or(0.0);
        let diagram = |field: &FoldedField| {
            let all = || field.rays.iter().flatten().map(|ray| ray.place);
            let count = all().count() as f64;
            let centroid = all().sum::<DVec2>() / count;
            let square = |place: DVec2| place.distance_squared(centroid);
            let line = |(rays, rms_mm): (&Vec<ImagePoint>, &f64)| LineSpot {
                points_mm: rays.iter().step_by(5).map(|ray| ray.place - centroid).collect(),
                rms_mm: *rms_mm,
            };
            SpotDiagram {
                angle_deg: field.field,
                centroid_mm: centroid.y,
                lines: field.rays.iter().zip(&field.rms_mm).map(line).collect(),
                rms_mm: (all().map(square).sum::<f64>() / count).sqrt(),
                largest_mm: all().map(square).fold(0.0, f64::max).sqrt(),
                airy_mm,
            }
        };
        analysis.fields.iter().filter(|field| field.passing > 0.0).map(diagram).collect()
    }

    /// Returns the ray fans of an analysis along y and x. Returns an error if a chief ray is lost.
    pub fn fans(&self, analysis: &FoldedAnalysis) -> Result<Vec<FanCurves>> {
        let lines = analysis.conditions.lines();
        let nm = lines[analysis.conditions.reference()].nm;
        let pupil: Vec<f64> = (0..=FAN_STEPS).map(|i| 2.0 * f64::from(i) / f64::from(FAN_STEPS) - 1.0).collect();
        let fan = |field: f64| {
            let chief = self.chief_place(field, nm)?;
            let lost = || Error::input(format!("the chief ray of the field {field} is lost"));
            let middle = self.trace(self.ray(field, chief), nm, |_, _| true).map(|ray| self.on_image(ray));
            let middle = middle.ok_or_else(lost)?.place;
            let aberrations = |nm: f64, axis: DVec2| {
                let at = |p: &f64| {
                    let place = chief + axis * (p * analysis.half_mm);
                    Some((self.image_point(self.ray(field, place), nm)?.place - middle).dot(axis))
                };
                pupil.iter().map(at).collect()
            };
            Ok(FanCurves {
                angle_deg: field,
                pupil: pupil.clone(),
                tangential_mm: lines.iter().map(|line| aberrations(line.nm, DVec2::Y)).collect(),
                sagittal_mm: lines.iter().map(|line| aberrations(line.nm, DVec2::X)).collect(),
            })
        };
        analysis.fields.iter().filter(|field| field.passing > 0.0).map(|field| fan(field.field)).collect()
    }

    /// Returns the MTF of an analysis, which is the geometric one times that of a perfect lens with
    /// the same f-number and a full round pupil. Returns an error without an f-number.
    pub fn mtf(&self, analysis: &FoldedAnalysis) -> Result<MtfCurves> {
        let nm = analysis.conditions.lines()[analysis.conditions.reference()].nm;
        let f_number = analysis.f_number.ok_or_else(|| {
            let what = "a system without a focal length, or with a near object, has no f-number for its MTF";
            Error::input(what).expected("a system with a focus and a distant object")
        })?;
        let fields = analysis.fields.iter().filter(|field| field.passing > 0.0);
        let fields: Vec<(f64, &FoldedField)> = fields.map(|field| (field.field, field)).collect();
        let contrasts = |field: &&FoldedField, per_mm: f64| {
            [DVec2::Y, DVec2::X].map(|axis| contrast(field.rays.iter().flatten().map(|ray| ray.place), axis * per_mm))
        };
        Ok(MtfCurves::with_limit(&fields, contrasts, |per_mm| perfect_contrast(per_mm * nm * 1e-6 * f_number)))
    }

    /// Returns the foci against the field from one edge to the other. Returns an error for a system
    /// whose only field is the axis.
    pub fn field_foci(&self, analysis: &FoldedAnalysis) -> Result<FieldFoci> {
        if analysis.half_field == 0.0 {
            return Err(Error::input("the only field is the axis").expected("a field of view (--field)"));
        }
        let lines = analysis.conditions.lines();
        let steps = (0..=FIELD_STEPS).map(|i| 2.0 * f64::from(i) / f64::from(FIELD_STEPS) - 1.0);
        let fields: Vec<f64> = steps.map(|step| step * analysis.half_field).collect();
        let foci = |aside: DVec2| {
            let of_line = |nm: f64| {
                fields.iter().map(|field| self.focus_from_image(*field, aside, analysis.half_mm, nm)).collect()
            };
            lines.iter().map(|line| of_line(line.nm)).collect()
        };
        Ok(FieldFoci { tangential_mm: foci(DVec2::Y), sagittal_mm: foci(DVec2::X), fields })
    }

    /// Returns the distance in mm from the image plane at which two near rays of a field are
    /// nearest to each other.
    fn focus_from_image(&self, field: f64, aside: DVec2, half_mm: f64, nm: f64) -> Option<f64> {
        let chief = self.chief_place(field, nm).ok()?;
        let ray = |place| self.ray(field, place);
        let offset = aside * (THIN * half_mm);
        let (turn, gap) = self.turn_and_gap(ray(chief), [ray(chief + offset), ray(chief - offset)], nm)?;
        let end = self.trace(ray(chief), nm, |_, _| true)?;
        let focus = end.origin - end.direction * (gap.dot(turn) / turn.length_squared());
        let focus = self.image.inverse().transform_point3(focus);
        // Towards the side on which the light arrives is negative.
        let towards = self.image.inverse().transform_vector3(end.direction).z.signum();
        Some(towards * focus.z).filter(|mm| mm.is_finite())
    }

    /// Returns the section. Returns an error if no ray of the fields passes.
    pub fn section(&self, analysis: &FoldedAnalysis) -> Result<FoldedSection> {
        let lines = analysis.conditions.lines();
        let nm = lines[analysis.conditions.reference()].nm;
        let mut rays: Vec<DrawnRay> = Vec::new();
        let mut reached = vec![(f64::INFINITY, f64::NEG_INFINITY); self.surfaces.len()];
        let mut image = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut aside_mm, mut along_mm) = (0.0_f64, 0.0_f64);
        let fields = analysis.fields.iter().enumerate().filter(|(_, field)| field.passing > 0.0);
        for (i, FoldedField { field, .. }) in fields {
            let chief = self.chief_place(*field, nm)?;
            for (k, line) in (0..RAYS_PER_BUNDLE).flat_map(|k| lines.iter().enumerate().map(move |line| (k, line))) {
                let offset = 2.0 * f64::from(k) / f64::from(RAYS_PER_BUNDLE - 1) - 1.0;
                let start = self.ray(*field, chief + DVec2::Y * (offset * analysis.half_mm * (1.0 - 1e-9)));
                let mut places = Vec::new();
                let visit = |s: usize, point: DVec3| {
                    places.push(point);
                    self.surfaces[s].passes(point)
                };
                let Some(end) = self.trace(start, line.1.nm, visit) else { continue };
                let place = self.on_image(end).place;
                let mut points: Vec<DVec3> = places
                    .iter()
                    .zip(&self.surfaces)
                    .map(|(place, surface)| surface.frame.transform_point3(*place))
                    .collect();
                points.push(self.image.transform_point3(place.extend(0.0)));
                places.iter().zip(&mut reached).for_each(|(place, range)| widen(range, place.y));
                widen(&mut image, place.y);
                let origin = if self.object_mm.is_some() { start.origin } else { points[0] - start.direction };
                points.insert(0, origin);
                aside_mm = points.iter().fold(aside_mm, |most, point| most.max(point.x.abs()));
                along_mm = points.iter().fold(along_mm, |most, point| most.max(point.length()));
                rays.push(DrawnRay { line: line.0, field: i, points: points.into_iter().map(flat).collect() });
            }
        }
        if rays.is_empty() {
            return Err(Error::input("no ray of the fields passes in the yz plane"));
        }
        self.lead_in(&mut rays, analysis, 0.15 * along_mm);
        let margin_mm = 0.05 * reached.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        reached
            .iter_mut()
            .chain([&mut image])
            .for_each(|(low, high)| (*low, *high) = (*low - margin_mm, *high + margin_mm));
        let curves: Vec<Vec<DVec2>> = (0..self.surfaces.len()).map(|i| self.curve(i, reached[i])).collect();
        let is_sheet =
            |i: &usize| self.surfaces[*i].index.is_none() || self.surfaces[*i].deflection != Deflection::None;
        let stop = curves[self.stop].first().copied().zip(curves[self.stop].last().copied());
        let (low, high) = stop.ok_or_else(|| Error::input("the stop does not extend to its rays"))?;
        let blade = (high - low).normalize_or_zero() * (3.0 * margin_mm);
        Ok(FoldedSection {
            elements: self.glass(&curves),
            sheets: (0..self.surfaces.len()).filter(is_sheet).map(|i| curves[i].clone()).collect(),
            stop: [[high, high + blade], [low, low - blade]],
            image: [image.1, image.0].map(|y| flat(self.image.transform_point3(DVec3::Y * y))),
            rays,
            leaves_plane: aside_mm > 1e-6 * along_mm,
        })
    }

    /// Lets the rays of each field of a distant object begin on one plane in front of the system.
    fn lead_in(&self, rays: &mut [DrawnRay], analysis: &FoldedAnalysis, lead_mm: f64) {
        if self.object_mm.is_some() {
            return;
        }
        for (i, field) in analysis.fields.iter().enumerate() {
            let along = flat(self.ray(field.field, DVec2::ZERO).direction);
            let ahead = |ray: &DrawnRay| ray.points[1].dot(along);
            let mut rays: Vec<_> = rays.iter_mut().filter(|ray| ray.field == i).collect();
            let first = rays.iter().map(|ray| ahead(ray)).fold(f64::INFINITY, f64::min) - lead_mm;
            for ray in &mut rays {
                ray.points[0] = ray.points[1] + along * (first - ahead(ray));
            }
        }
    }

    /// Returns the profile of a surface in its yz plane, where it extends.
    fn curve(&self, i: usize, (low, high): (f64, f64)) -> Vec<DVec2> {
        let surface = &self.surfaces[i];
        let heights = (0..=CURVE_POINTS).map(|step| low + (high - low) * f64::from(step) / f64::from(CURVE_POINTS));
        let points = heights.map(|y| DVec3::new(0.0, y, surface.shape.sag_mm(DVec2::Y * y)));
        points.filter(|point| point.z.is_finite()).map(|point| flat(surface.frame.transform_point3(point))).collect()
    }

    /// Returns the outlines of the glass between neighbouring surfaces.
    fn glass(&self, curves: &[Vec<DVec2>]) -> Vec<Vec<DVec2>> {
        let mut outlines = Vec::new();
        let mut in_glass = false;
        for (i, pair) in curves.windows(2).enumerate() {
            in_glass = self.surfaces[i].index.as_ref().map_or(in_glass, |index| index.nd() != 1.0);
            if in_glass {
                outlines.push(pair[0].iter().chain(pair[1].iter().rev()).copied().collect());
            }
        }
        outlines
    }
}

/// Projects a point onto the yz plane as (z, y).
fn flat(point: DVec3) -> DVec2 {
    DVec2::new(point.z, point.y)
}

fn widen((low, high): &mut (f64, f64), value: f64) {
    (*low, *high) = (low.min(value), high.max(value));
}
