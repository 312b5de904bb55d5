//! Light sources: the light that they emit, and the light that reaches a point from them.
//!
//! All lights must satisfy the same contract. Tests check the contract for each kind of light. The
//! mean flux of [`Light::sample_le`] equals [`Light::power_w`]. The function `power_w` uses no
//! random numbers. At each point, the irradiance from [`Light::sample_li`] equals the irradiance
//! from the emitted rays.
//!
//! Only this file, `bounded_light.rs` and `luminous_surface.rs` contain `match` expressions over
//! the variants of [`Emitter`]. All other code calls the methods of [`Light`].

mod area;
mod beam;
mod bounded_light;
mod directional;
mod environment;
mod environment_map;
mod goniometric;
mod intensity_bounds;
mod intensity_table;
mod lit_interval;
mod luminous_surface;
mod point;
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
pub use environment_map::EnvironmentMap;
pub use goniometric::{GoniometricLight, LuminousOpening, OpeningShape};
pub use intensity_bounds::IntensityBounds;
pub use intensity_table::{IntensityTable, PhotometricType};
pub use lit_interval::LitInterval;
pub use point::{PointLight, SpotFalloff, SpotLight};
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

/// A light source of the scene.
#[derive(Debug, Clone)]
pub struct Light {
    /// The name in reports.
    pub name: String,
    /// The name of the group. Lights of a group share a layer of the picture.
    pub group: String,
    /// The kind of light, with its position and radiometric quantity.
    pub emitter: Emitter,
    /// The relative spectral power distribution: a density per nm with integral 1 over the band.
    pub spectrum: Spectrum,
    /// The sampling distribution of photon wavelengths. It is proportional to the product of the
    /// spectrum and the visual importance.
    pub wavelengths: WavelengthDistribution,
    /// The distribution with the ultraviolet that excites fluorophores. `None` if no fluorophore of
    /// the scene needs it.
    pub ultraviolet: Option<Box<WavelengthDistribution>>,
    /// The visual importance of one watt: ∫ S(λ)(x̄+ȳ+z̄)(λ) dλ. It includes the light that the
    /// ultraviolet excites.
    pub importance_per_watt: f64,
    /// The bodies that contain the light. If the light crosses bodies, these are the bodies around
    /// one of its points.
    pub medium_stack: MediumStack,
    /// True if the bodies that contain a point of the light may differ from point to point. A panel
    /// may lie partly in fog, for example.
    pub crosses_bodies: bool,
    /// The light's own motion (in m) while the shutter is open. An area light has none, because it
    /// moves with its object. The field `emitter` describes the light at the moment when the
    /// shutter opens.
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
    /// Returns the emitter transformed by a map of world positions.
    ///
    /// The radius of a beam is multiplied by the mean scale of the map. An environment only
    /// rotates. An area light is not changed, because its object moves instead.
    #[must_use]
    pub fn moved(&self, map: &DAffine3) -> Self {
        match self {
            Self::Point(light) => Self::Point(light.moved(map)),
            Self::Spot(light) => Self::Spot(light.moved(map)),
            Self::Goniometric(light) => Self::Goniometric(light.moved(map)),
            Self::Beam(light) => Self::Beam(light.moved(map)),
            Self::Directional(light) => Self::Directional(light.moved(map)),
            Self::Environment(light) => Self::Environment(light.rotated(DecomposedTransform::of(map).rotation)),
            Self::Area(_) => self.clone(),
            Self::Volume(light) => Self::Volume(Box::new(light.moved(map))),
        }
    }
}

/// The local lights of the contract tests. The files that define the kinds of lights provide them.
/// Each light is at `at` and shines along `axis`.
#[cfg(test)]
fn local_test_lights(at: DVec3, axis: DVec3) -> Vec<contract_tests::TestLight> {
    [point::test_lights(at, axis), beam::test_lights(at, axis), goniometric::test_lights(at, axis)].concat()
}

impl Light {
    /// Creates a light at rest.
    ///
    /// `observer` is the observer of the film. Photon wavelengths are sampled in proportion to the
    /// product of the spectrum and the visual importance for this observer.
    ///
    /// # Errors
    /// Returns an error if the spectrum has no power within the band.
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

    /// The emitted power in W over the band. For a distant light, it is the power that enters the
    /// scene's bounding sphere.
    pub fn power_w(&self, extent: SceneExtent<'_>) -> f64 {
        match &self.emitter {
            Emitter::Point(light) => light.power_w(),
            Emitter::Spot(light) => light.power_w(),
            Emitter::Goniometric(light) => light.power_w(),
            Emitter::Beam(light) => light.power_w,
            Emitter::Directional(light) => light.power_w(extent.radius_m),
            Emitter::Environment(light) => light.power_w(extent.radius_m),
            Emitter::Area(light) => light.power_w(),
            Emitter::Volume(light) => light.power_w(),
        }
    }

