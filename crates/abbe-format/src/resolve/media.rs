//! Translates the media of the scene file. The coefficients become 1/m, and boxes of fields m.

use super::{context::Resolver, index::index_of, motion::ResolvedMotion, spectra::Role};
use crate::{
    DyeFile, ExponentialFieldFile, FieldFile, GridFile, HomogeneousFile, IceOrientationFile, IcePopulationFile,
    JsonPath, MediumFile, NoiseFieldFile, PhaseFile, PlanetFile, SpectrumFile, SphereFieldFile, TransmittanceFile,
    volume_file,
};
use abbe_optics::fluorophore::Fluorophore;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::phase::mie::MieSpheres;
use abbe_optics::phase::{self, IceOrientation, IcePopulation, PhaseFunction, PhaseTable, PrismShape};
use abbe_scene::builder::SceneBuilder;
use abbe_scene::medium::field::{Atmosphere, BallField, FieldGrid, FieldShape, Ground, Noise, Planet, ScalarField};
use abbe_scene::medium::{Density, Medium, TransmittanceEstimator};
use abbe_spectra::error::{Error, Result, both};
use abbe_spectra::spectrum::Spectrum;
use glam::{DAffine3, DVec3};
use std::path::Path;
use std::sync::Arc;

/// The number of steps of ray marching if `render.march_steps` is absent.
pub const DEFAULT_MARCH_STEPS: u32 = 64;

/// The box of a grid medium, in m.
struct FieldPlacement {
    /// The lowest and highest corner in the box's own coordinates.
    bounds: (DVec3, DVec3),
    /// The transform from coordinates relative to the scene's centre to those of the box.
    to_local: DAffine3,
}

/// Adds a dye to a medium, if there is one.
fn with_dye(medium: Medium, dye: Option<Fluorophore>) -> Medium {
    if let Some(dye) = dye { medium.with_fluorophore(dye) } else { medium }
}

