use abbe_spectra::spectrum::SmoothReflectance;
use rayon::prelude::*;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Palette {
    /// Coefficients of smooth reflectances, 12 bytes for each texel.
    Smooth(Vec<[f32; 3]>),
    /// Values in bands of wavelengths, 4 bytes for each band and texel.
    Bands(BandValues),
}

/// Values at a few wavelengths, interpolated linearly and held beyond them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BandValues {
    /// In nm, in rising order.
    pub(super) nm: Vec<f64>,
    /// One for each wavelength, texel by texel.
    pub(super) values: Vec<f32>,
}

/// A thread fits at least this number of colours, each near the colour before.
const COLOURS_PER_TASK: usize = 4096;

impl Palette {
    /// Returns the smooth reflectances of linear sRGB colours. The components must lie in [0, 1].
    pub(super) fn smooth(colours: &[[f32; 3]]) -> Self {
        // Equal colours are fitted once, and each colour is similar to the one before in the sorted
        // list. The tasks do not depend on the number of threads.
        let bits = |index: u32| colours[index as usize].map(f32::to_bits);
        let place = |(index, colour): (usize, &[f32; 3])| (place_on_curve(*colour), index as u32);
        let mut order: Vec<(u32, u32)> = colours.par_iter().enumerate().map(place).collect();
        order.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then_with(|| (bits(a.1), a.1).cmp(&(bits(b.1), b.1))));
        let mut distinct: Vec<[f32; 3]> = order.iter().map(|&(_, index)| colours[index as usize]).collect();
        distinct.dedup_by_key(|colour| colour.map(f32::to_bits));
        let fitted: Vec<[f32; 3]> = distinct.par_chunks(COLOURS_PER_TASK).flat_map_iter(fit).collect();
        let mut coefficients = vec![[0.0; 3]; colours.len()];
        let mut number = 0;
        for &(_, index) in &order {
            number += usize::from(bits(index) != distinct[number].map(f32::to_bits));
            coefficients[index as usize] = fitted[number];
        }
        Self::Smooth(coefficients)
    }

    #[inline]
    pub(super) fn at(&self, texel: u32, nm: f64) -> f64 {
        match self {
            Self::Smooth(coefficients) => {
                SmoothReflectance::from_coefficients(coefficients[texel as usize].map(f64::from)).at(nm)
            }
            Self::Bands(bands) => bands.at(texel, nm),
        }
    }

    pub(super) fn memory_bytes(&self) -> usize {
        match self {
            Self::Smooth(coefficients) => size_of_val(coefficients.as_slice()),
            Self::Bands(bands) => size_of_val(bands.values.as_slice()),
        }
    }
}

/// Returns the place of a colour on a curve through the RGB cube, on which neighbours are similar
/// (Morton order), in 1024 levels of about equal visible difference per component.
fn place_on_curve(colour: [f32; 3]) -> u32 {
    let levels = colour.map(|component| (component.sqrt() * 1023.0) as u32);
    let bit = |i: u32| (0..3).map(|channel| (levels[channel] >> i & 1) << (3 * i + channel as u32)).sum::<u32>();
    (0..10).map(bit).sum()
}

/// Fits the reflectances of colours, each near the colour before.
fn fit(colours: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let rgb = |colour: &[f32; 3]| colour.map(f64::from);
    let mut last = SmoothReflectance::of_rgb(colours.first().map_or([0.5; 3], rgb));
    let mut fit = |colour: &[f32; 3]| {
        let found = SmoothReflectance::of_rgb_near(rgb(colour), last);
        // A saturated colour is far from all other colours in the space of the coefficients.
        last = found;
        found.coefficients().map(|coefficient| coefficient as f32)
    };
    colours.iter().map(&mut fit).collect()
}

impl BandValues {
    #[inline]
    fn at(&self, texel: u32, nm: f64) -> f64 {
        let count = self.nm.len();
        let values = &self.values[texel as usize * count..][..count];
        let above = self.nm.partition_point(|&knot| knot <= nm);
        if above == 0 || above == count {
            return f64::from(values[above.min(count - 1)]);
        }
        let (low, high) = (self.nm[above - 1], self.nm[above]);
        let fraction = (nm - low) / (high - low);
        f64::from(values[above - 1]) * (1.0 - fraction) + f64::from(values[above]) * fraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_texel_has_the_reflectance_of_its_colour() {
        let colours: Vec<[f32; 3]> =
            (0..500).map(|i| [i * 7 % 11, i * 3 % 13, i % 5].map(|level| level as f32 / 12.0)).collect();
        let palette = Palette::smooth(&colours);
        for (texel, colour) in (0..).zip(&colours) {
            let expected = SmoothReflectance::of_rgb(colour.map(f64::from));
            for nm in [420.0, 530.0, 610.0] {
                let (found, expected) = (palette.at(texel, nm), expected.at(nm));
                assert!((found - expected).abs() < 2e-4, "{colour:?} at {nm} nm: {found} instead of {expected}");
            }
        }
    }

    #[test]
    fn bands_are_interpolated_and_continue() {
        let bands = BandValues { nm: vec![400.0, 500.0, 700.0], values: vec![0.0, 0.0, 0.0, 0.2, 0.6, 1.0] };
        for (nm, expected) in [(360.0, 0.2), (400.0, 0.2), (450.0, 0.4), (500.0, 0.6), (600.0, 0.8), (800.0, 1.0)] {
            assert!((bands.at(1, nm) - expected).abs() < 1e-6, "{nm}");
        }
    }
}
