//! The figures of a folded system, and the images of its fields.

use glam::{DMat2, DVec2, DVec3};

use super::{FoldedAperture, FoldedFieldSize, FoldedSystem, ImagePoint};
use crate::lens::conditions::AnalysisConditions;
use crate::lens::trace::LensRay;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{atan, sin_cos, tan};

/// The image of a point of the object.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldedField {
    /// Angle in degrees between the light of a distant object and the z axis, in the yz plane, or
    /// height in mm of the point of the object along y.
    pub field: f64,
    /// Centroid of the spot of the reference wavelength on the image plane in mm, or NaN if no
    /// light passes.
    pub centroid_mm: DVec2,
    /// For each wavelength the root mean square distance in mm of its rays from their centroid.
    pub rms_mm: Vec<f64>,
    /// Fraction of the rays of the entering bundle that reach the image.
    pub passing: f64,
    /// The rays of each wavelength.
    pub(super) rays: Vec<Vec<ImagePoint>>,
}

/// The analysis of a folded system.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldedAnalysis {
    /// The wavelengths of the analysis.
    pub conditions: AnalysisConditions,
    /// Focal lengths in mm along y and x, for thin bundles around the central ray, or `None` for a
    /// plane in which the system has no power. As in a lens, they are those in air.
    pub efl_mm: [Option<f64>; 2],
    /// Distances in mm from the last surface to the foci of these bundles, along the central ray.
    pub back_focus_mm: [Option<f64>; 2],
    /// Distance in mm from the last surface to the image plane, along the central ray.
    pub image_distance_mm: f64,
    /// Diameter of the entrance pupil in mm, which for a distant object is that of the bundle.
    pub entrance_mm: f64,
    /// For a distant object, the focal length divided by the diameter of the entering bundle.
    pub f_number: Option<f64>,
    /// The largest field: an angle in degrees, or a height of the object in mm.
    pub half_field: f64,
    /// The fields: on the axis, and on both sides of it.
    pub fields: Vec<FoldedField>,
    /// Half the width of the bundle, as a distance of the places of [`FoldedSystem::ray`].
    pub(super) half_mm: f64,
}

/// Each divided by half of the field of view.
const FIELD_FRACTIONS: [f64; 4] = [0.0, 0.7, 1.0, -1.0];
const RAYS_ACROSS_BUNDLE: u32 = 64;
/// Maximum number of Newton steps for the ray through the centre of the stop.
const MAX_AIM_STEPS: usize = 50;
/// Distance in mm of the rays of a thin bundle.
const THIN_MM: f64 = 1e-3;

impl FoldedSystem {
    /// Returns the ray of a field through a place near the first surface: for a distant object, the
    /// ray at this angle in degrees through this point of the plane z = 0. For a near one, the ray
    /// from this height of the object in mm whose slopes are the place divided by its
    /// [`distance`](Self::unit_mm).
    pub(super) fn ray(&self, field: f64, place: DVec2) -> LensRay {
        match self.object_mm {
            None => {
                let (sin, cos) = sin_cos(field.to_radians());
                LensRay { origin: place.extend(0.0), direction: DVec3::new(0.0, sin, cos) }
            }
            Some(object_mm) => LensRay {
                origin: DVec3::new(0.0, field, -object_mm),
                direction: (place / self.unit_mm()).extend(1.0).normalize(),
            },
        }
    }

    /// The distance that converts slopes at a near object to places, which is not 0.
    fn unit_mm(&self) -> f64 {
        self.object_mm.filter(|object_mm| object_mm.abs() >= 1.0).unwrap_or(1.0)
    }

    /// The point at which a ray crosses the stop.
    fn at_stop(&self, ray: LensRay, nm: f64) -> Option<DVec2> {
        let mut crossed = None;
        self.trace(ray, nm, |i, point| {
            if i == self.stop {
                crossed = Some(point.truncate());
            }
            i < self.stop
        });
        crossed
    }

    /// Returns the place of the ray of a field through the stop's centre, or an error.
    pub(super) fn chief_place(&self, field: f64, nm: f64) -> Result<DVec2> {
        let lost = || Error::input(format!("no ray of the field {field} passes through the centre of the stop"));
        // The search starts on the ray through the origin.
        let mut place = if self.object_mm.is_some() { DVec2::new(0.0, -field) } else { DVec2::ZERO };
        let step_mm = 1e-4;
        for _ in 0..MAX_AIM_STEPS {
            let height = self.at_stop(self.ray(field, place), nm).ok_or_else(lost)?;
            if height.length() < 1e-10 {
                return Ok(place);
            }
            let along = |offset: DVec2| -> Result<DVec2> {
                let beside = self.at_stop(self.ray(field, place + offset), nm).ok_or_else(lost)?;
                Ok((beside - height) / step_mm)
            };
            let step = DMat2::from_cols(along(DVec2::X * step_mm)?, along(DVec2::Y * step_mm)?).inverse() * height;
            if !step.is_finite() {
                return Err(lost());
            }
            place -= step;
            if step.length() < 1e-13 * (1.0 + place.length()) {
                return Ok(place);
            }
        }
        Err(lost())
    }

