//! A published picture.

use super::layers;
use super::loaded_scene::LoadedScene;
use super::scene_panels::ScenePanels;
use crate::api::provenance;
use abbe_session::output::Metadata;
#[cfg(feature = "view")]
use abbe_session::output::metadata::names;
use abbe_session::render::{CoarsePicture, LedgerStats, Run, StageSeconds};
use abbe_transport::plan::EffectState;
use abbe_transport::sensor::{Picture, bloom, exposure};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

/// A picture that a render shows: a coarse one before the first pass, or that of some passes.
#[derive(Debug)]
pub(crate) enum Shown<'a> {
    Coarse(CoarsePicture),
    Passes(Picture, &'a Run),
}

/// A picture that the page can show. It never changes.
#[derive(Debug)]
pub(crate) struct Snapshot {
    pub(crate) number: u64,
    /// The name of the scene file or of the picture file.
    pub(crate) name: String,
    pub(crate) scene: Arc<ScenePanels>,
    pub(crate) passes: u64,
    /// The width and the height in pixels, and the number of photons, of a coarse picture.
    coarse: Option<([usize; 2], u64)>,
    pub(crate) picture: Picture,
    /// The exposure of the scene's settings in 1/(cd/m²).
    pub(crate) exposure: f64,
    /// The reach of the chroma compression in each colour space of the page.
    pub(crate) reaches: Value,
    /// The forbidden effects.
    pub(crate) without: Vec<&'static str>,
    /// The mean Y of each path class in cd/m², if the picture separates them.
    pub(crate) class_means: Vec<f64>,
    /// The time of the stages and the energy balance of the render. `None` for a coarse picture.
    pub(crate) effort: Option<(StageSeconds, LedgerStats)>,
    /// The noise of the bands, if several pictures of the render were published.
    pub(crate) band_noise: Option<BandNoise>,
    pub(crate) events: BTreeMap<String, u64>,
    /// The header of the picture's file, or `None` for a coarse picture.
    pub(crate) metadata: Option<Metadata>,
    /// The mean Y in cd/m².
    pub(crate) mean_y: f64,
    /// The exposure at which `abbe compare` compares with this picture, in 1/(cd/m²).
    pub(crate) comparison_exposure: OnceLock<f64>,
}

impl Snapshot {
    /// A picture of a render. `last` is the picture before it in the same render.
    pub(crate) fn of_render(
        number: u64,
        (loaded, scene): (&LoadedScene, Arc<ScenePanels>),
        shown: Shown<'_>,
        last: Option<&Self>,
    ) -> Self {
        let job = &loaded.job;
        let (picture, coarse, run) = match shown {
            Shown::Coarse(coarse) => (coarse.enlarged(), Some(coarse), None),
            Shown::Passes(picture, run) => (picture, None, Some(run)),
        };
        // A small picture is measured sooner.
        let metered = coarse.as_ref().map_or(&picture, |coarse| &coarse.picture);
        let (exposure, reaches) = (scene.display.factor(metered), scene.reaches(metered));
        let metadata = run.map(|run| {
            let of_scene = &loaded.metadata;
            let metadata = provenance::of_passes(of_scene, run.passes(), &run.ledger_stats(job), run.seconds());
            provenance::reproducible(metadata)
        });
        let events = run.map(|run| run.effect_stats(job)).unwrap_or_default();
        let passes = run.map_or(0, Run::passes);
        let forbidden = job.rows.iter().filter(|row| row.state == EffectState::Forbidden);
        Self {
            number,
            name: loaded.source.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            passes,
            coarse: coarse.map(|coarse| ([coarse.picture.width, coarse.picture.height], coarse.photons)),
            exposure,
            reaches,
            band_noise: band_noise(&picture, passes, last),
            without: forbidden.map(|row| row.effect.name).collect(),
            mean_y: picture.mean_y(),
            comparison_exposure: OnceLock::new(),
            class_means: layers::class_means(&picture),
            effort: run.map(|run| (run.stage_seconds(), run.ledger_stats(job))),
            events: events.into_iter().map(|(name, effect)| (name, effect.events)).collect(),
            metadata,
            scene,
            picture,
        }
    }

