//! The figures of a luminaire: flux, peak intensity, beam angles and efficacy.

use super::photometry::Photometry;
use abbe_scene::light::IntensityTable;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::{acos, atan2, sin_cos};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The steps of a turn in which a plane is searched for the edges of the beam.
const PLANE_STEPS: u16 = 3600;

/// The steps of the angle γ and of the angle C of the sum over all directions.
const SPHERE_STEPS: (u16, u16) = (360, 180);

/// The angular extent of the light in a plane through the photometric axis. An extent is the angle
/// between the two outermost directions with at least a fraction of the plane's largest intensity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamAngles {
    /// The beam angle in degrees: the extent at 50 %.
    pub half_deg: f64,
    /// The field angle in degrees: the extent at 10 %.
    pub tenth_deg: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct LuminaireSummary {
    /// The luminous flux in lm: the integral of the interpolated intensity.
    pub flux_lm: f64,
    /// The fraction of the flux in the hemisphere around the photometric axis.
    pub downward: f64,
    /// The largest intensity in cd.
    pub peak_cd: f64,
    /// The angles γ and C of a direction with the largest intensity, in degrees.
    pub peak_deg: [f64; 2],
    /// The extent of the light in the planes C0–C180 and C90–C270. `None` if a plane is dark.
    pub beams: [Option<BeamAngles>; 2],
    /// The luminous flux per electric power in lm/W, if the file states the power.
    pub efficacy: Option<f64>,
    table: IntensityTable,
}

impl LuminaireSummary {
    /// Computes the figures, or returns an error if all intensities are 0.
    pub fn of(photometry: &Photometry) -> Result<Self> {
        let table = photometry.table()?;
        let flux_lm = table.flux();
        let peak = table.brightest();
        let azimuth = atan2(peak.y, peak.x).to_degrees().rem_euclid(360.0);
        // The azimuth of the polar axis is rounding noise.
        let azimuth = if peak.x.abs().max(peak.y.abs()) < 1e-9 { 0.0 } else { azimuth };
        Ok(Self {
            flux_lm,
            downward: downward(&table),
            peak_cd: table.largest(),
            peak_deg: [acos(peak.z.clamp(-1.0, 1.0)).to_degrees(), azimuth],
            beams: [0.0, 90.0].map(|plane| beam(&table, plane)),
            efficacy: photometry.input_watts.map(|watts| flux_lm / watts),
            table,
        })
    }

    /// Returns the polar curve of a plane as pairs of degrees and cd: γ in the half-plane `c_deg`
    /// from 0 to 180, and γ in the opposite half-plane from −180 to 0.
    pub fn polar_curve(&self, c_deg: f64) -> Vec<(f64, f64)> {
        (-180..=180_i16).map(f64::from).map(|angle| (angle, in_plane(&self.table, c_deg, angle))).collect()
    }
}

/// Returns the intensity in a plane at an angle from the photometric axis, both in degrees.
fn in_plane(table: &IntensityTable, c_deg: f64, angle_deg: f64) -> f64 {
    let ((sin, cos), (sin_c, cos_c)) = (sin_cos(angle_deg.to_radians()), sin_cos(c_deg.to_radians()));
    table.at(DVec3::new(sin * cos_c, sin * sin_c, cos))
}

fn downward(table: &IntensityTable) -> f64 {
    let (rings, sectors) = SPHERE_STEPS;
    let mut fluxes = [0.0; 2];
    for ring in 0..rings {
        let (sin, cos) = sin_cos(PI * (f64::from(ring) + 0.5) / f64::from(rings));
        for sector in 0..sectors {
            let (sin_c, cos_c) = sin_cos(TAU * (f64::from(sector) + 0.5) / f64::from(sectors));
            fluxes[usize::from(cos < 0.0)] += sin * table.at(DVec3::new(sin * cos_c, sin * sin_c, cos));
        }
    }
    let [down, up] = fluxes;
    if down + up > 0.0 { down / (down + up) } else { 0.0 }
}

fn beam(table: &IntensityTable, c_deg: f64) -> Option<BeamAngles> {
    let curve: Vec<f64> = (0..PLANE_STEPS).map(|step| in_plane(table, c_deg, angle_of(step))).collect();
    let largest = curve.iter().copied().fold(0.0, f64::max);
    let extent = |fraction: f64| extent(&curve, fraction * largest, |angle| in_plane(table, c_deg, angle));
    (largest > 0.0).then(|| BeamAngles { half_deg: extent(0.5), tenth_deg: extent(0.1) })
}

fn angle_of(step: u16) -> f64 {
    360.0 * f64::from(step) / f64::from(PLANE_STEPS)
}

/// Returns 360° minus the widest gap in which the curve is below the threshold.
fn extent(curve: &[f64], threshold: f64, intensity: impl Fn(f64) -> f64) -> f64 {
    let bright: Vec<u16> = (0..PLANE_STEPS).filter(|&step| curve[usize::from(step)] >= threshold).collect();
    let (Some(first), Some(last)) = (bright.first(), bright.last()) else { return 0.0 };
    let across_zero = (angle_of(*last), angle_of(*first) + 360.0);
    let gaps = bright.windows(2).map(|pair| (angle_of(pair[0]), angle_of(pair[1]))).chain([across_zero]);
    let Some((from, to)) = gaps.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0))) else { return 360.0 };
    if to - from < 1.5 * angle_of(1) {
        return 360.0;
    }
    // Bisection finds the edges of the gap within the steps.
    let edge = |mut inside: f64, mut outside: f64| {
        for _ in 0..30 {
            let middle = 0.5 * (inside + outside);
            if intensity(middle) >= threshold {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    };
    360.0 - (edge(to, to - angle_of(1)) - edge(from, from + angle_of(1)))
}