    /// Returns the focal length and back focus in mm of a thin bundle of parallel rays along
    /// `aside` around a ray, or `None` if they stay parallel, or an error if the ray is lost.
    pub(super) fn focus(&self, central: LensRay, aside: DVec3, nm: f64) -> Result<Option<(f64, f64)>> {
        let shifted = |sign: f64| LensRay { origin: central.origin + sign * THIN_MM * aside, ..central };
        let Some((turn, gap)) = self.turn_and_gap(central, [shifted(1.0), shifted(-1.0)], nm) else {
            return Err(Error::input("the central ray is lost in the system"));
        };
        // A turn of this size comes from rounding.
        if turn.length() < 1e-12 {
            return Ok(None);
        }
        // A converging system turns the rays towards each other in its own axes, which turn with it,
        // but not about the light.
        let axes = self.image.matrix3;
        let facing = if axes.x_axis.x.abs() > axes.y_axis.y.abs() { axes.x_axis.x } else { axes.y_axis.y };
        let diverges = facing * axes.transpose().mul_vec3(turn).dot(aside) > 0.5 * turn.length();
        let sign = if diverges { -1.0 } else { 1.0 };
        let efl_mm = sign * 2.0 * THIN_MM / (turn.length() * self.last_index(nm));
        let back_mm = -gap.dot(turn) / turn.length_squared();
        Ok(Some((efl_mm, back_mm)))
    }

    /// Returns the difference of the directions of two rays behind the system, perpendicular to a
    /// third one, and of their points on the plane through the end of the latter.
    pub(super) fn turn_and_gap(&self, central: LensRay, pair: [LensRay; 2], nm: f64) -> Option<(DVec3, DVec3)> {
        let out = |ray: LensRay| self.trace(ray, nm, |_, _| true);
        let (base, [plus, minus]) = (out(central)?, pair.map(out));
        let (plus, minus) = (plus?, minus?);
        let on_plane = |ray: LensRay| {
            let ahead = (base.origin - ray.origin).dot(base.direction) / ray.direction.dot(base.direction);
            ray.origin + ahead * ray.direction - base.origin
        };
        let turn = plus.direction - minus.direction;
        Some((turn - base.direction * turn.dot(base.direction), on_plane(plus) - on_plane(minus)))
    }

    /// Returns the distance in mm from the origin to the entrance pupil of a near object.
    fn pupil_mm(&self, object_mm: f64, nm: f64) -> Result<f64> {
        let centre = self.chief_place(0.0, nm)?;
        let slope = (self.chief_place(THIN_MM, nm)? - centre).y / self.unit_mm();
        if slope == 0.0 {
            return Err(Error::input("the entrance pupil lies at infinity").expected("a numerical aperture (OBNA)"));
        }
        Ok(-THIN_MM / slope - object_mm)
    }

    /// Returns half the width of the bundle as a distance of places, and the diameter in mm of the
    /// entrance pupil.
    fn bundle(&self, efl_mm: Option<f64>, nm: f64) -> Result<(f64, f64)> {
        // The ratio of a place to a height in the entrance pupil.
        let scale = match self.object_mm {
            None => Ok(1.0),
            Some(object_mm) => self.pupil_mm(object_mm, nm).map(|pupil_mm| self.unit_mm() / (object_mm + pupil_mm)),
        };
        let half_mm = match self.aperture {
            FoldedAperture::EntrancePupil(diameter_mm) => 0.5 * diameter_mm * scale.clone()?,
            FoldedAperture::FNumber(f_number) => {
                let no_power = || Error::input("a system without power has no f-number").expected("an entrance pupil");
                0.5 * efl_mm.ok_or_else(no_power)? / f_number * scale.clone()?
            }
            FoldedAperture::ObjectCone(tangent) => tangent * self.unit_mm(),
            FoldedAperture::Stop(radius_mm) => {
                let centre = self.chief_place(0.0, nm)?;
                let at = |place: DVec2| self.at_stop(self.ray(0.0, place), nm);
                let shift = at(centre + DVec2::Y * THIN_MM).zip(at(centre)).map(|(a, b)| (a - b).length());
                let shift = shift.filter(|shift| *shift > 0.0);
                radius_mm * THIN_MM / shift.ok_or_else(|| Error::input("no light reaches the stop"))?
            }
        };
        let half_mm = half_mm.abs();
        if !(half_mm > 0.0 && half_mm.is_finite()) {
            return Err(Error::input("the entering bundle has no width"));
        }
        // With a pupil at infinity, the width at the object's distance stands for it.
        Ok((half_mm, 2.0 * (half_mm / scale.unwrap_or(1.0)).abs()))
    }

