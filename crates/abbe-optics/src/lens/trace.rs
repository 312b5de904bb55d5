//! Exact sequential ray tracing through a lens at one wavelength.

use glam::DVec3;

use super::prescription::{Lens, MAX_SURFACES};
use super::profile::TraceDirection;
use crate::fresnel;

/// A ray in lens coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensRay {
    /// A point on the ray in mm.
    pub origin: DVec3,
    /// Unit vector along the propagation of the light.
    pub direction: DVec3,
}

impl LensRay {
    /// Returns the point in mm at which the line of the ray crosses the plane z = `z_mm`, not
    /// finite if the ray is perpendicular to the axis.
    pub fn at_z(&self, z_mm: f64) -> DVec3 {
        let mut point = self.origin + self.direction * ((z_mm - self.origin.z) / self.direction.z);
        point.z = z_mm;
        point
    }
}

/// Whether the apertures, which are the semi-apertures and the stop, block rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ApertureCheck {
    /// Rays outside a semi-aperture or the stop are blocked.
    Enforced,
    /// Surfaces extend as far as their shapes, to search for rays through a point.
    Ignored,
}

/// Why a ray does not pass the lens, with the index of the surface from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayLoss {
    /// The ray does not intersect the surface.
    Missed(usize),
    /// The ray lies outside the semi-aperture or the stop.
    Vignetted(usize),
    /// The ray is totally reflected.
    Reflected(usize),
}

/// A lens with its refractive indices at one wavelength.
#[derive(Debug, Clone)]
pub struct MonochromaticLens<'a> {
    lens: &'a Lens,
    wavelength_nm: f64,
    /// The index in front of surface i, and one more entry for that behind the last surface.
    n: [f64; MAX_SURFACES + 1],
}

impl Lens {
    /// Evaluates the lens at a wavelength in nm. The indices are computed once, into an array of
    /// fixed size, so that ray tracing allocates no memory.
    pub fn at(&self, wavelength_nm: f64) -> MonochromaticLens<'_> {
        let mut n = [1.0; MAX_SURFACES + 1];
        for (n, surface) in n[1..].iter_mut().zip(self.surfaces()) {
            *n = surface.index.n(wavelength_nm);
        }
        MonochromaticLens { lens: self, wavelength_nm, n }
    }
}

impl<'a> MonochromaticLens<'a> {
    /// Returns the lens.
    pub fn lens(&self) -> &'a Lens {
        self.lens
    }

    /// Returns the wavelength in nm.
    pub fn wavelength_nm(&self) -> f64 {
        self.wavelength_nm
    }

    /// Returns the index in front of surface `i`, or behind the last one for their number.
    pub(super) fn index_before(&self, i: usize) -> f64 {
        self.n[i]
    }

    /// Traces a ray, and returns it behind the last surface, or why and at which surface it is
    /// lost.
    pub fn trace(&self, ray: LensRay, travel: TraceDirection, limits: ApertureCheck) -> Result<LensRay, RayLoss> {
        self.trace_through(ray, travel, limits, |_, _| ())
    }

    /// Traces a ray like [`Self::trace`], and calls `visit` with each surface and point (mm).
    pub fn trace_through(
        &self,
        mut ray: LensRay,
        travel: TraceDirection,
        limits: ApertureCheck,
        mut visit: impl FnMut(usize, DVec3),
    ) -> Result<LensRay, RayLoss> {
        let count = self.lens.surfaces().len();
        for step in 0..count {
            let i = match travel {
                TraceDirection::ToSensor => step,
                TraceDirection::ToScene => count - 1 - step,
            };
            let (point, normal) = self.meet(&ray, i, travel, limits)?;
            visit(i, point);
            let (n_i, n_t) = travel.order(self.n[i], self.n[i + 1]);
            let refracted = fresnel::refract(-ray.direction, normal, n_i, n_t);
            ray = LensRay { origin: point, direction: refracted.ok_or(RayLoss::Reflected(i))? };
        }
        Ok(ray)
    }

    /// Intersects a ray with surface `i`. Returns the point in mm and the unit normal towards +z.
    #[inline]
    pub(super) fn meet(
        &self,
        ray: &LensRay,
        i: usize,
        travel: TraceDirection,
        limits: ApertureCheck,
    ) -> Result<(DVec3, DVec3), RayLoss> {
        let surface = &self.lens.surfaces()[i];
        let vertex = DVec3::new(0.0, 0.0, self.lens.vertex_z_mm(i));
        let met = surface.profile.intersect(ray.origin - vertex, ray.direction, travel);
        let point = met.ok_or(RayLoss::Missed(i))?;
        if limits == ApertureCheck::Enforced && !self.lens.aperture_contains(i, point.truncate()) {
            return Err(RayLoss::Vignetted(i));
        }
        Ok((point + vertex, surface.profile.normal(point)))
    }
}
