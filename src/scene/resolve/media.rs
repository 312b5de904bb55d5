//! Media as written → media as meant.

use super::Resolver;
use super::materials::index_of;
use super::motion::Way;
use super::objects::Things;
use super::spectra::Role;
use crate::error::{Error, Result};
use crate::optics::glass::Index;
use crate::optics::phase::mie::Spheres;
use crate::optics::phase::{self, Phase, PhaseTable};
use crate::scene::file::{
    ExponentialFieldFile, FieldFile, GridFile, HomogeneousFile, JsonPath, MediumFile, NoiseFieldFile, PhaseFile,
    PlanetFile, SpectrumFile, SphereFieldFile, TransmittanceFile,
};
use crate::scene::medium::field::{Atmosphere, Ball, Field, Grid, Ground, Noise, Planet, Shape};
use crate::scene::medium::{Density, Medium, Transmittance, volume_file};
use crate::scene::motion::MovingShape;
use crate::spectrum::Spectrum;
use glam::{DAffine3, DVec3};
use std::path::Path;
use std::sync::Arc;

/// Steps of a march where `render.march_steps` states none.
pub const DEFAULT_MARCH_STEPS: u32 = 64;

/// Where a grid's box stands: its corners in its own coordinates, and the way there from the scene's; all in m.
struct Place {
    bounds: (DVec3, DVec3),
    to_local: DAffine3,
}

