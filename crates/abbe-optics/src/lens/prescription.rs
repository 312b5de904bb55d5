//! Lens prescriptions and their validation.

use super::profile::SurfaceProfile;
use crate::aperture::Blades;
use crate::glass::{RefractiveIndex, lines};
use crate::thin_film::FilmStack;
use abbe_spectra::error::{Error, Result};
use glam::DVec2;

/// Maximum number of surfaces.
pub const MAX_SURFACES: usize = 64;

/// A surface of a lens and the medium behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct LensSurface {
    /// Profile of the surface.
    pub profile: SurfaceProfile,
    /// Distance to the next vertex, or of the last to the sensor (0 if unknown), in mm, ≥ 0.
    pub thickness_mm: f64,
    /// Behind the surface, relative to air.
    pub index: RefractiveIndex,
    /// Half of the clear diameter in mm.
    pub semi_aperture_mm: f64,
    /// Radius in mm of the central obscuration, which blocks rays nearer to the axis, or 0.
    pub obscuration_mm: f64,
    /// Thin films, from the side of the scene to the side of the sensor.
    pub coating: Option<FilmStack>,
}

/// The size of the stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ApertureSpec {
    /// The semi-aperture of the stop's surface.
    Stop,
    /// The diameter of the entrance pupil at the wavelength of the d line.
    EntrancePupil {
        /// Diameter in mm.
        diameter_mm: f64,
    },
    /// The f-number at the wavelength of the d line.
    FNumber(f64),
    /// The cone of light from the point of the object on the axis.
    ObjectCone {
        /// Tangent of half the angle of the cone.
        tangent: f64,
        /// Distance from the object to the first vertex in mm.
        object_mm: f64,
    },
}

/// A lens prescription that is not yet validated.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescription {
    /// Name of the lens.
    pub name: String,
    /// Source of the design.
    pub source: Option<String>,
    /// Surfaces from the scene to the sensor.
    pub surfaces: Vec<LensSurface>,
    /// Index of the surface that is the aperture stop, from 0.
    pub stop: Option<usize>,
    /// Size of the stop.
    pub opening: ApertureSpec,
    /// Half of the designed field of view in degrees.
    pub half_field_deg: Option<f64>,
    /// Remarks of the reader of a lens file.
    pub notes: Vec<String>,
}

/// A validated lens, with defined surfaces that do not cross, one of which is the stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Lens {
    name: String,
    source: Option<String>,
    surfaces: Vec<LensSurface>,
    vertices_mm: Vec<f64>,
    stop: usize,
    blades: Option<Blades>,
    half_field_deg: Option<f64>,
    notes: Vec<String>,
}

/// Returns the refractive index of a medium by name: `air`, whose index is 1 because all indices
/// are relative to air, or a glass of the catalogue. Returns an error if the name is unknown.
pub fn medium(name: &str) -> Result<RefractiveIndex> {
    if name.eq_ignore_ascii_case("air") { RefractiveIndex::constant(1.0) } else { RefractiveIndex::catalogue(name) }
}

impl Lens {
    /// Validates a prescription. Returns an error with the path of the surface, `surfaces[i]`,
    /// where i counts from 0, if a number is out of range, a surface is not defined up to its
    /// semi-aperture or crosses the next one, or the stop is missing.
    pub fn new(prescription: Prescription) -> Result<Self> {
        let Prescription { name, source, surfaces, stop, opening, half_field_deg, notes } = prescription;
        if !(1..=MAX_SURFACES).contains(&surfaces.len()) {
            let what = format!("found a lens of {} surfaces", surfaces.len());
            return Err(Error::input(what).expected(format!("1 to {MAX_SURFACES} surfaces")).on_path("surfaces"));
        }
        let Some(stop) = stop.filter(|stop| *stop < surfaces.len()) else {
            let expected = "one surface marked as the aperture stop";
            return Err(Error::input("found no stop").expected(expected).on_path("surfaces"));
        };
        surfaces
            .iter()
            .enumerate()
            .try_for_each(|(i, surface)| check_numbers(surface).map_err(|e| on_surface(i, e)))?;
        if half_field_deg.is_some_and(|field| !(field > 0.0 && field < 90.0)) {
            return Err(Error::input("found a half field outside 0 to 90 degrees"));
        }
        let mut behind_mm = 0.0;
        let advance = |surface: &LensSurface| {
            let vertex_mm = behind_mm;
            behind_mm += surface.thickness_mm;
            vertex_mm
        };
        let vertices_mm = surfaces.iter().map(advance).collect();
        let lens = Self { name, source, surfaces, vertices_mm, stop, blades: None, half_field_deg, notes };
        let lens = lens.with_aperture(opening)?;
        lens.check_shapes()?;
        Ok(lens)
    }

