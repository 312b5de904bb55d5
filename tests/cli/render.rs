//! The commands `abbe render`, `abbe explain` and `abbe check` as a user runs them: files, exit
//! status and interruption.

use crate::abbe_command::folder::{names_in, with_ball};
use crate::abbe_command::{Said, abbe, command};
use abbe_session::output::exr;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A glass ball over a floor, small enough to render within a moment.
const SCENE: &str = r#"{
  "title": "λ",
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 16, "height": 12},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "N-BK7"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"passes": 4, "photons": 500}
}"#;

/// A folder with `ball.json`.
fn scene() -> TempDir {
    with_ball(SCENE)
}

fn render(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["render", "ball.json"], more].concat())
}

fn header(folder: &Path, name: &str, key: &str) -> String {
    exr::read(&folder.join(name)).unwrap().metadata.get(key).unwrap().to_string()
}

#[test]
fn a_render_leaves_an_exr_a_png_and_statistics() {
    let folder = scene();
    let said =
        render(folder.path(), &["--stats", "stats.json", "--seed", "7", "--size", "20x10", "--spectral-bands", "4"]);
    assert!(said.status == 0 && said.out.is_empty(), "{}", said.err);
    assert!(said.err.contains("4 passes") && said.err.contains("ball.exr"), "{}", said.err);
    assert_eq!(names_in(folder.path()), ["ball.exr", "ball.json", "ball.png", "stats.json"]);

    let file = exr::read(&folder.path().join("ball.exr")).unwrap();
    assert_eq!((file.picture.width, file.picture.height), (20, 10));
    assert_eq!(file.picture.bands.map(|bands| bands.centres_nm.len()), Some(4));
    let said_of = |key: &str| file.metadata.get(key).unwrap().to_string();
    assert_eq!(["abbe.seed", "abbe.passes", "abbe.photons", "abbe.version"].map(said_of), ["7", "4", "500", "0.1.0"]);
    let effective: Value = serde_json::from_str(file.metadata.get("abbe.scene").unwrap()).unwrap();
    assert_eq!((&effective["title"], &effective["film"]["width"]), (&Value::from("λ"), &Value::from(20)));
    for json in ["abbe.plan", "abbe.ledger"] {
        assert!(serde_json::from_str::<Value>(&said_of(json)).unwrap().is_object());
    }

    let stats: Value = serde_json::from_slice(&std::fs::read(folder.path().join("stats.json")).unwrap()).unwrap();
    assert_eq!((&stats["passes"], &stats["photons_emitted"]), (&Value::from(4), &Value::from(2000)));
    let keys = ["photons_stored", "photons_per_second", "peak_memory_bytes", "seconds", "ledger_w", "error", "effects"];
    assert!(keys.iter().all(|key| !stats[key].is_null()), "{stats}");
    assert_eq!(stats["wavelengths"], "both");
}

/// Without a terminal, the first line of progress announces the pilot. The statistics contain its
/// time, and the total time includes it.
#[test]
fn the_pilot_is_announced_and_its_time_counts() {
    let folder = scene();
    let said = render(folder.path(), &["--stats", "stats.json"]);
    let (pilot, passes) = (said.err.find("pilot: estimating"), said.err.find("/4 passes"));
    assert!(pilot.is_some() && pilot < passes, "{}", said.err);
    let stats: Value = serde_json::from_slice(&std::fs::read(folder.path().join("stats.json")).unwrap()).unwrap();
    let seconds = |stage: &str| stats["seconds"][stage].as_f64().unwrap();
    assert!(seconds("pilot") > 0.0);
    let stages = ["pilot", "emit", "map", "gather"].map(seconds);
    assert!(seconds("total") >= stages.iter().sum::<f64>(), "{stages:?} of {}", seconds("total"));
    let quiet = render(folder.path(), &["--quiet"]);
    assert!(!quiet.err.contains("pilot"), "{}", quiet.err);
}

/// Returns the largest memory of a render of a part with a film of this size, until the file is
/// written.
#[cfg(target_os = "linux")]
fn peak_memory_bytes(folder: &Path, size: &str, denoising: &str) -> f64 {
    let arguments = ["render", "ball.json", "--quiet", "--passes", "2", "--part", "1/2", "--size", size];
    let more = [denoising, "--set", "render.camera_samples=1"];
    let mut child = command(folder).args(arguments).args(more).spawn().unwrap();
    let status = Path::new("/proc").join(child.id().to_string()).join("status");
    let mut peak_kilobytes = 0.0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let number = text.split("VmHWM:").nth(1).and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
        peak_kilobytes = number.unwrap_or(peak_kilobytes);
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    1024.0 * peak_kilobytes
}

