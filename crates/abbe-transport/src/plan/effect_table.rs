//! The table of effects: the facts that require each effect, its field of the plan, its event
//! counter, its removal, and the texts of `abbe explain`.

use super::effect_parts::{bodies, pictured_diffuse, replace_surfaces, with_final_gather};
use super::effects::{Effect, EffectId, Removal};
use super::fields::{
    AimPlan, AperturePlan, CausticPlan, DirectPlan, IndirectPlan, MediumPlan, MotionPlan, PolarisationPlan, Rim,
    VolumeDirectLighting, VolumePlan, WavelengthPlan,
};
use abbe_optics::bsdf::Bsdf;
use abbe_optics::glass::RefractiveIndex;
use abbe_scene::Layer;
use abbe_scene::camera::SystemLens;
use abbe_scene::light::{Emitter, Light};

impl EffectId {
    pub fn effect(self) -> &'static Effect {
        &EFFECTS[self as usize]
    }
}

/// All effects, in the order of decision.
pub static EFFECTS: [Effect; EffectId::ALL.len()] = {
    let mut rows = [row(EffectId::ALL[0]); EffectId::ALL.len()];
    let mut i = 0;
    while i < rows.len() {
        assert!(EffectId::ALL[i] as usize == i, "`ALL` and the variants have the same order");
        rows[i] = row(EffectId::ALL[i]);
        i += 1;
    }
    rows
};

