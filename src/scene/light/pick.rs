//! One place of a light, fixed before anybody asks: seen from there, light arrives at a point by one way.
//!
//! Of a light without extent it is the only place; of one with extent it stands for the whole, and the mean over drawn places is the light.

use super::{Emitter, Incident, Light, Tint, World};
use crate::scene::geometry::{Ray, SurfaceId};
use glam::DVec3;

/// A place of a light, or a direction to it.
#[derive(Debug, Clone, Copy)]
pub struct Pick {
    source: Source,
    surface: Option<SurfaceId>,
    u: [f64; 3],
}

/// Where the light comes from.
#[derive(Debug, Clone, Copy)]
enum Source {
    /// From a place.
    Place(DVec3),
    /// From a place of a surface: its normal, and radiance (W/m²/sr over the band) over the density per m² of the draw.
    Surface { place: DVec3, normal: DVec3, flux: f64 },
    /// Against a unit vector, from a plane through a point, or from infinity.
    Parallel { direction: DVec3, plane: Option<DVec3> },
}

/// The straight way from a point to a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WayTo {
    /// Unit vector towards the light.
    pub direction: DVec3,
    /// Its length in m, which may be infinite; not positive where the point is the light's place, or behind a lamp of parallel light.
    pub distance: f64,
    /// The surface on which it ends.
    pub target: Option<SurfaceId>,
}

impl Light {
    /// A place of the light, drawn by `u`; `None` of lights that one place says too little of: surroundings, glowing media, beams that diverge.
    pub fn pick(&self, world: World<'_>, u: [f64; 3]) -> Option<Pick> {
        let (source, surface) = match &self.emitter {
            Emitter::Point(light) => (Source::Place(light.at), None),
            Emitter::Spot(light) => (Source::Place(light.at()), None),
            Emitter::Beam(light) if light.is_parallel() => {
                (Source::Parallel { direction: -light.axis(), plane: Some(light.centre()) }, None)
            }
            Emitter::Directional(light) => {
                (Source::Parallel { direction: light.towards(u).direction, plane: None }, None)
            }
            Emitter::Area(light) => {
                let sample = world.geometry.sample_area(light.object, u);
                let flux = light.radiance / sample.pdf_area;
                (Source::Surface { place: sample.position, normal: sample.normal, flux }, Some(sample.surface))
            }
            Emitter::Beam(_) | Emitter::Environment(_) | Emitter::Volume(_) => return None,
        };
        Some(Pick { source, surface, u })
    }

    /// Whether [`Light::pick`] finds a place.
    pub fn can_be_picked(&self) -> bool {
        match &self.emitter {
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Directional(_) | Emitter::Area(_) => true,
            Emitter::Beam(light) => light.is_parallel(),
            Emitter::Environment(_) | Emitter::Volume(_) => false,
        }
    }

    /// What of the light comes from the picked place to the point `from`; `None` where it does not shine.
    pub fn picked(&self, world: World<'_>, pick: &Pick, from: DVec3) -> Option<Incident> {
        let Source::Surface { normal, flux, .. } = pick.source else { return self.towards(world, from, pick.u) };
        let WayTo { direction, distance, target } = pick.way_from(from);
        let irradiance = flux * -direction.dot(normal) / (distance * distance);
        (irradiance > 0.0 && irradiance.is_finite()).then_some(Incident {
            direction,
            distance,
            target,
            irradiance,
            pdf_solid_angle: None,
            tint: Tint::Own,
        })
    }
}

impl Pick {
    /// The numbers that drew it.
    pub fn numbers(&self) -> [f64; 3] {
        self.u
    }

    /// The way from a point to the light, whether it shines there or not.
    pub fn way_from(&self, from: DVec3) -> WayTo {
        let (direction, distance) = match self.source {
            Source::Place(place) | Source::Surface { place, .. } => (place - from).normalize_and_length(),
            Source::Parallel { direction, plane: None } => (direction, f64::INFINITY),
            Source::Parallel { direction, plane: Some(point) } => (direction, (point - from).dot(direction)),
        };
        WayTo { direction, distance, target: self.surface }
    }

    /// The same way as the light goes it: the ray from the light, and its length in m; light from infinity starts `far_m` away.
    pub fn ray_to(&self, to: DVec3, far_m: f64) -> (Ray, f64) {
        let WayTo { direction, distance, .. } = self.way_from(to);
        let length = if distance.is_finite() { distance } else { far_m };
        (Ray::new(to + length * direction, -direction), length)
    }
}
