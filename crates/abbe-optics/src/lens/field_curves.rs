//! Curves over the field of view: field curvature, distortion, lateral colour and relative
//! illumination.

use std::f64::consts::TAU;

use glam::DVec2;

use super::analysis::{LensAnalysis, chief_heights_mm, no_light};
use super::field::parallel_ray;
use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay, MonochromaticLens};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::sin_cos;

/// Curves over the field. The lists of a wavelength have one value per field angle.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldCurves {
    /// Field angles in degrees.
    pub angles_deg: Vec<f64>,
    /// Heights in mm at which the chief ray of the reference wavelength reaches the sensor.
    pub heights_mm: Vec<f64>,
    /// For each wavelength the distance in mm from the sensor to the tangential focus (T) of a thin
    /// bundle around the chief ray, positive away from the lens.
    pub tangential_mm: Vec<Vec<f64>>,
    /// The sagittal focus (S), like `tangential_mm`.
    pub sagittal_mm: Vec<Vec<f64>>,
    /// Distortion of the reference wavelength, as of [`FieldPoint`](super::FieldPoint), and 0 on
    /// the axis.
    pub distortion: Vec<f64>,
    /// For each wavelength the height of its chief ray minus that of the reference wavelength in
    /// mm.
    pub lateral_colour_mm: Vec<Vec<f64>>,
    /// Illuminance of the image of a uniform distant surface, relative to the axis, at the
    /// reference wavelength: by vignetting, obliquity and the aberrations of the pupil, without the
    /// losses of surfaces and glass.
    pub relative_illumination: Vec<f64>,
    /// Radius of the Petzval surface in mm at the reference wavelength, negative if it curves
    /// towards the lens, or infinite.
    pub petzval_radius_mm: f64,
}

const FIELD_STEPS: u32 = 40;
/// Distance from the chief ray, divided by the radius of the entrance pupil, of the rays that give
/// the foci of a thin bundle.
const THIN: f64 = 3e-4;
/// Rays across the search for the centre of the light that passes, directions in which its rim is
/// then searched, and steps to the rim along each direction.
const SEARCH: u32 = 24;
const RIM_DIRECTIONS: u32 = 120;
const RIM_STEPS: u32 = 32;

impl FieldCurves {
    /// Computes the curves from the axis to the half field of an analysis, on its sensor. Returns
    /// an error if a chief ray does not reach the sensor.
    pub fn of(lens: &Lens, analysis: &LensAnalysis) -> Result<Self> {
        let angle_deg = |step| analysis.half_field_deg * f64::from(step) / f64::from(FIELD_STEPS);
        Self::at_angles(lens, analysis, (0..=FIELD_STEPS).map(angle_deg))
    }

    /// Computes the values at these field angles in degrees, like [`Self::of`].
    pub fn at_angles(lens: &Lens, analysis: &LensAnalysis, angles_deg: impl Iterator<Item = f64>) -> Result<Self> {
        let (at, sensor_z_mm) = (analysis.at(lens), analysis.sensor_z_mm);
        let reference = analysis.conditions.reference();
        let mut curves = Self {
            angles_deg: Vec::new(),
            heights_mm: Vec::new(),
            tangential_mm: vec![Vec::new(); at.len()],
            sagittal_mm: vec![Vec::new(); at.len()],
            distortion: Vec::new(),
            lateral_colour_mm: vec![Vec::new(); at.len()],
            relative_illumination: Vec::new(),
            petzval_radius_mm: at[reference].petzval_radius_mm(),
        };
        let f_number = analysis.paraxial.f_number.unwrap_or(1.0);
        let light = |angle_deg| projected_solid_angle(&at[reference], angle_deg, sensor_z_mm, f_number);
        let on_axis = light(0.0)?;
        for angle_deg in angles_deg {
            let heights_mm = chief_heights_mm(&at, angle_deg, sensor_z_mm)?;
            let height_mm = heights_mm[reference];
            for (i, at) in at.iter().enumerate() {
                let [tangential, sagittal] = thin_foci_mm(at, angle_deg, sensor_z_mm)?;
                curves.tangential_mm[i].push(tangential);
                curves.sagittal_mm[i].push(sagittal);
                curves.lateral_colour_mm[i].push(heights_mm[i] - height_mm);
            }
            let ideal_mm = analysis.paraxial_height_mm(angle_deg);
            curves.distortion.push(if ideal_mm == 0.0 { 0.0 } else { height_mm / ideal_mm - 1.0 });
            curves.relative_illumination.push(light(angle_deg)? / on_axis);
            curves.angles_deg.push(angle_deg);
            curves.heights_mm.push(height_mm);
        }
        Ok(curves)
    }
}

