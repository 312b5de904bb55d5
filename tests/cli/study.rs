//! The command `abbe study`: its files, reuse of finished steps, interruption and errors.

use crate::abbe_command::folder::{names_in, with_ball};
use crate::abbe_command::{Said, abbe, command};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn scene() -> TempDir {
    with_ball(crate::study_scene::SCENE)
}

fn study(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["study", "ball.json", "-o", "out"], more].concat())
}

fn report(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("out/study.json")).unwrap()).unwrap()
}

/// Returns the rows of a CSV file without quoted cells. Each has as many cells as the header.
fn rows(folder: &Path, name: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(folder.join("out").join(name)).unwrap();
    let rows: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(str::to_string).collect()).collect();
    assert!(!text.contains('"') && rows[0].len() > 5, "{text}");
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{text}");
    rows
}

#[test]
fn a_study_leaves_its_files_and_takes_up_what_is_there() {
    let folder = scene();
    let said = study(folder.path(), &["--budget", "6s"]);
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.out.contains("slope of the error") && said.out.contains("path tracer"), "{}", said.out);
    let files = ["curves.csv", "curves.svg", "effects.csv", "settings.csv", "steps", "study.html", "study.json"];
    assert_eq!(names_in(&folder.path().join("out")), [&files[..], &["sweep.csv", "sweep.svg"]].concat());

    let found = report(folder.path());
    assert_eq!((&found["title"], &found["film"]["own_width"]), (&"A ball & its <caustic>".into(), &48.into()));
    // The path tracer cannot find the light of a point light through glass.
    assert_eq!(found["reference"]["origin"], "photon");
    assert!(found["reference"]["because"].as_str().unwrap().contains("ball"), "{}", found["reference"]);
    assert!(found["reference"]["relative_variance"].as_f64().unwrap() > 0.0);
    let integrators: Vec<&Value> =
        found["curves"].as_array().unwrap().iter().map(|curve| &curve["integrator"]).collect();
    assert_eq!(integrators, ["photon", "path"]);
    for curve in found["curves"].as_array().unwrap() {
        let points = curve["points"].as_array().unwrap();
        let passes: Vec<u64> = points.iter().map(|point| point["passes"].as_u64().unwrap()).collect();
        assert!(passes.starts_with(&[1, 2]) && passes.is_sorted(), "{passes:?}");
        let error = |i: usize| points[i]["wrong"]["whole"]["value"].as_f64().unwrap();
        assert!(error(0) > error(points.len() - 1), "{points:?}");
    }
    assert_eq!(found["curves"][1]["theory"][0]["slope"], -1.0);
    for effect in found["effects"]["off"].as_array().unwrap() {
        assert_eq!(effect["events"], 0, "{effect}");
    }
    let on: Vec<&str> =
        found["effects"]["on"].as_array().unwrap().iter().map(|on| on["name"].as_str().unwrap()).collect();
    let plan = abbe(folder.path(), &["explain", "ball.json", "--json"]).json();
    let planned = plan["effects"].as_array().unwrap().iter().filter(|effect| effect["state"] == "on");
    let planned: Vec<&str> = planned.map(|effect| effect["name"].as_str().unwrap()).collect();
    assert_eq!(on, planned);
    let place = on.iter().position(|&name| name == "direct").unwrap();
    let without_direct = &found["effects"]["on"][place]["left_out"]["measured"];
    assert!(without_direct["delta_e_2000"]["mean"].as_f64().unwrap() > 5.0, "{without_direct}");
    assert!(found["effects"]["wrong"]["value"].as_f64() < without_direct["wrong"]["value"].as_f64());
    assert!(without_direct["cost"]["memory_bytes"].as_u64().unwrap() > 0);
    assert!(!found["sweep"]["runs"].as_array().unwrap().is_empty() && found["sweep"]["runs"][0]["change"].is_null());

    let points: usize =
        found["curves"].as_array().unwrap().iter().map(|curve| curve["points"].as_array().unwrap().len()).sum();
    let curves = rows(folder.path(), "curves.csv");
    assert_eq!(curves.len(), 1 + points);
    assert!(curves[1..].iter().all(|row| row[1].parse::<u64>().is_ok() && row[2].parse::<f64>().is_ok()));
    let sweep = rows(folder.path(), "sweep.csv");
    let front = sweep.iter().filter(|row| row[7] == "true").count();
    assert_eq!(front, found["sweep"]["front"].as_array().unwrap().len());
    assert_eq!(rows(folder.path(), "settings.csv").len(), 1 + found["wanted"].as_array().unwrap().len());

    // All steps exist: nothing is rendered, and the results are equal.
    let before = std::fs::read(folder.path().join("out/study.json")).unwrap();
    let again = study(folder.path(), &["--budget", "6s"]);
    assert!(again.status == 0 && !again.err.contains("passes"), "{}", again.err);
    let steps = again.err.lines().filter(|line| line.ends_with(": cached")).count();
    assert!(steps >= 10, "{}", again.err);
    assert_eq!(std::fs::read(folder.path().join("out/study.json")).unwrap(), before);
    // One step is missing and one is damaged: only these two are repeated.
    let step = |name: &str| folder.path().join("out/steps").join(name);
    std::fs::remove_file(step("effects-without-direct.json")).unwrap();
    std::fs::write(step("curve-path.json"), "{\"identity\": ").unwrap();
    let again = study(folder.path(), &["--budget", "6s"]);
    let kept = again.err.lines().filter(|line| line.ends_with(": cached")).count();
    assert_eq!(kept, steps - 2, "{}", again.err);
}

