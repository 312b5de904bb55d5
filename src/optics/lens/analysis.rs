//! What a lens does, in the figures that a designer looks at first.

use super::field::Spot;
use super::paraxial::Paraxial;
use super::prescription::Lens;
use super::trace::{Limits, Monochromatic, Travel};
use crate::error::{Error, Result};
use crate::optics::glass::lines;

/// The lines at which a lens is examined: name and wavelength in nm.
pub const LINES: [(&str, f64); 3] = [("F", lines::F_NM), ("d", lines::D_NM), ("C", lines::C_NM)];

/// The fields at which it is examined, as shares of half the field of view.
const FIELDS: [f64; 3] = [0.0, 0.7, 1.0];

/// Half the field, in degrees, of a lens that states none and lets more through.
const FIELD_DEG: f64 = 20.0;

/// The focus of one line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtLine {
    /// Its name.
    pub line: &'static str,
    /// Its wavelength in nm.
    pub wavelength_nm: f64,
    /// Effective focal length in mm.
    pub efl_mm: f64,
    /// Back focal distance in mm.
    pub bfd_mm: f64,
}

/// How a distant point at an angle to the axis is imaged on the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldPoint {
    /// The angle in degrees.
    pub angle_deg: f64,
    /// Where the chief ray of the d line ends, in mm above the axis.
    pub image_height_mm: f64,
    /// How much farther that is than f·tan(angle), relative; `None` on the axis.
    pub distortion: Option<f64>,
    /// Lateral colour: the chief ray's height at F less that at C, in mm.
    pub lateral_colour_mm: f64,
    /// The spots at [`LINES`].
    pub spots: [Spot; 3],
}

/// A lens with its sensor where the d line focuses light from far away.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// At the d line.
    pub paraxial: Paraxial,
    /// At [`LINES`].
    pub lines: [AtLine; 3],
    /// Half the field of view, in degrees.
    pub half_field_deg: f64,
    /// On the axis, at 0.7 of half the field, and at its edge.
    pub fields: Vec<FieldPoint>,
}

impl Analysis {
    /// Examines a lens; `half_field_deg` (in degrees, above 0 and below 90) takes the place of its own. Fails where it forms no real
    /// image, and where no light passes at that field.
    pub fn of(lens: &Lens, half_field_deg: Option<f64>) -> Result<Self> {
        let at = LINES.map(|(_, nm)| lens.at(nm));
        let [_, d, _] = &at;
        let sensor_z_mm = lens.length_mm() + d.image_distance_mm(f64::INFINITY)?;
        let paraxial = d.paraxial()?;
        let mut foci = Vec::new();
        for (line, at) in LINES.iter().zip(&at) {
            let Paraxial { efl_mm, bfd_mm, .. } = at.paraxial()?;
            foci.push(AtLine { line: line.0, wavelength_nm: line.1, efl_mm, bfd_mm });
        }
        let half_field_deg = half_field_deg.or(lens.half_field_deg()).unwrap_or_else(|| widest_field_deg(d));
        // From the edge inwards, so that a field that is too wide is named as it was asked for.
        let angles = FIELDS.iter().rev().map(|share| share * half_field_deg);
        let field = |angle_deg| field_point(&at, angle_deg, (sensor_z_mm, paraxial.efl_mm));
        let lines = [foci[0], foci[1], foci[2]];
        let mut fields: Vec<FieldPoint> = angles.map(field).collect::<Result<_>>()?;
        fields.reverse();
        Ok(Self { paraxial, lines, half_field_deg, fields })
    }

    /// Longitudinal colour: the back focal distance at F less that at C, in mm.
    pub fn fc_shift_mm(&self) -> f64 {
        self.lines[0].bfd_mm - self.lines[2].bfd_mm
    }
}

/// The widest whole angle whose chief ray passes, at most [`FIELD_DEG`].
fn widest_field_deg(at: &Monochromatic<'_>) -> f64 {
    let passes = |degrees: f64| {
        at.chief_ray(degrees).is_ok_and(|chief| at.trace(chief, Travel::ToSensor, Limits::Apertures).is_ok())
    };
    (1..=FIELD_DEG as u32).map(f64::from).take_while(|degrees| passes(*degrees)).last().unwrap_or(1.0)
}

fn field_point(at: &[Monochromatic<'_>; 3], angle_deg: f64, (sensor_z_mm, efl_mm): (f64, f64)) -> Result<FieldPoint> {
    let [f, d, c] = at;
    let chief = d.chief_ray(angle_deg)?;
    let end_mm = |at: &Monochromatic<'_>| -> Result<f64> {
        let out = at.trace(at.chief_ray(angle_deg)?, Travel::ToSensor, Limits::None);
        out.map(|ray| ray.at_z(sensor_z_mm).y).map_err(|_| dark(angle_deg))
    };
    let mut spots = Vec::new();
    for at in at {
        spots.push(at.spot(chief, sensor_z_mm)?.ok_or_else(|| dark(angle_deg))?);
    }
    let (image_height_mm, ideal_mm) = (end_mm(d)?, efl_mm * angle_deg.to_radians().tan());
    Ok(FieldPoint {
        angle_deg,
        image_height_mm,
        distortion: (ideal_mm != 0.0).then(|| image_height_mm / ideal_mm - 1.0),
        lateral_colour_mm: end_mm(f)? - end_mm(c)?,
        spots: [spots[0], spots[1], spots[2]],
    })
}

pub(super) fn dark(angle_deg: f64) -> Error {
    Error::input(format!("no light passes the lens at {angle_deg} degrees: every ray is vignetted"))
        .expected("a smaller field, or larger apertures")
}
