//! One level of the filter: a weighted mean over nine pixels, 2ⁿ pixels apart at level n (Dammertz
//! et al. 2010, "Edge-avoiding À-Trous wavelet transform").
//!
//! A pixel has its full weight if the guiding replicates do not tell it apart from the pixel in
//! the middle, and less if they do, or if it is noisier.

use crate::features::Surfaces;
use crate::half::{Half, OWN, Spread};
use crate::planes::{ROWS, Size, by_rows, mean_around};
use rayon::prelude::*;
use std::ops::Range;

/// The levels of the filter: those of luma, and one more for chroma.
pub(crate) const LEVELS: usize = LUMA_LEVELS + 1;

const LUMA_LEVELS: usize = 5;

/// The largest distance of the nine pixels over which a comparison is pooled.
pub(crate) const LARGEST_PATCH: usize = 4;

/// The same distance for chroma, from the second level on. It divides no step, so that neighbours
/// share their decisions: a colour that few samples bring would otherwise become a lattice of dots.
const CHROMA_PATCH: usize = 3;

/// The weights of pixels in the middle and beside it, in each direction.
const KERNEL: [f32; 2] = [0.375, 0.25];

/// A test statistic has the mean 1 if two pixels are equal. Pixels with less than this are.
const EQUAL: f32 = 1.0;

/// Pixels whose pooled statistic exceeds [`EQUAL`] by this much are not averaged: of luma, and of
/// chroma, which has fewer degrees of freedom.
const LARGEST_LUMA: f32 = 2.0;
const LARGEST_CHROMA: f32 = 3.0;

/// The same for luma and a single pair of pixels with the pooled variance, so that details of one
/// pixel do not disappear among the pixels around it.
const EQUAL_SINGLE: f32 = 2.0;
const LARGEST_SINGLE: f32 = 8.0;

/// Pixels with more than this multiple of a pixel's variance have less weight.
const LARGEST_VARIANCE: f32 = 4.0;

/// Colours are averaged as ratios to the luminance, so a pixel that is brighter by more than this
/// factor would decide on the colour alone. Its weight falls with the square of the excess.
const LARGEST_RATIO: f32 = 4.0;

/// The distance, in those of a pooled comparison, over which the variance around a pixel is the
/// mean. A single bright sample does not dominate it, and many of them do.
const VARIANCE_RADIUS: usize = 4;

/// Keeps quotients of 0 finite. Below the square of any luminance that matters.
const TINY: f32 = 1e-30;

/// An offset between two pixels, with its weight in the kernel.
#[derive(Debug, Clone, Copy)]
struct Offset {
    dx: isize,
    dy: isize,
    kernel: f32,
}

impl Offset {
    fn all(step: usize) -> impl Iterator<Item = Self> {
        [-1, 0, 1].into_iter().flat_map(move |y| [-1, 0, 1].map(|x| Self::new(x, y, step as isize)))
    }

    fn new(x: isize, y: isize, step: isize) -> Self {
        Self { dx: x * step, dy: y * step, kernel: KERNEL[x.unsigned_abs()] * KERNEL[y.unsigned_abs()] }
    }

    /// Returns the columns whose partners lie in the picture.
    fn columns(self, width: usize) -> Range<usize> {
        let end = width.saturating_sub(self.dx.max(0).unsigned_abs());
        self.dx.min(0).unsigned_abs().min(end)..end
    }

    /// Returns the partners of some columns of a row, as a range of pixels. `None` if the row or
    /// that of the partners is outside the picture.
    fn pair(self, y: isize, columns: &Range<usize>, size: Size) -> Option<(usize, usize)> {
        let inside = |y: isize| usize::try_from(y).ok().filter(|&y| y < size.height);
        let (y, other) = (inside(y)?, inside(y + self.dy)?);
        let first = y * size.width + columns.start;
        let partner = (other * size.width + columns.start).checked_add_signed(self.dx)?;
        Some((first, partner))
    }
}

