//! The HTML pages of `abbe`, opened in a browser.

use crate::browser::{Scheme, Seen, open};
use image::{Rgb, RgbImage};
use std::collections::BTreeMap;
use std::process::Command;

/// The page of low-pressure sodium and its best match from a red and a green LED.
fn sodium_page() -> String {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["lamps", "sodium-low-pressure", "--match", "led/red", "led/green", "--html", "page.html"];
    let status =
        Command::new(env!("CARGO_BIN_EXE_abbe")).current_dir(folder.path()).args(arguments).output().unwrap().status;
    assert!(status.success());
    std::fs::read_to_string(folder.path().join("page.html")).unwrap()
}

fn counts(picture: &RgbImage) -> BTreeMap<[u8; 3], usize> {
    let mut counts = BTreeMap::new();
    // Most neighbours are equal.
    for run in picture.as_raw().as_chunks().0.chunk_by(|a, b| a == b) {
        *counts.entry(run[0]).or_insert(0) += run.len();
    }
    counts
}

/// Returns the colours of all swatches in the page's HTML.
fn swatches(page: &str) -> Vec<[u8; 3]> {
    let component = |text: &str, i: usize| u8::from_str_radix(&text[2 * i..2 * i + 2], 16).unwrap();
    let colours = page.split("background:#").skip(1).map(|rest| [0, 1, 2].map(|i| component(rest, i)));
    colours.collect()
}

/// Checks that the page fits the window: its right edge contains only the paper's colour, which is
/// returned.
#[track_caller]
fn paper_at_the_edge(picture: &RgbImage) -> Rgb<u8> {
    let paper = *picture.get_pixel(0, 0);
    let (width, height) = picture.dimensions();
    let edge = (width - 6..width).flat_map(|x| (0..height).map(move |y| (x, y)));
    for (x, y) in edge {
        assert_eq!(*picture.get_pixel(x, y), paper, "the page overflows at {x}, {y}");
    }
    paper
}

#[test]
fn the_lamp_page_renders_in_every_scheme_and_width() {
    let Some(browser) = crate::browser::find() else { return };
    let page = sodium_page();
    let swatches = swatches(&page);
    assert!(swatches.len() > 150, "{}", swatches.len());
    let cases = [
        ((1280, 6000), Scheme::Light, [255, 255, 255]),
        ((1280, 6000), Scheme::Dark, [22, 24, 27]),
        ((420, 12_000), Scheme::Light, [255, 255, 255]),
    ];
    for (size, scheme, paper) in cases {
        let Seen { picture, console, requests } = open(browser, &page, size, scheme);
        assert_eq!((picture.dimensions(), console, requests), (size, Vec::new(), Vec::new()));
        let counts = counts(&picture);
        assert!(counts.len() > 2000, "{} colours are too few for these plots", counts.len());
        for swatch in &swatches {
            assert!(counts.get(swatch).is_some_and(|&count| count >= 100), "{swatch:?} is not to be seen");
        }
        assert_eq!(paper_at_the_edge(&picture).0, paper, "{scheme:?}");
        assert!(counts[&paper] > picture.len() / 3 / 5 && counts[&paper] < picture.len() / 3 * 9 / 10);
    }
}

#[test]
fn a_page_that_asks_for_anything_or_fails_is_found_out() {
    let Some(browser) = crate::browser::find() else { return };
    let faults = [
        "<img src='http://example.invalid/a.png'>",
        "<img src='/b.png'>",
        "<link rel='stylesheet' href='http://example.invalid/c.css'>",
        "<style>@font-face { font-family: x; src: url('http://example.invalid/d.woff') } p { font-family: x }</style>",
        "<script>console.error('e')</script>",
    ];
    for fault in faults {
        let page = format!("<!DOCTYPE html><title>fault</title><p>words</p>{fault}");
        let seen = open(browser, &page, (400, 300), Scheme::Light);
        assert!(!seen.console.is_empty() || !seen.requests.is_empty(), "{fault}");
    }
    let harmless = open(browser, "<!DOCTYPE html><title>none</title><p>words</p>", (400, 300), Scheme::Light);
    assert!(harmless.console.is_empty() && harmless.requests.is_empty(), "{harmless:?}");
    assert!(counts(&harmless.picture).len() < 300, "next to nothing is to be seen");
}

/// A page to hand on is light in every scheme.
#[test]
fn the_page_of_a_lens_fits_the_window_and_is_light() {
    let Some(browser) = crate::browser::find() else { return };
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["lens", "double-gauss", "--html", "lens.html"];
    let status =
        Command::new(env!("CARGO_BIN_EXE_abbe")).current_dir(folder.path()).args(arguments).output().unwrap().status;
    assert!(status.success());
    let page = std::fs::read_to_string(folder.path().join("lens.html")).unwrap();
    for (size, scheme) in [((1280, 5000), Scheme::Dark), ((420, 7000), Scheme::Light)] {
        let Seen { picture, console, requests } = open(browser, &page, size, scheme);
        assert_eq!((picture.dimensions(), console, requests), (size, Vec::new(), Vec::new()));
        assert_eq!(paper_at_the_edge(&picture).0, [255, 255, 255], "{scheme:?}");
        assert!(counts(&picture).len() > 300, "plots are to be seen");
    }
}

/// Makes the page of a study.
fn study_page() -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ball.json"), crate::study_scene::SCENE).unwrap();
    let arguments = ["study", "ball.json", "-o", "out", "--budget", "1s", "--quiet"];
    let status =
        Command::new(env!("CARGO_BIN_EXE_abbe")).current_dir(folder.path()).args(arguments).output().unwrap().status;
    assert!(status.success());
    std::fs::read_to_string(folder.path().join("out/study.html")).unwrap()
}

#[test]
fn the_page_of_a_study_is_whole_and_its_slider_moves() {
    let Some(browser) = crate::browser::find() else { return };
    let page = study_page();
    for (size, scheme, paper) in
        [((1280, 1400), Scheme::Dark, [22, 24, 27]), ((390, 9000), Scheme::Light, [255, 255, 255])]
    {
        let Seen { picture, console, requests } = open(browser, &page, size, scheme);
        assert_eq!((picture.dimensions(), console, requests), (size, Vec::new(), Vec::new()));
        assert_eq!(paper_at_the_edge(&picture).0, paper, "{scheme:?}");
        assert!(counts(&picture).len() > 500, "plots and pictures are to be seen");
    }
    // Sets the slider as a reader who drags it.
    let at = |percent: u32| {
        let drag = format!(
            "const s = document.getElementById('split'); s.value = {percent}; s.dispatchEvent(new Event('input'));"
        );
        let page = page.replace("</body>", &format!("<script>{drag}</script></body>"));
        let Seen { picture, console, requests } = open(browser, &page, (1280, 900), Scheme::Light);
        assert!(console.is_empty() && requests.is_empty(), "{console:?} {requests:?}");
        picture
    };
    let (right, half, left) = (at(0), at(50), at(100));
    // The picture is 960 pixels wide and starts at x = 20; the handle covers some pixels around its
    // position.
    let (middle, handle) = (500, 45);
    let same = |a: &RgbImage, columns: std::ops::Range<u32>| {
        columns.flat_map(|x| (0..900).map(move |y| (x, y))).all(|(x, y)| a.get_pixel(x, y) == half.get_pixel(x, y))
    };
    assert!(same(&left, 20 + handle..middle - handle) && same(&right, middle + handle..980 - handle));
    assert!(!same(&right, 20 + handle..middle - handle) && !same(&left, middle + handle..980 - handle));
}
