//! The volume lights of emitting media.

use super::builder::{EmittingMedium, SceneBuilder, SceneError, ScenePart};
use super::light::{Emitter, Light, LightSpectrum, VolumeLight};
use super::medium::{Density, Medium, MediumEmission};
use super::motion::AnimatedShape;
use crate::geometry::shape::PlacedShape;
use crate::geometry::{Geometry, Ray};
use abbe_optics::glass::RefractiveIndex;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{BAND_NM, Observer, Outside, Spectrum};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

struct MediumContainer {
    medium: usize,
    name: String,
    /// `None` for air.
    index: Option<RefractiveIndex>,
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
            let lights = check(medium, &containers, in_atmosphere).and_then(|()| {
                medium.emission = medium.emission.as_ref().map(|emission| in_containers(emission, &containers));
                lights(medium, *power_w, &containers, self.centre, observer)
            });
            self.lights.extend(lights.map_err(|error| ScenePart::MediumEmission(number).error(error))?);
        }
        Ok(())
    }

    fn containers(&self) -> Vec<MediumContainer> {
        let container = |shape: &AnimatedShape| {
            let (placed, moves) = (&shape.placed, shape.motion.is_some());
            let body = self.objects.material_of(placed.object).body.as_ref()?;
            let medium = body.medium?;
            let index = body.index.clone().or_else(|| self.index_around(placed));
            let name = self.objects.name(placed.object).to_owned();
            Some(MediumContainer { medium, name, index, placed: placed.clone(), moves })
        };
        self.objects.shapes.iter().filter_map(container).collect()
    }

    /// Returns the index at the middle of a shape that only bounds a medium: that of the smallest
    /// body of the highest priority around it. `None` for air.
    fn index_around(&self, placed: &PlacedShape) -> Option<RefractiveIndex> {
        let (low, high) = placed.shape.bounds()?;
        let middle = placed.to_world.transform_point3(0.5 * (low + high)) - self.centre;
        let ray = Ray::new(middle, DVec3::new(0.39, 0.80, 0.45));
        let mut balances = BTreeMap::<u32, i32>::new();
        self.geometry.for_each_hit(&ray, None, |hit| {
            *balances.entry(hit.object).or_default() += if hit.normal.dot(ray.direction) > 0.0 { 1 } else { -1 };
        });
        let boxes = self.geometry.object_bounds();
        let around = balances.into_iter().filter(|(_, balance)| *balance > 0).filter_map(|(object, _)| {
            let body = self.objects.material_of(object).body.as_ref()?;
            let (low, high) = boxes.get(&object)?;
            Some((body.priority, -(*high - *low).element_product(), body.index.as_ref()?))
        });
        let dominant = around.max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        dominant.map(|(_, _, index)| index.clone())
    }
}

/// Returns the emission in bodies of one refractive index, or in air.
fn in_containers(emission: &MediumEmission, containers: &[&MediumContainer]) -> MediumEmission {
    let Some(index) = containers.first().and_then(|container| container.index.as_ref()) else {
        return emission.clone();
    };
    let nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let squares: Vec<f64> = nm.iter().map(|&nm| index.n(nm) * index.n(nm)).collect();
    let squared = Spectrum::table(&nm, &squares, Outside::Hold).expect("the wavelengths ascend");
    emission.in_index(&squared)
}

/// Checks that the emission of a medium can be simulated.
fn check(medium: &Medium, containers: &[&MediumContainer], in_atmosphere: bool) -> Result<()> {
    if let Some(container) = containers.iter().find(|container| container.moves) {
        let name = &container.name;
        return Err(Error::input(format!("\"{name}\" moves, and light from media that move is not supported yet")));
    }
    let mut pairs = containers.array_windows();
    if let Some([container, _]) = pairs.find(|[one, other]| one.placed.object == other.placed.object) {
        let what = format!("\"{}\" has shells that touch or overlap, and light from media in them", container.name);
        return Err(Error::input(format!("{what} is not supported")).expected("the union of the shells, as one shell"));
    }
    let is_thermal = medium.emission.as_ref().is_some_and(MediumEmission::is_thermal);
    if let Some([one, other]) = containers.array_windows().find(|[one, other]| is_thermal && one.index != other.index) {
        let found = format!("found in \"{}\" and \"{}\", whose refractive indices differ", one.name, other.name);
        return Err(
            Error::input(found).expected("a medium of its own for each, because the glow of a body grows with n²")
        );
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
