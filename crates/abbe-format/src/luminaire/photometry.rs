//! The content of a luminaire file.

use abbe_scene::light::{IntensityTable, OpeningShape, PhotometricType};
use abbe_spectra::error::Result;
use abbe_spectra::spectrum::Spectrum;

/// The planes about which a distribution is symmetric. The file contains only one part of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LuminaireSymmetry {
    /// The file contains all directions.
    None,
    /// All planes are equal.
    Rotational,
    /// The plane C0–C180 is a mirror.
    AboutC0,
    /// The plane C90–C270 is a mirror.
    AboutC90,
    /// Both planes are mirrors.
    Quadrants,
}

impl LuminaireSymmetry {
    pub fn description(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Rotational => "rotational",
            Self::AboutC0 => "about the plane C0–C180",
            Self::AboutC90 => "about the plane C90–C270",
            Self::Quadrants => "about the planes C0–C180 and C90–C270",
        }
    }
}

/// The luminous opening that a file states. All lengths are in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpeningSize {
    /// The shape of the horizontal cross-section.
    pub shape: OpeningShape,
    /// The length along the direction C0.
    pub along_c0_m: f64,
    /// The length along the direction C90.
    pub along_c90_m: f64,
    /// The height of luminous sides.
    pub height_m: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Photometry {
    pub format: String,
    /// The name of the luminaire. It may be empty.
    pub name: String,
    pub kind: PhotometricType,
    pub symmetry: LuminaireSymmetry,
    /// The vertical angles in degrees, ascending. For type C, these are the angles γ (0 to 180).
    pub vertical_deg: Vec<f64>,
    /// The horizontal angles in degrees, ascending. For type C, these are the angles C.
    pub horizontal_deg: Vec<f64>,
    /// The intensities in cd. There is one plane for each horizontal angle, and each plane has one
    /// value for each vertical angle. All factors of the file are applied.
    pub candela: Vec<f64>,
    /// The luminous flux of the lamps in lm. `None` for absolute photometry of an LM-63 file.
    pub lamp_lumens: Option<f64>,
    /// The electric power in W, if the file states it.
    pub input_watts: Option<f64>,
    pub opening: OpeningSize,
    /// Pairs of a tilt angle of the luminaire in degrees and the factor of its intensity,
    /// ascending. The list is empty if the flux does not depend on the tilt.
    pub tilt: Vec<(f64, f64)>,
    /// The spectrum of the light on any scale. `None` for IES LM-63 and EULUMDAT.
    pub spectrum: Option<Spectrum>,
    /// What the reader decided, or left out.
    pub notes: Vec<String>,
}

impl Photometry {
    /// Returns the intensity in cd over all directions, or an error if all intensities are 0.
    pub fn table(&self) -> Result<IntensityTable> {
        if self.kind == PhotometricType::C {
            return type_c_table(self.symmetry, &self.vertical_deg, &self.horizontal_deg, &self.candela);
        }
        let count = self.vertical_deg.len();
        let mut planes: Vec<Vec<f64>> = self.candela.chunks(count.max(1)).map(<[f64]>::to_vec).collect();
        let (mut polar, mut azimuth) = (self.vertical_deg.clone(), self.horizontal_deg.clone());
        if self.kind == PhotometricType::B {
            // The azimuth is the vertical angle, so the rows and the columns change places.
            planes = (0..count).map(|v| planes.iter().map(|plane| plane[v]).collect()).collect();
            std::mem::swap(&mut polar, &mut azimuth);
        }
        let mirrors = match self.symmetry {
            LuminaireSymmetry::Quadrants => [true, true],
            LuminaireSymmetry::AboutC0 => [self.kind == PhotometricType::A, self.kind == PhotometricType::B],
            LuminaireSymmetry::AboutC90 => [self.kind == PhotometricType::B, self.kind == PhotometricType::A],
            LuminaireSymmetry::None | LuminaireSymmetry::Rotational => [false, false],
        };
        if mirrors[0] {
            planes.iter_mut().for_each(|plane| mirror_below(plane, Clone::clone));
            mirror_below(&mut polar, |angle| -angle);
        }
        if mirrors[1] {
            mirror_below(&mut planes, Clone::clone);
            mirror_below(&mut azimuth, |angle| -angle);
        }
        // The polar angle is 90° minus the latitude.
        polar = polar.iter().rev().map(|latitude| 90.0 - latitude).collect();
        planes.iter_mut().for_each(|plane| plane.reverse());
        IntensityTable::new(self.kind, &radians(&polar), &radians(&azimuth), &planes.concat())
    }

