//! Lights as written → emitters in watts.

use super::motion::Way;
use super::objects::{Emission, Things};
use super::spectra::Role;
use super::{Resolver, surroundings, unsupported};
use crate::error::{Error, Result};
use crate::scene::file::{
    BeamFile, DirectionalFile, EmissionFile, EnvironmentFile, JsonPath, LightFile, PointFile, QuantityFile,
    SpectrumFile, SpotFile,
};
use crate::scene::geometry::Geometry;
use crate::scene::interior::Interior;
use crate::scene::light::{Area, Beam, Directional, Emitter, Environment, Light, Point, Spot, mean_stretch};
use crate::spectrum::{LUMENS_PER_WATT, Observer, Spectrum, WavelengthDistribution};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// What all lights are resolved against.
struct Surrounding {
    centre: DVec3,
    observer: &'static Observer,
}

/// A spectrum's shape, and how bright a watt of it is.
pub(super) struct Shape {
    spectrum: Spectrum,
    lumens_per_watt: f64,
}

impl Shape {
    /// The spectrum scaled to integral 1. Photometric quantities are always by the CIE 1931 observer's ȳ.
    pub(super) fn new(spectrum: &Spectrum) -> Self {
        let spectrum = spectrum.scaled(1.0 / spectrum.integral());
        let lumens_per_watt = LUMENS_PER_WATT * Observer::cie1931().xyz(&spectrum)[1];
        Self { spectrum, lumens_per_watt }
    }

    /// A quantity in W-based units (photometric ones divided by the luminous efficacy), and whether it is a power.
    fn watts(&self, quantity: QuantityFile) -> Result<(f64, bool)> {
        let by_eye = |value: f64| {
            if value > 0.0 && self.lumens_per_watt <= 0.0 {
                return Err(Error::input("the spectrum has no visible light")
                    .expected("a spectrum that the eye can see, or a quantity in W"));
            }
            Ok(if value > 0.0 { value / self.lumens_per_watt } else { 0.0 })
        };
        match quantity {
            QuantityFile::Power(value) => Ok((value, true)),
            QuantityFile::LuminousFlux(value) => Ok((by_eye(value)?, true)),
            QuantityFile::Intensity(value) | QuantityFile::Radiance(value) | QuantityFile::Irradiance(value) => {
                Ok((value, false))
            }
            QuantityFile::LuminousIntensity(value)
            | QuantityFile::Luminance(value)
            | QuantityFile::Illuminance(value) => Ok((by_eye(value)?, false)),
        }
    }
}

