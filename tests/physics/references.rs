//! The benchmark scenes against references from an independent renderer, which
//! benches/scenes/README.md names.

use crate::common::{render, with_setting};
use abbe_session::output::compare::compare;
use abbe_session::output::exr;
use abbe_session::output::selection::{Region, Selection};
use abbe_session::render::Integrator;
use abbe_transport::sensor::Picture;
use serde_json::Value;
use std::path::Path;

/// The largest relative difference of a region's mean Y that two correct renderers should have.
const BETWEEN_PROGRAMS: f64 = 0.01;

struct Benchmark {
    scene: Value,
    reference: Picture,
    /// The pixels at which the reference is reliable.
    reliable: Selection,
    /// The photon paths of a pass of the rough picture, if they differ from the default.
    photons_of_rough: Option<u64>,
}

impl Benchmark {
    fn read(name: &str) -> Self {
        let benches = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches");
        let scene = std::fs::read_to_string(benches.join("scenes").join(format!("{name}.json"))).expect("the scene");
        let reference =
            exr::read(&benches.join("references").join(format!("{name}_reference.exr"))).expect("the reference");
        Self {
            scene: serde_json::from_str(&scene).expect("JSON"),
            reference: reference.picture,
            reliable: Selection::default(),
            photons_of_rough: None,
        }
    }

    /// S1. The reference is too noisy at two highlights in the ball.
    fn s1() -> Self {
        let s1 = Self::read("s1_ball");
        let highlights = [([60, 86], [134, 147]), ([137, 150], [104, 117])];
        let is_reliable = |pixel: usize| {
            let (y, x) = (pixel / s1.reference.width, pixel % s1.reference.width);
            !highlights
                .iter()
                .any(|(rows, columns)| (rows[0]..=rows[1]).contains(&y) && (columns[0]..=columns[1]).contains(&x))
        };
        let mask = (0..s1.reference.xyz.len()).map(is_reliable).collect();
        Self { reliable: Selection { mask: Some(mask), ..Selection::default() }, ..s1 }
    }

    /// S2. One pass with the default number of photons has the noise of the reference already.
    fn s2() -> Self {
        Self { photons_of_rough: Some(10_000), ..Self::read("s2_prism") }
    }

    fn picture(&self, passes: u64, photons: Option<u64>) -> Picture {
        let scene = with_setting(&self.scene, "seed", 0);
        let scene = photons.map_or(scene.clone(), |photons| with_setting(&scene, "photons", photons));
        render(&scene, Integrator::Photon, passes).picture
    }

    /// Returns the relMSE and the ratio of the mean Y over the selected pixels.
    fn measure(&self, picture: &Picture, selection: &Selection) -> (f64, f64) {
        let found = compare(picture, &self.reference, selection).expect("comparable");
        (found.relative_mse, found.mean_ratio)
    }

    /// Checks the mean Y of regions. Checks that the error of the reliable pixels falls from few
    /// passes to many, to below `floor`.
    fn agrees(&self, name: &str, regions: &[(&str, Selection)], [few, many]: [u64; 2], floor: f64) {
        let (rough, fine) = (self.picture(few, self.photons_of_rough), self.picture(many, None));
        for (region, selection) in regions {
            let (error, ratio) = self.measure(&fine, selection);
            println!("{name}, {region}: mean Y {ratio:.4} of the reference's, relMSE {error:.5} at {many} passes");
            assert!((ratio - 1.0).abs() < BETWEEN_PROGRAMS, "{name}, {region}: {ratio}");
        }
        let [before, after] = [&rough, &fine].map(|picture| self.measure(picture, &self.reliable).0);
        println!("{name}: relMSE {before:.5} at {few} passes, {after:.5} at {many}");
        assert!(after < floor, "{name}: relMSE {after} at {many} passes");
        assert!(after < 0.5 * before, "{name}: {before} at {few} passes, {after} at {many}");
    }
}

/// Selects a rectangle of pixels; both ends are included.
fn pixels(rows: [usize; 2], columns: [usize; 2]) -> Selection {
    let region = Region { x0: columns[0], y0: rows[0], x1: columns[1] + 1, y1: rows[1] + 1 };
    Selection { regions: vec![region], mask: None }
}

/// Selects S1's caustic: pixels where the reference's Y exceeds 0.5 cd/m².
fn core(reference: &Picture) -> Selection {
    let mask = reference.xyz.iter().map(|xyz| xyz[1] > 0.5).collect();
    Selection { mask: Some(mask), ..pixels([138, 157], [85, 129]) }
}

#[test]
fn s1_floor_and_caustic() {
    let s1 = Benchmark::s1();
    let regions = [("floor", pixels([175, 249], [20, 235])), ("core", core(&s1.reference))];
    s1.agrees("S1", &regions, [2, 12], 0.006);
}

#[test]
#[ignore = "nightly: 14 seconds of CPU time"]
fn s2_spectrum() {
    Benchmark::s2().agrees("S2", &[("spectrum", pixels([110, 145], [20, 200]))], [1, 32], 0.003);
}

#[test]
#[ignore = "slow: 10 seconds of CPU time"]
fn s3_walls() {
    let walls = [("red", [10, 50]), ("green", [206, 246]), ("back", [60, 100])];
    let regions = walls.map(|(name, columns)| (name, pixels([60, 190], columns)));
    Benchmark::read("s3_box").agrees("S3", &regions, [4, 32], 0.005);
}

#[test]
#[ignore = "slow: minutes of rendering, to three times the references' own noise"]
fn errors_fall_to_three_times_the_references_noise() {
    let s1 = Benchmark::s1();
    s1.agrees("S1", &[("core", core(&s1.reference))], [8, 128], 0.006);
    Benchmark::s2().agrees("S2", &[], [1, 64], 0.003);
    // The common part of both integrators' errors against the S3 reference gives its noise: 0.0012.
    Benchmark::read("s3_box").agrees("S3", &[], [8, 128], 0.0035);
}
