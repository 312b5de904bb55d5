//! Tracing of photon paths from emission to absorption.

use super::fluorescence::scatter_at_fluorescent_surface;
use super::guiding_spheres::scatter_with_guiding;
use super::launch::Launch;
use super::medium::advance_through_media;
use super::photon_path::{PhotonDepth, PhotonPath, PhotonState};
use super::source::PhotonSource;
use super::visitor::{PhotonFlight, PhotonVisitor, SurfaceArrival};
use crate::plan::MediumPlan;
use crate::plan::partition::LightPath;
use crate::walk::SurfaceLookup;
use crate::walk::ledger::Ledger;
use crate::walk::{
    BodyMode, DepthLimit, MAX_EVENTS, ScatteredRay, SurfaceInteraction, WithBodies, WithoutBodies, long_path_survival,
};
use abbe_optics::bsdf::{BsdfClass, TransportMode};
use abbe_spectra::math::random::Stream;
use abbe_spectra::math::sobol::Sobol;
use abbe_spectra::spectrum::{BAND_NM, LANES};
use std::ops::Range;

/// Traces the photons with these indices. Only this function and `trace_limited` choose their
/// [`BodyMode`].
pub fn trace<V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    points: &Sobol,
    indices: Range<u64>,
    visitor: &mut V,
    ledger: &mut Ledger,
) {
    let limit = DepthLimit::of(source.scene);
    let indices = indices.take_while(|_| !source.stop.is_raised());
    if limit.is_explicit() {
        return trace_limited(source, points, (indices, limit), visitor, ledger);
    }
    match source.media_plan {
        MediumPlan::Air => {
            indices.for_each(|index| trace_one::<WithoutBodies, V>(source, points, index, visitor, ledger))
        }
        MediumPlan::Clear | MediumPlan::Absorbing | MediumPlan::Scattering(_) => {
            indices.for_each(|index| trace_one::<WithBodies, V>(source, points, index, visitor, ledger));
        }
    }
}

/// Traces photons whose paths end at an explicit limit.
#[inline(never)]
fn trace_limited<V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    points: &Sobol,
    (indices, limit): (impl Iterator<Item = u64>, DepthLimit),
    visitor: &mut V,
    ledger: &mut Ledger,
) {
    // The energy balance does not contain truncated paths.
    let ledgers = &mut [ledger, &mut Ledger::new(source.scene.materials.len())];
    match source.media_plan {
        MediumPlan::Air => {
            indices.for_each(|index| {
                trace_one_limited::<WithoutBodies, V>(source, points, (index, limit), visitor, ledgers);
            });
        }
        MediumPlan::Clear | MediumPlan::Absorbing | MediumPlan::Scattering(_) => {
            indices.for_each(|index| {
                trace_one_limited::<WithBodies, V>(source, points, (index, limit), visitor, ledgers);
            });
        }
    }
}

#[inline(always)]
fn trace_one<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    points: &Sobol,
    index: u64,
    visitor: &mut V,
    ledger: &mut Ledger,
) {
    let mut stream = source.stream(index);
    let Some(mut path) = start::<M, V>(source, points, index, &mut stream, visitor, ledger) else { return };
    if follow::<M, V>(source, &mut path, 1..MAX_EVENTS + 1, &mut stream, visitor, ledger) {
        path.book_at_limit(ledger);
    }
}

/// Traces one photon through as many surface events as the limit allows, and to the next surface.
/// Some photons then continue, and contribute only to the estimated bias. `ledgers` are those of
/// paths within the limit and of truncated paths.
fn trace_one_limited<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    points: &Sobol,
    (index, limit): (u64, DepthLimit),
    visitor: &mut V,
    [ledger, truncated]: &mut [&mut Ledger; 2],
) {
    let mut stream = source.stream(index);
    let Some(mut path) = start::<M, V>(source, points, index, &mut stream, visitor, ledger) else { return };
    let last = limit.events();
    for depth in 1..=last {
        path.photon.depth = PhotonDepth::Within((depth - 1) as u16);
        if !follow_to_next::<M, V>(source, &mut path, depth, &mut stream, visitor, ledger) {
            return;
        }
    }
    path.photon.depth = PhotonDepth::Within(last as u16);
    let next = arrive::<M, V>(source, &mut path, last + 1, &mut stream, visitor, ledger);
    let Some(interaction) = next else { return };
    path.book_at_limit(ledger);
    let Some(factor) = limit.sample_truncated_path(&mut stream) else { return };
    path.multiply_power(factor);
    path.photon.depth = PhotonDepth::Beyond(last as u16);
    if !interact::<M, V>(source, &mut path, (&interaction, last + 1), &mut stream, visitor, truncated) {
        return;
    }
    for depth in last + 2..=MAX_EVENTS {
        path.photon.depth = PhotonDepth::Beyond((depth - 1) as u16);
        if !follow_to_next::<M, V>(source, &mut path, depth, &mut stream, visitor, truncated) {
            return;
        }
    }
}

