//! Light of the clear sky by single scattering.

use super::frame::StokesFrame;
use super::scattering::rayleigh;
use super::stokes::Stokes;
use glam::DVec3;

/// Skylight from one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkyLight {
    /// The Stokes vector with S0 = 1.
    pub stokes: Stokes,
    /// The frame, whose x axis is horizontal.
    pub frame: StokesFrame,
}

/// Returns the polarisation of unpolarised sunlight that the air scatters once. `view` points from
/// the observer to the sky and `sun` to the sun, as unit vectors with z up. Towards the zenith, x
/// is perpendicular to the direction of the sun. Light that is scattered several times and by the
/// ground lowers the degree of polarisation of a real sky.
pub fn single_scattering(view: DVec3, sun: DVec3, depolarisation: f64) -> SkyLight {
    let matrix = rayleigh(view.dot(sun), depolarisation).0;
    let travel = -view;
    let level = DVec3::new(sun.x, sun.y, 0.0);
    let up = if travel.cross(DVec3::Z).length_squared() > 1e-24 { DVec3::Z } else { level };
    let frame = StokesFrame::perpendicular(travel, up);
    let plane = StokesFrame::perpendicular(travel, sun);
    let scattered = Stokes([1.0, matrix[1][0] / matrix[0][0], 0.0, 0.0]);
    SkyLight { stokes: plane.rotation_to(frame.x) * scattered, frame }
}
