//! Samples of EXR channels that are computed line by line while a file is written.

use ::exr::block::lines::LineRefMut;
use ::exr::image::write::samples::{SamplesWriter, WritableSamples};
use ::exr::math::RoundingMode;
use ::exr::meta::attribute::{LevelMode, SampleType};
use ::exr::meta::header::Header;

/// A function that returns the sample of a pixel. Pixels are counted row by row from the top.
type SampleOf<'a, T> = Box<dyn Fn(usize) -> T + Sync + 'a>;

/// The samples of a channel. They need no memory of their own.
pub(super) enum ChannelSamples<'a> {
    Floats(SampleOf<'a, f32>),
    Words(SampleOf<'a, u32>),
}

impl<'a> ChannelSamples<'a> {
    pub(super) fn floats(sample: impl Fn(usize) -> f32 + Sync + 'a) -> Self {
        Self::Floats(Box::new(sample))
    }

    pub(super) fn words(sample: impl Fn(usize) -> u32 + Sync + 'a) -> Self {
        Self::Words(Box::new(sample))
    }
}

pub(super) struct LineWriter<'s, 'a> {
    samples: &'s ChannelSamples<'a>,
    width: usize,
}

impl<'s, 'a: 's> WritableSamples<'s> for ChannelSamples<'a> {
    type Writer = LineWriter<'s, 'a>;

    fn sample_type(&self) -> SampleType {
        match self {
            Self::Floats(_) => SampleType::F32,
            Self::Words(_) => SampleType::U32,
        }
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&'s self, header: &Header) -> Self::Writer {
        LineWriter { samples: self, width: header.layer_size.width() }
    }
}

impl SamplesWriter for LineWriter<'_, '_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let first = line.location.position.y() * self.width + line.location.position.x();
        let written = match self.samples {
            ChannelSamples::Floats(sample) => line.write_samples(|i| sample(first + i)),
            ChannelSamples::Words(sample) => line.write_samples(|i| sample(first + i)),
        };
        written.expect("a line in memory takes its samples");
    }
}
