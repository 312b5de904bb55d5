//! Scattering at the surfaces of crystals, which split a path into an ordinary and an extraordinary
//! wave.
//!
//! Inside, a path is one of the two waves, and its direction is that of the power. The medium stack
//! says which wave it is. The phase between the waves is lost: a plate between polarisers that
//! shows interference colours is a retarder.

use super::scattered_ray::{ScatteredRay, single_lane, transmitted_scale};
use super::surface_interaction::SurfaceInteraction;
use abbe_optics::bsdf::{CrystalInterface, ScatterEvent, TransportMode};
use abbe_polarisation::crystal::{
    CrystalEvent, CrystalEvents, CrystalMode, CrystalRay, CrystalSurface, CrystalTracing, UniaxialIndices,
};
use abbe_polarisation::{ScatteringEvent, Stokes, StokesFrame};
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::Wavelengths;
use glam::DVec3;

/// Scatters a path at a crystal, where it keeps one of its wavelengths. The event is selected by
/// the power of the light of the kept lane, which [`PhotonPolarisation`](super::PhotonPolarisation)
/// or the response of the camera describes for a power of 1. Returns `None` if nothing is possible.
#[inline(never)]
pub(crate) fn scatter_at_crystal(
    interaction: &SurfaceInteraction<'_>,
    wavelengths: &Wavelengths,
    transport: TransportMode,
    light_of: impl Fn(usize) -> Stokes,
    stream: &mut Stream,
) -> Option<ScatteredRay> {
    let [choice, u, _] = stream.triple();
    let count = wavelengths.count as f64;
    let lane = ((choice * count) as usize).min(wavelengths.count - 1);
    let (nm, light) = (wavelengths.nm[lane], light_of(lane));
    let CrystalEvents { events, s_axis } = events_at_crystal(interaction, transport, nm)?;
    let s_axis = interaction.frame.to_world(s_axis);
    let selection =
        events.map(|event| event.map_or(0.0, |event| selected_power(interaction, &event, s_axis, transport, light)));
    let all: f64 = selection.iter().sum();
    let mut rest = u * all;
    let chosen = selection.iter().position(|power| {
        rest -= power;
        rest < 0.0
    })?;
    let CrystalEvent { ray, power, .. } = events[chosen]?;
    let event = event_of(interaction, ray);
    let scale = match event {
        ScatterEvent::Reflection => 1.0,
        ScatterEvent::Transmission => {
            let sides = interaction.sides;
            transmitted_scale(transport, sides.here.n(nm), sides.there.n(nm))
        }
    };
    let weight = count * scale * power * all / selection[chosen];
    let direction = interaction.frame.to_world(ray.direction);
    Some(ScatteredRay {
        kept: (wavelengths.count > 1).then_some(lane),
        wave: ray.mode,
        ..ScatteredRay::specular(direction, single_lane(lane, weight), event)
    })
}

/// Returns what a crystal does to the polarisation of light at the wavelength `nm`, for a path that
/// continues as this wave, or outside.
pub(super) fn event_at_crystal<'a>(
    interaction: &SurfaceInteraction<'_>,
    wave: Option<CrystalMode>,
    transport: TransportMode,
    nm: f64,
) -> ScatteringEvent<'a> {
    let found = events_at_crystal(interaction, transport, nm).and_then(|CrystalEvents { events, s_axis }| {
        let event = events.into_iter().flatten().find(|event| event.ray.mode == wave)?;
        Some((event, interaction.frame.to_world(s_axis)))
    });
    let Some((event, s_axis)) = found else { return ScatteringEvent::DEPOLARISER };
    let next = interaction.frame.to_world(event.ray.direction);
    ScatteringEvent::of_matrix(event.matrix, light_directions(interaction, next, transport), s_axis)
}

/// Returns the directions of travel of the arriving and of the leaving light.
fn light_directions(interaction: &SurfaceInteraction<'_>, next: DVec3, transport: TransportMode) -> [DVec3; 2] {
    match transport {
        TransportMode::Importance => [interaction.incoming, next],
        TransportMode::Radiance => [-next, -interaction.incoming],
    }
}

/// Returns the events of the path in the shading frame, or `None` if the surface is no crystal.
fn events_at_crystal(interaction: &SurfaceInteraction<'_>, transport: TransportMode, nm: f64) -> Option<CrystalEvents> {
    let CrystalInterface { extraordinary, axis } = interaction.bsdf.model.crystal()?;
    let (wo, sides) = (interaction.wo, interaction.sides);
    let is_inside = wo.z < 0.0;
    let (outside, ordinary) = if is_inside { (sides.there, sides.here) } else { (sides.here, sides.there) };
    let indices = UniaxialIndices { ordinary: ordinary.n(nm), extraordinary: extraordinary.n(nm) };
    let surface = CrystalSurface { indices, axis: interaction.frame.to_local(*axis), outside: outside.n(nm) };
    let mode = is_inside.then(|| {
        let is_extraordinary = interaction.here.is_extraordinary(interaction.hit.object);
        if is_extraordinary { CrystalMode::Extraordinary } else { CrystalMode::Ordinary }
    });
    let tracing = match transport {
        TransportMode::Importance => CrystalTracing::FromLight,
        TransportMode::Radiance => CrystalTracing::FromCamera,
    };
    Some(surface.events(CrystalRay { direction: -wo, mode }, tracing))
}

/// Returns the part of the light that an event receives: of the power of a photon, or of what the
/// camera would receive of natural light.
fn selected_power(
    interaction: &SurfaceInteraction<'_>,
    event: &CrystalEvent,
    s_axis: DVec3,
    transport: TransportMode,
    light: Stokes,
) -> f64 {
    let next = interaction.frame.to_world(event.ray.direction);
    let [arriving, leaving] = light_directions(interaction, next, transport);
    let travel = if transport == TransportMode::Importance { arriving } else { leaving };
    let Stokes(light) = StokesFrame::canonical(travel).rotation_to(s_axis) * light;
    let matrix = event.matrix.0;
    let received = |i: usize| if transport == TransportMode::Importance { matrix[0][i] } else { matrix[i][0] };
    event.power * (0..4).map(|i| received(i) * light[i]).sum::<f64>().max(0.0)
}

fn event_of(interaction: &SurfaceInteraction<'_>, ray: CrystalRay) -> ScatterEvent {
    let was_inside = interaction.wo.z < 0.0;
    if ray.mode.is_some() == was_inside { ScatterEvent::Reflection } else { ScatterEvent::Transmission }
}
