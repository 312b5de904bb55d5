//! The numbers of camera samples that the pilot chooses.

use super::common::{channel, job_with, render_job};
use abbe_session::render::Integrator;
use abbe_transport::sensor::Picture;

/// A board above a white floor, in the light of a sphere. The camera looks down. The sphere is
/// large, so the shadow of the board has a wide penumbra. A point brightens the shadow.
const PENUMBRA: &str = r#"{
  "camera": {"from": [-1, 6, 0], "at": [-1, 0, 0], "up": [0, 0, -1], "lens": {"pinhole": {"fov": 30}}},
  "film": {"width": 96, "height": 64, "layers": ["samples"]},
  "materials": {"white": {"diffuse": {"reflectance": 0.8}}, "black": "absorber", "lamp": "absorber"},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 20, "height": 20}}, "material": "white"},
    {"name": "board", "shape": {"rectangle": {"width": 1, "height": 1}}, "material": "black",
     "transform": [{"translate": [0.5, 1, 0]}]},
    {"name": "lamp", "shape": {"sphere": {"radius": 0.5, "center": [4, 4, 0]}}, "material": "black",
     "emission": {"spectrum": "E", "luminous_flux": 1000}}],
  "lights": [{"point": {"at": [-3, 4, 0], "spectrum": "E", "luminous_flux": 400}}]}"#;

fn render(sets: &[&str], passes: u64) -> Picture {
    render_job(&job_with(PENUMBRA, sets), Integrator::Photon, passes).picture
}

/// Samples in the penumbra differ by the shadow, and samples of the lit floor hardly differ. Where
/// the floor has 58 to 75 % of the light, the sphere is partly hidden. In the umbra, it has less.
#[test]
fn a_penumbra_gets_more_camera_samples_than_the_lit_floor() {
    let fine = render(&["render.camera_samples=4"], 16);
    let mut sorted: Vec<f64> = fine.xyz.iter().map(|xyz| xyz[1]).collect();
    sorted.sort_by(f64::total_cmp);
    let lit = sorted[sorted.len() * 3 / 4];
    let chosen = render(&[], 1);
    let samples = channel(&chosen, "samples");
    let mean = |least: f64, most: f64| {
        let in_range = fine.xyz.iter().zip(samples).filter(|(xyz, _)| (least..most).contains(&(xyz[1] / lit)));
        let of_pixels: Vec<f64> = in_range.map(|(_, &samples)| f64::from(samples)).collect();
        assert!(of_pixels.len() > 100, "{} pixels between {least} and {most}", of_pixels.len());
        of_pixels.iter().sum::<f64>() / of_pixels.len() as f64
    };
    let (penumbra, floor) = (mean(0.58, 0.75), mean(0.9, 1.1));
    println!("{penumbra} samples in the penumbra, {floor} on the lit floor");
    assert!(penumbra > 1.4 * floor, "{penumbra} and {floor}");
}

#[test]
fn a_stated_number_of_camera_samples_is_kept_in_all_pixels() {
    let picture = render(&["render.camera_samples=3"], 2);
    assert!(channel(&picture, "samples").iter().all(|&samples| samples == 6.0));
}
