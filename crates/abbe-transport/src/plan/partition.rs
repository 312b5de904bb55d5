//! The partition of light paths: which estimator computes which class of paths.
//!
//! Each path from a light to the camera belongs to exactly one class, so no light is counted twice.
//! It is divided at the first diffuse or rough surface from the camera. The class of that surface
//! ([`BsdfClass`]), the events between it and the light ([`LightPath`]) and those between it and
//! the camera ([`CameraView`]) select the estimator, for the photon recorder (`pass`) and for the
//! camera paths (`gather`).
//!
//! Caustics have sharp edges, which a connection to the camera keeps, because it needs no kernel.
//! Indirect light is smooth, so a kernel estimate has little bias.

use abbe_optics::bsdf::BsdfClass;
use std::ops::{Index, IndexMut};

/// The events on a light path before it reaches a surface or a point in a medium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightPath {
    /// No event: the light comes straight from its source.
    Direct,
    /// Specular reflections or refractions only: L S+ in Heckbert's notation.
    Caustic,
    /// At least one scattering event at a rough or diffuse surface or in a medium.
    Indirect,
}

impl LightPath {
    /// Returns the class of stored photons. Direct light is never stored.
    pub fn photon_class(self) -> Option<PhotonClass> {
        match self {
            Self::Direct => None,
            Self::Caustic => Some(PhotonClass::Caustic),
            Self::Indirect => Some(PhotonClass::Indirect),
        }
    }
}

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

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PerClass<T> {
    pub caustic: T,
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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhotonSet {
    /// Each photon has wavelengths of its own.
    Free,
    /// All photons have the shared wavelengths of the pass.
    Shared,
}

impl PhotonSet {
    /// Returns the set that a camera path reads, on a `shared` wavelength or not.
    pub fn of_path(shared: bool) -> Self {
        if shared { Self::Shared } else { Self::Free }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PerSet<T> {
    pub free: T,
    pub shared: T,
}

impl<T> PerSet<T> {
    /// Computes the value of each set, free photons first.
    pub fn from_fn(mut value: impl FnMut(PhotonSet) -> T) -> Self {
        Self { free: value(PhotonSet::Free), shared: value(PhotonSet::Shared) }
    }

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
    /// With scattered rays that hit the light, by multiple importance sampling.
    ShadowRays,
    /// From the photon to the camera, without a kernel.
    Connection,
    PhotonMap,
    /// The camera path continues in a scattered direction, and the next surface is evaluated.
    Continuation,
    /// No estimator: the surface reflects no light.
    None,
}

/// Selects the estimator of light that arrives by `path` at a surface seen by `view`.
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

/// Returns true if surfaces of this class store photons by `path`, because a view reads them.
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

    #[test]
    fn caustics_are_connected_or_mapped() {
        assert!(kept_in_map(LightPath::Caustic, BsdfClass::Diffuse));
        assert_eq!(estimator(LightPath::Caustic, BsdfClass::Diffuse, CameraView::Direct), Estimator::Connection);
        assert!(!kept_in_map(LightPath::Indirect, BsdfClass::Glossy), "camera paths continue at rough surfaces");
    }
}
