//! Convolution of the planes of a picture, by Fourier transforms.
//!
//! Reflection extends the picture beyond its edges, so that no light is lost there and a uniform
//! picture stays uniform. Kernels are normalised to 1, so energy is conserved.

use abbe_spectra::math::fourier::{self, Complex, Direction, FourierBuffers, FourierTransform};
use rayon::prelude::*;

/// The Fourier transform of a plane. Reflection extends the plane beyond its edges.
pub(super) type PlaneTransform = Vec<Complex>;

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
        let mirrored = |i: usize, length: usize| if i < length { i } else { 2 * length - 1 - i };
        let value = |place: usize| {
            let (x, y) = (place % (2 * self.width), place / (2 * self.width));
            let [re, im] = plane(mirrored(y, self.height) * self.width + mirrored(x, self.width));
            Complex { re, im }
        };
        self.forward((0..4 * self.width * self.height).into_par_iter().map(value).collect())
    }

    /// Returns the planes of a transform. This function is the inverse of `transform`.
    pub(super) fn planes(&self, mut spectrum: PlaneTransform) -> Vec<[f64; 2]> {
        let (width, height) = self.mirrored_size();
        each_line(&self.columns, &mut spectrum, Direction::Inverse);
        let mut plane = transposed(&spectrum, height);
        each_line(&self.rows, &mut plane, Direction::Inverse);
        let scale = 1.0 / (width * height) as f64;
        let pixel = |i: usize| plane[i / self.width * width + i % self.width] * scale;
        (0..self.width * self.height).map(|i| [pixel(i).re, pixel(i).im]).collect()
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
        self.forward(kernel.into_iter().map(Complex::from).collect())
    }

    /// Transforms rows and then columns. The result is stored column by column.
    fn forward(&self, mut plane: PlaneTransform) -> PlaneTransform {
        each_line(&self.rows, &mut plane, Direction::Forward);
        let mut spectrum = transposed(&plane, 2 * self.width);
        each_line(&self.columns, &mut spectrum, Direction::Forward);
        spectrum
    }
}

pub(super) fn add_product(sum: &mut PlaneTransform, a: &PlaneTransform, b: &PlaneTransform) {
    sum.par_iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += *a * *b);
}

fn each_line(transform: &FourierTransform, plane: &mut PlaneTransform, direction: Direction) {
    let lines = plane.par_chunks_mut(fourier::LINES * transform.line_length());
    lines.for_each_init(FourierBuffers::default, |buffers, lines| transform.transform(lines, direction, buffers));
}

/// Transposes a plane whose rows have `length` values.
fn transposed(lines: &PlaneTransform, length: usize) -> PlaneTransform {
    let count = lines.len() / length;
    (0..lines.len()).into_par_iter().map(|i| lines[i % count * length + i / count]).collect()
}