impl MonochromaticLens<'_> {
    /// Returns the radius of the Petzval surface in mm, infinite if it is plane: −1/Σ φ/(n n′) over
    /// the surfaces with the powers φ (Born & Wolf, *Principles of Optics*, §5.5.3).
    fn petzval_radius_mm(&self) -> f64 {
        let surfaces = self.lens().surfaces().iter().enumerate();
        let terms = surfaces.map(|(i, surface)| {
            let (before, behind) = (self.index_before(i), self.index_before(i + 1));
            (behind - before) * surface.profile.vertex_curvature_per_mm() / (before * behind)
        });
        -1.0 / (self.index_before(self.lens().surfaces().len()) * terms.sum::<f64>())
    }
}

/// Returns the distances in mm from the sensor to the tangential and the sagittal focus of a thin
/// bundle around the chief ray.
fn thin_foci_mm(at: &MonochromaticLens<'_>, angle_deg: f64, sensor_z_mm: f64) -> Result<[f64; 2]> {
    let chief = at.chief_ray(angle_deg)?;
    let offset_mm = THIN * at.paraxial()?.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
    let traced = |aside_mm: f64, up_mm: f64| {
        let out = at.trace(parallel_ray(chief, aside_mm, up_mm), TraceDirection::ToSensor, ApertureCheck::Ignored);
        out.map(|ray| super::field::ImageRay::of(ray, sensor_z_mm)).map_err(|_| no_light(angle_deg))
    };
    let (upper, lower, side) = (traced(0.0, offset_mm)?, traced(0.0, -offset_mm)?, traced(offset_mm, 0.0)?);
    let tangential = -(upper.point_mm.y - lower.point_mm.y) / (upper.slope.y - lower.slope.y);
    // By symmetry, the sagittal focus lies in the meridional plane.
    Ok([tangential, -side.point_mm.x / side.slope.x])
}

/// Returns the integral of the cosine of incidence over the directions from which light reaches the
/// place of the chief ray on the sensor, which is proportional to the illuminance: the area of the
/// exit pupil in direction cosines, as seen from there (M. P. Rimmer, "Relative illumination
/// calculations", *Proc. SPIE* 655, 1986). Rays are traced from the sensor to the scene.
fn projected_solid_angle(at: &MonochromaticLens<'_>, angle_deg: f64, sensor_z_mm: f64, f_number: f64) -> Result<f64> {
    let chief = at.trace(at.chief_ray(angle_deg)?, TraceDirection::ToSensor, ApertureCheck::Ignored);
    let chief = chief.map_err(|_| no_light(angle_deg))?;
    let (origin, back) = (chief.at_z(sensor_z_mm), -chief.direction);
    let passes = |offset: DVec2| {
        let cosines = back.truncate() + offset;
        let z2 = 1.0 - cosines.length_squared();
        let ray = LensRay { origin, direction: cosines.extend(-z2.max(0.0).sqrt()) };
        z2 > 0.0 && at.trace(ray, TraceDirection::ToScene, ApertureCheck::Enforced).is_ok()
    };
    // Twice the radius of the pupil in direction cosines, 1/(2 N) on the axis.
    let width = 1.0 / f_number;
    let cell = |i: u32| (f64::from(2 * i + 1) / f64::from(SEARCH) - 1.0) * width;
    let cells = (0..SEARCH).flat_map(|i| (0..SEARCH).map(move |j| DVec2::new(cell(i), cell(j))));
    let passing: Vec<DVec2> = cells.filter(|offset| passes(*offset)).collect();
    if passing.is_empty() {
        return Ok(0.0);
    }
    let middle = passing.iter().sum::<DVec2>() / passing.len() as f64;
    let pitch = 2.0 * width / f64::from(RIM_STEPS);
    let (mut outer, mut inner) = (Vec::new(), Vec::new());
    for i in 0..RIM_DIRECTIONS {
        let (sin, cos) = sin_cos(TAU * f64::from(i) / f64::from(RIM_DIRECTIONS));
        let point = |distance: f64| middle + distance * DVec2::new(cos, sin);
        let along = |distance: f64| passes(point(distance));
        let open: Vec<u32> = (0..=RIM_STEPS).filter(|step| along(f64::from(*step) * pitch)).collect();
        let (Some(first), Some(last)) = (open.first(), open.last()) else { continue };
        outer.push(point(rim(along, f64::from(*last) * pitch, f64::from(last + 1) * pitch)));
        // A central obscuration leaves an inner rim.
        if *first > 0 {
            inner.push(point(rim(along, f64::from(*first) * pitch, f64::from(first - 1) * pitch)));
        }
    }
    Ok(area(&outer) - area(&inner))
}

