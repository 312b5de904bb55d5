//! Facts about a scene, from which the plan decides which effects are simulated.

use super::camera::{Aperture, ApertureDiffraction};
use super::light::Light;
use super::{Layer, Object, Scene};
use abbe_optics::bsdf::{Bsdf, BsdfClass};
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::texture::SurfaceSpectrum;
use abbe_spectra::spectrum::Spectrum;

/// A light counts as a line light if at least this fraction of its power is in spectral lines, so
/// that the light that a surface reflects depends strongly on the reflectance at a few wavelengths.
const LINE_FRACTION: f64 = 0.1;

/// The facts that decide which effects a scene needs. Most facts are lists: the names of the parts
/// of the scene that make the fact true. An empty list means false.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Facts {
    /// Objects whose refractive index depends on wavelength, and gratings.
    pub dispersive: Vec<String>,
    /// Objects with a specular component, which reflects or refracts light into one direction.
    pub specular: Vec<String>,
    /// Objects with a glossy component: rough or coated surfaces.
    pub glossy: Vec<String>,
    pub textured: Vec<String>,
    /// Objects with thin films, and a coated lens of the camera.
    pub films: Vec<String>,
    /// Objects with a fluorescent surface or a fluorescent medium.
    pub fluorescent: Vec<String>,
    /// Fluorescent objects that absorb light of the scene below the band.
    pub ultraviolet: Vec<String>,
    pub diffuse: Vec<String>,
    /// Objects with a body of glass, liquid or a medium, and gratings, behind which paths keep a
    /// single wavelength.
    pub bodies: Vec<String>,
    /// Objects with a body that has an absorption coefficient.
    pub absorbing_bodies: Vec<String>,
    /// Objects filled with a medium, including the atmosphere.
    pub media: Vec<String>,
    /// Objects filled with a dense medium, in which light scatters more than a few times.
    pub dense_media: Vec<String>,
    /// Objects filled with a scattering medium that is not dense.
    pub thin_media: Vec<String>,
    /// The object or the setting that requires light maps of media.
    pub light_map: Vec<String>,
    pub lights: Vec<String>,
    /// Lights that a scattered ray can hit by chance: all lights that are not delta lights.
    pub hittable_lights: Vec<String>,
    pub distant_lights: Vec<String>,
    /// Lights that only photons carry.
    pub ray_sets: Vec<String>,
    /// Objects and lights with spectra that were reconstructed from RGB.
    pub upsampled: Vec<String>,
    /// Lights with at least `LINE_FRACTION` of their power in spectral lines.
    pub line_lights: Vec<String>,
    /// The radius of the camera's aperture in nm (an integer for `Eq`), or `None` for a pinhole.
    pub aperture_nm: Option<u64>,
    pub lens_system: Option<String>,
    /// The name of the camera's lens system if it has ghosts.
    pub ghosts: Option<String>,
    /// The size of the diffraction pattern. `None` for a pinhole, or if diffraction is not enabled.
    pub diffracting: Option<String>,
    pub meters: Vec<String>,
    /// Objects and settings that depend on the polarisation of light: filters and layers. The plan
    /// adds chains of surfaces whose error without polarisation is too large.
    pub polarising: Vec<String>,
    /// True if the film records the Stokes vector of the light.
    pub stokes: bool,
    /// Everything that moves while the shutter is open: objects, lights, media and the camera.
    pub moving: Vec<String>,
}

