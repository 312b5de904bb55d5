//! Translates the lights of the scene file to emitters in watts.

use super::objects::{EmissionSource, EmittingObject};
use super::{
    context::Resolver,
    environment_image,
    environment_image::{EnvironmentImage, ImageScale},
    motion::ResolvedMotion,
    spectra::Role,
};
use crate::light::{
    BeamFile, DirectionalFile, EnvironmentFile, IesFile, PointFile, SkyFile, SpotFalloffFile, SpotFile, SunFile,
};
use crate::{JsonPath, LightFile, QuantityFile, SpectrumFile, luminaire, luminaire::Photometry};
use abbe_scene::builder::SceneBuilder;
use abbe_scene::light::{
    AreaLight, BeamLight, DirectionalLight, Emitter, EnvironmentLight, EnvironmentPattern, GoniometricLight, Light,
    LightSpectrum, LuminousOpening, OpeningShape, PointLight, SpotFalloff, SpotLight, StandardSky, SunDirection,
    SunPosition, clear_beam_lx, mean_scale,
};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::acos;
use abbe_spectra::spectrum::{Observer, Spectrum};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

pub(super) struct LightContext<'n> {
    /// The transform from the light's frame to the world, in the scene's unit.
    pub(super) to_world: DAffine3,
    /// The scene's centre in m.
    centre: DVec3,
    pub(super) notes: &'n mut Vec<String>,
}

/// The scene to which lights are added, and the observer for whom their wavelengths are sampled.
struct LightSet<'b> {
    builder: &'b mut SceneBuilder,
    observer: &'static Observer,
}

type ResolvedEmitter = Result<Vec<(Emitter, LightSpectrum)>>;

/// A radiometric quantity, integrated over the band 360–830 nm.
pub(super) enum Radiometric {
    /// A power in W.
    Power(f64),
    /// By the kind of light: an intensity in W/sr, a radiance in W/m²/sr or an irradiance in W/m².
    FluxDensity(f64),
}

impl Radiometric {
    /// Returns the value of either variant, for a light that supports only one of them.
    pub(super) fn value(&self) -> f64 {
        match *self {
            Self::Power(value) | Self::FluxDensity(value) => value,
        }
    }
}

/// Converts a quantity of the file to a radiometric quantity.
pub(super) fn radiometric(quantity: QuantityFile, spectrum: &LightSpectrum) -> Result<Radiometric> {
    Ok(match quantity {
        QuantityFile::Power(value) => Radiometric::Power(value),
        QuantityFile::LuminousFlux(value) => Radiometric::Power(spectrum.watts_from_lumens(value)?),
        QuantityFile::Intensity(value) | QuantityFile::Radiance(value) | QuantityFile::Irradiance(value) => {
            Radiometric::FluxDensity(value)
        }
        QuantityFile::LuminousIntensity(value) | QuantityFile::Luminance(value) | QuantityFile::Illuminance(value) => {
            Radiometric::FluxDensity(spectrum.watts_from_lumens(value)?)
        }
    })
}

