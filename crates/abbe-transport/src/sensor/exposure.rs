//! Automatic exposure.

use super::picture::Picture;
use abbe_spectra::colour::xyz_to_linear_srgb;
use abbe_spectra::math::elementary::{exp, ln, powf};

/// The luminance of middle grey relative to white.
const MIDDLE_GREY: f64 = 0.18;

/// The luminance relative to white that the highlights reach at least.
const LEAST_HIGHLIGHT: f64 = 0.5;

/// The fraction of the pixels that are brighter than the highlights.
const ABOVE_HIGHLIGHT: f64 = 0.005;

/// The contrast of a display. Pixels darker than the highlights by more than this factor count
/// less.
const CONTRAST: f64 = 1000.0;

/// The largest influence of a pixel on the metered luminance, as a natural logarithm: two stops.
const LARGEST_INFLUENCE: f64 = 2.0 * std::f64::consts::LN_2;

/// The most pixels of the log-average, evenly spaced by luminance.
const MOST_METERED: usize = 1 << 16;

/// A pixel is coloured if its smallest linear component is below this fraction of its largest.
const GREYEST_COLOUR: f64 = 0.5;

/// A coloured pixel is a highlight if its largest component is at least two stops above middle
/// grey, at the exposure that shows the log-average as middle grey.
const COLOURED_HIGHLIGHT: f64 = 4.0 * MIDDLE_GREY;

/// The largest component that three quarters of the coloured highlights do not exceed. Tone curves
/// turn much brighter colours to white.
const BRIGHTEST_COLOUR: f64 = 2.0;

/// The fraction of the lit pixels that must be coloured highlights for their full influence.
const COLOURED_FRACTION: f64 = 0.005;

/// The fractions of the lit pixels between which the influence of coloured highlights ends: larger
/// ones are the subject of the picture, and the log-average contains them.
const LARGE_FRACTIONS: [f64; 2] = [0.1, 0.2];

/// The smallest factor by which coloured highlights reduce the exposure: four stops.
const LEAST_REDUCTION: f64 = 1.0 / 16.0;

/// Returns the exposure in 1/(cd/m²) for a suitable brightness of the developed picture.
///
/// The log-average of the lit pixels becomes middle grey (0.18; Reinhard et al. 2002). Caustics,
/// glints and the sky may be thousands of times brighter than the rest, so it is Huber's robust
/// estimate of location (Huber 1964): a pixel that differs by more than two stops counts as if it
/// differed by two stops. Pixels darker than a thousandth of the highlights count in proportion to
/// their squared luminance, because a display cannot show both. Visible light sources do not count,
/// because any suitable exposure shows them as white.
///
/// With little contrast, the exposure is raised until the highlights reach half of the range of the
/// display.
///
/// White highlights may be overexposed, but a spectrum would lose its colours. If the picture has
/// coloured highlights, the exposure is reduced until three quarters of them keep their colour.
pub fn automatic(picture: &Picture) -> f64 {
    let luminances = picture.xyz.iter().map(|xyz| xyz[1] as f32);
    let mut luminances: Vec<f32> = luminances.filter(|y| *y > 0.0 && y.is_finite()).collect();
    if luminances.is_empty() {
        return 1.0;
    }
    luminances.sort_unstable_by(f32::total_cmp);
    let metered = without_light_sources(&luminances);
    let highlight = f64::from(metered[((metered.len() - 1) as f64 * (1.0 - ABOVE_HIGHLIGHT)) as usize]);
    let step = metered.len().div_ceil(MOST_METERED);
    let sample = metered.iter().skip(step / 2).step_by(step).map(|y| f64::from(*y));
    let weighted: Vec<(f64, f64)> = sample.map(|y| (ln(y), (y * CONTRAST / highlight).min(1.0).powi(2))).collect();
    let exposure = (MIDDLE_GREY / exp(robust_mean(&weighted))).max(LEAST_HIGHLIGHT / highlight);
    let brightest = metered[metered.len() - 1];
    exposure * reduction(picture, exposure, brightest, metered.len())
}

