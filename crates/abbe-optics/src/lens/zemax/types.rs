//! The types of surfaces of a Zemax file, and the shapes that their parameters describe.

use glam::DVec2;

use super::words::unsupported;
use crate::lens::folded::{Deflection, FoldedShape};
use crate::lens::freeform::{FRINGE_TERMS, Freeform, FreeformTerms, ZernikeTerm};
use crate::lens::profile::SurfaceProfile;
use abbe_spectra::error::{Error, Result};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SurfaceType {
    Standard,
    /// A shift and a rotation of the axes for the surfaces behind it.
    CoordinateBreak,
    EvenAsphere,
    ExtendedAsphere,
    OddAsphere,
    ExtendedOddAsphere,
    Biconic,
    Toroid,
    Tilted,
    Polynomial,
    FringeSag,
    StandardSag,
    Paraxial,
    ParaxialXy,
    Grating,
    Binary2,
    /// A change of the polarisation, which bends no ray.
    JonesMatrix,
}

/// The types with their names in the file, and what they are called in errors about cameras.
const TYPES: [(&str, SurfaceType, Option<&str>); 17] = [
    ("STANDARD", SurfaceType::Standard, None),
    ("COORDBRK", SurfaceType::CoordinateBreak, Some("a coordinate break")),
    ("EVENASPH", SurfaceType::EvenAsphere, None),
    ("XASPHERE", SurfaceType::ExtendedAsphere, None),
    ("ODDASPHE", SurfaceType::OddAsphere, Some("an odd asphere")),
    ("XODDASPH", SurfaceType::ExtendedOddAsphere, Some("an odd asphere")),
    ("BICONICX", SurfaceType::Biconic, Some("a biconic surface")),
    ("TOROIDAL", SurfaceType::Toroid, Some("a toroid")),
    ("TILTSURF", SurfaceType::Tilted, Some("a tilted surface")),
    ("XPOLYNOM", SurfaceType::Polynomial, Some("a polynomial surface")),
    ("FZERNSAG", SurfaceType::FringeSag, Some("a Zernike surface")),
    ("SZERNSAG", SurfaceType::StandardSag, Some("a Zernike surface")),
    ("PARAXIAL", SurfaceType::Paraxial, Some("an ideal lens")),
    ("PARAX_XY", SurfaceType::ParaxialXy, Some("an ideal lens")),
    ("DGRATING", SurfaceType::Grating, Some("a grating")),
    ("BINARY_2", SurfaceType::Binary2, Some("a diffractive surface")),
    ("JONESMAT", SurfaceType::JonesMatrix, None),
];

impl SurfaceType {
    /// Returns the type with the name in the file. The error says why others have no meaning here.
    pub(super) fn named(name: &str) -> Result<Self> {
        if let Some((_, kind, _)) = TYPES.iter().find(|(known, _, _)| *known == name) {
            return Ok(*kind);
        }
        let what = match name {
            "NONSEQCO" => " (a group of objects that light meets in any order)".to_string(),
            _ if name.starts_with("USERSURF") => " (a program of the user computes it)".to_string(),
            _ if name.starts_with("GRIN") || name.starts_with("GRADIEN") => {
                " (the index varies within the glass)".to_string()
            }
            _ => String::new(),
        };
        let names = TYPES.map(|(name, _, _)| name).join(", ");
        Err(unsupported(&format!("a surface of type {name}{what}"), &names))
    }

