//! Image sequences: the frames, their changes of the scene and their file names.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use abbe_spectra::error::{Error, Result};

use super::values::{self, Sweep};

#[derive(Debug, Clone, clap::Args)]
#[command(group = clap::ArgGroup::new("sequence").args(["frames", "sweep"]))]
pub(crate) struct SequenceArgs {
    /// Render these frames of an image sequence, both ends included, such as 1..48, and an animated
    /// PNG. The frame's number replaces `####` in the output's name. The shutter of frame k opens
    /// at (k − 1)/fps seconds
    #[arg(long, value_name = "A..B", value_parser = values::frames, conflicts_with = "part")]
    frames: Option<RangeInclusive<u32>>,
    /// Render a picture for each of N values of a setting, from A to B, both included, such as
    /// lights.beam.power=1..5:9, and an animated PNG. The picture's number replaces `####`
    #[arg(long, value_name = "PATH=A..B:N", value_parser = values::sweep, conflicts_with = "part")]
    sweep: Option<Sweep>,
    /// The number of frames per second, also in the animated PNG
    #[arg(long, value_name = "N", value_parser = values::rate, default_value = "24", requires = "sequence")]
    pub(crate) fps: f64,
    /// The shutter angle in degrees: at 360 the shutter is open during the whole frame, at 0 for an
    /// instant
    #[arg(long, value_name = "DEG", value_parser = values::shutter_angle, default_value = "180", requires = "frames")]
    shutter_angle: f64,
}

/// A frame of an image sequence, or a picture of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SequenceFrame {
    number: u32,
    last: u32,
    /// The changes of the scene in the form `PATH=JSON`.
    patches: Vec<String>,
}

impl SequenceArgs {
    /// The frames in order, or `None` for a single picture. The changes of a frame of a sequence
    /// leave the transmission curve of the shutter.
    pub(crate) fn frames(&self) -> Option<Vec<SequenceFrame>> {
        if let Some(Sweep { key, from, to, count }) = &self.sweep {
            let picture = |number: u32| {
                let value = from + (to - from) * f64::from(number - 1) / f64::from(count - 1);
                SequenceFrame { number, last: *count, patches: vec![format!("{key}={value:?}")] }
            };
            return Some((1..=*count).map(picture).collect());
        }
        let frames = self.frames.clone()?;
        let last = *frames.end();
        let frame = |number: u32| {
            let open_s = f64::from(number - 1) / self.fps;
            let close_s = open_s + self.shutter_angle / 360.0 / self.fps;
            let patches = vec![format!("camera.shutter.open={open_s:?}"), format!("camera.shutter.close={close_s:?}")];
            SequenceFrame { number, last, patches }
        };
        Some(frames.map(frame).collect())
    }
}

/// Returns the name of the animated PNG: the word replaces the number in the names of the frames.
pub(crate) fn animation(pattern: &Path) -> PathBuf {
    let name = pattern.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let start = name.find('#').unwrap_or(name.len());
    let name = format!("{}animation{}", &name[..start], name[start..].trim_start_matches('#'));
    pattern.with_file_name(name).with_extension("png")
}

impl SequenceFrame {
    pub(crate) fn patches(&self) -> &[String] {
        &self.patches
    }

    pub(crate) fn label(&self) -> String {
        format!("frame {} of {}", self.number, self.last)
    }

    /// Returns the file name for this frame, whose number replaces the group of `#` signs in
    /// `pattern`. Returns an error if there is no group, or several.
    pub(crate) fn name(&self, pattern: &Path) -> Result<PathBuf> {
        let wrong = |what: &str| {
            let what = format!("the file name {} {what}", pattern.display());
            Error::input(what).expected("one group of # for the frame's number, such as out/####.exr")
        };
        let name = pattern.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let start = name.find('#').ok_or_else(|| wrong("has no # for the frame's number"))?;
        let rest = name[start..].trim_start_matches('#');
        if rest.contains('#') {
            return Err(wrong("has several groups of #"));
        }
        let width = name.len() - start - rest.len();
        Ok(pattern.with_file_name(format!("{}{:0width$}{rest}", &name[..start], self.number)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sequence(frames: RangeInclusive<u32>, fps: f64, shutter_angle: f64) -> Vec<SequenceFrame> {
        SequenceArgs { frames: Some(frames), sweep: None, fps, shutter_angle }.frames().unwrap()
    }

    fn frame(number: u32) -> SequenceFrame {
        sequence(number..=number.max(48), 24.0, 180.0).swap_remove(0)
    }

    #[test]
    fn a_shutter_angle_of_180_exposes_half_of_the_frame() {
        assert_eq!((frame(1).number, frame(1).last), (1, 48));
        assert_eq!(frame(25).patches(), ["camera.shutter.open=1.0", "camera.shutter.close=1.0208333333333333"]);
        let frames = sequence(3..=5, 8.0, 360.0);
        assert_eq!(frames.len(), 3);
        let time = |patch: &str| patch.split_once('=').unwrap().1.parse::<f64>().unwrap();
        let meet = |pair: &[SequenceFrame]| time(&pair[0].patches[1]) == time(&pair[1].patches[0]);
        assert!(frames.windows(2).all(meet), "without gaps");
    }

    #[test]
    fn a_sweep_includes_both_ends() {
        let sweep = Some(values::sweep("a.b=1..2:5").unwrap());
        let arguments = SequenceArgs { frames: None, sweep, fps: 24.0, shutter_angle: 180.0 };
        let frames = arguments.frames().unwrap();
        let patches: Vec<&String> = frames.iter().flat_map(SequenceFrame::patches).collect();
        assert_eq!(patches, ["a.b=1.0", "a.b=1.25", "a.b=1.5", "a.b=1.75", "a.b=2.0"]);
        for wrong in ["a.b", "a.b=1..2", "=1..2:3", "a=1..2:1", "a=1..x:3", "a=1:3"] {
            assert!(values::sweep(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_animation_has_the_name_of_the_frames() {
        assert_eq!(animation(Path::new("out/####.exr")), Path::new("out/animation.png"));
        assert_eq!(animation(Path::new("ball-##.exr")), Path::new("ball-animation.png"));
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
