//! Image sequences, and moving scenes on several threads and in parts.

use crate::abbe_command::folder::{names_in, with_ball};
use crate::abbe_command::{Said, abbe};
use abbe_session::output::exr;
use std::path::Path;
use tempfile::TempDir;

/// A glass ball that falls for a second, a light that turns, and a camera that moves slightly.
const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}, "shutter": {"open": 0, "close": 0.5, "curve": [[0, 0], [1, 1]]},
             "motion": [{"time": 0}, {"time": 1, "from": [0.2, 2, 5]}]},
  "film": {"width": 16, "height": 12},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "SF10"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass",
     "motion": [{"time": 0, "transform": [{"translate": [0, 1, 0]}]}, {"time": 1, "transform": []}]}],
  "lights": [{"spot": {"at": [1, 4, 1], "to": [0, 0, 0], "half_angle": 30, "spectrum": "D65", "power": 20,
     "motion": [{"time": 0, "transform": []}, {"time": 1, "transform": [{"rotate": {"axis": [0, 1, 0], "degrees": 30}}]}]}}],
  "render": {"passes": 5, "photons": 400}
}"#;

/// A folder with `ball.json`.
fn scene() -> TempDir {
    with_ball(SCENE)
}

fn render(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["render", "ball.json"], more].concat())
}

#[track_caller]
fn done(said: &Said) {
    assert_eq!(said.status, 0, "{}", said.err);
}

/// Checks that two pictures are bit-identical.
#[track_caller]
fn is_same_picture(folder: &Path, a: &str, b: &str) {
    let picture = |name: &str| exr::read(&folder.join(name)).unwrap().picture;
    assert!(picture(a) == picture(b), "{a} differs from {b}");
}

/// Returns the pixels of the frames of an animated PNG, and the time of a frame in s as a fraction.
fn animation(path: &Path) -> (Vec<Vec<u8>>, (u16, u16)) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let count = reader.info().animation_control.unwrap().num_frames;
    let mut delay = (0, 0);
    let frame = |_| {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let control = reader.info().frame_control.unwrap();
        delay = (control.delay_num, control.delay_den);
        pixels
    };
    let frames = (0..count).map(frame).collect();
    (frames, delay)
}

/// Returns the pixels of `out/NAME.png`.
fn pixels(folder: &Path, name: &str) -> Vec<u8> {
    let file = std::fs::File::open(folder.join(format!("out/{name}.png"))).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}

#[test]
fn a_sweep_is_a_picture_per_value_and_an_animation() {
    let folder = scene();
    let at = folder.path();
    std::fs::create_dir(at.join("out")).unwrap();
    let sweep =
        |key: &str, more: &[&str]| render(at, &[&["--sweep", key, "-o", "out/#.exr", "--fps", "2.5"], more].concat());
    let said = sweep("objects.ball.shape.sphere.radius=0.2..0.5:3", &[]);
    done(&said);
    assert!(said.err.contains("frame 2 of 3") && said.err.contains("wrote out/animation.png"), "{}", said.err);
    let frames = ["1", "2", "3"].map(|name| pixels(at, name)).to_vec();
    assert_eq!(animation(&at.join("out/animation.png")), (frames.clone(), (400, 1000)));
    assert!(frames[0] != frames[1]);
    done(&render(at, &["--set", "objects.ball.shape.sphere.radius=0.35", "--quiet", "-o", "alone.exr"]));
    is_same_picture(at, "out/2.exr", "alone.exr");
    sweep("objects.bal.shape=1..2:3", &[]).is_error(2, &["objects.bal.shape", "did you mean \"ball\""]);
    sweep("lights=1..2", &[]).is_error(2, &["lights.beam.power=1..5:9"]);
    let both = sweep("render.seed=1..2:2", &["--frames", "1..2"]);
    assert!(both.status == 2 && both.err.contains("--frames"), "{}", both.err);
}