    /// Returns what makes a system with this type of surface unfit for a camera, if anything does.
    pub(super) fn not_in_camera(self) -> Option<&'static str> {
        TYPES.iter().find(|(_, kind, _)| *kind == self).and_then(|(_, _, what)| *what)
    }

    /// Returns the shape in mm and the deflection of a surface with this conic as its base, and the
    /// parameters, from 0, and extra data, from 1, of the file. Returns an error if a value that is
    /// not 0 has no meaning for this type.
    pub(super) fn shape(
        self,
        base: SurfaceProfile,
        parameters: &[f64],
        data: &[f64],
        unit_mm: f64,
    ) -> Result<(FoldedShape, Deflection)> {
        let at = |i: usize| parameters.get(i).copied().unwrap_or(0.0);
        let used = |first: usize, last: usize| check_unused(parameters, first, last);
        // Coefficients from parameter `first`, each for the next power of the square of the height.
        let even = |first: usize, last: usize| {
            used(first.min(1), last)?;
            let coefficients = parameters.get(first..(last + 1).min(parameters.len())).unwrap_or_default();
            Ok(scaled(coefficients, |i| unit_mm.powi(-1 - 2 * i)))
        };
        let revolved = |base| FoldedShape::Revolved(base);
        let freeform = |base, terms| (FoldedShape::Freeform(Freeform { base, terms }), Deflection::None);
        let plain = |shape| (shape, Deflection::None);
        let curvature = |radius: f64| if radius == 0.0 { 0.0 } else { 1.0 / (radius * unit_mm) };
        Ok(match self {
            Self::Standard | Self::CoordinateBreak | Self::JonesMatrix => plain(revolved(base)),
            Self::EvenAsphere => plain(revolved(SurfaceProfile { even_terms: even(1, 8)?, ..base })),
            Self::ExtendedAsphere => {
                used(0, 0)?;
                let (coefficients, radius_mm) = normalised(data, unit_mm)?;
                let even_terms = scaled(coefficients, |i| unit_mm / radius_mm.powi(2 * i + 2));
                plain(revolved(SurfaceProfile { even_terms, ..base }))
            }
            Self::OddAsphere => {
                used(1, 8)?;
                let coefficients = scaled(parameters.get(1..).unwrap_or_default(), |i| unit_mm.powi(-i));
                freeform(base, FreeformTerms::Powers { coefficients, radius_mm: 1.0 })
            }
            Self::ExtendedOddAsphere => {
                used(0, 0)?;
                let (coefficients, radius_mm) = normalised(data, unit_mm)?;
                let coefficients = scaled(coefficients, |_| unit_mm);
                freeform(base, FreeformTerms::Powers { coefficients, radius_mm })
            }
            Self::Biconic => {
                used(1, 2)?;
                freeform(base, FreeformTerms::Biconic { curvature_x_per_mm: curvature(at(1)), conic_x: at(2) })
            }
            Self::Toroid => {
                if data.first().is_some_and(|count| *count > 0.0) {
                    return Err(unsupported("a toroid with Zernike terms", "a toroid without them (XDAT 1 of 0)"));
                }
                let base = SurfaceProfile { even_terms: even(2, 8)?, ..base };
                freeform(base, FreeformTerms::Toroid { curvature_x_per_mm: curvature(at(1)) })
            }
            Self::Tilted => {
                used(1, 2)?;
                let coefficients = [at(1), at(2)].into();
                freeform(SurfaceProfile::default(), FreeformTerms::Polynomial { coefficients, radius_mm: 1.0 })
            }
            Self::Polynomial => {
                used(0, 0)?;
                let (coefficients, radius_mm) = normalised(data, unit_mm)?;
                let coefficients = scaled(coefficients, |_| unit_mm);
                freeform(base, FreeformTerms::Polynomial { coefficients, radius_mm })
            }
            Self::FringeSag | Self::StandardSag => {
                let base = SurfaceProfile { even_terms: even(1, 8)?, ..base };
                let (coefficients, radius_mm) = normalised(data, unit_mm)?;
                let is_fringe = self == Self::FringeSag;
                if is_fringe && coefficients.len() > FRINGE_TERMS {
                    let what = format!("found {} fringe polynomials", coefficients.len());
                    return Err(Error::input(what).expected(format!("at most {FRINGE_TERMS}")));
                }
                let term = if is_fringe { ZernikeTerm::fringe } else { ZernikeTerm::noll };
                let terms = (1..).zip(coefficients).filter(|(_, value)| **value != 0.0);
                let coefficients = terms.map(|(j, value)| term(j, value * unit_mm)).collect();
                freeform(base, FreeformTerms::Zernike { coefficients, radius_mm })
            }
            Self::Paraxial => {
                // Parameter 2 selects how the path length is computed, which changes no ray.
                used(1, 2)?;
                let power = DVec2::splat(curvature(at(1)));
                (revolved(SurfaceProfile::default()), Deflection::IdealLens(power))
            }
            Self::ParaxialXy => {
                used(1, 2)?;
                let power = DVec2::new(at(1), at(2)) / unit_mm;
                (revolved(SurfaceProfile::default()), Deflection::IdealLens(power))
            }
            Self::Grating => {
                used(1, 2)?;
                (revolved(base), Deflection::Lines(at(1) * at(2) * 1e3))
            }
            Self::Binary2 => {
                let base = SurfaceProfile { even_terms: even(1, 8)?, ..base };
                let (coefficients, radius_mm) = normalised(data, unit_mm)?;
                let order = parameters.first().copied().unwrap_or(1.0);
                let coefficients = scaled(coefficients, |_| order);
                (revolved(base), Deflection::Radial { coefficients, radius_mm })
            }
        })
    }
}

/// Returns an error if a parameter outside `first` to `last`, except number 0, is not 0.
fn check_unused(parameters: &[f64], first: usize, last: usize) -> Result<()> {
    let unused = |(i, value): &(usize, &f64)| *i > 0 && !(first..=last).contains(i) && **value != 0.0;
    match parameters.iter().enumerate().find(unused) {
        Some((i, value)) => Err(unsupported(&format!("the parameter {i} with the value {value}"), "0")),
        None => Ok(()),
    }
}

/// Returns coefficients, each times a factor that depends on its index.
fn scaled(coefficients: &[f64], factor: impl Fn(i32) -> f64) -> Box<[f64]> {
    (0..).zip(coefficients).map(|(i, value)| value * factor(i)).collect()
}

/// Returns the coefficients of extra data, which are their count, the unit of length, and the
/// coefficients, and the unit of length in mm.
fn normalised(data: &[f64], unit_mm: f64) -> Result<(&[f64], f64)> {
    let (count, radius) = (data.first().copied().unwrap_or(0.0), data.get(1).copied().unwrap_or(0.0));
    let coefficients = data.get(2..).unwrap_or_default();
    let coefficients = &coefficients[..coefficients.len().min(count.max(0.0) as usize)];
    if coefficients.is_empty() {
        return Ok((coefficients, 1.0));
    }
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(Error::input(format!("found a norm radius of {radius}")).expected("a number above 0 (XDAT 2)"));
    }
    Ok((coefficients, radius * unit_mm))
}
