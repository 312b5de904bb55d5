//! The glare of luminaires for the unified glare rating (UGR, CIE 117:1995).
//!
//! UGR = 8 log₁₀(0.25/L_b Σ L²ω/p²), over the luminaires in front of the eye with the luminance L,
//! the solid angle ω of the luminous parts and the position index p. L_b is the background
//! luminance: the illuminance at the eye without the direct light of the luminaires, divided by π.
//! Parts behind other objects do not count.

use super::direct::lighting::DirectLighting;
use super::direct::selection::SelectedLight;
use crate::plan::Tally;
use crate::walk::transmittance;
use abbe_scene::Scene;
use abbe_scene::light::{EmittedSpd, Light};
use abbe_scene::meter::{Response, SensorPoint};
use abbe_spectra::math::elementary::{acos, atan2, exp, hypot, log10};
use abbe_spectra::math::random::{Purpose, REPLICATES, Seed, StreamKey};
use abbe_spectra::math::sobol::Sobol;
use abbe_spectra::spectrum::{LUMENS_PER_WATT, Observer};
use glam::DVec3;
use std::f64::consts::{LN_10, PI};

#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Glare {
    /// The sum of L²ω/p² over the luminaires, in cd²/m⁴.
    pub sum: f64,
    /// The direct light of the luminaires on the plane at right angles to the view, in lx.
    pub direct_lx: f64,
}

impl Glare {
    /// Returns the rating, or `None` without visible luminaires or background. `illuminance_lx` is
    /// that of all light on the plane at right angles to the view.
    pub fn rating(self, illuminance_lx: f64) -> Option<f64> {
        let background = (illuminance_lx - self.direct_lx) / PI;
        (self.sum > 0.0 && background > 0.0).then(|| 8.0 * log10(0.25 * self.sum / background))
    }

    /// Returns the derivative of the rating by the illuminance, in 1/lx.
    pub fn slope(self, illuminance_lx: f64) -> f64 {
        8.0 / (LN_10 * (illuminance_lx - self.direct_lx))
    }
}

impl DirectLighting<'_> {
    /// Estimates the glare for an eye that looks along the normal of the point's response,
    /// independently for each replicate.
    pub fn glare(&self, scene: &Scene, eye: &SensorPoint, seed: Seed) -> [Glare; REPLICATES] {
        std::array::from_fn(|replicate| {
            let key = seed.streams(Purpose::Glare).pass(replicate as u64);
            let sources = scene.lights.iter().enumerate().filter(|(_, light)| light.is_luminaire());
            sources.fold(Glare::default(), |total, (number, light)| {
                let of_light = self.glare_of_light(scene, eye, (number, light), key.part(number as u64));
                Glare { sum: total.sum + of_light.sum, direct_lx: total.direct_lx + of_light.direct_lx }
            })
        })
    }

    fn glare_of_light(
        &self,
        scene: &Scene,
        eye: &SensorPoint,
        (number, light): (usize, &Light),
        key: StreamKey,
    ) -> Glare {
        /// The number of points of a luminaire that each replicate samples.
        const SAMPLES: u32 = 256;
        let view = eye.response.normal();
        // A sphere receives light from all directions alike.
        let all_directions = SensorPoint { response: Response::Sphere, ..*eye };
        let photometric = LUMENS_PER_WATT * Observer::cie1931().xyz(&light.spectrum)[1];
        let sobol = Sobol::of(key);
        let mut tally = Tally::default();
        // Integrals over the luminous parts: of the solid angle, the luminance, the luminance
        // divided by p², and the luminance times the cosine.
        let [mut solid_angle, mut flux, mut weighted, mut direct_lx] = [0.0; 4];
        for i in 0..SAMPLES {
            let [a, b, c, wavelength, ..] = sobol.point(i);
            let selected = SelectedLight { number, u: [a, b, c], probability: 1.0 };
            let Some(incident) = light.sample_li(scene.extent(), eye.position, selected.u) else { continue };
            let cosine = incident.direction.dot(view);
            if cosine <= 0.0 {
                continue;
            }
            let arriving = self.sample_direct_at_sensor(&all_directions, |_| 0.0, selected, &mut tally);
            let Some(arriving) = arriving else { continue };
            let lumens = if arriving.transmittance.is_empty() && arriving.spd == EmittedSpd::Own {
                photometric
            } else {
                let (nm, pdf) = light.wavelengths.sample(wavelength);
                let visible = LUMENS_PER_WATT * Observer::cie1931().xyz_bar(nm)[1] / pdf;
                light.spd_at(arriving.spd, nm) * visible * transmittance(&arriving.transmittance, nm)
            };
            let lx = arriving.strength / Response::Sphere.pdf(incident.direction) * lumens;
            solid_angle += light.apparent_solid_angle(&incident);
            flux += lx;
            weighted += lx / position_index(view, incident.direction).powi(2);
            direct_lx += lx * cosine;
        }
        let count = f64::from(SAMPLES);
        let sum = if solid_angle > 0.0 { flux * weighted / (solid_angle * count) } else { 0.0 };
        Glare { sum, direct_lx: direct_lx / count }
    }
}

/// Returns the position index of a luminaire in the direction `to_light`. Vertical is +y.
///
/// Above the line of sight, this is the formula of Guth's index in the IES Lighting Handbook, and
/// below it that of Iwata and Tokura (1997), as quoted by Wienold and Christoffersen (Energy and
/// Buildings 38, 2006).
fn position_index(view: DVec3, to_light: DVec3) -> f64 {
    let right = view.cross(DVec3::Y);
    // In a vertical view, north is up.
    let right = if right.length() > 1e-6 { right.normalize() } else { DVec3::X };
    let up = right.cross(view);
    let ahead = to_light.dot(view);
    let (aside, above) = (to_light.dot(right).abs(), to_light.dot(up));
    if above < 0.0 {
        let ratio = hypot(aside, above) / ahead;
        return 1.0 + if ratio < 0.6 { 0.8 } else { 1.2 } * ratio;
    }
    let sigma = acos(ahead.clamp(-1.0, 1.0)).to_degrees();
    let tau = atan2(aside, above).to_degrees();
    let linear = 35.2 - 0.318_89 * tau - 1.22 * exp(-2.0 / 9.0 * tau);
    let square = 21.0 + (0.266_67 - 0.002_963 * tau) * tau;
    exp((linear * 1e-3 + square * 1e-5 * sigma) * sigma)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of CIE 117 at T/R (aside) and H/R (above), to the accuracy of the formula.
    #[test]
    fn the_position_index_agrees_with_the_table_of_cie_117() {
        let table = [
            ([0.0, 0.0], 1.00),
            ([0.0, 0.1], 1.26),
            ([0.0, 0.5], 2.86),
            ([0.0, 1.0], 7.00),
            ([0.0, 1.5], 13.15),
            ([1.0, 0.0], 2.11),
        ];
        for ([aside, above], expected) in table {
            for side in [-1.0, 1.0] {
                let found = position_index(DVec3::X, DVec3::new(1.0, above, side * aside).normalize());
                assert!((found / expected - 1.0).abs() < 0.04, "{aside} {above}: {found} for {expected}");
            }
        }
        // Below the line of sight, the index is 1 + 1.2 R/D.
        let below = position_index(DVec3::Z, DVec3::new(0.6, -0.8, 1.0).normalize());
        assert!((below - 2.2).abs() < 1e-12);
        assert!(position_index(DVec3::Y, DVec3::new(0.1, 1.0, 0.2).normalize()).is_finite());
    }
}