#[test]
fn each_frame_is_the_picture_of_its_own_shutter() {
    let folder = scene();
    let at = folder.path();
    std::fs::create_dir(at.join("out")).unwrap();
    let sequence =
        ["--frames", "2..4", "--fps", "10", "--shutter-angle", "90", "-o", "out/###.exr", "--stats", "out/#.json"];
    let said = render(at, &sequence);
    done(&said);
    assert!(
        ["frame 2 of 4", "frame 3 of 4", "frame 4 of 4"].iter().all(|frame| said.err.contains(frame)),
        "{}",
        said.err
    );
    let names = ["002.exr", "002.png", "003.exr", "003.png", "004.exr", "004.png", "2.json", "3.json", "4.json"];
    assert_eq!(names_in(&at.join("out")), [&names[..], &["animation.png"]].concat());
    assert_eq!(
        animation(&at.join("out/animation.png")),
        (["002", "003", "004"].map(|n| pixels(at, n)).to_vec(), (1, 10))
    );
    // The shutter of frame 3 opens at 0.2 s for 0.025 s. The scene's shutter curve stays.
    let shutter = ["--set", "camera.shutter.open=0.2", "--set", "camera.shutter.close=0.225"];
    done(&render(at, &[&shutter[..], &["--quiet", "-o", "alone.exr"]].concat()));
    is_same_picture(at, "out/003.exr", "alone.exr");
    let picture = |name: &str| exr::read(&at.join(name)).unwrap().picture;
    assert!(picture("out/002.exr") != picture("out/004.exr"), "things move");
}

#[test]
fn a_sequence_resumes_with_the_frames_that_are_missing() {
    let folder = scene();
    let at = folder.path();
    let sequence = |more: &[&str]| render(at, &[&["--frames", "1..3", "-o", "f#.exr"], more].concat());
    done(&sequence(&["--quiet"]));
    std::fs::copy(at.join("f2.exr"), at.join("known.exr")).unwrap();
    std::fs::remove_file(at.join("f2.exr")).unwrap();
    let said = sequence(&["--resume"]);
    done(&said);
    assert!(
        said.err.contains("f1.exr is already finished") && said.err.contains("f3.exr is already finished"),
        "{}",
        said.err
    );
    assert!(!said.err.contains("f2.exr is already finished"), "{}", said.err);
    is_same_picture(at, "f2.exr", "known.exr");
    // An interrupted frame is resumed from its checkpoint.
    done(&render(at, &["--quiet", "--frames", "2..2", "-o", "f#.exr", "--passes", "2", "--keep-checkpoint"]));
    let said = sequence(&["--resume"]);
    assert!(said.err.contains("resuming after 2 passes, from f2.checkpoint.exr"), "{}", said.err);
    is_same_picture(at, "f2.exr", "known.exr");
    // Frames of another scene, or with fewer passes than requested, are not complete.
    let said = sequence(&["--resume", "--passes", "6"]);
    assert!(said.status == 0 && !said.err.contains("finished"), "{}", said.err);
    let said = sequence(&["--resume", "--seed", "3"]);
    assert!(said.status == 0 && !said.err.contains("finished"), "{}", said.err);
}

#[test]
fn sequences_that_make_no_sense_are_refused() {
    let folder = scene();
    let at = folder.path();
    for (options, words) in [
        (&["--frames", "1..3", "-o", "a.exr"][..], &["a.exr", "#"][..]),
        (&["--frames", "1..3", "-o", "#a#.exr"], &["#a#.exr", "one group"]),
        (&["--frames", "1..3", "--stats", "a.json"], &["a.json", "#"]),
        (&["--frames", "3..1"], &["--frames", "3", "is before the first frame"]),
        (&["--frames", "0..2"], &["--frames", "counted from 1"]),
        (&["--frames", "2"], &["--frames", "1..48"]),
        (&["--frames", "1..2", "--fps", "0"], &["--fps", "above 0"]),
        (&["--frames", "1..2", "--shutter-angle", "400"], &["--shutter-angle", "360"]),
        (&["--fps", "24"], &["--frames"]),
        (&["--frames", "1..2", "--part", "0/2"], &["--frames", "--part"]),
    ] {
        render(at, options).is_error(2, words);
    }
    assert_eq!(names_in(at), ["ball.json"]);
}

#[test]
fn a_moving_scene_is_the_same_bits_on_threads_and_in_parts() {
    let folder = scene();
    let at = folder.path();
    let plan = abbe(at, &["explain", "ball.json", "--json"]).json();
    assert!(plan["motion_px"].as_f64() > Some(1.0), "{}", plan["motion_px"]);
    for integrator in ["photon", "path"] {
        let quiet = ["--quiet", "--integrator", integrator];
        for threads in ["1", "2", "3"] {
            let name = format!("{threads}.exr");
            done(&render(at, &[&quiet[..], &["--threads", threads, "-o", &name]].concat()));
            is_same_picture(at, &name, "1.exr");
        }
        for part in ["0/3", "1/3", "2/3"] {
            let name = format!("part{}.exr", &part[..1]);
            done(&render(at, &[&quiet[..], &["--part", part, "-o", &name]].concat()));
        }
        done(&abbe(at, &["merge", "part0.exr", "part1.exr", "part2.exr", "-o", "merged.exr"]));
        is_same_picture(at, "merged.exr", "1.exr");
    }
}