/// Emits a photon, or returns `None` if it has no power. It is large, so both loops share one copy.
#[inline(never)]
fn start<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    points: &Sobol,
    index: u64,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> Option<PhotonPath> {
    let (path, launch) = source.emit::<M>(points, index as u32, stream, visitor);
    let emitted = path.total_w();
    if emitted <= 0.0 {
        return None;
    }
    ledger.emitted += emitted;
    // The wavelengths of a photon ascend.
    if path.photon.wavelengths.nm[0] < BAND_NM.0 {
        ledger.ultraviolet += path.ultraviolet_w();
    }
    visitor.on_start(&path.ray_state.ray, &path.photon);
    if M::HAS_BODIES
        && let Some(factor) = source.ribbon_factor(index)
    {
        visitor.on_launch(&Launch { flux_w: launch.flux_w * factor, ..launch });
    }
    Some(path)
}

/// Follows a photon through surface event number `depth`. Returns true if it survives.
#[inline(never)]
fn follow_to_next<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    depth: u32,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> bool {
    follow::<M, V>(source, path, depth..depth + 1, stream, visitor, ledger)
}

/// Follows a photon through these surface events, from 1. Returns true if it survives.
#[inline(always)]
fn follow<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    events: Range<u32>,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> bool {
    for depth in events {
        let next = arrive::<M, V>(source, path, depth, stream, visitor, ledger);
        let Some(interaction) = &next else { return false };
        if !interact::<M, V>(source, path, (interaction, depth), stream, visitor, ledger) {
            return false;
        }
    }
    true
}

/// Advances a photon to its surface number `depth`.
#[inline(always)]
fn arrive<'a, M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'a>,
    path: &mut PhotonPath,
    depth: u32,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> Option<SurfaceInteraction<'a>> {
    let next = advance::<M, V>(source, path, stream, visitor, ledger);
    if let Some(interaction) = &next {
        visitor.on_arrival(&SurfaceArrival { interaction, photon: &path.photon, depth });
    }
    next
}

