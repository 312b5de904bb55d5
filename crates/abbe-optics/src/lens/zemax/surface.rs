//! The surfaces of a Zemax file: their operands, glasses and apertures.

use super::types::SurfaceType;
use super::words::{number, unsupported};
use crate::glass::makers::{in_lens_file, model_glass};
use crate::glass::{AgfCatalogue, RefractiveIndex};
use crate::lens::folded::{Deflection, FoldedShape};
use crate::lens::prescription::{LensSurface, medium};
use crate::lens::profile::SurfaceProfile;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::hypot;

const GLASSES: &str =
    "a glass of the built-in catalogue or of its makers, or of an .agf catalogue that is read with the lens";

/// A surface during parsing, with lengths in the unit of the file.
#[derive(Debug, Clone)]
pub(super) struct ZmxSurface {
    pub(super) line: usize,
    pub(super) kind: SurfaceType,
    pub(super) is_mirror: bool,
    curvature: f64,
    conic: f64,
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
    /// The parameters from 0, and the extra data from 1.
    parameters: Vec<f64>,
    data: Vec<f64>,
    /// The coordinate breaks in front of the surface and behind it, as of [`coordinate_break`].
    ///
    /// [`coordinate_break`]: super::folded
    pub(super) breaks: [[f64; 6]; 2],
}

impl ZmxSurface {
    pub(super) fn new(line: usize) -> Self {
        Self {
            line,
            kind: SurfaceType::Standard,
            is_mirror: false,
            curvature: 0.0,
            conic: 0.0,
            thickness: 0.0,
            index: None,
            semi_aperture: 0.0,
            clear: None,
            obscuration: 0.0,
            decentred: false,
            stop: false,
            parameters: Vec::new(),
            data: Vec::new(),
            breaks: [[0.0; 6]; 2],
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
            "TYPE" => {
                self.kind = SurfaceType::named(&arguments.join(" "))?;
                if self.kind == SurfaceType::JonesMatrix {
                    let what = format!("the Jones matrix of line {} changes no ray, and is left out", self.line);
                    note(notes, what);
                }
            }
            "CURV" => self.curvature = number(arguments, 0)?,
            "CONI" => self.conic = number(arguments, 0)?,
            "DISZ" => self.thickness = number(arguments, 0)?,
            "DIAM" => self.semi_aperture = number(arguments, 0)?.max(0.0),
            "GLAS" if arguments.first() == Some(&"MIRROR") => self.is_mirror = true,
            "GLAS" => self.index = Some(glass(arguments, catalogues, notes)?),
            "PARM" => place(&mut self.parameters, number(arguments, 0)?, number(arguments, 1)?)?,
            "XDAT" => place(&mut self.data, number(arguments, 0)? - 1.0, number(arguments, 1)?)?,
            "SCBD" => self.read_tilt(arguments)?,
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

    /// Reads the tilt of one surface: in front of it (1) or behind it (2), the order, a mark of how
    /// the program found the values, and the values, those of a coordinate break.
    fn read_tilt(&mut self, arguments: &[&str]) -> Result<()> {
        let Some(axes) = self.breaks.get_mut(number(arguments, 0)? as usize - 1) else {
            return Err(unsupported(&format!("the tilt SCBD {}", arguments.join(" ")), "1 or 2"));
        };
        for (value, i) in axes.iter_mut().zip([3, 4, 5, 6, 7, 1]) {
            *value = number(arguments, i)?;
        }
        Ok(())
    }

    /// Returns the radius of the aperture in the unit of the file, if the file states it.
    pub(super) fn aperture(&self) -> Option<f64> {
        self.blocking().0.or(Some(self.semi_aperture)).filter(|radius| *radius > 0.0)
    }

    /// Returns the parameters 1 to 6 of a coordinate break: decentres, tilts in degrees, and the
    /// order.
    pub(super) fn coordinates(&self) -> [f64; 6] {
        std::array::from_fn(|i| self.parameters.get(i + 1).copied().unwrap_or(0.0))
    }

    /// Returns true if the surface is a coordinate break that changes no axes.
    pub(super) fn is_idle_break(&self) -> bool {
        self.kind == SurfaceType::CoordinateBreak && self.coordinates()[..5] == [0.0; 5]
    }

    /// Returns what makes a system of this surface unfit for a camera, if anything does.
    pub(super) fn not_in_camera(&self) -> Option<&'static str> {
        if self.is_mirror {
            Some("a mirror")
        } else if self.breaks.iter().any(|axes| axes[..5] != [0.0; 5]) {
            Some("a tilted surface")
        } else if self.thickness < 0.0 {
            Some("a negative thickness")
        } else {
            self.kind.not_in_camera()
        }
    }

    /// Returns true if the surface is not a plane.
    pub(super) fn is_curved(&self) -> bool {
        self.curvature != 0.0 || self.parameters.iter().chain(&self.data).any(|value| *value != 0.0)
    }

    /// Returns the radii of a circular aperture and of the obscuration, in the file's unit.
    pub(super) fn blocking(&self) -> (Option<f64>, f64) {
        if self.decentred { (None, 0.0) } else { (self.clear.filter(|radius| *radius > 0.0), self.obscuration) }
    }

    /// Returns the shape in mm and the deflection. Returns an error if a parameter is not supported.
    pub(super) fn shape(&self, unit_mm: f64) -> Result<(FoldedShape, Deflection)> {
        let base =
            SurfaceProfile { curvature_per_mm: self.curvature / unit_mm, conic: self.conic, even_terms: [].into() };
        let shape = self.kind.shape(base, &self.parameters, &self.data, unit_mm);
        shape.map_err(|error| error.at(self.line, 1))
    }

    /// Converts the surface to mm, with a semi-aperture of 0 if the file lacks it.
    pub(super) fn surface(&self, unit_mm: f64) -> Result<LensSurface> {
        if !self.thickness.is_finite() {
            return Err(Error::input("found an infinite thickness").at(self.line, 1));
        }
        let (FoldedShape::Revolved(profile), Deflection::None) = self.shape(unit_mm)? else {
            return Err(unsupported("this surface in a camera lens", "a surface of revolution").at(self.line, 1));
        };
        Ok(LensSurface {
            profile,
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

/// Stores a value of a list, in which the others are 0.
fn place(values: &mut Vec<f64>, at: f64, value: f64) -> Result<()> {
    /// More than any type of surface has.
    const LONGEST: f64 = 1000.0;
    if at.fract() != 0.0 || !(0.0..LONGEST).contains(&at) {
        return Err(unsupported(&format!("the parameter {at}"), &format!("a number from 0 to {LONGEST}")));
    }
    values.resize(values.len().max(at as usize + 1), 0.0);
    values[at as usize] = value;
    Ok(())
}

/// Adds a remark that is not there yet.
pub(super) fn note(notes: &mut Vec<String>, note: String) {
    if !notes.contains(&note) {
        notes.push(note);
    }
}
