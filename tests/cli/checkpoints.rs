//! Checkpoints, resuming, parts and merging: each finished pass is counted exactly once.

use crate::abbe_command::folder::{names_in, with_ball};
use crate::abbe_command::{Said, abbe, command};
use abbe_session::output::exr;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A small picture with dispersion, caustics and indirect light.
const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 16, "height": 12, "spectral_bands": 3},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "SF10"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "stone", "shape": {"sphere": {"center": [-1, 0.4, 0], "radius": 0.4}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"passes": 19, "photons": 500}
}"#;

/// A folder with `ball.json` and the picture of an uninterrupted run, `whole.exr` and `whole.png`.
fn scene() -> TempDir {
    let folder = with_ball(SCENE);
    done(&render(folder.path(), &["-o", "whole.exr", "--stats", "whole.json"]));
    folder
}

fn render(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["render", "ball.json", "--quiet", "--threads", "1"], more].concat())
}

#[track_caller]
fn done(said: &Said) {
    assert_eq!(said.status, 0, "{}", said.err);
}

/// Checks that two pictures, their errors, spectra and PNGs are bit-identical.
#[track_caller]
fn is_same_picture(folder: &Path, found: &str, known: &str) {
    let file = |name: &str| exr::read(&folder.join(name).with_extension("exr")).unwrap();
    let (a, b) = (file(found), file(known));
    assert!(a.picture == b.picture, "{found}.exr differs from {known}.exr");
    for key in ["abbe.passes", "abbe.sceneHash", "abbe.seed", "abbe.photons", "abbe.version"] {
        assert_eq!(a.metadata.get(key), b.metadata.get(key));
    }
    let png = |name: &str| std::fs::read(folder.join(name).with_extension("png")).unwrap();
    assert!(png(found) == png(known), "{found}.png differs from {known}.png");
}