/// Records a photon at a surface, and scatters it there. Returns true if it survives.
#[inline(always)]
fn interact<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    (interaction, depth): (&SurfaceInteraction<'_>, u32),
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> bool {
    let scene = source.scene;
    if M::HAS_BODIES && scene.body_of(interaction.hit.object).is_some() {
        visitor.on_body_face();
    }
    if interaction.crossed_hidden_face && path.photon.light_path == LightPath::Direct {
        path.photon.light_path = LightPath::Caustic;
    }
    // A photon at a mixed material is reported for any selected component, because camera paths
    // select a component independently. Direct lighting already includes photons straight from
    // a light.
    if path.photon.light_path != LightPath::Direct
        && !path.photon.excitation
        && scene.materials[interaction.material].surface.class() >= BsdfClass::Glossy
    {
        visitor.on_surface(&SurfaceArrival { interaction, photon: &path.photon, depth }, stream);
    }
    if let Some(surface) = interaction.bsdf.model.as_fluorescent() {
        return scatter_at_fluorescent_surface(source, path, interaction, surface, depth, ledger, stream);
    }
    let guiding_spheres = &source.strata.guiding_spheres[..];
    let scattered = if path.polarised {
        scatter_polarised::<M>(source, path, interaction, stream, ledger)
    } else if guiding_spheres.is_empty() {
        M::scatter(interaction, &path.photon.wavelengths, TransportMode::Importance, stream)
    } else {
        scatter_with_guiding::<M>(guiding_spheres, path, interaction, stream, ledger)
    };
    let Some(scattered) = scattered else {
        ledger.absorbed[interaction.material] += path.total_w();
        return false;
    };
    if M::HAS_BODIES && source.has_ribbons() {
        path.photon.ribbon = path.photon.ribbon.after(interaction, scattered.kept.is_some());
    }
    apply_scattering::<M>(path, interaction, &scattered, depth, ledger, stream)
}

/// Scatters a photon, selected at smooth surfaces by the power of its polarised light, and polarises
/// it.
#[inline(never)]
fn scatter_polarised<M: BodyMode>(
    source: &PhotonSource<'_>,
    path: &mut PhotonPath,
    interaction: &SurfaceInteraction<'_>,
    stream: &mut Stream,
    ledger: &mut Ledger,
) -> Option<ScatteredRay> {
    let PhotonState { polarisation, wavelengths, .. } = path.photon;
    let guiding_spheres = &source.strata.guiding_spheres[..];
    let smooth = polarisation.scatter_at_smooth_surface(interaction, &wavelengths, stream);
    let mut scattered = match smooth {
        Some(scattered) => scattered?,
        None if guiding_spheres.is_empty() => M::scatter(interaction, &wavelengths, TransportMode::Importance, stream)?,
        None => scatter_with_guiding::<M>(guiding_spheres, path, interaction, stream, ledger)?,
    };
    path.polarise(interaction, &mut scattered);
    Some(scattered)
}

#[inline(always)]
fn advance<'a, M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'a>,
    path: &mut PhotonPath,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) -> Option<SurfaceInteraction<'a>> {
    if M::HAS_BODIES && !source.media_plan.is_clear() {
        return advance_through_media(source, path, stream, visitor, ledger);
    }
    let lookup = SurfaceLookup::of_line(stream.uniform());
    let interaction = M::next_interaction(source.scene, path.ray_state, lookup);
    let length_m = interaction.as_ref().map_or(f64::INFINITY, |interaction| interaction.distance_m);
    visitor.on_flight(&PhotonFlight { ray: path.ray_state.ray, length_m, photon: &path.photon, segment: None });
    if interaction.is_none() {
        let inside = M::HAS_BODIES && !path.ray_state.medium_stack.is_air();
        ledger.add_escaped(path.total_w(), inside);
        visitor.on_escape(&path.ray_state.ray, &path.photon);
    }
    interaction
}

/// Applies surface event number `depth` and Russian roulette; returns whether the photon survives.
#[inline(always)]
fn apply_scattering<M: BodyMode>(
    path: &mut PhotonPath,
    interaction: &SurfaceInteraction<'_>,
    scattered: &ScatteredRay,
    depth: u32,
    ledger: &mut Ledger,
    stream: &mut Stream,
) -> bool {
    let before = path.total_w();
    let correction =
        if scattered.delta { 1.0 } else { interaction.adjoint_correction(-interaction.incoming, scattered.direction) };
    let mut absorbed = 0.0;
    // Russian roulette keeps the power of all photons similar: the survival probability is the mean
    // weight of the photon's wavelengths, at most 1, and smaller on long paths.
    let (mut weights, count) = (0.0, M::wavelength_count(&path.photon.wavelengths));
    for k in 0..count {
        absorbed += path.photon.power[k] * path.watts[k] * scattered.absorbed[k];
        path.photon.power[k] *= scattered.weight[k] * correction;
        weights += scattered.weight[k] * correction;
    }
    if let Some(kept) = scattered.kept {
        path.keep_lane(kept);
    }
    ledger.absorbed[interaction.material] += absorbed;
    let survival = (weights / count as f64).min(1.0) * long_path_survival(depth);
    let survives = survival > 0.0 && stream.uniform() < survival;
    if survives {
        path.divide_power(survival);
    } else {
        path.photon.power = [0.0; LANES];
    }
    ledger.sampling += path.total_w() + absorbed - before;
    path.ray_state = M::spawn_scattered(interaction, scattered);
    path.photon.light_path = match (path.photon.light_path, scattered.delta) {
        (LightPath::Indirect, _) | (_, false) => LightPath::Indirect,
        (LightPath::Direct | LightPath::Caustic, true) => LightPath::Caustic,
    };
    survives
}
