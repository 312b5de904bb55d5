//! Zemax lens files (`.zmx`): sequential systems of spheres, conics and even aspheres. The media
//! come from the built-in catalogue or from `.agf` files.
//!
//! The file is a list of operands. Each operand has its own line. The operands of a surface are
//! indented under its `SURF` line. The reader uses `MODE`, `NAME`, `UNIT`, `ENPD`, `FNUM`, `FLOA`,
//! `OBNA`, `FTYP`, `XFLN` and `YFLN`. For surfaces, it also uses `STOP`, `TYPE`, `CURV`, `CONI`,
//! `PARM`, `DISZ`, `GLAS`, `DIAM`, `CLAP` and `OBSC`. The reader returns an error for operands that
//! are known to change the rays but are not supported. All other operands are ignored. The first
//! surface is the object, and the last surface is the sensor.
//!
//! A system with mirrors or coordinate breaks becomes a [`FoldedSystem`], which can be analysed but
//! not used in a camera.

mod folded;
mod surface;
#[cfg(test)]
mod tests;

use std::path::Path;

use super::folded::FoldedSystem;
use super::prescription::{ApertureSpec, Lens, Prescription};
use super::profile::SurfaceProfile;
use crate::glass::AgfCatalogue;
use crate::zemax_text::decoded;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{hypot, sin};
use surface::{SurfaceKind, ZmxSurface};

/// A system that a file describes.
#[derive(Debug, Clone)]
pub enum ZmxSystem {
    /// A lens without mirrors.
    Lens(Lens),
    /// A system with mirrors or coordinate breaks.
    Folded(FoldedSystem),
}

/// Parses a lens from the bytes of a file. The encoding is UTF-8, UTF-16 or Latin-1. Error messages
/// contain `path` and the line number. Each glass is searched in `catalogues` first, in the order
/// of the list, and then in the built-in catalogue.
///
/// # Errors
/// Returns an error if an operand is not supported, a glass is unknown, or the surfaces form no
/// valid lens. Also returns an error if the system has mirrors or coordinate breaks.
pub fn parse(bytes: &[u8], path: &Path, catalogues: &[AgfCatalogue]) -> Result<Lens> {
    read(bytes, path, catalogues)?.unfolded().map_err(|error| error.in_file(path))
}

/// Parses a system from the bytes of a file, with or without mirrors. The arguments are those of
/// [`parse`].
///
/// # Errors
/// Returns an error if an operand is not supported, a glass is unknown, or the surfaces form no
/// valid system.
pub fn parse_system(bytes: &[u8], path: &Path, catalogues: &[AgfCatalogue]) -> Result<ZmxSystem> {
    read(bytes, path, catalogues)?.system().map_err(|error| error.in_file(path))
}

/// Reads the operands of a file.
fn read<'a>(bytes: &[u8], path: &Path, catalogues: &'a [AgfCatalogue]) -> Result<ZmxReader<'a>> {
    let text = text(bytes).map_err(|error| error.in_file(path))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut reader = ZmxReader::new(name, catalogues);
    for (i, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let Some(operand) = words.next() else { continue };
        let arguments: Vec<&str> = words.collect();
        reader.read(operand, &arguments, i + 1).map_err(|error| error.at(i + 1, 1).in_file(path))?;
    }
    Ok(reader)
}

/// Returns the names of the glass catalogues (`GCAT`) that a file lists. If the file is not text,
/// the result is empty.
pub fn catalogues(bytes: &[u8]) -> Vec<String> {
    let text = text(bytes).unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.trim().strip_prefix("GCAT "));
    lines.flat_map(str::split_whitespace).map(str::to_string).collect()
}

fn text(bytes: &[u8]) -> Result<String> {
    let expected = "a Zemax lens file in UTF-8 or UTF-16";
    decoded(bytes).ok_or_else(|| Error::input("the file is not text").expected(expected))
}

/// The field points of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FieldKind {
    /// Angles in degrees.
    Angle,
    /// Heights on the object.
    ObjectHeight,
    /// Heights on the image.
    ImageHeight,
}

/// The contents of a file during parsing.
struct ZmxReader<'a> {
    catalogues: &'a [AgfCatalogue],
    name: String,
    unit_mm: f64,
    /// The lengths are in the unit of the file until [`ZmxReader::opening_mm`] converts them.
    opening: ApertureSpec,
    fields: FieldKind,
    /// The number of fields that are in use, if the file states it.
    field_count: Option<usize>,
    field_x: Vec<f64>,
    field_y: Vec<f64>,
    rows: Vec<ZmxSurface>,
    notes: Vec<String>,
}