    /// Returns the factor of the intensity for a tilt in degrees, linear between the file's.
    pub fn tilt_factor(&self, tilt_deg: f64) -> f64 {
        let (Some(first), Some(last)) = (self.tilt.first(), self.tilt.last()) else { return 1.0 };
        let tilt = tilt_deg.clamp(first.0, last.0);
        let pair = self.tilt.windows(2).find(|pair| tilt <= pair[1].0);
        pair.map_or(first.1, |pair| {
            let [(from, low), (to, high)] = [pair[0], pair[1]];
            low + (tilt - from) / (to - from) * (high - low)
        })
    }
}

fn radians(degrees: &[f64]) -> Vec<f64> {
    degrees.iter().map(|angle| angle.to_radians()).collect()
}

/// Returns the intensity over all directions from photometry of type C: `candela` contains one
/// plane for each horizontal angle in degrees, with one value for each vertical angle in degrees.
/// Returns an error if all intensities are 0.
pub(super) fn type_c_table(
    symmetry: LuminaireSymmetry,
    vertical_deg: &[f64],
    horizontal_deg: &[f64],
    candela: &[f64],
) -> Result<IntensityTable> {
    let mut planes: Vec<Vec<f64>> = candela.chunks(vertical_deg.len().max(1)).map(<[f64]>::to_vec).collect();
    let mut azimuth = horizontal_deg.to_vec();
    complete_planes(symmetry, &mut azimuth, &mut planes);
    IntensityTable::new(PhotometricType::C, &radians(vertical_deg), &radians(&azimuth), &planes.concat())
}

/// Adds the planes that follow from the symmetry, so that the planes span 360°.
fn complete_planes(symmetry: LuminaireSymmetry, azimuth: &mut Vec<f64>, planes: &mut Vec<Vec<f64>>) {
    match symmetry {
        LuminaireSymmetry::Rotational => {
            *azimuth = vec![0.0, 360.0];
            planes.truncate(1);
            planes.extend(planes.first().cloned());
        }
        LuminaireSymmetry::AboutC0 | LuminaireSymmetry::AboutC90 => mirror_above(azimuth, planes),
        LuminaireSymmetry::Quadrants => {
            mirror_above(azimuth, planes);
            mirror_above(azimuth, planes);
        }
        LuminaireSymmetry::None => {
            let first = azimuth.first().copied().unwrap_or_default();
            if azimuth.last().is_some_and(|last| *last < first + 360.0) {
                azimuth.push(first + 360.0);
                planes.extend(planes.first().cloned());
            }
        }
    }
}

/// Appends the mirror image of the planes at the last plane.
fn mirror_above(azimuth: &mut Vec<f64>, planes: &mut Vec<Vec<f64>>) {
    let mirror = 2.0 * azimuth.last().copied().unwrap_or_default();
    for plane in (0..azimuth.len().saturating_sub(1)).rev() {
        azimuth.push(mirror - azimuth[plane]);
        planes.push(planes[plane].clone());
    }
}

/// Prepends the mirror image of the items at the first item.
fn mirror_below<T: Clone>(items: &mut Vec<T>, image: impl Fn(&T) -> T) {
    let images: Vec<T> = items.iter().skip(1).rev().map(image).collect();
    items.splice(0..0, images);
}