/// The film has 192 bytes for each pixel, and 168 more for the sums of the denoiser. The words of
/// its sums and the samples of the picture are computed while the file is written, so that they
/// take no memory.
#[cfg(target_os = "linux")]
#[test]
fn a_part_is_written_without_a_copy_of_the_film() {
    let folder = scene();
    for (denoising, film) in [("--no-denoise", 192.0), ("--denoise", 360.0)] {
        let [small, large] = ["40x30", "800x600"].map(|size| peak_memory_bytes(folder.path(), size, denoising));
        let bytes = (large - small) / (800.0 * 600.0 - 40.0 * 30.0);
        assert!(bytes > film && bytes < film + 300.0, "{denoising}: {bytes} bytes per pixel");
    }
}

#[test]
fn the_same_command_gives_the_same_pixels_on_any_threads() {
    let folder = scene();
    for (threads, name) in [("1", "one.exr"), ("3", "three.exr")] {
        assert_eq!(render(folder.path(), &["--threads", threads, "-o", name, "--quiet"]).status, 0);
    }
    let picture = |name: &str| exr::read(&folder.path().join(name)).unwrap().picture;
    assert_eq!(picture("one.exr"), picture("three.exr"));
    assert_eq!(
        header(folder.path(), "one.exr", "abbe.sceneHash"),
        header(folder.path(), "three.exr", "abbe.sceneHash")
    );
}

