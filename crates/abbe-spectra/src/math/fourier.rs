//! The discrete Fourier transform, whose results depend only on the data: the roots of unity come
//! from [`super::elementary`], and the order of the operations is fixed.
//!
//! Lengths with small prime factors are transformed by the self-sorting algorithm of Stockham (Van
//! Loan 1992, *Computational Frameworks for the Fast Fourier Transform*, §1.7), and all others by a
//! convolution with a chirp (Bluestein 1970).

pub use super::complex::Complex;
use std::f64::consts::{PI, TAU};
use std::ops::{Add, Mul, Sub};

/// The largest prime factor of a length that is transformed without a chirp.
const LARGEST_RADIX: usize = 31;

/// The number of lines that are transformed together, so that the compiler can vectorise.
pub const LINES: usize = 4;

/// The numbers at one place of several lines.
#[derive(Debug, Clone, Copy, Default)]
struct Column {
    re: [f64; LINES],
    im: [f64; LINES],
}

impl Column {
    #[inline]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            re: std::array::from_fn(|i| f(self.re[i], other.re[i])),
            im: std::array::from_fn(|i| f(self.im[i], other.im[i])),
        }
    }

    /// Returns the column times −i.
    #[inline]
    fn turned_back(self) -> Self {
        Self { re: self.im, im: self.re.map(|re| -re) }
    }

    #[inline]
    fn scaled(self, factor: f64) -> Self {
        Self { re: self.re.map(|re| re * factor), im: self.im.map(|im| im * factor) }
    }

    /// Exchanges the parts. This turns a transform of exchanged numbers into its inverse.
    #[inline]
    fn exchanged(self) -> Self {
        Self { re: self.im, im: self.re }
    }
}

impl Add for Column {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Column {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul<Complex> for Column {
    type Output = Self;

    #[inline]
    fn mul(self, factor: Complex) -> Self {
        Self {
            re: std::array::from_fn(|i| self.re[i] * factor.re - self.im[i] * factor.im),
            im: std::array::from_fn(|i| self.re[i] * factor.im + self.im[i] * factor.re),
        }
    }
}

/// The direction of a transform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Xₖ = Σⱼ xⱼ exp(−2πi·jk/n).
    Forward,
    /// Xₖ = Σⱼ xⱼ exp(+2πi·jk/n).
    Inverse,
}

/// Buffers of a transform, whose contents between two transforms do not matter.
#[derive(Debug, Default)]
pub struct FourierBuffers {
    columns: Vec<Column>,
    spare: Vec<Column>,
}

/// The Fourier transform of lines of one length.
#[derive(Debug)]
pub struct FourierTransform {
    length: usize,
    method: Method,
}

#[derive(Debug)]
enum Method {
    Stockham(Stockham),
    Chirp(Chirp),
}

impl FourierTransform {
    /// Prepares the transform of lines of `length` ≥ 1 numbers.
    pub fn new(length: usize) -> Self {
        let radices = radices(length);
        let method = if radices.iter().any(|&radix| radix > LARGEST_RADIX) {
            Method::Chirp(Chirp::new(length))
        } else {
            Method::Stockham(Stockham::new(length, radices))
        };
        Self { length, method }
    }

    /// Returns the number of numbers in a line.
    pub fn line_length(&self) -> usize {
        self.length
    }

    /// Transforms up to [`LINES`] consecutive lines in place, without normalisation: the forward
    /// and then the inverse transform multiply a line by its length.
    pub fn transform(&self, lines: &mut [Complex], direction: Direction, buffers: &mut FourierBuffers) {
        let FourierBuffers { columns, spare } = buffers;
        columns.clear();
        columns.resize(self.length, Column::default());
        for (i, line) in lines.chunks_exact(self.length).enumerate() {
            for (column, value) in columns.iter_mut().zip(line) {
                (column.re[i], column.im[i]) = (value.re, value.im);
            }
        }
        let exchange = |columns: &mut [Column]| columns.iter_mut().for_each(|column| *column = column.exchanged());
        if direction == Direction::Inverse {
            exchange(columns);
        }
        match &self.method {
            Method::Stockham(stockham) => stockham.forward(columns, spare),
            Method::Chirp(chirp) => chirp.forward(columns, spare),
        }
        if direction == Direction::Inverse {
            exchange(columns);
        }
        for (i, line) in lines.chunks_exact_mut(self.length).enumerate() {
            for (column, value) in columns.iter().zip(line) {
                *value = Complex { re: column.re[i], im: column.im[i] };
            }
        }
    }
}

#[derive(Debug)]
struct Stockham {
    /// exp(−2πi·k/n).
    roots: Vec<Complex>,
    /// The factors of the length: fours, and then primes in ascending order.
    radices: Vec<usize>,
}

impl Stockham {
    fn new(length: usize, radices: Vec<usize>) -> Self {
        let roots = (0..length).map(|k| Complex::unit(-TAU * (k as f64 / length as f64))).collect();
        Self { roots, radices }
    }

