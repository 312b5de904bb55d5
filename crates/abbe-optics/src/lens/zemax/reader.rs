//! The operands of a file, and the lens that they describe.

use super::surface::{ZmxSurface, note};
use super::types::SurfaceType;
use super::words::{number, parsed, unsupported};
use crate::glass::{AgfCatalogue, RefractiveIndex};
use crate::lens::prescription::{ApertureSpec, Lens, Prescription};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{hypot, sin};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldKind {
    /// Angles in degrees.
    Angle,
    /// Heights on the object.
    ObjectHeight,
    /// Heights on the image.
    ImageHeight,
}

#[derive(Clone)]
pub(super) struct ZmxReader<'a> {
    catalogues: &'a [AgfCatalogue],
    pub(super) name: String,
    pub(super) unit_mm: f64,
    /// In the unit of the file until [`ZmxReader::opening_mm`] converts them.
    opening: ApertureSpec,
    pub(super) fields: FieldKind,
    /// The number of fields that are in use, if the file states it.
    field_count: Option<usize>,
    field_x: Vec<f64>,
    field_y: Vec<f64>,
    pub(super) rows: Vec<ZmxSurface>,
    /// The medium in front of the first surface, if it is not air.
    pub(super) object_index: Option<RefractiveIndex>,
    pub(super) notes: Vec<String>,
}

impl<'a> ZmxReader<'a> {
    pub(super) fn new(name: String, catalogues: &'a [AgfCatalogue]) -> Self {
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
            object_index: None,
            notes: Vec::new(),
        }
    }

    pub(super) fn read(&mut self, operand: &str, arguments: &[&str], line: usize) -> Result<()> {
        let numbers = || arguments.iter().map(|word| parsed(word)).collect::<Result<Vec<f64>>>();
        match operand {
            "MODE" if arguments.first() == Some(&"NSC") => {
                let what = "a non-sequential system, whose objects light meets in any order,";
                return Err(unsupported(what, "a sequential system (MODE SEQ)"));
            }
            "MODE" if arguments.first() != Some(&"SEQ") => {
                return Err(unsupported(&format!("the mode {}", arguments.join(" ")), "a sequential system"));
            }
            "MNUM" if number(arguments, 0)? > 1.0 => {
                let current = arguments.get(1).copied().unwrap_or("1");
                let what = format!("the file has {} configurations, of which number {current} is read", arguments[0]);
                note(&mut self.notes, what);
            }
            "NAME" if !arguments.is_empty() => self.name = arguments.join(" "),
            "UNIT" => self.unit_mm = unit_mm(arguments.first().copied().unwrap_or_default())?,
            "ENPD" => self.opening = ApertureSpec::EntrancePupil { diameter_mm: number(arguments, 0)? },
            "FNUM" => {
                self.opening = ApertureSpec::FNumber(number(arguments, 0)?);
                if arguments.get(1) == Some(&"1") {
                    note(&mut self.notes, "the working f-number counts as the one for a distant object".to_string());
                }
            }
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

    /// Returns the largest distance of a field from the axis, if there is one beside the axis.
    pub(super) fn widest_field(&self) -> Option<f64> {
        let count = self.field_count.unwrap_or(usize::MAX).min(self.field_x.len().max(self.field_y.len()));
        let at = |fields: &[f64], i: usize| fields.get(i).copied().unwrap_or(0.0);
        let distances = (0..count).map(|i| hypot(at(&self.field_x, i), at(&self.field_y, i)));
        Some(distances.fold(0.0, f64::max)).filter(|widest| *widest > 0.0)
    }

    /// Removes the object and the image, and returns the object's distance in mm.
    pub(super) fn take_ends(&mut self) -> Result<f64> {
        let sensor = self.rows.pop().filter(|_| self.rows.len() > 1);
        let Some(sensor) = sensor else {
            let what = format!("found {} surfaces", self.rows.len());
            return Err(Error::input(what).expected("an object, at least one surface, and an image"));
        };
        if sensor.is_curved() {
            self.notes.push("the image surface is curved; a plane sensor at its vertex replaces it".to_string());
        }
        let object = self.rows.remove(0);
        let mut object_mm = object.thickness * self.unit_mm;
        self.object_index = object.index;
        self.remove_idle_breaks(&mut object_mm);
        for i in 1..self.rows.len() {
            if self.rows[i - 1].kind == SurfaceType::CoordinateBreak && self.rows[i - 1].stop {
                (self.rows[i - 1].stop, self.rows[i].stop) = (false, true);
                self.notes
                    .push("the stop lies on a coordinate break, so the surface behind it is the stop".to_string());
            }
        }
        if self.rows.iter().all(|row| !row.stop) {
            let first = self.rows.iter_mut().find(|row| row.kind != SurfaceType::CoordinateBreak);
            first.ok_or_else(|| Error::input("found no surface").expected("at least one"))?.stop = true;
            self.notes.push("the lens file marks no aperture stop, so the first surface is the stop".to_string());
        }
        if object_mm.is_finite() {
            self.notes.push(format!(
                "the lens file has its object {object_mm} mm in front of the first surface; this distance only sets \
                 the aperture and the field"
            ));
        }
        Ok(object_mm)
    }

    /// Removes coordinate breaks without a shift or a tilt, and adds their thickness to the
    /// distance in front of them.
    fn remove_idle_breaks(&mut self, object_mm: &mut f64) {
        let mut kept: Vec<ZmxSurface> = Vec::new();
        for row in self.rows.drain(..) {
            if !row.is_idle_break() {
                kept.push(row);
            } else if let Some(before) = kept.last_mut() {
                before.thickness += row.thickness;
                before.stop |= row.stop;
            } else {
                *object_mm += row.thickness * self.unit_mm;
            }
        }
        self.rows = kept;
    }

    pub(super) fn unfolded(mut self) -> Result<Lens> {
        let object_mm = self.take_ends()?;
        let unfit = self.rows.iter().find_map(|row| Some((row.line, row.not_in_camera()?)));
        if let Some((line, what)) = unfit {
            let what = format!("{what} in a camera lens");
            return Err(unsupported(&what, "refracting surfaces of revolution on one axis").at(line, 1));
        }
        self.lens(object_mm)
    }

    /// Returns the size of the stop in mm, for an object at this distance.
    pub(super) fn opening_mm(&self, object_mm: f64) -> ApertureSpec {
        match self.opening {
            ApertureSpec::EntrancePupil { diameter_mm } => {
                ApertureSpec::EntrancePupil { diameter_mm: diameter_mm * self.unit_mm }
            }
            ApertureSpec::ObjectCone { tangent, .. } => ApertureSpec::ObjectCone { tangent, object_mm },
            ApertureSpec::Stop | ApertureSpec::FNumber(_) => self.opening,
        }
    }

    pub(super) fn lens(self, object_mm: f64) -> Result<Lens> {
        if self.object_index.is_some() {
            return Err(unsupported("an object in glass in front of a camera lens", "an object in air"));
        }
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
        let lens = complete.and_then(|()| prescription.complete_apertures()).and_then(|()| {
            for (i, semi_mm) in prescription.limit_apertures() {
                let line = lines.get(i).copied().unwrap_or_default();
                prescription.notes.push(format!(
                    "the semi-diameter of the surface of line {line} is {semi_mm:.4} mm and not larger, because there \
                     the surface ends or meets the next one"
                ));
            }
            Lens::new(prescription)
        });
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

/// Adds the line in the file to an error that contains the path of a surface.
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
