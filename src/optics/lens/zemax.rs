//! Zemax lens files (`.zmx`): sequential systems of spheres, conics and even aspheres. The media
//! come from the built-in catalogue or from `.agf` files.
//!
//! The file is a list of operands. Each operand has its own line. The operands of a surface are
//! indented under its `SURF` line. The reader uses `MODE`, `NAME`, `UNIT`, `ENPD`, `FNUM`, `FLOA`,
//! `FTYP` and `YFLN`. For surfaces, it also uses `STOP`, `TYPE`, `CURV`, `CONI`, `PARM`, `DISZ`,
//! `GLAS`, `DIAM` and `CLAP`. The reader returns an error for operands that are known to change the
//! rays but are not supported. All other operands are ignored. The first surface is the object, and
//! the last surface is the sensor.

use std::path::Path;

use super::prescription::{ApertureSpec, Lens, LensSurface, Prescription, medium};
use super::profile::SurfaceProfile;
use crate::error::{Error, Result};
use crate::optics::glass::{AgfCatalogue, RefractiveIndex};
use crate::optics::zemax_text::decoded;

/// Parses a lens from the bytes of a file. The encoding is UTF-8, UTF-16 or Latin-1. Error messages
/// contain `path` and the line number. Each glass is searched in `catalogues` first, in the order
/// of the list, and then in the built-in catalogue.
///
/// # Errors
/// Returns an error if an operand is not supported, a glass is unknown, or the surfaces form no
/// valid lens.
pub fn parse(bytes: &[u8], path: &Path, catalogues: &[AgfCatalogue]) -> Result<Lens> {
    let text = text(bytes).map_err(|error| error.in_file(path))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut reader = ZmxReader::new(name, catalogues);
    for (i, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let Some(operand) = words.next() else { continue };
        let arguments: Vec<&str> = words.collect();
        reader.read(operand, &arguments, i + 1).map_err(|error| error.at(i + 1, 1).in_file(path))?;
    }
    reader.finish().map_err(|error| error.in_file(path))
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

/// A surface during parsing, with lengths in the unit of the file.
struct ZmxSurface {
    line: usize,
    profile: SurfaceProfile,
    thickness: f64,
    index: Option<RefractiveIndex>,
    semi_aperture: f64,
    /// Radius of a circular aperture. If it is given, it replaces the semi-diameter.
    clear: Option<f64>,
    stop: bool,
    aspheric: bool,
}

struct ZmxReader<'a> {
    catalogues: &'a [AgfCatalogue],
    name: String,
    unit_mm: f64,
    /// The lengths are in the unit of the file until [`ZmxReader::finish`] converts them.
    opening: ApertureSpec,
    fields_are_angles: bool,
    half_field_deg: Option<f64>,
    rows: Vec<ZmxSurface>,
}

impl<'a> ZmxReader<'a> {
    fn new(name: String, catalogues: &'a [AgfCatalogue]) -> Self {
        let opening = ApertureSpec::Stop;
        Self {
            catalogues,
            name,
            unit_mm: 1.0,
            opening,
            fields_are_angles: true,
            half_field_deg: None,
            rows: Vec::new(),
        }
    }

