//! Runs every example of the program and of its crates.

use std::path::PathBuf;
use std::process::Command;

/// Returns the folder of the compiled examples. All packages of the workspace share it. Cargo builds
/// the examples of each package whose tests it builds.
fn examples_folder() -> PathBuf {
    let test = std::env::current_exe().expect("a path of this test");
    let target = test.parent().and_then(|deps| deps.parent()).expect("the test lies in target/PROFILE/deps");
    target.join("examples")
}

/// Runs an example in the package's folder, and returns its standard output.
fn output_of(name: &str, arguments: &[&str]) -> String {
    let program = examples_folder().join(name).with_extension(std::env::consts::EXE_EXTENSION);
    let mut command = Command::new(&program);
    command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.output().unwrap_or_else(|error| {
        panic!("{}: {error}; build the examples with `cargo build --profile quick --examples`", program.display())
    });
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {errors}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_scene_file_is_rendered_with_progress() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let picture = folder.path().join("ball.exr");
    let path = picture.display().to_string();
    let text = output_of("render_scene", &["scenes/glass_ball.json", &path]);
    assert!(text.contains(" passes, ") && text.contains("wrote "), "{text}");
    assert!(picture.exists() && picture.with_extension("png").exists());
    let text = output_of("error_bars", &[&path]);
    assert!(text.contains("pixels with unknown error"), "{text}");
}

#[test]
fn a_scene_is_built_without_json() {
    assert!(output_of("build_scene", &[]).starts_with("wrote "));
}

#[test]
fn spectra_become_srgb() {
    let text = output_of("spectrum_to_srgb", &[]);
    assert_eq!(text.matches('#').count(), 5, "{text}");
}

#[test]
fn a_photon_is_traced_through_the_ball() {
    let text = output_of("trace_photon", &[]);
    assert_eq!(text.matches("hits the ball").count(), 2, "{text}");
    assert!(text.contains("hits the floor"), "{text}");
}

/// The errors of a picture that the example renders itself.
#[test]
fn error_bars_are_printed() {
    let text = output_of("error_bars", &[]);
    assert!(text.contains("relative error of the picture"), "{text}");
}

/// Returns the names of the examples of all crates.
fn examples_of_crates() -> Vec<String> {
    let crates = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("crates");
    let entries = |folder: PathBuf| {
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        entries.map(|entry| entry.expect("a readable folder").path()).collect::<Vec<PathBuf>>()
    };
    let examples = entries(crates).into_iter().flat_map(|folder| entries(folder.join("examples")));
    let sources = examples.filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    sources.map(|path| path.file_stem().expect("a file has a name").to_string_lossy().into_owned()).collect()
}

/// Each crate has an example, and each example runs without arguments.
#[test]
fn the_examples_of_the_crates_run() {
    let names = examples_of_crates();
    assert!(names.len() >= 10, "{names:?}");
    for name in names {
        assert!(!output_of(&name, &[]).is_empty(), "{name} prints nothing");
    }
}

#[test]
fn the_examples_of_the_crates_print_known_values() {
    for (name, arguments, expected) in [
        ("colour_of_a_spectrum", ["FL11"].as_slice(), "CCT       4001 K"),
        ("two_lamps", &["D65", "D65"], "D65 and D65 have the same colour"),
        ("two_lamps", &[], "ΔE2000 of the lamps themselves"),
        ("index_of_a_glass", &["N-BK7"], "V_d = (n_d − 1)/(n_F − n_C) = 64.17"),
        ("film_colours", &[], "#000000"),
        ("zemax_lens", &[], "line d: f = 49.976 mm"),
        ("intersect_a_ray", &[], "the floor at [0.300, 0.000, 0.000]"),
        ("error_bar", &[], "cd/m² (95 %)"),
        ("find_a_mistake", &[], "did you mean \"N-BK7\"?"),
        ("convert_gltf", &[], "triangle.gltf"),
    ] {
        let text = output_of(name, arguments);
        assert!(text.contains(expected), "{name}: {text}");
    }
}
