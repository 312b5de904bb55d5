//! The input of the denoiser: means over the replicates of a picture.

use crate::planes::Size;
use crate::{GROUPS, REPLICATES};
use std::ops::Range;

/// The means of a picture over groups of its passes, row by row from the top.
///
/// All planes have `width` × `height` values, and X, Y and Z one unit, such as cd/m².
#[derive(Debug, Clone, Default)]
pub struct Samples {
    /// The number of columns.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// The number of passes of each replicate. Each group has at least one.
    pub passes: [u64; REPLICATES],
    /// The mean Y of each replicate, and any finite values for one without passes.
    pub y: [Vec<f32>; REPLICATES],
    /// The mean X of each group: of the replicates r whose remainder modulo [`GROUPS`] is its
    /// number.
    pub x: [Vec<f32>; GROUPS],
    /// The mean Z of each group.
    pub z: [Vec<f32>; GROUPS],
    /// What camera rays show, measured twice with independent samples.
    pub features: [Vec<Feature>; 2],
}

/// What the camera samples of a pixel show: means over them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// The fraction of light that the surface reflects or transmits, as X, Y and Z relative to
    /// those of white. Samples that hit no surface count as white.
    pub albedo: [f32; 3],
    /// The mean of the unit normals or, at mirrors and clear glass, of another vector of the same
    /// size that differs where something else is seen there. Samples that hit no surface count as 0.
    pub normal: [f32; 3],
    /// The mean binary logarithm of the distance, along reflected and refracted rays, over samples
    /// that hit a surface.
    pub log_depth: f32,
}

impl Feature {
    /// The features of a pixel whose samples hit no surface.
    pub const NONE: Self = Self { albedo: [1.0; 3], normal: [0.0; 3], log_depth: 0.0 };
}

impl Samples {
    pub(crate) fn size(&self) -> Size {
        Size { width: self.width, height: self.height }
    }

    /// Panics if the samples are incomplete.
    pub(crate) fn check(&self) {
        let count = self.size().count();
        let planes = self.y.iter().chain(&self.x).chain(&self.z);
        let complete = planes.map(Vec::len).chain(self.features.iter().map(Vec::len)).all(|length| length == count);
        assert!(complete, "each plane has {count} values");
        assert!(Self::suffice(self.passes), "each group has passes");
    }

    /// Returns true if so many passes of each replicate can be denoised: if each group has at least
    /// one, so that each half has two independent means, which tell noise from differences.
    pub fn suffice(passes: [u64; REPLICATES]) -> bool {
        (0..GROUPS).all(|group| passes.iter().skip(group).step_by(GROUPS).any(|&passes| passes > 0))
    }

    /// Returns the samples of some rows.
    pub(crate) fn rows(&self, rows: Range<usize>) -> Self {
        let pixels = rows.start * self.width..rows.end * self.width;
        let cut = |plane: &Vec<f32>| plane[pixels.clone()].to_vec();
        Self {
            width: self.width,
            height: rows.len(),
            passes: self.passes,
            y: self.y.each_ref().map(cut),
            x: self.x.each_ref().map(cut),
            z: self.z.each_ref().map(cut),
            features: self.features.each_ref().map(|plane| plane[pixels.clone()].to_vec()),
        }
    }
}
