//! The surfaces of a Zemax file: their operands, glasses and apertures.

use super::words::{number, unsupported};
use crate::glass::makers::{in_lens_file, model_glass};
use crate::glass::{AgfCatalogue, RefractiveIndex};
use crate::lens::prescription::{LensSurface, medium};
use crate::lens::profile::SurfaceProfile;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::hypot;

const GLASSES: &str =
    "a glass of the built-in catalogue or of its makers, or of an .agf catalogue that is read with the lens";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SurfaceKind {
    /// Refraction, or nothing if the media on both sides are equal.
    Refracting,
    /// Reflection.
    Mirror,
    /// A shift and a rotation of the axes for the surfaces behind it.
    CoordinateBreak,
}

/// A surface during parsing, with lengths in the unit of the file.
#[derive(Debug)]
pub(super) struct ZmxSurface {
    pub(super) line: usize,
    pub(super) kind: SurfaceKind,
    pub(super) profile: SurfaceProfile,
    pub(super) thickness: f64,
    /// The medium behind the surface. `None` is air, and for a mirror the medium in front of it.
    pub(super) index: Option<RefractiveIndex>,
    /// 0 if the file does not state it.
    semi_aperture: f64,
    /// Radius of a circular aperture, which replaces the semi-diameter.
    clear: Option<f64>,
    /// Radius of the central obscuration, or 0.
    obscuration: f64,
    /// True if `clear` and `obscuration` are not centred, so that they are ignored.
    decentred: bool,
    pub(super) stop: bool,
    aspheric: bool,
    /// The parameters 1 to 6 of a coordinate break: decentres, tilts in degrees, and the order.
    pub(super) parameters: [f64; 6],
}

impl ZmxSurface {
    pub(super) fn new(line: usize) -> Self {
        Self {
            line,
            kind: SurfaceKind::Refracting,
            profile: SurfaceProfile::default(),
            thickness: 0.0,
            index: None,
            semi_aperture: 0.0,
            clear: None,
            obscuration: 0.0,
            decentred: false,
            stop: false,
            aspheric: false,
            parameters: [0.0; 6],
        }
    }

    /// Reads an operand, with remarks for the user in `notes`.
    pub(super) fn read(
        &mut self,
        operand: &str,
        arguments: &[&str],
        catalogues: &[AgfCatalogue],
        notes: &mut Vec<String>,
    ) -> Result<()> {
        match operand {
            "STOP" => self.stop = true,
            "TYPE" => match arguments.first() {
                Some(&"STANDARD") => {}
                Some(&"EVENASPH") => self.aspheric = true,
                Some(&"COORDBRK") => self.kind = SurfaceKind::CoordinateBreak,
                _ => {
                    let what = format!("a surface of type {}", arguments.join(" "));
                    return Err(unsupported(&what, "STANDARD, EVENASPH or COORDBRK"));
                }
            },
            "CURV" => self.profile.curvature_per_mm = number(arguments, 0)?,
            "CONI" => self.profile.conic = number(arguments, 0)?,
            "DISZ" => self.thickness = number(arguments, 0)?,
            "DIAM" => self.semi_aperture = number(arguments, 0)?.max(0.0),
            "GLAS" if arguments.first() == Some(&"MIRROR") => self.kind = SurfaceKind::Mirror,
            "GLAS" => self.index = Some(glass(arguments, catalogues, notes)?),
            "PARM" if self.kind == SurfaceKind::CoordinateBreak => {
                let place = number(arguments, 0)? - 1.0;
                if let Some(parameter) = self.parameters.get_mut(place as usize) {
                    *parameter = number(arguments, 1)?;
                }
            }
            "PARM" if self.aspheric => self.read_term(number(arguments, 0)?, number(arguments, 1)?)?,
            "CLAP" => {
                self.obscuration = self.obscuration.max(number(arguments, 0)?);
                self.clear = Some(number(arguments, 1)?);
            }
            "SQAP" | "ELAP" => {
                let (x, y) = (number(arguments, 0)?, number(arguments, 1)?);
                self.clear = Some(if operand == "SQAP" { hypot(x, y) } else { x.max(y) });
                note(notes, format!("the circle around it replaces the aperture {operand} {}", arguments.join(" ")));
            }
            "OBSC" if number(arguments, 0)? == 0.0 => self.obscuration = self.obscuration.max(number(arguments, 1)?),
            "OBDC" if arguments.iter().all(|word| word.parse() == Ok(0.0)) => {}
            "OBDC" => {
                self.decentred = true;
                note(notes, format!("a decentred aperture (OBDC {}) blocks no light", arguments.join(" ")));
            }
            "OBSC" | "SQOB" | "ELOB" | "UDAD" | "REX" | "REY" | "ELX" | "ELY" => {
                note(notes, format!("the aperture {operand} {} blocks no light", arguments.join(" ")));
            }
            _ => {}
        }
        Ok(())
    }