    /// Samples an emitted ray.
    pub fn sample_le(&self, extent: SceneExtent<'_>, u: LeRandoms) -> LeSample {
        match &self.emitter {
            Emitter::Point(light) => light.sample_le(u),
            Emitter::Spot(light) => light.sample_le(u),
            Emitter::Goniometric(light) => light.sample_le(u),
            Emitter::Beam(light) => light.sample_le(u),
            Emitter::Directional(light) => light.sample_le(extent.radius_m, u),
            Emitter::Environment(light) => light.sample_le(extent.radius_m, u),
            Emitter::Area(light) => light.sample_le(extent.geometry, u),
            Emitter::Volume(light) => light.sample_le(u),
        }
    }

    /// Samples an emitted ray that passes through a sphere.
    ///
    /// The random numbers `u.rest` have the same meaning as in [`Light::sample_le`]. The numbers
    /// `u.aim` cover only the rays through the sphere, so the mean flux is the power that the light
    /// sends through the sphere.
    pub fn sample_le_through(&self, extent: SceneExtent<'_>, sphere: &BoundingSphere, u: LeRandoms) -> LeSample {
        let sample = match &self.emitter {
            Emitter::Point(light) => light.sample_le_through(sphere, u),
            Emitter::Spot(light) => light.sample_le_through(sphere, u),
            Emitter::Goniometric(light) => light.sample_le_through(sphere, u),
            Emitter::Beam(light) => light.sample_le_through(sphere, u),
            Emitter::Directional(light) => light.sample_le_through(extent.radius_m, sphere, u),
            Emitter::Environment(light) => light.sample_le_through(extent.radius_m, sphere, u),
            Emitter::Area(light) => light.sample_le_through(extent.geometry, sphere, u),
            Emitter::Volume(light) => light.sample_le_through(sphere, u),
        };
        if sphere.contains_part_of(sample.origin, sample.direction) { sample } else { sample.dark() }
    }

    /// Samples a direction from the point `from` towards the light. Returns `None` if no light
    /// arrives along the sampled direction. The caller must test whether a surface blocks the
    /// light.
    pub fn sample_li(&self, extent: SceneExtent<'_>, from: DVec3, u: [f64; 3]) -> Option<LiSample> {
        match &self.emitter {
            Emitter::Point(light) => light.sample_li(from),
            Emitter::Spot(light) => light.sample_li(from),
            Emitter::Goniometric(light) => light.sample_li(from, u),
            Emitter::Beam(light) => light.sample_li(from, u),
            Emitter::Directional(light) => Some(light.sample_li(u)),
            Emitter::Environment(light) => light.sample_li(u),
            Emitter::Area(light) => light.sample_li(extent.geometry, from, u),
            Emitter::Volume(light) => light.sample_li(from, u),
        }
    }

    /// The radiance (W/m²/sr over the band) and the spectrum that a ray sees if it leaves the scene
    /// along `direction`. The result is `None` for local lights. It is also `None` for a
    /// directional light that is not in this direction.
    pub fn le(&self, direction: DVec3) -> Option<(f64, EmittedSpd)> {
        match &self.emitter {
            Emitter::Directional(light) => light.le(direction).map(|radiance| (radiance, EmittedSpd::Own)),
            Emitter::Environment(light) => Some(light.le(direction)),
            Emitter::Point(_)
            | Emitter::Spot(_)
            | Emitter::Goniometric(_)
            | Emitter::Beam(_)
            | Emitter::Area(_)
            | Emitter::Volume(_) => None,
        }
    }

    /// The radiance (W/m²/sr over the band) of an emitted ray. It is 0 for lights that no camera
    /// ray can hit on a surface or at infinity.
    pub fn radiance_of(&self, sample: &LeSample) -> f64 {
        match &self.emitter {
            Emitter::Area(light) => light.radiance,
            Emitter::Directional(_) | Emitter::Environment(_) => {
                self.le(-sample.direction).map_or(0.0, |(radiance, _)| radiance)
            }
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Goniometric(_) | Emitter::Beam(_) | Emitter::Volume(_) => {
                0.0
            }
        }
    }

