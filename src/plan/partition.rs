//! Each class of light path is counted once: which estimator counts which.
//!
//! A path from a light to the camera is cut at the first surface, seen from the camera, that is neither a mirror nor clear glass.
//! What happened between the light and that surface, and between that surface and the camera, decides who counts it.
//! `emit` and `gather` read this table and nothing else. Caustics are sharp, so connections serve them best where the camera sees them;
//! indirect light is smooth, and kernels serve that.

use crate::optics::surface::Class;

/// What happened to light before it came to the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightPath {
    /// Nothing: it came straight from the lamp.
    Direct,
    /// Only mirror reflections and refractions (at least one): L S+ in Heckbert's notation.
    Caustic,
    /// At least one scattering by a rough or diffuse surface.
    Indirect,
}

/// What stands between the surface and the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// Nothing: a straight line.
    Seen,
    /// Mirrors, glass or rough surfaces.
    Relayed,
}

/// Who counts a class of paths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Shadow rays from the surface to the light, and scattered rays that hit it, by multiple importance sampling.
    ShadowRays,
    /// The photon's hit, connected to the camera; needs no kernel.
    Connection,
    /// Density estimation in the photon map.
    PhotonMap,
    /// The camera path goes on in a scattered direction, and the next surface counts it.
    Continuation,
    /// Nobody: the surface takes no light.
    Nobody,
}

/// Who counts light that came by `path` to a surface of this class, seen by `view`.
#[inline]
pub fn estimator(path: LightPath, class: Class, view: View) -> Estimator {
    match (class, path, view) {
        (Class::Absorbing, _, _) => Estimator::Nobody,
        (Class::Specular, _, _) => Estimator::Continuation,
        (Class::Diffuse | Class::Glossy, LightPath::Direct, _) => Estimator::ShadowRays,
        (Class::Diffuse | Class::Glossy, LightPath::Caustic, View::Seen) => Estimator::Connection,
        (Class::Diffuse | Class::Glossy, LightPath::Caustic, View::Relayed) => Estimator::PhotonMap,
        (Class::Diffuse, LightPath::Indirect, _) => Estimator::PhotonMap,
        (Class::Glossy, LightPath::Indirect, _) => Estimator::Continuation,
    }
}

/// Whether any view needs photons of this kind kept in the map at a surface of this class.
#[inline]
pub fn kept_in_map(path: LightPath, class: Class) -> bool {
    [View::Seen, View::Relayed].into_iter().any(|view| estimator(path, class, view) == Estimator::PhotonMap)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_straight_from_the_lamp_never_enters_the_map() {
        for class in [Class::Absorbing, Class::Specular, Class::Glossy, Class::Diffuse] {
            assert!(!kept_in_map(LightPath::Direct, class));
        }
    }

    #[test]
    fn a_caustic_is_kept_for_views_through_glass_and_connected_where_it_is_seen() {
        assert!(kept_in_map(LightPath::Caustic, Class::Diffuse));
        assert_eq!(estimator(LightPath::Caustic, Class::Diffuse, View::Seen), Estimator::Connection);
        assert!(!kept_in_map(LightPath::Indirect, Class::Glossy), "rough surfaces send the camera path on");
    }
}