    /// Returns the name of the lens.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the source of the design.
    pub fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// Returns the remarks of the reader of the lens file.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the surfaces from the scene to the sensor.
    pub fn surfaces(&self) -> &[LensSurface] {
        &self.surfaces
    }

    /// Replaces the coating of each surface by index, or returns the first error.
    pub fn with_coatings(mut self, coating: impl Fn(&Self, usize) -> Result<Option<FilmStack>>) -> Result<Self> {
        let coatings = (0..self.surfaces.len()).map(|i| coating(&self, i)).collect::<Result<Vec<_>>>()?;
        self.surfaces.iter_mut().zip(coatings).for_each(|(surface, coating)| surface.coating = coating);
        Ok(self)
    }

    /// Removes the coatings of all surfaces.
    pub fn remove_coatings(&mut self) {
        self.surfaces.iter_mut().for_each(|surface| surface.coating = None);
    }

    /// Returns true if a surface has a coating.
    pub fn is_coated(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.coating.is_some())
    }

    /// Returns the index of the stop's surface, from 0.
    pub fn stop(&self) -> usize {
        self.stop
    }

    /// Sets or removes the aperture blades inside the circle of the stop.
    #[must_use]
    pub fn with_blades(mut self, blades: Option<Blades>) -> Self {
        self.blades = blades;
        self
    }

    /// Returns the aperture blades, if the stop has any.
    pub fn blades(&self) -> Option<Blades> {
        self.blades
    }

    /// Returns true if a point (mm to the right and upwards) lies inside a surface's aperture.
    pub(super) fn aperture_contains(&self, surface: usize, place: DVec2) -> bool {
        let LensSurface { semi_aperture_mm, obscuration_mm, .. } = &self.surfaces[surface];
        let height2_mm2 = place.length_squared();
        if height2_mm2 > semi_aperture_mm * semi_aperture_mm || height2_mm2 < obscuration_mm * obscuration_mm {
            return false;
        }
        match self.blades {
            Some(blades) if surface == self.stop => blades.contains(place / *semi_aperture_mm),
            Some(_) | None => true,
        }
    }

    /// Returns half of the designed field of view in degrees, if the design contains it.
    pub fn half_field_deg(&self) -> Option<f64> {
        self.half_field_deg
    }

    /// Returns the z coordinate, in mm, of the vertex of a surface.
    pub fn vertex_z_mm(&self, surface: usize) -> f64 {
        self.vertices_mm[surface]
    }

    /// Returns the distance from the first to the last vertex in mm.
    pub fn length_mm(&self) -> f64 {
        self.vertices_mm[self.surfaces.len() - 1]
    }

    /// Returns the lens at this f-number, or an error if that requires a larger stop.
    pub fn stopped_down(&self, f_number: f64) -> Result<Self> {
        /// The fraction by which the true f-number of an open lens may exceed its nominal one.
        const NOMINAL_TOLERANCE: f64 = 1e-2;
        let stopped = self.clone().with_aperture(ApertureSpec::FNumber(f_number))?;
        let semi_aperture_mm = |lens: &Self| lens.surfaces[lens.stop].semi_aperture_mm;
        if semi_aperture_mm(&stopped) > semi_aperture_mm(self) * (1.0 + NOMINAL_TOLERANCE) {
            let open = self.at(lines::D_NM).paraxial()?.f_number.unwrap_or(f64::NAN);
            let what = format!("the lens does not open to f/{f_number}");
            return Err(Error::input(what).expected(format!("an f-number of at least {open:.4}")));
        }
        Ok(stopped)
    }

    fn with_aperture(mut self, opening: ApertureSpec) -> Result<Self> {
        let diameter_mm = match opening {
            ApertureSpec::Stop => return Ok(self),
            ApertureSpec::EntrancePupil { diameter_mm } => diameter_mm,
            ApertureSpec::FNumber(f_number) => self.at(lines::D_NM).paraxial()?.efl_mm.abs() / f_number,
            ApertureSpec::ObjectCone { tangent, object_mm } => {
                if !object_mm.is_finite() {
                    let what = "found a numerical aperture of an object at infinity";
                    return Err(Error::input(what).expected("an object at a finite distance"));
                }
                2.0 * tangent * (object_mm + self.at(lines::D_NM).entrance_pupil_z_mm())
            }
        };
        let semi_aperture_mm = 0.5 * diameter_mm * self.at(lines::D_NM).stop_magnification().abs();
        if !(semi_aperture_mm > 0.0 && semi_aperture_mm.is_finite()) {
            let what = format!(
                "an entrance pupil of {diameter_mm} mm gives a stop with a semi-aperture of {semi_aperture_mm} mm"
            );
            return Err(Error::input(what).expected("a positive semi-aperture"));
        }
        self.surfaces[self.stop].semi_aperture_mm = semi_aperture_mm;
        Ok(self)
    }

    /// Checks that every surface is defined in its aperture and does not cross the next one there.
    fn check_shapes(&self) -> Result<()> {
        for (i, surface) in self.surfaces.iter().enumerate() {
            let semi_aperture_mm = surface.semi_aperture_mm;
            if !surface.profile.sag_mm(semi_aperture_mm * semi_aperture_mm).is_finite() {
                let what = format!("the surface is not defined up to its semi-aperture of {semi_aperture_mm} mm");
                let expected = "a radius of at least the semi-aperture";
                return Err(on_surface(i, Error::input(what).expected(expected)));
            }
        }
        for (i, pair) in self.surfaces.windows(2).enumerate() {
            if let Some(h) = crossing_mm(pair) {
                let what = format!("the surface crosses the next one {h:.4} mm from the axis");
                let expected = "a larger thickness or smaller semi-apertures";
                return Err(on_surface(i, Error::input(what).expected(expected)));
            }
        }
        Ok(())
    }
}

