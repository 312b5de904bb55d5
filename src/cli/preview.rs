//! The preview of a running render: from time to time, its EXR and PNG files are refreshed, and a
//! display server receives the picture.

use std::path::Path;
use std::time::{Duration, Instant};

use abbe_session::output::Metadata;
use abbe_session::output::exr::write_uncompressed;
use abbe_session::output::metadata::names;
use abbe_session::output::tev::TevImage;
use abbe_session::render::{DisplaySettings, Run};
use abbe_spectra::error::Result;
use abbe_transport::sensor::Picture;

use super::display_server::DisplayServer;
use super::outputs::OutputFiles;
use super::print;

/// The time before the first preview.
const FIRST: Duration = Duration::from_millis(250);

/// The pause after the first preview is at least this long.
const FIRST_PAUSE: Duration = Duration::from_secs(1);

/// The pause between two previews grows by at least this factor.
const GROWTH: f64 = 1.5;

/// The largest fraction of the render's time that previews take.
const LARGEST_FRACTION: f64 = 0.03;

/// Writes the picture of a running render to its output files, and sends it to a display server.
#[derive(Debug)]
pub(crate) struct Preview<'a> {
    outputs: &'a OutputFiles,
    metadata: Metadata,
    display: DisplaySettings,
    server: Option<&'a DisplayServer>,
    schedule: PreviewSchedule,
    has_failed: bool,
}

impl<'a> Preview<'a> {
    /// Creates a preview in these files and on a display server, if given. `of_scene` holds the
    /// header entries of the scene.
    pub(crate) fn new(
        outputs: &'a OutputFiles,
        of_scene: &Metadata,
        display: DisplaySettings,
        server: Option<&'a DisplayServer>,
    ) -> Self {
        let metadata = of_scene.clone().with(names::PREVIEW, "true");
        Self { outputs, metadata, display, server, schedule: PreviewSchedule::new(), has_failed: false }
    }

    /// Shows the picture if a preview is due.
    pub(crate) fn update(&mut self, start: Instant, run: &Run) {
        let elapsed = start.elapsed();
        if self.schedule.is_due(elapsed) && self.is_possible() {
            self.show(&run.picture(), run.passes());
            self.schedule.written(elapsed, start.elapsed());
        }
    }

    /// Returns true if there is a display server, or if the output files can be replaced.
    pub(crate) fn is_possible(&self) -> bool {
        self.server.is_some() || self.outputs.can_be_refreshed()
    }

    /// Sends the picture to the display server, and writes the files. A failure is reported once.
    pub(crate) fn show(&mut self, picture: &Picture, passes: u64) {
        self.send(picture);
        if self.outputs.can_be_refreshed()
            && let Err(error) = self.write(picture, passes)
            && !self.has_failed
        {
            self.has_failed = true;
            print::remark(&format!("warning: the preview cannot be written: {error}; the render continues"));
        }
    }

    pub(crate) fn send(&self, picture: &Picture) {
        if let Some(server) = self.server {
            let exposure = self.display.factor(picture);
            server.show(TevImage::new(&self.outputs.name(), picture, exposure, &self.display.development));
        }
    }

    fn write(&self, picture: &Picture, passes: u64) -> Result<()> {
        let metadata = self.metadata.clone().with(names::PASSES, &passes.to_string());
        let write = |path: &Path| write_uncompressed(path, picture, &metadata);
        self.outputs.save_pictures(write, picture, &self.display).map(drop)
    }
}

#[derive(Debug, Clone, Copy)]
struct PreviewSchedule {
    next: Duration,
    /// The time that all previews have taken.
    spent: Duration,
    pause: Duration,
}

impl PreviewSchedule {
    fn new() -> Self {
        Self { next: FIRST, spent: Duration::ZERO, pause: FIRST_PAUSE }
    }

    fn is_due(&self, elapsed: Duration) -> bool {
        elapsed >= self.next
    }

    /// Notes a preview that took the time from `begin` to `end`. The next preview is due when all
    /// previews together, and another one as long as this one, take at most [`LARGEST_FRACTION`] of
    /// the time.
    fn written(&mut self, begin: Duration, end: Duration) {
        let cost = end - begin;
        self.spent += cost;
        let affordable = (self.spent + cost).div_f64(LARGEST_FRACTION).saturating_sub(end);
        self.pause = self.pause.mul_f64(GROWTH).max(affordable);
        self.next = end + self.pause;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn previews_come_soon_and_take_little_time() {
        for cost_s in [0.001, 0.05, 2.0] {
            let (mut schedule, mut elapsed, mut spent, mut written) = (PreviewSchedule::new(), 0.0, 0.0, Vec::new());
            while elapsed < 3600.0 {
                elapsed += 0.1;
                if schedule.is_due(Duration::from_secs_f64(elapsed)) {
                    let end = elapsed + cost_s;
                    schedule.written(Duration::from_secs_f64(elapsed), Duration::from_secs_f64(end));
                    written.push(elapsed);
                    (spent, elapsed) = (spent + cost_s, end);
                    assert!(written.len() == 1 || spent <= 0.0301 * elapsed, "{spent} of {elapsed} s");
                }
            }
            assert!((0.24..0.45).contains(&written[0]), "{written:?}");
            assert!(written.windows(3).all(|t| t[2] - t[1] > t[1] - t[0]), "{written:?}");
            assert!(written.len() > 3, "{written:?}");
        }
    }
}