/// Returns the object whose medium renders better with light maps than with shadow rays from
/// sampled points: the maps have less noise there, and no interpolation error. By measurements,
/// this is a convex body of thin, uniform fog, which is the only medium and contains all lights, if
/// these are few and without extent, so that many passes can use the same light map. In other fog
/// or with specular surfaces, photon noise dominates.
fn object_with_light_maps(scene: &Scene) -> Option<&str> {
    const MAX_LIGHTS: usize = 8;
    /// An optical depth.
    const THIN: f64 = 0.5;
    let medium_of = |object: &Object| scene.materials[object.material].body.as_ref()?.medium;
    let mut filled = (0..).zip(&scene.objects).filter_map(|(number, object)| Some((number, medium_of(object)?)));
    let (Some((number, medium)), None) = (filled.next(), filled.next()) else { return None };
    let (medium, lights) = (&scene.media[medium], &scene.lights);
    let uniform = medium.scatters() && medium.is_uniform() && !scene.moves();
    let convex = scene.boundaries.convex_bodies().any(|body| body.object == number);
    let inside = |light: &Light| light.has_virtual_lights() && light.is_delta() && light.medium_stack.contains(number);
    let lit = (1..=MAX_LIGHTS).contains(&lights.len()) && lights.iter().all(inside);
    if !(uniform && convex && lit) {
        return None;
    }
    let (low, high) = *scene.boundaries.object_bounds().get(&number)?;
    let depth = medium.optical_depth(550.0, (high - low).min_element());
    (depth < THIN).then(|| scene.objects[number as usize].name.as_str())
}

impl Facts {
    pub fn scatters(&self) -> bool {
        !(self.diffuse.is_empty() && self.glossy.is_empty())
    }

    /// Returns true if a surface scatters light or a meter receives it.
    pub fn receives(&self) -> bool {
        self.scatters() || !self.meters.is_empty()
    }

    /// Returns what throws light on surfaces or meters that their shadow rays do not find.
    pub fn focusing(&self) -> Vec<String> {
        if self.receives() { [&self.specular[..], &self.ray_sets].concat() } else { Vec::new() }
    }

    /// Returns what photons are aimed at or divided among: objects that focus light, media, and the
    /// lights themselves if there are several or if they are distant.
    pub fn aimed(&self) -> Vec<String> {
        let lights = if self.lights.len() > 1 { &self.lights } else { &self.distant_lights };
        [&self.specular, &self.glossy, &self.media, lights].into_iter().flatten().cloned().collect()
    }

    /// Collects the facts about a scene without the objects that no light can reach.
    pub fn of(scene: &Scene) -> Self {
        let enclosures = scene.enclosures();
        Self::without(scene, |object| enclosures.contains_key(&object))
    }

    /// Collects the facts about a scene with the objects that no light can reach.
    pub fn of_all(scene: &Scene) -> Self {
        Self::without(scene, |_| false)
    }

