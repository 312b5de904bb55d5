//! Tracing of photon paths from emission to absorption.

use super::fluorescence::scatter_at_fluorescent_surface;
use super::guiding_spheres::scatter_with_guiding;
use super::medium::advance_through_media;
use super::photon_path::PhotonPath;
use super::ribbon::Launch;
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

/// Traces the photons with these indices. Only this function chooses their [`BodyMode`].
pub fn trace<V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    points: &Sobol,
    indices: Range<u64>,
    visitor: &mut V,
    ledger: &mut Ledger,
) {
    // The energy balance does not contain truncated paths.
    let mut truncated = DepthLimit::of(source.scene).is_explicit().then(|| Ledger::new(ledger.absorbed.len()));
    let indices = indices.take_while(|_| !source.stop.is_raised());
    match source.media_plan {
        MediumPlan::Air => indices.for_each(|index| {
            trace_one::<WithoutBodies, V>(source, points, index, visitor, ledger, truncated.as_mut())
        }),
        MediumPlan::Clear | MediumPlan::Absorbing | MediumPlan::Scattering(_) => indices
            .for_each(|index| trace_one::<WithBodies, V>(source, points, index, visitor, ledger, truncated.as_mut())),
    }
}

/// Traces one photon. `truncated` is the ledger of truncated paths.
#[inline(always)]
fn trace_one<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    points: &Sobol,
    index: u64,
    visitor: &mut V,
    ledger: &mut Ledger,
    truncated: Option<&mut Ledger>,
) {
    let limit = DepthLimit::of(source.scene);
    let mut stream = source.stream(index);
    let (mut path, launch) = source.emit::<M>(points, index as u32, &mut stream, visitor);
    let emitted = path.total_w();
    if emitted <= 0.0 {
        return;
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
    if !follow::<M, V>(source, &mut path, 1..limit.events() + 1, &mut stream, visitor, ledger) {
        return;
    }
    ledger.depth_limit += path.total_w();
    if path.photon.light_path == LightPath::Indirect {
        ledger.depth_limit_indirect += path.total_w();
    }
    if let Some(truncated) = truncated {
        follow_truncated::<M, V>(source, limit, &mut path, &mut stream, visitor, truncated);
    }
}

/// Follows some photons that reach the depth limit and contribute only to the estimated bias.
#[inline(never)]
fn follow_truncated<M: BodyMode, V: PhotonVisitor>(
    source: &PhotonSource<'_>,
    limit: DepthLimit,
    path: &mut PhotonPath,
    stream: &mut Stream,
    visitor: &mut V,
    ledger: &mut Ledger,
) {
    let Some(factor) = limit.sample_truncated_path(stream) else { return };
    path.truncate(factor);
    follow::<M, V>(source, path, limit.events() + 1..MAX_EVENTS + 1, stream, visitor, ledger);
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
    let scene = source.scene;
    for depth in events {
        let next = advance::<M, V>(source, path, stream, visitor, ledger);
        let Some(interaction) = &next else { return false };
        visitor.on_arrival(&SurfaceArrival { interaction, photon: &path.photon, depth });
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
            if scatter_at_fluorescent_surface(source, path, interaction, surface, depth, ledger, stream) {
                continue;
            }
            return false;
        }
        let guiding_spheres = &source.strata.guiding_spheres[..];
        let scattered = if guiding_spheres.is_empty() {
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
        if !apply_scattering::<M>(path, interaction, &scattered, depth, ledger, stream) {
            return false;
        }
    }
    true
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