/// The study, the render and the comparison speak of the same error.
#[test]
fn a_render_with_recommended_settings_has_the_promised_error() {
    let folder = scene();
    let at = folder.path();
    assert_eq!(study(at, &["--budget", "6s", "--quiet"]).status, 0);
    let found = report(at);
    let rows = found["wanted"].as_array().unwrap();
    let row = rows.iter().rfind(|row| row["extrapolated"] == false).expect("a measured error");
    let promised = row["typical_error"].as_f64().unwrap();
    let words: Vec<&str> = row["command"].as_str().unwrap().split(' ').skip(1).collect();
    assert!(words[..2] == ["render", "ball.json"] && words.contains(&"--passes"), "{words:?}");
    for (seed, name) in [("7", "a"), ("8", "b")] {
        let (exr, json) = (format!("{name}.exr"), format!("{name}.json"));
        let more = ["-o", &exr, "--stats", &json, "--seed", seed, "--quiet"];
        assert_eq!(abbe(at, &[&words[..], &more].concat()).status, 0);
        let stats: Value = serde_json::from_slice(&std::fs::read(at.join(json)).unwrap()).unwrap();
        let error = stats["error"]["typical"].as_f64().unwrap();
        // A film of another size has other noise at edges.
        assert!((0.5..1.6).contains(&(error / promised)), "{error} instead of {promised}: {words:?}");
        let said =
            abbe(at, &["render", "ball.json", "--quiet", "--target-error", &format!("{error}"), "--passes", "16"]);
        assert_eq!(said.status, 0, "{}", said.err);
    }
    let compared = abbe(at, &["compare", "a.exr", "b.exr", "--json"]).json();
    let error = compared["typical_error"].as_f64().unwrap();
    assert!((0.5..1.6).contains(&(error / promised)), "{error} instead of {promised}");
}

#[cfg(unix)]
#[test]
fn an_interrupted_study_keeps_its_steps() {
    use std::io::{BufRead, BufReader, Read};
    let folder = scene();
    let mut study = command(folder.path());
    let study = study.args(["study", "ball.json", "-o", "out", "--budget", "2h"]);
    let mut child = study.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let mut err = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("reference") {
        line.clear();
        assert!(err.read_line(&mut line).unwrap() > 0, "the study ended by itself");
    }
    crate::abbe_command::signal::signal(&child, "-INT");
    let mut rest = String::new();
    err.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest}");
    assert!(rest.contains("cached in out"), "{rest}");
    assert_eq!(names_in(&folder.path().join("out")), ["steps"]);
    let steps = names_in(&folder.path().join("out/steps"));
    let kept = ["rehearsal-path.exr", "rehearsal-path.json", "rehearsal-photon.exr", "rehearsal-photon.json"];
    assert_eq!(steps, kept);
}

#[test]
fn a_reference_may_be_given_and_must_have_the_film_s_shape() {
    let folder = scene();
    let said = abbe(folder.path(), &["render", "ball.json", "--passes", "64", "--size", "24x16", "--quiet"]);
    assert_eq!(said.status, 0, "{}", said.err);
    let said = study(folder.path(), &["--budget", "500ms", "--reference", "ball.exr", "--quiet"]);
    assert!(said.status == 0 && said.err.is_empty(), "{}", said.err);
    let found = report(folder.path());
    assert_eq!((&found["reference"]["origin"], &found["film"]["width"]), (&"given".into(), &24.into()));
    let said = abbe(folder.path(), &["render", "ball.json", "--passes", "1", "--size", "24x24", "--quiet"]);
    assert_eq!(said.status, 0, "{}", said.err);
    study(folder.path(), &["--reference", "ball.exr", "--quiet"]).is_error(2, &["24 × 24", "48 × 32"]);
}

#[test]
fn what_cannot_be_studied_is_told_at_once() {
    let folder = scene();
    abbe(folder.path(), &["study", "none.json", "-o", "out"]).is_error(2, &["none.json"]);
    study(folder.path(), &["--budget", "0s"]).is_error(2, &["--budget"]);
    study(folder.path(), &["--reference", "none.exr"]).is_error(2, &["none.exr"]);
    abbe(folder.path(), &["study", "ball.json"]).is_error(2, &["--output"]);
    assert_eq!(names_in(folder.path()), ["ball.json"]);
    abbe(folder.path(), &["study", "ball.json", "-o", "ball.json/out"])
        .is_error(1, &["ball.json/out", "cannot be created"]);
}
