//! Light sources: what they emit, and what of it reaches a point.
//!
//! One contract holds for all of them and is tested for all: the power that [`Light::emit`] hands out in the mean is the
//! closed form [`Light::power_w`], and the irradiance that [`Light::towards`] finds at a point is the one that the emitted
//! rays bring there.

mod area;
mod beam;
mod directional;
mod environment;
mod pick;
mod point;
mod reach;
mod volume;

#[cfg(test)]
mod contract_tests;

pub use area::Area;
pub use beam::{Beam, mean_stretch};
pub use directional::Directional;
pub use environment::{Environment, EnvironmentMap};
pub use pick::{Pick, WayTo};
pub use point::{Point, Spot};
pub use reach::Reach;

pub use volume::Volume;

use super::geometry::Geometry;
use super::geometry::{Hit, SurfaceId};
use super::interior::Interior;
use super::motion::{Motion, Pose};
use crate::spectrum::{Spectrum, WavelengthDistribution};
use glam::{DAffine3, DVec3};

/// A light source of the scene.
#[derive(Debug, Clone)]
pub struct Light {
    /// Its name for reports.
    pub name: String,
    /// Where the light comes from and where it goes.
    pub emitter: Emitter,
    /// The shape of its spectrum: density per nm with integral 1 over the band.
    pub spectrum: Spectrum,
    /// How photons' wavelengths are drawn: the spectrum times visual importance.
    pub wavelengths: WavelengthDistribution,
    /// The luminous importance of one watt: ∫ S(λ)(x̄+ȳ+z̄)(λ) dλ.
    pub importance_per_watt: f64,
    /// The bodies of glass that the source stands in.
    pub interior: Interior,
    /// Its way in m, if it moves by itself while the shutter is open (objects that shine take their light along); the emitter is where it is
    /// when the shutter opens.
    pub motion: Option<Motion>,
}

/// The kinds of sources. Quantities are over the whole band.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A point that shines equally everywhere.
    Point(Point),
    /// A point that shines into a cone.
    Spot(Spot),
    /// A disk of parallel or slightly divergent light.
    Beam(Beam),
    /// Light from one far direction, or the sun's disk around it.
    Directional(Directional),
    /// Light from everywhere far away.
    Environment(Environment),
    /// The surface of an object.
    Area(Area),
    /// A glowing medium.
    Volume(Box<Volume>),
}

/// The colour of a part of a light: the light's own spectrum, or a mix of an image's three basis lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tint {
    /// The light's own spectrum.
    Own,
    /// Weights of the environment map's red, green and blue lights, summing to 1.
    Mixed([f64; 3]),
    /// Of hot matter of this temperature in K.
    Thermal(f64),
}

/// One emitted ray.
#[derive(Debug, Clone, Copy)]
pub struct Emission {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes, unit.
    pub direction: DVec3,
    /// The surface that it leaves, if any.
    pub from: Option<SurfaceId>,
    /// Flux in W over the band, divided by the density of the draw.
    pub flux_w: f64,
    /// The colour of this ray.
    pub tint: Tint,
}

/// What a shadow ray from a point looks for.
#[derive(Debug, Clone, Copy)]
pub struct Incident {
    /// From the point to the light, unit.
    pub direction: DVec3,
    /// How far the light is; infinite for directions.
    pub distance: f64,
    /// The surface aimed at, which does not block.
    pub target: Option<SurfaceId>,
    /// Radiance divided by density (W/m²), or the perpendicular irradiance of a light without extent.
    pub irradiance: f64,
    /// Density per steradian of this direction; `None` for lights that a scattered ray can never hit.
    pub pdf_solid_angle: Option<f64>,
    /// The colour from there.
    pub tint: Tint,
}

/// The random numbers of one emission; `aim` are the two that decide where the ray goes.
#[derive(Debug, Clone, Copy)]
pub struct EmissionNumbers {
    /// The pair worth aiming: the direction of local lights, the place of distant ones.
    pub aim: [f64; 2],
    /// All others.
    pub rest: [f64; 3],
}

/// The ball around the scene that distant lights shine on; its centre is the origin.
#[derive(Debug, Clone, Copy)]
pub struct World<'a> {
    /// The surfaces.
    pub geometry: &'a Geometry,
    /// The ball's radius in m.
    pub radius_m: f64,
}

impl Emitter {
    /// The emitter after a map of the world's places. A beam's radius is scaled by the mean of what the map does to lengths; surroundings only turn.
    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        match self {
            Self::Point(light) => Self::Point(Point { at: map.transform_point3(light.at), ..*light }),
            Self::Spot(light) => Self::Spot(light.moved(map)),
            Self::Beam(light) => Self::Beam(light.moved(map)),
            Self::Directional(light) => Self::Directional(light.moved(map)),
            Self::Environment(light) => Self::Environment(light.turned(Pose::of(map).rotation)),
            // Its surface moves by itself.
            Self::Area(_) => self.clone(),
            Self::Volume(light) => Self::Volume(Box::new(light.moved(map))),
        }
    }
}

