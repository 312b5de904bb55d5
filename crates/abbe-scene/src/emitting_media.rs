//! The volume lights of emitting media.

use super::builder::{EmittingMedium, SceneBuilder, SceneError, ScenePart};
use super::light::{Emitter, Light, LightSpectrum, VolumeLight};
use super::medium::{Density, Medium};
use super::motion::AnimatedShape;
use crate::geometry::Geometry;
use crate::geometry::shape::PlacedShape;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::Observer;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

struct MediumContainer {
    medium: usize,
    name: String,
    placed: PlacedShape,
    moves: bool,
}

type NamedVolume = (String, VolumeLight);

impl SceneBuilder {
    /// Adds the lights of all emitting media that fill bodies or the atmosphere, scaled to the
    /// power that the scene gives, if any.
    pub(super) fn add_volume_lights(&mut self, observer: &'static Observer) -> std::result::Result<(), SceneError> {
        let containers = self.containers();
        for (number, EmittingMedium { medium, power_w }) in self.media.iter_mut().enumerate() {
            let containers: Vec<_> = containers.iter().filter(|container| container.medium == number).collect();
            let in_atmosphere = self.atmosphere == Some(number);
            if medium.emission.is_none() || (containers.is_empty() && !in_atmosphere) {
                continue;
            }
            let lights = check(medium, &containers, in_atmosphere)
                .and_then(|()| lights(medium, *power_w, &containers, self.centre, observer));
            self.lights.extend(lights.map_err(|error| ScenePart::MediumEmission(number).error(error))?);
        }
        Ok(())
    }

    fn containers(&self) -> Vec<MediumContainer> {
        let container = |shape: &AnimatedShape| {
            let (placed, moves) = (&shape.placed, shape.motion.is_some());
            let medium = self.objects.material_of(placed.object).body.as_ref()?.medium?;
            let name = self.objects.name(placed.object).to_owned();
            Some(MediumContainer { medium, name, placed: placed.clone(), moves })
        };
        self.objects.shapes.iter().filter_map(container).collect()
    }
}

/// Checks that the emission of a medium can be simulated.
fn check(medium: &Medium, containers: &[&MediumContainer], in_atmosphere: bool) -> Result<()> {
    if let Some(container) = containers.iter().find(|container| container.moves) {
        let name = &container.name;
        return Err(Error::input(format!("\"{name}\" moves, and light from media that move is not supported yet")));
    }
    if in_atmosphere && medium.is_uniform() {
        return Err(Error::input("found on the atmosphere, which is unbounded")
            .expected("a grid, or objects that contain the medium"));
    }
    Ok(())
}

/// The lights of a medium, which together emit `power_w` if it is given.
fn lights(
    medium: &mut Medium,
    power_w: Option<f64>,
    containers: &[&MediumContainer],
    centre: DVec3,
    observer: &'static Observer,
) -> Result<Vec<Light>> {
    let mut volumes = volumes(medium, containers, centre)?;
    if let Some(power_w) = power_w {
        let found: f64 = volumes.iter().map(|(_, volume)| volume.power_w()).sum();
        medium.emission.iter_mut().for_each(|emission| emission.scale(power_w / found));
        volumes = self::volumes(medium, containers, centre)?;
    }
    let light = |(name, volume): NamedVolume| {
        let spectrum = LightSpectrum::new(volume.spectrum());
        let motion = volume.motion().cloned();
        let light = Light::new(name, Emitter::Volume(Box::new(volume)), &spectrum, observer)?;
        // A path that sees the emission of a medium does not know the body: one group for all.
        Ok(Light { motion, group: format!("medium {}", medium.name), ..light })
    };
    volumes.into_iter().map(light).collect()
}

/// The volumes that a medium fills: the box of its density field, or each body with it.
fn volumes(medium: &Medium, containers: &[&MediumContainer], centre: DVec3) -> Result<Vec<NamedVolume>> {
    let dark =
        || Error::input("found no light within 360–830 nm").expected("a medium that is hot enough and absorbs light");
    if let Density::Field(field) = &medium.density {
        let volume = VolumeLight::new(medium, field.from_unit(), None);
        return Ok(vec![(format!("medium {}", medium.name), volume.ok_or_else(dark)?)]);
    }
    let volume_of = |container: &&MediumContainer| {
        let bounds = container.placed.shape.bounds();
        let (low, high) = bounds.ok_or_else(|| Error::input("found on a shape that encloses no space"))?;
        let from_unit = DAffine3::from_translation(-centre)
            * container.placed.to_world
            * DAffine3::from_translation(low)
            * DAffine3::from_scale(high - low);
        let body = Geometry::build(vec![container.placed.clone()], centre)?;
        let volume = VolumeLight::new(medium, from_unit, Some((Arc::new(body), container.placed.volume_m3())));
        Ok((format!("{} ({})", container.name, medium.name), volume.ok_or_else(dark)?))
    };
    containers.iter().map(volume_of).collect()
}
