//! The coarse picture before pass 0.

use super::common::example_job;
use abbe_session::render::{CoarseLevel, CoarsePicture, Integrator, Monitor, Progress, Rendered, Request, StopRules};
use abbe_transport::sensor::Picture;

/// Keeps the coarse pictures of a render.
#[derive(Default)]
struct Coarse {
    levels: &'static [CoarseLevel],
    pictures: Vec<CoarsePicture>,
}

impl Monitor for Coarse {
    fn coarse_levels(&self) -> &'static [CoarseLevel] {
        self.levels
    }

    fn show_coarse_picture(&mut self, coarse: &CoarsePicture) {
        self.pictures.push(coarse.clone());
    }

    fn after_pass(&mut self, _: &Progress) -> bool {
        true
    }
}

/// Renders an example scene. Returns the coarse pictures too.
fn render(
    scene: &str,
    size: [u32; 2],
    integrator: Integrator,
    levels: &'static [CoarseLevel],
) -> (Rendered, Vec<CoarsePicture>) {
    let [width, height] = size;
    let sets = [format!("film.width={width}"), format!("film.height={height}"), "render.photons=20000".to_owned()];
    let job = example_job(scene, &sets.each_ref().map(String::as_str));
    let mut monitor = Coarse { levels, pictures: Vec::new() };
    let stop = StopRules { passes: Some(2), ..StopRules::default() };
    (job.render(Request { integrator, stop }, &mut monitor).unwrap(), monitor.pictures)
}

/// Returns the mean of Y in a 4 × 3 grid of blocks. Each pixel counts with at most `largest`, so
/// that a few pixels with images of the lamp do not decide.
fn blocks(picture: &Picture, largest: f64) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); 12];
    for (pixel, xyz) in picture.xyz.iter().enumerate() {
        let (x, y) = (pixel % picture.width, pixel / picture.width);
        let (sum, count) = &mut sums[4 * x / picture.width + 4 * (3 * y / picture.height)];
        (*sum, *count) = (*sum + xyz[1].min(largest), *count + 1.0);
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// Coarse pictures have the size of the film and show the scene. The render is the same, bit by
/// bit, as without them.
#[test]
#[ignore = "nightly: 10 seconds of CPU time"]
fn a_coarse_picture_shows_the_scene_and_leaves_the_render_unchanged() {
    for (scene, integrator) in [
        ("cornell", Integrator::Photon),
        ("cornell", Integrator::Path),
        ("glass_ball", Integrator::Photon),
        ("moving_caustic", Integrator::Photon),
    ] {
        let size = [281, 211];
        let (plain, none) = render(scene, size, integrator, &[]);
        let (rendered, shown) = render(scene, size, integrator, &[CoarseLevel::Sketch(1.0), CoarseLevel::Half]);
        let expected = if integrator == Integrator::Photon { 2 } else { 1 };
        assert!(none.is_empty() && shown.len() == expected, "{scene}");
        assert_eq!(plain.picture, rendered.picture, "{scene}");
        let mean = rendered.picture.mean_y();
        for (coarse, columns) in shown.iter().zip([71, 141]) {
            assert_eq!((coarse.picture.width, coarse.film), (columns, [281, 211]));
            let [coarse, fine] = [&coarse.enlarged(), &rendered.picture].map(|picture| blocks(picture, 3.0 * mean));
            println!("{scene}: {coarse:.0?}, {fine:.0?}");
            for (coarse, fine) in coarse.into_iter().zip(fine) {
                assert!((coarse - fine).abs() < 0.25 * fine + 0.1 * mean, "{scene}: {coarse} for {fine}, mean {mean}");
            }
        }
    }
}

/// The full picture uses the radii of the pilot's survey, and leaves the rest of the pilot as it
/// is.
#[test]
fn a_full_coarse_picture_leaves_the_render_unchanged() {
    let [(plain, _), (rendered, shown)] =
        [&[][..], &[CoarseLevel::Full]].map(|levels| render("glass_ball", [210, 160], Integrator::Photon, levels));
    assert_eq!(plain.picture, rendered.picture);
    assert_eq!((shown[0].picture.width, shown[0].photons), (210, 5_000));
    let mean = rendered.picture.mean_y();
    assert!((shown[0].picture.mean_y() / mean - 1.0).abs() < 0.2, "{} for {mean}", shown[0].picture.mean_y());
}

#[test]
fn a_small_film_has_no_coarse_picture() {
    assert!(render("cornell", [160, 120], Integrator::Photon, &[CoarseLevel::Half]).1.is_empty());
}
