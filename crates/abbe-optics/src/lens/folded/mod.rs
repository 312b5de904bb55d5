//! Sequential systems that are no camera lens: with mirrors, tilted or decentred surfaces, surfaces
//! without symmetry of revolution, ideal lenses or gratings, or without a real image of a distant
//! object. They may have no axis of symmetry, so all figures follow from exactly traced rays.
//!
//! The axes are right-handed, and the light enters towards +z. Each surface has its own frame, and
//! lengths are in mm.

mod analysis;
mod figures;

use std::f64::consts::TAU;

use glam::{DAffine3, DVec2, DVec3};

use super::freeform::Freeform;
use super::profile::{SurfaceProfile, TraceDirection};
use super::trace::LensRay;
use crate::glass::RefractiveIndex;

pub use analysis::{FoldedAnalysis, FoldedField};
pub use figures::{FieldFoci, FoldedSection};

/// The shape of a surface in its frame.
#[derive(Debug, Clone, PartialEq)]
pub enum FoldedShape {
    /// A surface of revolution about the z axis of the frame.
    Revolved(SurfaceProfile),
    /// Any other surface.
    Freeform(Freeform),
}

/// What a surface does to light besides refraction or reflection.
#[derive(Debug, Clone, PartialEq)]
pub enum Deflection {
    /// Nothing.
    None,
    /// An ideal lens, a plane that adds −power · (x, y) to the slopes (dx/dz, dy/dz) times the
    /// index. The powers in 1/mm are along x and y.
    IdealLens(DVec2),
    /// A grating with lines parallel to x: lines per mm of the projection onto the xy plane, times
    /// the order.
    Lines(f64),
    /// A diffractive element with the phase Σ aᵢ (h / radius)²ⁱ in radians, with i ≥ 1, times the
    /// order.
    Radial {
        /// The coefficients times the order.
        coefficients: Box<[f64]>,
        /// Unit of the height h in mm.
        radius_mm: f64,
    },
}

/// A surface of a folded system.
#[derive(Debug, Clone)]
pub struct FoldedSurface {
    /// In the frame of the surface.
    pub shape: FoldedShape,
    /// From the frame of the surface to the frame of the system, without a scale.
    pub frame: DAffine3,
    /// The medium behind the surface. `None` is a mirror.
    pub index: Option<RefractiveIndex>,
    /// What the surface does besides.
    pub deflection: Deflection,
    /// Radius of the circular aperture in mm, or `None` if it blocks no light.
    pub aperture_mm: Option<f64>,
    /// Radius of the central obscuration in mm, or 0.
    pub obscuration_mm: f64,
}

/// The width of the bundle of rays that enters a folded system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FoldedAperture {
    /// Diameter in mm of the entrance pupil, which for a distant object is that of the entering
    /// bundle, perpendicular to the z axis.
    EntrancePupil(f64),
    /// The f-number: the focal length divided by the diameter of the entrance pupil.
    FNumber(f64),
    /// Radius in mm of the stop.
    Stop(f64),
    /// Tangent of half the angle of the cone from the object.
    ObjectCone(f64),
}

/// The largest field of a folded system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FoldedFieldSize {
    /// Only the axis.
    Axis,
    /// Angle in degrees, of the object as seen from the entrance pupil.
    Angle(f64),
    /// Height of the object in mm.
    ObjectHeight(f64),
    /// Height of the image in mm, to first order.
    ImageHeight(f64),
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
    /// Distance in mm of the object in front of the origin, or `None` for a distant object.
    pub object_mm: Option<f64>,
    /// The medium between the object and the first surface.
    pub object_index: RefractiveIndex,
    /// The image plane: the plane z = 0 of this frame.
    pub image: DAffine3,
    /// The width of the entering bundle.
    pub aperture: FoldedAperture,
    /// The designed field.
    pub field: FoldedFieldSize,
    /// Remarks of the reader of the file.
    pub notes: Vec<String>,
}

/// A ray behind a system, where it crosses the image plane, in the frame of this plane.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ImagePoint {
    place: DVec2,
    /// The slopes (dx/dz, dy/dz).
    slope: DVec2,
}

impl FoldedShape {
    /// Returns the sag in mm at a point, or NaN where the surface does not extend.
    pub fn sag_mm(&self, place: DVec2) -> f64 {
        match self {
            Self::Revolved(profile) => profile.sag_mm(place.length_squared()),
            Self::Freeform(freeform) => freeform.sag_mm(place),
        }
    }

    fn intersect(&self, origin: DVec3, direction: DVec3, travel: TraceDirection) -> Option<DVec3> {
        match self {
            Self::Revolved(profile) => profile.intersect(origin, direction, travel),
            Self::Freeform(freeform) => freeform.intersect(origin, direction, travel),
        }
    }

    fn normal(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Revolved(profile) => profile.normal(point),
            Self::Freeform(freeform) => freeform.normal(point),
        }
    }
}

