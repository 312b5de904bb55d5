//! The options of a render.

use std::path::PathBuf;
use std::time::Duration;

use abbe_session::render::{Integrator, Request, StopRules};

/// The options of a render. The default options change nothing in the scene.
///
/// A render stops as soon as one of the limits [`passes`](Self::passes), [`time`](Self::time) and
/// [`target_error`](Self::target_error) is reached. If no limit is set, the scene determines the
/// number of passes.
///
/// ```
/// use abbe::{Integrator, RenderOptions};
/// use std::time::Duration;
///
/// let quick = RenderOptions::default().size(320, 180).passes(16);
/// let eight_hours = Duration::from_secs(8 * 3600);
/// let overnight = RenderOptions::default().time(eight_hours).target_error(0.005);
/// let reference = RenderOptions::default().integrator(Integrator::Path).seed(1);
/// # let _ = (quick, overnight, reference);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[must_use]
pub struct RenderOptions {
    pub(super) request: Request,
    pub(super) size: Option<(u32, u32)>,
    pub(super) photons: Option<u64>,
    pub(super) seed: Option<u64>,
    pub(super) threads: Option<u32>,
    pub(super) spectral_bands: Option<u32>,
    pub(super) checkpoint: Option<PathBuf>,
    pub(super) resume: bool,
}

impl RenderOptions {
    fn stop(self, change: impl FnOnce(&mut StopRules)) -> Self {
        let mut request = self.request;
        change(&mut request.stop);
        Self { request, ..self }
    }

    /// Stops after this many passes. The value 0 counts as 1.
    pub fn passes(self, passes: u64) -> Self {
        self.stop(|stop| stop.passes = Some(passes.max(1)))
    }

    /// Stops after the first pass that ends later than this wall-clock time.
    pub fn time(self, time: Duration) -> Self {
        self.stop(|stop| stop.time = Some(time))
    }

    /// Stops when the relative error of the picture falls to this value. 0.02 means 2 %.
    pub fn target_error(self, relative: f64) -> Self {
        self.stop(|stop| stop.target_error = Some(relative))
    }

    /// Selects photon mapping (the default) or the reference path tracer.
    pub fn integrator(self, integrator: Integrator) -> Self {
        Self { request: Request { integrator, ..self.request }, ..self }
    }

    /// Sets the size of the picture in pixels. This size replaces the scene's own size.
    pub fn size(self, width: u32, height: u32) -> Self {
        Self { size: Some((width, height)), ..self }
    }

    /// Sets the number of photon paths in each pass.
    pub fn photons(self, photons: u64) -> Self {
        Self { photons: Some(photons), ..self }
    }

    /// Sets the seed of all random streams. Equal seeds give equal pictures for any number of
    /// threads.
    pub fn seed(self, seed: u64) -> Self {
        Self { seed: Some(seed), ..self }
    }

    /// Sets the number of worker threads. The default is the number of logical processors.
    pub fn threads(self, threads: u32) -> Self {
        Self { threads: Some(threads), ..self }
    }

    /// Divides the range 360–830 nm into this many bands of equal width, and stores the spectrum of
    /// every pixel in these bands.
    pub fn spectral_bands(self, bands: u32) -> Self {
        Self { spectral_bands: Some(bands), ..self }
    }

    /// Saves the exact sums of an unfinished render in this EXR file: about once per minute, and
    /// when the progress callback stops the render. A finished render removes the file. If a
    /// checkpoint cannot be written during the render, the render continues, and the statistics
    /// contain a note.
    pub fn checkpoint(self, path: impl Into<PathBuf>) -> Self {
        Self { checkpoint: Some(path.into()), ..self }
    }

    /// Continues from the file of [`checkpoint`](Self::checkpoint) if this file exists. All limits
    /// count from the beginning of the first run, so the finished picture has the same bits as the
    /// picture of an uninterrupted render.
    pub fn resume(self, resume: bool) -> Self {
        Self { resume, ..self }
    }

    /// Converts the options to changes of the scene's text. Each change has the form `PATH=JSON`.
    pub(super) fn changes(&self) -> Vec<String> {
        let change = |key: &str, value: Option<u64>| value.map(|value| format!("{key}={value}"));
        let (width, height) = self.size.unzip();
        [
            change("film.width", width.map(u64::from)),
            change("film.height", height.map(u64::from)),
            change("film.spectral_bands", self.spectral_bands.map(u64::from)),
            change("render.photons", self.photons),
            change("render.seed", self.seed),
            change("render.threads", self.threads.map(u64::from)),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