    #[cfg(feature = "view")]
    pub(crate) fn of_file(
        number: u64,
        name: &str,
        scene: Arc<ScenePanels>,
        picture: Picture,
        metadata: Metadata,
    ) -> Self {
        Self {
            number,
            name: name.to_string(),
            passes: metadata.get(names::PASSES).and_then(|passes| passes.parse().ok()).unwrap_or(0),
            coarse: None,
            exposure: scene.display.factor(&picture),
            reaches: scene.reaches(&picture),
            class_means: layers::class_means(&picture),
            without: Vec::new(),
            effort: None,
            mean_y: picture.mean_y(),
            comparison_exposure: OnceLock::new(),
            scene,
            picture,
            band_noise: None,
            events: BTreeMap::new(),
            metadata: Some(metadata),
        }
    }

    /// Returns the numbers of the page for a reference, at the exposure of `abbe compare`.
    pub(crate) fn reference_summary(&self) -> Value {
        json!({
            "number": self.number,
            "name": self.name,
            "width": self.picture.width,
            "height": self.picture.height,
            "passes": self.passes,
            "exposure": self.comparison_exposure.get_or_init(|| exposure::automatic(&self.picture)),
            "reaches": self.reaches,
            "without": self.without,
            "mean_y": self.mean_y,
            "pass_seconds": self.pass_seconds(),
        })
    }

    /// Returns the numbers that the page needs with each picture.
    pub(crate) fn summary(&self) -> Value {
        json!({
            "number": self.number,
            "name": self.name,
            "scene": self.scene.number,
            "width": self.picture.width,
            "height": self.picture.height,
            "passes": self.passes,
            "coarse": self.coarse.map(|(size, photons)| json!({"size": size, "photons": photons})),
            "exposure": self.exposure,
            "reaches": self.reaches,
            "events": self.events,
            "without": self.without,
            "mean_y": self.mean_y,
            "pass_seconds": self.pass_seconds(),
            "seconds": self.effort.as_ref().map(|(seconds, _)| seconds),
            "ledger_w": self.effort.as_ref().map(|(_, ledger)| ledger),
            "classes": self.class_means,
            "denoised": self.scene.display.shows_denoised(&self.picture),
            "samples": layers::samples(&self.picture).is_some(),
            "stokes": layers::degree(&self.picture).is_some(),
        })
    }

    /// Returns the mean time of a pass in s, without the pilot.
    fn pass_seconds(&self) -> Option<f64> {
        let (StageSeconds { pose, emit, map, gather, .. }, _) = self.effort.as_ref()?;
        (self.passes > 0).then(|| (pose + emit + map + gather) / self.passes as f64)
    }

    /// Returns the number of camera samples of all pixels. Returns `None` if it was not recorded.
    pub(crate) fn samples(&self) -> Option<Vec<u8>> {
        layers::samples(&self.picture).map(|samples| float_bytes(samples.iter().copied()))
    }

    /// Returns S0 to S3 of Y at each pixel in cd/m², in the frame of the picture, if they were
    /// recorded.
    pub(crate) fn stokes(&self) -> Option<Vec<u8>> {
        layers::stokes(&self.picture).map(|stokes| float_bytes(stokes.into_iter().flatten()))
    }

    /// Returns the degree of polarisation at all pixels, if it was recorded.
    pub(crate) fn degree(&self) -> Option<Vec<u8>> {
        layers::degree(&self.picture).map(|degrees| float_bytes(degrees.iter().copied()))
    }

    /// Returns Y of each path class at all pixels in cd/m², if the picture separates them.
    pub(crate) fn classes(&self) -> Option<Vec<u8>> {
        layers::class_luminance(&self.picture).map(|classes| float_bytes(classes.into_iter().flatten()))
    }

    /// Returns X, Y and Z of all pixels as 32-bit floating-point numbers.
    pub(crate) fn xyz(&self) -> Vec<u8> {
        float_bytes(self.picture.xyz.iter().flatten().map(|&value| value as f32))
    }

    /// Returns X, Y and Z of all pixels of the denoised picture, if there is one.
    pub(crate) fn denoised(&self) -> Option<Vec<u8>> {
        let denoised = self.picture.denoised.as_ref()?;
        Some(float_bytes(denoised.xyz.iter().flatten().map(|&value| value as f32)))
    }

