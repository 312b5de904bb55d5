//! Systems of a Zemax file with mirrors or coordinate breaks.

use glam::{DAffine3, DVec3};

use super::reader::{FieldKind, ZmxReader};
use super::surface::{SurfaceKind, ZmxSurface};
use super::words::unsupported;
use crate::lens::folded::{FoldedAperture, FoldedSurface, FoldedSystem};
use crate::lens::prescription::ApertureSpec;
use crate::lens::prescription::medium;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::rotation;

/// Places the surfaces of a file, whose object has this distance, in space.
pub(super) fn system(reader: ZmxReader<'_>, object_mm: f64) -> Result<FoldedSystem> {
    let unit_mm = reader.unit_mm;
    let half_field_deg = reader.widest_field().filter(|_| reader.fields == FieldKind::Angle);
    let opening = reader.opening_mm(object_mm);
    let mut frame = DAffine3::IDENTITY;
    let mut surfaces = Vec::new();
    let mut stop = None;
    for row in &reader.rows {
        if !row.thickness.is_finite() {
            return Err(Error::input("found an infinite thickness").at(row.line, 1));
        }
        if row.kind == SurfaceKind::CoordinateBreak {
            frame *= coordinate_break(row, unit_mm);
        } else {
            if row.stop {
                stop = Some((surfaces.len(), row.aperture()));
            }
            surfaces.push(surface(row, frame, unit_mm)?);
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
        (ApertureSpec::ObjectCone { .. }, _) => {
            let what = "a numerical aperture of the object in a system with mirrors or coordinate breaks";
            return Err(unsupported(what, "an entrance pupil (ENPD), an f-number (FNUM), or the stop's size (FLOA)"));
        }
    };
    let name = reader.name;
    Ok(FoldedSystem { name, surfaces, stop, image: frame, aperture, half_field_deg, notes: reader.notes })
}

/// Returns a surface in its place. As in Zemax, a semi-diameter alone blocks no light.
fn surface(row: &ZmxSurface, frame: DAffine3, unit_mm: f64) -> Result<FoldedSurface> {
    let (clear, obscuration) = row.blocking();
    let index = match row.kind {
        SurfaceKind::Mirror => None,
        SurfaceKind::Refracting | SurfaceKind::CoordinateBreak => {
            Some(row.index.clone().map_or_else(|| medium("air"), Ok)?)
        }
    };
    Ok(FoldedSurface {
        profile: row.profile_mm(unit_mm),
        frame,
        index,
        aperture_mm: clear.map(|radius| radius * unit_mm),
        obscuration_mm: obscuration * unit_mm,
    })
}

/// Returns the transform of a coordinate break from the new axes to those in front of it. With the
/// order 0, they are shifted and then rotated about x, the new y and the new z; with any other
/// order, rotated about z, y and x, and then shifted. The angles are right-handed.
fn coordinate_break(row: &ZmxSurface, unit_mm: f64) -> DAffine3 {
    let [x, y, tilt_x, tilt_y, tilt_z, order] = row.parameters;
    let shift = DAffine3::from_translation(DVec3::new(x, y, 0.0) * unit_mm);
    let [about_x, about_y, about_z] = rotation::about_axes([tilt_x, tilt_y, tilt_z].map(f64::to_radians));
    if order == 0.0 {
        shift * DAffine3::from_mat3(about_x * about_y * about_z)
    } else {
        DAffine3::from_mat3(about_z * about_y * about_x) * shift
    }
}
