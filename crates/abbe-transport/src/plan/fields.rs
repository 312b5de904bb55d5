//! The plan and the types of its fields.

use super::partition::PerSet;

/// The choices that fix how a scene is simulated. [`EFFECTS`](super::EFFECTS) names, for each
/// effect, the fact that requires it, its switch (a field of this struct, or a part of the scene),
/// and the consequence if it is off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    pub wavelengths: WavelengthPlan,
    /// Light arriving at a surface through glass or from mirrors.
    pub caustics: CausticPlan,
    /// True if photons paint the dispersed light on surfaces that the camera sees with their whole
    /// spectrum.
    pub ribbons: bool,
    /// Light scattered from surface to surface.
    pub indirect: IndirectPlan,
    pub direct: DirectPlan,
    pub aperture: AperturePlan,
    pub media_plan: MediumPlan,
    /// Caustic and indirect light scattered in a medium.
    pub volume: VolumePlan,
    pub aim: AimPlan,
    pub motion: MotionPlan,
    pub fluorescence: bool,
    pub polarisation: PolarisationPlan,
    /// True if light from 300 to 360 nm excites fluorophores.
    pub ultraviolet: bool,
}

impl Plan {
    pub(super) const EMPTY: Self = Self {
        wavelengths: WavelengthPlan::Free,
        caustics: CausticPlan::Absent,
        ribbons: false,
        indirect: IndirectPlan::Absent,
        direct: DirectPlan::Absent,
        aperture: AperturePlan::Pinhole,
        media_plan: MediumPlan::Air,
        volume: VolumePlan::Absent,
        aim: AimPlan::Plain,
        motion: MotionPlan::Still,
        fluorescence: false,
        polarisation: PolarisationPlan::Absent,
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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WavelengthPlan {
    /// Every photon has its own wavelengths. No camera path reaches dispersive glass.
    Free,
    /// Every camera path starts with one of the pass's shared wavelengths.
    Shared,
    /// Camera paths carry all wavelengths until they refract dispersively, and then one.
    Both,
}

/// The method of computing light that arrives through glass or from mirrors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CausticPlan {
    Absent,
    /// Photons are connected to a camera that sees the surface. Other paths read the photon map.
    Photons,
}

/// The method of computing light scattered from surface to surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IndirectPlan {
    Absent,
    /// Density estimation in a photon map computes this light.
    Photons,
    /// So it does, either around the first diffuse surface of a camera path or behind it.
    PhotonsOrFinalGather,
}

impl IndirectPlan {
    /// Returns true if camera paths may gather photons behind the first diffuse surface.
    pub fn may_gather_behind(self) -> bool {
        self == Self::PhotonsOrFinalGather
    }
}

/// The method of computing direct light (light straight from its source).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DirectPlan {
    Absent,
    /// Shadow rays alone compute this light, because no scattered ray can hit a light source.
    ShadowRays,
    /// Combined by multiple importance sampling.
    ShadowAndScatteredRays,
}

impl DirectPlan {
    pub fn is_absent(self) -> bool {
        self == Self::Absent
    }

    /// Returns true if direct light includes scattered rays that hit a light.
    pub fn traces_scattered_rays(self) -> bool {
        self == Self::ShadowAndScatteredRays
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AperturePlan {
    /// A point.
    Pinhole,
    ThinLens(Rim),
    /// Of real glass. Each wavelength has its own camera ray.
    LensSystem(Rim),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rim {
    /// The rim only blocks rays.
    Stops,
    /// Also diffracts light: each slice of the film's spectrum is convolved with its pattern.
    Diffracts,
}

impl AperturePlan {
    /// Returns true if camera rays start at sampled points of a lens.
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
    /// No object has an interior: all space is air.
    Air,
    /// Objects have interiors, and all interiors are clear.
    Clear,
    /// Bodies absorb light by the Beer–Lambert law.
    Absorbing,
    Scattering(VolumeDirectLighting),
}

/// The method of computing the direct light that a medium scatters into a camera ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeDirectLighting {
    /// A shadow ray computes this light. It starts at a sampled distance along the camera ray.
    ShadowRays,
    /// Lights without a map are sampled by shadow rays.
    LightMaps,
}

impl MediumPlan {
    /// Returns true if no medium attenuates the light between two mutually visible points.
    pub fn is_clear(self) -> bool {
        matches!(self, Self::Air | Self::Clear)
    }

    pub fn has_light_maps(self) -> bool {
        self == Self::Scattering(VolumeDirectLighting::LightMaps)
    }
}

/// The storage of caustic and indirect light in media.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumePlan {
    Absent,
    Points,
    Beams,
    /// Dense media store photon points, and thin media store photon beams.
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

    /// Returns whether a medium stores photon points. `dense` is true if the medium is dense.
    pub fn keeps_points(self, dense: bool) -> bool {
        self == Self::Points || (self == Self::ByDensity && dense)
    }

    /// Returns whether a medium stores photon beams. `dense` is true if the medium is dense.
    pub fn keeps_beams(self, dense: bool) -> bool {
        self == Self::Beams || (self == Self::ByDensity && !dense)
    }
}

/// What photons and camera paths carry of the polarisation of light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PolarisationPlan {
    /// Surfaces treat light as unpolarised.
    Absent,
    /// The polarisation changes the power of the light.
    Power,
    /// The film also records the Stokes vector of the light.
    Stokes,
}

impl PolarisationPlan {
    pub(super) fn of(on: bool, stokes: bool) -> Self {
        match (on, stokes) {
            (false, _) => Self::Absent,
            (true, false) => Self::Power,
            (true, true) => Self::Stokes,
        }
    }

    /// Returns true if paths carry polarisation.
    #[inline]
    pub fn is_on(self) -> bool {
        self != Self::Absent
    }

    /// Returns true if the film records Stokes vectors.
    #[inline]
    pub fn records_stokes(self) -> bool {
        self == Self::Stokes
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AimPlan {
    /// Photons follow the emission distribution of their light.
    Plain,
    Learned,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionPlan {
    /// All passes use the scene at the time when the shutter opens.
    Still,
    /// Each pass samples a time. All its rays and photons use the scene at that time.
    PosedPerPass,
}
