//! What a scene contains, as far as it decides which effects it calls for.

use super::camera::{Aperture, Diffraction};
use super::light::{Emitter, Light};
use super::{Object, Scene};
use crate::optics::glass::Index;
use crate::optics::surface::{Class, Surface};
use crate::spectrum::Spectrum;

/// A lamp with this share of its power in spectral lines shows of a reflectance mostly what it is at a few wavelengths.
const LINE_LAMP: f64 = 0.1;

/// Facts about a scene, each with the names that prove it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Facts {
    /// Objects of glass whose index depends on wavelength.
    pub dispersive: Vec<String>,
    /// Objects that only mirror or refract.
    pub specular: Vec<String>,
    /// Objects with rough or coated surfaces.
    pub glossy: Vec<String>,
    /// Objects that scatter diffusely.
    pub diffuse: Vec<String>,
    /// Objects with an inside: of glass or liquid, or filled with a medium.
    pub bodies: Vec<String>,
    /// Objects of absorbing glass or liquid.
    pub absorbing_bodies: Vec<String>,
    /// Objects filled with a medium, and the atmosphere.
    pub media: Vec<String>,
    /// Those of them whose medium scatters and lets little light pass.
    pub dense_media: Vec<String>,
    /// Those of them whose medium scatters and lets much light pass.
    pub thin_media: Vec<String>,
    /// What calls for maps of lamps in media.
    pub light_map: Vec<String>,
    /// Lights, all of which shadow rays can ask.
    pub lights: Vec<String>,
    /// Lights that a scattered ray can hit by itself.
    pub hittable_lights: Vec<String>,
    /// Lights at infinity that have extent.
    pub surroundings: Vec<String>,
    /// Objects and lights whose colours are smooth guesses, made from three numbers.
    pub upsampled: Vec<String>,
    /// Lights of which a good part lies in spectral lines or peaks as narrow.
    pub line_lamps: Vec<String>,
    /// The radius of the camera's opening in nm (an integer, so that facts compare), if it is not a pinhole.
    pub aperture_nm: Option<u64>,
    /// The name of the camera's lens, if it is one of real glass.
    pub lens_system: Option<String>,
    /// What the scene says of its camera's opening, if that is to diffract light.
    pub diffracting: Option<String>,
    /// Objects and lights that move while the shutter is open, and the camera.
    pub moving: Vec<String>,
}

/// The object in whose medium maps of lamps are better than shadow rays from drawn places (measured, see docs/media.md), and without any error of
/// their cells: it is a convex body of thin fog that is the same everywhere, the only medium, and holds all lamps, which are few and without extent, so that a
/// map lasts for many passes. In thicker fog, or beside mirrors and glass, the noise is that of photons, and a better look at lamps is lost in it.
fn best_mapped(scene: &Scene) -> Option<&str> {
    /// Lamps.
    const FEW: usize = 8;
    /// Mean free paths.
    const THIN: f64 = 0.5;
    let medium_of = |object: &Object| scene.materials[object.material].body.as_ref()?.medium;
    let mut filled = (0..).zip(&scene.objects).filter_map(|(number, object)| Some((number, medium_of(object)?)));
    let (Some((number, medium)), None) = (filled.next(), filled.next()) else { return None };
    let (medium, lamps) = (&scene.media[medium], &scene.lights);
    let even = medium.scatters() && medium.is_uniform() && !scene.moves();
    let convex = scene.boundaries.convex_bodies().any(|(body, _)| body == number);
    let held = |lamp: &Light| lamp.can_be_picked() && !lamp.can_be_hit() && lamp.interior.contains(number);
    let lit = (1..=FEW).contains(&lamps.len()) && lamps.iter().all(held);
    if !(even && convex && lit) {
        return None;
    }
    let (low, high) = *scene.boundaries.object_boxes().get(&number)?;
    let depth = medium.optical_depth(550.0, (high - low).min_element());
    (depth < THIN).then(|| scene.objects[number as usize].name.as_str())
}

impl Facts {
    /// Whether any surface spreads the light that falls on it.
    pub fn scatters(&self) -> bool {
        !(self.diffuse.is_empty() && self.glossy.is_empty())
    }

