//! Paraxial optics by matrices on (y, n·u): height in mm and slope times index (Born & Wolf, *Principles of Optics*, §4.4).

use super::trace::Monochromatic;
use crate::error::{Error, Result};

/// An image of the stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pupil {
    /// Where it lies on the axis in mm, from the first vertex.
    pub z_mm: f64,
    /// Its diameter in mm.
    pub diameter_mm: f64,
}

/// What a lens does to rays near its axis, at one wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paraxial {
    /// Effective focal length f′ in mm; below 0 for a diverging lens.
    pub efl_mm: f64,
    /// Back focal distance in mm, from the last vertex to the focus behind it.
    pub bfd_mm: f64,
    /// The front focus on the axis in mm, from the first vertex; below 0 where it lies before the lens.
    pub front_focus_z_mm: f64,
    /// The stop as the scene sees it; `None` where it lies at infinity.
    pub entrance_pupil: Option<Pupil>,
    /// The stop as the sensor sees it; `None` where it lies at infinity.
    pub exit_pupil: Option<Pupil>,
    /// Focal length over the entrance pupil's diameter, for an object at infinity; `None` where that pupil lies at infinity.
    pub f_number: Option<f64>,
}

/// A ray-transfer matrix: y′ = a·y + b·ω, ω′ = c·y + d·ω with ω = n·u; a·d − b·c = 1.
#[derive(Debug, Clone, Copy)]
struct Matrix {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
}

impl Matrix {
    const IDENTITY: Self = Self { a: 1.0, b: 0.0, c: 0.0, d: 1.0 };

    fn refraction(self, power_per_mm: f64) -> Self {
        Self { c: self.c - power_per_mm * self.a, d: self.d - power_per_mm * self.b, ..self }
    }

    fn transfer(self, reduced_mm: f64) -> Self {
        Self { a: self.a + reduced_mm * self.c, b: self.b + reduced_mm * self.d, ..self }
    }
}

/// A lens of less power than this, relative to its size, has no focus.
const AFOCAL: f64 = 1e-9;

impl Monochromatic<'_> {
    /// From the vertex of surface `from`, before it refracts, to that of `to`, before it refracts; for the number of surfaces, to the
    /// last vertex after it has refracted.
    fn matrix(&self, from: usize, to: usize) -> Matrix {
        let (mut matrix, surfaces) = (Matrix::IDENTITY, self.lens().surfaces());
        for (i, surface) in surfaces.iter().enumerate().take(to).skip(from) {
            let (before, behind) = (self.index_before(i), self.index_before(i + 1));
            matrix = matrix.refraction((behind - before) * surface.profile.vertex_curvature_per_mm());
            if i + 1 < surfaces.len() {
                matrix = matrix.transfer(surface.thickness_mm / behind);
            }
        }
        matrix
    }

    /// How high a ray parallel to the axis goes at the stop, over its height before the lens.
    pub(super) fn stop_magnification(&self) -> f64 {
        self.matrix(0, self.lens().stop()).a
    }

    /// Focal length, focal points and pupils. Fails for a lens without power.
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
        // A ray through the stop's centre crosses the axis where the stop's image lies.
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

    /// How far behind the last vertex, in mm, the image of an object lies that is `object_mm` before the first vertex (infinity is
    /// allowed): where the sensor has to stand. Fails where no real image is behind the lens: the object is too near, or the lens
    /// diverges.
    pub fn image_distance_mm(&self, object_mm: f64) -> Result<f64> {
        let Paraxial { efl_mm, bfd_mm, front_focus_z_mm, .. } = self.paraxial()?;
        let behind = self.index_before(self.lens().surfaces().len());
        // Newton: x·x′ = −f·f′, from the focal points.
        let from_focus_mm = object_mm + front_focus_z_mm;
        let distance_mm = bfd_mm + behind * efl_mm * efl_mm / from_focus_mm;
        if efl_mm < 0.0 || (object_mm == f64::INFINITY && bfd_mm < 0.0) {
            let what =
                format!("the lens (focal length {efl_mm:.4} mm, back focus {bfd_mm:.4} mm) forms no image behind it");
            return Err(Error::input(what).expected("a lens whose focus lies behind its last surface"));
        }
        if !(from_focus_mm > 0.0 && distance_mm >= 0.0 && object_mm > 0.0) {
            let least_mm = (-front_focus_z_mm).max(0.0);
            let what = format!("a focus {object_mm} mm before the lens is nearer than it can reach");
            return Err(
                Error::input(what).expected(format!("a distance above {least_mm:.4} mm from the first surface"))
            );
        }
        Ok(distance_mm)
    }
}