impl Deflection {
    /// Returns the change of index times direction cosine along x and y that diffraction causes at
    /// a point and a wavelength in nm. Source: Welford, *Optics Communications* 14, 1975.
    fn kick(&self, point: DVec3, nm: f64) -> DVec3 {
        match self {
            Self::None | Self::IdealLens(_) => DVec3::ZERO,
            Self::Lines(per_mm) => DVec3::Y * (per_mm * nm * 1e-6),
            Self::Radial { coefficients, radius_mm } => {
                let place = point.truncate() / *radius_mm;
                let square = place.length_squared();
                let terms = coefficients.iter().enumerate().rev();
                let slope = terms.fold(0.0, |sum, (i, a)| sum * square + 2.0 * (i + 1) as f64 * a);
                (place * (slope / radius_mm * nm * 1e-6 / TAU)).extend(0.0)
            }
        }
    }
}

impl FoldedSurface {
    /// Returns a description of the shape and of the deflection.
    pub fn describe(&self) -> String {
        let shape = match &self.shape {
            FoldedShape::Revolved(profile) if *profile == SurfaceProfile::default() => "plane",
            FoldedShape::Revolved(profile) if !profile.even_terms.is_empty() => "even asphere",
            FoldedShape::Revolved(profile) if profile.conic != 0.0 => "conic",
            FoldedShape::Revolved(_) => "sphere",
            FoldedShape::Freeform(freeform) => freeform.terms.name(),
        };
        let deflection = match self.deflection {
            Deflection::None => return shape.to_string(),
            Deflection::IdealLens(_) => return "ideal lens".to_string(),
            Deflection::Lines(_) => "grating",
            Deflection::Radial { .. } => "diffractive",
        };
        format!("{shape}, {deflection}")
    }

    /// Returns the unit direction behind the surface at a point, and the index there, or `None` if
    /// the ray is totally reflected or its diffraction order does not exist.
    fn bend(&self, point: DVec3, direction: DVec3, n_before: f64, nm: f64) -> Option<(DVec3, f64)> {
        let n_behind = self.index.as_ref().map_or(n_before, |index| index.n(nm));
        if let Deflection::IdealLens(power_per_mm) = self.deflection {
            let towards = direction.z.signum();
            let slope = n_before * direction.truncate() / direction.z.abs() - power_per_mm * point.truncate();
            return Some(((slope / n_behind).extend(towards).normalize(), n_behind));
        }
        let normal = self.shape.normal(point);
        let vector = n_before * direction + self.deflection.kick(point, nm);
        let along = vector.dot(normal);
        let across = vector - along * normal;
        let square = n_behind * n_behind - across.length_squared();
        if square < 0.0 {
            return None;
        }
        let crosses = if self.index.is_none() { -1.0 } else { 1.0 };
        let side = crosses * direction.dot(normal).signum();
        Some(((across + side * square.sqrt() * normal) / n_behind, n_behind))
    }

    fn passes(&self, point: DVec3) -> bool {
        let height_mm = point.truncate().length();
        height_mm >= self.obscuration_mm && self.aperture_mm.is_none_or(|radius_mm| height_mm <= radius_mm)
    }
}

impl FoldedSystem {
    /// Traces a ray through the surfaces, and calls `visit` with the index of each and the point in
    /// its frame. Returns the ray behind the last surface, or `None` if it is lost.
    fn trace(&self, mut ray: LensRay, nm: f64, mut visit: impl FnMut(usize, DVec3) -> bool) -> Option<LensRay> {
        let mut n_before = self.object_index.n(nm);
        for (i, surface) in self.surfaces.iter().enumerate() {
            let to_local = surface.frame.inverse();
            let origin = to_local.transform_point3(ray.origin);
            let direction = to_local.transform_vector3(ray.direction);
            let travel = if direction.z >= 0.0 { TraceDirection::ToSensor } else { TraceDirection::ToScene };
            let point = surface.shape.intersect(origin, direction, travel)?;
            if !visit(i, point) {
                return None;
            }
            let (onwards, n_behind) = surface.bend(point, direction, n_before, nm)?;
            n_before = n_behind;
            ray = LensRay {
                origin: surface.frame.transform_point3(point),
                direction: surface.frame.transform_vector3(onwards).normalize(),
            };
        }
        Some(ray)
    }

    /// Traces a ray that the apertures may block to the image plane.
    fn image_point(&self, ray: LensRay, nm: f64) -> Option<ImagePoint> {
        self.trace(ray, nm, |i, point| self.surfaces[i].passes(point)).map(|ray| self.on_image(ray))
    }

    /// Returns where a ray behind the system crosses the image plane.
    fn on_image(&self, ray: LensRay) -> ImagePoint {
        let to_local = self.image.inverse();
        let (origin, direction) = (to_local.transform_point3(ray.origin), to_local.transform_vector3(ray.direction));
        let place = (origin - direction * (origin.z / direction.z)).truncate();
        ImagePoint { place, slope: direction.truncate() / direction.z }
    }

    /// Returns the index of the medium behind the last surface.
    fn last_index(&self, nm: f64) -> f64 {
        let last = self.surfaces.iter().rev().find_map(|surface| surface.index.as_ref());
        last.unwrap_or(&self.object_index).n(nm)
    }

    /// Returns the number of mirrors.
    pub fn mirrors(&self) -> usize {
        self.surfaces.iter().filter(|surface| surface.index.is_none()).count()
    }
}
