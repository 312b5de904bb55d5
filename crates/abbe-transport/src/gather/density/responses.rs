//! The responses of the sensor to photons at diffuse surfaces.
//!
//! A camera path without wavelength-dependent factors sees a diffuse surface directly. The response
//! of the sensor to a photon there is the sum over the photon's wavelengths of power × reflectance
//! / π × sensitivity. All factors except the power depend only on the surface, the spectrum of the
//! light and the random number that selected the wavelengths, so they are tabulated once and a
//! gathered photon costs a few multiplications.
//!
//! At a fluorescent surface, the response also contains the emission that the photon excites, by a
//! single integral over the emission spectrum.

use crate::map::{PhotonPower, PhotonSpectra, WavelengthCode};
use crate::walk::SurfaceInteraction;
use abbe_optics::bsdf::{Bsdf, Fluorescent};
use abbe_scene::Scene;
use abbe_spectra::spectrum::{BAND_NM, LANES, Spectrum};
use std::f64::consts::FRAC_1_PI;
use wide::f32x4;

/// The number of cells of the random numbers. A response is the mean over its cell. A table then
/// fits in the first-level cache.
const CELLS: usize = 256;

/// The number of wavelengths of each lane over which the response of a cell is averaged.
const SAMPLES_PER_CELL: usize = 4;

/// The largest number of tables. Scenes that need more evaluate each wavelength of each photon.
const MOST_TABLES: usize = 256;

/// The responses of the sensor to a power of 1 in each lane. The fourth component is 0.
type Cell = [f32x4; LANES];

/// A table of responses for each uniform diffuse material and each spectrum of the lights.
#[derive(Debug, Clone)]
pub struct SensorResponses {
    cells: Vec<Cell>,
    /// For each material, the position of its first cell.
    first_cells: Vec<Option<usize>>,
    cells_per_material: usize,
}

#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct SurfaceResponses<'r>(&'r [Cell]);

impl SensorResponses {
    /// Tabulates the responses of a scene, by the `sensitivity` of the sensor to a wavelength (nm).
    /// Returns `None` if no material is diffuse and uniform, or if the tables need too much memory.
    pub fn new(scene: &Scene, spectra: &PhotonSpectra, sensitivity: impl Fn(f64) -> [f64; 3]) -> Option<Self> {
        let diffuse = |surface: &Bsdf| {
            if let Bsdf::Diffuse(diffuse) = surface {
                return diffuse.reflectance().uniform().cloned().map(TabulatedSurface::Diffuse);
            }
            surface.as_fluorescent().map(|surface| TabulatedSurface::fluorescent(surface, &sensitivity))
        };
        let materials: Vec<Option<TabulatedSurface>> =
            scene.materials.iter().map(|material| diffuse(&material.surface)).collect();
        let tables = materials.iter().flatten().count() * spectra.different();
        if tables == 0 || tables > MOST_TABLES {
            return None;
        }
        let sampled: Vec<CellSamples> = (0..spectra.len() * CELLS)
            .map(|cell| CellSamples::new(spectra, cell / CELLS, cell % CELLS, &sensitivity))
            .collect();
        let mut cells = Vec::with_capacity(tables * CELLS);
        let first_cells = materials.iter().map(|material| {
            material.as_ref().map(|surface| {
                cells.extend(sampled.iter().map(|samples| samples.returned_by(surface)));
                cells.len() - sampled.len()
            })
        });
        Some(Self { first_cells: first_cells.collect(), cells_per_material: sampled.len(), cells })
    }

