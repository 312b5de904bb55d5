//! Scattering of a path that carries several wavelengths.
//!
//! All wavelengths of a path go the same way until a refraction sends each its own way: then the path keeps one of them.

use super::encounter::Encounter;
use crate::math::frame::Frame;
use crate::math::random::Stream;
use crate::optics::fresnel;
use crate::optics::surface::{Event, Scatter, Surface, Transport};
use crate::spectrum::{LANES, Lanes, Wavelengths};
use glam::DVec3;

/// What became of a path at a surface.
#[derive(Debug, Clone, Copy)]
pub struct Scattered {
    /// The new direction, unit.
    pub direction: DVec3,
    /// Factor on each wavelength's power or radiance; that of lanes given up is 0.
    pub weight: Lanes,
    /// The share of each wavelength's power that this event absorbed.
    pub absorbed: Lanes,
    /// The lane that was kept, if the path gave up the others here.
    pub kept: Option<usize>,
    /// Whether the direction was the only one possible.
    pub delta: bool,
    /// The density per steradian of the direction, for the hero wavelength; 0 for a delta.
    pub pdf: f64,
    /// Whether it went through.
    pub event: Event,
}

/// Scatters a path with these wavelengths; `None` where it ends (an absorber).
#[inline]
pub fn scatter(
    encounter: &Encounter<'_>,
    wavelengths: &Wavelengths,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Scattered> {
    if let Surface::Dielectric(dielectric) = encounter.surface
        && wavelengths.count > 1
        && (encounter.sides.here.is_dispersive() || encounter.sides.there.is_dispersive())
    {
        return match dielectric.is_rough() {
            false => split_at_dispersive_interface(encounter, wavelengths, transport, stream),
            true => split_at_dispersive_facets(encounter, wavelengths, transport, stream),
        };
    }
    scatter_together(encounter, wavelengths, transport, stream)
}

/// The same where wavelengths stay together, as they do wherever nothing disperses: one direction for all of them, drawn for the hero.
#[inline(always)]
pub fn scatter_together(
    encounter: &Encounter<'_>,
    wavelengths: &Wavelengths,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Scattered> {
    let u = stream.triple();
    let (surface, sides) = (encounter.surface, encounter.sides);
    let Drawn { frame, wo, scatter: drawn } =
        draw_consistently(encounter, |wo| surface.sample(wo, sides, wavelengths.hero(), transport, u))?;
    let mut weight = [0.0; LANES];
    let mut absorbed = [0.0; LANES];
    for (k, &nm) in wavelengths.active().iter().enumerate() {
        weight[k] = surface.response(wo, &drawn, sides, transport, nm) / drawn.probability;
        absorbed[k] = surface.absorbed(wo, &drawn, sides, nm);
    }
    Some(Scattered {
        direction: frame.to_world(drawn.wi),
        weight,
        absorbed,
        kept: None,
        delta: drawn.delta,
        pdf: if drawn.delta { 0.0 } else { drawn.probability },
        event: drawn.event,
    })
}

/// A rough interface of dispersive media: its facets send each wavelength its own way, so one is chosen beforehand.
#[inline(never)]
fn split_at_dispersive_facets(
    encounter: &Encounter<'_>,
    wavelengths: &Wavelengths,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Scattered> {
    let kept = ((stream.uniform() * LANES as f64) as usize).min(wavelengths.count - 1);
    let single = Wavelengths::single(wavelengths.nm[kept]);
    let one = scatter_together(encounter, &single, transport, stream)?;
    let spread = |value: f64| lane(kept, value * wavelengths.count as f64);
    Some(Scattered { weight: spread(one.weight[0]), absorbed: spread(one.absorbed[0]), kept: Some(kept), ..one })
}

/// A smooth interface of dispersive media. Reflection keeps all wavelengths and is chosen by their mean reflectance F̄ (weights F/F̄
/// ≤ their number, also where only some are totally reflected); refraction keeps one, drawn by its transmittance, so that
/// its weight is exactly the number of wavelengths.
fn split_at_dispersive_interface(
    encounter: &Encounter<'_>,
    wavelengths: &Wavelengths,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Scattered> {
    let u = stream.uniform();
    with_consistent_normal(encounter, |encounter| {
        let (wo, sides) = (encounter.wo, encounter.sides);
        let count = wavelengths.count as f64;
        let mut reflectance = [0.0; LANES];
        for (k, &nm) in wavelengths.active().iter().enumerate() {
            reflectance[k] = fresnel::dielectric(wo.z.abs(), sides.here.n(nm), sides.there.n(nm));
        }
        let mean = reflectance.iter().sum::<f64>() / count;
        let base = Scattered {
            direction: encounter.frame.to_world(DVec3::new(-wo.x, -wo.y, wo.z)),
            weight: reflectance.map(|f| f / mean),
            absorbed: [0.0; LANES],
            kept: None,
            delta: true,
            pdf: 0.0,
            event: Event::Reflection,
        };
        if u < mean {
            return Some(base);
        }
        let kept = draw_transmitted(&reflectance[..wavelengths.count], (u - mean) * count)?;
        let nm = wavelengths.nm[kept];
        let (n_here, n_there) = (sides.here.n(nm), sides.there.n(nm));
        let refracted = fresnel::refract(wo, DVec3::Z, n_here, n_there)?;
        let scale = match transport {
            Transport::Radiance => (n_here / n_there) * (n_here / n_there),
            Transport::Importance => 1.0,
        };
        Some(Scattered {
            direction: encounter.frame.to_world(refracted),
            weight: lane(kept, count * scale),
            kept: Some(kept),
            event: Event::Transmission,
            ..base
        })
    })
}

/// Draws a lane with probability proportional to its transmittance; `rest` is uniform between 0 and their sum.
fn draw_transmitted(reflectance: &[f64], mut rest: f64) -> Option<usize> {
    let drawn = reflectance.iter().position(|f| {
        rest -= 1.0 - f;
        rest < 0.0
    });
    drawn.or_else(|| reflectance.iter().rposition(|&f| f < 1.0))
}

/// A way on from a surface, in the frame in which it was drawn.
#[derive(Debug, Clone, Copy)]
pub struct Drawn {
    /// The frame.
    pub frame: Frame,
    /// The direction back along the path, in the frame.
    pub wo: DVec3,
    /// The way on.
    pub scatter: Scatter,
}

/// Draws in the frame of the shading normal; where that would send a reflected ray through the surface, or hold a transmitted one
/// back, again in the frame of the true normal.
#[inline(always)]
pub fn draw_consistently(encounter: &Encounter<'_>, draw: impl Fn(DVec3) -> Option<Scatter>) -> Option<Drawn> {
    let Encounter { mut frame, mut wo, .. } = *encounter;
    let mut scatter = draw(wo)?;
    if !encounter.agrees(frame.to_world(scatter.wi), scatter.event) {
        (frame, wo) = encounter.seen_truly();
        scatter = draw(wo)?;
    }
    Some(Drawn { frame, wo, scatter })
}

/// The same for an event that has been worked out for all wavelengths.
fn with_consistent_normal<'a>(
    encounter: &Encounter<'a>,
    scatter: impl Fn(&Encounter<'a>) -> Option<Scattered>,
) -> Option<Scattered> {
    let scattered = scatter(encounter)?;
    if encounter.agrees(scattered.direction, scattered.event) {
        Some(scattered)
    } else {
        let (frame, wo) = encounter.seen_truly();
        scatter(&Encounter { frame, wo, ..*encounter })
    }
}

/// A value in one lane, 0 in the others.
fn lane(kept: usize, value: f64) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes[kept] = value;
    lanes
}