    fn read(&mut self, operand: &str, arguments: &[&str], line: usize) -> Result<()> {
        match operand {
            "MODE" if arguments.first() != Some(&"SEQ") => {
                return Err(unsupported(&format!("the mode {}", arguments.join(" ")), "a sequential system"));
            }
            "NAME" if !arguments.is_empty() => self.name = arguments.join(" "),
            "UNIT" => self.unit_mm = unit_mm(arguments.first().copied().unwrap_or_default())?,
            "ENPD" => self.opening = ApertureSpec::EntrancePupil { diameter_mm: number(arguments, 0)? },
            "FNUM" => self.opening = ApertureSpec::FNumber(number(arguments, 0)?),
            "FLOA" => self.opening = ApertureSpec::Stop,
            "OBNA" => return Err(unsupported("an aperture stated by the object's numerical aperture", APERTURES)),
            "FTYP" => self.fields_are_angles = number(arguments, 0)? == 0.0,
            "YFLN" => {
                let angles = arguments.iter().map(|word| parsed(word)).collect::<Result<Vec<f64>>>()?;
                let widest = angles.into_iter().map(f64::abs).fold(0.0, f64::max);
                self.half_field_deg = (widest > 0.0).then_some(widest);
            }
            "SURF" => self.rows.push(ZmxSurface {
                line,
                profile: SurfaceProfile::default(),
                thickness: 0.0,
                index: None,
                semi_aperture: 0.0,
                clear: None,
                stop: false,
                aspheric: false,
            }),
            _ => {
                if let Some(row) = self.rows.last_mut() {
                    row.read(operand, arguments, self.catalogues)?;
                }
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<Lens> {
        let Self { catalogues: _, name, unit_mm, opening, fields_are_angles, half_field_deg, mut rows } = self;
        let sensor = rows.pop().filter(|_| rows.len() > 1);
        let Some(sensor) = sensor else {
            let what = format!("found {} surfaces", rows.len());
            return Err(Error::input(what).expected("an object, at least one surface, and an image"));
        };
        if sensor.profile != SurfaceProfile::default() {
            return Err(unsupported("a curved image surface", "a plane sensor").at(sensor.line, 1));
        }
        rows.remove(0);
        let stop = rows.iter().position(|row| row.stop);
        let lines: Vec<usize> = rows.iter().map(|row| row.line).collect();
        let opening = match opening {
            ApertureSpec::EntrancePupil { diameter_mm } => {
                ApertureSpec::EntrancePupil { diameter_mm: diameter_mm * unit_mm }
            }
            ApertureSpec::Stop | ApertureSpec::FNumber(_) => opening,
        };
        let surfaces = rows.into_iter().map(|row| row.surface(unit_mm)).collect::<Result<_>>()?;
        let half_field_deg = half_field_deg.filter(|_| fields_are_angles);
        let lens = Lens::new(Prescription { name, source: None, surfaces, stop, opening, half_field_deg });
        lens.map_err(|error| placed(error, &lines))
    }
}

const GLASSES: &str = "a glass of the built-in catalogue, or of an .agf catalogue that is read with the lens";

const APERTURES: &str = "an entrance pupil diameter (ENPD), an f-number (FNUM), or the stop's size (FLOA)";

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

impl ZmxSurface {
    fn read(&mut self, operand: &str, arguments: &[&str], catalogues: &[AgfCatalogue]) -> Result<()> {
        match operand {
            "STOP" => self.stop = true,
            "TYPE" => match arguments.first() {
                Some(&"STANDARD") => {}
                Some(&"EVENASPH") => self.aspheric = true,
                _ => {
                    let what = format!("a surface of type {}", arguments.join(" "));
                    return Err(unsupported(&what, "STANDARD or EVENASPH"));
                }
            },
            "CURV" => self.profile.curvature_per_mm = number(arguments, 0)?,
            "CONI" => self.profile.conic = number(arguments, 0)?,
            "DISZ" => self.thickness = number(arguments, 0)?,
            "DIAM" => self.semi_aperture = number(arguments, 0)?,
            "GLAS" => self.index = Some(glass(arguments, catalogues)?),
            "PARM" if self.aspheric => self.read_term(number(arguments, 0)?, number(arguments, 1)?)?,
            "CLAP" if number(arguments, 0)? == 0.0 => self.clear = Some(number(arguments, 1)?),
            "CLAP" | "SQAP" | "ELAP" | "OBSC" | "SQOB" | "ELOB" | "UDAD" => {
                let what = format!("the aperture {operand} {}", arguments.join(" "));
                return Err(unsupported(&what, "a round one (CLAP 0 RADIUS), or the semi-diameter (DIAM)"));
            }
            _ => {}
        }
        Ok(())
    }

    /// Sets the coefficient of h^(2·order).
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

    /// Converts the surface to mm.
    fn surface(self, unit_mm: f64) -> Result<LensSurface> {
        let Self { line, profile: SurfaceProfile { curvature_per_mm, conic, even_terms }, thickness, index, .. } = self;
        if !thickness.is_finite() {
            return Err(Error::input("found an infinite thickness").at(line, 1));
        }
        let scaled = |(i, term): (usize, &f64)| term * unit_mm.powi(1 - 2 * (i as i32 + 1));
        Ok(LensSurface {
            profile: SurfaceProfile {
                curvature_per_mm: curvature_per_mm / unit_mm,
                conic,
                even_terms: even_terms.iter().enumerate().map(scaled).collect(),
            },
            thickness_mm: thickness * unit_mm,
            index: index.map_or_else(|| medium("air"), Ok)?,
            semi_aperture_mm: self.clear.unwrap_or(self.semi_aperture) * unit_mm,
        })
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

/// Returns the index of a glass by name. `___BLANK` is a model glass with a given n_d and Abbe
/// number.
fn glass(arguments: &[&str], catalogues: &[AgfCatalogue]) -> Result<RefractiveIndex> {
    match arguments.first() {
        Some(&"MIRROR") => Err(unsupported("a mirror", "a glass of the catalogue")),
        Some(&"___BLANK") => RefractiveIndex::abbe(number(arguments, 3)?, number(arguments, 4)?),
        Some(name) => match catalogues.iter().find(|file| file.has(name)) {
            Some(file) => Ok(file.find(name)?.index),
            None => medium(name).map_err(|error| error.expected(GLASSES)),
        },
        None => Err(Error::input("found no glass name")),
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