/// Returns the height in mm at which a surface crosses the next one inside both apertures, if any.
pub(super) fn crossing_mm(pair: &[LensSurface]) -> Option<f64> {
    let shared_mm = pair[0].semi_aperture_mm.min(pair[1].semi_aperture_mm);
    let gap_mm = |height2| pair[0].thickness_mm + pair[1].profile.sag_mm(height2) - pair[0].profile.sag_mm(height2);
    let slack_mm = 1e-9 * (1.0 + shared_mm);
    (0..=64).map(|step| shared_mm * f64::from(step) / 64.0).find(|h| gap_mm(h * h) < -slack_mm)
}

fn on_surface(i: usize, error: Error) -> Error {
    error.on_path(format!("surfaces[{i}]"))
}

fn check_numbers(surface: &LensSurface) -> Result<()> {
    let LensSurface { profile, thickness_mm, index: _, semi_aperture_mm, obscuration_mm, coating: _ } = surface;
    let SurfaceProfile { curvature_per_mm, conic, even_terms } = profile;
    if !(curvature_per_mm.is_finite() && conic.is_finite() && even_terms.iter().all(|term| term.is_finite())) {
        return Err(Error::input("found a shape whose numbers are not finite"));
    }
    if !(*thickness_mm >= 0.0 && thickness_mm.is_finite()) {
        return Err(Error::input(format!("found a thickness of {thickness_mm} mm")).expected("at least 0"));
    }
    if !(*semi_aperture_mm > 0.0 && semi_aperture_mm.is_finite()) {
        let what = format!("found a semi-aperture of {semi_aperture_mm} mm");
        return Err(Error::input(what).expected("a number above 0"));
    }
    if !(0.0..*semi_aperture_mm).contains(obscuration_mm) {
        let what = format!("found a central obscuration with a radius of {obscuration_mm} mm");
        return Err(Error::input(what).expected(format!("a radius below the semi-aperture of {semi_aperture_mm} mm")));
    }
    Ok(())
}