/// Matches exhaustively, so that no variant lacks a row and no row a part.
const fn row(id: EffectId) -> Effect {
    match id {
        EffectId::Dispersion => Effect {
            id,
            name: "dispersion",
            field: "wavelengths",
            cost: "four camera paths instead of one behind dispersive glass, and a second photon set at the wavelengths \
                   that the pass shares",
            absent: "no camera path is divided into one path for each shared wavelength",
            required_by: "dispersive glass or gratings",
            not_required: "no glass has an index that depends on the wavelength, and there is no grating",
            requires: |facts| facts.dispersive.clone(),
            set: |plan, _, on| plan.wavelengths = if on { WavelengthPlan::Both } else { WavelengthPlan::Free },
            events: |tally, _| tally.dispersions,
            removal: Removal::FromScene(|scene, nm| {
                replace_surfaces(scene, |surface| surface.without_dispersion(nm))?;
                for body in bodies(scene) {
                    body.index = body.index.as_ref().map(|index| RefractiveIndex::constant(index.n(nm))).transpose()?;
                }
                Ok(())
            }),
        },
        EffectId::Shared => Effect {
            id,
            name: "shared",
            field: "wavelengths",
            cost: "four camera paths that start at the camera, at the shared wavelengths of the pass; more colour noise",
            absent: "camera paths carry all wavelengths until they refract dispersively",
            required_by: "a camera lens of real glass",
            not_required: "the camera has no lens of real glass, which would refract each wavelength differently",
            requires: |facts| facts.lens_system.iter().cloned().collect(),
            set: |plan, _, on| {
                if on {
                    plan.wavelengths = WavelengthPlan::Shared;
                }
            },
            events: |tally, plan| match plan.wavelengths {
                WavelengthPlan::Shared => tally.shared_paths,
                WavelengthPlan::Free | WavelengthPlan::Both => 0,
            },
            removal: Removal::Refused {
                alternative: "a camera without a lens of real glass, or \"depth-of-field\" forbidden",
            },
        },
        EffectId::Polarisation => Effect {
            id,
            name: "polarisation",
            field: "polarisation",
            cost: "a Mueller matrix at each wavelength of each event, and 24 more bytes per stored photon",
            absent: "surfaces treat all light as unpolarised, and filters and the layer stokes are removed",
            required_by: "parts that depend on it",
            not_required: "nothing in the scene polarises light on purpose or depends on its polarisation",
            requires: |facts| facts.polarising.clone(),
            set: |plan, facts, on| plan.polarisation = PolarisationPlan::of(on, facts.stokes),
            events: |tally, _| tally.polarised_events,
            removal: Removal::FromScene(|scene, _| {
                scene.camera.filter = None;
                scene.film.layers.retain(|layer| *layer != Layer::Stokes);
                replace_surfaces(scene, Bsdf::without_filters)
            }),
        },
        EffectId::Caustics => Effect {
            id,
            name: "caustics",
            field: "caustics",
            cost: "per photon: a path through the glass, a shadow ray to the camera and a record in the map",
            absent: "photons that come from mirrors, through glass or from ray files are neither stored nor connected to the camera",
            required_by: "mirrors, glass or ray files",
            not_required: "there is no mirror, glass or ray file, or no surface or meter that could receive its light",
            requires: |facts| facts.focusing(),
            set: |plan, _, on| plan.caustics = if on { CausticPlan::Photons } else { CausticPlan::Absent },
            events: |tally, _| tally.connections + tally.ribbons,
            removal: Removal::FromPlan,
        },
        EffectId::Ribbons => Effect {
            id,
            name: "ribbons",
            field: "ribbons",
            cost: "per photon at dispersive glass: a path for each of about nine wavelengths, and the pixels between them",
            absent: "behind dispersive glass, each photon adds one wavelength at one point to the picture",
            required_by: "dispersive glass or gratings that throw light on surfaces in a picture",
            not_required: "no picture shows by a simple lens what dispersive glass or gratings throw on surfaces unpolarised",
            requires: |facts| {
                let painted = facts.receives() && facts.lens_system.is_none() && facts.meters.is_empty();
                let natural = facts.polarising.is_empty();
                if painted && natural { facts.dispersive.clone() } else { Vec::new() }
            },
            set: |plan, _, on| {
                let connects = plan.caustics != CausticPlan::Absent && plan.wavelengths != WavelengthPlan::Shared;
                plan.ribbons = on && connects && !plan.polarisation.is_on();
            },
            events: |tally, _| tally.ribbons,
            removal: Removal::FromPlan,
        },
        EffectId::Indirect => Effect {
            id,
            name: "indirect",
            field: "indirect",
            cost: "a record per stored photon, the search tree, and one query per camera path",
            absent: "photons that were scattered are not stored",
            required_by: "surfaces that scatter light",
            not_required: "no surface scatters light",
            requires: |facts| [facts.diffuse.as_slice(), &facts.glossy].concat(),
            set: |plan, _, on| plan.indirect = if on { IndirectPlan::Photons } else { IndirectPlan::Absent },
            events: |tally, _| tally.map_queries,
            removal: Removal::FromPlan,
        },
        EffectId::FinalGather => Effect {
            id,
            name: "final-gather",
            field: "indirect",
            cost: "a ray, shadow rays and a query behind each diffuse surface; the pilot chooses, unless it is forced",
            absent: "camera paths read indirect light from the photons around the first diffuse surface",
            required_by: "diffuse surfaces in a picture",
            not_required: "no picture shows a diffuse surface in clear air and natural light",
            requires: pictured_diffuse,
            set: |plan, _, on| plan.indirect = with_final_gather(plan, on),
            events: |tally, _| tally.final_gathers,
            removal: Removal::FromPlan,
        },
        EffectId::Direct => Effect {
            id,
            name: "direct",
            field: "direct",
            cost: "a shadow ray for each light, and a scattered ray if it can hit a light; above 8 lights, a shadow ray \
                   for one light that a light tree selects",
            absent: "no shadow rays are traced",
            required_by: "lights that shadow rays can reach",
            not_required: "there is no light, or no surface, medium or meter that it could light",
            requires: |facts| {
                let media = facts.dense_media.iter().chain(&facts.thin_media).next();
                if facts.receives() || media.is_some() { facts.lights.clone() } else { Vec::new() }
            },
            set: |plan, facts, on| {
                plan.direct = match (on, facts.hittable_lights.is_empty()) {
                    (false, _) => DirectPlan::Absent,
                    (true, true) => DirectPlan::ShadowRays,
                    (true, false) => DirectPlan::ShadowAndScatteredRays,
                }
            },
            events: |tally, _| tally.shadow_rays,
            removal: Removal::FromPlan,
        },
        EffectId::DepthOfField => Effect {
            id,
            name: "depth-of-field",
            field: "aperture",
            cost: "a sampled lens point for each camera ray and each connection",
            absent: "all camera rays start at the pinhole, and no lens points are sampled",
            required_by: "the camera's aperture",
            not_required: "the camera is a pinhole or orthographic",
            requires: |facts| {
                let aperture = facts.aperture_nm.map(|nm| format!("radius {:.3} mm", nm as f64 * 1e-6));
                aperture.into_iter().collect()
            },
            set: |plan, facts, on| {
                plan.aperture = match (on, &facts.lens_system) {
                    (false, _) => AperturePlan::Pinhole,
                    (true, None) => AperturePlan::ThinLens(Rim::Stops),
                    (true, Some(_)) => AperturePlan::LensSystem(Rim::Stops),
                }
            },
            events: |tally, _| tally.lens_rays,
            removal: Removal::FromScene(|scene, _| {
                scene.camera.close_aperture();
                Ok(())
            }),
        },
        EffectId::Diffraction => Effect {
            id,
            name: "diffraction",
            field: "aperture",
            cost: "three sums per pixel and one convolution of the developed picture for each slice of the spectrum",
            absent: "no slices of the spectrum are stored, and nothing is convolved",
            required_by: "diffraction at the camera's aperture",
            not_required: "the scene does not enable diffraction at the camera's aperture",
            requires: |facts| facts.diffracting.iter().cloned().collect(),
            set: |plan, _, on| {
                let rim = if on { Rim::Diffracts } else { Rim::Stops };
                plan.aperture = match plan.aperture {
                    AperturePlan::Pinhole => AperturePlan::Pinhole,
                    AperturePlan::ThinLens(_) => AperturePlan::ThinLens(rim),
                    AperturePlan::LensSystem(_) => AperturePlan::LensSystem(rim),
                };
            },
            events: |tally, plan| if plan.aperture.diffracts() { tally.lens_rays } else { 0 },
            removal: Removal::FromPlan,
        },
        EffectId::Ghosts => Effect {
            id,
            name: "ghosts",
            field: "scene.camera",
            cost: "a second camera path for each image path, which is reflected twice in the lens",
            absent: "light that a surface of the lens reflects does not reach the sensor",
            required_by: "a camera lens with ghosts",
            not_required: "the scene does not ask for ghosts of a camera lens",
            requires: |facts| facts.ghosts.iter().cloned().collect(),
            set: |_, _, _| {},
            events: |tally, _| tally.ghost_rays,
            removal: Removal::FromScene(|scene, _| {
                scene.camera.system_mut().into_iter().for_each(SystemLens::remove_ghosts);
                Ok(())
            }),
        },
        EffectId::Environment => Effect {
            id,
            name: "environment",
            field: "scene.distant_lights",
            cost: "a lookup of the lights at infinity for each ray that leaves the scene",
            absent: "rays that leave the scene carry no light",
            required_by: "lights at infinity",
            not_required: "there is no light at infinity",
            requires: |facts| facts.distant_lights.clone(),
            set: |_, _, _| {},
            events: |tally, _| tally.environment_rays,
            removal: Removal::FromScene(|scene, _| {
                scene.lights.retain(|light| !light.is_distant());
                scene.renumber_lights();
                Ok(())
            }),
        },
        EffectId::Textures => Effect {
            id,
            name: "textures",
            field: "scene.materials",
            cost: "texture coordinates and a random texel for each arrival at a textured surface; no tabulated responses \
                   to photons there",
            absent: "each material is uniform, and no texture coordinates are computed",
            required_by: "materials, normals or slides that vary over a surface",
            not_required: "no material, normal or slide varies over a surface",
            requires: |facts| facts.textured.clone(),
            set: |_, _, _| {},
            events: |tally, _| tally.texture_lookups,
            removal: Removal::FromScene(|scene, _| {
                replace_surfaces(scene, |surface| Ok(surface.without_textures()))?;
                scene.materials.iter_mut().for_each(|material| material.normal_map = None);
                scene.lights.iter_mut().for_each(Light::remove_texture_of_slide);
                Ok(())
            }),
        },
        EffectId::ThinFilms => Effect {
            id,
            name: "thin-films",
            field: "scene.materials",
            cost: "the amplitudes of all films for each arrival and wavelength at a surface with films, and for each ray \
                   through a coated lens",
            absent: "no surface has thin films, so no amplitudes are computed",
            required_by: "coatings and free-standing films",
            not_required: "no surface has thin films",
            requires: |facts| facts.films.clone(),
            set: |_, _, _| {},
            events: |tally, _| tally.film_events,
            removal: Removal::FromScene(|scene, _| {
                replace_surfaces(scene, Bsdf::without_films)?;
                scene.camera.system_mut().into_iter().for_each(SystemLens::remove_coatings);
                Ok(())
            }),
        },
        EffectId::Fluorescence => Effect {
            id,
            name: "fluorescence",
            field: "fluorescence",
            cost: "at fluorescent surfaces and in fluorescent media, four wavelengths of the excitation for each light; \
                   half of the photons of a shared set, beside which there is always a set of free photons",
            absent: "nothing is fluorescent, so light keeps its wavelength",
            required_by: "fluorescent surfaces and media",
            not_required: "no surface and no medium is fluorescent",
            requires: |facts| facts.fluorescent.clone(),
            set: |plan, facts, on| plan.fluorescence = on && !facts.fluorescent.is_empty(),
            events: |tally, _| tally.fluorescent_events,
            removal: Removal::FromScene(|scene, _| {
                replace_surfaces(scene, Bsdf::without_fluorescence)?;
                scene.media.iter_mut().for_each(|medium| medium.fluorophore = None);
                Ok(())
            }),
        },
        EffectId::Ultraviolet => Effect {
            id,
            name: "ultraviolet",
            field: "ultraviolet",
            cost: "wavelengths from 300 to 360 nm, for a share of at most one half of each light's photons",
            absent: "the simulated band begins at 360 nm",
            required_by: "fluorescent objects that absorb ultraviolet of the lights",
            not_required: "no fluorescent object absorbs light of the scene below 360 nm",
            requires: |facts| facts.ultraviolet.clone(),
            set: |plan, facts, on| plan.ultraviolet = on && plan.fluorescence && !facts.ultraviolet.is_empty(),
            events: |tally, _| tally.ultraviolet_photons,
            removal: Removal::FromPlan,
        },
        EffectId::Roughness => Effect {
            id,
            name: "roughness",
            field: "scene.materials",
            cost: "a longer camera path, with shadow rays at each rough surface",
            absent: "no camera path meets a rough surface",
            required_by: "rough or coated surfaces",
            not_required: "there is no rough or coated surface",
            requires: |facts| facts.glossy.clone(),
            set: |_, _, _| {},
            events: |tally, _| tally.rough_events,
            removal: Removal::Refused { alternative: "a scene without rough materials" },
        },
        EffectId::Bodies => Effect {
            id,
            name: "bodies",
            field: "media_plan",
            cost: "a medium stack per ray, a visibility test per face, and a count of wavelengths per path",
            absent: "every surface has air on both sides, and every photon keeps its wavelengths",
            required_by: "objects with an interior, or gratings",
            not_required: "no object has an interior: there is no glass, no liquid and no medium",
            requires: |facts| facts.bodies.clone(),
            set: |plan, _, on| plan.media_plan = if on { MediumPlan::Clear } else { MediumPlan::Air },
            events: |tally, _| tally.body_events,
            removal: Removal::Refused { alternative: "a scene of opaque objects in air" },
        },
        EffectId::Absorption => Effect {
            id,
            name: "absorption",
            field: "media_plan",
            cost: "an exponential per wavelength and path segment",
            absent: "bodies are clear",
            required_by: "absorbing glass or liquid",
            not_required: "there is no absorbing glass or liquid",
            requires: |facts| facts.absorbing_bodies.clone(),
            set: |plan, _, on| {
                if on {
                    plan.media_plan = MediumPlan::Absorbing;
                }
            },
            events: |tally, _| tally.absorptions,
            removal: Removal::FromScene(|scene, _| {
                bodies(scene).for_each(|body| body.absorption = None);
                Ok(())
            }),
        },
        EffectId::Media => Effect {
            id,
            name: "media",
            field: "media_plan",
            cost: "per segment of a camera ray: a sampled distance and a shadow ray for each light; per segment of a \
                   photon path: a sampled distance",
            absent: "no object is filled with a medium",
            required_by: "media",
            not_required: "no object is filled with a medium, and there is no atmosphere",
            requires: |facts| facts.media.clone(),
            set: |plan, _, on| {
                if on {
                    plan.media_plan = MediumPlan::Scattering(VolumeDirectLighting::ShadowRays);
                }
            },
            events: |tally, _| tally.medium_segments,
            removal: Removal::FromScene(|scene, _| {
                bodies(scene).for_each(|body| body.medium = None);
                scene.lights.retain(|light| !matches!(light.emitter, Emitter::Volume(_)));
                scene.renumber_lights();
                Ok(())
            }),
        },
        EffectId::LightMap => Effect {
            id,
            name: "light-map",
            field: "media_plan",
            cost: "per light: a shadow ray and 5 bytes for each node of a grid around each medium; per light and segment \
                   of a camera ray: 8 lookups and shadow rays",
            absent: "camera rays sample lights by shadow rays from sampled distances",
            required_by: "uniform thin fog around lights without extent, for which maps are exact, or a given resolution",
            not_required: "there is no uniform thin fog around lights without extent, or there are mirrors or glass: sampled \
                       distances are as fast, and they have no bias",
            requires: |facts| facts.light_map.clone(),
            set: |plan, _, on| {
                if let MediumPlan::Scattering(lighting) = &mut plan.media_plan {
                    *lighting = if on && !plan.direct.is_absent() {
                        VolumeDirectLighting::LightMaps
                    } else {
                        VolumeDirectLighting::ShadowRays
                    };
                }
            },
            events: |tally, _| tally.light_map_lookups,
            removal: Removal::FromPlan,
        },
        EffectId::VolumePhotons => Effect {
            id,
            name: "volume-photons",
            field: "volume",
            cost: "a record per stored scattering event, a tree of boxes, and one query per segment of a camera ray",
            absent: "no photon is stored where it scatters in a medium",
            required_by: "dense media, in which light scatters many times",
            not_required: "there is no dense medium that scatters",
            requires: |facts| facts.dense_media.clone(),
            set: |plan, _, on| plan.volume = VolumePlan::of(on, plan.volume.keeps_beams(false)),
            events: |tally, _| tally.volume_points,
            removal: Removal::FromPlan,
        },
        EffectId::PhotonBeams => Effect {
            id,
            name: "photon-beams",
            field: "volume",
            cost: "a record per segment of a photon path, a tree of boxes, and one query per segment of a camera ray",
            absent: "no segment of a photon path is stored",
            required_by: "thin media that scatter light",
            not_required: "there is no thin medium that scatters",
            requires: |facts| facts.thin_media.clone(),
            set: |plan, _, on| plan.volume = VolumePlan::of(plan.volume.keeps_points(true), on),
            events: |tally, _| tally.volume_beams,
            removal: Removal::FromPlan,
        },
        EffectId::Aim => Effect {
            id,
            name: "aim",
            field: "aim",
            cost: "some pilot photons, and a table lookup per photon",
            absent: "photons follow the emission distributions of the lights",
            required_by: "mirrors, glass, media, several lights or distant lights",
            not_required: "there is one light and nothing to aim it at, or no surface or meter that could receive its light",
            requires: |facts| if facts.receives() { facts.aimed() } else { Vec::new() },
            set: |plan, _, on| plan.aim = if on { AimPlan::Learned } else { AimPlan::Plain },
            events: |tally, _| tally.aimed,
            removal: Removal::FromPlan,
        },
        EffectId::Motion => Effect {
            id,
            name: "motion",
            field: "motion",
            cost: "a new bounding volume hierarchy per pass if objects move, a pilot at four times, and enough passes to \
                   hide the steps",
            absent: "all passes share one scene, and no times are sampled",
            required_by: "motion while the shutter is open",
            not_required: "nothing moves while the shutter is open",
            requires: |facts| facts.moving.clone(),
            set: |plan, _, on| plan.motion = if on { MotionPlan::PosedPerPass } else { MotionPlan::Still },
            events: |tally, _| tally.moments,
            removal: Removal::FromScene(|scene, _| {
                scene.stop();
                Ok(())
            }),
        },
        EffectId::Meters => Effect {
            id,
            name: "meters",
            field: "scene.meters",
            cost: "a path and a shadow ray for each light, for each sample of a receptor; no camera ray",
            absent: "the film records a picture",
            required_by: "a measurement with meters",
            not_required: "`abbe measure` reads the meters of a scene, and this is a picture",
            requires: |facts| facts.meters.clone(),
            set: |_, _, _| {},
            events: |tally, _| tally.sensor_samples,
            removal: Removal::Refused { alternative: "`abbe render`, which ignores meters" },
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_effect_has_one_row_and_one_name() {
        for (i, id) in EffectId::ALL.into_iter().enumerate() {
            assert_eq!(id.effect().id, id);
            assert!(EFFECTS[..i].iter().all(|before| before.name != id.effect().name), "{id:?}");
        }
    }
}
