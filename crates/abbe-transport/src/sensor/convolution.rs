//! Convolution of the planes of a picture, by Fourier transforms.
//!
//! Reflection extends the picture beyond its edges, so that no light is lost there and a uniform
//! picture stays uniform. Kernels are normalised to 1, so energy is conserved.

use abbe_spectra::math::fourier::{self, Complex, Direction, FourierBuffers, FourierTransform};
use rayon::prelude::*;
use std::f64::consts::PI;

/// The Fourier transform of a plane. Reflection extends the plane beyond its edges.
pub(super) type PlaneTransform = Vec<Complex>;

/// The Fourier transform of an even kernel, of which one half is stored.
pub(super) struct EvenKernel(PlaneTransform);

/// The transforms of all planes of one size.
pub(super) struct MirroredPlanes {
    width: usize,
    height: usize,
    rows: FourierTransform,
    columns: FourierTransform,
}

impl MirroredPlanes {
    pub(super) fn new((width, height): (usize, usize)) -> Self {
        let [rows, columns] = [2 * width, 2 * height].map(FourierTransform::new);
        Self { width, height, rows, columns }
    }

    /// Returns the width and height of a plane with its reflections.
    pub(super) fn mirrored_size(&self) -> (usize, usize) {
        (2 * self.width, 2 * self.height)
    }

    /// Transforms two real planes together, as the real and the imaginary part.
    pub(super) fn transform(&self, plane: impl Fn(usize) -> [f64; 2] + Sync) -> PlaneTransform {
        let rows = self.rows_of(plane);
        self.forward(rows, |y| reflected(y, self.height), 2 * self.width)
    }

    /// Returns the planes of a transform. This function is the inverse of `transform`.
    pub(super) fn planes(&self, mut spectrum: PlaneTransform) -> Vec<[f64; 2]> {
        let (width, height) = self.mirrored_size();
        each_line(&self.columns, &mut spectrum, Direction::Inverse);
        // The reflected rows are not needed.
        let value = |place: usize| spectrum[place % width * height + place / width];
        self.pixels((0..width * self.height).into_par_iter().map(value).collect())
    }

    /// Returns the rows of a plane with their reflections.
    fn rows_of(&self, plane: impl Fn(usize) -> [f64; 2] + Sync) -> Vec<Complex> {
        let value = |place: usize| {
            let (x, y) = (place % (2 * self.width), place / (2 * self.width));
            let [re, im] = plane(y * self.width + reflected(x, self.width));
            Complex { re, im }
        };
        (0..2 * self.width * self.height).into_par_iter().map(value).collect()
    }

    /// Transforms the rows of a plane back, and returns its pixels.
    fn pixels(&self, mut plane: Vec<Complex>) -> Vec<[f64; 2]> {
        let (width, height) = self.mirrored_size();
        each_line(&self.rows, &mut plane, Direction::Inverse);
        let scale = 1.0 / (width * height) as f64;
        let pixel = |i: usize| {
            let value = plane[i / self.width * width + i % self.width] * scale;
            [value.re, value.im]
        };
        (0..self.width * self.height).into_par_iter().map(pixel).collect()
    }

    /// Normalises a kernel to 1 and transforms it. The kernel has the size of a mirrored plane, and
    /// its centre is the first value. A kernel of zeros stands for one that changes nothing.
    pub(super) fn kernel(&self, mut kernel: Vec<f64>) -> PlaneTransform {
        let whole: f64 = kernel.iter().sum();
        if whole > 0.0 {
            kernel.iter_mut().for_each(|value| *value /= whole);
        } else {
            kernel[0] = 1.0;
        }
        self.forward(kernel.into_iter().map(Complex::from).collect(), |y| y, 2 * self.width)
    }