    fn read_term(&mut self, order: f64, value: f64) -> Result<()> {
        if value == 0.0 {
            return Ok(());
        }
        if order.fract() != 0.0 || !(1.0..=8.0).contains(&order) {
            return Err(unsupported(&format!("parameter {order} of an even asphere"), "1 to 8"));
        }
        let mut terms = std::mem::take(&mut self.profile.even_terms).into_vec();
        terms.resize(terms.len().max(order as usize), 0.0);
        terms[order as usize - 1] = value;
        self.profile.even_terms = terms.into();
        Ok(())
    }

    /// Returns the radius of the aperture in the unit of the file, if the file states it.
    pub(super) fn aperture(&self) -> Option<f64> {
        self.blocking().0.or(Some(self.semi_aperture)).filter(|radius| *radius > 0.0)
    }

    /// Returns true if the surface is a coordinate break that changes no axes.
    pub(super) fn is_idle_break(&self) -> bool {
        self.kind == SurfaceKind::CoordinateBreak && self.parameters[..5] == [0.0; 5]
    }

    /// Returns the radii of a circular aperture and of the obscuration, in the file's unit.
    pub(super) fn blocking(&self) -> (Option<f64>, f64) {
        if self.decentred { (None, 0.0) } else { (self.clear.filter(|radius| *radius > 0.0), self.obscuration) }
    }

    pub(super) fn profile_mm(&self, unit_mm: f64) -> SurfaceProfile {
        let SurfaceProfile { curvature_per_mm, conic, even_terms } = &self.profile;
        let scaled = |(i, term): (usize, &f64)| term * unit_mm.powi(1 - 2 * (i as i32 + 1));
        SurfaceProfile {
            curvature_per_mm: curvature_per_mm / unit_mm,
            conic: *conic,
            even_terms: even_terms.iter().enumerate().map(scaled).collect(),
        }
    }

    /// Converts the surface to mm, with a semi-aperture of 0 if the file lacks it.
    pub(super) fn surface(&self, unit_mm: f64) -> Result<LensSurface> {
        if !self.thickness.is_finite() {
            return Err(Error::input("found an infinite thickness").at(self.line, 1));
        }
        Ok(LensSurface {
            profile: self.profile_mm(unit_mm),
            thickness_mm: self.thickness * unit_mm,
            index: self.index.clone().map_or_else(|| medium("air"), Ok)?,
            semi_aperture_mm: self.aperture().unwrap_or(0.0) * unit_mm,
            obscuration_mm: self.blocking().1 * unit_mm,
            coating: None,
        })
    }
}

/// Returns the index of a glass by name, where `___BLANK` is a model glass of a given n_d and Abbe
/// number. For an unknown name, those of the line replace the formula. The Abbe number 0 means no
/// dispersion.
fn glass(arguments: &[&str], catalogues: &[AgfCatalogue], notes: &mut Vec<String>) -> Result<RefractiveIndex> {
    /// Zemax writes these values into the line of a catalogue glass as placeholders.
    const PLACEHOLDER: (f64, f64) = (1.5, 40.0);
    let Some(name) = arguments.first() else { return Err(Error::input("found no glass name")) };
    let solve = arguments.get(1).copied().unwrap_or_default();
    // The number after the name is 1 for a model glass.
    if *name == "___BLANK" || solve == "1" {
        let (nd, vd) = (number(arguments, 3)?, number(arguments, 4)?);
        if vd == 0.0 {
            note(notes, format!("a model glass of n_d {nd} has the Abbe number 0, so it has no dispersion"));
        }
        return model_glass(nd, vd);
    }
    let unknown = match in_lens_file(name, catalogues, notes) {
        Ok(index) => return Ok(index),
        Err(error) if error.location.file.is_some() => return Err(error),
        Err(error) => error.expected(GLASSES),
    };
    match (number(arguments, 3), number(arguments, 4)) {
        // With 3, Zemax substitutes glasses, and the values may be those of an earlier glass.
        (Ok(nd), Ok(vd)) if nd > 1.0 && vd >= 0.0 && (nd, vd) != PLACEHOLDER && solve != "3" => {
            let what = format!(
                "the glass {name} is unknown; its n_d of {nd} and Abbe number of {vd} in the lens file replace its \
                 dispersion formula"
            );
            note(notes, what);
            model_glass(nd, vd)
        }
        _ => Err(unknown),
    }
}

/// Adds a remark that is not there yet.
fn note(notes: &mut Vec<String>, note: String) {
    if !notes.contains(&note) {
        notes.push(note);
    }
}
