//! Light sources: the light that they emit, and the light that reaches a point from them.
//!
//! Tests check the contract of each kind of light: the mean flux of [`Light::sample_le`] equals
//! [`Light::power_w`], which uses no random numbers, and at each point the irradiance from
//! [`Light::sample_li`] equals that from the emitted rays.
//!
//! Only this file, `bounded_light.rs` and `luminous_surface.rs` match on the variants of
//! [`Emitter`]. All other code calls the methods of [`Light`].

mod area;
mod beam;
mod bounded_light;
mod directional;
mod environment;
mod environment_bands;
mod environment_map;
mod goniometric;
mod intensity_bounds;
mod intensity_table;
mod lit_interval;
mod luminous_surface;
mod point;
mod ray_set;
mod sample;
mod sky;
mod spectrum;
mod sun;
mod ultraviolet;
mod virtual_light;
mod volume;

#[cfg(test)]
mod contract_tests;

pub use area::AreaLight;
pub use beam::{BeamLight, mean_scale};
pub use directional::DirectionalLight;
pub use environment::{EnvironmentLight, EnvironmentPattern};
pub use environment_bands::EnvironmentBands;
pub use environment_map::EnvironmentMap;
pub use goniometric::{GoniometricLight, LuminousOpening, OpeningShape};
pub use intensity_bounds::IntensityBounds;
pub use intensity_table::{IntensityTable, PhotometricType};
pub use lit_interval::LitInterval;
pub use point::{PointLight, SpotFalloff, SpotLight};
pub use ray_set::{EmittedRay, RaySet, RaySetLight};
pub use sample::{EmittedSpd, LeRandoms, LeSample, LiSample, RepresentativePoint, SceneExtent};
pub use sky::{StandardSky, SunDirection};
pub use spectrum::LightSpectrum;
pub use sun::{GeographicPlace, SunPosition, clear_beam_lx};
pub use virtual_light::{LightConnection, VirtualLight};
pub use volume::VolumeLight;

use super::medium_stack::MediumStack;
use super::motion::{AnimatedTransform, DecomposedTransform};
use crate::geometry::{Geometry, Hit, Ray};
use abbe_optics::texture::SurfaceSpectrum;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::spectrum::{Observer, Spectrum, WavelengthDistribution};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

#[derive(Debug, Clone)]
pub struct Light {
    pub name: String,
    /// Lights of a group share a layer of the picture.
    pub group: String,
    /// The kind of light, with its position and radiometric quantity at the shutter's opening.
    pub emitter: Emitter,
    /// The relative spectral power distribution: a density per nm with integral 1 over the band.
    pub spectrum: Spectrum,
    /// Samples photon wavelengths in proportion to the spectrum times the visual importance.
    pub wavelengths: WavelengthDistribution,
    /// The same with the ultraviolet that excites fluorophores, if the scene needs it.
    pub ultraviolet: Option<Box<WavelengthDistribution>>,
    /// The visual importance of one watt, ∫ S(λ)(x̄+ȳ+z̄)(λ) dλ, plus that excited by ultraviolet.
    pub importance_per_watt: f64,
    /// The bodies that contain the light, or one of its points if it crosses bodies.
    pub medium_stack: MediumStack,
    /// True if the bodies may differ from point to point of the light, as for a panel partly in
    /// fog.
    pub crosses_bodies: bool,
    /// The light's own motion (in m); an area light has none, because its object moves.
    pub motion: Option<AnimatedTransform>,
}

/// The kinds of lights. All quantities are integrals over the band 360–830 nm.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A point with the same intensity in all directions.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(SpotLight),
    /// A luminaire with a measured distribution of intensity.
    Goniometric(GoniometricLight),
    /// A disk of parallel or divergent light.
    Beam(BeamLight),
    /// The rays of a file.
    Rays(RaySetLight),
    /// Distant light from one direction or from a disk in the sky.
    Directional(DirectionalLight),
    /// Distant light from all directions.
    Environment(EnvironmentLight),
    /// The surface of an object.
    Area(AreaLight),
    /// A medium that emits light.
    Volume(Box<VolumeLight>),
}

impl Emitter {
    /// Returns the emitter transformed by a map of world positions, whose mean scale multiplies the
    /// radius of a beam. An environment only rotates, and an area light moves with its object.
    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        match self {
            Self::Point(light) => Self::Point(light.moved(map)),
            Self::Spot(light) => Self::Spot(light.moved(map)),
            Self::Goniometric(light) => Self::Goniometric(light.moved(map)),
            Self::Beam(light) => Self::Beam(light.moved(map)),
            Self::Rays(light) => Self::Rays(light.moved(map)),
            Self::Directional(light) => Self::Directional(light.moved(map)),
            Self::Environment(light) => Self::Environment(light.rotated(DecomposedTransform::of(map).rotation)),
            Self::Area(_) => self.clone(),
            Self::Volume(light) => Self::Volume(Box::new(light.moved(map))),
        }
    }
}

