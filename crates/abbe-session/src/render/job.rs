//! A scene that is ready to render.

use super::diffraction::DiffractionSetup;
use super::layers::layer_set;
use abbe_scene::Scene;
use abbe_scene::meter::{Meter, QuantityKind};
use abbe_spectra::error::{Error, Result};
use abbe_transport::emit::LightSampler;
use abbe_transport::gather::{LightSelector, Portals, SensorResponses};
use abbe_transport::map::{MOST_MEDIA, PhotonSpectra};
use abbe_transport::pass::PassContext;
use abbe_transport::plan::{Budget, EffectRow, IndirectPlan, Plan, WavelengthPlan};
use abbe_transport::sensor::{Film, LayerSet, ReadingLayout, ReadingOwner};
use abbe_transport::walk::NEVER_STOP;
use std::sync::Arc;

#[derive(Debug)]
pub struct Job {
    /// The scene without the omitted effects.
    pub scene: Scene,
    pub plan: Plan,
    pub rows: Vec<EffectRow>,
    pub budget: Budget,
    /// The diffraction at the camera's aperture, if the plan contains it.
    pub diffraction: Option<DiffractionSetup>,
    pub layers: LayerSet,
    /// The readings of the film, if the scene has meters.
    pub readings: Option<Arc<ReadingLayout>>,
    lights: LightSampler,
    /// Selects the lights that a point samples, when the shutter opens.
    selector: LightSelector,
    spectra: PhotonSpectra,
}

impl Job {
    /// Plans a scene. Returns an input error if the scene forces or forbids an unknown effect,
    /// forbids a necessary one, has no light between 360 nm and 830 nm, or has too many media.
    pub fn new(scene: Scene) -> Result<Self> {
        Self::with_denoising(scene, false)
    }

    /// Plans a scene whose picture is denoised where that is possible, unless the scene says
    /// otherwise. Returns the errors of [`Job::new`].
    pub fn of_picture(scene: Scene) -> Result<Self> {
        Self::with_denoising(scene, true)
    }

    /// Plans a scene. `by_default` tells whether a scene that says nothing about it is denoised.
    fn with_denoising(mut scene: Scene, by_default: bool) -> Result<Self> {
        if scene.media.len() > MOST_MEDIA {
            let error = Error::input(format!("the scene contains {} media", scene.media.len()));
            return Err(error.expected(format!("at most {MOST_MEDIA}")));
        }
        let (plan, rows) = abbe_transport::plan::prepare(&mut scene)?;
        let lights = LightSampler::new(&scene)
            .ok_or_else(|| Error::input("no light in the scene has power within 360–830 nm"))?;
        let selector = LightSelector::new(&scene, &lights.lights);
        let mut layers = layer_set(&scene)?;
        let spectra = PhotonSpectra::new(&scene, !layers.light_groups.is_empty())?;
        let film = &scene.film;
        let diffraction = DiffractionSetup::of(&scene.camera, &plan, &lights);
        let slices = diffraction.as_ref().map_or(0, DiffractionSetup::slices);
        let [width, height, bands] = [film.width, film.height, film.spectral_bands].map(|count| count as usize);
        let pixels = width.saturating_mul(height);
        let readings = reading_layout(&scene).map(Arc::new);
        let channels = readings.as_ref().map_or(bands, |layout| layout.equivalent_channels(bands));
        layers.denoising = denoises(&scene, slices > 0, by_default)?;
        let film_bytes = Film::memory_bytes(pixels, channels, slices, &layers) as u64;
        if slices > 0 && layers.separates_light() {
            let error = Error::input("the layers `paths` and `lights` do not contain the diffraction at the aperture");
            return Err(error.expected("other layers, or a render that forbids the effect `diffraction`"));
        }
        let budget = Budget::of(&scene, &plan, memory_bytes(film_bytes, pixels as u64, slices > 0));
        Ok(Self { scene, plan, rows, budget, diffraction, layers, readings, lights, selector, spectra })
    }