fn stats(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

/// Returns the statistics without the values that differ between any two runs.
fn counted(mut stats: Value) -> Value {
    let object = stats.as_object_mut().unwrap();
    ["seconds", "forecast", "photons_per_second", "peak_memory_bytes", "threads"].iter().for_each(|key| {
        object.remove(*key);
    });
    stats
}

#[test]
fn a_kept_checkpoint_extends_to_the_picture_of_a_single_run() {
    let folder = scene();
    let at = folder.path();
    done(&render(at, &["--passes", "5", "--keep-checkpoint"]));
    assert!(at.join("ball.checkpoint.exr").exists());
    done(&render(at, &["--passes", "11", "--resume", "--keep-checkpoint"]));
    let said = render(at, &["--passes", "4", "--resume"]);
    said.is_error(2, &["11 passes already", "at least 11 passes"]);
    done(&render(at, &["--resume", "--keep-checkpoint", "--stats", "ball.stats.json"]));
    is_same_picture(at, "ball", "whole");
    assert_eq!(counted(stats(at, "ball.stats.json")), counted(stats(at, "whole.json")));
    // The render is complete: resuming writes the same picture and removes the checkpoint.
    done(&render(at, &["--resume"]));
    is_same_picture(at, "ball", "whole");
    assert!(!at.join("ball.checkpoint.exr").exists());
}

/// A batch job starts with the same command whether it starts first, after a kill or at the end.
#[test]
fn resume_auto_starts_continues_and_ends() {
    let folder = scene();
    let at = folder.path();
    let words = ["render", "ball.json", "--threads", "1", "--resume", "auto", "--keep-checkpoint", "--passes"];
    let auto = |passes: &str| abbe(at, &[&words[..], &[passes]].concat());
    render(at, &["--resume"]).is_error(2, &["the checkpoint does not exist", "--resume auto"]);
    let said = auto("4");
    done(&said);
    assert!(
        said.err.contains("there is no ball.checkpoint.exr, so the render starts from the beginning"),
        "{}",
        said.err
    );
    let said = auto("9");
    done(&said);
    assert!(said.err.contains("resuming after 4 passes"), "{}", said.err);
    std::fs::remove_file(at.join("ball.checkpoint.exr")).unwrap();
    let said = auto("9");
    done(&said);
    assert!(said.err.contains("ball.exr is already finished"), "{}", said.err);
}

#[test]
fn the_path_tracer_resumes_too_and_on_any_number_of_threads() {
    let folder = scene();
    let (at, path) = (folder.path(), ["--integrator", "path"]);
    done(&render(at, &[&path[..], &["-o", "once.exr"]].concat()));
    done(&render(at, &[&path[..], &["--passes", "3", "--keep-checkpoint"]].concat()));
    let more = ["render", "ball.json", "--quiet", "--threads", "3", "--resume"];
    done(&abbe(at, &[&more[..], &path].concat()));
    is_same_picture(at, "ball", "once");
}

#[test]
fn stop_rules_count_from_the_very_beginning() {
    let folder = scene();
    let at = folder.path();
    let passes = || exr::read(&at.join("ball.exr")).unwrap().metadata.get("abbe.passes").unwrap().to_string();
    // A target error that 16 passes reach. A resumed run must detect this both at 16 passes and
    // below.
    for first in ["16", "9"] {
        done(&render(at, &["--passes", first, "--keep-checkpoint"]));
        done(&render(at, &["--target-error", "1000%", "--resume"]));
        assert_eq!(passes(), "16", "from {first}");
    }
    done(&render(at, &["--time", "300ms", "--keep-checkpoint"]));
    let first = passes();
    done(&render(at, &["--time", "100ms", "--resume", "--keep-checkpoint"]));
    assert_eq!(passes(), first, "no time is left");
    let seconds =
        exr::read(&at.join("ball.exr")).unwrap().metadata.get("abbe.seconds").unwrap().parse::<f64>().unwrap();
    done(&render(at, &["--time", &format!("{:.3}s", seconds + 0.5), "--resume"]));
    assert!(passes().parse::<u64>().unwrap() > first.parse::<u64>().unwrap());
}

/// The size of a pass depends on the speed of the machine, so the checkpoint contains it.
#[test]
fn a_time_limit_makes_passes_smaller_and_a_resumed_render_keeps_their_size() {
    let folder = scene();
    let at = folder.path();
    let count = |name: &str| stats(at, "stats.json")[name].as_u64().unwrap();
    let many = ["--photons", "800000", "--keep-checkpoint", "--stats", "stats.json"];
    let rendered = |limits: &[&str]| {
        done(&render(at, &[&many[..], limits].concat()));
        count("photons_emitted") / count("passes")
    };
    let small = rendered(&["--time", "50ms"]);
    let notes = stats(at, "stats.json")["notes"].to_string();
    assert!(notes.contains("passes are smaller than without a time limit"), "{notes}");
    assert!(small <= 200_000, "{small}");
    let saved = at.join("ball.checkpoint.exr");
    std::fs::copy(&saved, at.join("saved.exr")).unwrap();
    assert_eq!(rendered(&["--passes", "100", "--time", "800ms", "--resume"]), small);
    let passes = count("passes").to_string();
    std::fs::copy(at.join("ball.exr"), at.join("in_two.exr")).unwrap();
    std::fs::copy(at.join("ball.png"), at.join("in_two.png")).unwrap();
    std::fs::copy(at.join("saved.exr"), &saved).unwrap();
    assert_eq!(rendered(&["--passes", &passes, "--resume"]), small);
    is_same_picture(at, "ball", "in_two");
}

#[cfg(unix)]
#[test]
fn a_render_that_is_interrupted_goes_on_where_it_was() {
    let folder = scene();
    let at = folder.path();
    for (signal, part) in [("-TERM", "0/1"), ("-INT", "1/2")] {
        let mut command = command(at);
        let options = ["--quiet", "--threads", "1", "--checkpoint-every", "1ms", "--part", part, "-o", "ball.exr"];
        command.args(["render", "ball.json", "--passes", "1000000"]).args(options).stderr(Stdio::piped());
        let child = command.spawn().unwrap();
        let start = Instant::now();
        while !at.join("ball.checkpoint.exr").exists() {
            assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint");
            std::thread::sleep(Duration::from_millis(5));
        }
        let id = child.id().to_string();
        assert!(std::process::Command::new("kill").args([signal, &id]).status().unwrap().success());
        let said = Said::from(child.wait_with_output().unwrap());
        assert_eq!(said.status, 130, "{}", said.err);
        assert!(said.err.contains("saved ball.exr") && said.err.contains("ball.checkpoint.exr"), "{}", said.err);

        let passes = exr::read(&at.join("ball.exr")).unwrap().metadata.get("abbe.passes").unwrap().to_string();
        let more = (2 * passes.parse::<u64>().unwrap() + 3).to_string();
        let options = ["--part", part, "--passes", &more];
        done(&render(at, &[&options[..], &["-o", "ball.exr", "--resume"]].concat()));
        done(&render(at, &[&options[..], &["-o", "once.exr"]].concat()));
        is_same_picture(at, "ball", "once");
        assert!(!at.join("ball.checkpoint.exr").exists());
    }
}

#[test]
fn a_checkpoint_of_another_render_is_refused_by_name() {
    let folder = scene();
    let at = folder.path();
    render(at, &["--resume"])
        .is_error(2, &["ball.checkpoint.exr", "the checkpoint does not exist", "--keep-checkpoint"]);
    done(&render(at, &["--passes", "2", "--keep-checkpoint"]));
    let before = std::fs::read(at.join("ball.checkpoint.exr")).unwrap();
    let cases: [(&[&str], &[&str]); 8] = [
        (&["--seed", "3"], &["seed 0", "seed 3"]),
        (&["--integrator", "path"], &["integrator photon", "integrator path"]),
        (&["--size", "12x16"], &["16 × 12 pixels", "12 × 16 pixels"]),
        (&["--photons", "501"], &["500 photons per pass", "501 photons per pass"]),
        (&["--spectral-bands", "4"], &["3 spectral bands", "4 spectral bands"]),
        (&["--set", "lights[0].point.power=21"], &["another scene: lights[0].point.power is 20", "power is 21"]),
        (&["--forbid", "caustics"], &["caustics on", "caustics forbidden"]),
        (&["--part", "1/2"], &["part 0/1", "part 1/2"]),
    ];
    for (options, words) in cases {
        let said = render(at, &[&["--resume", "-o", "ball.exr"], options].concat());
        said.is_error(2, &[&["ball.checkpoint.exr"], words].concat());
    }
    assert!(std::fs::read(at.join("ball.checkpoint.exr")).unwrap() == before, "a refused checkpoint stays as it is");
}

#[test]
fn a_damaged_checkpoint_is_refused() {
    let folder = scene();
    let at = folder.path();
    done(&render(at, &["--passes", "2", "--keep-checkpoint"]));
    let path = at.join("ball.checkpoint.exr");
    let sound = std::fs::read(&path).unwrap();
    let refused = |bytes: &[u8], word: &str| {
        std::fs::write(&path, bytes).unwrap();
        render(at, &["--resume"]).is_error(2, &["ball.checkpoint.exr", word]);
    };
    refused(b"", "EXR");
    refused(&sound[..sound.len() / 2], "");
    refused(&sound[..sound.len() - 100], "");
    refused(&std::fs::read(at.join("ball.exr")).unwrap(), "no exact sums");
    // Changes a digit of the record, and of the version, in the header.
    let place = |text: &[u8]| sound.windows(text.len()).position(|window| window == text).unwrap();
    let changed = |at: usize, byte: u8| {
        let mut bytes = sound.clone();
        bytes[at] = byte;
        bytes
    };
    refused(&changed(place(br#""done":2"#) + 7, b'3'), "damaged");
    refused(&changed(place(b"abbe.version") + 12 + 1 + 7 + 4, b'9'), "was written by abbe 9.");
    // Any other changed byte is either detected or has no influence on the sums.
    for step in 0..40 {
        let here = (step * 7919 + 31) % sound.len();
        std::fs::write(&path, changed(here, sound[here] ^ 0x55)).unwrap();
        let said = render(at, &["--resume"]);
        match said.status {
            0 => is_same_picture(at, "ball", "whole"),
            _ => said.is_error(2, &["ball.checkpoint.exr"]),
        }
    }
    std::fs::write(&path, &sound).unwrap();
    done(&render(at, &["--resume"]));
    is_same_picture(at, "ball", "whole");
}

#[test]
fn merged_parts_are_the_picture_of_a_single_run() {
    let folder = scene();
    let at = folder.path();
    for (part, name) in [("0/2", "a.exr"), ("1/4", "b.exr"), ("3/4", "c.exr")] {
        done(&render(at, &["--part", part, "-o", name]));
    }
    done(&abbe(at, &["merge", "c.exr", "a.exr", "b.exr", "-o", "merged.exr", "--stats", "merged.json", "--quiet"]));
    is_same_picture(at, "merged", "whole");
    let (mut merged, mut whole) = (counted(stats(at, "merged.json")), counted(stats(at, "whole.json")));
    let ledger = |stats: &mut Value| stats.as_object_mut().unwrap().remove("ledger_w").unwrap();
    let (found, known) = (ledger(&mut merged), ledger(&mut whole));
    assert_eq!(merged, whole);
    for key in ["emitted", "absorbed", "escaped", "sampling"] {
        let [found, known] = [&found, &known].map(|ledger| ledger[key].as_f64().unwrap());
        assert!((found - known).abs() < 1e-9, "{key}: {found} {known}");
    }

    // As many parts as replicates, and more, with default file names.
    for part in ["0/3", "1/3", "2/3"] {
        done(&render(at, &["--part", part]));
    }
    let names = ["ball.part-0-of-3.exr", "ball.part-1-of-3.exr", "ball.part-2-of-3.exr"];
    done(&abbe(at, &[&["merge", "-o", "thirds.exr"], &names[..]].concat()));
    is_same_picture(at, "thirds", "whole");
}

#[test]
fn parts_that_do_not_fit_are_refused_by_name() {
    let folder = scene();
    let at = folder.path();
    let merge = |more: &[&str]| abbe(at, &[&["merge", "-o", "merged.exr"], more].concat());
    for (part, name) in [("0/2", "a.exr"), ("1/2", "b.exr"), ("1/4", "quarter.exr")] {
        done(&render(at, &["--part", part, "-o", name]));
    }
    done(&render(at, &["--part", "1/2", "--seed", "5", "-o", "seed.exr"]));
    done(&render(at, &["--part", "1/2", "--set", "lights[0].point.power=21", "-o", "scene.exr"]));
    merge(&["a.exr", "b.exr", "quarter.exr"]).is_error(2, &["quarter.exr", "pass 1", "b.exr also contains"]);
    // The last pass of one part is the only pass of another part.
    done(&render(at, &["--part", "0/2", "--passes", "5", "-o", "even.exr"]));
    done(&render(at, &["--part", "4/5", "--passes", "5", "-o", "last.exr"]));
    merge(&["even.exr", "last.exr"]).is_error(2, &["last.exr", "contains pass 4", "even.exr also contains"]);
    merge(&["a.exr", "./a.exr"]).is_error(2, &["a.exr", "given twice"]);
    merge(&["a.exr", "seed.exr"]).is_error(2, &["seed.exr", "seed 5", "seed 0, as a.exr has"]);
    merge(&["a.exr", "scene.exr"])
        .is_error(2, &["scene.exr", "another scene: lights[0].point.power is 21", "power is 20, as a.exr has"]);
    merge(&["a.exr", "whole.exr"]).is_error(2, &["whole.exr", "no exact sums", "a part or a checkpoint"]);
    merge(&["a.exr", "missing.exr"]).is_error(2, &["missing.exr"]);
    // Records with a film that is too large or with too many passes are refused.
    let sound = std::fs::read(at.join("a.exr")).unwrap();
    for (text, digit) in [(&br#""size":["#[..], b'9'), (br#""done":"#, b'9')] {
        let mut bytes = sound.clone();
        let place = sound.windows(text.len()).position(|window| window == text).unwrap() + text.len();
        bytes[place] = digit;
        std::fs::write(at.join("forged.exr"), bytes).unwrap();
        let said = merge(&["forged.exr", "--allow-gaps"]);
        assert!(said.status == 2 && said.err.contains("forged.exr: is damaged"), "{}", said.err);
    }
    abbe(at, &["merge", "a.exr", "b.exr", "-o", "b.exr"]).is_error(2, &["b.exr", "which this command reads"]);
    let words = ["lack 4 of 19 passes (3, 7, 11, …)", "a.exr: 10 of part 0/2", "--allow-gaps"];
    merge(&["a.exr", "quarter.exr"]).is_error(2, &words);
    render(at, &["--part", "3/2"]).is_error(2, &["3/2", "0/2 to 1/2"]);
    render(at, &["--part", "7/8", "--passes", "4"]).is_error(2, &["part 7/8 contains none of the passes"]);
    render(at, &["--part", "0/2", "--target-error", "1%"]).is_error(2, &["--part", "--target-error"]);
    assert!(!at.join("merged.exr").exists());

    let said = merge(&["a.exr", "quarter.exr", "--allow-gaps"]);
    done(&said);
    assert!(said.err.contains("without 4 of 19 passes (3, 7, 11, …)"), "{}", said.err);
    let file = exr::read(&at.join("merged.exr")).unwrap();
    assert_eq!(file.metadata.get("abbe.passes"), Some("15"));
    assert!(file.metadata.get("abbe.notes").unwrap().contains("merged without 4 of 19 passes"));
}

#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_leaves_the_last_good_files_and_no_other() {
    use std::os::unix::fs::PermissionsExt;
    let folder = scene();
    let at = folder.path();
    std::fs::create_dir(at.join("out")).unwrap();
    done(&render(at, &["-o", "out/ball.exr", "--passes", "2", "--keep-checkpoint"]));
    let before = names_in(&at.join("out"));
    let bytes = || before.iter().map(|name| std::fs::read(at.join("out").join(name)).unwrap()).collect::<Vec<_>>();
    let good = bytes();
    // A limit on the file size simulates a full disk: writing fails halfway.
    let binary = env!("CARGO_BIN_EXE_abbe");
    let limited = format!(
        "trap '' XFSZ; ulimit -f 4; exec {binary} render ball.json --threads 1 --quiet -o out/ball.exr --checkpoint-every 1ms --resume"
    );
    let output = std::process::Command::new("bash").args(["-c", &limited]).current_dir(at).output().unwrap();
    let said = Said::from(output);
    assert_eq!(said.status, 1, "{}", said.err);
    assert!(
        said.err.contains("the checkpoint cannot be written")
            && said.err.contains("error: out/ball.exr: cannot be written"),
        "{}",
        said.err
    );
    assert_eq!(names_in(&at.join("out")), before);
    assert!(bytes() == good, "what was there is as it was");
    done(&render(at, &["-o", "out/ball.exr", "--resume"]));
    std::fs::rename(at.join("out/ball.exr"), at.join("later.exr")).unwrap();
    std::fs::rename(at.join("out/ball.png"), at.join("later.png")).unwrap();
    is_same_picture(at, "later", "whole");

    // No user, not even root, can create files in /proc.
    #[cfg(target_os = "linux")]
    render(at, &["-o", "/proc/a.exr", "--time", "1h"]).is_error(1, &["/proc/a.exr", "cannot be written"]);
    // Only root can write into a read-only folder.
    let read_only = at.join("read-only");
    std::fs::create_dir(&read_only).unwrap();
    std::fs::set_permissions(&read_only, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::File::create(read_only.join("probe")).is_err() {
        render(at, &["-o", "read-only/a.exr", "--time", "1h"]).is_error(1, &["read-only/a.exr", "cannot be written"]);
    }
}

#[test]
fn what_does_not_fit_into_memory_is_refused_before_it_is_tried() {
    let folder = scene();
    let at = folder.path();
    let start = Instant::now();
    let said = |more: &[&str]| render(at, &[&["-o", "big.exr"], more].concat());
    said(&["--photons", "1000000000000"]).is_error(1, &["not enough memory", "need ", " GB", "at most --photons"]);
    said(&["--photons", &u64::MAX.to_string()]).is_error(1, &["not enough memory", "at most --photons"]);
    said(&["--size", "65536x65536"]).is_error(1, &["not enough memory", "a smaller --size"]);
    said(&["--size", "65536x65536", "--spectral-bands", "1024"])
        .is_error(1, &["not enough memory", "a smaller --size"]);
    assert!(start.elapsed() < Duration::from_secs(20));
    assert!(!at.join("big.exr").exists());
    let plan = abbe(at, &["explain", "ball.json", "--json"]).json();
    assert!(plan["memory_bytes"].as_u64().is_some_and(|bytes| (100_000..10_000_000).contains(&bytes)), "{plan}");
}

/// Renders with a checkpoint after every pass. Kills the process repeatedly at moments derived from
/// a seed until it finishes. Returns how many processes were killed while they wrote.
fn killed_at_random(kills: u64, seed: u64) -> u64 {
    let folder = scene();
    let at = folder.path();
    let checkpoint = at.join("ball.checkpoint.exr");
    let begin = |resume: bool| -> Child {
        let mut command = command(at);
        command.args(["render", "ball.json", "--quiet", "--threads", "1", "--checkpoint-every", "1ms"]);
        command.args(resume.then_some("--resume")).stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().unwrap()
    };
    // The duration of an undisturbed run gives the range of these moments.
    let start = Instant::now();
    assert!(begin(false).wait().unwrap().success());
    let whole = start.elapsed();
    let (mut state, mut killed, mut resumed, mut writing) = (seed, 0, 0, 0);
    for _ in 0..100 * kills {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let moment = whole.mul_f64((state >> 11) as f64 / (1_u64 << 53) as f64);
        let resume = checkpoint.exists();
        resumed += u64::from(resume);
        let mut child = begin(resume);
        std::thread::sleep(moment);
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            None => {
                killed += 1;
                writing += u64::from(names_in(at).iter().any(|name| name.contains(".unfinished-")));
            }
            Some(0) => is_same_picture(at, "ball", "whole"),
            Some(_) => panic!("{}", String::from_utf8_lossy(&output.stderr)),
        }
        if killed >= kills && resumed >= kills / 2 {
            break;
        }
    }
    assert!(killed >= kills && resumed >= kills / 2, "{killed} killed, {resumed} resumed");
    assert!(kills < 50 || writing > 0, "none of {killed} was killed while it wrote");
    assert!(begin(checkpoint.exists()).wait().unwrap().success());
    is_same_picture(at, "ball", "whole");
    let names = ["ball.exr", "ball.json", "ball.png", "whole.exr", "whole.json", "whole.png"];
    assert_eq!(names_in(at), names, "also what a killed process left half-written is gone");
    writing
}

#[test]
fn a_render_that_is_killed_resumes_to_the_same_picture() {
    killed_at_random(5, 1);
}

#[test]
#[ignore = "slow: 200 kills and resumptions"]
fn a_render_killed_repeatedly_resumes_to_the_same_bits() {
    println!("{} of 200 killed while they wrote", killed_at_random(200, 2));
}

/// Twelve lamps with different spectral lines light a floor behind dispersive glass. A few passes
/// have no wavelength that suits some of the lamps. The replicates cannot show the missing light,
/// so the error is unknown, in a single run as well as after merging.
#[test]
fn the_error_is_unknown_until_each_spectrum_is_sampled() {
    let mut scene: Value = serde_json::from_str(SCENE).unwrap();
    let lamp = |i: u32| {
        let lines = serde_json::json!({"lines": [{"nm": 420 + 20 * i, "power": 1}]});
        serde_json::json!({"point": {"at": [1, 4, 1], "spectrum": lines, "power": 20}})
    };
    scene["lights"] = (0..12).map(lamp).collect();
    let folder = with_ball(&scene.to_string());
    let at = folder.path();
    let said = abbe(at, &["render", "ball.json", "--passes", "3", "-o", "whole.exr", "--stats", "whole.json"]);
    done(&said);
    let few = stats(at, "whole.json");
    let missing = few["unsampled_lights"].as_array().unwrap().len();
    assert!((1..12).contains(&missing) && few["error"]["relative"].is_null() && few["forecast"].is_null(), "{few}");
    let note = "no pass has sampled the spectrum of \"";
    let notes = |stats: &Value| {
        stats["notes"].as_array().unwrap().iter().filter(|n| n.as_str().unwrap().contains(note)).count()
    };
    assert_eq!(notes(&few), 1);
    assert!(said.err.contains(note), "{}", said.err);

    for (part, name) in [("0/3", "a"), ("1/3", "b"), ("2/3", "c")] {
        done(&render(
            at,
            &["--passes", "3", "--part", part, "-o", &format!("{name}.exr"), "--stats", &format!("{name}.json")],
        ));
    }
    assert!(stats(at, "a.json")["unsampled_lights"].as_array().unwrap().len() > missing);
    done(&abbe(at, &["merge", "a.exr", "b.exr", "c.exr", "-o", "merged.exr", "--stats", "merged.json", "--quiet"]));
    let merged = stats(at, "merged.json");
    for key in ["unsampled_lights", "error", "notes"] {
        assert_eq!(merged[key], few[key], "{key}");
    }

    // A target error does not end the render before all spectra are sampled.
    done(&render(at, &["--target-error", "1000000%", "-o", "many.exr", "--stats", "many.json"]));
    let many = stats(at, "many.json");
    assert_eq!((many["unsampled_lights"].as_array().unwrap().len(), notes(&many)), (0, 0));
    assert!(many["error"]["relative"].is_number());
}