/// Returns the factor of at most 1 by which coloured highlights reduce an exposure. Pixels with a
/// luminance above `brightest` are light sources, and `lit` counts the others.
fn reduction(picture: &Picture, exposure: f64, brightest: f32, lit: usize) -> f64 {
    let peaks = picture.xyz.iter().filter(|xyz| xyz[1] > 0.0 && xyz[1] as f32 <= brightest).filter_map(|xyz| {
        let [r, g, b] = xyz_to_linear_srgb(*xyz).map(|component| component * exposure);
        let (least, peak) = (r.min(g).min(b), r.max(g).max(b));
        (peak >= COLOURED_HIGHLIGHT && peak.is_finite() && least < GREYEST_COLOUR * peak).then_some(peak)
    });
    let mut peaks: Vec<f64> = peaks.collect();
    if peaks.is_empty() {
        return 1.0;
    }
    let rank = 3 * (peaks.len() - 1) / 4;
    let upper_quartile = *peaks.select_nth_unstable_by(rank, f64::total_cmp).1;
    let fraction = peaks.len() as f64 / lit as f64;
    let [from, to] = LARGE_FRACTIONS;
    let influence = (fraction / COLOURED_FRACTION).min((to - fraction) / (to - from)).clamp(0.0, 1.0);
    powf((BRIGHTEST_COLOUR / upper_quartile).clamp(LEAST_REDUCTION, 1.0), influence)
}