    /// Returns the power of all lights between 360 nm and 830 nm in W, in closed form.
    pub fn light_power_w(&self) -> f64 {
        self.lights.power_w
    }

    /// Returns how many wavelengths of camera paths behind dispersive glass are worth one that
    /// suits the light whose spectrum is sampled least, or 1 if no camera path is limited to one
    /// wavelength.
    pub(super) fn wavelengths_per_useful_one(&self) -> f64 {
        match self.plan.wavelengths {
            WavelengthPlan::Free => 1.0,
            WavelengthPlan::Shared | WavelengthPlan::Both => self.lights.wavelengths_per_useful_one(&self.scene),
        }
    }

    /// Returns `None` if the film needs the wavelengths, or if no photons are gathered.
    pub(super) fn responses(&self, film: &Film) -> Option<SensorResponses> {
        let unused = film.needs_wavelengths() || self.plan.indirect == IndirectPlan::Absent;
        let observer = self.scene.film.observer;
        if unused { None } else { SensorResponses::new(&self.scene, &self.spectra, |nm| observer.xyz_bar(nm)) }
    }

    pub(super) fn selector(&self) -> &LightSelector {
        &self.selector
    }

    pub(super) fn pass_context(&self) -> PassContext<'_> {
        PassContext {
            scene: &self.scene,
            plan: &self.plan,
            budget: &self.budget,
            lights: &self.lights,
            selector: &self.selector,
            spectra: &self.spectra,
            responses: None,
            portals: Portals::NONE,
            stop: &NEVER_STOP,
        }
    }
}

/// Returns whether the film records what a denoiser needs, or an input error if that is impossible.
fn denoises(scene: &Scene, diffraction: bool, by_default: bool) -> Result<bool> {
    match scene.film.denoise {
        Some(true) if diffraction => {
            let error = Error::input("a denoised picture does not contain the diffraction at the aperture");
            Err(error.expected("no denoising, or a render that forbids the effect `diffraction`"))
        }
        choice => Ok(choice.unwrap_or(by_default) && !diffraction && scene.meters.is_empty()),
    }
}

/// The convolution with the diffraction: five arrays with four complex numbers for each pixel.
const CONVOLUTION_BYTES_PER_PIXEL: u64 = 5 * 64;

/// The pilot: the kernel radii, the visible points, and the photons in media. They are free again
/// when the film is allocated.
const PILOT_BYTES_PER_PIXEL: u64 = 250;

/// The pilot's results and a preview: the kernel radii, the surface extents, the display codes, and
/// free memory that the allocator keeps.
const PASS_BYTES_PER_PIXEL: u64 = 64;

/// Returns the largest memory of a render. Its picture has at most a quarter of the film's bytes.
fn memory_bytes(film_bytes: u64, pixels: u64, diffraction: bool) -> u64 {
    let convolution = if diffraction { CONVOLUTION_BYTES_PER_PIXEL } else { 0 };
    let others = pixels.saturating_mul(PASS_BYTES_PER_PIXEL + convolution);
    let passes = film_bytes.saturating_add(film_bytes / 4).saturating_add(others);
    passes.max(pixels.saturating_mul(PILOT_BYTES_PER_PIXEL))
}

/// Returns the readings of the scene's meters, or `None` if the scene has a picture.
fn reading_layout(scene: &Scene) -> Option<ReadingLayout> {
    let owners = |(meter, data): (usize, &Meter)| {
        let observer = data.quantity.observer();
        let decides_stop = data.decides_stop;
        std::iter::repeat_n(ReadingOwner { meter, observer, decides_stop }, data.readings.len())
    };
    let readings: Vec<ReadingOwner> = scene.meters.iter().enumerate().flat_map(owners).collect();
    let moments = scene.meters.iter().any(|meter| meter.quantity.kind() == QuantityKind::OfSpectrum);
    (!readings.is_empty()).then(|| ReadingLayout {
        rows: scene.camera.pixel_count() / readings.len(),
        readings,
        moments,
    })
}
