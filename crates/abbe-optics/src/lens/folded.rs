//! Sequential systems with mirrors and tilted or decentred surfaces. They may have no axis of
//! symmetry, so all figures follow from exactly traced rays.
//!
//! The axes are right-handed, and the light enters towards +z. Each surface has its own frame, and
//! lengths are in mm.

use glam::{DAffine3, DVec2, DVec3};

use super::conditions::LINES;
use super::profile::{SurfaceProfile, TraceDirection};
use super::trace::LensRay;
use crate::fresnel;
use crate::glass::{RefractiveIndex, lines};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::sin_cos;

/// A surface of a folded system.
#[derive(Debug, Clone)]
pub struct FoldedSurface {
    /// In the frame of the surface.
    pub profile: SurfaceProfile,
    /// From the frame of the surface to the frame of the system, without a scale.
    pub frame: DAffine3,
    /// The medium behind the surface. `None` is a mirror.
    pub index: Option<RefractiveIndex>,
    /// Radius of the circular aperture in mm, or `None` if it blocks no light.
    pub aperture_mm: Option<f64>,
    /// Radius of the central obscuration in mm, or 0.
    pub obscuration_mm: f64,
}

/// The width of the bundle of parallel rays that enters a folded system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FoldedAperture {
    /// Diameter in mm of the entering bundle, perpendicular to the z axis.
    EntrancePupil(f64),
    /// The f-number: the focal length divided by the diameter of the entering bundle.
    FNumber(f64),
    /// Radius in mm of the stop.
    Stop(f64),
}

/// A system of surfaces that light meets one after the other.
#[derive(Debug, Clone)]
pub struct FoldedSystem {
    /// Name of the system.
    pub name: String,
    /// The surfaces in the order in which light meets them.
    pub surfaces: Vec<FoldedSurface>,
    /// Index of the stop's surface.
    pub stop: usize,
    /// The image plane: the plane z = 0 of this frame.
    pub image: DAffine3,
    /// The width of the entering bundle.
    pub aperture: FoldedAperture,
    /// Half of the designed field of view in degrees.
    pub half_field_deg: Option<f64>,
    /// Remarks of the reader of the file.
    pub notes: Vec<String>,
}

/// The image of a distant point.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldedField {
    /// Angle in degrees between the light and the z axis, in the yz plane.
    pub angle_deg: f64,
    /// Centroid of the spot of the d line on the image plane in mm.
    pub centroid_mm: DVec2,
    /// Root mean square distance of the rays from the centroid in mm, at [`LINES`].
    pub rms_mm: [f64; 3],
    /// Fraction of the rays of the entering bundle that reach the image.
    pub passing: f64,
}

/// The analysis of a folded system.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldedAnalysis {
    /// Focal lengths in mm along y and x, for thin bundles around the central ray.
    pub efl_mm: [f64; 2],
    /// Distances in mm from the last surface to the foci of these bundles, along the central ray.
    pub back_focus_mm: [f64; 2],
    /// Distance in mm from the last surface to the image plane, along the central ray.
    pub image_distance_mm: f64,
    /// Diameter of the entering bundle in mm.
    pub entrance_mm: f64,
    /// Focal length divided by the diameter of the entering bundle.
    pub f_number: f64,
    /// Half of the field of view in degrees.
    pub half_field_deg: f64,
    /// The fields: on the axis, and on both sides of it.
    pub fields: Vec<FoldedField>,
}

/// In degrees, for a system without an explicit field.
const DEFAULT_HALF_FIELD_DEG: f64 = 1.0;
/// Each divided by half of the field of view.
const FIELD_FRACTIONS: [f64; 4] = [0.0, 0.7, 1.0, -1.0];
const RAYS_ACROSS_BUNDLE: u32 = 64;
/// Maximum number of Newton steps for the ray through the centre of the stop.
const MAX_AIM_STEPS: usize = 50;