impl<'a> ZmxReader<'a> {
    fn new(name: String, catalogues: &'a [AgfCatalogue]) -> Self {
        Self {
            catalogues,
            name,
            unit_mm: 1.0,
            opening: ApertureSpec::Stop,
            fields: FieldKind::Angle,
            field_count: None,
            field_x: Vec::new(),
            field_y: Vec::new(),
            rows: Vec::new(),
            notes: Vec::new(),
        }
    }

    fn read(&mut self, operand: &str, arguments: &[&str], line: usize) -> Result<()> {
        let numbers = || arguments.iter().map(|word| parsed(word)).collect::<Result<Vec<f64>>>();
        match operand {
            "MODE" if arguments.first() != Some(&"SEQ") => {
                return Err(unsupported(&format!("the mode {}", arguments.join(" ")), "a sequential system"));
            }
            "NAME" if !arguments.is_empty() => self.name = arguments.join(" "),
            "UNIT" => self.unit_mm = unit_mm(arguments.first().copied().unwrap_or_default())?,
            "ENPD" => self.opening = ApertureSpec::EntrancePupil { diameter_mm: number(arguments, 0)? },
            "FNUM" => self.opening = ApertureSpec::FNumber(number(arguments, 0)?),
            "FLOA" => self.opening = ApertureSpec::Stop,
            "OBNA" => self.opening = object_cone(arguments)?,
            "FTYP" => {
                self.fields = match number(arguments, 0)? {
                    0.0 => FieldKind::Angle,
                    1.0 => FieldKind::ObjectHeight,
                    _ => FieldKind::ImageHeight,
                };
                self.field_count = number(arguments, 2).ok().filter(|count| *count >= 1.0).map(|count| count as usize);
            }
            "XFLN" => self.field_x = numbers()?,
            "YFLN" => self.field_y = numbers()?,
            "SURF" => self.rows.push(ZmxSurface::new(line)),
            _ => {
                if let Some(row) = self.rows.last_mut() {
                    row.read(operand, arguments, self.catalogues, &mut self.notes)?;
                }
            }
        }
        Ok(())
    }

    /// Returns the largest distance of a field from the axis. Returns `None` if the file has only
    /// the field on the axis.
    fn widest_field(&self) -> Option<f64> {
        let count = self.field_count.unwrap_or(usize::MAX).min(self.field_x.len().max(self.field_y.len()));
        let at = |fields: &[f64], i: usize| fields.get(i).copied().unwrap_or(0.0);
        let distances = (0..count).map(|i| hypot(at(&self.field_x, i), at(&self.field_y, i)));
        Some(distances.fold(0.0, f64::max)).filter(|widest| *widest > 0.0)
    }

    /// Removes the object and the image from the surfaces. Returns the distance of the object in mm.
    fn take_ends(&mut self) -> Result<f64> {
        let sensor = self.rows.pop().filter(|_| self.rows.len() > 1);
        let Some(sensor) = sensor else {
            let what = format!("found {} surfaces", self.rows.len());
            return Err(Error::input(what).expected("an object, at least one surface, and an image"));
        };
        if sensor.profile != SurfaceProfile::default() {
            return Err(unsupported("a curved image surface", "a plane sensor").at(sensor.line, 1));
        }
        let object_mm = self.rows.remove(0).thickness * self.unit_mm;
        if object_mm.is_finite() {
            self.notes.push(format!(
                "the lens file has its object {object_mm} mm in front of the first surface; this distance only sets \
                 the aperture and the field"
            ));
        }
        Ok(object_mm)
    }

    fn system(mut self) -> Result<ZmxSystem> {
        let object_mm = self.take_ends()?;
        let is_folded = |row: &ZmxSurface| row.kind != SurfaceKind::Refracting || row.thickness < 0.0;
        if self.rows.iter().any(is_folded) {
            return folded::system(self, object_mm).map(ZmxSystem::Folded);
        }
        self.lens(object_mm).map(ZmxSystem::Lens)
    }

