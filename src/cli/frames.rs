//! Image sequences: which frames, when each frame's shutter is open, and what its files are called.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use abbe::error::{Error, Result};

use super::values;

#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Sequence {
    /// Render these frames of an image sequence, both ends included, such as 1..48; `####` in the output's name becomes the frame's
    /// number. Frame 1 opens its shutter at 0 s, frame k at (k − 1)/fps
    #[arg(long, value_name = "A..B", value_parser = values::frames, conflicts_with = "part")]
    frames: Option<RangeInclusive<u32>>,
    /// Frames per second
    #[arg(long, value_name = "N", value_parser = values::rate, default_value = "24", requires = "frames")]
    fps: f64,
    /// How much of a frame's time the shutter is open, in degrees: 360 is all of it, 0 a moment
    #[arg(long, value_name = "DEG", value_parser = values::shutter_angle, default_value = "180", requires = "frames")]
    shutter_angle: f64,
}

/// One frame of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    number: u32,
    last: u32,
    /// When its shutter opens and closes, in s.
    open_s: f64,
    close_s: f64,
}

impl Sequence {
    /// The frames, in their order; `None` for a single picture.
    pub(crate) fn frames(&self) -> Option<impl Iterator<Item = Frame>> {
        let frames = self.frames.clone()?;
        let last = *frames.end();
        Some(frames.map(move |number| {
            let open_s = f64::from(number - 1) / self.fps;
            Frame { number, last, open_s, close_s: open_s + self.shutter_angle / 360.0 / self.fps }
        }))
    }
}

impl Frame {
    /// How the scene is changed for this frame; the shutter's curve stays.
    pub(crate) fn patches(&self) -> [String; 2] {
        let Self { open_s, close_s, .. } = self;
        [format!("camera.shutter.open={open_s:?}"), format!("camera.shutter.close={close_s:?}")]
    }

    /// What progress calls it.
    pub(crate) fn label(&self) -> String {
        format!("frame {} of {}", self.number, self.last)
    }

    /// The name of one of the frame's files: the signs `#` of the pattern's file name stand for the digits of the frame's number.
    ///
    /// # Errors
    /// The input's: no `#`, or several groups of them.
    pub(crate) fn name(&self, pattern: &Path) -> Result<PathBuf> {
        let wrong = |what: &str| {
            let what = format!("the name {} {what}", pattern.display());
            Error::input(what).expected("one group of # for the frame's number, such as out/####.exr")
        };
        let name = pattern.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let start = name.find('#').ok_or_else(|| wrong("has no place for the frame's number"))?;
        let rest = name[start..].trim_start_matches('#');
        if rest.contains('#') {
            return Err(wrong("has several places for the frame's number"));
        }
        let width = name.len() - start - rest.len();
        Ok(pattern.with_file_name(format!("{}{:0width$}{rest}", &name[..start], self.number)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(number: u32) -> Frame {
        let sequence = Sequence { frames: Some(number..=number.max(48)), fps: 24.0, shutter_angle: 180.0 };
        sequence.frames().unwrap().next().unwrap()
    }

    #[test]
    fn half_a_frames_time_is_exposed_from_its_start() {
        assert_eq!(frame(1), Frame { number: 1, last: 48, open_s: 0.0, close_s: 1.0 / 48.0 });
        let [open, close] = frame(25).patches();
        assert_eq!(
            (open.as_str(), close.as_str()),
            ("camera.shutter.open=1.0", "camera.shutter.close=1.0208333333333333")
        );
        let whole = Sequence { frames: Some(3..=5), fps: 10.0, shutter_angle: 360.0 };
        let frames: Vec<Frame> = whole.frames().unwrap().collect();
        assert_eq!(frames.len(), 3);
        assert!(frames.windows(2).all(|pair| (pair[0].close_s - pair[1].open_s).abs() < 1e-12), "without gaps");
    }

    #[test]
    fn numbers_fill_the_pattern() {
        let name = |pattern: &str| frame(7).name(Path::new(pattern)).map(|name| name.display().to_string());
        assert_eq!(name("out/####.exr").unwrap(), "out/0007.exr");
        assert_eq!(name("a.#.exr").unwrap(), "a.7.exr");
        assert_eq!(frame(12345).name(Path::new("##.exr")).unwrap(), Path::new("12345.exr"));
        for wrong in ["out/a.exr", "#/a.exr", "#a#.exr"] {
            assert_eq!(name(wrong).unwrap_err().exit_status(), 2, "{wrong}");
        }
    }
}