impl FoldedSystem {
    /// Traces a ray through the surfaces, and calls `visit` with the index of each and the point in
    /// its frame. Returns the ray behind the last surface, or `None` if it is lost.
    fn trace(&self, mut ray: LensRay, nm: f64, mut visit: impl FnMut(usize, DVec3) -> bool) -> Option<LensRay> {
        let mut n_before = 1.0;
        for (i, surface) in self.surfaces.iter().enumerate() {
            let to_local = surface.frame.inverse();
            let origin = to_local.transform_point3(ray.origin);
            let direction = to_local.transform_vector3(ray.direction);
            let travel = if direction.z >= 0.0 { TraceDirection::ToSensor } else { TraceDirection::ToScene };
            let point = surface.profile.intersect(origin, direction, travel)?;
            if !visit(i, point) {
                return None;
            }
            let normal = surface.profile.normal(point);
            let onwards = match &surface.index {
                None => direction - 2.0 * direction.dot(normal) * normal,
                Some(index) => {
                    let n_behind = index.n(nm);
                    let refracted = fresnel::refract(-direction, normal, n_before, n_behind)?;
                    n_before = n_behind;
                    refracted
                }
            };
            ray = LensRay {
                origin: surface.frame.transform_point3(point),
                direction: surface.frame.transform_vector3(onwards).normalize(),
            };
        }
        Some(ray)
    }

    /// Returns the point in mm, in the frame of the image plane, at which a ray crosses it.
    fn on_image(&self, ray: LensRay) -> DVec2 {
        let to_local = self.image.inverse();
        let (origin, direction) = (to_local.transform_point3(ray.origin), to_local.transform_vector3(ray.direction));
        (origin - direction * (origin.z / direction.z)).truncate()
    }

    fn passes(&self, i: usize, point: DVec3) -> bool {
        let FoldedSurface { aperture_mm, obscuration_mm, .. } = &self.surfaces[i];
        let height_mm = point.truncate().length();
        height_mm >= *obscuration_mm && aperture_mm.is_none_or(|radius_mm| height_mm <= radius_mm)
    }

    /// The point at which a ray of the d line crosses the stop.
    fn at_stop(&self, ray: LensRay) -> Option<DVec2> {
        let mut crossed = None;
        self.trace(ray, lines::D_NM, |i, point| {
            if i == self.stop {
                crossed = Some(point.truncate());
            }
            i < self.stop
        });
        crossed
    }

    /// Returns the ray at an angle in degrees through the stop's centre, or an error.
    fn chief_ray(&self, angle_deg: f64) -> Result<LensRay> {
        let angle = angle_deg.to_radians();
        let (sin, cos) = sin_cos(angle);
        let direction = DVec3::new(0.0, sin, cos);
        let ray = |place: DVec2| LensRay { origin: place.extend(0.0), direction };
        let lost = || Error::input(format!("no ray at {angle_deg}° passes through the centre of the stop"));
        // The search starts on the ray through the origin.
        let mut place = DVec2::ZERO;
        let step_mm = 1e-4;
        for _ in 0..MAX_AIM_STEPS {
            let height = self.at_stop(ray(place)).ok_or_else(lost)?;
            if height.length() < 1e-10 {
                return Ok(ray(place));
            }
            let along = |offset: DVec2| -> Result<DVec2> {
                Ok((self.at_stop(ray(place + offset)).ok_or_else(lost)? - height) / step_mm)
            };
            let jacobian = glam::DMat2::from_cols(along(DVec2::X * step_mm)?, along(DVec2::Y * step_mm)?);
            place -= jacobian.inverse() * height;
            if !place.is_finite() {
                return Err(lost());
            }
        }
        Err(lost())
    }

    /// Returns the focal length and back focus in mm of a thin bundle along `aside` around a ray.
    fn focus(&self, central: LensRay, aside: DVec3) -> Result<(f64, f64)> {
        const OFFSET_MM: f64 = 1e-3;
        let lost = || Error::input("the central ray is lost in the system");
        let out = |ray: LensRay| self.trace(ray, lines::D_NM, |_, _| true).ok_or_else(lost);
        let shifted = |sign: f64| LensRay { origin: central.origin + sign * OFFSET_MM * aside, ..central };
        let (plus, minus) = (out(shifted(1.0))?, out(shifted(-1.0))?);
        let base = out(central)?;
        let across = |vector: DVec3| vector - base.direction * vector.dot(base.direction);
        let turn = across(plus.direction - minus.direction);
        if turn.length() < 1e-12 {
            return Err(Error::input("the system has no power: it has no focus"));
        }
        // The points of the two rays on the plane through the end of the central ray.
        let on_plane = |ray: LensRay| {
            let ahead = (base.origin - ray.origin).dot(base.direction) / ray.direction.dot(base.direction);
            ray.origin + ahead * ray.direction - base.origin
        };
        let gap = on_plane(plus) - on_plane(minus);
        Ok((2.0 * OFFSET_MM / turn.length(), -gap.dot(turn) / turn.length_squared()))
    }