/// Returns the largest distance at which a ray passes, between one at which rays pass and one at
/// which they do not.
fn rim(along: impl Fn(f64) -> bool, mut passes: f64, mut blocked: f64) -> f64 {
    const HALVINGS: u32 = 24;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (passes + blocked);
        *(if along(middle) { &mut passes } else { &mut blocked }) = middle;
    }
    passes
}

/// Returns the area of a polygon.
fn area(corners: &[DVec2]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::test_lens::{TestSurface, lens_of};
    use crate::lens::{AnalysisConditions, SensorFocus, catalogue};

    fn curves(lens: &Lens, half_field_deg: f64) -> (LensAnalysis, FieldCurves) {
        let analysis = LensAnalysis::of(lens, Some(half_field_deg)).unwrap();
        let curves = FieldCurves::of(lens, &analysis).unwrap();
        (analysis, curves)
    }

    /// In the third order, the tangential focus is three times as far from the Petzval surface as
    /// the sagittal focus (Smith, *Modern Optical Engineering*, §5.7).
    #[test]
    fn the_foci_near_the_axis_obey_the_petzval_relation() {
        for name in ["singlet", "cemented", "cooke", "tessar", "double-gauss"] {
            let (_, curves) = curves(catalogue::find(name).unwrap(), 1.0);
            let height_mm = curves.heights_mm[40];
            let petzval_mm = 0.5 * height_mm * height_mm / curves.petzval_radius_mm;
            let (tangential, sagittal) = (curves.tangential_mm[1][40], curves.sagittal_mm[1][40]);
            let ratio = (tangential - petzval_mm) / (sagittal - petzval_mm);
            assert!((ratio - 3.0).abs() < 0.02, "{name}: {ratio}");
        }
    }

    /// The Coddington equations along the chief ray, an independent way to the foci of a thin
    /// bundle (Welford, *Aberrations of Optical Systems*, §9.6).
    #[test]
    fn the_foci_agree_with_the_coddington_equations() {
        for name in ["cooke", "double-gauss"] {
            let lens = catalogue::find(name).unwrap();
            let (analysis, curves) = curves(lens, lens.half_field_deg().unwrap());
            let at = lens.at(587.5618);
            let mut points = Vec::new();
            let chief = at.chief_ray(analysis.half_field_deg).unwrap();
            let visit = |_, point| points.push(point);
            let out = at.trace_through(chief, TraceDirection::ToSensor, ApertureCheck::Ignored, visit).unwrap();
            let (mut before, mut s, mut t): (LensRay, f64, f64) = (chief, f64::INFINITY, f64::INFINITY);
            for (i, surface) in lens.surfaces().iter().enumerate() {
                let end = points.get(i + 1).copied().unwrap_or(points[i] + out.direction);
                let direction = (end - points[i]).normalize();
                let local = points[i] - glam::DVec3::Z * lens.vertex_z_mm(i);
                let normal = surface.profile.normal(local);
                let (n, m) = (at.index_before(i), at.index_before(i + 1));
                let (cos_i, cos_t) = (before.direction.dot(normal), direction.dot(normal));
                // The built-in lenses have spherical surfaces.
                let power = (m * cos_t - n * cos_i) * surface.profile.curvature_per_mm;
                s = m / (n / s + power);
                t = m * cos_t * cos_t / (n * cos_i * cos_i / t + power);
                let gap_mm = if i + 1 < points.len() { (points[i + 1] - points[i]).length() } else { 0.0 };
                (s, t, before) = (s - gap_mm, t - gap_mm, LensRay { origin: points[i], direction });
            }
            let z_mm = |distance: f64| out.origin.z + distance * out.direction.z - analysis.sensor_z_mm;
            let found = (curves.tangential_mm[1][40], curves.sagittal_mm[1][40]);
            assert!((z_mm(t) - found.0).abs() < 1e-6, "{name}: {} {}", z_mm(t), found.0);
            assert!((z_mm(s) - found.1).abs() < 1e-6, "{name}: {} {}", z_mm(s), found.1);
        }
    }

    /// In the third order, distortion grows as the square of the field, also out of focus.
    #[test]
    fn distortion_vanishes_towards_the_axis_at_any_focus() {
        let lens = catalogue::find("cooke").unwrap();
        for shift_mm in [0.0, -0.5, 0.5] {
            let conditions = AnalysisConditions::default().with_half_field(Some(2.0));
            let analysis = LensAnalysis::under(lens, conditions.with_focus(SensorFocus::Shift(shift_mm))).unwrap();
            let curves = FieldCurves::of(lens, &analysis).unwrap();
            assert!((curves.distortion[40] / curves.distortion[20] / 4.0 - 1.0).abs() < 0.01, "{shift_mm}");
        }
    }

    #[test]
    fn the_ends_of_the_curves_are_the_figures_of_the_analysis() {
        let (analysis, curves) = curves(catalogue::find("tessar").unwrap(), 20.0);
        let edge = &analysis.fields[2];
        assert_eq!(curves.heights_mm[40], edge.image_height_mm);
        assert_eq!(Some(curves.distortion[40]), edge.distortion);
        let colour_mm = curves.lateral_colour_mm[0][40] - curves.lateral_colour_mm[2][40];
        assert!((colour_mm - edge.lateral_colour_mm).abs() < 1e-12);
        assert!(curves.lateral_colour_mm[1].iter().all(|mm| *mm == 0.0));
        for (line, focus) in analysis.lines.iter().enumerate() {
            let paraxial_mm = focus.bfd_mm - analysis.paraxial.bfd_mm;
            assert!((curves.tangential_mm[line][0] - paraxial_mm).abs() < 1e-5);
            assert!((curves.sagittal_mm[line][0] - paraxial_mm).abs() < 1e-5);
        }
    }

    /// A weak thin lens, `gap_mm` behind its stop if there is a gap.
    fn weak_lens(gap_mm: f64, semi_aperture_mm: f64, obscuration_mm: f64) -> Lens {
        let stop =
            TestSurface { radius: 0.0, thickness: gap_mm, n: 1.0, semi_aperture: 1.0, obscuration: obscuration_mm };
        let glass = |radius, thickness, n| TestSurface {
            radius,
            thickness,
            n,
            semi_aperture: semi_aperture_mm,
            obscuration: 0.0,
        };
        lens_of(&[stop, glass(2000.0, 0.01, 1.5), glass(-2000.0, 0.0, 1.0)])
    }

    /// A thin lens with its stop has no distortion and darkens as cos⁴ of the field angle, also
    /// with a central obscuration.
    #[test]
    fn a_thin_lens_darkens_as_the_fourth_power_of_the_cosine() {
        for obscuration_mm in [0.0, 0.5] {
            let (_, curves) = curves(&weak_lens(0.0, 1.1, obscuration_mm), 30.0);
            for (angle_deg, found) in curves.angles_deg.iter().zip(&curves.relative_illumination) {
                let cosine = angle_deg.to_radians().cos();
                assert!((found / cosine.powi(4) - 1.0).abs() < 1e-3, "{obscuration_mm} {angle_deg}: {found}");
            }
        }
    }

    /// A lens of the size of its stop, 10 mm behind it, cuts the bundle to the overlap of two
    /// discs, less the disc of a central obscuration that lies in it.
    #[test]
    fn a_second_aperture_vignettes_the_overlap_of_two_discs() {
        for (obscuration_mm, half_field_deg) in [(0.0, 6.0), (0.5, 2.5)] {
            let (_, curves) = curves(&weak_lens(10.0, 1.0, obscuration_mm), half_field_deg);
            for (angle_deg, found) in curves.angles_deg.iter().zip(&curves.relative_illumination) {
                let (cosine, shift) = (angle_deg.to_radians().cos(), 10.0 * angle_deg.to_radians().tan());
                let half = 0.5 * shift;
                let overlap = (2.0 * half.acos() - shift * (1.0 - half * half).sqrt()) * 2.0 / TAU;
                let obscured = obscuration_mm * obscuration_mm;
                let expected = (overlap - obscured) / (1.0 - obscured) * cosine.powi(4);
                assert!((found - expected).abs() < 3e-3, "{obscuration_mm} {angle_deg}: {found} {expected}");
            }
        }
    }
}
