//! Coarse pictures while the reader moves something.

use abbe_session::render::CoarsePicture;
use abbe_transport::sensor::Picture;

/// The time for loading the scene and for a sketch in s. The page needs the rest of a fifth of a
/// second to show the picture.
const FRAME_S: f64 = 0.14;

/// The least fraction of the frame for the sketch, if the scene loads slowly.
const LEAST_FRACTION: f64 = 0.25;

/// The least and the largest size of a sketch.
const SIZES: (f64, f64) = (0.25, 4.0);

/// The size of the next sketch, which the times of the earlier ones decide: a slow scene or a busy
/// machine gets coarser pictures, but not fewer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SketchSize(f64);

impl Default for SketchSize {
    fn default() -> Self {
        Self(1.0)
    }
}

impl SketchSize {
    pub(crate) fn get(self) -> f64 {
        self.0
    }

    /// Notes the times of a frame in s.
    pub(crate) fn update(&mut self, load_s: f64, sketch_s: f64) {
        let wanted = self.0 * (FRAME_S - load_s).max(LEAST_FRACTION * FRAME_S) / sketch_s.max(1e-3);
        // One slow frame moves the size only half of the way.
        self.0 = (self.0 * wanted).sqrt().clamp(SIZES.0, SIZES.1);
    }
}

/// Returns a coarse picture as bytes for another worker.
pub(super) fn to_bytes(CoarsePicture { picture, photons, factor, film }: &CoarsePicture) -> Vec<u8> {
    let sizes = [picture.width, picture.height, *factor, film[0], film[1]].map(|size| size as u64);
    let numbers = sizes.into_iter().chain([*photons]).flat_map(u64::to_le_bytes);
    numbers.chain(picture.xyz.iter().flatten().flat_map(|value| value.to_le_bytes())).collect()
}

/// Returns the coarse picture of these bytes, or `None` if they are not one.
pub(super) fn of_bytes(bytes: &[u8]) -> Option<CoarsePicture> {
    let (words, rest) = bytes.as_chunks::<8>();
    let (numbers, values) = words.split_first_chunk::<6>()?;
    let [width, height, factor, film_width, film_height, photons] = numbers.map(u64::from_le_bytes);
    let size = |number: u64| usize::try_from(number).ok();
    let (width, height) = (size(width)?, size(height)?);
    let values: Vec<f64> = values.iter().map(|word| f64::from_le_bytes(*word)).collect();
    let (xyz, others) = values.as_chunks::<3>();
    if !(rest.is_empty() && others.is_empty()) || width.checked_mul(height) != Some(xyz.len()) {
        return None;
    }
    let picture = Picture { xyz: xyz.to_vec(), ..Picture::black(width, height) };
    Some(CoarsePicture { picture, photons, factor: size(factor)?, film: [size(film_width)?, size(film_height)?] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_follows_the_time_of_a_frame() {
        let size_after = |frames: usize, seconds_of: fn(f64) -> f64| {
            let mut size = SketchSize::default();
            (0..frames).for_each(|_| size.update(0.02, seconds_of(size.get())));
            size.get()
        };
        let settled = size_after(20, |size| 0.06 * size);
        assert!((settled - 2.0).abs() < 0.01, "a sketch of size 2 takes 0.12 s: {settled}");
        let settled = size_after(20, |size| 0.06 + 0.12 * size);
        assert!((settled - 0.5).abs() < 0.01, "a part of the time is fixed: {settled}");
        assert_eq!(size_after(20, |_| 10.0), SIZES.0);
        assert_eq!(size_after(20, |_| 0.0), SIZES.1);
    }

    #[test]
    fn a_coarse_picture_returns_from_its_bytes() {
        let mut picture = Picture::black(3, 2);
        picture.xyz = (0..6).map(|i| [f64::from(i), 0.1, -0.5]).collect();
        let coarse = CoarsePicture { picture, photons: 77, factor: 2, film: [6, 4] };
        let bytes = to_bytes(&coarse);
        assert_eq!(of_bytes(&bytes), Some(coarse));
        for wrong in [&bytes[1..], &bytes[..bytes.len() - 24], &bytes[..47], &[]] {
            assert_eq!(of_bytes(wrong), None);
        }
    }
}