    /// Returns the largest field: an angle in degrees, or a height of the object in mm.
    fn half_field(&self, size: FoldedFieldSize, nm: f64) -> Result<f64> {
        let image_mm = |field: f64| -> Result<f64> {
            let image = |field| {
                Some(
                    self.on_image(self.trace(self.ray(field, self.chief_place(field, nm).ok()?), nm, |_, _| true)?)
                        .place,
                )
            };
            let gap = image(field).zip(image(0.0)).map(|(a, b)| (a - b).length()).filter(|gap| *gap > 0.0);
            gap.ok_or_else(|| Error::input("the height of the image does not depend on the field"))
        };
        const SMALL_DEG: f64 = 1e-3;
        Ok(match (size, self.object_mm) {
            (FoldedFieldSize::Axis, _) => 0.0,
            (FoldedFieldSize::Angle(deg), None) => deg,
            (FoldedFieldSize::Angle(deg), Some(object_mm)) => {
                (tan(deg.to_radians()) * (object_mm + self.pupil_mm(object_mm, nm)?)).abs()
            }
            (FoldedFieldSize::ObjectHeight(height_mm), Some(_)) => height_mm,
            (FoldedFieldSize::ObjectHeight(_), None) => {
                return Err(Error::input("found object heights of an object at infinity").expected("field angles"));
            }
            (FoldedFieldSize::ImageHeight(height_mm), None) => {
                atan(height_mm / image_mm(SMALL_DEG)? * SMALL_DEG.to_radians()).to_degrees()
            }
            (FoldedFieldSize::ImageHeight(height_mm), Some(_)) => height_mm / image_mm(THIN_MM)? * THIN_MM,
        })
    }

    fn image_of(&self, field: f64, half_mm: f64, conditions: &AnalysisConditions) -> FoldedField {
        let (lines, reference) = (conditions.lines(), conditions.reference());
        let offset = |i: u32| (f64::from(2 * i + 1) / f64::from(RAYS_ACROSS_BUNDLE) - 1.0) * half_mm;
        let grid = (0..RAYS_ACROSS_BUNDLE).flat_map(|i| (0..RAYS_ACROSS_BUNDLE).map(move |j| (i, j)));
        let offsets: Vec<DVec2> =
            grid.map(|(i, j)| DVec2::new(offset(i), offset(j))).filter(|offset| offset.length() <= half_mm).collect();
        let chief = self.chief_place(field, lines[reference].nm).ok();
        let rays: Vec<Vec<ImagePoint>> = lines
            .iter()
            .map(|line| {
                let bundle = chief.iter().flat_map(|chief| offsets.iter().map(|offset| *chief + *offset));
                bundle.filter_map(|place| self.image_point(self.ray(field, place), line.nm)).collect()
            })
            .collect();
        FoldedField {
            field,
            centroid_mm: spot(&rays[reference]).0,
            rms_mm: rays.iter().map(|rays| spot(rays).1).collect(),
            passing: rays[reference].len() as f64 / offsets.len() as f64,
            rays,
        }
    }

    /// Analyses the system at the wavelengths of `conditions`, with its own field or the half field
    /// of view of `conditions`. Focal lengths are for a distant object, spots for the object of the
    /// system. Returns an error if the central ray is lost.
    pub fn analysis(&self, conditions: AnalysisConditions) -> Result<FoldedAnalysis> {
        let nm = conditions.lines()[conditions.reference()].nm;
        let central = self.ray(0.0, self.chief_place(0.0, nm)?);
        let foci = [self.focus(central, DVec3::Y, nm)?, self.focus(central, DVec3::X, nm)?];
        let end = self.trace(central, nm, |_, _| true);
        let end = end.ok_or_else(|| Error::input("the central ray is lost in the system"))?;
        let image = self.image.transform_point3(self.on_image(end).place.extend(0.0));
        let efl_mm = foci.map(|focus| focus.map(|(efl_mm, _)| efl_mm));
        let (half_mm, entrance_mm) = self.bundle(efl_mm[0], nm)?;
        let size = conditions.half_field_deg.map_or(self.field, FoldedFieldSize::Angle);
        let half_field = self.half_field(size, nm)?;
        let fractions = if half_field == 0.0 { &FIELD_FRACTIONS[..1] } else { &FIELD_FRACTIONS[..] };
        let fields = fractions.iter().map(|fraction| self.image_of(fraction * half_field, half_mm, &conditions));
        let fields: Vec<FoldedField> = fields.collect();
        Ok(FoldedAnalysis {
            efl_mm,
            back_focus_mm: foci.map(|focus| focus.map(|(_, back_mm)| back_mm)),
            image_distance_mm: (image - end.origin).dot(end.direction),
            entrance_mm,
            f_number: efl_mm[0].filter(|_| self.object_mm.is_none()).map(|efl_mm| efl_mm.abs() / entrance_mm),
            half_field,
            fields,
            half_mm,
            conditions,
        })
    }
}

/// Returns the centroid of rays on the image plane, and their root mean square distance from it.
fn spot(rays: &[ImagePoint]) -> (DVec2, f64) {
    let count = rays.len() as f64;
    let centroid = rays.iter().map(|ray| ray.place).sum::<DVec2>() / count;
    let variance = rays.iter().map(|ray| ray.place.distance_squared(centroid)).sum::<f64>() / count;
    (centroid, variance.sqrt())
}