/// Returns Huber's estimate of location for sorted pairs of a value and a weight: the value m for
/// which the weighted differences from m, each limited to ±[`LARGEST_INFLUENCE`], sum to 0. The sum
/// falls monotonically with m, so bisection finds it.
fn robust_mean(values: &[(f64, f64)]) -> f64 {
    let pull = |m: f64| -> f64 {
        values.iter().map(|(value, weight)| weight * (value - m).clamp(-LARGEST_INFLUENCE, LARGEST_INFLUENCE)).sum()
    };
    let (mut low, mut high) = (values[0].0, values[values.len() - 1].0);
    // A thousandth of a stop is invisible.
    while high - low > 1e-3 * std::f64::consts::LN_2 {
        let middle = 0.5 * (low + high);
        if pull(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Removes light sources from sorted brightnesses: the brightest pixels, at most a tenth of all,
/// above a gap of a factor of eight with few pixels inside. Illuminated surfaces and caustics
/// darken gradually towards their surroundings, so they leave no such gap. A spectrum on a black
/// wall leaves one, but its own brightness varies.
fn without_light_sources(sorted: &[f32]) -> &[f32] {
    const GAP: f32 = 8.0;
    const LARGEST_FRACTION: f64 = 0.1;
    /// The pixels in the gap, at the edges of light sources, relative to those of the sources.
    const EDGES: f64 = 0.25;
    let below = |y: f32| sorted.partition_point(|&other| other < y);
    let mut top = sorted[sorted.len() - 1];
    let first = sorted[((sorted.len() - 1) as f64 * (1.0 - LARGEST_FRACTION)) as usize];
    while top / GAP >= first {
        let (rest, lamps) = (below(top / GAP), sorted.len() - below(top));
        let between = sorted.len() - rest - lamps;
        if lamps > 0 && (between as f64) < EDGES * lamps as f64 && is_uniform(&sorted[sorted.len() - lamps..]) {
            return &sorted[..rest];
        }
        top /= 2.0_f32.sqrt();
    }
    sorted
}

/// Returns true if half of the brightnesses are within a tenth of their median, as for a lamp.
fn is_uniform(sorted: &[f32]) -> bool {
    let median = sorted[sorted.len() / 2];
    let near = sorted.partition_point(|&y| y <= 1.1 * median) - sorted.partition_point(|&y| y < 0.9 * median);
    2 * near >= sorted.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::colour::linear_srgb_to_xyz;

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
    fn a_caustic_does_not_darken_the_room() {
        // The caustic covers 2 % of the film and is up to 1000 times as bright as the room.
        let caustic = (0..200).map(|i| 50_000.0 * (-f64::from(i) / 40.0).exp());
        let with_caustic = automatic(&picture(room().chain(caustic)));
        let ratio = with_caustic / automatic(&picture(room()));
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn a_sky_darkens_the_room_by_less_than_a_stop() {
        let sky = (0..3000).map(|i| 5000.0 + f64::from(i));
        let ratio = automatic(&picture(room().chain(sky))) / automatic(&picture(room()));
        assert!((0.5..0.9).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_spectrum_on_a_dark_wall_is_exposed() {
        // The spectrum covers 3 % of the film. The wall is black, or it reflects a little light.
        let spectrum = || (0..300).map(|i| 100.0 * (0.2 + (f64::from(i) / 300.0 * std::f64::consts::PI).sin()));
        for wall in [0.0, 1e-9, 1e-4, 1e-3, 1e-2] {
            let film = picture(std::iter::repeat_n(wall, 9_700).chain(spectrum()));
            let shown = 80.0 * automatic(&film);
            assert!((0.15..0.6).contains(&shown), "{wall}: {shown}");
        }
    }

    /// Returns a picture of an evenly lit room, and light of one colour in linear sRGB.
    fn room_with_colour(pixels: usize, rgb: impl Fn(usize) -> [f64; 3]) -> Picture {
        let mut film = picture(room());
        film.xyz.extend((0..pixels).map(|i| linear_srgb_to_xyz(rgb(i))));
        film
    }

    /// The spectrum covers 1 % of the film and is up to 200 times as bright as the room.
    #[test]
    fn a_spectrum_in_a_lit_room_keeps_its_colours() {
        let brightness = |i: usize| 100.0 + 60.0 * i as f64;
        let film = room_with_colour(100, |i| [brightness(i), 0.2 * brightness(i), 0.0]);
        let shown = automatic(&film) * brightness(74);
        assert!((shown - BRIGHTEST_COLOUR).abs() < 0.1, "{shown}");
        let white = room_with_colour(100, |i| [brightness(i); 3]);
        assert!((automatic(&white) / automatic(&picture(room())) - 1.0).abs() < 0.1, "white light may be overexposed");
    }

    /// Where coloured light fills a fifth of the film, it is the subject, and its log-average
    /// counts.
    #[test]
    fn large_coloured_surfaces_do_not_darken_the_picture() {
        let shown = |pixels: usize| automatic(&room_with_colour(pixels, |_| [0.0, 0.0, 2e3]));
        assert!(shown(3000) > 3.0 * shown(1000), "{} {}", shown(3000), shown(1000));
    }

    /// Single coloured pixels, such as fireflies, have little influence, and the influence grows
    /// steadily with their number.
    #[test]
    fn coloured_pixels_influence_the_exposure_by_their_number() {
        let with = |pixels: usize| automatic(&room_with_colour(pixels, |_| [0.0, 0.0, 5e3]));
        let factors: Vec<f64> = (0..60).map(|pixels| with(pixels) / with(0)).collect();
        assert!(factors[3] > 0.8 && factors[59] < 0.2, "{} {}", factors[3], factors[59]);
        assert!(factors.windows(2).all(|pair| pair[1] < 1.01 * pair[0] && pair[1] > 0.9 * pair[0]), "{factors:?}");
    }

    #[test]
    fn extreme_pictures_have_a_finite_exposure() {
        assert_eq!(automatic(&picture([0.0, 0.0])), 1.0);
        assert!((automatic(&picture([4.0; 100])) - 0.5 / 4.0).abs() < 1e-4, "grey paper is shown as bright paper");
        assert!((automatic(&picture([7.0])) - 0.5 / 7.0).abs() < 1e-9, "a film of one pixel");
        assert!(automatic(&picture([f64::NAN, f64::INFINITY, 1.0])).is_finite());
        assert!(automatic(&picture([1e-9, 1e9])).is_finite());
    }
}
