//! The Descartes ray of a rainbow.

use super::diattenuating_retarder::DiattenuatingRetarder;
use super::surface::SurfaceMatrices;
use abbe_spectra::math::elementary::asin;
use std::f64::consts::PI;

/// The ray of least deviation through a sphere with internal reflections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DescartesRay {
    /// The angle of incidence in radians.
    pub incidence: f64,
    /// The angle of refraction in radians, which is that of the internal reflections.
    pub refraction: f64,
    /// The angle between the bow and the point opposite the sun in radians.
    pub bow_radius: f64,
    /// The matrix of the transmissions and internal reflections. The axis s is perpendicular to
    /// the scattering plane, so tangential to the bow.
    pub matrix: DiattenuatingRetarder,
}

/// Returns the Descartes ray with `reflections` internal reflections, at least 1, in a sphere of
/// the relative index `n` above 1 (Born & Wolf, §13.2.3; Können, *Polarized Light in Nature*).
/// Returns `None` if no ray has an extreme deviation, because `n` exceeds `reflections` + 1.
pub fn descartes_ray(n: f64, reflections: u8) -> Option<DescartesRay> {
    let k = f64::from(reflections);
    let cos2 = (n * n - 1.0) / (k * (k + 2.0));
    (cos2 <= 1.0 && cos2 > 0.0).then(|| {
        let sin = (1.0 - cos2).sqrt();
        let (incidence, refraction) = (asin(sin), asin(sin / n));
        let deviation = k * PI + 2.0 * incidence - 2.0 * (k + 1.0) * refraction;
        let bow_radius = (deviation.rem_euclid(2.0 * PI) - PI).abs();
        let enters = SurfaceMatrices::dielectric(cos2.sqrt(), 1.0, n);
        let inside = SurfaceMatrices::dielectric((1.0 - (sin / n) * (sin / n)).sqrt(), n, 1.0);
        let start = enters.transmitted * inside.transmitted;
        let matrix = (0..reflections).fold(start, |matrix, _| matrix * inside.reflected);
        DescartesRay { incidence, refraction, bow_radius, matrix }
    })
}
