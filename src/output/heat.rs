//! Heat maps: a picture's numbers as colours, and its relative error as a picture.

use crate::sensor::{Picture, Screen};

/// A pixel of which nothing is known: no light reached it.
pub const UNKNOWN: [u8; 3] = [0, 96, 128];

/// The relative error that is shown in white.
pub const FULL_ERROR: f64 = 0.5;

/// A share from 0 to 1 as black over violet and orange to white, brighter all the way; NaN is white.
pub fn heat(share: f64) -> [u8; 3] {
    const STOPS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [90.0, 20.0, 130.0], [240.0, 120.0, 30.0], [255.0, 255.0, 255.0]];
    let place = if share < 1.0 { share.max(0.0) * 3.0 } else { 3.0 };
    let stop = (place as usize).min(2);
    let t = place - stop as f64;
    [0, 1, 2].map(|c| (STOPS[stop][c] + t * (STOPS[stop + 1][c] - STOPS[stop][c])).round() as u8)
}

/// A picture's relative error: each pixel's, noise and bias together, over √(Y² + 0.01 m²), m the picture's mean Y. 0 is black, [`FULL_ERROR`] and
/// more white, unknown [`UNKNOWN`].
pub fn error_map(picture: &Picture) -> Screen {
    let colours = relative_errors(picture).map(|error| error.map_or(UNKNOWN, |error| heat(error / FULL_ERROR)));
    Screen::of_srgb(picture.width, picture.height, colours.collect())
}

/// Each pixel's relative error, as in [`error_map`].
pub(super) fn relative_errors(picture: &Picture) -> impl Iterator<Item = Option<f64>> {
    let dark = 0.01 * picture.mean_y().powi(2);
    let unit = move |pixel: usize| (picture.xyz[pixel][1].powi(2) + dark).sqrt();
    (0..picture.xyz.len()).map(move |pixel| picture.error(pixel).map(|error| error / unit(pixel)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_shares_are_brighter() {
        let brightness = |share: f64| heat(share).map(u32::from).iter().sum::<u32>();
        assert!((0..100).all(|i| brightness(f64::from(i + 1) * 0.01) >= brightness(f64::from(i) * 0.01)));
        assert_eq!([0.0, 1.0, 7.0, f64::INFINITY, f64::NAN].map(brightness), [0, 765, 765, 765, 765]);
    }

    #[test]
    fn an_error_map_shows_noise_and_bias_together_and_what_is_unknown() {
        let mut picture = Picture::black(4, 1);
        picture.xyz.fill([1.0; 3]);
        picture.noise = vec![0.0, 0.3, 0.9, -1.0];
        picture.bias = vec![0.0, 0.4, 0.0, -1.0];
        let full = FULL_ERROR * 1.01_f64.sqrt();
        let known = [0.0, 0.5 / full, 1.0].map(heat);
        assert_eq!(error_map(&picture), Screen::of_srgb(4, 1, vec![known[0], known[1], known[2], UNKNOWN]));
    }
}
