//! Aberrations on the axis: the longitudinal aberration against the height in the pupil, and the
//! focus against the wavelength.

use glam::DVec3;

use super::analysis::LensAnalysis;
use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay, MonochromaticLens};
use abbe_spectra::error::Result;

/// The aberrations of the point on the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialColour {
    /// Heights in the entrance pupil, divided by the radius of the pupil, from 0 to 1.
    pub pupil: Vec<f64>,
    /// For each wavelength of the analysis the longitudinal aberration: the distance in mm from the
    /// sensor to the crossing of the ray with the axis, or `None` for a ray that is blocked. At the
    /// height 0 it is the paraxial focus.
    pub longitudinal_mm: Vec<Vec<Option<f64>>>,
    /// Wavelengths in nm of the chromatic focal shift.
    pub nm: Vec<f64>,
    /// Paraxial back focus in mm minus that of the reference wavelength.
    pub focal_shift_mm: Vec<f64>,
}

const PUPIL_STEPS: u32 = 40;
/// The range in nm of the chromatic focal shift, which other wavelengths of the analysis widen.
const RANGE_NM: (f64, f64) = (400.0, 700.0);
const STEP_NM: f64 = 5.0;

impl AxialColour {
    /// Computes the aberrations on the axis. Returns an error if the lens has no focus at one of
    /// the wavelengths.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Self> {
        let pupil: Vec<f64> = (0..=PUPIL_STEPS).map(|i| f64::from(i) / f64::from(PUPIL_STEPS)).collect();
        let radius_mm = analysis.paraxial.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
        let at = analysis.at(lens);
        let longitudinal = |(i, at): (usize, &MonochromaticLens<'_>)| {
            let paraxial_mm = lens.length_mm() + analysis.lines[i].bfd_mm - analysis.sensor_z_mm;
            let rays = pupil.iter().skip(1).map(|p| Some(axial_crossing_mm(at, p * radius_mm)? - analysis.sensor_z_mm));
            std::iter::once(Some(paraxial_mm)).chain(rays).collect()
        };
        let nm_of_lines = || analysis.lines.iter().map(|line| line.wavelength_nm);
        let (from_nm, to_nm) = (nm_of_lines().fold(RANGE_NM.0, f64::min), nm_of_lines().fold(RANGE_NM.1, f64::max));
        let steps = ((to_nm - from_nm) / STEP_NM).ceil();
        let nm: Vec<f64> = (0..=steps as u32).map(|i| from_nm + (to_nm - from_nm) * f64::from(i) / steps).collect();
        let shift = |nm: &f64| Ok(lens.at(*nm).paraxial()?.bfd_mm - analysis.paraxial.bfd_mm);
        Ok(Self {
            longitudinal_mm: at.iter().enumerate().map(longitudinal).collect(),
            pupil,
            focal_shift_mm: nm.iter().map(shift).collect::<Result<_>>()?,
            nm,
        })
    }
}

/// Returns z in mm where a ray that enters parallel to the axis at this height crosses the axis.
fn axial_crossing_mm(at: &MonochromaticLens<'_>, height_mm: f64) -> Option<f64> {
    // Just inside the rim, so that rounding does not block the outermost ray.
    let ray = LensRay { origin: DVec3::new(0.0, height_mm * (1.0 - 1e-9), 0.0), direction: DVec3::Z };
    let out = at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).ok()?;
    let crossing_mm = out.origin.z - out.origin.y * out.direction.z / out.direction.y;
    crossing_mm.is_finite().then_some(crossing_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::catalogue;
    use crate::lens::test_lens::{TestSurface, lens_of};

    /// A thin plano-convex lens of n = 1.5 and f = 100 mm at f/20, with these radii in mm.
    fn plano_convex(radii_mm: [f64; 2]) -> Lens {
        let surface = |radius, thickness, n| TestSurface { radius, thickness, n, semi_aperture: 2.5, obscuration: 0.0 };
        lens_of(&[surface(radii_mm[0], 0.1, 1.5), surface(radii_mm[1], 0.0, 1.0)])
    }

    /// The Seidel aberration of thin lenses of n = 1.5 for a distant object: 7/6 h²/f with the
    /// convex side in front, and 9/2 h²/f with the plane side (Jenkins and White, *Fundamentals of
    /// Optics*, §9.5).
    #[test]
    fn thin_lenses_have_their_seidel_spherical_aberration() {
        for (radii_mm, factor) in [([50.0, 0.0], 7.0 / 6.0), ([0.0, -50.0], 4.5)] {
            let lens = plano_convex(radii_mm);
            let analysis = LensAnalysis::of(&lens, Some(1.0)).unwrap();
            let axial = AxialColour::of(&lens, &analysis).unwrap();
            let found_mm = axial.longitudinal_mm[1][40].unwrap();
            let seidel_mm = -factor * 2.5 * 2.5 / 100.0;
            assert!((found_mm / seidel_mm - 1.0).abs() < 0.01, "{radii_mm:?}: {found_mm} {seidel_mm}");
        }
    }

    /// Third-order longitudinal spherical aberration grows as the square of the height, and starts
    /// at the paraxial focus.
    #[test]
    fn the_longitudinal_aberration_starts_at_the_paraxial_focus() {
        let lens = catalogue::find("singlet").unwrap();
        let analysis = LensAnalysis::of(lens, Some(1.0)).unwrap();
        let axial = AxialColour::of(lens, &analysis).unwrap();
        let d: Vec<f64> = axial.longitudinal_mm[1].iter().map(|mm| mm.unwrap()).collect();
        assert_eq!(d[0], 0.0);
        assert!((d[2] / d[1] - 4.0).abs() < 1e-2 && d[40] < 0.0, "{d:?}");
        let at = |nm: f64| axial.nm.iter().position(|it| (it - nm).abs() < 2.5).unwrap();
        let colour = axial.focal_shift_mm[at(485.0)] - axial.focal_shift_mm[at(655.0)];
        assert!((colour / analysis.fc_shift_mm() - 1.0).abs() < 0.03, "{colour}");
    }
}
