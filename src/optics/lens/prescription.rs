//! What a lens is made of, and the check that it can be.

use super::profile::Profile;
use crate::error::{Error, Result};
use crate::optics::aperture::Blades;
use crate::optics::glass::{Index, lines};
use glam::DVec2;

/// The largest number of surfaces.
pub const MAX_SURFACES: usize = 64;

/// One surface of a lens, with what lies behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Its shape.
    pub profile: Profile,
    /// Distance to the next vertex in mm, ≥ 0; of the last surface to the sensor as designed, 0 where the design does not say.
    pub thickness_mm: f64,
    /// The index behind it, relative to air.
    pub index: Index,
    /// Half the clear diameter in mm.
    pub semi_aperture_mm: f64,
}

/// How large the stop is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Opening {
    /// As large as its surface's semi-aperture.
    Stop,
    /// Such that the entrance pupil has this diameter at the d line.
    EntrancePupil {
        /// In mm.
        diameter_mm: f64,
    },
    /// Such that the lens has this f-number at the d line.
    FNumber(f64),
}

/// A lens as its designer states it, not yet checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescription {
    /// What it is called.
    pub name: String,
    /// Whose design it is.
    pub source: Option<String>,
    /// From the scene to the sensor.
    pub surfaces: Vec<Surface>,
    /// The number of the surface that is the aperture stop, from 0.
    pub stop: Option<usize>,
    /// How large the stop is.
    pub opening: Opening,
    /// Half the field of view that it is designed for, in degrees.
    pub half_field_deg: Option<f64>,
}

/// A lens that can be built: its surfaces exist as far as they reach, do not cross, and one of them is the stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Lens {
    name: String,
    source: Option<String>,
    surfaces: Vec<Surface>,
    vertices_mm: Vec<f64>,
    stop: usize,
    blades: Option<Blades>,
    half_field_deg: Option<f64>,
}

/// The index of a medium in a prescription: `air`, which is 1 as indices of glasses are relative to it, or a name of the catalogue.
/// Fails on an unknown name.
pub fn medium(name: &str) -> Result<Index> {
    if name.eq_ignore_ascii_case("air") { Index::constant(1.0) } else { Index::catalogue(name) }
}