    /// Returns `None` if the surface is not diffuse and uniform, or if its normal is interpolated.
    #[inline]
    pub(in crate::gather) fn of_surface(&self, interaction: &SurfaceInteraction<'_>) -> Option<SurfaceResponses<'_>> {
        let first = self.first_cells[interaction.material]?;
        (!interaction.frame.is_folded()).then(|| SurfaceResponses(&self.cells[first..first + self.cells_per_material]))
    }
}

impl SurfaceResponses<'_> {
    /// Returns the response of the sensor to a photon that the surface reflects.
    #[inline(always)]
    pub(in crate::gather) fn of_photon(self, photon: &PhotonPower) -> [f64; 3] {
        let cell = &self.0[photon.wavelength_code().cell(CELLS)];
        let powers = photon.powers();
        let lane = |k: usize| cell[k] * f32x4::splat(powers[k]);
        let [x, y, z, _] = ((lane(0) + lane(1)) + (lane(2) + lane(3))).to_array();
        [f64::from(x), f64::from(y), f64::from(z)]
    }
}

/// The wavelengths (nm) of a cell and the sensitivities of the sensor, for each lane.
struct CellSamples([[(f64, [f64; 3]); SAMPLES_PER_CELL]; LANES]);

impl CellSamples {
    fn new(spectra: &PhotonSpectra, spectrum: usize, cell: usize, sensitivity: &impl Fn(f64) -> [f64; 3]) -> Self {
        let u = |sample: usize| (cell as f64 + (sample as f64 + 0.5) / SAMPLES_PER_CELL as f64) / CELLS as f64;
        let sampled = |lane: usize, sample: usize| {
            let nm = spectra.wavelength_at(spectrum, u(sample), lane);
            (nm, sensitivity(nm))
        };
        Self(std::array::from_fn(|lane| std::array::from_fn(|sample| sampled(lane, sample))))
    }

    fn returned_by(&self, surface: &TabulatedSurface) -> Cell {
        self.0.each_ref().map(|samples| {
            let mut mean = [0.0; 4];
            for (nm, sensitivity) in samples {
                let response = surface.response(*nm, *sensitivity);
                (0..3).for_each(|component| mean[component] += response[component] / SAMPLES_PER_CELL as f64);
            }
            f32x4::from(mean.map(|component| component as f32))
        })
    }
}

enum TabulatedSurface {
    Diffuse(Spectrum),
    Fluorescent {
        surface: Box<Fluorescent>,
        /// For each emission, the response of the sensor for an excitation of 1 W·nm/m².
        emissions: Vec<[f64; 3]>,
    },
}

impl TabulatedSurface {
    fn fluorescent(surface: &Fluorescent, sensitivity: &impl Fn(f64) -> [f64; 3]) -> Self {
        /// The number of samples per nm of the integral over the emission.
        const SAMPLES_PER_NM: f64 = 4.0;
        let mut emissions = vec![[0.0; 3]; surface.fluorophore.emissions().len()];
        for sample in 0..((BAND_NM.1 - BAND_NM.0) * SAMPLES_PER_NM) as usize {
            let nm = BAND_NM.0 + (sample as f64 + 0.5) / SAMPLES_PER_NM;
            let sensitivity = sensitivity(nm);
            for (emission, response) in surface.fluorophore.emissions().iter().zip(&mut emissions) {
                let radiance = emission.emitted(nm) * FRAC_1_PI / SAMPLES_PER_NM;
                (0..3).for_each(|component| response[component] += sensitivity[component] * radiance);
            }
        }
        Self::Fluorescent { surface: Box::new(surface.clone()), emissions }
    }

    /// Returns the response for a power of 1 at the wavelength `nm`, with its `sensitivity`.
    fn response(&self, nm: f64, sensitivity: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Diffuse(reflectance) => {
                let factor = reflectance.at(nm) * FRAC_1_PI;
                sensitivity.map(|value| value * factor)
            }
            Self::Fluorescent { surface, emissions } => {
                let factor = surface.reflected_fraction(nm) * FRAC_1_PI;
                let mut response = sensitivity.map(|value| value * factor);
                for i in surface.fluorophore.excited_by(nm) {
                    let excitation = surface.fluorophore.emissions()[i].excitation(nm);
                    (0..3).for_each(|component| response[component] += emissions[i][component] * excitation);
                }
                response
            }
        }
    }
}

const _: () = assert!(WavelengthCode::QUANTILES.is_multiple_of(CELLS));