    /// Returns X, Y and Z of all pixels with the bloom of the scene, if it has one, of the picture
    /// or of the denoised picture.
    pub(crate) fn bloomed(&self, denoised: bool) -> Option<Vec<u8>> {
        let eye = self.scene.display.development.bloom?;
        let denoised = if denoised { self.picture.denoised() } else { None };
        let xyz = bloom::apply(&eye, denoised.as_ref().unwrap_or(&self.picture));
        Some(float_bytes(xyz.into_iter().flatten().map(|value| value as f32)))
    }

    /// Returns the noise and the bias of all pixels in cd/m², and NaN if they are unknown.
    pub(crate) fn errors(&self) -> Vec<u8> {
        let pairs = self.picture.noise.iter().zip(&self.picture.bias);
        float_bytes(pairs.flat_map(|(noise, bias)| [noise, bias].map(|value| value.unwrap_or(f32::NAN))))
    }

    /// Returns the spectral radiance of a band at all pixels in W/m²/sr/nm, if the picture has it.
    pub(crate) fn band(&self, band: usize) -> Option<Vec<u8>> {
        let bands = self.picture.bands.as_ref()?;
        let count = bands.centres_nm.len();
        (band < count).then(|| float_bytes(bands.values.iter().skip(band).step_by(count).copied()))
    }
}

pub(crate) fn float_bytes(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}

fn band_noise(picture: &Picture, passes: u64, last: Option<&Snapshot>) -> Option<BandNoise> {
    let after = &picture.bands.as_ref()?.values;
    match last.and_then(|last| Some((last.band_noise.as_ref()?, last.picture.bands.as_ref()?))) {
        Some((noise, before)) => Some(noise.next(&before.values, after, passes)),
        None => Some(BandNoise::first(passes, after.len())),
    }
}

/// The noise of spectral bands, by the method of batch means: the passes between two pictures of a
/// render are a batch, and the variance of a pass is the sum of the squared deviations of the batch
/// means, weighted by their passes, divided by the number of batches minus 1.
#[derive(Debug, Clone)]
pub(crate) struct BandNoise {
    batches: u32,
    passes: u64,
    /// The sums of the weighted squared deviations, pixel by pixel and band by band.
    squares: Vec<f32>,
}

impl BandNoise {
    /// Returns the noise after the first picture of a render.
    pub(crate) fn first(passes: u64, values: usize) -> Self {
        Self { batches: 1, passes, squares: vec![0.0; values] }
    }

    /// Returns the noise after another picture, from the means before and after it.
    pub(crate) fn next(&self, before: &[f32], after: &[f32], passes: u64) -> Self {
        let (first, second) = (self.passes as f32, (passes - self.passes) as f32);
        let weight = first * passes as f32 / second;
        let deviations = after.iter().zip(before).map(|(after, before)| after - before);
        let squares = self.squares.iter().zip(deviations).map(|(sum, step)| sum + weight * step * step).collect();
        Self { batches: self.batches + 1, passes, squares }
    }

    /// Returns the standard error of a value, or `None` if there are too few batches.
    pub(crate) fn at(&self, index: usize) -> Option<f64> {
        const LEAST_BATCHES: u32 = 3;
        let freedom = f64::from(self.batches - 1) * self.passes as f64;
        (self.batches >= LEAST_BATCHES).then(|| (f64::from(self.squares[index]) / freedom).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Batches of 1, 2 and 3 passes with the means 1, 4 and 3 have the weighted mean 3 and the
    /// weighted squared deviations 4 + 2 + 0 = 6.
    #[test]
    fn band_noise_is_the_noise_of_batch_means() {
        let means = [1.0, (1.0 + 2.0 * 4.0) / 3.0, (1.0 + 2.0 * 4.0 + 3.0 * 3.0) / 6.0];
        let noise = BandNoise::first(1, 1);
        assert_eq!(noise.at(0), None);
        let noise = noise.next(&means[..1], &means[1..2], 3).next(&means[1..2], &means[2..], 6);
        let expected = (6.0_f64 / (2.0 * 6.0)).sqrt();
        assert!((noise.at(0).unwrap() - expected).abs() < 1e-6, "{:?}", noise.at(0));
    }
}
