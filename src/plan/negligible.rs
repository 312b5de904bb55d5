//! Effects that something in the scene calls for, and that cannot be seen all the same: nothing reaches it, or what it does is bounded
//! below a stated tolerance. Such an effect is taken out of the scene before it is planned, unless it is forced.

use super::effects::{EFFECTS, listed};
use crate::math::random::ONE_MINUS_ULP;
use crate::optics::glass::Index;
use crate::optics::surface::Class;
use crate::scene::Scene;
use crate::scene::camera::{Aperture, DepthOfField};
use crate::scene::facts::Facts;
use crate::scene::light::Light;

/// An effect that cannot be seen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Negligible {
    /// Its name.
    pub effect: &'static str,
    /// Why, with the bound and the tolerance.
    pub because: String,
}

/// How far, in pixels, a refraction may send two of the light's wavelengths apart, up to 80° of incidence.
const APART_PX: f64 = 0.01;

/// Tangent of that angle of incidence: turning by dθ = tan θ dn/n is at most this × dn in anything denser than air.
const TAN_STEEPEST: f64 = 5.671;

/// How far, in pixels, the lens may spread a point.
const BLUR_PX: f64 = 0.5;

/// The share of the light on any straight way that a medium may take or scatter: a thousandth of a relative error of 1 %.
const TAKEN: f64 = 1e-5;

/// The wavelength in the middle of the scene's light, in nm.
pub(super) fn middle_of_light_nm(scene: &Scene) -> f64 {
    let (from, to) = band_of_light(scene);
    0.5 * (from + to)
}

/// The wavelengths of the scene's light, in nm: least and largest.
fn band_of_light(scene: &Scene) -> (f64, f64) {
    let ends = |light: &Light| [0.0, ONE_MINUS_ULP].map(|u| light.wavelengths.sample(u).0);
    scene.lights.iter().map(ends).fold((f64::INFINITY, 0.0), |(low, high), [from, to]| (low.min(from), high.max(to)))
}

/// All effects that cannot be seen.
pub(super) fn negligible(scene: &Scene) -> Vec<Negligible> {
    let facts = Facts::of(scene);
    let mut all = out_of_reach(scene, &facts);
    let mut add = |effect, because: Option<String>| all.extend(because.map(|because| Negligible { effect, because }));
    add("indirect", indirect(scene, &facts));
    add("dispersion", dispersion(scene, &facts));
    add("depth-of-field", blur(scene, &facts));
    add("absorption", absorption(scene, &facts));
    add("media", media(scene, &facts));
    all
}

/// What only objects inside closed bodies call for.
fn out_of_reach(scene: &Scene, facts: &Facts) -> Vec<Negligible> {
    let enclosures = scene.enclosures();
    if enclosures.is_empty() {
        return Vec::new();
    }
    let everything = Facts::of_all(scene);
    let name = |object: u32| scene.objects[object as usize].name.clone();
    let inside = EFFECTS.iter().filter_map(|effect| {
        let callers = effect.callers(&everything);
        let container = enclosures.iter().find(|(object, _)| callers.contains(&name(**object)))?.1;
        let because = format!(
            "out of reach: {} in {}, an opaque body without a light or the camera in it",
            listed(&callers),
            name(*container)
        );
        effect.callers(facts).is_empty().then_some(Negligible { effect: effect.name, because })
    });
    inside.collect()
}

/// What scatters light is one flat thing, and nothing brings the light back to it.
fn indirect(scene: &Scene, facts: &Facts) -> Option<String> {
    if !(facts.specular.is_empty() && facts.media.is_empty()) {
        return None;
    }
    let scatters = |object: &u32| {
        let class = scene.material_of(*object).surface.class();
        class == Class::Diffuse || class == Class::Glossy
    };
    let mut scattering = (0..scene.objects.len() as u32).filter(scatters);
    let (only, None) = (scattering.next()?, scattering.next()) else { return None };
    let flat = scene.geometry.flat_objects().any(|object| object == only);
    let only = &scene.objects[only as usize].name;
    flat.then(|| {
        format!("what {only} scatters meets nothing that would scatter it again: all else absorbs, and {only} is flat")
    })
}

