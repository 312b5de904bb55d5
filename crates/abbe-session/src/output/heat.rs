//! Heat maps: numbers as colours, and the relative error of a picture as an image.

use abbe_transport::sensor::{DisplayImage, Picture};

/// The colour of a pixel whose error is unknown because no light reached it.
pub const UNKNOWN_COLOUR: [u8; 3] = [0, 96, 128];

/// The map shows this relative error, and all larger ones, as white.
pub const WHITE_ERROR: f64 = 0.5;

/// The colours of the scale at equal distances, from 0 to 1.
const HEAT_COLOURS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [90.0, 20.0, 130.0], [240.0, 120.0, 30.0], [255.0, 255.0, 255.0]];

/// Returns the colours of the scale at equal distances as CSS colours, separated by commas.
pub fn css_colours() -> String {
    HEAT_COLOURS.map(|[r, g, b]| format!("rgb({r} {g} {b})")).join(", ")
}

/// Returns the colour of a fraction from 0 to 1, from black through violet and orange to white with
/// increasing brightness. NaN is white.
pub fn heat(fraction: f64) -> [u8; 3] {
    let place = if fraction < 1.0 { fraction.max(0.0) * 3.0 } else { 3.0 };
    let stop = (place as usize).min(2);
    let t = place - stop as f64;
    [0, 1, 2].map(|c| (HEAT_COLOURS[stop][c] + t * (HEAT_COLOURS[stop + 1][c] - HEAT_COLOURS[stop][c])).round() as u8)
}

/// Returns a map of the relative error √(noise² + bias²) / √(Y² + 0.01 m²) of a picture with the
/// mean m of Y: black for 0, white from [`WHITE_ERROR`], and [`UNKNOWN_COLOUR`] if it is unknown.
pub fn error_map(picture: &Picture) -> DisplayImage {
    let colours =
        picture.relative_errors().map(|error| error.map_or(UNKNOWN_COLOUR, |error| heat(error / WHITE_ERROR)));
    DisplayImage::of_srgb(picture.width, picture.height, colours.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_fractions_are_brighter() {
        let brightness = |fraction: f64| heat(fraction).map(u32::from).iter().sum::<u32>();
        assert!((0..100).all(|i| brightness(f64::from(i + 1) * 0.01) >= brightness(f64::from(i) * 0.01)));
        assert_eq!([0.0, 1.0, 7.0, f64::INFINITY, f64::NAN].map(brightness), [0, 765, 765, 765, 765]);
    }

    /// An error map combines noise and bias, and shows which pixels have an unknown error.
    #[test]
    fn an_error_map_combines_noise_and_bias() {
        let mut picture = Picture::black(4, 1);
        picture.xyz.fill([1.0; 3]);
        picture.noise = vec![Some(0.0), Some(0.3), Some(0.9), None];
        picture.bias = vec![Some(0.0), Some(0.4), Some(0.0), None];
        let full = WHITE_ERROR * 1.01_f64.sqrt();
        let known = [0.0, 0.5 / full, 1.0].map(heat);
        assert_eq!(
            error_map(&picture),
            DisplayImage::of_srgb(4, 1, vec![known[0], known[1], known[2], UNKNOWN_COLOUR])
        );
    }
}
