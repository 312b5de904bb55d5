//! The partition of light paths: which estimator computes which class of paths.
//!
//! Each path from a light to the camera belongs to exactly one class, so no light is counted twice.
//! The path is divided at the first diffuse or rough surface on the way from the camera. Three
//! facts select the estimator: the class of that surface ([`BsdfClass`]), the events between the
//! light and that surface ([`LightPath`]), and the events between that surface and the camera
//! ([`CameraView`]). The photon recorder (`pass`) and the camera paths (`gather`) read this table.
//!
//! Caustics have sharp edges. A connection to the camera needs no kernel, so it keeps these edges.
//! Indirect light is smooth, so a kernel estimate has little bias.

use abbe_optics::bsdf::BsdfClass;
use std::ops::{Index, IndexMut};

/// The events on a light path before it reaches a surface or a point in a medium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightPath {
    /// No event: the light comes straight from its source.
    Direct,
    /// One or more specular reflections or refractions, and nothing else. Heckbert's notation for
    /// these paths is L S+.
    Caustic,
    /// At least one scattering event at a rough or diffuse surface or in a medium.
    Indirect,
}

impl LightPath {
    /// Returns the class of the photons that such paths store. Returns `None` for direct light,
    /// because direct light is never stored.
    pub fn photon_class(self) -> Option<PhotonClass> {
        match self {
            Self::Direct => None,
            Self::Caustic => Some(PhotonClass::Caustic),
            Self::Indirect => Some(PhotonClass::Indirect),
        }
    }
}

/// The class of a stored photon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhotonClass {
    /// The photon interacted only with mirrors and clear glass.
    Caustic,
    /// The photon was scattered at least once.
    Indirect,
}

impl PhotonClass {
    /// All classes, in the order in which they are gathered.
    pub const ALL: [Self; 2] = [Self::Caustic, Self::Indirect];

    pub fn light_path(self) -> LightPath {
        match self {
            Self::Caustic => LightPath::Caustic,
            Self::Indirect => LightPath::Indirect,
        }
    }
}

/// One value for each class of stored photons.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PerClass<T> {
    /// The value for caustic photons.
    pub caustic: T,
    /// The value for indirect photons.
    pub indirect: T,
}

impl<T> PerClass<T> {
    /// Computes the value of each class, caustics first.
    pub fn from_fn(mut value: impl FnMut(PhotonClass) -> T) -> Self {
        Self { caustic: value(PhotonClass::Caustic), indirect: value(PhotonClass::Indirect) }
    }

    /// Combines the values of each class, caustics first.
    pub fn zip_with<U, V>(self, other: PerClass<U>, mut combine: impl FnMut(T, U) -> V) -> PerClass<V> {
        PerClass { caustic: combine(self.caustic, other.caustic), indirect: combine(self.indirect, other.indirect) }
    }
}

impl<T> Index<PhotonClass> for PerClass<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, class: PhotonClass) -> &T {
        match class {
            PhotonClass::Caustic => &self.caustic,
            PhotonClass::Indirect => &self.indirect,
        }
    }
}

impl<T> IndexMut<PhotonClass> for PerClass<T> {
    #[inline(always)]
    fn index_mut(&mut self, class: PhotonClass) -> &mut T {
        match class {
            PhotonClass::Caustic => &mut self.caustic,
            PhotonClass::Indirect => &mut self.indirect,
        }
    }
}

/// The two photon sets of a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhotonSet {
    /// Each photon has wavelengths of its own.
    Free,
    /// All photons have the shared wavelengths of the pass.
    Shared,
}

