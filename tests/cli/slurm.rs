//! `abbe slurm` with a stand-in for Slurm, and `abbe merge --watch`. `tests/run --cluster` tests
//! the scripts on a real Slurm.

#![cfg(unix)]

use crate::abbe_command::folder::{names_in, with_ball};
use crate::abbe_command::signal::signal;
use crate::abbe_command::{Said, abbe, command};
use abbe_session::output::exr;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 16, "height": 12},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "SF10"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"passes": 9, "photons": 300}
}"#;

/// A program `sbatch` that runs each job at once. It does not run the first `LOST` tasks with the
/// index 1, like a machine that fails.
const SBATCH: &str = r#"#!/bin/bash
array=
for word in "$@"; do
  case $word in
    --array=*) array=${word#*=} ;;
    --export=ALL,*) IFS=, read -ra variables <<< "${word#--export=ALL,}" ;;
  esac
done
echo "$*" >> calls
export "${variables[@]}"
script=${!#}
id=$(wc -l < calls)
if [ -z "$array" ]; then
  bash "$script" >> logs/merge.log 2>&1
  echo $? > merge.status
fi
case $array in
  *-*) list=$(seq "${array%-*}" "${array#*-}") ;;
  *) list=${array//,/ } ;;
esac
for task in $list; do
  if [ "$task" = 1 ] && [ "$(cat lost 2> /dev/null || echo 0)" -lt "${LOST:-0}" ]; then
    echo $(($(cat lost 2> /dev/null || echo 0) + 1)) > lost
    continue
  fi
  SLURM_ARRAY_JOB_ID=$id SLURM_ARRAY_TASK_ID=$task bash "$script" >> "logs/part-$task.log" 2>&1
done
echo "$id"
"#;

/// Runs `abbe slurm` with the stand-in for `sbatch`. `lost` tasks do not run.
fn slurm(folder: &Path, lost: u32, arguments: &[&str]) -> Said {
    let bin = folder.join("bin");
    std::fs::create_dir_all(&bin).unwrap();
    std::fs::write(bin.join("sbatch"), SBATCH).unwrap();
    std::fs::set_permissions(bin.join("sbatch"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let mut command = command(folder);
    command.arg("slurm").args(arguments).env("PATH", path).env("LOST", lost.to_string());
    command.output().unwrap().into()
}

#[track_caller]
fn is_same_picture(folder: &Path, found: &str, known: &str) {
    let [found, known] = [found, known].map(|name| exr::read(&folder.join(name)).unwrap());
    assert!(found.picture == known.picture, "the pictures differ");
    assert_eq!(found.metadata.get("abbe.passes"), known.metadata.get("abbe.passes"));
}

fn render(folder: &Path, arguments: &[&str]) {
    let said = abbe(folder, &[&["render", "ball.json", "--quiet", "--threads", "1"], arguments].concat());
    assert_eq!(said.status, 0, "{}", said.err);
}

#[test]
fn the_jobs_render_the_picture_of_a_single_run() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    // Names with characters that have a meaning in a shell.
    let scene = "it's $(touch pwned) \"ball\".json";
    std::fs::rename(at.join("ball.json"), at.join(scene)).unwrap();
    let options = ["--parts", "3", "-o", "`touch pwned`; out", "--time", "90m", "--sbatch=--comment=$(touch pwned)"];
    let said = slurm(at, 0, &[&[scene], &options[..], &["--submit", "--", "--set", "film.width=20"]].concat());
    assert_eq!(said.status, 0, "{}", said.err);
    std::fs::rename(at.join(scene), at.join("ball.json")).unwrap();
    render(at, &["--set", "film.width=20", "-o", "whole.exr"]);
    let out = at.join("`touch pwned`; out");
    is_same_picture(at, "`touch pwned`; out/it's $(touch pwned) \"ball\".exr", "whole.exr");
    assert!(names_in(at).iter().chain(&names_in(&out)).all(|name| name != "pwned"), "a name was run as a command");
    let calls = std::fs::read_to_string(out.join("calls")).unwrap();
    let array = calls.lines().next().unwrap();
    for word in ["--array=0-2", "--requeue", "--time=90", "--cpus-per-task=1", "--comment=$(touch pwned)"] {
        assert!(array.contains(word), "{array}");
    }
    assert!(calls.lines().nth(1).unwrap().contains("--dependency=afterany:1"), "{calls}");
    let parts = names_in(&out.join("parts"));
    assert_eq!(parts.iter().filter(|name| name.ends_with(".exr")).count(), 3, "{parts:?}");
    assert!(out.join("it's $(touch pwned) \"ball\".json").exists(), "the statistics");
}

#[test]
fn a_lost_part_is_rendered_again_and_counted_once() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    render(at, &["-o", "whole.exr"]);
    let said = slurm(at, 2, &["ball.json", "--parts", "3", "-o", "out", "--submit"]);
    assert_eq!(said.status, 0, "{}", said.err);
    is_same_picture(at, "out/ball.exr", "whole.exr");
    let calls = std::fs::read_to_string(at.join("out/calls")).unwrap();
    assert_eq!(calls.matches("--array=1 ").count(), 2, "{calls}");
    // Complete parts are not rendered again.
    std::fs::remove_file(at.join("out/ball.exr")).unwrap();
    std::fs::remove_file(at.join("out/parts/part-2-of-3.9.exr")).unwrap();
    let old = std::fs::metadata(at.join("out/parts/part-0-of-3.9.exr")).unwrap().modified().unwrap();
    assert_eq!(slurm(at, 0, &["ball.json", "--parts", "3", "-o", "out", "--submit"]).status, 0);
    is_same_picture(at, "out/ball.exr", "whole.exr");
    assert_eq!(std::fs::metadata(at.join("out/parts/part-0-of-3.9.exr")).unwrap().modified().unwrap(), old);
    // A part that is always lost ends the render with a message.
    slurm(at, 99, &["ball.json", "--parts", "3", "-o", "lost", "--submit"]);
    let log = std::fs::read_to_string(at.join("lost/logs/merge.log")).unwrap();
    assert!(log.contains("parts 1 are missing after 4 tries") && !at.join("lost/ball.exr").exists(), "{log}");
}

#[test]
fn rounds_end_at_the_target_error_or_at_the_largest_number_of_passes() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    let read = |name: &str| std::fs::read_to_string(at.join(name)).unwrap();
    slurm(at, 0, &["ball.json", "--parts", "3", "--target-error", "1000%", "-o", "first", "--submit"]);
    render(at, &["-o", "whole.exr", "--passes", "24"]);
    is_same_picture(at, "first/ball.exr", "whole.exr");
    assert_eq!(read("first/merge.status").trim(), "0");

    let options = ["--parts", "3", "--target-error", "0.0001%", "--passes", "60", "-o", "last", "--submit"];
    slurm(at, 0, &[&["ball.json"], &options[..]].concat());
    render(at, &["-o", "whole.exr", "--passes", "60"]);
    is_same_picture(at, "last/ball.exr", "whole.exr");
    let log = read("last/logs/merge.log");
    assert!(log.contains("the next round has 48 passes") && log.contains("the next round has 60 passes"), "{log}");
    assert!(read("last/logs/part-1.log").contains("part 1 continues from its checkpoint"));
    let parts = names_in(&at.join("last/parts"));
    assert_eq!(parts.iter().filter(|name| name.ends_with(".exr")).count(), 3, "{parts:?}");
    let exact: Vec<String> = (0..3).map(|part| format!("last/parts/part-{part}-of-3.60.exr")).collect();
    let mut merge = vec!["merge", "-o", "again.exr", "--target-error", "0.0001%"];
    merge.extend(exact.iter().map(String::as_str));
    let said = abbe(at, &merge);
    assert!(said.status == 3 && said.err.contains("failed: the error of a typical pixel is"), "{}", said.err);
}

