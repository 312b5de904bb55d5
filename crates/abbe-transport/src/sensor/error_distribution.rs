//! The distribution of the relative error over the pixels of a picture.

use super::picture::Picture;

/// The relative errors √(noise² + bias²) / √(Y² + 0.01 m²) of a picture's pixels, for the mean m of
/// Y. A few glints dominate the mean square error, so the median and the 95th percentile describe
/// the other pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorDistribution {
    /// The median over the pixels with known errors.
    pub median: f64,
    /// The 95th percentile over the pixels with known errors.
    pub p95: f64,
    /// The block of pixels that contributes most to the mean square error.
    pub worst: WorstRegion,
}

/// The block with the largest errors. Its side is a sixteenth of the longer side of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstRegion {
    /// The first column and row, and the column and row after the last.
    pub corners: [usize; 4],
    /// The fraction of the block in the sum of noise² + bias² over the picture.
    pub fraction: f64,
}

/// The number of blocks along the longer side of a picture.
const BLOCKS: usize = 16;

impl Picture {
    /// Returns the relative error of each pixel. Unknown errors are `None`.
    pub fn relative_errors(&self) -> impl Iterator<Item = Option<f64>> {
        let dark = 0.01 * self.mean_y().powi(2);
        let unit = move |pixel: usize| (self.xyz[pixel][1].powi(2) + dark).sqrt();
        (0..self.xyz.len()).map(move |pixel| self.error(pixel).map(|error| error / unit(pixel)))
    }

    /// Returns the distribution of the relative error, or `None` if no pixel has a known error.
    pub fn error_distribution(&self) -> Option<ErrorDistribution> {
        let mut errors: Vec<f64> = self.relative_errors().flatten().filter(|error| error.is_finite()).collect();
        if errors.is_empty() {
            return None;
        }
        errors.sort_by(f64::total_cmp);
        let rank =
            |fraction: f64| errors[((errors.len() as f64 * fraction).ceil() as usize).clamp(1, errors.len()) - 1];
        Some(ErrorDistribution { median: rank(0.5), p95: rank(0.95), worst: self.worst_region() })
    }

    fn worst_region(&self) -> WorstRegion {
        let side = self.width.max(self.height).div_ceil(BLOCKS);
        let columns = self.width.div_ceil(side);
        let mut squares = vec![0.0; columns * self.height.div_ceil(side)];
        for pixel in 0..self.xyz.len() {
            let block = pixel / self.width / side * columns + pixel % self.width / side;
            squares[block] += self.error(pixel).map_or(0.0, |error| error * error);
        }
        let total: f64 = squares.iter().sum();
        let worst =
            (0..squares.len()).fold(0, |worst, block| if squares[block] > squares[worst] { block } else { worst });
        let (x, y) = (worst % columns * side, worst / columns * side);
        let corners = [x, y, (x + side).min(self.width), (y + side).min(self.height)];
        WorstRegion { corners, fraction: if total > 0.0 { squares[worst] / total } else { 0.0 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_glint_does_not_change_the_median_and_is_located() {
        let mut picture = Picture::black(32, 16);
        picture.xyz.fill([1.0; 3]);
        (picture.noise, picture.bias) = (vec![Some(0.02); 512], vec![Some(0.0); 512]);
        picture.noise[5 * 32 + 20] = Some(40.0);
        assert!(picture.error_means().relative.unwrap() > 1.0, "the glint dominates the mean square");
        let found = picture.error_distribution().unwrap();
        assert!((found.median - 0.02 / 1.01_f64.sqrt()).abs() < 1e-6 && found.p95 == found.median, "{found:?}");
        assert_eq!(found.worst.corners, [20, 4, 22, 6]);
        assert!(found.worst.fraction > 0.99);
        assert_eq!(Picture::black(3, 2).error_distribution(), None);
    }
}