/// The local lights of the contract tests, at `at` and shining along `axis`.
#[cfg(test)]
fn local_test_lights(at: DVec3, axis: DVec3) -> Vec<contract_tests::TestLight> {
    [point::test_lights(at, axis), beam::test_lights(at, axis), goniometric::test_lights(at, axis)].concat()
}

impl Light {
    /// Creates a light at rest, or returns an error if the spectrum has no power in the band.
    /// Photon wavelengths follow the spectrum times the visual importance for the film's observer.
    pub fn new(name: String, emitter: Emitter, spectrum: &LightSpectrum, observer: &'static Observer) -> Result<Self> {
        let spectrum = spectrum.normalised();
        let wavelengths = WavelengthDistribution::visually_weighted(spectrum, observer)
            .ok_or_else(|| Error::input("the spectrum has no power within 360–830 nm"))?;
        let importance_per_watt = observer.xyz(spectrum).iter().sum();
        Ok(Self {
            group: name.clone(),
            name,
            emitter,
            spectrum: spectrum.clone(),
            wavelengths,
            ultraviolet: None,
            importance_per_watt,
            medium_stack: MediumStack::AIR,
            crosses_bodies: false,
            motion: None,
        })
    }

    /// The emitted power in W over the band; a distant light's enters the bounding sphere.
    pub fn power_w(&self, extent: SceneExtent<'_>) -> f64 {
        match &self.emitter {
            Emitter::Point(light) => light.power_w(),
            Emitter::Spot(light) => light.power_w(),
            Emitter::Goniometric(light) => light.power_w(),
            Emitter::Beam(light) => light.power_w,
            Emitter::Rays(light) => light.power_w,
            Emitter::Directional(light) => light.power_w(extent.radius_m),
            Emitter::Environment(light) => light.power_w(extent.radius_m),
            Emitter::Area(light) => light.power_w(),
            Emitter::Volume(light) => light.power_w(),
        }
    }

    pub fn sample_le(&self, extent: SceneExtent<'_>, u: LeRandoms) -> LeSample {
        match &self.emitter {
            Emitter::Point(light) => light.sample_le(u),
            Emitter::Spot(light) => light.sample_le(u),
            Emitter::Goniometric(light) => light.sample_le(u),
            Emitter::Beam(light) => light.sample_le(u),
            Emitter::Rays(light) => light.sample_le(u),
            Emitter::Directional(light) => light.sample_le(extent.radius_m, u),
            Emitter::Environment(light) => light.sample_le(extent.radius_m, u),
            Emitter::Area(light) => light.sample_le(extent.geometry, u),
            Emitter::Volume(light) => light.sample_le(u),
        }
    }