    fn forward(&self, columns: &mut [Column], spare: &mut Vec<Column>) {
        spare.resize(columns.len(), Column::default());
        let (mut from, mut to) = (columns, spare.as_mut_slice());
        let mut stride = 1;
        for &radix in &self.radices {
            match radix {
                2 => self.radix_2(from, to, stride),
                4 => self.radix_4(from, to, stride),
                odd => self.odd_radix(odd, from, to, stride),
            }
            stride *= radix;
            std::mem::swap(&mut from, &mut to);
        }
        if self.radices.len() % 2 == 1 {
            to.copy_from_slice(from);
        }
    }

    /// `stride` is the product of the previous radices.
    fn radix_4(&self, from: &[Column], to: &mut [Column], stride: usize) {
        let part = from.len() / 4;
        for (k, out) in to.chunks_exact_mut(4 * stride).enumerate() {
            let [a, b, c, d] = [0, 1, 2, 3].map(|j| &from[j * part + k * stride..][..stride]);
            let [w1, w2, w3] = [1, 2, 3].map(|j| self.roots[j * k * stride]);
            let (low, high) = out.split_at_mut(2 * stride);
            let ((out0, out1), (out2, out3)) = (low.split_at_mut(stride), high.split_at_mut(stride));
            for q in 0..stride {
                let (even, even_difference) = (a[q] + c[q], a[q] - c[q]);
                let (odd, odd_difference) = (b[q] + d[q], (b[q] - d[q]).turned_back());
                out0[q] = even + odd;
                out1[q] = (even_difference + odd_difference) * w1;
                out2[q] = (even - odd) * w2;
                out3[q] = (even_difference - odd_difference) * w3;
            }
        }
    }

    fn radix_2(&self, from: &[Column], to: &mut [Column], stride: usize) {
        let (first, second) = from.split_at(from.len() / 2);
        let inputs = first.chunks_exact(stride).zip(second.chunks_exact(stride));
        for (k, (out, (first, second))) in to.chunks_exact_mut(2 * stride).zip(inputs).enumerate() {
            let (sums, differences) = out.split_at_mut(stride);
            for q in 0..stride {
                sums[q] = first[q] + second[q];
                differences[q] = (first[q] - second[q]) * self.roots[k * stride];
            }
        }
    }

    /// Performs a step with an odd radix p up to `LARGEST_RADIX`. The roots of unity of the terms l
    /// and p − l are conjugate, so these terms are combined.
    fn odd_radix(&self, radix: usize, from: &[Column], to: &mut [Column], stride: usize) {
        let (part, half) = (from.len() / radix, radix / 2);
        let (mut sums, mut differences) =
            ([Column::default(); LARGEST_RADIX / 2], [Column::default(); LARGEST_RADIX / 2]);
        let (sums, differences) = (&mut sums[..half], &mut differences[..half]);
        for (k, out) in to.chunks_exact_mut(radix * stride).enumerate() {
            for q in 0..stride {
                let input = |l: usize| from[l * part + k * stride + q];
                for l in 1..=half {
                    let (a, b) = (input(l), input(radix - l));
                    (sums[l - 1], differences[l - 1]) = (a + b, (a - b).turned_back());
                }
                out[q] = sums.iter().fold(input(0), |sum, term| sum + *term);
                for j in 1..=half {
                    let (mut even, mut odd, mut turn) = (input(0), Column::default(), 0);
                    for (sum, difference) in sums.iter().zip(differences.iter()) {
                        turn = if turn + j < radix { turn + j } else { turn + j - radix };
                        let root = self.roots[turn * part];
                        (even, odd) = (even + sum.scaled(root.re), odd + difference.scaled(-root.im));
                    }
                    out[j * stride + q] = (even + odd) * self.roots[j * k * stride];
                    out[(radix - j) * stride + q] = (even - odd) * self.roots[(radix - j) * k * stride];
                }
            }
        }
    }
}

fn radices(length: usize) -> Vec<usize> {
    let (mut rest, mut radices) = (length, Vec::new());
    while rest.is_multiple_of(4) {
        radices.push(4);
        rest /= 4;
    }
    let mut prime = 2;
    while rest > 1 {
        if rest.is_multiple_of(prime) {
            radices.push(prime);
            rest /= prime;
        } else {
            prime += 1;
        }
    }
    radices
}

/// The transform of lines as a convolution: jk = (j² + k² − (k − j)²) / 2.
#[derive(Debug)]
struct Chirp {
    /// exp(−πi·k²/n).
    values: Vec<Complex>,
    /// The transform of the conjugate values at the places −n < k < n, divided by its length.
    kernel: Vec<Complex>,
    /// A transform whose length is a power of 2.
    transform: Stockham,
}

impl Chirp {
    fn new(length: usize) -> Self {
        let unit = |k: usize| Complex::unit(-PI * ((k * k % (2 * length)) as f64 / length as f64));
        let values: Vec<Complex> = (0..length).map(unit).collect();
        let whole = (2 * length - 1).next_power_of_two();
        let mut kernel = vec![Complex::default(); whole];
        for (k, value) in values.iter().enumerate() {
            let value = Complex { re: value.re, im: -value.im } * (1.0 / whole as f64);
            (kernel[k], kernel[(whole - k) % whole]) = (value, value);
        }
        let of_kernel = FourierTransform::new(whole);
        of_kernel.transform(&mut kernel, Direction::Forward, &mut FourierBuffers::default());
        Self { values, kernel, transform: Stockham::new(whole, radices(whole)) }
    }

