//! Systems of a Zemax file that are no camera lens, with their surfaces in space.

use glam::{DAffine3, DVec3};

use super::reader::{FieldKind, ZmxReader};
use super::surface::ZmxSurface;
use super::types::SurfaceType;
use super::words::unsupported;
use crate::glass::RefractiveIndex;
use crate::lens::folded::{Deflection, FoldedAperture, FoldedFieldSize, FoldedSurface, FoldedSystem};
use crate::lens::prescription::{ApertureSpec, medium};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::rotation;

/// Places the surfaces of a file, whose object has this distance, in space.
pub(super) fn system(reader: ZmxReader<'_>, object_mm: f64) -> Result<FoldedSystem> {
    let unit_mm = reader.unit_mm;
    let field = match (reader.widest_field(), reader.fields) {
        (None, _) => FoldedFieldSize::Axis,
        (Some(deg), FieldKind::Angle) => FoldedFieldSize::Angle(deg),
        (Some(height), FieldKind::ObjectHeight) => FoldedFieldSize::ObjectHeight(height * unit_mm),
        (Some(height), FieldKind::ImageHeight) => FoldedFieldSize::ImageHeight(height * unit_mm),
    };
    let opening = reader.opening_mm(object_mm);
    let mut frame = DAffine3::IDENTITY;
    let mut surfaces = Vec::new();
    let mut stop = None;
    for row in &reader.rows {
        if !row.thickness.is_finite() {
            return Err(Error::input("found an infinite thickness").at(row.line, 1));
        }
        if row.kind == SurfaceType::CoordinateBreak {
            frame *= coordinate_break(row.coordinates(), unit_mm);
        } else {
            if row.stop {
                stop = Some((surfaces.len(), row.aperture()));
            }
            let [before, behind] = row.breaks.map(|axes| coordinate_break(axes, unit_mm));
            frame *= before;
            surfaces.push(surface(row, frame, unit_mm)?);
            frame *= behind;
        }
        frame *= DAffine3::from_translation(DVec3::Z * row.thickness * unit_mm);
    }
    let (stop, radius) = stop.ok_or_else(|| {
        Error::input("found no stop on a surface").expected("one surface marked as the aperture stop (STOP)")
    })?;
    let aperture = match (opening, radius) {
        (ApertureSpec::EntrancePupil { diameter_mm }, _) => FoldedAperture::EntrancePupil(diameter_mm),
        (ApertureSpec::FNumber(f_number), _) => FoldedAperture::FNumber(f_number),
        (ApertureSpec::Stop, Some(radius)) => FoldedAperture::Stop(radius * unit_mm),
        (ApertureSpec::Stop, None) => {
            return Err(
                Error::input("the size of the stop is not stated").expected("a semi-diameter of the stop (DIAM)")
            );
        }
        (ApertureSpec::ObjectCone { .. }, _) if !object_mm.is_finite() => {
            let what = "found a numerical aperture of an object at infinity";
            return Err(Error::input(what).expected("an object at a finite distance"));
        }
        (ApertureSpec::ObjectCone { tangent, .. }, _) => FoldedAperture::ObjectCone(tangent),
    };
    Ok(FoldedSystem {
        name: reader.name,
        surfaces,
        stop,
        object_mm: Some(object_mm).filter(|object_mm| object_mm.is_finite()),
        object_index: reader.object_index.map_or_else(|| medium("air"), Ok)?,
        image: frame,
        aperture,
        field,
        notes: reader.notes,
    })
}

/// Returns a surface in its place. As in Zemax, a semi-diameter alone blocks no light.
fn surface(row: &ZmxSurface, frame: DAffine3, unit_mm: f64) -> Result<FoldedSurface> {
    let (clear, obscuration) = row.blocking();
    let index = if row.is_mirror { None } else { Some(behind(row)?) };
    let (shape, deflection) = row.shape(unit_mm)?;
    if row.is_mirror && matches!(deflection, Deflection::IdealLens(_)) {
        return Err(unsupported("an ideal lens that is a mirror", "a lens in air or glass").at(row.line, 1));
    }
    Ok(FoldedSurface {
        shape,
        frame,
        index,
        deflection,
        aperture_mm: clear.map(|radius| radius * unit_mm),
        obscuration_mm: obscuration * unit_mm,
    })
}

fn behind(row: &ZmxSurface) -> Result<RefractiveIndex> {
    row.index.clone().map_or_else(|| medium("air"), Ok)
}

/// Returns the transform of a coordinate break from the new axes to those in front of it. With the
/// order 0, they are shifted and then rotated about x, the new y and the new z; with any other
/// order, rotated about z, y and x, and then shifted. The angles are right-handed.
fn coordinate_break([x, y, tilt_x, tilt_y, tilt_z, order]: [f64; 6], unit_mm: f64) -> DAffine3 {
    let shift = DAffine3::from_translation(DVec3::new(x, y, 0.0) * unit_mm);
    let [about_x, about_y, about_z] = rotation::about_axes([tilt_x, tilt_y, tilt_z].map(f64::to_radians));
    if order == 0.0 {
        shift * DAffine3::from_mat3(about_x * about_y * about_z)
    } else {
        DAffine3::from_mat3(about_z * about_y * about_x) * shift
    }
}
