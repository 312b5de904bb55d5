//! Automatic exposure.

use super::develop::Development;
use super::picture::Picture;

/// The luminance of middle grey relative to white.
const MIDDLE_GREY: f64 = 0.18;

/// The fraction of the pixels that may be overexposed.
const OVEREXPOSED_SHARE: f64 = 0.005;

/// Returns the exposure of a picture. The exposure is a factor that multiplies the luminance, and
/// its unit is 1/(cd/m²). With this factor, the developed picture has a suitable brightness.
///
/// The log-average of the lit pixels becomes middle grey (0.18; after Reinhard et al. 2002). Two
/// limits apply: at most 0.5 % of the pixels may exceed the range of the display, and the
/// highlights must reach at least half of this range. Saturated colours reach the limit long before
/// white does: sodium light with a relative luminance above 0.36 is no longer orange on a display.
/// Visible light sources do not influence the exposure, because any suitable exposure shows them as
/// white.
pub fn automatic(picture: &Picture, development: &Development) -> f64 {
    let matrix = development.matrix();
    let component = |xyz: &[f64; 3], row: [f64; 3]| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
    let strongest_of = |xyz: &[f64; 3]| matrix.into_iter().map(|row| component(xyz, row)).fold(xyz[1], f64::max);
    let lit = picture.xyz.iter().filter(|xyz| xyz[1] > 0.0 && xyz.iter().all(|value| value.is_finite()));
    let (mut luminances, mut strongest): (Vec<f64>, Vec<f64>) = lit.map(|xyz| (xyz[1], strongest_of(xyz))).unzip();
    if luminances.is_empty() {
        return 1.0;
    }
    luminances.sort_by(f64::total_cmp);
    strongest.sort_by(f64::total_cmp);
    let metered = without_light_sources(&strongest).len();
    let highlight = strongest[((metered - 1) as f64 * (1.0 - OVEREXPOSED_SHARE)) as usize];
    // Pixels far darker than the highlights (an unlit background) are not metered.
    let luminances = &luminances[..metered];
    let bright = &luminances[luminances.partition_point(|&y| y < highlight * 1e-3)..];
    let log_mean = bright.iter().map(|y| y.ln()).sum::<f64>() / bright.len().max(1) as f64;
    let grey = MIDDLE_GREY / log_mean.exp();
    grey.clamp(0.5 / highlight, 1.0 / highlight)
}

/// Removes the pixels of light sources from sorted brightnesses. Light sources are the brightest
/// pixels. They are at most a tenth of all pixels. A gap in brightness separates light sources from
/// the other pixels. The ends of the gap differ by a factor of eight, and few pixels are inside the
/// gap. Illuminated surfaces and caustics become gradually darker towards their surroundings, so
/// they leave no such gap.
fn without_light_sources(sorted: &[f64]) -> &[f64] {
    const GAP: f64 = 8.0;
    const LARGEST_SHARE: f64 = 0.1;
    /// The largest ratio of the number of pixels in the gap to the number of pixels of light
    /// sources. The pixels in the gap are at the edges of light sources.
    const EDGES: f64 = 0.25;
    let below = |y: f64| sorted.partition_point(|&other| other < y);
    let mut top = sorted[sorted.len() - 1];
    let first = sorted[((sorted.len() - 1) as f64 * (1.0 - LARGEST_SHARE)) as usize];
    while top / GAP >= first {
        let (rest, lamps) = (below(top / GAP), sorted.len() - below(top));
        let between = sorted.len() - rest - lamps;
        if lamps > 0 && (between as f64) < EDGES * lamps as f64 {
            return &sorted[..rest];
        }
        top /= 2.0_f64.sqrt();
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::xyz_to_linear_srgb;

    fn automatic(picture: &Picture) -> f64 {
        super::automatic(picture, &Development::default())
    }

    /// Returns a picture of white light with these luminances.
    fn picture(luminances: impl IntoIterator<Item = f64>) -> Picture {
        let xyz: Vec<[f64; 3]> = luminances.into_iter().map(|y| [0.9505 * y, y, 1.089 * y]).collect();
        let mut picture = Picture::black(xyz.len(), 1);
        picture.xyz = xyz;
        picture
    }

    /// Returns the luminances of a room, from 10 to 100 cd/m².
    fn room() -> impl Iterator<Item = f64> {
        (0..10_000).map(|i| 10.0 * 10.0_f64.powf(f64::from(i) * 1e-4))
    }

    #[test]
    fn an_even_room_has_its_log_average_at_middle_grey() {
        let log_mean = room().map(f64::ln).sum::<f64>() / 10_000.0;
        assert!((automatic(&picture(room())) * log_mean.exp() / 0.18 - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_lamp_in_view_does_not_darken_the_room() {
        let lamp = std::iter::repeat_n(20_000.0, 300);
        let edge = (0..60).map(|i| 300.0 * f64::from(i));
        let with_lamp = automatic(&picture(room().chain(lamp).chain(edge)));
        assert!((with_lamp / automatic(&picture(room())) - 1.0).abs() < 0.05, "{with_lamp}");
    }

    #[test]
    fn a_caustic_on_a_dark_table_is_not_overexposed() {
        // The caustic fades from 5000 cd/m² into a table of 10 cd/m².
        let caustic = (0..300).map(|i| 5000.0 * (-f64::from(i) / 60.0).exp());
        let table = std::iter::repeat_n(10.0, 9_700);
        let exposure = automatic(&picture(caustic.clone().chain(table)));
        let burnt = caustic.filter(|y| y * exposure > 1.0).count();
        assert!((20..=55).contains(&burnt), "{burnt} of 10,000 pixels");
    }

    #[test]
    fn sodium_light_stays_orange() {
        // Grey paper under sodium light, from black to white. The brightest pixel is as bright as
        // the orange of the display.
        let mut picture = picture((1..=1000).map(f64::from));
        picture.xyz.iter_mut().for_each(|xyz| *xyz = [1.3299 * xyz[1], xyz[1], 0.0016 * xyz[1]]);
        let red = xyz_to_linear_srgb(picture.xyz[990].map(|value| value * automatic(&picture)))[0];
        assert!((0.9..1.01).contains(&red), "{red}");
    }

    #[test]
    fn a_wider_gamut_allows_a_brighter_exposure() {
        // Sodium light is outside sRGB but well inside Rec. 2020. If white is balanced for candle
        // light, the red component of sodium light is weaker.
        let mut picture = picture((1..=1000).map(f64::from));
        picture.xyz.iter_mut().for_each(|xyz| *xyz = [1.3299 * xyz[1], xyz[1], 0.0016 * xyz[1]]);
        let exposure =
            |space, white| super::automatic(&picture, &Development { space, white, ..Development::default() });
        use crate::colour::RgbSpace::{Rec2020, Srgb};
        assert!(exposure(Rec2020, None) > 1.3 * exposure(Srgb, None));
        assert!(exposure(Srgb, Some([1.24, 1.0, 0.13])) > 1.3 * exposure(Srgb, None));
    }

    #[test]
    fn extreme_pictures_have_a_finite_exposure() {
        assert_eq!(automatic(&picture([0.0, 0.0])), 1.0);
        assert!((automatic(&picture([4.0; 100])) - 0.5 / 4.0).abs() < 1e-4, "grey paper is shown as bright paper");
        assert!(automatic(&picture([1e-9, 1e9])).is_finite());
    }
}
