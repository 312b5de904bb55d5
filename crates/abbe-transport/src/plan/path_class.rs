//! The classes of paths that a picture may show as separate layers.
//!
//! Each path belongs to exactly one class, by its first scattering event from the camera that is
//! not specular, and the events between it and the light, so the classes sum to the picture. Both
//! integrators use the same classes.

use super::partition::LightPath;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathClass {
    /// The camera sees the light directly, or by specular events only (L S* E).
    Emission,
    /// The first scattering event is at a surface that the light reaches straight.
    Direct,
    /// The first scattering event is at a surface that the light reaches by specular events.
    Caustic,
    /// The first scattering event is at a surface, and the light was scattered before.
    Indirect,
    /// The first scattering event is in a medium.
    Volume,
}

impl PathClass {
    /// The names of the classes, in the order of their numbers.
    pub const NAMES: [&'static str; 5] = ["emission", "direct", "caustic", "indirect", "volume"];

    /// Returns the number of the class: its index in [`Self::NAMES`].
    #[inline(always)]
    pub fn number(self) -> usize {
        self as usize
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LightOrigin {
    pub class: PathClass,
    /// For light from photons, another light of the same group and spectrum may stand here.
    pub light: usize,
}

/// The events on a camera path so far, as far as they decide the class of its light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CameraEvents {
    /// Only specular events, or no events.
    #[default]
    Specular,
    /// The path was scattered at one diffuse or glossy surface. This was the last event.
    Surface,
    /// The path was scattered at one diffuse or glossy surface. Then came only specular events.
    SurfaceThenSpecular,
    /// The path was scattered at a diffuse or glossy surface, and at least once more.
    Scattered,
    /// The first scattering event was in a medium.
    Medium,
}

impl CameraEvents {
    /// Returns the events after a specular event, or after a hidden face.
    #[inline]
    #[must_use]
    pub fn after_specular_event(self) -> Self {
        match self {
            Self::Surface => Self::SurfaceThenSpecular,
            Self::Specular | Self::SurfaceThenSpecular | Self::Scattered | Self::Medium => self,
        }
    }

    #[inline]
    #[must_use]
    pub fn after_surface(self) -> Self {
        match self {
            Self::Specular => Self::Surface,
            Self::Surface | Self::SurfaceThenSpecular | Self::Scattered => Self::Scattered,
            Self::Medium => Self::Medium,
        }
    }

    #[inline]
    #[must_use]
    pub fn after_medium(self) -> Self {
        match self {
            Self::Specular | Self::Medium => Self::Medium,
            Self::Surface | Self::SurfaceThenSpecular | Self::Scattered => Self::Scattered,
        }
    }

    /// Returns the class of the light that a source emits into the path.
    #[inline]
    pub fn class_of_emission(self) -> PathClass {
        match self {
            Self::Specular => PathClass::Emission,
            Self::Surface => PathClass::Direct,
            Self::SurfaceThenSpecular => PathClass::Caustic,
            Self::Scattered => PathClass::Indirect,
            Self::Medium => PathClass::Volume,
        }
    }

    /// Returns the class of light that arrives by `light_path` at a diffuse or glossy surface.
    #[inline]
    pub fn class_at_surface(self, light_path: LightPath) -> PathClass {
        match (self, light_path) {
            (Self::Specular, LightPath::Direct) => PathClass::Direct,
            (Self::Specular, LightPath::Caustic) => PathClass::Caustic,
            (Self::Specular, LightPath::Indirect) => PathClass::Indirect,
            (Self::Surface | Self::SurfaceThenSpecular | Self::Scattered, _) => PathClass::Indirect,
            (Self::Medium, _) => PathClass::Volume,
        }
    }

    #[inline]
    pub fn class_in_medium(self) -> PathClass {
        match self {
            Self::Specular | Self::Medium => PathClass::Volume,
            Self::Surface | Self::SurfaceThenSpecular | Self::Scattered => PathClass::Indirect,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A light that a path hits after a scattering event has the class of direct light there.
    #[test]
    fn hits_and_shadow_rays_agree_on_the_class() {
        use CameraEvents::{Medium, Scattered, Specular, Surface, SurfaceThenSpecular};
        for events in [Specular, Surface, SurfaceThenSpecular, Scattered, Medium] {
            let after = events.after_surface();
            assert_eq!(after.class_of_emission(), events.class_at_surface(LightPath::Direct));
            let after = after.after_specular_event();
            assert_eq!(after.class_of_emission(), events.class_at_surface(LightPath::Caustic));
            assert_eq!(events.after_medium().class_of_emission(), events.class_in_medium());
        }
    }

    #[test]
    fn class_numbers_are_indices_of_the_names() {
        let classes =
            [PathClass::Emission, PathClass::Direct, PathClass::Caustic, PathClass::Indirect, PathClass::Volume];
        assert!(classes.iter().enumerate().all(|(number, class)| class.number() == number));
        assert_eq!(PathClass::NAMES.len(), classes.len());
    }
}
