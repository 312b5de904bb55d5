//! The self-contained HTML page that compares two pictures: both pictures, maps of their
//! differences, and the results.

use maud::{Markup, html};

use super::compare::{Comparison, ErrorScale, delta_e_map};
use super::data_uri::data_uri;
use super::heat::{self, heat};
use super::page::document;
use super::png::encode as encode_png;
use super::selection::Selection;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::exp2;
use abbe_transport::sensor::{Development, DisplayImage, Picture, develop_with_reach};

#[derive(Debug, Clone, Copy)]
pub struct PicturePair<'a> {
    pub picture: (&'a str, &'a Picture),
    pub reference: (&'a str, &'a Picture),
    /// The tone curve with which both pictures are shown.
    pub tone: ToneCurve,
}

/// From this relative difference in Y, the map has its full saturation.
const SATURATED_DIFFERENCE: f64 = 0.5;

/// If ΔE2000 is at least this value, its colour in the map is white.
const WHITE_DELTA_E: f64 = 10.0;

const ERROR_CAPTION: &str = "√(noise² + bias²) relative to Y, blue-green if it is unknown.";

/// Returns the page. Returns a machine error if a picture is too large for PNG.
pub fn page(pair: PicturePair<'_>, selection: &Selection, comparison: &Comparison) -> Result<String> {
    let PicturePair { picture: (name_a, a), reference: (name_b, b), tone } = pair;
    let development = Development { tone, ..Development::default() };
    let exposure = exp2(comparison.exposure_ev);
    let reach = development.reach(b);
    let shown = |picture: &Picture| develop_with_reach(picture, exposure, reach, &development);
    let title = format!("{name_a} against {name_b}");
    let signed = "Difference in Y, relative to the reference: red where A is brighter, blue where A is darker.";
    let heat_legend = |words: [&str; 3]| legend(&heat::css_colours(), words);
    let body = html! {
        h1 { (title) }
        (table(comparison))
        h2 { "Both pictures" }
        (slider(&shown(a), &shown(b), (name_a, name_b))?)
        div.pictures {
            (figure(&luminance_differences(a, b, selection), signed, &legend("#00f, #fff, #f00", ["−50 %", "0", "50 %"]))?)
            (figure(
                &colour_differences(a, b, selection, exposure),
                "Colour difference ΔE2000.",
                &heat_legend(["0", "5", "≥ 10"]),
            )?)
            @for (letter, picture) in [("A", a), ("B", b)] {
                @if (0..picture.xyz.len()).any(|pixel| picture.error(pixel).is_some()) {
                    (figure(
                        &relative_error_map(picture, selection),
                        &format!("Error that {letter} reports: {ERROR_CAPTION}"),
                        &heat_legend(["0", "25 %", "≥ 50 %"]),
                    )?)
                }
            }
        }
        p { "Both pictures are shown at one exposure, EV "
            (format!("{:.2}", comparison.exposure_ev)) ", with the tone curve " (tone.name()) ". In the maps, pixels that are not selected are grey." }
    };
    Ok(document(&title, COMPARISON_STYLE, &body))
}

const COMPARISON_STYLE: &str = ".pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); gap: 1.5rem; \
    margin: 1.5rem 0; }\nfigure img { width: 100%; height: auto; image-rendering: pixelated; background: #000; }\n\
    .legend { height: .8rem; border: 1px solid var(--rule); }\n\
    .ticks { display: flex; justify-content: space-between; font-size: .85rem; color: var(--soft); }\n";

fn table(comparison: &Comparison) -> Markup {
    let number = |value: f64| format!("{value:.6}");
    html! {
        table {
            @for (name, value) in [
                ("Relative mean square error", number(comparison.relative_mse)),
                ("Error of a typical pixel of A (Y, without the worst 2 % of the pixels, and without the error of B)", number(comparison.typical_error)),
                ("Relative mean square error without the worst 2 % of the pixels", number(comparison.relative_mse_trimmed)),
                ("RMSE of Y in cd/m²", number(comparison.rmse)),
                ("Mean Y, A / B", number(comparison.mean_ratio)),
                ("ΔE2000, mean", number(comparison.delta_e_2000.mean)),
                ("ΔE2000, 95th percentile", number(comparison.delta_e_2000.p95)),
                ("Share of pixels with |z| < 1.96", comparison.z.map_or("errors unknown".to_string(), |z| number(z.fraction))),
                ("Probability that noise explains the largest difference", comparison.z.map_or("errors unknown".to_string(), |z| number(z.p))),
                (
                    "Share of pixels where B lies in A's 95 % interval",
                    comparison.covered.map_or("errors unknown".to_string(), |covered| number(covered.fraction)),
                ),
                ("Pixels compared", comparison.pixels.to_string()),
                ("Pixels of A whose error is unknown", comparison.unknown_pixels.to_string()),
                ("Pixels that are not finite", comparison.non_finite_pixels.to_string()),
            ] {
                tr { th scope="row" { (name) } td { (value) } }
            }
        }
    }
}