    /// Looks a scene over, but for the objects that nothing reaches.
    pub fn of(scene: &Scene) -> Self {
        let enclosures = scene.enclosures();
        Self::without(scene, |object| enclosures.contains_key(&object))
    }

    /// Looks over all of a scene.
    pub fn of_all(scene: &Scene) -> Self {
        Self::without(scene, |_| false)
    }

    fn without(scene: &Scene, left_out: impl Fn(u32) -> bool) -> Self {
        let mut facts = Self::default();
        for (_, object) in (0..).zip(&scene.objects).filter(|(number, _)| !left_out(*number)) {
            let material = &scene.materials[object.material];
            let mut classes: Vec<Class> = material.surface.components().map(Surface::class).collect();
            classes.dedup();
            for class in classes {
                let list = match class {
                    Class::Absorbing => continue,
                    Class::Specular => &mut facts.specular,
                    Class::Glossy => &mut facts.glossy,
                    Class::Diffuse => &mut facts.diffuse,
                };
                if list.last() != Some(&object.name) {
                    list.push(object.name.clone());
                }
            }
            let absorption = material.body.iter().filter_map(|body| body.absorption.as_ref());
            if material.surface.spectra().into_iter().chain(absorption).any(Spectrum::is_upsampled) {
                facts.upsampled.push(object.name.clone());
            }
            if let Some(body) = &material.body {
                facts.bodies.push(object.name.clone());
                if body.index.as_ref().is_some_and(Index::is_dispersive) {
                    facts.dispersive.push(object.name.clone());
                }
                if body.absorption.is_some() {
                    facts.absorbing_bodies.push(object.name.clone());
                }
                if let Some(medium) = body.medium.map(|number| &scene.media[number]) {
                    facts.media.push(object.name.clone());
                    if medium.scatters() {
                        let list = if medium.dense { &mut facts.dense_media } else { &mut facts.thin_media };
                        list.push(object.name.clone());
                    }
                }
            }
        }
        for light in &scene.lights {
            facts.lights.push(light.name.clone());
            if light.can_be_hit() {
                facts.hittable_lights.push(light.name.clone());
            }
            if light.spectrum.is_upsampled() {
                facts.upsampled.push(light.name.clone());
            }
            if light.spectrum.line_share() >= LINE_LAMP {
                facts.line_lamps.push(light.name.clone());
            }
            match &light.emitter {
                Emitter::Environment(_) | Emitter::Directional(_) => facts.surroundings.push(light.name.clone()),
                Emitter::Point(_) | Emitter::Spot(_) | Emitter::Beam(_) | Emitter::Area(_) | Emitter::Volume(_) => {}
            }
        }
        facts.aperture_nm = match scene.camera.aperture() {
            Aperture::Pinhole => None,
            Aperture::ThinLens { stop, .. } => Some((stop.radius_m * 1e9) as u64).filter(|&nm| nm > 0),
            Aperture::System(system) => Some((system.pupil_radius_m() * 1e9) as u64),
        };
        facts.diffracting = Diffraction::of(&scene.camera)
            .filter(|_| scene.camera.diffracts)
            .map(|diffraction| format!("an Airy disk of {:.2} pixels in green light", diffraction.airy_diameter_px()));
        let moving = scene.motions.shapes.iter().filter(|shape| shape.motion.is_some());
        facts.moving.extend(moving.map(|shape| scene.objects[shape.placed.object as usize].name.clone()));
        facts.moving.extend(scene.moving_lights().map(|light| light.name.clone()));
        let moving = scene.media.iter().filter(|medium| medium.motion.is_some() && medium.emission.is_none());
        facts.moving.extend(moving.map(|medium| medium.name.clone()));
        facts.moving.extend(scene.motions.camera.iter().map(|_| "the camera".to_owned()));
        let plain = facts.specular.is_empty();
        facts.light_map.extend(best_mapped(scene).filter(|_| plain).map(str::to_owned));
        facts.light_map.extend(scene.settings.light_map.map(|cells| format!("`render.light_map` of {cells} cells")));
        facts.lens_system = scene.camera.system().map(|system| system.name().to_owned());
        facts
    }
}