    /// Samples an emitted ray that passes through a sphere. `u.aim` covers only the rays through
    /// the sphere, so the mean flux is the power that the light sends through it.
    pub fn sample_le_through(&self, extent: SceneExtent<'_>, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let sample = match &self.emitter {
            Emitter::Point(light) => light.sample_le_through(sphere, u),
            Emitter::Spot(light) => light.sample_le_through(sphere, u),
            Emitter::Goniometric(light) => light.sample_le_through(sphere, u),
            Emitter::Beam(light) => light.sample_le_through(sphere, u),
            Emitter::Rays(light) => light.sample_le(u),
            Emitter::Directional(light) => light.sample_le_through(extent.radius_m, sphere, u),
            Emitter::Environment(light) => light.sample_le_through(extent.radius_m, sphere, u),
            Emitter::Area(light) => light.sample_le_through(extent.geometry, sphere, u),
            Emitter::Volume(light) => light.sample_le_through(sphere, u),
        };
        if sphere.contains_part_of(sample.origin, sample.direction) { sample } else { sample.dark() }
    }

    /// Samples a direction from the point `from` towards the light. Returns `None` if no light
    /// arrives along it. The caller must test whether a surface blocks the light.
    pub fn sample_li(&self, extent: SceneExtent<'_>, from: DVec3, u: [f64; 3]) -> Option<LiSample> {
        match &self.emitter {
            Emitter::Point(light) => light.sample_li(from),
            Emitter::Spot(light) => light.sample_li(from),
            Emitter::Goniometric(light) => light.sample_li(from, u),
            Emitter::Beam(light) => light.sample_li(from, u),
            Emitter::Rays(_) => None,
            Emitter::Directional(light) => Some(light.sample_li(u)),
            Emitter::Environment(light) => light.sample_li(u),
            Emitter::Area(light) => light.sample_li(extent.geometry, from, u),
            Emitter::Volume(light) => light.sample_li(from, u),
        }
    }

    /// The radiance (W/m²/sr over the band) and the spectrum that a ray sees if it leaves the scene
    /// along `direction`. `None` for local lights, and beside a directional light.
    pub fn le(&self, direction: DVec3) -> Option<(f64, EmittedSpd)> {
        match &self.emitter {
            Emitter::Directional(light) => light.le(direction).map(|radiance| (radiance, EmittedSpd::Own)),
            Emitter::Environment(light) => Some(light.le(direction)),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Goniometric(_) | Emitter::Beam(_) => None,
            Emitter::Rays(_) | Emitter::Area(_) | Emitter::Volume(_) => None,
        }
    }

    /// The radiance (W/m²/sr over the band) of an emitted ray, 0 if no camera ray hits the light.
    pub fn radiance_of(&self, sample: &LeSample) -> f64 {
        if let Emitter::Area(light) = &self.emitter {
            return light.radiance;
        }
        self.le(-sample.direction).map_or(0.0, |(radiance, _)| radiance)
    }

    /// The pdf per steradian of [`Light::sample_li`] for an escaping direction, 0 for local lights.
    pub fn pdf_li_escaped(&self, direction: DVec3) -> f64 {
        match &self.emitter {
            Emitter::Directional(light) => light.pdf_li(direction),
            Emitter::Environment(light) => light.pdf_li(direction),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Goniometric(_) | Emitter::Beam(_) => 0.0,
            Emitter::Rays(_) | Emitter::Area(_) | Emitter::Volume(_) => 0.0,
        }
    }

    /// The radiance (W/m²/sr over the band) and the spectrum that a ray along `direction` sees
    /// where it hits the light's surface. The radiance is 0 for lights that are not area lights.
    pub fn le_surface(&self, extent: SceneExtent<'_>, direction: DVec3, hit: &Hit) -> (f64, EmittedSpd) {
        let Emitter::Area(light) = &self.emitter else { return (0.0, EmittedSpd::Own) };
        (light.le(direction, hit.normal), light.spd(extent.geometry, hit.surface, hit.position))
    }

    /// The pdf per steradian at `from` of [`Light::sample_li`] for the point `hit` on the light's
    /// surface. 0 for lights that are not area lights.
    pub fn pdf_li_surface(&self, extent: SceneExtent<'_>, from: DVec3, hit: &Hit) -> f64 {
        match self.object() {
            Some(object) => extent.geometry.pdf_solid_angle(object, from, hit),
            None => 0.0,
        }
    }

    /// The relative spectral power distribution `spd` at a wavelength in nm: a density per nm with
    /// integral 1 over the band, or less if a slide absorbs light.
    pub fn spd_at(&self, spd: EmittedSpd, nm: f64) -> f64 {
        match (spd, &self.emitter) {
            (EmittedSpd::Mixed(weights), Emitter::Environment(light)) => light.mixture_at(weights, nm),
            (EmittedSpd::Bands(pixel), Emitter::Environment(light)) => light.bands_at(pixel, nm),
            (EmittedSpd::Thermal(temperature), Emitter::Volume(light)) => light.spd_at(temperature, nm),
            (
                EmittedSpd::Own
                | EmittedSpd::Mixed(_)
                | EmittedSpd::Bands(_)
                | EmittedSpd::Filtered(_)
                | EmittedSpd::Thermal(_),
                _,
            ) => self.spectrum.at(nm) * self.filter_at(spd, nm),
        }
    }

    /// Returns the factor of the light's own spectrum at a wavelength in nm: the transmittance of a
    /// slide, or 1.
    pub fn filter_at(&self, spd: EmittedSpd, nm: f64) -> f64 {
        match (spd, &self.emitter) {
            (EmittedSpd::Filtered(texel), Emitter::Area(light)) => light.transmittance(texel, nm),
            (
                EmittedSpd::Own
                | EmittedSpd::Mixed(_)
                | EmittedSpd::Bands(_)
                | EmittedSpd::Filtered(_)
                | EmittedSpd::Thermal(_),
                _,
            ) => 1.0,
        }
    }

    /// The part of `interval` (distances along a ray in m) in which the light can illuminate the
    /// ray, if any. If the light has extent, `u` selects the pivot of the interval.
    pub fn lit_interval(
        &self,
        extent: SceneExtent<'_>,
        ray: &Ray,
        interval: (f64, f64),
        u: [f64; 3],
    ) -> Option<LitInterval> {
        let (from, to) = interval;
        match &self.emitter {
            Emitter::Point(light) => Some(LitInterval { from, to, pivot: Some(light.position) }),
            Emitter::Spot(light) => light.lit_interval(ray, interval),
            Emitter::Goniometric(light) => light.lit_interval(ray, interval, u),
            Emitter::Beam(light) => light.lit_interval(ray, interval),
            Emitter::Rays(_) => None,
            Emitter::Directional(_) | Emitter::Environment(_) => Some(LitInterval { from, to, pivot: None }),
            Emitter::Area(light) => Some(light.lit_interval(extent.geometry, interval, u)),
            Emitter::Volume(light) => Some(light.lit_interval(interval, u)),
        }
    }

    /// Samples a virtual light, if the light [has them](Self::has_virtual_lights).
    pub fn virtual_light(&self, extent: SceneExtent<'_>, u: [f64; 3]) -> Option<VirtualLight> {
        match &self.emitter {
            Emitter::Point(light) => Some(VirtualLight::at_point(light.position, u)),
            Emitter::Spot(light) => Some(VirtualLight::at_point(light.position(), u)),
            Emitter::Goniometric(light) => light.virtual_light(u),
            Emitter::Beam(light) => light.virtual_light(u),
            Emitter::Directional(light) => Some(light.virtual_light(u)),
            Emitter::Area(light) => light.slide.is_none().then(|| light.virtual_light(extent.geometry, u)),
            Emitter::Rays(_) | Emitter::Environment(_) | Emitter::Volume(_) => None,
        }
    }

    /// Returns true if the light arrives from all directions.
    pub fn surrounds(&self) -> bool {
        matches!(self.emitter, Emitter::Environment(_))
    }

    pub fn slide(&self) -> Option<&SurfaceSpectrum> {
        if let Emitter::Area(light) = &self.emitter { light.slide.as_ref() } else { None }
    }

    /// Replaces the picture of a slide by its mean.
    pub fn remove_texture_of_slide(&mut self) {
        if let Emitter::Area(light) = &mut self.emitter {
            light.slide = light.slide.take().map(SurfaceSpectrum::without_texture);
        }
    }

    /// Returns true if virtual lights can represent the light. A single one is too inaccurate for
    /// environments, volumes, divergent beams, luminous openings and slides.
    pub fn has_virtual_lights(&self) -> bool {
        match &self.emitter {
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Directional(_) => true,
            Emitter::Area(light) => light.slide.is_none(),
            Emitter::Goniometric(light) => light.is_point(),
            Emitter::Beam(light) => light.is_parallel(),
            Emitter::Rays(_) | Emitter::Environment(_) | Emitter::Volume(_) => false,
        }
    }

    /// The light from a virtual light, if any, at the point `from`, as if nothing blocked it.
    pub fn li_from(&self, extent: SceneExtent<'_>, virtual_light: &VirtualLight, from: DVec3) -> Option<LiSample> {
        let connection = virtual_light.connection_from(from);
        let Some(irradiance) = virtual_light.surface_irradiance(&connection) else {
            return self.sample_li(extent, from, virtual_light.randoms());
        };
        let LightConnection { direction, distance, target } = connection;
        (irradiance > 0.0 && irradiance.is_finite()).then_some(LiSample {
            direction,
            distance,
            target,
            irradiance,
            pdf_solid_angle: None,
            spd: EmittedSpd::Own,
        })
    }

    /// Returns true if the light is at infinity, so that a ray that leaves the scene may see it.
    pub fn is_distant(&self) -> bool {
        matches!(self.emitter, Emitter::Directional(_) | Emitter::Environment(_))
    }

    /// Returns true if only photons carry the light, because no direction from a point to the light
    /// is known.
    pub fn is_ray_set(&self) -> bool {
        matches!(self.emitter, Emitter::Rays(_))
    }

    /// Returns true if no scattered ray can hit the light, so that only [`Light::sample_li`] finds
    /// it: beams and luminaires are invisible, and of a volume light, rays see the medium's
    /// emission.
    pub fn is_delta(&self) -> bool {
        match &self.emitter {
            Emitter::Area(_) | Emitter::Environment(_) => false,
            Emitter::Directional(light) => !light.has_extent(),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Goniometric(_) | Emitter::Beam(_) => true,
            Emitter::Rays(_) | Emitter::Volume(_) => true,
        }
    }

    /// Returns true if a path that is sampled from a BSDF hits the light seldom or never: a light
    /// without extent, the sun, a lamp that is small in the scene, or a surround with a bright
    /// spot.
    pub fn is_small(&self, extent: SceneExtent<'_>) -> bool {
        /// The largest radius of a small lamp, by the radius of the scene. From the middle of the
        /// scene, the lamp then covers 1/400 of all directions.
        const SMALL_RADIUS: f64 = 0.1;
        /// A bright spot has more than this factor times the mean radiance of its surround.
        const CONTRAST: f64 = 100.0;
        /// The least fraction of the power from bright spots that counts.
        const FRACTION: f64 = 0.01;
        match &self.emitter {
            Emitter::Area(light) => 0.25 * light.area_m2 < PI * (SMALL_RADIUS * extent.radius_m).powi(2),
            Emitter::Directional(_) => true,
            Emitter::Environment(light) => match &light.pattern {
                EnvironmentPattern::Image(map) => map.fraction_above(CONTRAST) > FRACTION,
                EnvironmentPattern::Uniform | EnvironmentPattern::Sky(_) => false,
            },
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Goniometric(_) | Emitter::Beam(_) | Emitter::Rays(_) => {
                true
            }
            Emitter::Volume(_) => false,
        }
    }

    /// Returns true if the light is a uniform environment, which a rotation does not change.
    pub fn is_rotation_invariant(&self) -> bool {
        matches!(&self.emitter, Emitter::Environment(light) if light.is_uniform())
    }

    pub fn object(&self) -> Option<u32> {
        if let Emitter::Area(light) = &self.emitter { Some(light.object) } else { None }
    }

    pub fn medium_name(&self) -> Option<&str> {
        if let Emitter::Volume(light) = &self.emitter { Some(light.medium_name()) } else { None }
    }

    /// The map from the unit cube to a box around a volume light.
    pub(super) fn box_of_medium(&self) -> Option<DAffine3> {
        if let Emitter::Volume(light) = &self.emitter { Some(light.box_map()) } else { None }
    }

    /// The position of a local light without an object in m about the scene's centre.
    pub fn position(&self) -> Option<DVec3> {
        match &self.emitter {
            Emitter::Point(light) => Some(light.position),
            Emitter::Spot(light) => Some(light.position()),
            Emitter::Goniometric(light) => Some(light.position()),
            Emitter::Beam(light) => Some(light.centre()),
            Emitter::Rays(light) => Some(light.centre()),
            Emitter::Directional(_) | Emitter::Environment(_) | Emitter::Area(_) | Emitter::Volume(_) => None,
        }
    }

    /// A point in all bodies that contain the light, or `None` for distant lights, in air.
    pub fn representative_point(&self, geometry: &Geometry) -> Option<RepresentativePoint> {
        match &self.emitter {
            Emitter::Area(light) => Some(light.representative_point(geometry)),
            Emitter::Volume(light) => Some(light.representative_point()),
            Emitter::Directional(_) | Emitter::Environment(_) => None,
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Goniometric(_) | Emitter::Beam(_) | Emitter::Rays(_) => {
                self.position().map(|position| RepresentativePoint { position, surface: None })
            }
        }
    }

    /// The corners in m of a box around a local light, relative to the scene's centre. `None` for
    /// distant and volume lights. `object_bounds` has one box per object.
    pub fn bounds(&self, object_bounds: &BTreeMap<u32, (DVec3, DVec3)>) -> Option<(DVec3, DVec3)> {
        let around = |centre: DVec3, radius: f64| Some((centre - radius, centre + radius));
        match &self.emitter {
            Emitter::Point(light) => around(light.position, 0.0),
            Emitter::Spot(light) => around(light.position(), 0.0),
            Emitter::Goniometric(light) => Some(light.corners()),
            Emitter::Beam(light) => around(light.centre(), light.radius_m()),
            Emitter::Rays(light) => Some(light.bounds()),
            Emitter::Area(light) => object_bounds.get(&light.object).copied(),
            Emitter::Directional(_) | Emitter::Environment(_) | Emitter::Volume(_) => None,
        }
    }

    /// Recomputes the area of an area light after its object has moved.
    pub(super) fn update_area(&mut self, geometry: &Geometry) {
        if let Emitter::Area(light) = &mut self.emitter {
            light.area_m2 = geometry.area(light.object);
        }
    }
}
