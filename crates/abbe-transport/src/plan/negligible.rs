//! Finds effects that are present in the scene but cannot be seen in the picture: because no light
//! reaches the object that causes the effect, or because a bound shows that the picture changes by
//! less than a tolerance. They are removed before planning, unless the user forces them.

use super::effect_table::EFFECTS;
use super::effects::{EffectId, listed};
use super::unpolarised::small_polarisation;
use abbe_optics::bsdf::BsdfClass;
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::glass::RefractiveIndex;
use abbe_scene::camera::{Aperture, DepthOfField};
use abbe_scene::facts::Facts;
use abbe_scene::{Material, Scene};
use abbe_spectra::math::elementary::tan;
use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_spectra::spectrum::WavelengthDistribution;
use std::collections::BTreeSet;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct NegligibleEffect {
    pub(super) effect: EffectId,
    /// The reason, with the bound and the tolerance.
    pub(super) because: String,
}

/// The tolerance for dispersion, in pixels between the images of one point at two wavelengths.
const MAX_SEPARATION_PX: f64 = 0.01;

/// The tangent of 80°, the largest angle of incidence of the bound for dispersion. If the index n >
/// 1 changes by dn, the refracted ray turns by tan θ dn/n, at most tan 80° × dn.
const TAN_MAX_INCIDENCE: f64 = 5.671;

/// The magnification that this bound covers, by curved surfaces and repeated refraction.
const MAX_MAGNIFICATION: f64 = 100.0;

/// The tolerance for depth of field: the largest width in pixels of a point's image.
const MAX_BLUR_PX: f64 = 0.5;

/// The largest loss of light that may be ignored: 0.1 %, a tenth of an error of 1 %.
const MAX_LOSS: f64 = 1e-3;

/// The largest number of straight segments of a path, if the scene does not limit the number.
const MAX_SEGMENTS: u32 = 10_000;

/// Returns the centre of the wavelength range of the scene's lights and fluorophores, in nm.
pub(super) fn light_centre_nm(scene: &Scene) -> f64 {
    let (from, to) = light_range_nm(scene);
    0.5 * (from + to)
}

/// Returns the smallest and the largest wavelength of the scene's lights and fluorophores, in nm.
fn light_range_nm(scene: &Scene) -> (f64, f64) {
    let of_lights = scene.lights.iter().map(|light| &light.wavelengths);
    let of_fluorophores = scene.fluorophores().map(Fluorophore::wavelengths);
    let ends = |wavelengths: &WavelengthDistribution| [0.0, ONE_MINUS_ULP].map(|u| wavelengths.sample(u).0);
    let all = of_lights.chain(of_fluorophores).map(ends);
    all.fold((f64::INFINITY, 0.0), |(low, high), [from, to]| (low.min(from), high.max(to)))
}

/// Returns all effects that cannot be seen, each with its reason.
pub(super) fn negligible(scene: &Scene) -> Vec<NegligibleEffect> {
    let facts = Facts::of(scene);
    let mut all = unreachable(scene, &facts);
    let mut add =
        |effect, because: Option<String>| all.extend(because.map(|because| NegligibleEffect { effect, because }));
    let indirect = indirect(scene, &facts);
    add(EffectId::Indirect, indirect.clone());
    add(EffectId::FinalGather, indirect);
    add(EffectId::Dispersion, dispersion(scene, &facts));
    add(EffectId::DepthOfField, depth_of_field(scene, &facts));
    add(EffectId::Absorption, absorption(scene, &facts));
    add(EffectId::Media, media(scene, &facts));
    add(EffectId::Polarisation, facts.polarising.is_empty().then(|| small_polarisation(scene)).flatten());
    all
}

/// Returns the effects only of objects inside closed opaque bodies, which no light reaches.
fn unreachable(scene: &Scene, facts: &Facts) -> Vec<NegligibleEffect> {
    let enclosures = scene.enclosures();
    if enclosures.is_empty() {
        return Vec::new();
    }
    let everything = Facts::of_all(scene);
    let name = |object: u32| scene.objects[object as usize].name.clone();
    let inside = EFFECTS.iter().filter_map(|effect| {
        let requirers = (effect.requires)(&everything);
        let names: BTreeSet<&str> = requirers.iter().map(String::as_str).collect();
        let container = enclosures.iter().find(|(object, _)| names.contains(name(**object).as_str()))?.1;
        let because = format!(
            "enclosed: {} in {}, an opaque body that contains neither a light nor the camera",
            listed(&requirers),
            name(*container)
        );
        (effect.requires)(facts).is_empty().then_some(NegligibleEffect { effect: effect.id, because })
    });
    inside.collect()
}

/// Indirect light is absent if only one flat object scatters, and nothing sends light back.
fn indirect(scene: &Scene, facts: &Facts) -> Option<String> {
    if !(facts.specular.is_empty() && facts.media.is_empty()) {
        return None;
    }
    let scatters = |object: &u32| {
        let class = scene.material_of(*object).surface.class();
        class == BsdfClass::Diffuse || class == BsdfClass::Glossy
    };
    let mut scattering = (0..scene.objects.len() as u32).filter(scatters);
    let (only, None) = (scattering.next()?, scattering.next()) else { return None };
    let flat = scene.geometry.flat_objects().any(|object| object == only);
    let only = &scene.objects[only as usize].name;
    flat.then(|| {
        format!(
            "light that {only} scatters is never scattered again: {only} is flat, and all other objects absorb light"
        )
    })
}