    /// The sampling density of [`Light::sample_li`] for the direction of a ray that leaves the
    /// scene. The density is per steradian. It is 0 for local lights.
    pub fn pdf_li_escaped(&self, direction: DVec3) -> f64 {
        match &self.emitter {
            Emitter::Directional(light) => light.pdf_li(direction),
            Emitter::Environment(light) => light.pdf_li(direction),
            Emitter::Point(_)
            | Emitter::Spot(_)
            | Emitter::Goniometric(_)
            | Emitter::Beam(_)
            | Emitter::Area(_)
            | Emitter::Volume(_) => 0.0,
        }
    }

    /// The radiance (W/m²/sr over the band) and the spectrum that a ray along `direction` sees
    /// where it hits the light's surface. The radiance is 0 for lights that are not area lights.
    pub fn le_surface(&self, extent: SceneExtent<'_>, direction: DVec3, hit: &Hit) -> (f64, EmittedSpd) {
        let Emitter::Area(light) = &self.emitter else { return (0.0, EmittedSpd::Own) };
        (light.le(direction, hit.normal), light.spd(extent.geometry, hit.surface, hit.position))
    }

    /// The sampling density of [`Light::sample_li`] for the point `hit` on the light's surface. The
    /// density is per steradian at `from`. It is 0 for lights that are not area lights.
    pub fn pdf_li_surface(&self, extent: SceneExtent<'_>, from: DVec3, hit: &Hit) -> f64 {
        match self.object() {
            Some(object) => extent.geometry.pdf_solid_angle(object, from, hit),
            None => 0.0,
        }
    }

    /// The relative spectral power distribution `spd` of this light at a wavelength in nm. It is a
    /// density per nm. Its integral over the band is 1, or less if a slide absorbs light.
    pub fn spd_at(&self, spd: EmittedSpd, nm: f64) -> f64 {
        match (spd, &self.emitter) {
            (EmittedSpd::Mixed(weights), Emitter::Environment(light)) => light.mixture_at(weights, nm),
            (EmittedSpd::Thermal(temperature), Emitter::Volume(light)) => light.spd_at(temperature, nm),
            (EmittedSpd::Filtered(texel), Emitter::Area(light)) => {
                self.spectrum.at(nm) * light.transmittance(texel, nm)
            }
            (EmittedSpd::Own | EmittedSpd::Mixed(_) | EmittedSpd::Filtered(_) | EmittedSpd::Thermal(_), _) => {
                self.spectrum.at(nm)
            }
        }
    }

