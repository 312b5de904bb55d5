//! The denoised picture: its layers, resuming and merging, and the choice of the PNG.

use crate::abbe_command::folder::with_ball;
use crate::abbe_command::{Said, abbe};
use abbe_session::output::exr;
use abbe_transport::sensor::Picture;
use std::path::Path;

/// A lamp above a grey ball on a grey floor.
const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 40, "height": 30, "exposure": {"ev": -3}},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "grey"},
    {"name": "lamp", "shape": {"sphere": {"center": [2, 3, 1], "radius": 0.8}}, "material": "grey",
     "emission": {"spectrum": "A", "power": 50}}],
  "render": {"passes": 10, "photons": 500}
}"#;

#[track_caller]
fn done(said: &Said) {
    assert_eq!(said.status, 0, "{}", said.err);
}

fn render(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["render", "ball.json"], more].concat())
}

fn picture(folder: &Path, name: &str) -> Picture {
    exr::read(&folder.join(name)).unwrap().picture
}

/// Threads, a resumed run and merged parts give the bits of a single run. The picture as it was
/// rendered has the bits of a render without the denoiser.
#[test]
fn the_denoised_picture_has_the_same_bits_after_resume_and_merge() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    done(&render(at, &["-o", "whole.exr", "--threads", "2"]));
    let whole = picture(at, "whole.exr");
    let denoised = whole.denoised.as_ref().expect("a denoised layer");
    assert_eq!((denoised.xyz.len(), denoised.noise.len()), (1200, 1200));
    done(&render(at, &["-o", "one.exr", "--threads", "1"]));
    assert!(picture(at, "one.exr") == whole);
    done(&render(at, &["--passes", "3", "--keep-checkpoint"]));
    assert!(picture(at, "ball.exr").denoised.is_none(), "a group has no pass");
    done(&render(at, &["--resume"]));
    assert!(picture(at, "ball.exr") == whole);
    done(&render(at, &["--part", "0/2", "-o", "a.exr"]));
    done(&render(at, &["--part", "1/2", "-o", "b.exr"]));
    done(&abbe(at, &["merge", "--quiet", "b.exr", "a.exr", "-o", "merged.exr"]));
    assert!(picture(at, "merged.exr") == whole);
    done(&render(at, &["--no-denoise", "-o", "raw.exr"]));
    assert!(picture(at, "raw.exr") == Picture { denoised: None, ..whole });
}

/// Returns the mean squared relative difference of two pictures without the worst 5 % of the
/// pixels.
fn difference(picture: &Picture, reference: &Picture) -> f64 {
    // Relative to Y, and to a tenth of its mean where it is dark.
    let dark = 0.1 * reference.mean_y();
    let pairs = picture.xyz.iter().zip(&reference.xyz);
    let mut squares: Vec<f64> = pairs.map(|(a, b)| ((a[1] - b[1]) / (b[1] + dark)).powi(2)).collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate(squares.len() * 95 / 100);
    squares.iter().sum::<f64>() / squares.len() as f64
}

/// The difference to an independent render is the sum of both variances. The denoised picture has
/// less of its own, and its intervals contain the other picture with its noise.
#[test]
fn the_denoised_picture_is_better_than_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let cornell = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.json");
    let render = |seed: &str, output: &str| {
        let scene = cornell.to_str().unwrap();
        done(&abbe(at, &["render", scene, "--size", "96x54", "--passes", "8", "--seed", seed, "-o", output]));
        picture(at, output)
    };
    let (own, other) = (render("1", "a.exr"), render("2", "b.exr"));
    let denoised = own.denoised().unwrap();
    let [after, before] = [&denoised, &own].map(|picture| difference(picture, &other));
    assert!(after < 0.9 * before, "{after} {before}");
    let known: Vec<usize> = (0..other.xyz.len()).filter(|&i| other.noise[i].is_some()).collect();
    let inside = |&&i: &&usize| {
        let half = denoised.half_interval_95(i, f64::from(other.noise[i].unwrap_or(0.0)));
        half.is_some_and(|half| (denoised.xyz[i][1] - other.xyz[i][1]).abs() <= half)
    };
    let covered = known.iter().filter(inside).count() as f64 / known.len() as f64;
    assert!((0.9..0.995).contains(&covered), "{covered}");
}

#[test]
fn the_png_shows_the_choice() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    let said = render(at, &["-o", "a.exr", "--keep-checkpoint"]);
    assert!(said.err.contains("the PNG shows the denoised picture"), "{}", said.err);
    let png = |name: &str| std::fs::read(at.join(name)).unwrap();
    let develop = |picture: &str, output: &str, option: &str| {
        done(&abbe(at, &["develop", picture, "-o", output, option]));
        png(output)
    };
    let denoised = develop("a.exr", "denoised.png", "--denoise");
    assert!(denoised == png("a.png"));
    let raw = develop("a.exr", "raw.png", "--no-denoise");
    assert!(raw != denoised);
    assert!(develop("a.checkpoint.exr", "checkpoint.png", "--denoise") == denoised);
    let said = render(at, &["-o", "b.exr", "--no-denoise"]);
    assert!(!said.err.contains("denoised"), "{}", said.err);
    assert!(png("b.png") == raw);
    let said = abbe(at, &["develop", "b.exr", "-o", "c.png", "--denoise"]);
    said.is_error(2, &["contains no denoised picture", "without --no-denoise"]);
    done(&abbe(at, &["compare", "a.exr", "b.exr", "--denoised"]));
    abbe(at, &["compare", "b.exr", "a.exr", "--denoised"]).is_error(2, &["contains no denoised picture"]);
}

/// The scene's key decides like the options, and diffraction refuses it.
#[test]
fn the_key_of_the_film_decides() {
    let folder = with_ball(&SCENE.replace(r#""exposure""#, r#""denoise": false, "exposure""#));
    let at = folder.path();
    done(&render(at, &["-o", "a.exr"]));
    assert!(picture(at, "a.exr").denoised.is_none());
    done(&render(at, &["-o", "b.exr", "--denoise"]));
    assert!(picture(at, "b.exr").denoised.is_some());
}
