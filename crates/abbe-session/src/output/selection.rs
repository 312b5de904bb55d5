//! The pixels of two pictures that are compared.

use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::Picture;

/// A rectangle of pixels, with columns counted from the left and rows from the top. Column `x1` and
/// row `y1` are excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    pub x0: usize,
    pub y0: usize,
    pub x1: usize,
    pub y1: usize,
}

/// The pixels to compare. Without regions and without a mask, all pixels are selected.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Selection {
    /// Regions. A pixel is selected if any of these regions contains the pixel.
    pub regions: Vec<Region>,
    /// A mask, row by row from the top. Only pixels whose value is true are selected.
    pub mask: Option<Vec<bool>>,
}

impl Region {
    pub fn contains(&self, x: usize, y: usize) -> bool {
        (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y)
    }

    pub(super) fn check(&self, width: usize, height: usize) -> Result<()> {
        let Self { x0, y0, x1, y1 } = *self;
        if x0 < x1 && y0 < y1 && x1 <= width && y1 <= height {
            return Ok(());
        }
        let what = format!("the region {x0},{y0},{x1},{y1} in a picture of {width} × {height} pixels");
        Err(Error::input(what).expected(format!("x0 < x1 ≤ {width} and y0 < y1 ≤ {height}")))
    }
}

impl Selection {
    pub(super) fn selected(&self, picture: &Picture, reference: &Picture) -> Result<Vec<usize>> {
        let (width, height) = (reference.width, reference.height);
        if (picture.width, picture.height) != (width, height) {
            let what = format!("pictures of {} × {} and {width} × {height} pixels", picture.width, picture.height);
            return Err(Error::input(what).expected("two pictures of the same size"));
        }
        self.regions.iter().try_for_each(|region| region.check(width, height))?;
        let selected: Vec<usize> = (0..width * height).filter(|&i| self.selects(i % width, i / width, width)).collect();
        if selected.is_empty() {
            return Err(Error::input("no pixel is selected").expected("at least one pixel in the mask and the regions"));
        }
        Ok(selected)
    }

    pub fn selects(&self, x: usize, y: usize, width: usize) -> bool {
        let in_region = self.regions.is_empty() || self.regions.iter().any(|region| region.contains(x, y));
        in_region && self.mask.as_ref().is_none_or(|mask| mask[y * width + x])
    }
}