    fn entrance_mm(&self, efl_mm: f64, central: LensRay) -> Result<f64> {
        match self.aperture {
            FoldedAperture::EntrancePupil(diameter_mm) => Ok(diameter_mm),
            FoldedAperture::FNumber(f_number) => Ok(efl_mm / f_number),
            FoldedAperture::Stop(radius_mm) => {
                const OFFSET_MM: f64 = 1e-3;
                let shifted = LensRay { origin: central.origin + DVec3::Y * OFFSET_MM, ..central };
                let height = self.at_stop(shifted).zip(self.at_stop(central)).map(|(a, b)| (a - b).length());
                let height = height.filter(|height| *height > 0.0);
                let height = height.ok_or_else(|| Error::input("no light reaches the stop"))?;
                Ok(2.0 * radius_mm * OFFSET_MM / height)
            }
        }
    }

    fn field(&self, angle_deg: f64, entrance_mm: f64) -> Result<FoldedField> {
        let chief = self.chief_ray(angle_deg)?;
        let offset = |i: u32| (f64::from(2 * i + 1) / f64::from(RAYS_ACROSS_BUNDLE) - 1.0) * 0.5 * entrance_mm;
        let grid = (0..RAYS_ACROSS_BUNDLE).flat_map(|i| (0..RAYS_ACROSS_BUNDLE).map(move |j| (i, j)));
        let places: Vec<DVec3> = grid
            .map(|(i, j)| DVec3::new(offset(i), offset(j), 0.0))
            .filter(|place| place.length() <= 0.5 * entrance_mm)
            .collect();
        let spot = |nm: f64| -> Option<(DVec2, f64, f64)> {
            let rays = places.iter().map(|place| LensRay { origin: chief.origin + *place, ..chief });
            let landed: Vec<DVec2> = rays
                .filter_map(|ray| self.trace(ray, nm, |i, point| self.passes(i, point)))
                .map(|ray| self.on_image(ray))
                .collect();
            let count = landed.len() as f64;
            let centroid = landed.iter().sum::<DVec2>() / count;
            let variance = landed.iter().map(|point| point.distance_squared(centroid)).sum::<f64>() / count;
            (!landed.is_empty()).then(|| (centroid, variance.sqrt(), count / places.len() as f64))
        };
        let [f, d, c] = LINES.map(|(_, nm)| spot(nm));
        let ((f, d), c) = f.zip(d).zip(c).ok_or_else(|| super::analysis::no_light(angle_deg))?;
        Ok(FoldedField { angle_deg, centroid_mm: d.0, rms_mm: [f.1, d.1, c.1], passing: d.2 })
    }

    /// Analyses the system for distant objects with its own half field, or `half_field_deg`.
    /// Returns an error if the system has no focus, or if no light passes at one of the fields.
    pub fn analysis(&self, half_field_deg: Option<f64>) -> Result<FoldedAnalysis> {
        let central = self.chief_ray(0.0)?;
        let ((efl_y, back_y), (efl_x, back_x)) = (self.focus(central, DVec3::Y)?, self.focus(central, DVec3::X)?);
        let end = self.trace(central, lines::D_NM, |_, _| true);
        let end = end.ok_or_else(|| Error::input("the central ray is lost in the system"))?;
        let image = self.image.transform_point3(self.on_image(end).extend(0.0));
        let entrance_mm = self.entrance_mm(efl_y, central)?;
        let half_field_deg = half_field_deg.or(self.half_field_deg).unwrap_or(DEFAULT_HALF_FIELD_DEG);
        let fields = FIELD_FRACTIONS.iter().map(|fraction| self.field(fraction * half_field_deg, entrance_mm));
        Ok(FoldedAnalysis {
            efl_mm: [efl_y, efl_x],
            back_focus_mm: [back_y, back_x],
            image_distance_mm: (image - end.origin).dot(end.direction),
            entrance_mm,
            f_number: efl_y / entrance_mm,
            half_field_deg,
            fields: fields.collect::<Result<_>>()?,
        })
    }

    /// Returns the number of mirrors.
    pub fn mirrors(&self) -> usize {
        self.surfaces.iter().filter(|surface| surface.index.is_none()).count()
    }
}
