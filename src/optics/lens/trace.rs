//! Exact rays through a lens, surface by surface, at one wavelength.

use glam::DVec3;

use super::prescription::{Lens, MAX_SURFACES};
use crate::optics::fresnel;

/// Which way light goes through the lens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Travel {
    /// Towards +z.
    ToSensor,
    /// Towards −z.
    ToScene,
}

impl Travel {
    /// +1 towards the sensor, −1 towards the scene.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::ToSensor => 1.0,
            Self::ToScene => -1.0,
        }
    }
}

/// A ray in the lens's coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// A point on it, in mm.
    pub origin: DVec3,
    /// Unit vector along which light travels.
    pub direction: DVec3,
}

impl Ray {
    /// The point on the ray's line at this z, in mm; not finite for a ray across the axis.
    pub fn at_z(&self, z_mm: f64) -> DVec3 {
        let mut point = self.origin + self.direction * ((z_mm - self.origin.z) / self.direction.z);
        point.z = z_mm;
        point
    }
}

/// Whether semi-apertures and the stop hold rays back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limits {
    /// They do.
    Apertures,
    /// Surfaces reach as far as their shape does: for finding rays through a given point.
    None,
}

/// Why a ray does not get through, with the surface's number from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// It passes the surface by.
    Missed(usize),
    /// It falls outside the semi-aperture.
    Vignetted(usize),
    /// It is totally reflected.
    Reflected(usize),
}

/// A lens as one wavelength sees it.
#[derive(Debug, Clone)]
pub struct Monochromatic<'a> {
    lens: &'a Lens,
    wavelength_nm: f64,
    /// The index before each surface, and behind the last one.
    n: [f64; MAX_SURFACES + 1],
}

impl Lens {
    /// The lens at a wavelength in nm: the indices are looked up once, rays then cost no allocation.
    pub fn at(&self, wavelength_nm: f64) -> Monochromatic<'_> {
        let mut n = [1.0; MAX_SURFACES + 1];
        for (n, surface) in n[1..].iter_mut().zip(self.surfaces()) {
            *n = surface.index.n(wavelength_nm);
        }
        Monochromatic { lens: self, wavelength_nm, n }
    }
}

impl<'a> Monochromatic<'a> {
    /// The lens.
    pub fn lens(&self) -> &'a Lens {
        self.lens
    }

    /// The wavelength in nm.
    pub fn wavelength_nm(&self) -> f64 {
        self.wavelength_nm
    }

    /// The index before surface `i`, counted from 0; for the number of surfaces, that behind the last one.
    pub(super) fn index_before(&self, i: usize) -> f64 {
        self.n[i]
    }

    /// The ray as it leaves the lens, its origin on the last surface; `Err` says where and why it is lost.
    pub fn trace(&self, ray: Ray, travel: Travel, limits: Limits) -> Result<Ray, Loss> {
        self.trace_through(ray, travel, limits, |_, _| ())
    }

    /// As [`Self::trace`]; `visit` gets each surface's number and the point where the ray meets it, as it goes.
    pub fn trace_through(
        &self,
        mut ray: Ray,
        travel: Travel,
        limits: Limits,
        mut visit: impl FnMut(usize, DVec3),
    ) -> Result<Ray, Loss> {
        let count = self.lens.surfaces().len();
        for step in 0..count {
            let (i, n_here, n_there) = match travel {
                Travel::ToSensor => (step, self.n[step], self.n[step + 1]),
                Travel::ToScene => (count - 1 - step, self.n[count - step], self.n[count - 1 - step]),
            };
            let surface = &self.lens.surfaces()[i];
            let vertex = DVec3::new(0.0, 0.0, self.lens.vertex_z_mm(i));
            let met = surface.profile.meet(ray.origin - vertex, ray.direction, travel);
            let point = met.ok_or(Loss::Missed(i))?;
            if limits == Limits::Apertures && !self.lens.lets_through(i, point.truncate()) {
                return Err(Loss::Vignetted(i));
            }
            visit(i, point + vertex);
            let refracted = fresnel::refract(-ray.direction, surface.profile.normal(point), n_here, n_there);
            ray = Ray { origin: point + vertex, direction: refracted.ok_or(Loss::Reflected(i))? };
        }
        Ok(ray)
    }
}