impl Resolver<'_> {
    /// Resolves all lights: first the list `lights`, then the emitting objects.
    pub(super) fn lights(&self, emitting: &[EmittingObject], builder: &mut SceneBuilder, observer: &'static Observer) {
        let (root, mut set) = (JsonPath::Root, LightSet { builder, observer });
        let at = root.key("lights");
        for (number, file) in self.scene.lights.iter().enumerate() {
            let at = at.index(number);
            let lights = self.lights_of(&at, number, file, &mut set);
            let add = |light| self.at(&at, set.builder.add_light(light));
            self.keep(lights.and_then(|lights| lights.into_iter().try_for_each(add)));
            if let LightFile::Sky(sky @ SkyFile { sun: Some(sun), .. }) = file {
                let light = self.sun(&at.key("sky"), number, sky, sun, &mut set);
                self.keep(light.and_then(|light| self.at(&at, set.builder.add_light(light))));
            }
        }
        let at = root.key("objects");
        for emitting in emitting {
            self.keep(self.area_lights(&at.index(emitting.file_index), emitting, &mut set));
        }
    }

    /// Resolves the lights of an emitting object: one for each part of its mesh.
    fn area_lights(&self, at: &JsonPath, emitting: &EmittingObject, set: &mut LightSet) -> Result<()> {
        let EmittingObject { file_index, objects, emission } = emitting;
        let (builder, observer) = (&mut *set.builder, set.observer);
        let emission_at = at.key("emission");
        let (spectrum, radiance, explicit, slide) = match emission {
            EmissionSource::Scene(file) => {
                let spectrum = self.light_spectrum(&emission_at, &file.spectrum, &mut builder.notes)?;
                let quantity = file.quantity().and_then(|q| radiometric(q, &spectrum));
                let area: f64 = objects.iter().map(|&object| builder.area_m2(object)).sum();
                let radiance = match self.at(&emission_at, quantity)? {
                    Radiometric::Power(power) => power / (PI * area),
                    Radiometric::FluxDensity(radiance) => radiance,
                };
                let slide = |slide| self.reflectance(&emission_at.key("slide"), slide);
                (spectrum, radiance, file.group.clone(), file.slide.as_ref().map(slide).transpose()?)
            }
            EmissionSource::Mesh(rgb, slide) => {
                let (spectrum, radiance) = self.mesh_emission(at, *rgb)?;
                (spectrum, radiance, None, slide.clone())
            }
        };
        let object_name = || self.scene.objects[*file_index].name.clone();
        let group = explicit.or_else(object_name).unwrap_or_else(|| format!("object {file_index}"));
        for &object in objects {
            let name = builder.objects().name(object).to_owned();
            let (area_m2, slide) = (builder.area_m2(object), slide.clone());
            let emitter = Emitter::Area(AreaLight { object, radiance, area_m2, slide });
            let light = Light { group: group.clone(), ..self.at(at, Light::new(name, emitter, &spectrum, observer))? };
            self.at(&emission_at, builder.add_light(light))?;
        }
        Ok(())
    }

    /// Resolves a light. A file of rays with several spectra is several lights.
    fn lights_of(&self, at: &JsonPath, number: usize, file: &LightFile, set: &mut LightSet) -> Result<Vec<Light>> {
        let (builder, observer) = (&mut *set.builder, set.observer);
        let (transform, keys, group) = file.pose_and_group();
        let ResolvedMotion { start, motion } = self.motion(transform, keys);
        let mut place = LightContext { to_world: start, centre: builder.centre(), notes: &mut builder.notes };
        let (kind, resolved) = match file {
            LightFile::Point(file) => ("point", self.point_light(&at.key("point"), file, &mut place)),
            LightFile::Spot(file) => ("spot", self.spot_light(&at.key("spot"), file, &mut place)),
            LightFile::Beam(file) => ("beam", self.beam_light(&at.key("beam"), file, &mut place)),
            LightFile::Directional(file) => ("directional", self.distant(&at.key("directional"), file, &mut place)),
            LightFile::Environment(file) => ("environment", self.environment(&at.key("environment"), file, &mut place)),
            LightFile::Sky(file) => ("sky", self.sky_light(&at.key("sky"), file, &mut place)),
            LightFile::Ies(file) => ("ies", self.luminaire(&at.key("ies"), file, &mut place)),
            LightFile::Rays(file) => ("rays", self.ray_lights(&at.key("rays"), file, &mut place)),
        };
        let (emitters, name) = (resolved?, format!("{kind} {number}"));
        let group = group.as_ref().unwrap_or(&name).to_owned();
        let several = emitters.len() > 1;
        let light = |(part, (emitter, spectrum))| {
            let name = if several { format!("{name} part {part}") } else { name.clone() };
            let light = self.at(at, Light::new(name, emitter, &spectrum, observer))?;
            Ok(Light { motion: motion.clone(), group: group.clone(), ..light })
        };
        (1..).zip(emitters).map(light).collect()
    }

    /// Resolves the spectrum of a light.
    pub(super) fn light_spectrum(
        &self,
        at: &JsonPath,
        file: &SpectrumFile,
        notes: &mut Vec<String>,
    ) -> Result<LightSpectrum> {
        let at = at.key("spectrum");
        let spectrum = self.spectrum(&at, file, Role::Light)?;
        notes.extend(self.match_note(file, &at.to_string()));
        Ok(LightSpectrum::new(&spectrum))
    }

    /// Transforms a point from the light's frame to the world, in m relative to the scene's centre.
    pub(super) fn point_of_light(&self, context: &LightContext, point: [f64; 3]) -> DVec3 {
        self.point(context.to_world.transform_point3(DVec3::from(point)).to_array(), context.centre)
    }

    fn point_light(&self, path: &JsonPath, file: &PointFile, context: &mut LightContext) -> ResolvedEmitter {
        let PointFile { at, spectrum, power: _, luminous_flux: _, .. } = file;
        let spectrum = self.light_spectrum(path, spectrum, context.notes)?;
        let intensity = match self.at(path, file.quantity().and_then(|q| radiometric(q, &spectrum)))? {
            Radiometric::Power(power) => power / (4.0 * PI),
            Radiometric::FluxDensity(intensity) => intensity,
        };
        let position = self.point_of_light(context, *at);
        Ok(vec![(Emitter::Point(PointLight { position, intensity }), spectrum)])
    }

    fn spot_light(&self, path: &JsonPath, file: &SpotFile, context: &mut LightContext) -> ResolvedEmitter {
        let SpotFile { at, to, half_angle, penumbra, spectrum, .. } = file;
        let spectrum = self.light_spectrum(path, spectrum, context.notes)?;
        let (half_angle, penumbra) = (half_angle.to_radians(), penumbra.to_radians());
        let falloff = match file.falloff {
            SpotFalloffFile::Smooth => SpotFalloff::Smooth,
            SpotFalloffFile::Linear => SpotFalloff::Linear,
            SpotFalloffFile::Square => SpotFalloff::Square,
        };
        let (at, to) = (self.point_of_light(context, *at), self.point_of_light(context, *to));
        let spot = SpotLight::new(at, (to - at).normalize(), half_angle, penumbra, 1.0).with_falloff(falloff);
        let intensity = match self.at(path, file.quantity().and_then(|q| radiometric(q, &spectrum)))? {
            Radiometric::Power(power) => power / spot.power_w(),
            Radiometric::FluxDensity(intensity) => intensity,
        };
        Ok(vec![(Emitter::Spot(spot.with_intensity(intensity)), spectrum)])
    }

    fn beam_light(&self, path: &JsonPath, file: &BeamFile, context: &mut LightContext) -> ResolvedEmitter {
        let BeamFile { from, to, radius, divergence, spectrum, .. } = file;
        let spectrum = self.light_spectrum(path, spectrum, context.notes)?;
        let power = self.at(path, file.quantity().and_then(|q| radiometric(q, &spectrum)))?.value();
        let (from, to) = (self.point_of_light(context, *from), self.point_of_light(context, *to));
        // A transform with a scale also scales the radius of the beam.
        let radius_m = radius * self.metres * mean_scale(&context.to_world);
        let beam = BeamLight::new(from, (to - from).normalize(), radius_m, divergence.to_radians(), power);
        Ok(vec![(Emitter::Beam(beam), spectrum)])
    }

    /// Resolves a luminaire with a measured distribution of intensity.
    fn luminaire(&self, path: &JsonPath, file: &IesFile, context: &mut LightContext) -> ResolvedEmitter {
        let at_path = path.key("path");
        let photometry = self.source.file(&file.path).and_then(|it| luminaire::read(&it, self.source.file_access()));
        let photometry = self.at(&at_path, photometry)?;
        let table = self.at(&at_path, photometry.table())?;
        context.notes.extend(photometry.notes.iter().map(|note| format!("{}: {note}", file.path)));
        let spectrum = match (&file.spectrum, &photometry.spectrum) {
            (Some(spectrum), _) => self.light_spectrum(path, spectrum, context.notes)?,
            (None, Some(spectrum)) => LightSpectrum::new(spectrum),
            (None, None) => {
                let expected = "the spectrum of the light, which the file does not contain";
                return Err(self.source.fault(path, "missing key \"spectrum\"", expected));
            }
        };
        let toward = DVec3::from(file.toward).normalize();
        let c0 = file.c0.map_or_else(|| GoniometricLight::default_c0(toward), DVec3::from);
        let c0 = (c0 - c0.dot(toward) * toward).normalize();
        // Without a quantity, the file sets the scale in cd, which a tilt may change.
        let axis = context.to_world.transform_vector3(toward).normalize();
        let tilt_deg = acos((-axis.y).clamp(-1.0, 1.0)).to_degrees();
        let scale = match self.at(path, file.quantity())? {
            Some(quantity) => self.at(path, radiometric(quantity, &spectrum))?.value() / table.flux(),
            None => self.at(path, spectrum.watts_from_lumens(photometry.tilt_factor(tilt_deg)))?,
        };
        let opening = if file.area {
            self.at(&path.key("area"), opening(&photometry, [toward, c0], context.notes))?
        } else {
            LuminousOpening::POINT
        };
        let light = GoniometricLight::new(DVec3::ZERO, [toward, c0], scale, Arc::new(table)).with_opening(opening);
        // A transform with a scale also scales the opening.
        let place = DAffine3 { translation: self.point_of_light(context, file.at), ..context.to_world };
        Ok(vec![(Emitter::Goniometric(light).moved(&place), spectrum)])
    }

    fn distant(&self, path: &JsonPath, file: &DirectionalFile, context: &mut LightContext) -> ResolvedEmitter {
        let DirectionalFile { toward, angular_diameter, spectrum, .. } = file;
        let spectrum = self.light_spectrum(path, spectrum, context.notes)?;
        let irradiance = self.at(path, file.quantity().and_then(|q| radiometric(q, &spectrum)))?.value();
        let toward = context.to_world.transform_vector3(DVec3::from(*toward)).normalize();
        let angular_radius = 0.5 * angular_diameter.to_radians();
        Ok(vec![(Emitter::Directional(DirectionalLight::new(toward, angular_radius, irradiance)), spectrum)])
    }

    fn environment(&self, path: &JsonPath, file: &EnvironmentFile, context: &mut LightContext) -> ResolvedEmitter {
        let EnvironmentFile { spectrum, image, projection, .. } = file;
        let (spectrum, pattern, scale) = match (spectrum, image) {
            (_, Some(image)) => {
                let at = path.key("image");
                let map = self.source.file(&image.path);
                let image = map.and_then(|path| environment_image::load(&path, *projection, context.to_world));
                let EnvironmentImage { map, scale } = self.at(&at.key("path"), image)?;
                (LightSpectrum::new(&map.mean_spectrum()), EnvironmentPattern::Image(Arc::new(map)), scale)
            }
            (Some(spectrum), None) => {
                let scale = ImageScale::Colours { mean_luminance: 1.0 };
                (self.light_spectrum(path, spectrum, context.notes)?, EnvironmentPattern::Uniform, scale)
            }
            (None, None) => return Err(self.source.fault(path, "found neither", "one of `spectrum`, `image`")),
        };
        let irradiance = match (scale, file.luminance) {
            (ImageScale::Radiance { mean_radiance }, luminance) if luminance.is_some() || !file.has_quantity() => {
                PI * mean_radiance * luminance.unwrap_or(1.0)
            }
            (ImageScale::Colours { mean_luminance }, Some(luminance)) => {
                let quantity = QuantityFile::Illuminance(PI * mean_luminance * luminance);
                self.at(path, radiometric(quantity, &spectrum))?.value()
            }
            (ImageScale::Colours { .. }, None) if !file.has_quantity() => {
                let expected = "exactly one of irradiance, illuminance, luminance";
                return Err(self.source.fault(path, "a picture without spectral channels has no scale", expected));
            }
            (ImageScale::UnknownUnit(unit), luminance) if luminance.is_some() || !file.has_quantity() => {
                let what = format!("the unit of the spectral channels is \"{unit}\"");
                let expected = "W.m^-2.sr^-1 in the attribute emissiveUnits, or the key `irradiance` or `illuminance`";
                return Err(self.source.fault(&path.key("image"), what, expected));
            }
            _ => self.at(path, file.quantity().and_then(|q| radiometric(q, &spectrum)))?.value(),
        };
        Ok(vec![(Emitter::Environment(EnvironmentLight::new(irradiance / PI, pattern)), spectrum)])
    }

    fn sky_light(&self, path: &JsonPath, file: &SkyFile, context: &mut LightContext) -> ResolvedEmitter {
        let SkyFile { kind, illuminance, ground_reflectance, spectrum, .. } = file;
        let spectrum = self.light_spectrum(path, spectrum, context.notes)?;
        let position = self.at(path, file.sun_position())?;
        let sun = position.map_or(SunDirection::ZENITH, |position| position.direction);
        let sky = StandardSky::new(*kind, sun, *ground_reflectance);
        let unknown = || Error::input(format!("found {kind}")).expected("a whole number from 1 to 16");
        let sky = self.at(&path.key("type"), sky.ok_or_else(unknown))?;
        let quantity = QuantityFile::Illuminance(illuminance / sky.horizontal_illuminance());
        let mean_radiance = self.at(path, radiometric(quantity, &spectrum))?.value();
        let pattern = EnvironmentPattern::Sky(Arc::new(sky));
        Ok(vec![(Emitter::Environment(EnvironmentLight::new(mean_radiance, pattern)), spectrum)])
    }

    /// Returns the sines of the elevations of all distant lights in the file. A faulty light, which
    /// another function reports, has none.
    pub(super) fn distant_light_sines(&self) -> Vec<f64> {
        let sine = |file: &LightFile| match file {
            LightFile::Directional(light) => {
                let start = self.motion(&light.transform, &light.motion).start;
                let toward = start.transform_vector3(DVec3::from(light.toward)).try_normalize();
                toward.map(|toward| -toward.y)
            }
            LightFile::Sky(sky) => {
                let position = sky.sun.as_ref().and_then(|_| sky.sun_position().ok().flatten());
                position.map(|SunPosition { direction, .. }| direction.to_vector().y)
            }
            LightFile::Point(_) | LightFile::Spot(_) | LightFile::Beam(_) | LightFile::Environment(_) => None,
            LightFile::Ies(_) | LightFile::Rays(_) => None,
        };
        self.scene.lights.iter().filter_map(sine).collect()
    }

    /// Resolves the sun of a sky.
    fn sun(&self, path: &JsonPath, number: usize, sky: &SkyFile, file: &SunFile, set: &mut LightSet) -> Result<Light> {
        let at = path.key("sun");
        let spectrum = self.light_spectrum(&at, &file.spectrum, &mut set.builder.notes)?;
        let unknown = || Error::input("missing key \"sun_elevation\"").expected("the elevation of the sun in degrees");
        let SunPosition { direction, distance_au } = self.at(path, sky.sun_position()?.ok_or_else(unknown))?;
        let illuminance = file.illuminance.unwrap_or_else(|| clear_beam_lx(direction.elevation, distance_au));
        let irradiance = self.at(&at, spectrum.watts_from_lumens(illuminance))?;
        let angular_radius = 0.5 * file.angular_diameter.to_radians();
        let emitter = Emitter::Directional(DirectionalLight::new(-direction.to_vector(), angular_radius, irradiance));
        let light = self.at(&at, Light::new(format!("sky {number} sun"), emitter, &spectrum, set.observer))?;
        let group = file.group.as_ref().or(sky.group.as_ref()).unwrap_or(&light.name).clone();
        Ok(Light { group, ..light })
    }

    /// Resolves a mesh file's emission in linear RGB. White, (1, 1, 1), has 1 cd/m².
    fn mesh_emission(&self, path: &JsonPath, rgb: [f64; 3]) -> Result<(LightSpectrum, f64)> {
        let spectrum = LightSpectrum::new(&self.at(path, Spectrum::rgb_light(rgb))?);
        let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        let radiance = self.at(path, spectrum.watts_from_lumens(luminance))?;
        Ok((spectrum, radiance))
    }
}

/// Returns the luminous opening. `toward` is the photometric axis, and `c0` the direction C0.
fn opening(photometry: &Photometry, [toward, c0]: [DVec3; 2], notes: &mut Vec<String>) -> Result<LuminousOpening> {
    let size = photometry.opening;
    if size.shape == OpeningShape::Point {
        let error = Error::input("the luminaire file states no luminous opening");
        return Err(error.expected("false, or a file with the size of the opening"));
    }
    if size.height_m > 0.0 {
        let name = if photometry.name.is_empty() { "a luminaire" } else { &photometry.name };
        notes.push(format!("{name}: the light leaves the flat opening; its luminous sides are left out"));
    }
    let half_sides = [0.5 * size.along_c0_m * c0, 0.5 * size.along_c90_m * c0.cross(toward)];
    Ok(LuminousOpening { shape: size.shape, half_sides })
}