impl Resolver<'_> {
    /// Returns the number of a medium, its position in `media`. `at` is the place of the name.
    pub(super) fn medium_number(&self, at: &JsonPath, name: &str) -> Result<usize> {
        self.scene.media.keys().position(|known| known == name).ok_or_else(|| {
            let known = self.scene.media.keys().map(String::as_str).collect();
            self.unknown_name(at, ["medium", "media"], name, known)
        })
    }

    /// Adds all media to the builder, including unused ones, in the order of their numbers.
    pub(super) fn media(&self, builder: &mut SceneBuilder) {
        let (root, centre) = (JsonPath::Root, builder.centre());
        let media = root.key("media");
        for (name, file) in &self.scene.media {
            let (at, notes) = (media.key(name), &mut builder.notes);
            let (medium, emission) = match file {
                MediumFile::Homogeneous(it) => (self.uniform(&at.key("homogeneous"), it, name, notes), &it.emission),
                MediumFile::Grid(it) => (self.grid(&at.key("grid"), it, name, centre, notes), &it.emission),
            };
            if let Some(medium) = self.keep(medium) {
                builder.add_medium(medium, emission.as_ref().and_then(|emission| emission.power));
            }
        }
    }

    fn uniform(&self, at: &JsonPath, file: &HomogeneousFile, name: &str, notes: &mut Vec<String>) -> Result<Medium> {
        // The transform and the motion of a uniform medium have no effect.
        let HomogeneousFile { absorption, scattering, phase, emission, dye, priority: _, transform: _, motion: _ } =
            file;
        let phase = self.phase(&at.key("phase"), phase, notes);
        let phase_and_dye = both(phase, self.dye(&at.key("dye"), dye.as_ref()));
        let (coefficients, (phase, dye)) = both(self.coefficients(at, [absorption, scattering]), phase_and_dye)?;
        let resolve = |file| self.medium_emission(&at.key("emission"), file, &coefficients.0, None);
        let emission = emission.as_ref().map(resolve).transpose()?;
        let medium = Medium { emission, ..Medium::new(name.to_owned(), coefficients, phase, Density::Uniform) };
        Ok(with_dye(medium, dye))
    }

    fn grid(
        &self,
        at: &JsonPath,
        file: &GridFile,
        name: &str,
        centre: DVec3,
        notes: &mut Vec<String>,
    ) -> Result<Medium> {
        let GridFile { bounds, density, absorption, scattering, phase, emission, temperature, .. } = file;
        let GridFile { transmittance, priority: _, transform, motion, .. } = file;
        let ResolvedMotion { start, motion } = self.motion(transform, motion);
        let phase = self.phase(&at.key("phase"), phase, notes);
        let phase_and_dye = both(phase, self.dye(&at.key("dye"), file.dye.as_ref()));
        let (coefficients, (phase, dye)) = both(self.coefficients(at, [absorption, scattering]), phase_and_dye)?;
        let place = self.field_placement(*bounds, start, centre);
        let field = |key: &str, file| self.field(&at.key(key), file, &place).map(Arc::new);
        let density = Density::Field(field("density", density)?);
        let temperature = temperature.as_ref().map(|file| field("temperature", file)).transpose()?;
        let resolve = |file| self.medium_emission(&at.key("emission"), file, &coefficients.0, temperature);
        let emission = emission.as_ref().map(resolve).transpose()?;
        let transmittance = match transmittance {
            TransmittanceFile::Exact => TransmittanceEstimator::Exact,
            TransmittanceFile::Ratio => TransmittanceEstimator::Ratio,
            TransmittanceFile::March => {
                TransmittanceEstimator::March { steps: self.scene.render.march_steps.unwrap_or(DEFAULT_MARCH_STEPS) }
            }
        };
        let medium = Medium::new(name.to_owned(), coefficients, phase, density);
        Ok(with_dye(Medium { transmittance, emission, motion, ..medium }, dye))
    }

    /// Resolves the dye of a medium. The absorption coefficient is in 1/m.
    fn dye(&self, at: &JsonPath, file: Option<&DyeFile>) -> Result<Option<Fluorophore>> {
        /// Converts a decadic coefficient in 1/cm to a natural coefficient in 1/m.
        const PER_M: f64 = 100.0 * std::f64::consts::LN_10;
        let Some(file) = file else { return Ok(None) };
        let DyeFile { absorption, molar_absorption, concentration, emission, quantum_yield } = file;
        let (key, spectrum, factor) = match (absorption, molar_absorption) {
            (Some(absorption), _) => ("absorption", absorption, 1.0 / self.metres),
            (None, Some(molar)) => ("molar_absorption", molar, concentration.unwrap_or_default() * PER_M),
            (None, None) => return Ok(None),
        };
        let absorption = self.spectrum(&at.key(key), spectrum, Role::DyeAbsorption);
        let emission = self.spectrum(&at.key("emission"), emission, Role::Light);
        let (absorption, emission) = both(absorption, emission)?;
        self.at(at, Fluorophore::with_absorption(absorption.scaled(factor), &emission, *quantum_yield)).map(Some)
    }

    /// The absorption and scattering coefficients in 1/m.
    fn coefficients(
        &self,
        at: &JsonPath,
        [absorption, scattering]: [&SpectrumFile; 2],
    ) -> Result<(Spectrum, Spectrum)> {
        let coefficient = |key: &str, file| {
            self.spectrum(&at.key(key), file, Role::Coefficient).map(|per_unit| per_unit.scaled(1.0 / self.metres))
        };
        both(coefficient("absorption", absorption), coefficient("scattering", scattering))
    }

    /// Resolves the box of a grid medium. `to_world` is in the scene's unit.
    fn field_placement(&self, bounds: [[f64; 3]; 2], to_world: DAffine3, centre: DVec3) -> FieldPlacement {
        let metres = DAffine3::from_scale(DVec3::splat(self.metres));
        let to_file = metres.inverse() * DAffine3::from_translation(centre);
        let to_local = metres * to_world.inverse() * to_file;
        let [low, high] = bounds.map(|corner| DVec3::from(corner) * self.metres);
        FieldPlacement { bounds: (low, high), to_local }
    }

    fn field(&self, at: &JsonPath, file: &FieldFile, place: &FieldPlacement) -> Result<ScalarField> {
        Ok(ScalarField::new(self.field_shape(at, file, place.bounds)?, place.bounds, place.to_local))
    }

    fn field_shape(&self, at: &JsonPath, file: &FieldFile, bounds: (DVec3, DVec3)) -> Result<FieldShape> {
        let FieldFile { values, resolution, path, constant, exponential, sphere, noise } = file;
        if let (Some(values), Some(resolution)) = (values, resolution) {
            let grid = FieldGrid::new(resolution.map(|cells| cells as usize), values.iter().copied());
            return Ok(FieldShape::Grid(self.at(&at.key("values"), grid)?));
        }
        if let Some(path) = path {
            let grid = self.source.file(path).and_then(|path| volume_file::read(&path));
            return Ok(FieldShape::Grid(self.at(&at.key("path"), grid)?));
        }
        if let Some(value) = constant {
            return Ok(FieldShape::Constant(*value));
        }
        let length = |length: f64| length * self.metres;
        let point = |point: [f64; 3]| DVec3::from(point) * self.metres;
        if let Some(ExponentialFieldFile { value, scale_height, planet }) = *exponential {
            let above = planet.map_or(Ground::Plain(bounds.0.y), |PlanetFile { center, radius }| {
                Ground::Planet(Planet { center: point(center), radius: length(radius) })
            });
            return Ok(FieldShape::Atmosphere(Atmosphere { value, scale_height: length(scale_height), above }));
        }
        if let Some(SphereFieldFile { value, center, radius, falloff }) = *sphere {
            return Ok(FieldShape::Ball(BallField { value, center: point(center), radius: length(radius), falloff }));
        }
        if let Some(NoiseFieldFile { value, scale, octaves, threshold, falloff, seed }) = *noise {
            let noise = Noise { value, scale: length(scale), octaves, threshold, falloff, seed };
            return Ok(FieldShape::Grid(self.at(&at.key("noise"), noise.grid(bounds))?));
        }
        // Unreachable: the validation of the file requires exactly one form.
        self.at(at, Err(Error::input("found none of the forms of a field")))
    }

    fn phase(&self, at: &JsonPath, file: &PhaseFile, notes: &mut Vec<String>) -> Result<PhaseFunction> {
        match file {
            PhaseFile::Isotropic => Ok(PhaseFunction::Isotropic),
            PhaseFile::Rayleigh => Ok(PhaseFunction::Rayleigh),
            PhaseFile::HenyeyGreenstein { g } => {
                let g = self.spectrum(&at.key("henyey_greenstein").key("g"), g, Role::MeanCosine)?;
                Ok(PhaseFunction::HenyeyGreenstein { g })
            }
            PhaseFile::Table { path } => {
                let table = self.source.file(path).and_then(|path| read_phase_table(&path));
                Ok(PhaseFunction::Table(Arc::new(self.at(&at.key("table").key("path"), table)?)))
            }
            PhaseFile::Mie { radius_um, spread, ior } => {
                let at = at.key("mie");
                let given = ior.as_ref().map(|file| self.at(&at.key("ior"), index_of(file, self.source)));
                let index = given.unwrap_or_else(|| RefractiveIndex::catalogue("water 20C"))?;
                notes.extend(index.warning().map(|warning| format!("{at}: {warning}")));
                let spheres = MieSpheres::new(*radius_um, *spread, index);
                Ok(PhaseFunction::Table(self.at(&at, spheres.and_then(|spheres| spheres.table()))?))
            }
            PhaseFile::Rainbow => Ok(PhaseFunction::Table(phase::rainbow())),
            PhaseFile::Ice => Ok(PhaseFunction::Table(phase::ice())),
            PhaseFile::IceCrystals(populations) => {
                let populations: Vec<IcePopulation> = populations.iter().map(ice_population).collect();
                Ok(phase::ice_crystals(&populations, &self.distant_light_sines()))
            }
        }
    }
}

/// Translates a population of ice crystals. Angles become rad.
fn ice_population(file: &IcePopulationFile) -> IcePopulation {
    /// Degrees.
    const DEFAULT_TILT: f64 = 1.0;
    let IcePopulationFile { orientation, length_to_width, tilt, weight } = *file;
    let shape = |length: f64| PrismShape {
        length_to_width: length_to_width.unwrap_or(length),
        tilt: tilt.unwrap_or(DEFAULT_TILT).to_radians(),
    };
    let orientation = match orientation {
        IceOrientationFile::Random => IceOrientation::Random,
        IceOrientationFile::Plates => IceOrientation::Plates(shape(0.3)),
        IceOrientationFile::Columns => IceOrientation::Columns(shape(2.0)),
        IceOrientationFile::Parry => IceOrientation::Parry(shape(2.0)),
    };
    IcePopulation { orientation, weight }
}

/// Reads a tabulated phase function from a file.
fn read_phase_table(path: &Path) -> Result<PhaseTable> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Error::input(format!("cannot read the phase function: {error}")).in_file(path))?;
    phase::parse_table(&text).map_err(|error| error.in_file(path))
}