    /// Returns the system as a lens without mirrors.
    fn unfolded(mut self) -> Result<Lens> {
        let object_mm = self.take_ends()?;
        for row in &self.rows {
            let what = match row.kind {
                SurfaceKind::Refracting => continue,
                SurfaceKind::Mirror => "a mirror in a camera lens",
                SurfaceKind::CoordinateBreak => "a coordinate break in a camera lens",
            };
            return Err(unsupported(what, "refracting surfaces on one axis").at(row.line, 1));
        }
        self.lens(object_mm)
    }

    /// Returns the size of the stop in mm. `object_mm` is the distance of the object.
    fn opening_mm(&self, object_mm: f64) -> ApertureSpec {
        match self.opening {
            ApertureSpec::EntrancePupil { diameter_mm } => {
                ApertureSpec::EntrancePupil { diameter_mm: diameter_mm * self.unit_mm }
            }
            ApertureSpec::ObjectCone { tangent, .. } => ApertureSpec::ObjectCone { tangent, object_mm },
            ApertureSpec::Stop | ApertureSpec::FNumber(_) => self.opening,
        }
    }

    /// Returns the system as a lens without mirrors.
    fn lens(self, object_mm: f64) -> Result<Lens> {
        let lines: Vec<usize> = self.rows.iter().map(|row| row.line).collect();
        let surfaces = self.rows.iter().map(|row| row.surface(self.unit_mm)).collect::<Result<_>>()?;
        let stop = self.rows.iter().position(|row| row.stop);
        let opening = self.opening_mm(object_mm);
        let widest = self.widest_field();
        let mut prescription = Prescription {
            name: self.name,
            source: None,
            surfaces,
            stop,
            opening,
            half_field_deg: widest.filter(|_| self.fields == FieldKind::Angle),
            notes: self.notes,
        };
        let heights = widest.filter(|_| self.fields != FieldKind::Angle).map(|height| height * self.unit_mm);
        let complete = match (self.fields, heights) {
            (FieldKind::ImageHeight, Some(height_mm)) => prescription.set_field_of_image(height_mm),
            (FieldKind::ObjectHeight, Some(height_mm)) => prescription.set_field_of_object(height_mm, object_mm),
            (FieldKind::Angle | FieldKind::ImageHeight | FieldKind::ObjectHeight, _) => Ok(()),
        };
        let lens = complete.and_then(|()| prescription.complete_apertures()).and_then(|()| Lens::new(prescription));
        lens.map_err(|error| placed(error, &lines))
    }
}

/// Reads the cone of light from an object point: a numerical aperture, or half the cone's angle in
/// degrees. The distance of the object is not known yet.
fn object_cone(arguments: &[&str]) -> Result<ApertureSpec> {
    let value = number(arguments, 0)?;
    let is_angle = arguments.get(1) == Some(&"1");
    let sine = if is_angle { sin(value.to_radians()) } else { value };
    if !(sine > 0.0 && sine < 1.0) {
        return Err(Error::input(format!("found an object cone of {value}")).expected("a numerical aperture below 1"));
    }
    Ok(ApertureSpec::ObjectCone { tangent: sine / (1.0 - sine * sine).sqrt(), object_mm: f64::INFINITY })
}

/// Adds a line number to an error that contains the path of a surface. The number is the line of
/// the surface in the file.
fn placed(error: Error, lines: &[usize]) -> Error {
    let path = error.location.path.as_deref().unwrap_or_default();
    let surface = path.strip_prefix("surfaces[").and_then(|rest| rest.split(']').next()?.parse::<usize>().ok());
    match surface.and_then(|i| lines.get(i)) {
        Some(&line) => error.at(line, 1),
        None => error,
    }
}

fn unit_mm(unit: &str) -> Result<f64> {
    match unit {
        "MM" => Ok(1.0),
        "CM" => Ok(10.0),
        "IN" => Ok(25.4),
        "METER" => Ok(1000.0),
        _ => Err(unsupported(&format!("the unit {unit}"), "MM, CM, IN or METER")),
    }
}

fn number(arguments: &[&str], i: usize) -> Result<f64> {
    match arguments.get(i) {
        Some(word) => parsed(word),
        None => Err(Error::input(format!("found {} values", arguments.len())).expected(format!("at least {}", i + 1))),
    }
}

fn parsed(word: &str) -> Result<f64> {
    if word == "INFINITY" {
        return Ok(f64::INFINITY);
    }
    let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
    value.ok_or_else(|| Error::input(format!("found \"{word}\"")).expected("a number"))
}

fn unsupported(what: &str, expected: &str) -> Error {
    Error::input(format!("{what} is not supported")).expected(expected)
}
