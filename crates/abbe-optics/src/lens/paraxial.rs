//! Paraxial optics by ray transfer matrices for rays (y, n·u): the height in mm, and index times
//! slope (Born & Wolf, *Principles of Optics*, §4.4).

use super::trace::MonochromaticLens;
use abbe_spectra::error::{Error, Result};

/// An image of the stop.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Pupil {
    /// Position on the axis in mm from the first vertex.
    pub z_mm: f64,
    /// Diameter in mm.
    pub diameter_mm: f64,
}

/// Paraxial properties of a lens at one wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paraxial {
    /// Effective focal length f′ in mm, negative for a diverging lens.
    pub efl_mm: f64,
    /// Back focal distance in mm, from the last vertex to the rear focus.
    pub bfd_mm: f64,
    /// Position of the front focus, in mm from the first vertex, negative in front of it.
    pub front_focus_z_mm: f64,
    /// Image of the stop seen from the scene, unless it lies at infinity.
    pub entrance_pupil: Option<Pupil>,
    /// Image of the stop seen from the sensor, unless it lies at infinity.
    pub exit_pupil: Option<Pupil>,
    /// F-number for an object at infinity: the focal length divided by the diameter of the entrance
    /// pupil, unless this pupil lies at infinity.
    pub f_number: Option<f64>,
}

/// A ray transfer matrix of determinant 1: (y, ω = n·u) to (a·y + b·ω, c·y + d·ω).
#[derive(Debug, Clone, Copy)]
struct RayTransferMatrix {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
}

impl RayTransferMatrix {
    const IDENTITY: Self = Self { a: 1.0, b: 0.0, c: 0.0, d: 1.0 };

    fn refraction(self, power_per_mm: f64) -> Self {
        Self { c: self.c - power_per_mm * self.a, d: self.d - power_per_mm * self.b, ..self }
    }

    fn transfer(self, reduced_mm: f64) -> Self {
        Self { a: self.a + reduced_mm * self.c, b: self.b + reduced_mm * self.d, ..self }
    }
}

/// A lens has a focus only if its power times its size exceeds this value.
const AFOCAL: f64 = 1e-9;

impl MonochromaticLens<'_> {
    /// Returns the matrix from the vertex of surface `from`, with its refraction, to that of `to`,
    /// without, or if `to` is the number of surfaces, to the last, with its refraction.
    fn matrix(&self, from: usize, to: usize) -> RayTransferMatrix {
        let (mut matrix, surfaces) = (RayTransferMatrix::IDENTITY, self.lens().surfaces());
        for (i, surface) in surfaces.iter().enumerate().take(to).skip(from) {
            let (before, behind) = (self.index_before(i), self.index_before(i + 1));
            matrix = matrix.refraction((behind - before) * surface.profile.vertex_curvature_per_mm());
            if i + 1 < surfaces.len() {
                matrix = matrix.transfer(surface.thickness_mm / behind);
            }
        }
        matrix
    }

    /// Returns the height at the stop, relative to that in front, of a ray parallel to the axis.
    pub(super) fn stop_magnification(&self) -> f64 {
        self.matrix(0, self.lens().stop()).a
    }

    /// Returns z of the entrance pupil in mm, for any size of the stop; not finite at infinity.
    pub(super) fn entrance_pupil_z_mm(&self) -> f64 {
        let front = self.matrix(0, self.lens().stop());
        front.b / front.a
    }

    /// Computes focal length, foci and pupils, or returns an error for a lens without power.
    pub fn paraxial(&self) -> Result<Paraxial> {
        let lens = self.lens();
        let (count, stop) = (lens.surfaces().len(), lens.stop());
        let whole = self.matrix(0, count);
        let scale_mm = lens.length_mm() + lens.surfaces()[stop].semi_aperture_mm;
        let has_power = whole.c.abs() * scale_mm > AFOCAL;
        if !has_power {
            let what = format!("the lens has no power at {} nm: it has no focus", self.wavelength_nm());
            return Err(Error::input(what));
        }
        let (front, back) = (self.matrix(0, stop), self.matrix(stop, count));
        let diameter_mm = 2.0 * lens.surfaces()[stop].semi_aperture_mm;
        // A ray through the centre of the stop crosses the axis at the image of the stop.
        let entrance_pupil =
            (front.a != 0.0).then(|| Pupil { z_mm: front.b / front.a, diameter_mm: diameter_mm / front.a.abs() });
        let behind = self.index_before(count);
        let exit_pupil = (back.d != 0.0).then(|| Pupil {
            z_mm: lens.length_mm() - back.b * behind / back.d,
            diameter_mm: diameter_mm / back.d.abs(),
        });
        let efl_mm = -1.0 / whole.c;
        Ok(Paraxial {
            efl_mm,
            bfd_mm: -behind * whole.a / whole.c,
            front_focus_z_mm: whole.d / whole.c,
            entrance_pupil,
            exit_pupil,
            f_number: entrance_pupil.map(|pupil| efl_mm.abs() / pupil.diameter_mm),
        })
    }

    /// Returns the distance in mm from the last vertex to the image behind it of an object at the
    /// distance `object_mm`, which may be infinite, in front of the first vertex. Returns an error
    /// if there is no real image, because the object is too near or the lens diverges.
    pub fn image_distance_mm(&self, object_mm: f64) -> Result<f64> {
        let Paraxial { efl_mm, bfd_mm, front_focus_z_mm, .. } = self.paraxial()?;
        let behind = self.index_before(self.lens().surfaces().len());
        // Newton's equation from the focal points: x·x′ = −f·f′.
        let from_focus_mm = object_mm + front_focus_z_mm;
        let distance_mm = bfd_mm + behind * efl_mm * efl_mm / from_focus_mm;
        if efl_mm < 0.0 || (object_mm == f64::INFINITY && bfd_mm < 0.0) {
            let what =
                format!("the lens (focal length {efl_mm:.4} mm, back focus {bfd_mm:.4} mm) forms no image behind it");
            return Err(Error::input(what).expected("a lens whose focus lies behind its last surface"));
        }
        if !(from_focus_mm > 0.0 && distance_mm >= 0.0 && object_mm > 0.0) {
            let least_mm = (-front_focus_z_mm).max(0.0);
            let what = format!("the lens cannot focus on an object {object_mm} mm in front of it");
            return Err(
                Error::input(what).expected(format!("a distance above {least_mm:.4} mm from the first surface"))
            );
        }
        Ok(distance_mm)
    }
}