impl Resolver<'_> {
    /// The number of the medium of this name, which is its place among the scene's media; `at` is where it is named.
    pub(super) fn medium_number(&self, at: &JsonPath<'_>, name: &str) -> Result<usize> {
        let mut names = self.scene.media.keys();
        names.position(|known| known == name).map_or_else(
            || {
                let known = self.scene.media.keys().map(String::as_str);
                let allowed = if self.scene.media.is_empty() {
                    "a name of the scene's `media`, which is empty".into()
                } else {
                    format!("one of {}", known.clone().collect::<Vec<_>>().join(", "))
                };
                self.at(at, Err(Error::unknown_name("medium", name, known).expected(allowed)))
            },
            Ok,
        )
    }

    /// Resolves all media, those too that nothing uses; `centre` is the scene's centre in m.
    pub(super) fn media(&self, centre: DVec3, notes: &mut Vec<String>) -> Result<Vec<Medium>> {
        self.scene.media.iter().map(|(name, file)| self.medium(name, file, centre, notes)).collect()
    }

    fn medium(&self, name: &str, file: &MediumFile, centre: DVec3, notes: &mut Vec<String>) -> Result<Medium> {
        let root = JsonPath::Root;
        let media = root.key("media");
        let at = media.key(name);
        match file {
            MediumFile::Homogeneous(file) => self.homogeneous(&at.key("homogeneous"), file, name, notes),
            MediumFile::Grid(file) => self.grid(&at.key("grid"), file, (name, centre), notes),
        }
    }

    fn homogeneous(
        &self,
        at: &JsonPath<'_>,
        file: &HomogeneousFile,
        name: &str,
        notes: &mut Vec<String>,
    ) -> Result<Medium> {
        // Where a medium stands that is the same everywhere makes no difference, nor does how it moves.
        let HomogeneousFile { absorption, scattering, phase, emission, priority: _, transform: _, motion: _ } = file;
        let coefficients = self.coefficients(at, absorption, scattering)?;
        let glow = |file| self.glow(&at.key("emission"), file, &coefficients.0, None);
        let emission = emission.as_ref().map(glow).transpose()?;
        let phase = self.phase(&at.key("phase"), phase, notes)?;
        Ok(Medium { emission, ..Medium::new(name.to_owned(), coefficients, phase, Density::Uniform) })
    }

    fn grid(
        &self,
        at: &JsonPath<'_>,
        file: &GridFile,
        (name, centre): (&str, DVec3),
        notes: &mut Vec<String>,
    ) -> Result<Medium> {
        let GridFile { bounds, density, absorption, scattering, phase, emission, temperature, .. } = file;
        let GridFile { transmittance, priority: _, transform, motion, .. } = file;
        let Way { placing, motion } = self.way(transform, motion);
        let coefficients = self.coefficients(at, absorption, scattering)?;
        let phase = self.phase(&at.key("phase"), phase, notes)?;
        let place = self.place(*bounds, placing, centre);
        let field = |key: &str, file| self.field(&at.key(key), file, &place).map(Arc::new);
        let density = Density::Field(field("density", density)?);
        let temperature = temperature.as_ref().map(|file| field("temperature", file)).transpose()?;
        let glow = |file| self.glow(&at.key("emission"), file, &coefficients.0, temperature);
        let emission = emission.as_ref().map(glow).transpose()?;
        let transmittance = match transmittance {
            TransmittanceFile::Exact => Transmittance::Exact,
            TransmittanceFile::Ratio => Transmittance::Ratio,
            TransmittanceFile::March => {
                Transmittance::March { steps: self.scene.render.march_steps.unwrap_or(DEFAULT_MARCH_STEPS) }
            }
        };
        Ok(Medium { transmittance, emission, motion, ..Medium::new(name.to_owned(), coefficients, phase, density) })
    }

    /// Finds the media that are dense in any of the bodies that they fill.
    pub(super) fn find_dense(&self, media: &mut [Medium], things: &Things<'_>) {
        for MovingShape { placed, .. } in &things.shapes {
            let material = &things.materials[things.objects[placed.object as usize].material];
            let medium = material.body.as_ref().and_then(|body| body.medium);
            if let Some((number, (low, high))) = medium.zip(placed.shape.bounds()) {
                let axes = placed.to_world.matrix3;
                let sides = (high - low) * DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
                media[number].dense |= media[number].is_dense_across(sides.min_element());
            }
        }
    }

    /// Absorption and scattering in 1/m.
    fn coefficients(
        &self,
        at: &JsonPath<'_>,
        absorption: &SpectrumFile,
        scattering: &SpectrumFile,
    ) -> Result<(Spectrum, Spectrum)> {
        let coefficient = |key: &str, file| {
            self.spectrum(&at.key(key), file, Role::Coefficient).map(|per_unit| per_unit.scaled(1.0 / self.metres))
        };
        Ok((coefficient("absorption", absorption)?, coefficient("scattering", scattering)?))
    }

    /// Where a grid's box stands.
    fn place(&self, bounds: [[f64; 3]; 2], placing: DAffine3, centre: DVec3) -> Place {
        let metres = DAffine3::from_scale(DVec3::splat(self.metres));
        let to_file = metres.inverse() * DAffine3::from_translation(centre);
        let to_local = metres * placing.inverse() * to_file;
        let [low, high] = bounds.map(|corner| DVec3::from(corner) * self.metres);
        Place { bounds: (low, high), to_local }
    }

    /// A quantity over a grid's box.
    fn field(&self, at: &JsonPath<'_>, file: &FieldFile, place: &Place) -> Result<Field> {
        Ok(Field::new(self.field_shape(at, file, place.bounds)?, place.bounds, place.to_local))
    }

    fn field_shape(&self, at: &JsonPath<'_>, file: &FieldFile, bounds: (DVec3, DVec3)) -> Result<Shape> {
        let FieldFile { values, resolution, path, constant, exponential, sphere, noise } = file;
        if let (Some(values), Some(resolution)) = (values, resolution) {
            let grid = Grid::new(resolution.map(|cells| cells as usize), values.iter().copied());
            return Ok(Shape::Grid(self.at(&at.key("values"), grid)?));
        }
        if let Some(path) = path {
            let grid = self.source.file(path).and_then(|path| volume_file::read(&path));
            return Ok(Shape::Grid(self.at(&at.key("path"), grid)?));
        }
        if let Some(value) = constant {
            return Ok(Shape::Constant(*value));
        }
        let length = |length: f64| length * self.metres;
        let point = |point: [f64; 3]| DVec3::from(point) * self.metres;
        if let Some(ExponentialFieldFile { value, scale_height, planet }) = *exponential {
            let above = planet.map_or(Ground::Plain(bounds.0.y), |PlanetFile { center, radius }| {
                Ground::Planet(Planet { center: point(center), radius: length(radius) })
            });
            return Ok(Shape::Atmosphere(Atmosphere { value, scale_height: length(scale_height), above }));
        }
        if let Some(SphereFieldFile { value, center, radius, falloff }) = *sphere {
            return Ok(Shape::Ball(Ball { value, center: point(center), radius: length(radius), falloff }));
        }
        if let Some(NoiseFieldFile { value, scale, octaves, threshold, falloff, seed }) = *noise {
            let noise = Noise { value, scale: length(scale), octaves, threshold, falloff, seed };
            return Ok(Shape::Grid(self.at(&at.key("noise"), noise.grid(bounds))?));
        }
        // The file's own check lets no other form through.
        self.at(at, Err(Error::input("found none of the forms of a field")))
    }

    fn phase(&self, at: &JsonPath<'_>, file: &PhaseFile, notes: &mut Vec<String>) -> Result<Phase> {
        match file {
            PhaseFile::Isotropic => Ok(Phase::Isotropic),
            PhaseFile::Rayleigh => Ok(Phase::Rayleigh),
            PhaseFile::HenyeyGreenstein { g } => {
                let g = self.spectrum(&at.key("henyey_greenstein").key("g"), g, Role::MeanCosine)?;
                Ok(Phase::HenyeyGreenstein { g })
            }
            PhaseFile::Table { path } => {
                let table = self.source.file(path).and_then(|path| read_phase_table(&path));
                Ok(Phase::Table(Arc::new(self.at(&at.key("table").key("path"), table)?)))
            }
            PhaseFile::Mie { radius_um, spread, ior } => {
                let at = at.key("mie");
                let index = match ior {
                    Some(file) => self.at(&at.key("ior"), index_of(file, self.source))?,
                    None => Index::catalogue("water 20C")?,
                };
                notes.extend(index.warning().map(|warning| format!("{at}: {warning}")));
                let spheres = Spheres::new(*radius_um, *spread, index);
                Ok(Phase::Table(self.at(&at, spheres.and_then(|spheres| spheres.table()))?))
            }
            PhaseFile::Rainbow => Ok(Phase::Table(phase::rainbow())),
        }
    }
}

/// Reads a phase function's table from a file.
fn read_phase_table(path: &Path) -> Result<PhaseTable> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Error::input(format!("cannot read the phase function: {error}")).in_file(path))?;
    phase::parse_table(&text).map_err(|error| error.in_file(path))
}
