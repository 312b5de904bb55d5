//! Which effects does this scene call for? Facts → plan.
//!
//! The table stands in [`effects`]; who counts which class of light path in [`partition`]; passes, photons and memory in [`budget`].

pub mod budget;
pub mod effects;
pub mod explain;
mod negligible;
pub mod partition;
mod prepare;

use crate::error::Result;
use crate::scene::facts::Facts;

pub use budget::Budget;
pub use effects::{EFFECTS, Effect, Row, State};
pub use negligible::Negligible;
pub use prepare::prepare;

/// What will be simulated. `effects::EFFECTS` says for each effect which fact calls for it, which field here (or what of the scene itself) switches it,
/// and what its absence means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// How wavelengths are shared between photons and camera paths.
    pub wavelengths: WavelengthPlan,
    /// Light through glass and from mirrors.
    pub caustics: CausticPlan,
    /// Light scattered from surface to surface.
    pub indirect: IndirectPlan,
    /// Light straight from lamps.
    pub direct: DirectPlan,
    /// The camera's opening.
    pub aperture: AperturePlan,
    /// What happens between surfaces.
    pub between: BetweenPlan,
    /// Light that reaches the ray through a medium after it passed glass or was scattered before.
    pub volume: VolumePlan,
    /// Where photons are sent.
    pub aim: AimPlan,
    /// Things that move.
    pub motion: MotionPlan,
}

/// How wavelengths are shared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WavelengthPlan {
    /// Every photon has its own; no camera path meets dispersive glass.
    Free,
    /// Every camera path takes the pass's shared wavelengths from the start.
    Shared,
    /// Camera paths are free until they refract dispersively, then shared.
    Both,
}

/// Light through glass and from mirrors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CausticPlan {
    /// None.
    Absent,
    /// Photons: connected to the camera where it sees the surface, from the map elsewhere.
    Photons,
}

/// Light scattered from surface to surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IndirectPlan {
    /// None.
    Absent,
    /// Photons in a map.
    Photons,
}

/// Light straight from lamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DirectPlan {
    /// None: no surface scatters.
    Absent,
    /// Shadow rays alone: no scattered ray can hit a lamp.
    ShadowRays,
    /// Shadow rays and scattered rays, weighted against each other.
    ShadowAndScatteredRays,
}

impl DirectPlan {
    /// Whether no light straight from lamps is looked for.
    pub fn is_absent(self) -> bool {
        self == Self::Absent
    }

    /// Whether scattered rays look for lamps.
    pub fn scatters_to_lamps(self) -> bool {
        self == Self::ShadowAndScatteredRays
    }
}

/// The camera's opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AperturePlan {
    /// A point.
    Pinhole,
    /// A lens with depth of field.
    ThinLens(Rim),
    /// Real glass: camera rays are traced through it, each wavelength for itself.
    LensSystem(Rim),
}

/// What the rim of the camera's opening does to light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rim {
    /// It holds rays back.
    Stops,
    /// It spreads light too: the film keeps slices of the spectrum apart, and convolves each with its pattern.
    Diffracts,
}

impl AperturePlan {
    /// Whether rays start all over a lens.
    pub fn is_finite(self) -> bool {
        self != Self::Pinhole
    }

    /// Whether light is diffracted at the lens's rim.
    pub fn diffracts(self) -> bool {
        match self {
            Self::Pinhole => false,
            Self::ThinLens(rim) | Self::LensSystem(rim) => rim == Rim::Diffracts,
        }
    }
}

/// What happens between surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BetweenPlan {
    /// Nothing: there is air everywhere.
    Air,
    /// Nothing: air and bodies are clear.
    Clear,
    /// Bodies absorb by Beer's law.
    Absorbing,
    /// Media absorb, scatter or glow.
    Scattering(LampsInside),
}

/// How a camera ray that crosses a medium finds the light that comes straight from lamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LampsInside {
    /// By a shadow ray from a drawn place.
    Asked,
    /// In maps of lamps, made for each pass; of lamps that maps do not serve, by a shadow ray.
    Mapped,
}

impl BetweenPlan {
    /// Whether light that sets out towards a place it can see arrives there whole.
    pub fn is_clear(self) -> bool {
        matches!(self, Self::Air | Self::Clear)
    }

    /// Whether lamps are looked up in maps.
    pub fn maps_lamps(self) -> bool {
        self == Self::Scattering(LampsInside::Mapped)
    }
}

/// Light that reaches a camera ray through a medium after it passed glass or was scattered before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumePlan {
    /// None.
    Absent,
    /// Photons as points, in all media.
    Points,
    /// Photons as beams, in all media.
    Beams,
    /// Points in dense media, beams in thin ones.
    ByDensity,
}

impl VolumePlan {
    /// The plan that has points, beams, both or neither.
    fn of(points: bool, beams: bool) -> Self {
        match (points, beams) {
            (false, false) => Self::Absent,
            (true, false) => Self::Points,
            (false, true) => Self::Beams,
            (true, true) => Self::ByDensity,
        }
    }

    /// Whether photons are kept as points in a medium that is dense or not.
    pub fn keeps_points(self, dense: bool) -> bool {
        self == Self::Points || (self == Self::ByDensity && dense)
    }

    /// Whether photons are kept as beams in a medium that is dense or not.
    pub fn keeps_beams(self, dense: bool) -> bool {
        self == Self::Beams || (self == Self::ByDensity && !dense)
    }
}

/// Where photons are sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AimPlan {
    /// As the lights shine.
    Plain,
    /// Where the pilot found them useful.
    Learned,
}

/// Things that move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionPlan {
    /// All stands as it does when the shutter opens.
    Still,
    /// Each pass has a moment of its own, at which all its rays and photons see the scene.
    PosedPerPass,
}

impl Plan {
    /// The plan for these facts, without the effects that cannot be seen, with others forced on or forbidden by name; the rows tell state and
    /// reason of each.
    pub fn new(
        facts: &Facts,
        negligible: &[Negligible],
        force: &[String],
        forbid: &[String],
    ) -> Result<(Self, Vec<Row>)> {
        effects::decide(facts, negligible, force, forbid)
    }
}