#[test]
fn wrong_options_are_refused_before_a_job_runs() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    let refused = |arguments: &[&str], words: &[&str]| {
        abbe(at, &[&["slurm", "ball.json"], arguments].concat()).is_error(2, words);
    };
    refused(&["--parts", "2", "--", "--part", "0/2"], &["--part", "do not allow"]);
    refused(&["--parts", "2", "--", "--passes", "7"], &["--passes", "do not allow"]);
    refused(&["--parts", "2", "--", "--phtons", "7"], &["--phtons", "--photons"]);
    refused(&["--parts", "2", "--", "--set", "film.widht=3"], &["widht"]);
    refused(&["--parts", "20"], &["9 passes for 20 parts", "fewer parts"]);
    refused(&["--parts", "1"], &["--parts"]);
    refused(&[], &["--parts"]);
    abbe(at, &["slurm", "missing.json", "--parts", "2"]).is_error(2, &["missing.json"]);
    assert_eq!(names_in(at), ["ball.json"]);
    let said = abbe(at, &["slurm", "ball.json", "--parts", "2"]);
    assert!(said.status == 0 && said.err.contains("`bash 'ball-slurm/submit.sh'` submits them"), "{}", said.err);
    assert_eq!(names_in(&at.join("ball-slurm")), ["merge.sh", "part.sh", "settings.sh", "submit.sh"]);
}