impl PhotonSet {
    /// Returns the photon set that a camera path reads. `shared` is true for a path on a shared
    /// wavelength.
    pub fn of_path(shared: bool) -> Self {
        if shared { Self::Shared } else { Self::Free }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PerSet<T> {
    /// The value for free photons.
    pub free: T,
    /// The value for photons on the shared wavelengths.
    pub shared: T,
}

impl<T> PerSet<T> {
    /// Computes the value of each set, free photons first.
    pub fn from_fn(mut value: impl FnMut(PhotonSet) -> T) -> Self {
        Self { free: value(PhotonSet::Free), shared: value(PhotonSet::Shared) }
    }

    /// Borrows the value of each set.
    pub fn as_ref(&self) -> PerSet<&T> {
        PerSet { free: &self.free, shared: &self.shared }
    }

    /// Combines the values of each set, free photons first.
    pub fn zip_with<U, V>(self, other: PerSet<U>, mut combine: impl FnMut(T, U) -> V) -> PerSet<V> {
        PerSet { free: combine(self.free, other.free), shared: combine(self.shared, other.shared) }
    }
}

impl<T> Index<PhotonSet> for PerSet<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, set: PhotonSet) -> &T {
        match set {
            PhotonSet::Free => &self.free,
            PhotonSet::Shared => &self.shared,
        }
    }
}

impl<T> IndexMut<PhotonSet> for PerSet<T> {
    #[inline(always)]
    fn index_mut(&mut self, set: PhotonSet) -> &mut T {
        match set {
            PhotonSet::Free => &mut self.free,
            PhotonSet::Shared => &mut self.shared,
        }
    }
}

/// The events on a camera path before it reaches a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraView {
    /// No event: the camera sees the surface along a straight line.
    Direct,
    /// At least one reflection, refraction or scattering event.
    Indirect,
}

/// The estimator of a class of paths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Shadow rays from the surface to the light, and scattered rays that hit the light. Multiple
    /// importance sampling combines both.
    ShadowRays,
    /// A connection from the photon's position on the surface to the camera. A connection needs no
    /// kernel.
    Connection,
    /// Density estimation in the photon map.
    PhotonMap,
    /// The camera path continues in a scattered direction, and the next surface is evaluated.
    Continuation,
    /// No estimator: the surface reflects no light.
    None,
}

/// Selects the estimator for a surface of this class. The light arrives at the surface by `path`,
/// and the camera sees the surface by `view`.
#[inline]
pub fn estimator(path: LightPath, class: BsdfClass, view: CameraView) -> Estimator {
    match (class, path, view) {
        (BsdfClass::Absorbing, _, _) => Estimator::None,
        (BsdfClass::Specular, _, _) => Estimator::Continuation,
        (BsdfClass::Diffuse | BsdfClass::Glossy, LightPath::Direct, _) => Estimator::ShadowRays,
        (BsdfClass::Diffuse | BsdfClass::Glossy, LightPath::Caustic, CameraView::Direct) => Estimator::Connection,
        (BsdfClass::Diffuse | BsdfClass::Glossy, LightPath::Caustic, CameraView::Indirect) => Estimator::PhotonMap,
        (BsdfClass::Diffuse, LightPath::Indirect, _) => Estimator::PhotonMap,
        (BsdfClass::Glossy, LightPath::Indirect, _) => Estimator::Continuation,
    }
}

/// Returns true if surfaces of this class store the photons that arrive by `path`. The photons are
/// stored if at least one view reads them.
#[inline]
pub fn kept_in_map(path: LightPath, class: BsdfClass) -> bool {
    [CameraView::Direct, CameraView::Indirect]
        .into_iter()
        .any(|view| estimator(path, class, view) == Estimator::PhotonMap)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_never_stores_direct_light() {
        for class in [BsdfClass::Absorbing, BsdfClass::Specular, BsdfClass::Glossy, BsdfClass::Diffuse] {
            assert!(!kept_in_map(LightPath::Direct, class));
        }
    }

    /// Caustics on directly visible surfaces are connected to the camera. Other views read the map.
    #[test]
    fn caustics_are_connected_or_mapped() {
        assert!(kept_in_map(LightPath::Caustic, BsdfClass::Diffuse));
        assert_eq!(estimator(LightPath::Caustic, BsdfClass::Diffuse, CameraView::Direct), Estimator::Connection);
        assert!(!kept_in_map(LightPath::Indirect, BsdfClass::Glossy), "camera paths continue at rough surfaces");
    }
}