/// All the light is of nearly one wavelength, or the glass has nearly one index for all of it.
fn dispersion(scene: &Scene, facts: &Facts) -> Option<String> {
    /// Places in the band at which indices are compared; they rise or fall steadily in between.
    const PLACES: u32 = 64;
    let (from, to) = band_of_light(scene);
    if facts.dispersive.is_empty() || facts.lens_system.is_some() || from > to {
        return None;
    }
    let spread = |index: &Index| {
        let n = (0..=PLACES).map(|i| index.n(from + (to - from) * f64::from(i) / f64::from(PLACES)));
        let (low, high) = n.fold((f64::INFINITY, 0.0_f64), |(low, high), n| (low.min(n), high.max(n)));
        high - low
    };
    let indices = scene.materials.iter().filter_map(|material| material.body.as_ref()?.index.as_ref());
    let spread = indices.map(spread).fold(0.0, f64::max);
    let apart_px = spread * TAN_STEEPEST / scene.camera.pixel_angle();
    (apart_px <= APART_PX).then(|| {
        format!(
            "all light is within {from:.3}–{to:.3} nm, for which no index differs by more than {spread:.1e}: a refraction sends \
             it apart by at most {apart_px:.1e} pixels, of {APART_PX} allowed"
        )
    })
}

/// All that the camera sees is in focus. Where it sees mirrors or glass, or light between surfaces, what it looks at may be nearer than any surface.
fn blur(scene: &Scene, facts: &Facts) -> Option<String> {
    let Aperture::ThinLens { .. } = scene.camera.aperture() else { return None };
    let (lenses, between) = (&facts.specular, &facts.media);
    if !(lenses.is_empty() && between.is_empty()) || scene.moves() || scene.camera.diffracts {
        return None;
    }
    let depth = DepthOfField::of(&scene.camera)?;
    let [across, down] = scene.camera.field_of_view().map(|angle| (0.5 * angle).tan());
    // Along the axis, if it stands in a corner of the picture.
    let near_m = scene.geometry.clearance_m(scene.camera.origin()) / (1.0 + across * across + down * down).sqrt();
    let blur_px = depth.blur_at_infinity_px * (depth.focus_m / near_m - 1.0).abs().max(1.0);
    (blur_px < BLUR_PX).then(|| {
        format!(
            "from {near_m:.4} m to infinity nothing is spread over more than {blur_px:.1e} pixels, of {BLUR_PX} allowed"
        )
    })
}

/// No way through bodies of clear glass is long enough.
fn absorption(scene: &Scene, facts: &Facts) -> Option<String> {
    if facts.absorbing_bodies.is_empty() || scene.moves() {
        return None;
    }
    let bodies = across_bodies(scene).filter_map(|(material, across_m)| {
        let absorption = scene.materials[material].body.as_ref()?.absorption.as_ref()?;
        Some(absorption.max() * across_m)
    });
    // A way may lead through all of them.
    too_thin(bodies.sum())
}

/// No way through a medium is long enough, and none glows.
fn media(scene: &Scene, facts: &Facts) -> Option<String> {
    if facts.media.is_empty() || scene.moves() || scene.media.iter().any(|medium| medium.emission.is_some()) {
        return None;
    }
    let bodies = across_bodies(scene).filter_map(|(material, across_m)| {
        let medium = &scene.media[scene.materials[material].body.as_ref()?.medium?];
        Some(medium.largest_extinction() * medium.most_column_m(across_m))
    });
    // A way may lead through all of them.
    too_thin(bodies.sum())
}

fn too_thin(depth: f64) -> Option<String> {
    (depth <= TAKEN).then(|| {
        format!(
            "no straight way through it takes or scatters more than {depth:.1e} of the light, of {TAKEN:.0e} allowed"
        )
    })
}

/// The material of each object, and the longest straight way within a box around it, in m.
fn across_bodies(scene: &Scene) -> impl Iterator<Item = (usize, f64)> + '_ {
    let boxes = [&scene.geometry, &scene.boundaries].map(|geometry| geometry.object_boxes());
    let all = boxes.into_iter().flatten();
    all.map(|(object, (low, high))| (scene.objects[object as usize].material, (high - low).length()))
}