    /// Normalises an even kernel to 1 and transforms it, for [`convolved`](Self::convolved).
    /// `value` returns its positive values at a column and a row from its centre, up to the width
    /// and height of a plane.
    pub(super) fn even_kernel(&self, value: impl Fn(usize, usize) -> f64 + Sync) -> EvenKernel {
        let (columns, rows) = self.mirrored_size();
        let quadrant: Vec<Vec<f64>> =
            (0..=self.height).into_par_iter().map(|y| (0..=self.width).map(|x| value(x, y)).collect()).collect();
        let from_centre = |i: usize, count: usize| i.min(count - i);
        // Only the centre and the farthest column or row are there once.
        let copies = |i: usize, half: usize| if i == 0 || i == half { 1.0 } else { 2.0 };
        let sum_of_row = |(y, row): (usize, &Vec<f64>)| -> f64 {
            let sum: f64 = row.iter().enumerate().map(|(x, value)| copies(x, self.width) * value).sum();
            copies(y, self.height) * sum
        };
        let whole: f64 = quadrant.iter().enumerate().map(sum_of_row).sum();
        let at = |place: usize| quadrant[place / columns][from_centre(place % columns, columns)] / whole;
        let upper = (0..columns * (self.height + 1)).into_par_iter().map(|place| Complex::from(at(place))).collect();
        EvenKernel(self.forward(upper, |y| from_centre(y, rows), self.width + 1))
    }

    /// Convolves two real planes with an even kernel. The transform of a mirrored plane at the
    /// column 2w − k is exp(−πi·k/w) times that at k, where w is the width, so half of the columns
    /// suffice.
    pub(super) fn convolved(&self, kernel: &EvenKernel, plane: impl Fn(usize) -> [f64; 2] + Sync) -> Vec<[f64; 2]> {
        let (width, height) = self.mirrored_size();
        let mut spectrum = self.forward(self.rows_of(plane), |y| reflected(y, self.height), self.width + 1);
        spectrum.par_iter_mut().zip(&kernel.0).for_each(|(value, kernel)| *value = *value * *kernel);
        each_line(&self.columns, &mut spectrum, Direction::Inverse);
        let turns: Vec<Complex> =
            (0..self.width).map(|k| Complex::unit(-PI * (k as f64 / self.width as f64))).collect();
        let value = |place: usize| match (place % width, place / width) {
            (x, y) if x <= self.width => spectrum[x * height + y],
            (x, y) => spectrum[(width - x) * height + y] * turns[width - x],
        };
        self.pixels((0..width * self.height).into_par_iter().map(value).collect())
    }

    /// Transforms rows and then the first `columns` columns. `row` returns the row of the plane at
    /// each of all mirrored rows, so equal rows are transformed once. The result is stored column
    /// by column.
    fn forward(&self, mut plane: Vec<Complex>, row: impl Fn(usize) -> usize + Sync, columns: usize) -> PlaneTransform {
        let (width, height) = self.mirrored_size();
        each_line(&self.rows, &mut plane, Direction::Forward);
        let value = |place: usize| plane[row(place % height) * width + place / height];
        let mut spectrum = (0..columns * height).into_par_iter().map(value).collect();
        each_line(&self.columns, &mut spectrum, Direction::Forward);
        spectrum
    }
}

/// Returns the place in a line of `length` values whose reflection continues at its end.
fn reflected(i: usize, length: usize) -> usize {
    if i < length { i } else { 2 * length - 1 - i }
}

pub(super) fn add_product(sum: &mut PlaneTransform, a: &PlaneTransform, b: &PlaneTransform) {
    sum.par_iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += *a * *b);
}

fn each_line(transform: &FourierTransform, plane: &mut PlaneTransform, direction: Direction) {
    let lines = plane.par_chunks_mut(fourier::LINES * transform.line_length());
    lines.for_each_init(FourierBuffers::default, |buffers, lines| transform.transform(lines, direction, buffers));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the columns give the same planes as the whole transform.
    #[test]
    fn an_even_kernel_convolves_like_any_kernel() {
        for (width, height) in [(7, 5), (8, 6), (1, 3)] {
            let planes = MirroredPlanes::new((width, height));
            let value = |x: usize, y: usize| 1.0 / (1.0 + (x * x + 2 * y * y) as f64);
            let plane = |pixel: usize| [(pixel * 7919 % 101) as f64, (pixel * 104_729 % 89) as f64];
            let found = planes.convolved(&planes.even_kernel(value), plane);
            let (columns, rows) = planes.mirrored_size();
            let from_centre = |i: usize, count: usize| i.min(count - i);
            let at = |i: usize| value(from_centre(i % columns, columns), from_centre(i / columns, rows));
            let mut product = vec![Complex::default(); columns * rows];
            let kernel = planes.kernel((0..columns * rows).map(at).collect());
            add_product(&mut product, &kernel, &planes.transform(plane));
            for (a, b) in found.iter().zip(planes.planes(product)) {
                assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9, "{width} × {height}: {a:?} {b:?}");
            }
        }
    }
}