/// What a level knows about each pixel before it compares pairs.
struct Level<'h> {
    half: &'h Half,
    surfaces: &'h Surfaces,
    /// The distance of neighbouring pixels.
    step: usize,
    /// The distances of the nine pixels over which a comparison is pooled: of luma and of chroma.
    patches: [usize; 2],
    /// The luminance of each pixel, as the levels before have filtered it.
    luminance: Vec<f32>,
    /// The mean ratios of X and Z to Y around each pixel.
    ratios: [Vec<f32>; 2],
    /// The variance of each pixel: of luma and of chroma.
    variances: [Vec<f32>; 2],
    /// The mean variance around each pixel.
    around: [Vec<f32>; 2],
    luma: bool,
    /// Y of the guiding replicates, compressed.
    compressed: [Vec<f32>; OWN],
}

/// Returns a luminance on the scale of the tests. Rare bright samples count less on it, so they do
/// not hide the differences of the many others: that between two facets of a brilliant, for
/// example. A test of small differences, or of only two values, is the same on any scale.
fn compress(luminance: f32) -> f32 {
    luminance.max(0.0).sqrt().sqrt()
}

/// The numbers of a comparison: squares of differences, and their variances, for luma and the two
/// chromas.
const STATISTICS: usize = 6;

/// Returns 0 if a statistic is of luma, and 1 if it is of chroma.
fn kind(statistic: usize) -> usize {
    usize::from(statistic >= 2)
}

impl<'h> Level<'h> {
    fn new(half: &'h Half, surfaces: &'h Surfaces, nth: usize) -> Self {
        let (size, step) = (half.size, 1 << nth);
        let patches = [step.min(LARGEST_PATCH), if step == 1 { 1 } else { CHROMA_PATCH }];
        let [patch, _] = patches;
        let mean = |c: usize| {
            let [a, b] = [0, 1].map(|group| &half.guide_colour[group][c]);
            let f = half.groups.weights;
            let own: Vec<f32> = a.iter().zip(b).map(|(a, b)| f[0] * a + f[1] * b).collect();
            mean_around(&own, size, 1, patch)
        };
        let [x, y, z] = [0, 1, 2].map(mean);
        let of_pixel = |i: usize| half.replicates.mean(std::array::from_fn(|k| half.guide[k][i])).max(0.0);
        let luminance = (0..y.len()).map(of_pixel).collect();
        let ratio =
            |c: &Vec<f32>| -> Vec<f32> { c.iter().zip(&y).map(|(c, y)| if *y > 0.0 { c / y } else { 0.0 }).collect() };
        let ratios = [ratio(&x), ratio(&z)];
        // Both halves, because rare bright samples may be in one of them only.
        let luma = by_rows(size, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                let i = y * size.width + x;
                let of_others = half.others.variance_at(&half.luma, i);
                *value = 0.5 * (half.replicates.variance_at(&half.guide, i) + of_others);
            }
        });
        let chroma = by_rows(size, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                let i = y * size.width + x;
                let of = |[x, y, z]: &[Vec<f32>; 3], c: usize| [x, z][c][i] - ratios[c][i] * y[i];
                let variance = |groups: &[[Vec<f32>; 3]; 2], spread: &Spread<2>| -> f32 {
                    (0..2).map(|c| spread.variance(groups.each_ref().map(|group| of(group, c)))).sum()
                };
                let of_others = variance(&half.colour, &half.other_groups);
                *value = 0.5 * (variance(&half.guide_colour, &half.groups) + of_others);
            }
        });
        let around = [&luma, &chroma].map(|plane| mean_around(plane, size, VARIANCE_RADIUS, patch));
        let variances = [luma, chroma];
        let compressed = std::array::from_fn(|k| half.guide[k].iter().map(|&y| compress(y)).collect());
        Self {
            half,
            surfaces,
            step,
            patches,
            luminance,
            ratios,
            variances,
            around,
            luma: nth < LUMA_LEVELS,
            compressed,
        }
    }

    /// Compares the pixels of a row with their partners. Writes the sums over three columns.
    fn compare(&self, (first, partner): (usize, usize), columns: &Range<usize>, row: &mut Comparisons) {
        let Half { guide_colour, replicates, groups, .. } = self.half;
        let count = columns.len();
        let a: [&[f32]; OWN] = std::array::from_fn(|k| &self.compressed[k][first..][..count]);
        let b: [&[f32]; OWN] = std::array::from_fn(|k| &self.compressed[k][partner..][..count]);
        let [square, variance, chroma @ ..] = &mut row.own;
        for i in 0..count {
            let difference: [f32; OWN] = std::array::from_fn(|k| a[k][i] - b[k][i]);
            let mean = replicates.mean(difference);
            square[i] = mean * mean;
            variance[i] = replicates.variance(difference);
        }
        for (c, pair) in chroma.chunks_exact_mut(2).enumerate() {
            let [square, variance] = pair else { continue };
            let ratio = &self.ratios[c][first..][..count];
            let at = |plane: usize, start: usize| -> [&[f32]; 2] {
                std::array::from_fn(|group| &guide_colour[group][plane][start..][..count])
            };
            let (a, b) = (at(2 * c, first), at(2 * c, partner));
            let (ay, by) = (at(1, first), at(1, partner));
            for i in 0..count {
                let difference: [f32; 2] =
                    std::array::from_fn(|g| (a[g][i] - b[g][i]) - ratio[i] * (ay[g][i] - by[g][i]));
                let mean = groups.mean(difference);
                square[i] = mean * mean;
                variance[i] = groups.variance(difference);
            }
        }
        for (nth, (own, sums)) in row.own.iter().zip(&mut row.sums).enumerate() {
            let patch = self.patches[kind(nth)];
            let own = &own[..count];
            let sums = &mut sums[columns.clone()];
            sums.copy_from_slice(own);
            let inner = count.saturating_sub(patch);
            sums[..inner].iter_mut().zip(&own[count - inner..]).for_each(|(sum, own)| *sum += own);
            sums[count - inner..].iter_mut().zip(&own[..inner]).for_each(|(sum, own)| *sum += own);
        }
    }
}