impl Resolver<'_> {
    /// Resolves all lights: those of `lights`, then emitting objects.
    pub(super) fn lights(
        &self,
        things: &Things<'_>,
        (geometry, centre): (&Geometry, DVec3),
        observer: &'static Observer,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Light>> {
        let around = Surrounding { centre, observer };
        let root = JsonPath::Root;
        let mut lights = Vec::new();
        let at = root.key("lights");
        for (number, file) in self.scene.lights.iter().enumerate() {
            lights.push(self.light(&at.index(number), (number, file), &around, notes)?);
        }
        let at = root.key("objects");
        for (number, objects, emission) in &things.emitting {
            let at = at.index(*number);
            let area: f64 = objects.iter().map(|&object| geometry.area(object)).sum();
            let (shape, radiance) = match emission {
                Emission::Stated(file) => self.emission(&at.key("emission"), file, area, notes)?,
                Emission::OfMesh(rgb) => self.mesh_emission(&at, *rgb)?,
            };
            for &object in objects {
                let name = things.objects[object as usize].name.clone();
                let emitter = Emitter::Area(Area { object, radiance, area_m2: geometry.area(object) });
                lights.push(self.at(&at, finish(name, emitter, &shape, around.observer))?);
            }
        }
        Ok(lights)
    }

    fn light(
        &self,
        at: &JsonPath<'_>,
        (number, file): (usize, &LightFile),
        around: &Surrounding,
        notes: &mut Vec<String>,
    ) -> Result<Light> {
        let (transform, keys) = file.way();
        let Way { placing, motion } = self.way(transform, keys);
        let (kind, resolved) = match file {
            LightFile::Point(file) => ("point", self.point_light(&at.key("point"), file, (&placing, around), notes)),
            LightFile::Spot(file) => ("spot", self.spot_light(&at.key("spot"), file, (&placing, around), notes)),
            LightFile::Beam(file) => ("beam", self.beam_light(&at.key("beam"), file, (&placing, around), notes)),
            LightFile::Directional(file) => {
                ("directional", self.directional_light(&at.key("directional"), file, &placing, notes))
            }
            LightFile::Environment(file) => {
                ("environment", self.environment_light(&at.key("environment"), file, &placing, notes))
            }
            LightFile::Ies(_) => ("ies", self.at(&at.key("ies"), Err(unsupported("IES lamps are")))),
        };
        let (emitter, shape) = resolved?;
        // Uniform surroundings look the same however they turn.
        let uniform = matches!(&emitter, Emitter::Environment(Environment { map: None, .. }));
        let light = self.at(at, finish(format!("{kind} {number}"), emitter, &shape, around.observer))?;
        Ok(Light { motion: motion.filter(|_| !uniform), ..light })
    }

    /// The shape of a light's spectrum.
    fn light_shape(&self, at: &JsonPath<'_>, file: &SpectrumFile, notes: &mut Vec<String>) -> Result<Shape> {
        let at = at.key("spectrum");
        let spectrum = self.spectrum(&at, file, Role::Light)?;
        notes.extend(self.match_note(file, &at.to_string()));
        Ok(Shape::new(&spectrum))
    }

    fn placed_point(&self, placing: &DAffine3, point: [f64; 3], centre: DVec3) -> DVec3 {
        self.point(placing.transform_point3(DVec3::from(point)).to_array(), centre)
    }

    fn point_light(
        &self,
        path: &JsonPath<'_>,
        file: &PointFile,
        (placing, around): (&DAffine3, &Surrounding),
        notes: &mut Vec<String>,
    ) -> Result<(Emitter, Shape)> {
        let PointFile { at, spectrum, power: _, luminous_flux: _, .. } = file;
        let shape = self.light_shape(path, spectrum, notes)?;
        let intensity = match self.at(path, file.quantity().and_then(|q| shape.watts(q)))? {
            (power, true) => power / (4.0 * PI),
            (intensity, false) => intensity,
        };
        let at = self.placed_point(placing, *at, around.centre);
        Ok((Emitter::Point(Point { at, intensity }), shape))
    }

    fn spot_light(
        &self,
        path: &JsonPath<'_>,
        file: &SpotFile,
        (placing, around): (&DAffine3, &Surrounding),
        notes: &mut Vec<String>,
    ) -> Result<(Emitter, Shape)> {
        let SpotFile { at, to, half_angle, penumbra, spectrum, .. } = file;
        let shape = self.light_shape(path, spectrum, notes)?;
        let (half_angle, penumbra) = (half_angle.to_radians(), penumbra.to_radians());
        let intensity = match self.at(path, file.quantity().and_then(|q| shape.watts(q)))? {
            (power, true) => power / Spot::power_per_intensity(half_angle, penumbra),
            (intensity, false) => intensity,
        };
        let (at, to) = (self.placed_point(placing, *at, around.centre), self.placed_point(placing, *to, around.centre));
        Ok((Emitter::Spot(Spot::new(at, (to - at).normalize(), half_angle, penumbra, intensity)), shape))
    }

    fn beam_light(
        &self,
        path: &JsonPath<'_>,
        file: &BeamFile,
        (placing, around): (&DAffine3, &Surrounding),
        notes: &mut Vec<String>,
    ) -> Result<(Emitter, Shape)> {
        let BeamFile { from, to, radius, divergence, spectrum, .. } = file;
        let shape = self.light_shape(path, spectrum, notes)?;
        let power = self.at(path, file.quantity().and_then(|q| shape.watts(q)))?.0;
        let from = self.placed_point(placing, *from, around.centre);
        let to = self.placed_point(placing, *to, around.centre);
        // A scaling transform scales the disk: by the mean of what it does to areas.
        let radius_m = radius * self.metres * mean_stretch(placing);
        let beam = Beam::new(from, (to - from).normalize(), radius_m, divergence.to_radians(), power);
        Ok((Emitter::Beam(beam), shape))
    }

    fn directional_light(
        &self,
        path: &JsonPath<'_>,
        file: &DirectionalFile,
        placing: &DAffine3,
        notes: &mut Vec<String>,
    ) -> Result<(Emitter, Shape)> {
        let DirectionalFile { toward, angular_diameter, spectrum, .. } = file;
        let shape = self.light_shape(path, spectrum, notes)?;
        let irradiance = self.at(path, file.quantity().and_then(|q| shape.watts(q)))?.0;
        let toward = placing.transform_vector3(DVec3::from(*toward)).normalize();
        let angular_radius = 0.5 * angular_diameter.to_radians();
        Ok((Emitter::Directional(Directional::new(toward, angular_radius, irradiance)), shape))
    }

    fn environment_light(
        &self,
        path: &JsonPath<'_>,
        file: &EnvironmentFile,
        placing: &DAffine3,
        notes: &mut Vec<String>,
    ) -> Result<(Emitter, Shape)> {
        let EnvironmentFile { spectrum, image, .. } = file;
        let (shape, map) = match (spectrum, image) {
            (_, Some(image)) => {
                let at = path.key("image");
                let map = self.source.file(&image.path).and_then(|path| surroundings::load(&path, *placing));
                let map = self.at(&at.key("path"), map)?;
                (Shape::new(&map.mean_spectrum()), Some(Arc::new(map)))
            }
            (Some(spectrum), None) => (self.light_shape(path, spectrum, notes)?, None),
            (None, None) => {
                return self.at(path, Err(Error::input("found neither").expected("one of `spectrum`, `image`")));
            }
        };
        let irradiance = self.at(path, file.quantity().and_then(|q| shape.watts(q)))?.0;
        Ok((Emitter::Environment(Environment::new(irradiance / PI, map)), shape))
    }

    fn emission(
        &self,
        path: &JsonPath<'_>,
        file: &EmissionFile,
        area_m2: f64,
        notes: &mut Vec<String>,
    ) -> Result<(Shape, f64)> {
        let shape = self.light_shape(path, &file.spectrum, notes)?;
        let radiance = match self.at(path, file.quantity().and_then(|q| shape.watts(q)))? {
            (power, true) => power / (PI * area_m2),
            (radiance, false) => radiance,
        };
        Ok((shape, radiance))
    }

    /// Emission of a mesh file: linear RGB, white being 1 cd/m².
    fn mesh_emission(&self, path: &JsonPath<'_>, rgb: [f64; 3]) -> Result<(Shape, f64)> {
        let shape = Shape::new(&self.at(path, Spectrum::rgb_light(rgb))?);
        let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        let radiance = self.at(path, shape.watts(QuantityFile::Luminance(luminance)))?.0;
        Ok((shape, radiance))
    }
}

/// A light from its parts.
pub(super) fn finish(name: String, emitter: Emitter, shape: &Shape, observer: &'static Observer) -> Result<Light> {
    let wavelengths = WavelengthDistribution::important(&shape.spectrum, observer)
        .ok_or_else(|| Error::input("the spectrum has no power within 360–830 nm"))?;
    let importance_per_watt = observer.xyz(&shape.spectrum).iter().sum();
    let spectrum = shape.spectrum.clone();
    Ok(Light { name, emitter, spectrum, wavelengths, importance_per_watt, interior: Interior::AIR, motion: None })
}
