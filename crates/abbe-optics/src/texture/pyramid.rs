//! Pictures over uv, with reduced copies for minification (MIP map).

use super::mapping::UvTransform;
use super::point::{LookupRandom, TexturePoint};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary::{hypot, log2};

/// The width and the height of a picture in texels, each at least 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageSize {
    /// The number of columns.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
}

/// What a picture looks like outside the unit square of uv.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The picture repeats.
    #[default]
    Repeat,
    /// The picture repeats, and every second copy is mirrored.
    Mirror,
    /// The texels at the edges continue.
    Clamp,
}

/// How texels are interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// Linear interpolation between the four nearest texels.
    #[default]
    Bilinear,
    /// The nearest texel.
    Nearest,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct MipLevel {
    size: ImageSize,
    /// The number of the upper left texel.
    first: usize,
}

/// The texels of a picture (level 0) and of its reduced copies, each half as wide and high as the
/// level before, rounded up, down to one texel, numbered level by level and row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct ImagePattern {
    levels: Vec<MipLevel>,
    wrap: [Wrap; 2],
    filter: Filter,
    transform: UvTransform,
}

const MOST_TEXELS: usize = 1 << 29;

/// The largest ratio of the edges of a footprint within which the longer edge is sampled.
const MOST_ANISOTROPY: f64 = 64.0;

impl ImagePattern {
    /// Creates the pyramid of a picture, with wrap modes along u and v. Returns an error if the
    /// picture has no texel, or more than 2²⁹ texels with all levels.
    pub fn new(size: ImageSize, wrap: [Wrap; 2], filter: Filter, transform: UvTransform) -> Result<Self> {
        let halved = |side: usize| side.div_ceil(2);
        let (mut levels, mut first, mut size) = (Vec::new(), 0_usize, size);
        if size.width == 0 || size.height == 0 {
            return Err(Error::input("the picture has no pixels"));
        }
        loop {
            levels.push(MipLevel { size, first });
            let count = size.width.checked_mul(size.height).and_then(|count| count.checked_add(first));
            first = count.filter(|&count| count <= MOST_TEXELS).ok_or_else(|| {
                Error::input(format!("a texture of {} × {} pixels", levels[0].size.width, levels[0].size.height))
                    .expected("at most 400 million pixels")
            })?;
            if size.width == 1 && size.height == 1 {
                return Ok(Self { levels, wrap, filter, transform });
            }
            size = ImageSize { width: halved(size.width), height: halved(size.height) };
        }
    }

    /// Returns the pattern without reduced copies: a lookup samples the whole footprint.
    #[must_use]
    pub(super) fn without_copies(mut self) -> Self {
        self.levels.truncate(1);
        self
    }

    pub(super) fn texel_count(&self) -> usize {
        let last = self.levels[self.levels.len() - 1];
        last.first + last.size.width * last.size.height
    }

    /// Returns the size of the picture.
    pub fn size(&self) -> ImageSize {
        self.levels[0].size
    }