/// The comparisons of the pixels of one row with their partners.
#[derive(Clone)]
struct Comparisons {
    /// Of each pixel, from the first column that has a partner.
    own: [Vec<f32>; STATISTICS],
    /// Over three pixels of the row.
    sums: [Vec<f32>; STATISTICS],
}

impl Comparisons {
    fn new(width: usize) -> Self {
        let blank = || std::array::from_fn(|_| vec![0.0; width]);
        Self { own: blank(), sums: blank() }
    }

    fn clear(&mut self) {
        self.sums.iter_mut().flatten().for_each(|sum| *sum = 0.0);
    }
}

/// Applies all levels of the filter, and the first one once more: after steps of two pixels and
/// more, neighbours are means of different pixels.
pub(crate) fn filtered(half: Half, surfaces: &Surfaces) -> Half {
    (0..LEVELS).chain([0]).fold(half, |half, nth| level(&half, surfaces, nth))
}

/// Filters all planes with steps of 2ⁿ pixels.
fn level(half: &Half, surfaces: &Surfaces, nth: usize) -> Half {
    let level = Level::new(half, surfaces, nth);
    let (size, width) = (half.size, half.size.width);
    let mut filtered = half.blank();
    let inputs: Vec<(&[f32], usize)> = half.planes().collect();
    let mut blocks: Vec<Vec<&mut [f32]>> = (0..size.height.div_ceil(ROWS)).map(|_| Vec::new()).collect();
    for plane in filtered.planes_mut() {
        blocks.iter_mut().zip(plane.chunks_mut(width * ROWS)).for_each(|(block, rows)| block.push(rows));
    }
    blocks.into_par_iter().enumerate().for_each(|(number, mut planes)| {
        let first = number * ROWS;
        let rows = planes[0].len() / width;
        let mut totals = [0, 1].map(|_| vec![0.0_f32; rows * width]);
        let reach = level.patches.into_iter().max().unwrap_or_default();
        let mut comparisons = vec![Comparisons::new(width); rows + 2 * reach];
        let mut weights = [0, 1].map(|_| vec![0.0_f32; width]);
        for offset in Offset::all(level.step) {
            let columns = offset.columns(width);
            if columns.is_empty() {
                continue;
            }
            let is_centre = offset.dx == 0 && offset.dy == 0;
            if !is_centre {
                for (row, compared) in comparisons.iter_mut().enumerate() {
                    compared.clear();
                    let y = (first + row) as isize - reach as isize;
                    if let Some(pair) = offset.pair(y, &columns, size) {
                        level.compare(pair, &columns, compared);
                    }
                }
            }
            for row in 0..rows {
                let Some((p, q)) = offset.pair((first + row) as isize, &columns, size) else { continue };
                if is_centre {
                    weights.iter_mut().flatten().for_each(|weight| *weight = offset.kernel);
                } else {
                    let around =
                        level.patches.map(|patch| [0, 1, 2].map(|k| &comparisons[row + reach + k * patch - patch]));
                    level.weigh(offset, (p, q), &columns, around, &mut weights);
                }
                let own = row * width + columns.start..row * width + columns.end;
                for (total, weights) in totals.iter_mut().zip(&weights) {
                    total[own.clone()].iter_mut().zip(weights).for_each(|(total, weight)| *total += weight);
                }
                for (plane, (from, kind)) in planes.iter_mut().zip(&inputs) {
                    let from = &from[q..][..columns.len()];
                    for ((sum, weight), value) in plane[own.clone()].iter_mut().zip(&weights[*kind]).zip(from) {
                        *sum += weight * value;
                    }
                }
            }
        }
        for (plane, (_, kind)) in planes.iter_mut().zip(&inputs) {
            plane.iter_mut().zip(&totals[*kind]).for_each(|(value, total)| *value /= total);
        }
    });
    filtered
}

