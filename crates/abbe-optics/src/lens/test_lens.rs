//! Simple lenses for tests.

use super::{ApertureSpec, Lens, LensSurface, Prescription, SurfaceProfile};
use crate::glass::RefractiveIndex;

/// A spherical surface of a test lens, in mm. The radius 0 is a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct TestSurface {
    pub(super) radius: f64,
    pub(super) thickness: f64,
    /// The index behind the surface.
    pub(super) n: f64,
    pub(super) semi_aperture: f64,
    pub(super) obscuration: f64,
}

/// Returns a lens whose first surface is the stop.
pub(super) fn lens_of(surfaces: &[TestSurface]) -> Lens {
    let surface = |surface: &TestSurface| LensSurface {
        profile: SurfaceProfile::sphere(surface.radius),
        thickness_mm: surface.thickness,
        index: RefractiveIndex::constant(surface.n).unwrap(),
        semi_aperture_mm: surface.semi_aperture,
        obscuration_mm: surface.obscuration,
        coating: None,
    };
    Lens::new(Prescription {
        name: "test".to_string(),
        source: None,
        surfaces: surfaces.iter().map(surface).collect(),
        stop: Some(0),
        opening: ApertureSpec::Stop,
        half_field_deg: None,
        notes: Vec::new(),
    })
    .unwrap()
}