impl Light {
    /// The power that the light sends into the scene, in W over the band.
    pub fn power_w(&self, world: World<'_>) -> f64 {
        match &self.emitter {
            Emitter::Point(light) => light.power_w(),
            Emitter::Spot(light) => light.power_w(),
            Emitter::Beam(light) => light.power_w,
            Emitter::Directional(light) => light.power_w(world.radius_m),
            Emitter::Environment(light) => light.power_w(world.radius_m),
            Emitter::Area(light) => light.power_w(),
            Emitter::Volume(light) => light.power_w(),
        }
    }

    /// Draws one ray of the light's emission.
    pub fn emit(&self, world: World<'_>, u: EmissionNumbers) -> Emission {
        match &self.emitter {
            Emitter::Point(light) => light.emit(u),
            Emitter::Spot(light) => light.emit(u),
            Emitter::Beam(light) => light.emit(u),
            Emitter::Directional(light) => light.emit(world.radius_m, u),
            Emitter::Environment(light) => light.emit(world.radius_m, u),
            Emitter::Area(light) => light.emit(world.geometry, u),
            Emitter::Volume(light) => light.emit(u),
        }
    }

    /// Draws a direction from the point `from` towards the light; `None` where the light cannot shine.
    pub fn towards(&self, world: World<'_>, from: DVec3, u: [f64; 3]) -> Option<Incident> {
        match &self.emitter {
            Emitter::Point(light) => light.towards(from),
            Emitter::Spot(light) => light.towards(from),
            Emitter::Beam(light) => light.towards(from, u),
            Emitter::Directional(light) => Some(light.towards(u)),
            Emitter::Environment(light) => light.towards(u),
            Emitter::Area(light) => light.towards(world.geometry, from, u),
            Emitter::Volume(light) => light.towards(from, u),
        }
    }

    /// Radiance (W/m²/sr over the band) and colour that a ray leaving the scene along `direction` sees of a distant light.
    pub fn escaping(&self, direction: DVec3) -> Option<(f64, Tint)> {
        match &self.emitter {
            Emitter::Directional(light) => light.radiance(direction).map(|radiance| (radiance, Tint::Own)),
            Emitter::Environment(light) => Some(light.radiance(direction)),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Area(_) | Emitter::Volume(_) => None,
        }
    }

    /// The density per steradian with which [`Light::towards`] draws a direction that leaves the scene.
    pub fn escaping_pdf(&self, direction: DVec3) -> f64 {
        match &self.emitter {
            Emitter::Directional(light) => light.pdf(direction),
            Emitter::Environment(light) => light.pdf(direction),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Area(_) | Emitter::Volume(_) => 0.0,
        }
    }

    /// Radiance (W/m²/sr over the band) that a ray along `direction` sees where it hits the light's surface.
    pub fn surface_radiance(&self, direction: DVec3, hit: &Hit) -> f64 {
        match &self.emitter {
            Emitter::Area(light) => light.radiance(direction, hit.normal),
            Emitter::Point(_)
            | Emitter::Spot(_)
            | Emitter::Beam(_)
            | Emitter::Directional(_)
            | Emitter::Environment(_)
            | Emitter::Volume(_) => 0.0,
        }
    }

    /// The density per steradian with which [`Light::towards`] draws, from `from`, the place of `hit` on the light's surface.
    pub fn surface_pdf(&self, world: World<'_>, from: DVec3, hit: &Hit) -> f64 {
        match &self.emitter {
            Emitter::Area(light) => world.geometry.pdf_towards(light.object, from, hit),
            Emitter::Point(_)
            | Emitter::Spot(_)
            | Emitter::Beam(_)
            | Emitter::Directional(_)
            | Emitter::Environment(_)
            | Emitter::Volume(_) => 0.0,
        }
    }

    /// The spectral density per nm of a part of the light with this colour; integral 1 over the band.
    pub fn shape_at(&self, tint: Tint, nm: f64) -> f64 {
        match (tint, &self.emitter) {
            (Tint::Mixed(weights), Emitter::Environment(light)) => light.mixed_at(weights, nm),
            (Tint::Thermal(temperature), Emitter::Volume(light)) => light.shape_at(temperature, nm),
            (Tint::Own | Tint::Mixed(_) | Tint::Thermal(_), _) => self.spectrum.at(nm),
        }
    }

    /// Whether a scattered ray can find the light by itself.
    pub fn can_be_hit(&self) -> bool {
        match &self.emitter {
            Emitter::Area(_) | Emitter::Environment(_) => true,
            Emitter::Directional(light) => light.has_extent(),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Volume(_) => false,
        }
    }
}
