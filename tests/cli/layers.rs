//! Layers on the command line: `--layers`, resuming, merging, and `abbe relight`.

use crate::abbe_command::folder::with_ball;
use crate::abbe_command::{Said, abbe};
use abbe_session::output::exr;
use std::path::Path;
use tempfile::TempDir;

/// Two lights, a glass ball and a grey ball on a floor.
const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 16, "height": 12, "exposure": {"ev": -3}},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "SF10"}}},
  "objects": [
    {"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "stone", "shape": {"sphere": {"center": [-1, 0.4, 0], "radius": 0.4}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20, "group": "lamp"}},
    {"point": {"at": [-3, 2, 1], "spectrum": "A", "power": 20, "group": "side light"}}],
  "render": {"passes": 9, "photons": 500}
}"#;

const LAYERS: &str = "albedo,normal,depth,object,material,uv,samples,paths,lights";

fn scene() -> TempDir {
    let folder = with_ball(SCENE);
    done(&render(folder.path(), &["-o", "whole.exr"]));
    folder
}

fn render(folder: &Path, more: &[&str]) -> Said {
    abbe(folder, &[&["render", "ball.json", "--quiet", "--layers", LAYERS], more].concat())
}

#[track_caller]
fn done(said: &Said) {
    assert_eq!(said.status, 0, "{}", said.err);
}

#[track_caller]
fn is_same_picture(folder: &Path, found: &str, known: &str) {
    let picture = |name: &str| exr::read(&folder.join(name)).unwrap().picture;
    let (found, known) = (picture(found), picture(known));
    assert!(!known.layers.channels.is_empty() && known.layers.mattes.len() == 2);
    for (a, b) in found.layers.channels.iter().zip(&known.layers.channels) {
        assert!(a.name == b.name && a.values.iter().map(|v| v.to_bits()).eq(b.values.iter().map(|v| v.to_bits())));
    }
    assert!(found == known);
}

#[test]
fn resumed_and_merged_layers_are_those_of_a_single_run() {
    let folder = scene();
    let at = folder.path();
    done(&render(at, &["--passes", "4", "--keep-checkpoint"]));
    done(&render(at, &["--resume"]));
    is_same_picture(at, "ball.exr", "whole.exr");
    done(&render(at, &["--part", "0/2", "-o", "a.exr"]));
    done(&render(at, &["--part", "1/2", "-o", "b.exr"]));
    done(&abbe(at, &["merge", "--quiet", "b.exr", "a.exr", "-o", "merged.exr"]));
    is_same_picture(at, "merged.exr", "whole.exr");
}

#[test]
fn a_checkpoint_with_other_layers_is_refused() {
    let folder = scene();
    let at = folder.path();
    done(&render(at, &["--passes", "2", "--keep-checkpoint"]));
    let said = abbe(at, &["render", "ball.json", "--resume", "--layers", "depth"]);
    said.is_error(2, &["the layers albedo, normal", "the layers depth"]);
}

#[test]
fn an_unknown_layer_is_refused() {
    let folder = with_ball(SCENE);
    let said = abbe(folder.path(), &["render", "ball.json", "--layers", "albedo,dept"]);
    assert_eq!(said.status, 2);
    assert!(said.err.contains("dept") && said.err.contains("depth"), "{}", said.err);
}

#[test]
fn relighting_mixes_the_light_groups() {
    let folder = scene();
    let at = folder.path();
    let said = abbe(at, &["relight", "whole.exr", "--list"]);
    assert_eq!((said.status, said.out.as_str()), (0, "lamp\nside_light\n"));
    let relight = |more: &[&str]| {
        done(&abbe(at, &[&["relight", "whole.exr", "--quiet", "-o", "relit.exr"], more].concat()));
        exr::read(&at.join("relit.exr")).unwrap()
    };
    let whole = exr::read(&at.join("whole.exr")).unwrap().picture;
    let same = relight(&[]).picture;
    for (a, b) in same.xyz.iter().zip(&whole.xyz) {
        let scale = b.iter().fold(0.0_f64, |scale, value| scale.max(*value));
        (0..3).for_each(|c| assert!((a[c] - b[c]).abs() <= 1e-6 * scale, "{a:?} {b:?}"));
    }
    let [lamp, side] = ["lamp", "side_light"].map(|group| {
        let name = format!("light.{group}.G");
        whole.layers.channels.iter().find(|channel| channel.name == name).unwrap().values.clone()
    });
    let mixed = relight(&["--set", "lamp=2", "--set", "side_light=#00ff00"]);
    let green = |pixel: usize| abbe_spectra::colour::xyz_to_linear_srgb(mixed.picture.xyz[pixel]);
    for pixel in 0..lamp.len() {
        let expected = 2.0 * f64::from(lamp[pixel]) + f64::from(side[pixel]);
        assert!((green(pixel)[1] - expected).abs() <= 1e-5 * expected.abs().max(1e-6), "{pixel}");
    }
    assert!(mixed.metadata.get("abbe.relight").unwrap().contains("lamp"));
    done(&abbe(at, &["relight", "whole.exr", "-o", "relit.png", "--set", "lamp=0", "--exposure", "-4"]));
    assert!(at.join("relit.png").exists());
    abbe(at, &["relight", "whole.exr", "-o", "no.exr", "--set", "lmap=2"]).is_error(2, &["lmap", "lamp"]);
    abbe(at, &["relight", "whole.exr", "-o", "no.jpg"]).is_error(2, &["no.jpg", ".png"]);
    done(&abbe(at, &["render", "ball.json", "--quiet", "--passes", "1", "-o", "plain.exr"]));
    abbe(at, &["relight", "plain.exr", "-o", "no.exr"]).is_error(2, &["plain.exr", "--layers lights"]);
}