    /// Returns the values of all texels, `count` for each, from those of level 0, of which each
    /// further texel is the area's mean, so all levels have the same mean.
    pub(super) fn reduced(&self, mut values: Vec<f32>, count: usize) -> Vec<f32> {
        values.reserve_exact(count * self.texel_count() - values.len());
        let mut mean = vec![0.0_f64; count];
        for pair in self.levels.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let columns = overlaps(from.size.width, to.size.width);
            let rows = overlaps(from.size.height, to.size.height);
            for row in &rows {
                for column in &columns {
                    mean.fill(0.0);
                    for &(y, weight_y) in row {
                        for &(x, weight_x) in column {
                            let texel = count * (from.first + y * from.size.width + x);
                            let weight = weight_x * weight_y;
                            let texel = &values[texel..texel + count];
                            mean.iter_mut().zip(texel).for_each(|(mean, &value)| *mean += weight * f64::from(value));
                        }
                    }
                    values.extend(mean.iter().map(|&mean| mean as f32));
                }
            }
        }
        values
    }

    /// Selects a texel at a point: a random place on the footprint's longer edge, at the level of
    /// the shorter one, and at random between levels and nearest texels.
    pub(super) fn texel(&self, point: &TexturePoint, random: &mut LookupRandom) -> u32 {
        let point = self.transform.apply(point);
        let ImageSize { width, height } = self.levels[0].size;
        let length = |edge: [f64; 2]| hypot(edge[0] * width as f64, edge[1] * height as f64);
        let [first, second] = point.footprint.map(length);
        let (mut uv, mut number) = (point.uv, 0);
        if self.filter == Filter::Bilinear && first + second > 0.0 {
            let shift = random.uniform() - 0.5;
            uv = if first > second { point.moved(shift, 0.0) } else { point.moved(0.0, shift) };
            let texels = first.min(second).max(first.max(second) / MOST_ANISOTROPY);
            if texels > 1.0 && self.levels.len() == 1 {
                let other = random.uniform() - 0.5;
                uv = if first > second { point.moved(shift, other) } else { point.moved(other, shift) };
            } else if texels > 1.0 {
                let level = log2(texels);
                number = (random.round(level.floor(), level.fract()) as usize).min(self.levels.len() - 1);
            }
        }
        let MipLevel { size, first } = self.levels[number];
        let x = self.index(uv[0], size.width, self.wrap[0], random);
        let y = self.index(uv[1], size.height, self.wrap[1], random);
        (first + y * size.width + x) as u32
    }

    /// Returns the value, interpolated between texels, at a random point within the footprint.
    pub(super) fn interpolated(
        &self,
        point: &TexturePoint,
        random: &mut LookupRandom,
        value: impl Fn(usize) -> f64,
    ) -> f64 {
        let uv = self.transform.apply(point).moved(random.uniform() - 0.5, random.uniform() - 0.5);
        let ImageSize { width, height } = self.levels[0].size;
        let texel = |x: f64, y: f64| value(wrapped(y, height, self.wrap[1]) * width + wrapped(x, width, self.wrap[0]));
        let (x, y) = (uv[0] * width as f64, uv[1] * height as f64);
        match self.filter {
            Filter::Nearest => texel(x.floor(), y.floor()),
            Filter::Bilinear => {
                let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
                let (s, t) = (x - 0.5 - left, y - 0.5 - top);
                let row = |y: f64| (1.0 - s) * texel(left, y) + s * texel(left + 1.0, y);
                (1.0 - t) * row(top) + t * row(top + 1.0)
            }
        }
    }

    fn index(&self, coordinate: f64, count: usize, wrap: Wrap, random: &mut LookupRandom) -> usize {
        let place = coordinate * count as f64;
        let index = match self.filter {
            Filter::Nearest => place.floor(),
            Filter::Bilinear => {
                let place = place - 0.5;
                random.round(place.floor(), place - place.floor())
            }
        };
        wrapped(index, count, wrap)
    }
}

fn wrapped(index: f64, count: usize, wrap: Wrap) -> usize {
    let sides = count as f64;
    let inside = match wrap {
        Wrap::Repeat => index.rem_euclid(sides),
        Wrap::Mirror => {
            let twice = index.rem_euclid(2.0 * sides);
            if twice < sides { twice } else { 2.0 * sides - 1.0 - twice }
        }
        Wrap::Clamp => index,
    };
    // Coordinates that are not finite become 0.
    (inside.max(0.0) as usize).min(count - 1)
}