impl Lens {
    /// Checks a prescription. Fails, naming the surface (`surfaces[i]`, from 0), where a number is out of its range, a surface does
    /// not reach as far as its semi-aperture or crosses the next one, or the stop is missing.
    pub fn new(prescription: Prescription) -> Result<Self> {
        let Prescription { name, source, surfaces, stop, opening, half_field_deg } = prescription;
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
        let advance = |surface: &Surface| {
            let vertex_mm = behind_mm;
            behind_mm += surface.thickness_mm;
            vertex_mm
        };
        let vertices_mm = surfaces.iter().map(advance).collect();
        let blades = None;
        let lens = Self { name, source, surfaces, vertices_mm, stop, blades, half_field_deg }.opened(opening)?;
        lens.check_shapes()?;
        Ok(lens)
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whose design it is.
    pub fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// From the scene to the sensor.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The number of the stop's surface, from 0.
    pub fn stop(&self) -> usize {
        self.stop
    }

    /// The lens with blades, or none, inside the circle of its stop.
    #[must_use]
    pub fn with_blades(mut self, blades: Option<Blades>) -> Self {
        self.blades = blades;
        self
    }

    /// What bounds the stop inside its circle, if anything does.
    pub fn blades(&self) -> Option<Blades> {
        self.blades
    }

    /// Whether a surface's aperture lets a ray through that meets it at a place, in mm from the axis to the right and up.
    pub(super) fn lets_through(&self, surface: usize, place: DVec2) -> bool {
        let semi_aperture_mm = self.surfaces[surface].semi_aperture_mm;
        if place.length_squared() > semi_aperture_mm * semi_aperture_mm {
            return false;
        }
        match self.blades {
            Some(blades) if surface == self.stop => blades.leave(place / semi_aperture_mm),
            Some(_) | None => true,
        }
    }

    /// Half the field of view that it is designed for, in degrees, if the design says so.
    pub fn half_field_deg(&self) -> Option<f64> {
        self.half_field_deg
    }

    /// z of a surface's vertex in mm.
    pub fn vertex_z_mm(&self, surface: usize) -> f64 {
        self.vertices_mm[surface]
    }

    /// From the first to the last vertex, in mm.
    pub fn length_mm(&self) -> f64 {
        self.vertices_mm[self.surfaces.len() - 1]
    }

    /// The lens stopped down to an f-number. Fails on one that the open stop does not reach.
    pub fn stopped_down(&self, f_number: f64) -> Result<Self> {
        /// An open lens may be this much slower than its nominal f-number.
        const NOMINAL: f64 = 1e-2;
        let stopped = self.clone().opened(Opening::FNumber(f_number))?;
        let semi_aperture_mm = |lens: &Self| lens.surfaces[lens.stop].semi_aperture_mm;
        if semi_aperture_mm(&stopped) > semi_aperture_mm(self) * (1.0 + NOMINAL) {
            let open = self.at(lines::D_NM).paraxial()?.f_number.unwrap_or(f64::NAN);
            let what = format!("the lens does not open to f/{f_number}");
            return Err(Error::input(what).expected(format!("an f-number of at least {open:.4}")));
        }
        Ok(stopped)
    }

    /// Sets the stop's size.
    fn opened(mut self, opening: Opening) -> Result<Self> {
        let diameter_mm = match opening {
            Opening::Stop => return Ok(self),
            Opening::EntrancePupil { diameter_mm } => diameter_mm,
            Opening::FNumber(f_number) => self.at(lines::D_NM).paraxial()?.efl_mm.abs() / f_number,
        };
        let semi_aperture_mm = 0.5 * diameter_mm * self.at(lines::D_NM).stop_magnification().abs();
        if !(semi_aperture_mm > 0.0 && semi_aperture_mm.is_finite()) {
            let what = format!("an entrance pupil of {diameter_mm} mm leaves a stop of {semi_aperture_mm} mm");
            return Err(Error::input(what).expected("a stop that is open"));
        }
        self.surfaces[self.stop].semi_aperture_mm = semi_aperture_mm;
        Ok(self)
    }

    /// Surfaces reach as far as they say, and do not cross where both are.
    fn check_shapes(&self) -> Result<()> {
        for (i, surface) in self.surfaces.iter().enumerate() {
            let reach_mm = surface.semi_aperture_mm;
            if !surface.profile.sag_mm(reach_mm * reach_mm).is_finite() {
                let what = format!("the surface does not reach as far as its semi-aperture of {reach_mm} mm");
                let expected = "a radius of at least the semi-aperture";
                return Err(on_surface(i, Error::input(what).expected(expected)));
            }
        }
        for (i, pair) in self.surfaces.windows(2).enumerate() {
            let shared_mm = pair[0].semi_aperture_mm.min(pair[1].semi_aperture_mm);
            let gap_mm =
                |height2| pair[0].thickness_mm + pair[1].profile.sag_mm(height2) - pair[0].profile.sag_mm(height2);
            let slack_mm = 1e-9 * (1.0 + shared_mm);
            let heights = (0..=64).map(|step| shared_mm * f64::from(step) / 64.0);
            if let Some(h) = heights.into_iter().find(|h| gap_mm(h * h) < -slack_mm) {
                let what = format!("the surface crosses the next one {h:.4} mm from the axis");
                let expected = "a larger thickness or smaller semi-apertures";
                return Err(on_surface(i, Error::input(what).expected(expected)));
            }
        }
        Ok(())
    }
}

fn on_surface(i: usize, error: Error) -> Error {
    error.on_path(format!("surfaces[{i}]"))
}

fn check_numbers(surface: &Surface) -> Result<()> {
    let Surface { profile, thickness_mm, index: _, semi_aperture_mm } = surface;
    let Profile { curvature_per_mm, conic, even_terms } = profile;
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
    Ok(())
}