fn figure(screen: &DisplayImage, caption: &str, legend: &Markup) -> Result<Markup> {
    let source = data_uri("image/png", &encode_png(screen)?);
    Ok(html! { figure { img src=(source) alt=(caption); (legend) figcaption { (caption) } } })
}

/// Returns the legend of a map, with the values at the left end, in the middle and at the right.
fn legend(colours: &str, values: [&str; 3]) -> Markup {
    html! {
        div.legend style={ "background: linear-gradient(to right, " (colours) ")" } {}
        div.ticks { @for value in values { span { (value) } } }
    }
}

/// Returns two pictures with a slider: A is on the left of the handle, and B is on the right.
fn slider(a: &DisplayImage, b: &DisplayImage, names: (&str, &str)) -> Result<Markup> {
    let [left, right] = [encode_png(a)?, encode_png(b)?].map(|bytes| data_uri("image/png", &bytes));
    let (name_a, name_b) = names;
    Ok(html! {
        div.stage style={ "aspect-ratio:" (a.width) "/" (a.height) } {
            img src=(left) alt={ "A: " (name_a) };
            img.over src=(right) alt={ "B, the reference: " (name_b) };
            div.handle {}
            input.splitter type="range" min="0" max="100" step="0.1" value="50" aria-label="where picture A ends"
                oninput="this.parentNode.style.setProperty('--split', this.value + '%')";
        }
        p.soft { "Drag across the picture to compare. Left: A, " (name_a) ". Right: B, the reference, " (name_b) "." }
    })
}

const UNSELECTED_COLOUR: [u8; 3] = [128, 128, 128];

/// Builds a map. `colour` returns the colour of a selected pixel; all others are grey.
fn pixel_map(of: &Picture, selection: &Selection, colour: impl Fn(usize) -> [u8; 3]) -> DisplayImage {
    let width = of.width;
    let pixel = |i: usize| if selection.selects(i % width, i / width, width) { colour(i) } else { UNSELECTED_COLOUR };
    DisplayImage::of_srgb(width, of.height, (0..of.xyz.len()).map(pixel).collect())
}

fn luminance_differences(a: &Picture, b: &Picture, selection: &Selection) -> DisplayImage {
    let scale = ErrorScale::of(b);
    pixel_map(b, selection, |i| {
        let (a, b) = (a.xyz[i][1], b.xyz[i][1]);
        let fraction = ((a - b) / scale.unit(b, 1) / SATURATED_DIFFERENCE).clamp(-1.0, 1.0);
        let faded = (255.0 * (1.0 - fraction.abs())) as u8;
        if fraction > 0.0 { [255, faded, faded] } else { [faded, faded, 255] }
    })
}

/// Builds a map of the relative error that the picture itself reports.
fn relative_error_map(of: &Picture, selection: &Selection) -> DisplayImage {
    let errors: Vec<Option<f64>> = of.relative_errors().collect();
    pixel_map(of, selection, |i| errors[i].map_or(heat::UNKNOWN_COLOUR, |error| heat(error / heat::WHITE_ERROR)))
}

/// Builds a map of ΔE2000 of every selected pixel, both pictures with an exposure in 1/(cd/m²):
/// from black for 0 through violet and orange to white for 10 or more.
pub fn colour_differences(a: &Picture, b: &Picture, selection: &Selection, exposure: f64) -> DisplayImage {
    let differences = delta_e_map(a, b, exposure);
    pixel_map(b, selection, |i| heat(differences[i] / WHITE_DELTA_E))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::compare::compare;
    use crate::output::selection::Region;

    #[test]
    fn the_page_contains_four_pictures_and_no_links() {
        let mut a = Picture::black(4, 2);
        a.xyz.fill([1.0; 3]);
        let mut b = a.clone();
        b.xyz[3] = [2.0; 3];
        let comparison = compare(&a, &b, &Selection::default()).unwrap();
        let pair = PicturePair { picture: ("<a>.exr", &a), reference: ("b.exr", &b), tone: ToneCurve::RollOff };
        let page = page(pair, &Selection::default(), &comparison).unwrap();
        assert_eq!(page.matches("src=\"data:image/png;base64,").count(), 4);
        assert!(!page.contains("http") && !page.contains("<script"), "the page is self-contained");
        assert!(page.contains("&lt;a&gt;.exr") && !page.contains("<a>"));
        assert!(page.contains(&format!("{:.6}", comparison.relative_mse)));
    }

    #[test]
    fn brighter_is_red_darker_blue_and_unselected_grey() {
        let mut b = Picture::black(4, 1);
        b.xyz.fill([1.0; 3]);
        let mut a = b.clone();
        (a.xyz[0][1], a.xyz[1][1], a.xyz[3][1]) = (5.0, 0.0, 5.0);
        let selection = Selection { regions: vec![Region { x0: 0, y0: 0, x1: 3, y1: 1 }], mask: None };
        let shown = luminance_differences(&a, &b, &selection);
        assert_eq!(
            shown,
            DisplayImage::of_srgb(4, 1, vec![[255, 0, 0], [0, 0, 255], [255, 255, 255], UNSELECTED_COLOUR])
        );
    }
}