/// Dispersion is negligible if the lights and fluorophores emit at nearly one wavelength, or if the
/// glass has nearly the same index at all of them.
///
/// The distance between two wavelengths grows along the path after the refraction. The bound
/// assumes the longest path in the scene, to a surface as near to the camera as the nearest one.
fn dispersion(scene: &Scene, facts: &Facts) -> Option<String> {
    /// The wavelength intervals. Indices are assumed to be monotonic within each.
    const INTERVALS: u32 = 64;
    let (from, to) = light_range_nm(scene);
    // The bound is an angle in pixels, which a meter or an orthographic camera lacks.
    let has_angles = scene.camera.pixel_angle() > 0.0;
    let bounded = facts.lens_system.is_none() && facts.meters.is_empty() && has_angles;
    if facts.dispersive.is_empty() || !bounded || from > to {
        return None;
    }
    let spread = |index: &RefractiveIndex| {
        let n = (0..=INTERVALS).map(|i| index.n(from + (to - from) * f64::from(i) / f64::from(INTERVALS)));
        let (low, high) = n.fold((f64::INFINITY, 0.0_f64), |(low, high), n| (low.min(n), high.max(n)));
        high - low
    };
    let indices = scene.materials.iter().filter_map(|material| material.body.as_ref()?.index.as_ref());
    // In any order of a grating, the component across the grooves is at most 1 in each medium, and
    // differs between two wavelengths by at most twice their relative difference.
    let diffracts = |material: &Material| material.surface.components().any(|part| part.grating().is_some());
    let by_gratings = if scene.materials.iter().any(diffracts) { 2.0 * (to - from) / from } else { 0.0 };
    let spread = indices.map(spread).fold(by_gratings, f64::max);
    let near_m = scene.geometry.clearance_m(scene.camera.origin());
    let arm_m = scene.camera.origin().length() + scene.radius_m;
    let lever = (2.0 * arm_m / near_m).max(1.0);
    let separation_px = MAX_MAGNIFICATION * lever * spread * TAN_MAX_INCIDENCE / scene.camera.pixel_angle();
    (separation_px <= MAX_SEPARATION_PX).then(|| {
        format!(
            "all light is within {from:.3}–{to:.3} nm, where no index varies by more than {spread:.1e}: refraction \
             separates wavelengths by at most {separation_px:.1e} pixels, and {MAX_SEPARATION_PX} are allowed"
        )
    })
}

/// Depth of field is negligible if all surfaces are in focus. The bound does not hold with mirrors,
/// glass, glossy surfaces or media: an image in a mirror or in a polished coat, or light in a
/// medium, may be nearer than any surface.
fn depth_of_field(scene: &Scene, facts: &Facts) -> Option<String> {
    let Aperture::ThinLens { .. } = scene.camera.aperture() else { return None };
    let images = !(facts.specular.is_empty() && facts.glossy.is_empty() && facts.media.is_empty());
    if images || scene.moves() || scene.camera.diffracts {
        return None;
    }
    let depth = DepthOfField::of(&scene.camera)?;
    let [across, down] = scene.camera.field_of_view().map(|angle| tan(0.5 * angle));
    // A lower bound of all depths along the axis: the nearest point, in a corner of the picture.
    let near_m = scene.geometry.clearance_m(scene.camera.origin()) / (1.0 + across * across + down * down).sqrt();
    let blur_px = depth.blur_at_infinity_px * (depth.focus_m / near_m - 1.0).abs().max(1.0);
    (blur_px < MAX_BLUR_PX).then(|| {
        format!(
            "from {near_m:.4} m to infinity, the lens spreads a point over at most {blur_px:.1e} pixels, and {MAX_BLUR_PX} are allowed"
        )
    })
}

/// Absorption is negligible if all straight paths are, each of whose segments may cross the bodies.
fn absorption(scene: &Scene, facts: &Facts) -> Option<String> {
    if facts.absorbing_bodies.is_empty() || scene.moves() {
        return None;
    }
    let fluorescent = !facts.fluorescent.is_empty();
    let bodies = diagonals(scene).filter_map(|(material, diagonal_m)| {
        let absorption = scene.materials[material].body.as_ref()?.absorption.as_ref()?;
        // A fluorophore can also receive light below the band.
        let below = if fluorescent { absorption.ultraviolet_range().1 } else { 0.0 };
        Some(absorption.max().max(below) * diagonal_m)
    });
    // A segment may cross all bodies.
    if_thin(scene, bodies.sum())
}

/// Media are negligible if they only absorb, and too little along all straight paths. Even a thin
/// medium that scatters is visible in front of a black background.
fn media(scene: &Scene, facts: &Facts) -> Option<String> {
    let visible = scene.media.iter().any(|medium| medium.emission.is_some() || medium.scatters());
    if facts.media.is_empty() || scene.moves() || visible {
        return None;
    }
    let bodies = diagonals(scene).filter_map(|(material, diagonal_m)| {
        let medium = &scene.media[scene.materials[material].body.as_ref()?.medium?];
        Some(medium.largest_extinction() * medium.max_column_m(diagonal_m))
    });
    if_thin(scene, bodies.sum())
}

/// Returns the reason if the optical depth of a straight segment is negligible.
fn if_thin(scene: &Scene, depth: f64) -> Option<String> {
    let segments = scene.settings.max_depth.unwrap_or(MAX_SEGMENTS).saturating_add(1);
    let loss = depth * f64::from(segments);
    (loss <= MAX_LOSS).then(|| {
        format!(
            "no path of {segments} segments through it loses more than {loss:.1e} of its light, and {MAX_LOSS:.0e} is allowed"
        )
    })
}

/// Returns the material and the diagonal (m) of each object, its longest straight path.
fn diagonals(scene: &Scene) -> impl Iterator<Item = (usize, f64)> + '_ {
    let boxes = [&scene.geometry, &scene.boundaries].map(|geometry| geometry.object_bounds());
    let all = boxes.into_iter().flatten();
    all.map(|(object, (low, high))| (scene.objects[object as usize].material, (high - low).length()))
}