impl Level<'_> {
    /// Computes the weights of the partners of some columns of a row, for luma and for chroma.
    fn weigh(
        &self,
        offset: Offset,
        (p, q): (usize, usize),
        columns: &Range<usize>,
        around: [[&Comparisons; 3]; 2],
        weights: &mut [Vec<f32>; 2],
    ) {
        let count = columns.len();
        let sums: [[&[f32]; 3]; STATISTICS] =
            std::array::from_fn(|k| around[kind(k)].map(|row| &row.sums[k][columns.clone()]));
        let [own, ..] = &around[0][1].own;
        let [luma, chroma] = weights;
        let (luma, chroma) = (&mut luma[..count], &mut chroma[..count]);
        self.surfaces.penalties((offset.dx, offset.dy), (p, q), luma);
        // Of the pixels in the middle, and of their partners.
        let [luma_variances, chroma_variances] = [0, 1].map(|kind| {
            let (own, around) = (&self.variances[kind], &self.around[kind]);
            (&around[p..][..count], [&own[q..][..count], &around[q..][..count]])
        });
        let (middle, partner) = (&self.luminance[p..][..count], &self.luminance[q..][..count]);
        for i in 0..count {
            let pooled: [f32; STATISTICS] = std::array::from_fn(|k| sums[k][0][i] + sums[k][1][i] + sums[k][2][i]);
            let [square, variance, x2, vx, z2, vz] = pooled;
            let surface = luma[i];
            let ratio = square / (variance + TINY);
            let single = 9.0 * own[i] / (variance + TINY);
            let of_luma =
                excess(ratio, EQUAL, LARGEST_LUMA).max(excess(single, EQUAL_SINGLE, LARGEST_SINGLE)) + surface;
            let of_chroma = (x2 / (vx + TINY)).max(z2 / (vz + TINY));
            let of_chroma = excess(of_chroma, EQUAL, LARGEST_CHROMA) + surface;
            let precise = |(middle, partner): (&[f32], [&[f32]; 2])| {
                (LARGEST_VARIANCE * middle[i] / (partner[0][i].max(partner[1][i]) + TINY)).min(1.0)
            };
            let precision = precise(luma_variances);
            let smooth = |penalty: f32| {
                let rest = (1.0 - penalty * penalty).max(0.0);
                offset.kernel * rest * rest
            };
            luma[i] = if self.luma { smooth(of_luma) * precision } else { 0.0 };
            let darker = (LARGEST_RATIO * middle[i] / (partner[i] + TINY)).min(1.0);
            chroma[i] = smooth(of_chroma) * precision.min(precise(chroma_variances)) * darker * darker;
        }
    }
}

/// Returns by how much a statistic exceeds the value of equal pixels, relative to the largest
/// excess.
fn excess(statistic: f32, equal: f32, largest: f32) -> f32 {
    (statistic - equal).max(0.0) / largest
}
