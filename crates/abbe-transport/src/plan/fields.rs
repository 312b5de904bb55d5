//! The plan and the types of its fields.

use super::partition::PerSet;

/// The choices that fix how a scene is simulated. [`EFFECTS`](super::EFFECTS) names, for each
/// effect, the fact that requires it, its switch (a field of this struct, or a part of the scene),
/// and the consequence if it is off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    pub wavelengths: WavelengthPlan,
    /// Through glass or from mirrors.
    pub caustics: CausticPlan,
    /// From surface to surface.
    pub indirect: IndirectPlan,
    /// Straight from its source.
    pub direct: DirectPlan,
    pub aperture: AperturePlan,
    /// Between surfaces.
    pub media_plan: MediumPlan,
    /// Caustic and indirect light in media.
    pub volume: VolumePlan,
    /// In which lights emit photons.
    pub aim: AimPlan,
    pub motion: MotionPlan,
    /// Surfaces or media are fluorescent.
    pub fluorescence: bool,
    /// Light from 300 to 360 nm excites fluorophores.
    pub ultraviolet: bool,
}

impl Plan {
    pub(super) const EMPTY: Self = Self {
        wavelengths: WavelengthPlan::Free,
        caustics: CausticPlan::Absent,
        indirect: IndirectPlan::Absent,
        direct: DirectPlan::Absent,
        aperture: AperturePlan::Pinhole,
        media_plan: MediumPlan::Air,
        volume: VolumePlan::Absent,
        aim: AimPlan::Plain,
        motion: MotionPlan::Still,
        fluorescence: false,
        ultraviolet: false,
    };

    /// Free photons excite fluorophores, also if all camera paths carry shared wavelengths.
    pub(crate) fn photon_sets(&self) -> PerSet<bool> {
        PerSet {
            free: self.wavelengths != WavelengthPlan::Shared || self.fluorescence,
            shared: self.wavelengths != WavelengthPlan::Free,
        }
    }
}

/// How photons and camera paths share wavelengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WavelengthPlan {
    /// Each photon has its own. No camera path reaches dispersive glass.
    Free,
    /// Each camera path starts with one of the shared wavelengths.
    Shared,
    /// Camera paths carry all wavelengths until they refract dispersively, and then one of the
    /// shared ones.
    Both,
}

/// Light through glass or from mirrors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CausticPlan {
    Absent,
    /// Photons are connected to a camera that sees the surface directly. Other camera paths read
    /// the photon map.
    Photons,
}

/// Light from surface to surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IndirectPlan {
    Absent,
    /// By density estimation.
    Photons,
}

/// Light straight from its source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DirectPlan {
    Absent,
    /// No scattered ray can hit a light.
    ShadowRays,
    /// Combined by multiple importance sampling.
    ShadowAndScatteredRays,
}

impl DirectPlan {
    pub fn is_absent(self) -> bool {
        self == Self::Absent
    }

    /// Returns true if scattered rays may hit a light.
    pub fn traces_scattered_rays(self) -> bool {
        self == Self::ShadowAndScatteredRays
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AperturePlan {
    /// A point.
    Pinhole,
    /// With depth of field.
    ThinLens(Rim),
    /// Of real glass. Each wavelength has its own camera ray.
    LensSystem(Rim),
}

/// The effect of the aperture's rim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rim {
    /// Only blocks rays.
    Stops,
    /// Also diffracts light: each slice of the film's spectrum is convolved with its pattern.
    Diffracts,
}

impl AperturePlan {
    /// Camera rays start at sampled points of a lens.
    pub fn is_finite(self) -> bool {
        self != Self::Pinhole
    }

    pub fn diffracts(self) -> bool {
        match self {
            Self::Pinhole => false,
            Self::ThinLens(rim) | Self::LensSystem(rim) => rim == Rim::Diffracts,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MediumPlan {
    /// No object has an interior.
    Air,
    /// All interiors are clear.
    Clear,
    /// By the Beer–Lambert law.
    Absorbing,
    /// Media absorb, scatter or emit.
    Scattering(VolumeDirectLighting),
}

/// The direct light that a medium scatters into a camera ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeDirectLighting {
    /// From a sampled distance along the ray.
    ShadowRays,
    /// Lights without a map are sampled by shadow rays.
    LightMaps,
}

impl MediumPlan {
    /// No medium attenuates the light between two mutually visible points.
    pub fn is_clear(self) -> bool {
        matches!(self, Self::Air | Self::Clear)
    }

    pub fn has_light_maps(self) -> bool {
        self == Self::Scattering(VolumeDirectLighting::LightMaps)
    }
}

/// How media store caustic and indirect light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumePlan {
    Absent,
    Points,
    Beams,
    /// Points in dense media, beams in thin ones.
    ByDensity,
}

impl VolumePlan {
    pub(super) fn of(points: bool, beams: bool) -> Self {
        match (points, beams) {
            (false, false) => Self::Absent,
            (true, false) => Self::Points,
            (false, true) => Self::Beams,
            (true, true) => Self::ByDensity,
        }
    }

    /// In a medium that may be `dense`.
    pub fn keeps_points(self, dense: bool) -> bool {
        self == Self::Points || (self == Self::ByDensity && dense)
    }

    /// In a medium that may be `dense`.
    pub fn keeps_beams(self, dense: bool) -> bool {
        self == Self::Beams || (self == Self::ByDensity && !dense)
    }
}

/// In which lights emit photons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AimPlan {
    /// By the emission distribution of the light.
    Plain,
    /// By the pilot.
    Learned,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionPlan {
    /// As when the shutter opens.
    Still,
    /// Each pass samples a time for all its rays and photons.
    PosedPerPass,
}
