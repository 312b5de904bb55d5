//! Hard cases: inputs for which the obvious formula fails. Each case is measured against a value of
//! higher precision or a closed form. The hard-cases document lists each case with its bound;
//! `ABBE_BLESS=1 cargo test --release --test hard_cases -- --include-ignored` writes its tables.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod camera;
#[path = "../common/mod.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod common;
mod density;
#[path = "../golden/mod.rs"]
mod golden;
mod media;
mod meshes;
mod paths;
mod random_numbers;
mod refraction;
mod scale_and_place;
mod shapes;
mod spectra;
mod table;

use table::{Family, Pace, check, check_document};

const FAMILIES: [Family; 8] = [
    Family { title: "Refraction", cases: refraction::CASES },
    Family { title: "Scale and place", cases: scale_and_place::CASES },
    Family { title: "Shapes", cases: shapes::CASES },
    Family { title: "Spectra", cases: spectra::CASES },
    Family { title: "Density estimation", cases: density::CASES },
    Family { title: "Media", cases: media::CASES },
    Family { title: "Camera and time", cases: camera::CASES },
    Family { title: "Random numbers", cases: random_numbers::CASES },
];

#[test]
fn refraction_is_as_exact_as_stated() {
    check(&FAMILIES, "Refraction", Pace::Fast);
}

#[test]
fn scale_and_place_do_not_matter() {
    check(&FAMILIES, "Scale and place", Pace::Fast);
}

#[test]
fn shapes_are_hit_as_exactly_as_stated() {
    check(&FAMILIES, "Shapes", Pace::Fast);
}

#[test]
fn spectra_are_as_exact_as_stated() {
    check(&FAMILIES, "Spectra", Pace::Fast);
}

#[test]
fn densities_are_as_exact_as_stated() {
    check(&FAMILIES, "Density estimation", Pace::Fast);
}

#[test]
fn media_are_as_exact_as_stated() {
    check(&FAMILIES, "Media", Pace::Fast);
}

#[test]
fn cameras_are_as_exact_as_stated() {
    check(&FAMILIES, "Camera and time", Pace::Fast);
}

#[test]
fn no_random_number_breaks_a_sampler() {
    check(&FAMILIES, "Random numbers", Pace::Fast);
}

#[test]
#[ignore = "slow: millions of paths and rays"]
fn slow_cases_keep_to_their_bounds() {
    FAMILIES.iter().for_each(|family| check(&FAMILIES, family.title, Pace::Slow));
}

#[test]
fn the_document_holds_every_case() {
    if std::env::var_os("ABBE_BLESS").is_none() {
        check_document(&FAMILIES);
    }
}