/// Starts `abbe merge --watch`.
fn watch(folder: &Path) -> Child {
    let mut command = command(folder);
    command.args(["merge", "--watch", "parts", "-o", "watched.exr"]).stderr(Stdio::piped());
    command.spawn().unwrap()
}

#[track_caller]
fn wait_for(what: impl Fn() -> bool) {
    let start = Instant::now();
    while !what() {
        assert!(start.elapsed() < Duration::from_secs(60), "no success in time");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_watched_picture_grows_until_all_parts_are_complete() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    std::fs::create_dir(at.join("parts")).unwrap();
    abbe(at, &["merge", "--watch", "missing", "-o", "a.exr"]).is_error(2, &["missing", "is not a folder"]);
    render(at, &["-o", "whole.exr"]);
    let passes = || Some(exr::read(&at.join("watched.exr")).ok()?.metadata.get("abbe.passes")?.to_string());
    let child = watch(at);
    // A checkpoint of a part, and the whole part, are counted once. A picture is no part.
    std::fs::copy(at.join("whole.exr"), at.join("parts/whole.exr")).unwrap();
    render(at, &["--part", "0/2", "--passes", "4", "-o", "parts/a.exr", "--keep-checkpoint"]);
    wait_for(|| passes().as_deref() == Some("2"));
    render(at, &["--part", "0/2", "-o", "parts/b.exr"]);
    wait_for(|| passes().as_deref() == Some("5"));
    render(at, &["--part", "1/2", "-o", "parts/c.exr"]);
    let said = Said::from(child.wait_with_output().unwrap());
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.err.contains("5 passes from 1 part, without 4 of 9 passes"), "{}", said.err);
    assert!(said.err.contains("9 passes from 2 parts; "), "{}", said.err);
    is_same_picture(at, "watched.exr", "whole.exr");
}

#[test]
fn parts_of_different_renders_are_not_watched() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    std::fs::create_dir(at.join("parts")).unwrap();
    render(at, &["--part", "0/2", "-o", "parts/a.exr"]);
    render(at, &["--part", "1/2", "--seed", "5", "-o", "parts/b.exr"]);
    let said = Said::from(watch(at).wait_with_output().unwrap());
    said.is_error(2, &["parts/b.exr", "seed 5", "seed 0"]);
}

#[test]
fn watching_can_be_interrupted() {
    let folder = with_ball(SCENE);
    let at = folder.path();
    std::fs::create_dir(at.join("parts")).unwrap();
    render(at, &["--part", "0/2", "-o", "parts/a.exr"]);
    let child = watch(at);
    wait_for(|| at.join("watched.png").exists());
    signal(&child, "-INT");
    let said = Said::from(child.wait_with_output().unwrap());
    assert_eq!(said.status, 130, "{}", said.err);
    assert_eq!(names_in(at), ["ball.json", "parts", "watched.exr", "watched.png"]);
}
