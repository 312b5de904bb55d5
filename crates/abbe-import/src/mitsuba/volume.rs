//! Reads the `.vol` files of Mitsuba: grids of densities.

use abbe_spectra::error::{Error, Result};
use std::path::Path;

/// The largest number of cells that a scene file contains.
const MAX_CELLS: usize = 262_144;

/// The largest number of cells that are read.
const MAX_READ: usize = 1 << 28;

const HEADER: usize = 48;

/// The values at the centres of cells. x varies fastest, then y, then z.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct VolumeGrid {
    pub(super) resolution: [usize; 3],
    /// The lowest and the highest corner.
    pub(super) bounds: [[f64; 3]; 2],
    pub(super) values: Vec<f64>,
    channels: usize,
}

impl VolumeGrid {
    /// Reads a file: "VOL", version 3, type 1 (32-bit numbers), the numbers of cells along x, y and
    /// z, the number of channels, the two corners of the box, and the values.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|why| Error::input(format!("cannot be read: {why}")).in_file(path))?;
        Self::decode(&bytes).map_err(|error| error.in_file(path))
    }

    fn decode(bytes: &[u8]) -> Result<Self> {
        let wrong = |what: &str| Error::input(what).expected("a Mitsuba volume file of version 3 with 32-bit numbers");
        if bytes.len() < HEADER || !bytes.starts_with(b"VOL\x03") {
            return Err(wrong("found no volume file"));
        }
        let word = |i: usize| [bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]];
        let count = |i: usize| usize::try_from(i32::from_le_bytes(word(i))).unwrap_or(0);
        let float = |i: usize| f64::from(f32::from_le_bytes(word(i)));
        let (resolution, channels) = ([count(2), count(3), count(4)], count(5));
        let values = resolution.iter().chain([&channels]).try_fold(1_usize, |product, &n| product.checked_mul(n));
        let values = values.filter(|&values| values > 0 && values <= MAX_READ);
        let values = values.filter(|&values| count(1) == 1 && bytes.len() >= HEADER + 4 * values);
        let number = values.ok_or_else(|| wrong("the header or the length of the volume file is wrong"))?;
        let bounds = [[float(6), float(7), float(8)], [float(9), float(10), float(11)]];
        let values: Vec<f64> = (0..number).map(|i| float(HEADER / 4 + i)).collect();
        if values.iter().any(|value| !value.is_finite() || *value < 0.0) {
            return Err(wrong("the volume file has values that are negative or not finite"));
        }
        Ok(Self { resolution, bounds, values, channels })
    }

    pub(super) fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// Returns why a scene file cannot contain the grid, if it cannot.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let [low, high] = self.bounds;
        if self.channels != 1 {
            Some("a grid of colours is not supported")
        } else if self.values.len() > MAX_CELLS {
            Some("a grid with more than 262144 cells is too large")
        } else if !low.iter().zip(high).all(|(low, high)| *low < high) {
            Some("a grid with an empty box is not supported")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with a resolution of 2 × 1 × 1.
    pub(crate) fn file(values: &[f32]) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        [1_i32, values.len() as i32, 1, 1, 1].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
        [0.0_f32, 0.0, 0.0, 1.0, 2.0, 3.0].iter().chain(values).for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes
    }

    #[test]
    fn a_volume_file_is_decoded() {
        let grid = VolumeGrid::decode(&file(&[0.5, 1.5])).unwrap();
        assert_eq!((grid.resolution, grid.values.as_slice()), ([2, 1, 1], [0.5, 1.5].as_slice()));
        assert_eq!((grid.bounds[1], grid.mean(), grid.unusable()), ([1.0, 2.0, 3.0], 1.0, None));
    }

    #[test]
    fn broken_volume_files_are_errors() {
        let good = file(&[0.5, 1.5]);
        for bad in [&good[..20], &good[..good.len() - 1], b"VOL\x02", &file(&[-1.0]), &file(&[f32::NAN])] {
            assert!(VolumeGrid::decode(bad).is_err());
        }
        let mut huge = good;
        huge[8..20].fill(0x7f);
        assert!(VolumeGrid::decode(&huge).is_err());
    }
}