    /// The part of a ray that the light can illuminate. This part lies within `interval`, an interval
    /// of distances in m. `None` if there is no such part. If the light has extent, the random
    /// numbers `u` select the pivot of the interval.
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
            Emitter::Directional(_) | Emitter::Environment(_) => Some(LitInterval { from, to, pivot: None }),
            Emitter::Area(light) => Some(light.lit_interval(extent.geometry, interval, u)),
            Emitter::Volume(light) => Some(light.lit_interval(interval, u)),
        }
    }

    /// Samples a virtual light. Returns `None` if [`has_virtual_lights`](Self::has_virtual_lights)
    /// is false.
    pub fn virtual_light(&self, extent: SceneExtent<'_>, u: [f64; 3]) -> Option<VirtualLight> {
        match &self.emitter {
            Emitter::Point(light) => Some(VirtualLight::at_point(light.position, u)),
            Emitter::Spot(light) => Some(VirtualLight::at_point(light.position(), u)),
            Emitter::Goniometric(light) => light.virtual_light(u),
            Emitter::Beam(light) => light.virtual_light(u),
            Emitter::Directional(light) => Some(light.virtual_light(u)),
            Emitter::Area(light) => light.slide.is_none().then(|| light.virtual_light(extent.geometry, u)),
            Emitter::Environment(_) | Emitter::Volume(_) => None,
        }
    }

    /// Returns true if the light arrives from all directions.
    pub fn surrounds(&self) -> bool {
        matches!(self.emitter, Emitter::Environment(_))
    }

    /// Returns the slide in front of the light.
    pub fn slide(&self) -> Option<&SurfaceSpectrum> {
        if let Emitter::Area(light) = &self.emitter { light.slide.as_ref() } else { None }
    }

    /// Replaces the picture of a slide by its mean.
    pub fn remove_texture_of_slide(&mut self) {
        if let Emitter::Area(light) = &mut self.emitter {
            light.slide = light.slide.take().map(SurfaceSpectrum::without_texture);
        }
    }

    /// Returns true if virtual lights can represent the light. For an environment, a volume light,
    /// a divergent beam, a luminous opening or a light with a slide, a single virtual light is too
    /// inaccurate.
    pub fn has_virtual_lights(&self) -> bool {
        match &self.emitter {
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Directional(_) => true,
            Emitter::Area(light) => light.slide.is_none(),
            Emitter::Goniometric(light) => light.is_point(),
            Emitter::Beam(light) => light.is_parallel(),
            Emitter::Environment(_) | Emitter::Volume(_) => false,
        }
    }

    /// The light that the point `from` receives from a virtual light. `None` if the point receives
    /// no light. The caller must test whether a surface blocks the light.
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

    /// Returns true if the light is at infinity. A ray that leaves the scene may then see the
    /// light.
    pub fn is_distant(&self) -> bool {
        match &self.emitter {
            Emitter::Directional(_) | Emitter::Environment(_) => true,
            Emitter::Point(_)
            | Emitter::Spot(_)
            | Emitter::Goniometric(_)
            | Emitter::Beam(_)
            | Emitter::Area(_)
            | Emitter::Volume(_) => false,
        }
    }

    /// Returns true if no scattered ray can hit the light. In this case, only [`Light::sample_li`]
    /// finds the light. Beams and luminaires count as delta lights because their surface is
    /// invisible. Volume lights count as delta lights because a ray never sees the light itself,
    /// but only the emission of the medium.
    pub fn is_delta(&self) -> bool {
        match &self.emitter {
            Emitter::Area(_) | Emitter::Environment(_) => false,
            Emitter::Directional(light) => !light.has_extent(),
            Emitter::Point(_) | Emitter::Spot(_) | Emitter::Goniometric(_) | Emitter::Beam(_) | Emitter::Volume(_) => {
                true
            }
        }
    }

    /// Returns true if the light is a uniform environment, which a rotation does not change.
    pub fn is_rotation_invariant(&self) -> bool {
        match &self.emitter {
            Emitter::Environment(light) => light.is_uniform(),
            Emitter::Point(_)
            | Emitter::Spot(_)
            | Emitter::Goniometric(_)
            | Emitter::Beam(_)
            | Emitter::Directional(_)
            | Emitter::Area(_)
            | Emitter::Volume(_) => false,
        }
    }

    /// The number of the object that emits the light. `None` if the light is not an area light.
    pub fn object(&self) -> Option<u32> {
        if let Emitter::Area(light) = &self.emitter { Some(light.object) } else { None }
    }

    /// The name of the medium that emits the light. `None` if the light is not a volume light.
    pub fn medium_name(&self) -> Option<&str> {
        if let Emitter::Volume(light) = &self.emitter { Some(light.medium_name()) } else { None }
    }

    /// The map from the unit cube to a box around a volume light. `None` for all other lights.
    pub(super) fn box_of_medium(&self) -> Option<DAffine3> {
        if let Emitter::Volume(light) = &self.emitter { Some(light.box_map()) } else { None }
    }

    /// The position of a point, spot, goniometric or beam light, relative to the scene's centre, in
    /// m; `None` for all other lights.
    pub fn position(&self) -> Option<DVec3> {
        match &self.emitter {
            Emitter::Point(light) => Some(light.position),
            Emitter::Spot(light) => Some(light.position()),
            Emitter::Goniometric(light) => Some(light.position()),
            Emitter::Beam(light) => Some(light.centre()),
            Emitter::Directional(_) | Emitter::Environment(_) | Emitter::Area(_) | Emitter::Volume(_) => None,
        }
    }

    /// A point of the light. The bodies that contain this point also contain the light. `None` for
    /// distant lights, which are in air.
    pub fn representative_point(&self, geometry: &Geometry) -> Option<RepresentativePoint> {
        match &self.emitter {
            Emitter::Area(light) => Some(light.representative_point(geometry)),
            Emitter::Volume(light) => Some(light.representative_point()),
            Emitter::Point(_)
            | Emitter::Spot(_)
            | Emitter::Goniometric(_)
            | Emitter::Beam(_)
            | Emitter::Directional(_)
            | Emitter::Environment(_) => {
                self.position().map(|position| RepresentativePoint { position, surface: None })
            }
        }
    }

    /// The lowest and highest corner of a box around a local light, relative to the scene's centre,
    /// in m. `None` for distant lights and volume lights. `object_bounds` contains one box around
    /// each object.
    pub fn bounds(&self, object_bounds: &BTreeMap<u32, (DVec3, DVec3)>) -> Option<(DVec3, DVec3)> {
        let around = |centre: DVec3, radius: f64| Some((centre - radius, centre + radius));
        match &self.emitter {
            Emitter::Point(light) => around(light.position, 0.0),
            Emitter::Spot(light) => around(light.position(), 0.0),
            Emitter::Goniometric(light) => Some(light.corners()),
            Emitter::Beam(light) => around(light.centre(), light.radius_m()),
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
