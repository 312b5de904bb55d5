//! Media that glow → volume lights.

use super::lights::{Shape, finish};
use super::objects::Things;
use super::spectra::Role;
use super::{Resolver, unsupported};
use crate::error::{Error, Result};
use crate::scene::file::{JsonPath, MediumBlackbodyFile, MediumEmissionFile, MediumFile};
use crate::scene::geometry::Geometry;
use crate::scene::light::{Emitter, Light, Volume};
use crate::scene::medium::field::Field;
use crate::scene::medium::{Density, Glow, Medium};
use crate::scene::motion::MovingShape;
use crate::scene::shape::Placed;
use crate::spectrum::{Observer, Spectrum};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A body that holds a medium.
pub(super) struct Holder {
    /// The medium's number.
    medium: usize,
    /// The object's name.
    name: String,
    placed: Placed,
    moves: bool,
}

/// The bodies that hold media.
pub(super) fn holders(things: &Things<'_>) -> Vec<Holder> {
    let holder = |shape: &MovingShape| {
        let (placed, moves) = (&shape.placed, shape.motion.is_some());
        let object = &things.objects[placed.object as usize];
        let medium = things.materials[object.material].body.as_ref()?.medium?;
        Some(Holder { medium, name: object.name.clone(), placed: placed.clone(), moves })
    };
    things.shapes.iter().filter_map(holder).collect()
}

impl Resolver<'_> {
    /// The emission of a medium. A `power` is that of 1/(4π) W/m³/sr for now; [`volume_lights`](Self::volume_lights) finds the volume.
    pub(super) fn glow(
        &self,
        at: &JsonPath<'_>,
        file: &MediumEmissionFile,
        absorption: &Spectrum,
        temperature: Option<Arc<Field>>,
    ) -> Result<Glow> {
        let MediumEmissionFile { blackbody, spectrum, radiance, power } = file;
        if let Some(MediumBlackbodyFile { temperature: stated }) = blackbody {
            if let Some(kelvin) = stated {
                return Ok(Glow::same(absorption.product(&Spectrum::blackbodies(&[(*kelvin, 1.0)]))));
            }
            let missing = || Error::input("found no temperature").expected("`temperature`, or a grid that has one");
            let field = self.at(&at.key("blackbody"), temperature.ok_or_else(missing))?;
            return Ok(Glow::thermal(absorption.clone(), field));
        }
        let missing = || Error::input("found neither").expected("one of `blackbody`, `spectrum`");
        let spectrum = self.at(at, spectrum.as_ref().ok_or_else(missing))?;
        let spectrum = self.spectrum(&at.key("spectrum"), spectrum, Role::Light)?;
        let shape = spectrum.scaled(1.0 / spectrum.integral());
        Ok(Glow::same(match (radiance, power) {
            (Some(radiance), _) => absorption.product(&shape).scaled(*radiance),
            (None, Some(power)) => shape.scaled(power / (4.0 * PI)),
            (None, None) => {
                let error = Error::input("found none of the keys it needs").expected("exactly one of radiance, power");
                return self.at(at, Err(error));
            }
        }))
    }

    /// The lights of all media that glow and that something holds; media whose power is stated get their scale.
    pub(super) fn volume_lights(
        &self,
        media: &mut [Medium],
        holders: &[Holder],
        atmosphere: Option<usize>,
        (centre, observer): (DVec3, &'static Observer),
    ) -> Result<Vec<Light>> {
        let mut lights = Vec::new();
        for (number, (name, file)) in self.scene.media.iter().enumerate() {
            let (kind, emission) = match file {
                MediumFile::Homogeneous(file) => ("homogeneous", &file.emission),
                MediumFile::Grid(file) => ("grid", &file.emission),
            };
            let Some(emission) = emission else { continue };
            let root = JsonPath::Root;
            let media_at = root.key("media");
            let (name_at, medium) = (media_at.key(name), &mut media[number]);
            let kind_at = name_at.key(kind);
            let at = kind_at.key("emission");
            let held: Vec<&Holder> = holders.iter().filter(|holder| holder.medium == number).collect();
            let around = atmosphere == Some(number);
            if held.is_empty() && !around {
                continue;
            }
            if let Some(holder) = held.iter().find(|holder| holder.moves) {
                let what = format!("\"{}\" moves, and light from media that move is", holder.name);
                return self.at(&at, Err(unsupported(&what)));
            }
            if around && medium.is_uniform() {
                let error = Error::input("found on the atmosphere, which has no end")
                    .expected("a grid, or objects that hold it");
                return self.at(&at, Err(error));
            }
            let mut volumes = self.volumes(&at, medium, &held, centre)?;
            if let Some(power) = emission.power {
                let found: f64 = volumes.iter().map(|(_, volume)| volume.power_w()).sum();
                medium.emission.iter_mut().for_each(|glow| glow.scale(power / found));
                volumes = self.volumes(&at, medium, &held, centre)?;
            }
            for (name, volume) in volumes {
                let shape = Shape::new(volume.spectrum());
                let motion = volume.motion().cloned();
                let light = self.at(&at, finish(name, Emitter::Volume(Box::new(volume)), &shape, observer))?;
                lights.push(Light { motion, ..light });
            }
        }
        Ok(lights)
    }

    /// The volumes of a medium with their names: the box of a grid, or each body that holds it.
    fn volumes(
        &self,
        at: &JsonPath<'_>,
        medium: &Medium,
        held: &[&Holder],
        centre: DVec3,
    ) -> Result<Vec<(String, Volume)>> {
        let dark =
            || Error::input("found no light within 360–830 nm").expected("something that shines: matter, hot enough");
        if let Density::Field(field) = &medium.density {
            let volume = Volume::new(medium, field.from_unit(), None);
            return Ok(vec![(format!("medium {}", medium.name), self.at(at, volume.ok_or_else(dark))?)]);
        }
        held.iter()
            .map(|holder| {
                let bounds =
                    holder.placed.shape.bounds().ok_or_else(|| Error::input("found on a shape without a body"));
                let (low, high) = self.at(at, bounds)?;
                let from_unit = DAffine3::from_translation(-centre)
                    * holder.placed.to_world
                    * DAffine3::from_translation(low)
                    * DAffine3::from_scale(high - low);
                let body = self.at(at, Geometry::build(vec![holder.placed.clone()], centre))?;
                let volume = Volume::new(medium, from_unit, Some((Arc::new(body), holder.placed.volume_m3())));
                Ok((format!("{} ({})", holder.name, medium.name), self.at(at, volume.ok_or_else(dark))?))
            })
            .collect()
    }
}