/// Divides `from` cells into `to` equal parts. Returns the cells of each and their fractions.
fn overlaps(from: usize, to: usize) -> Vec<Vec<(usize, f64)>> {
    let step = from as f64 / to as f64;
    let part = |i: usize| {
        let (low, high) = (i as f64 * step, (i + 1) as f64 * step);
        let cells = low as usize..(high.ceil() as usize).min(from);
        let fraction = |cell: usize| (high.min(cell as f64 + 1.0) - low.max(cell as f64)) / step;
        cells.map(|cell| (cell, fraction(cell))).filter(|(_, fraction)| *fraction > 0.0).collect()
    };
    (0..to).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: usize, height: usize, wrap: Wrap, filter: Filter) -> ImagePattern {
        ImagePattern::new(ImageSize { width, height }, [wrap; 2], filter, UvTransform::IDENTITY).unwrap()
    }

    #[test]
    fn reduced_copies_keep_the_mean() {
        let image = image(13, 6, Wrap::Repeat, Filter::Bilinear);
        let values: Vec<f32> = (0..78).map(|i| ((i * 37) % 78) as f32).collect();
        let all = image.reduced(values, 1);
        assert_eq!(all.len(), image.texel_count());
        for MipLevel { size, first } in &image.levels {
            let count = size.width * size.height;
            let mean = all[*first..first + count].iter().map(|value| f64::from(*value)).sum::<f64>() / count as f64;
            assert!((mean - 38.5).abs() < 1e-4, "{size:?}: {mean}");
        }
    }

    #[test]
    fn wrap_modes_continue_the_picture() {
        for (wrap, expected) in [
            (Wrap::Repeat, [2, 3, 0, 1, 2, 3, 0, 1]),
            (Wrap::Mirror, [1, 0, 0, 1, 2, 3, 3, 2]),
            (Wrap::Clamp, [0, 0, 0, 1, 2, 3, 3, 3]),
        ] {
            let image = image(4, 1, wrap, Filter::Nearest);
            let texel = |u: f64| image.texel(&TexturePoint::new([u, 0.5]), &mut LookupRandom::new(0.5));
            let found: Vec<u32> = (0..8).map(|i| texel((f64::from(i) - 1.5) / 4.0)).collect();
            assert_eq!(found, expected, "{wrap:?}");
        }
    }

    #[test]
    fn texels_are_selected_with_bilinear_weights() {
        let image = image(2, 2, Wrap::Clamp, Filter::Bilinear);
        let (mut counts, mut random, lookups) = ([0.0; 4], LookupRandom::new(0.2), 200_000);
        for _ in 0..lookups {
            counts[image.texel(&TexturePoint::new([0.25 + 0.5 * 0.3, 0.25 + 0.5 * 0.9]), &mut random) as usize] += 1.0;
        }
        for (found, expected) in counts.iter().zip([0.7 * 0.1, 0.3 * 0.1, 0.7 * 0.9, 0.3 * 0.9]) {
            assert!((found / f64::from(lookups) - expected).abs() < 0.004, "{counts:?}");
        }
    }

    /// Four texels read the level of a quarter of the width; a long narrow footprint the picture.
    #[test]
    fn the_footprint_selects_the_level() {
        let image = image(64, 64, Wrap::Repeat, Filter::Bilinear);
        let first_of = |number: usize| image.levels[number].first as u32;
        let mut random = LookupRandom::new(0.9);
        for _ in 0..100 {
            let wide = TexturePoint { uv: [0.4, 0.7], footprint: [[4.0 / 64.0, 0.0], [0.0, 4.0 / 64.0]] };
            let texel = image.texel(&wide, &mut random);
            assert!((first_of(2)..first_of(3)).contains(&texel), "{texel}");
            let narrow = TexturePoint { uv: [0.4, 0.7], footprint: [[16.0 / 64.0, 0.0], [0.0, 0.5 / 64.0]] };
            assert!(image.texel(&narrow, &mut random) < first_of(1));
        }
    }

    #[test]
    fn coordinates_that_are_not_finite_stay_inside() {
        let image = image(3, 3, Wrap::Repeat, Filter::Bilinear);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let point = TexturePoint { uv: [bad, 0.5], footprint: [[bad, 0.0], [0.0, 0.1]] };
            assert!((image.texel(&point, &mut LookupRandom::new(0.4)) as usize) < image.texel_count());
        }
    }
}