#[test]
fn options_override_the_scene() {
    let folder = scene();
    let said = render(
        folder.path(),
        &[
            "--passes",
            "2",
            "--photons",
            "300",
            "--integrator",
            "path",
            "--set",
            "objects[1].material=\"grey\"",
            "--quiet",
        ],
    );
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    let of = |key: &str| header(folder.path(), "ball.exr", key);
    assert_eq!(["abbe.passes", "abbe.photons", "abbe.integrator"].map(of), ["2", "300", "path"]);
    assert!(of("abbe.scene").contains(r#""material":"grey"}]"#), "{}", of("abbe.scene"));
}

#[test]
fn effects_can_be_forced_and_forbidden_and_the_header_says_so() {
    let folder = scene();
    assert_eq!(render(folder.path(), &["--forbid", "caustics", "--force", "shared", "--passes", "1"]).status, 0);
    let plan: Value = serde_json::from_str(&header(folder.path(), "ball.exr", "abbe.plan")).unwrap();
    let state = |name: &str| {
        let effects = plan["effects"].as_array().unwrap();
        effects.iter().find(|effect| effect["name"] == name).unwrap()["state"].clone()
    };
    assert_eq!((state("caustics"), state("shared")), ("forbidden".into(), "forced".into()));
    let effective: Value = serde_json::from_str(&header(folder.path(), "ball.exr", "abbe.scene")).unwrap();
    assert_eq!(effective["render"]["forbid"], serde_json::json!(["caustics"]));
    render(folder.path(), &["--force", "caustic"]).is_error(2, &["caustic", "did you mean \"caustics\""]);
}

#[test]
fn explain_says_where_colours_made_from_rgb_meet_spectral_lines() {
    let folder = scene();
    let explain = |paint: &str, lamp: &str| {
        let scene = SCENE.replace(r#""reflectance": 0.5"#, &format!(r#""reflectance": {paint}"#));
        let scene = scene.replace(r#""spectrum": "D65""#, &format!(r#""spectrum": {lamp}"#));
        std::fs::write(folder.path().join("lines.json"), scene).unwrap();
        let json = abbe(folder.path(), &["explain", "lines.json", "--json"]).json();
        (json["guessed_colours"].clone(), abbe(folder.path(), &["explain", "lines.json"]).out)
    };
    let (paint, sodium) = (r#"{"rgb": [0.7, 0.2, 0.1]}"#, r#""sodium-low-pressure""#);
    let (found, words) = explain(paint, sodium);
    assert_eq!(found, serde_json::json!({"upsampled": ["floor"], "line_lamps": ["point 0"]}));
    assert!(words.contains("Note: spectra reconstructed from RGB (floor)") && words.contains("(point 0)"), "{words}");
    // The same spectrum as a component of a mix is also detected.
    let mixed = format!(r#"{{"mix": [{{"spectrum": {paint}, "weight": 0.5}}, {{"spectrum": 0.2, "weight": 0.5}}]}}"#);
    let laser = r#"{"mix": [{"spectrum": "E", "weight": 0.0001}, {"spectrum": {"gaussian": {"peak_nm": 532, "fwhm_nm": 0.1}}, "weight": 9}]}"#;
    assert!(explain(&mixed, laser).0.is_object());
    for (paint, lamp) in [
        (paint, r#""D65""#),
        ("0.5", sodium),
        (r#"{"rgb": [0.5, 0.5, 0.5]}"#, sodium),
        (r#""colorchecker/red""#, sodium),
    ] {
        let (found, words) = explain(paint, lamp);
        assert!(found.is_null() && !words.contains("from RGB"), "{paint} under {lamp}: {words}");
    }
}

#[test]
fn time_and_target_error_extend_the_default_passes() {
    let folder = scene();
    assert_eq!(render(folder.path(), &["--time", "300ms", "--quiet"]).status, 0);
    let passes: u64 = header(folder.path(), "ball.exr", "abbe.passes").parse().unwrap();
    let seconds: f64 = header(folder.path(), "ball.exr", "abbe.seconds").parse().unwrap();
    assert!(passes >= 1 && seconds >= 0.3, "{passes} passes in {seconds} s");
    assert_eq!(render(folder.path(), &["--target-error", "1000%", "--quiet"]).status, 0);
    assert_eq!(header(folder.path(), "ball.exr", "abbe.passes"), "16");
}

#[test]
fn what_cannot_be_rendered_leaves_no_file() {
    let folder = scene();
    let error = |scene: &str, status: i32, words: &[&str]| {
        abbe(folder.path(), &["render", scene]).is_error(status, words);
    };
    error("missing.json", 2, &["missing.json"]);
    std::fs::write(folder.path().join("broken.json"), "{\"camera\": ").unwrap();
    error("broken.json", 2, &["broken.json:1:"]);
    std::fs::write(folder.path().join("dark.json"), SCENE.replace("\"power\": 20", "\"power\": -1")).unwrap();
    error("dark.json", 2, &["dark.json:9:", "lights[0].point.power"]);
    render(folder.path(), &["--set", "film.width=0"]).is_error(2, &["film.width"]);
    render(folder.path(), &["--size", "60000x60000"]).is_error(1, &["memory"]);
    render(folder.path(), &["-o", "picture.png"]).is_error(2, &["picture.png", ".exr"]);
    assert_eq!(names_in(folder.path()), ["ball.json", "broken.json", "dark.json"]);
}

#[test]
fn an_unwritable_output_is_told_before_rendering_begins() {
    let folder = scene();
    let start = Instant::now();
    render(folder.path(), &["-o", "no/such/folder/a.exr", "--time", "1h"]).is_error(1, &["no/such/folder/a.exr"]);
    render(folder.path(), &["--stats", "no/stats.json", "--time", "1h"]).is_error(1, &["no/stats.json"]);
    assert!(start.elapsed() < Duration::from_secs(60));
    assert_eq!(names_in(folder.path()), ["ball.json"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_the_machine_s_fault() {
    let folder = scene();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("full.exr")).unwrap();
    let said = render(folder.path(), &["-o", "full.exr", "--passes", "1", "--quiet"]);
    said.is_error(1, &["full.exr", "cannot be written", "saved in full.checkpoint.exr"]);
    assert_eq!(names_in(folder.path()), ["ball.json", "full.checkpoint.exr", "full.exr"]);
}

/// Starts a render that runs until it is interrupted.
fn endless(folder: &Path) -> Child {
    let mut command = command(folder);
    let child = command.args(["render", "ball.json", "--time", "10m", "--threads", "1"]);
    child.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_saves_what_it_has() {
    use std::io::{BufRead, BufReader, Read};
    for name in ["-INT", "-TERM"] {
        let folder = scene();
        let mut child = endless(folder.path());
        let mut err = BufReader::new(child.stderr.take().unwrap());
        // At the first line of progress, the signal handler is installed and one pass is complete.
        let mut lines = String::new();
        while !lines.contains(" pass") {
            assert!(err.read_line(&mut lines).unwrap() > 0, "{lines}");
        }
        crate::abbe_command::signal::signal(&child, name);
        let mut rest = String::new();
        err.read_to_string(&mut rest).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{rest}");
        assert!(rest.contains("ball.exr"), "{rest}");
        let passes: u64 = header(folder.path(), "ball.exr", "abbe.passes").parse().unwrap();
        assert!(passes >= 1);
        assert!(rest.contains("--resume continues from ball.checkpoint.exr"), "{rest}");
        assert_eq!(names_in(folder.path()), ["ball.checkpoint.exr", "ball.exr", "ball.json", "ball.png"]);
    }
}

#[test]
fn explain_names_every_effect_with_its_reason() {
    let folder = scene();
    let plan = abbe(folder.path(), &["explain", "ball.json", "--json"]).json();
    for effect in plan["effects"].as_array().unwrap() {
        for key in ["name", "state", "because", "field"] {
            assert!(effect[key].as_str().is_some_and(|text| !text.is_empty()), "{effect}");
        }
    }
    assert_eq!((&plan["wavelengths"], &plan["passes"], &plan["photons"]), (&"both".into(), &4.into(), &500.into()));
    assert!(plan["memory_bytes"].as_u64() > Some(0));
    let text = abbe(folder.path(), &["explain", "ball.json"]).out;
    assert!(text.contains("dispersion") && text.contains("ball"), "{text}");
}

#[test]
fn check_looks_at_every_scene() {
    let folder = scene();
    std::fs::write(folder.path().join("bad.json"), SCENE.replace("N-BK7", "N-BK8")).unwrap();
    let good = abbe(folder.path(), &["check", "ball.json"]);
    assert_eq!((good.status, good.out.as_str(), good.err.as_str()), (0, "ball.json: ok\n", ""));
    let both = abbe(folder.path(), &["check", "bad.json", "ball.json", "missing.json"]);
    assert_eq!((both.status, both.out.as_str()), (2, "ball.json: ok\n"));
    assert!(both.err.contains("bad.json:5:") && both.err.contains("did you mean") && both.err.contains("missing.json"));
    assert_eq!(both.err.lines().count(), 2, "{}", both.err);
}

#[test]
fn files_outside_the_scene_folder_need_permission() {
    let folder = scene();
    let below = folder.path().join("below");
    std::fs::create_dir(&below).unwrap();
    std::fs::write(folder.path().join("lamp.csv"), "nm,value\n400,1\n700,2\n").unwrap();
    std::fs::write(below.join("lamp.csv"), "nm,value\n400,1\n700,2\n").unwrap();
    for (path, word) in
        [("../lamp.csv", "../lamp.csv"), ("/etc/hostname", "/etc/hostname"), ("a/../../lamp.csv", "a/../..")]
    {
        let text = SCENE.replacen('{', &format!("{{\"spectra\": {{\"far\": {{\"file\": \"{path}\"}}}},"), 1);
        std::fs::write(below.join("far.json"), text).unwrap();
        for command in ["check", "explain", "render"] {
            let said = abbe(folder.path(), &[command, "below/far.json"]);
            said.is_error(2, &["far.json:1:", "spectra.far", word, "out of the folder", "--allow-outside"]);
        }
    }
    let text = SCENE.replacen('{', "{\"spectra\": {\"far\": {\"file\": \"../lamp.csv\"}},", 1);
    std::fs::write(below.join("far.json"), text).unwrap();
    let said = abbe(folder.path(), &["check", "below/far.json", "--allow-outside"]);
    assert_eq!(said.status, 0, "{}", said.err);
}

/// A pass of this render takes minutes. A stop in it discards it, and nothing is left.
#[cfg(unix)]
#[test]
fn a_stop_does_not_wait_for_the_end_of_the_pass() {
    for wait_ms in [300, 1500] {
        let folder = scene();
        let arguments = ["render", "ball.json", "--photons", "20000000", "--threads", "1", "--quiet"];
        let child = command(folder.path()).args(arguments).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait_ms));
        let start = Instant::now();
        crate::abbe_command::signal::signal(&child, "-TERM");
        let said = Said::from(child.wait_with_output().unwrap());
        assert!(start.elapsed() < Duration::from_secs(4), "{:?}", start.elapsed());
        assert_eq!(said.status, 130, "{}", said.err);
        assert!(said.err.contains("interrupted before the first pass was done"), "{}", said.err);
        assert_eq!(names_in(folder.path()), ["ball.json"]);
    }
}