    fn forward(&self, columns: &mut Vec<Column>, spare: &mut Vec<Column>) {
        columns.iter_mut().zip(&self.values).for_each(|(column, value)| *column = *column * *value);
        columns.resize(self.kernel.len(), Column::default());
        self.transform.forward(columns, spare);
        for (column, kernel) in columns.iter_mut().zip(&self.kernel) {
            *column = (*column * *kernel).exchanged();
        }
        self.transform.forward(columns, spare);
        columns.truncate(self.values.len());
        columns.iter_mut().zip(&self.values).for_each(|(column, value)| *column = column.exchanged() * *value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{Purpose, Seed, Stream};

    fn line(length: usize, seed: u64) -> Vec<Complex> {
        let mut stream = Stream::new(Seed::new(seed), Purpose::Pass, 0, length as u64);
        (0..length).map(|_| Complex { re: stream.uniform() - 0.5, im: stream.uniform() - 0.5 }).collect()
    }

    fn largest_difference(a: &[Complex], b: &[Complex]) -> f64 {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a.re - b.re).abs().max((a.im - b.im).abs())).fold(0.0, f64::max)
    }

    fn sum_of_waves(line: &[Complex]) -> Vec<Complex> {
        let n = line.len();
        let roots: Vec<Complex> = (0..n).map(|k| Complex::unit(-TAU * (k as f64 / n as f64))).collect();
        let sum = |k: usize| {
            let mut sum = Complex::default();
            line.iter().enumerate().for_each(|(j, value)| sum += *value * roots[j * k % n]);
            sum
        };
        (0..n).map(sum).collect()
    }

    #[test]
    fn transforms_of_all_lengths_are_sums_of_waves() {
        let mut buffers = FourierBuffers::default();
        for length in (1..=130).chain([256, 360, 683, 1000, 1366]) {
            let transform = FourierTransform::new(length);
            assert_eq!(transform.line_length(), length);
            for count in [1, LINES] {
                let lines: Vec<Vec<Complex>> = (0..count).map(|i| line(length, i as u64)).collect();
                let mut found = lines.concat();
                transform.transform(&mut found, Direction::Forward, &mut buffers);
                let expected: Vec<Complex> = lines.iter().flat_map(|line| sum_of_waves(line)).collect();
                let error = largest_difference(&found, &expected) / length as f64;
                assert!(error < 1e-15, "{length}: {error}");
                transform.transform(&mut found, Direction::Inverse, &mut buffers);
                found.iter_mut().for_each(|value| *value = *value * (1.0 / length as f64));
                assert!(largest_difference(&found, &lines.concat()) < 1e-14, "{length}");
            }
        }
    }

    #[test]
    fn radices_are_fours_and_primes() {
        assert_eq!(radices(1), [0; 0]);
        assert_eq!(radices(3840), [4, 4, 4, 4, 3, 5]);
        assert_eq!(radices(2 * 49), [2, 7, 7]);
        assert_eq!(radices(4 * 683), [4, 683]);
        assert_eq!(radices(25), [5, 5]);
    }
}