    fn without(scene: &Scene, left_out: impl Fn(u32) -> bool) -> Self {
        let mut facts = Self::default();
        for (_, object) in (0..).zip(&scene.objects).filter(|(number, _)| !left_out(*number)) {
            let material = &scene.materials[object.material];
            let mut classes: Vec<BsdfClass> = material.surface.components().map(Bsdf::class).collect();
            classes.dedup();
            for class in classes {
                let list = match class {
                    BsdfClass::Absorbing => continue,
                    BsdfClass::Specular => &mut facts.specular,
                    BsdfClass::Glossy => &mut facts.glossy,
                    BsdfClass::Diffuse => &mut facts.diffuse,
                };
                if list.last() != Some(&object.name) {
                    list.push(object.name.clone());
                }
            }
            let note = |list: &mut Vec<String>, holds: bool| list.extend(holds.then(|| object.name.clone()));
            note(&mut facts.films, material.surface.components().any(|part| part.films().is_some()));
            note(&mut facts.fluorescent, material.surface.fluorescent().next().is_some());
            let mut surfaces = material.surface.fluorescent();
            note(&mut facts.ultraviolet, surfaces.any(|surface| ultraviolet_excites(scene, &surface.fluorophore)));
            let is_grating = material.surface.components().any(|part| part.grating().is_some());
            note(&mut facts.dispersive, is_grating);
            note(&mut facts.bodies, is_grating);
            let crystal = material.surface.crystal();
            note(&mut facts.polarising, crystal.is_some() || material.surface.filters().next().is_some());
            note(&mut facts.textured, material.is_textured());
            let absorption = material.body.as_ref().and_then(|body| body.absorption.as_ref());
            let is_upsampled = material.surface.is_upsampled() || absorption.is_some_and(Spectrum::is_upsampled);
            note(&mut facts.upsampled, is_upsampled);
            let Some(body) = &material.body else { continue };
            note(&mut facts.bodies, true);
            let extraordinary = crystal.map(|crystal| &crystal.extraordinary);
            note(&mut facts.dispersive, body.index.iter().chain(extraordinary).any(RefractiveIndex::is_dispersive));
            note(&mut facts.absorbing_bodies, body.absorption.is_some());
            let Some(medium) = body.medium.map(|number| &scene.media[number]) else { continue };
            note(&mut facts.media, true);
            let dye = medium.fluorophore.as_deref();
            note(&mut facts.fluorescent, dye.is_some());
            note(&mut facts.ultraviolet, dye.is_some_and(|dye| ultraviolet_excites(scene, dye)));
            note(&mut facts.dense_media, medium.scatters() && medium.dense);
            note(&mut facts.thin_media, medium.scatters() && !medium.dense);
        }
        for light in &scene.lights {
            let note = |list: &mut Vec<String>, holds: bool| list.extend(holds.then(|| light.name.clone()));
            note(&mut facts.lights, true);
            note(&mut facts.hittable_lights, !light.is_delta());
            note(&mut facts.textured, light.slide().is_some_and(SurfaceSpectrum::is_textured));
            let is_upsampled =
                light.spectrum.is_upsampled() || light.slide().is_some_and(SurfaceSpectrum::is_upsampled);
            note(&mut facts.upsampled, is_upsampled);
            note(&mut facts.line_lights, light.spectrum.line_fraction() >= LINE_FRACTION);
            note(&mut facts.distant_lights, light.is_distant());
            note(&mut facts.ray_sets, light.is_ray_set());
        }
        facts.aperture_nm = match scene.camera.aperture() {
            Aperture::Pinhole | Aperture::Orthographic => None,
            Aperture::ThinLens { stop, .. } => Some((stop.radius_m * 1e9) as u64).filter(|&nm| nm > 0),
            Aperture::System(system) => Some((system.pupil_radius_m() * 1e9) as u64),
        };
        facts.diffracting = ApertureDiffraction::of(&scene.camera)
            .filter(|_| scene.camera.diffracts)
            .map(|diffraction| format!("an Airy disk of {:.2} pixels in green light", diffraction.airy_diameter_px()));
        facts.polarising.extend(scene.camera.filter.iter().map(|_| "the camera's filter".to_owned()));
        facts.stokes = scene.film.layers.contains(&Layer::Stokes);
        facts.polarising.extend(facts.stokes.then(|| "the layer stokes".to_owned()));
        facts.meters = scene.meters.iter().map(|meter| meter.name.clone()).collect();
        let moving = scene.motions.shapes.iter().filter(|shape| shape.motion.is_some());
        facts.moving.extend(moving.map(|shape| scene.objects[shape.placed.object as usize].name.clone()));
        facts.moving.extend(scene.moving_lights().map(|light| light.name.clone()));
        let moving = scene.media.iter().filter(|medium| medium.motion.is_some() && medium.emission.is_none());
        facts.moving.extend(moving.map(|medium| medium.name.clone()));
        facts.moving.extend(scene.motions.camera.iter().map(|_| "the camera".to_owned()));
        let no_specular = facts.specular.is_empty();
        facts.light_map.extend(object_with_light_maps(scene).filter(|_| no_specular).map(str::to_owned));
        facts.light_map.extend(scene.settings.light_map.map(|cells| format!("`render.light_map` of {cells} cells")));
        let lens = scene.camera.system();
        facts.lens_system = lens.map(|system| system.name().to_owned());
        facts.ghosts = lens.filter(|system| system.has_ghosts()).map(|system| system.name().to_owned());
        facts.films.extend(lens.filter(|system| system.is_coated()).map(|_| "the camera's lens".to_owned()));
        facts
    }
}

/// Returns true if a light of the scene has power below the band where a fluorophore absorbs.
fn ultraviolet_excites(scene: &Scene, fluorophore: &Fluorophore) -> bool {
    scene.lights.iter().any(|light| fluorophore.absorbed_ultraviolet(&light.spectrum) > 0.0)
}
