//! The distribution of the relative error over the pixels of a picture.

use super::picture::Picture;

/// The relative errors √(noise² + bias²) / √(Y² + 0.01 m²) of a picture's pixels, for the mean m of
/// Y. A few glints dominate the mean square error, so the typical error, the median and the 95th
/// percentile describe the other pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorDistribution {
    /// The error of a typical pixel; see [`typical_squares`].
    pub typical: f64,
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

/// The fraction of the pixels with the largest errors, which the typical error leaves out.
pub const TRIMMED: f64 = 0.02;

/// Returns what is added to the squared Y of a pixel before a squared error is divided by it. It
/// limits the relative errors of dark pixels.
pub fn dark_square(mean_y: f64) -> f64 {
    0.01 * mean_y.powi(2)
}

/// Returns the mean squares of a typical pixel: of all pixels except the fraction [`TRIMMED`] with
/// the largest `of(squares)`. `None` without pixels.
///
/// The root of this trimmed mean is the headline error. Unlike the root mean square, it hardly
/// depends on a few glints, whose error no one knows before they are found. Unlike the median, it
/// does not become 0 if most pixels show a light directly, and its square is the expectation of
/// what a comparison with the true picture measures.
pub fn typical_squares<const PARTS: usize>(
    mut squares: Vec<[f64; PARTS]>,
    of: impl Fn(&[f64; PARTS]) -> f64,
) -> Option<[f64; PARTS]> {
    let kept = squares.len() - (TRIMMED * squares.len() as f64) as usize;
    if kept == 0 {
        return None;
    }
    if kept < squares.len() {
        squares.select_nth_unstable_by(kept, |a, b| of(a).total_cmp(&of(b)));
    }
    let sum = |part: usize| squares[..kept].iter().map(|squares| squares[part]).sum::<f64>();
    Some(std::array::from_fn(|part| sum(part) / kept as f64))
}

impl Picture {
    /// Returns the relative error of each pixel. Unknown errors are `None`.
    pub fn relative_errors(&self) -> impl Iterator<Item = Option<f64>> {
        let dark = dark_square(self.mean_y());
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
        let [typical] = typical_squares(errors.iter().map(|error| [error * error]).collect(), |[square]| *square)?;
        Some(ErrorDistribution {
            typical: typical.sqrt(),
            median: rank(0.5),
            p95: rank(0.95),
            worst: self.worst_region(),
        })
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
    fn the_typical_squares_leave_out_the_worst_fiftieth() {
        let of = |squares: &[[f64; 2]]| typical_squares(squares.to_vec(), |[a, b]| a + b);
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[[1.0, 4.0]]), Some([1.0, 4.0]));
        let mut squares = vec![[1.0, 0.5]; 100];
        (squares[7], squares[60]) = ([9.0, 0.0], [0.0, f64::INFINITY]);
        assert_eq!(of(&squares), Some([1.0, 0.5]));
        // Exact pixels, as of a sky, do not hide the error of the others, unlike in a median.
        let half = [vec![[0.0]; 600], vec![[0.04]; 400]].concat();
        let [square] = typical_squares(half, |[square]| *square).unwrap();
        assert!((square.sqrt() - 0.2 * (380.0_f64 / 980.0).sqrt()).abs() < 1e-12, "{square}");
    }

    #[test]
    fn a_glint_does_not_change_the_median_and_is_located() {
        let mut picture = Picture::black(32, 16);
        picture.xyz.fill([1.0; 3]);
        (picture.noise, picture.bias) = (vec![Some(0.02); 512], vec![Some(0.0); 512]);
        picture.noise[5 * 32 + 20] = Some(40.0);
        assert!(picture.error_means().relative.unwrap() > 1.0, "the glint dominates the mean square");
        let found = picture.error_distribution().unwrap();
        assert!((found.typical - found.median).abs() < 1e-9, "{found:?}");
        assert!((found.median - 0.02 / 1.01_f64.sqrt()).abs() < 1e-6 && found.p95 == found.median, "{found:?}");
        assert_eq!(found.worst.corners, [20, 4, 22, 6]);
        assert!(found.worst.fraction > 0.99);
        assert_eq!(Picture::black(3, 2).error_distribution(), None);
    }
}
